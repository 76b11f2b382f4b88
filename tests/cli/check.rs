//! `kfgpu check`: exit codes for consistent and other filters.

use serde_json::Value;

use crate::command::{Folder, LEVEL, level_log};

/// A folder with `right.toml`, whose starts are what `log.csv` was simulated with, and `wrong.toml` with R too small.
fn simulated() -> Folder {
    let folder = Folder::new();
    let drawn = LEVEL.replace("file = \"log.csv\"\n", "").replace("start = 1,", "start = 0.5,").replace("= 50", "= 4")
        + "\n[simulate]\nsteps = 400\ndt = 1.0\nx0 = [3]\nseed = 5\n";
    folder.write("simulated.toml", &drawn);
    folder.run(&["simulate", "simulated.toml", "--out", "log.csv"]).expect(0);
    let right = LEVEL.replace("start = 1,", "start = 0.5,").replace("start = 50", "start = 4");
    folder.write("wrong.toml", right.replace("start = 4", "start = 1"));
    folder.write("right.toml", right);
    folder
}

#[test]
fn the_filter_that_drew_the_log_passes() {
    let folder = simulated();
    let finished = folder.run(&["check", "right.toml", "--quiet"]).expect(0);
    assert!(finished.stdout.ends_with("check passed\n"), "{}", finished.stdout);
    assert_eq!(finished.stderr, "");
    let json = folder.run(&["check", "right.toml", "--json"]).expect(0).json();
    assert_eq!(json["pass"], true, "{json}");
    let targets = json["targets"].as_array().unwrap();
    assert_eq!(targets.len(), 8, "seven tests with one measurement, and bounds: {json}");
    for key in ["name", "required", "measured", "pass"] {
        assert!(targets.iter().all(|target| !target[key].is_null()), "{key}: {json}");
    }
    let tests = json["consistency"]["tests"].as_array().unwrap();
    for (test, target) in tests.iter().zip(targets) {
        assert_eq!((&test["name"], &test["pass"]), (&target["name"], &target["pass"]), "the verdict's own tests");
    }
    assert_eq!(json["consistency"]["nis_distribution"]["rows"], 401, "{json}");
    assert!(json["consistency"]["standard_errors"].is_null(), "nothing was tuned: {json}");
}

#[test]
fn a_wrong_filter_fails_with_exit_code_1() {
    let folder = simulated();
    let finished = folder.run(&["check", "wrong.toml"]).expect(1);
    assert!(finished.stdout.contains("FAIL") && finished.stdout.contains("overconfident"), "{}", finished.stdout);
    assert!(finished.stdout.ends_with("check failed\n"), "{}", finished.stdout);
    folder.run(&["check", "wrong.toml", "--parameters", "right.toml"]).expect(0);
    folder.run(&["check", "right.toml", "--parameters", "wrong.toml"]).expect(1);
}

/// NIS may be right where the innovations are not white.
#[test]
fn correlated_innovations_fail() {
    let folder = Folder::with_level();
    folder.write("log.csv", level_log(400));
    let json = folder.run(&["check", "problem.toml", "--json"]).expect(1).json();
    assert_eq!(target(&json, "largest autocorrelation of z")["pass"], false, "{json}");
}

fn target(json: &Value, name: &str) -> Value {
    let targets = json["targets"].as_array().unwrap();
    targets.iter().find(|target| target["name"] == name).unwrap_or_else(|| panic!("no {name}: {json}")).clone()
}

/// One wrong value fails the filter that drew the log, and one whose noise was tuned around it.
#[test]
fn a_glitch_fails_and_is_named() {
    let folder = simulated();
    let log = folder.read("log.csv").lines().enumerate().fold(String::new(), |text, (i, line)| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if i == 200 {
            cells[1] = "300";
        }
        text + &cells.join(",") + "\n"
    });
    folder.write("glitch.csv", log);
    let glitch = |name: &str| folder.read(name).replace("log.csv", "glitch.csv");
    folder.write("glitch.toml", glitch("right.toml"));
    folder.run(&["tune", "glitch.toml", "--quiet", "--out", "tuned"]).expect(0);
    for parameters in ["right.toml", "tuned/tuned.toml"] {
        let finished = folder.run(&["check", "glitch.toml", "--parameters", parameters]).expect(1);
        let said = finished.stdout.lines().find(|line| line.trim_start().starts_with("outliers: ")).unwrap_or_default();
        // Behind the wrong value stands its echo, which the estimate takes a few rows to forget.
        assert!(
            said.contains("line 201 (row 199, time 199)") && said.contains("of the sum of NIS"),
            "{}",
            finished.stdout
        );
        let json = folder.run(&["check", "glitch.toml", "--parameters", parameters, "--json"]).expect(1).json();
        assert_eq!(target(&json, "largest share of one row in the sum of NIS")["pass"], false, "{json}");
        assert_eq!(json["consistency"]["dominating_rows"][0]["line"], 201, "{json}");
    }
}

/// What a search left at a bound is not what the log asks for.
#[test]
fn a_parameter_at_its_bound_fails() {
    let folder = simulated();
    folder.write(
        "bound.toml",
        folder.read("right.toml").replace("r = { min = 1e-3, max = 1e2", "r = { min = 1e-3, max = 4"),
    );
    let json = folder.run(&["check", "bound.toml", "--json"]).expect(1).json();
    assert_eq!(target(&json, "searched parameters at a bound")["measured"], 1.0, "{json}");
}

#[test]
fn another_log_is_checked_and_too_short_a_one_proves_nothing() {
    let folder = simulated();
    let log = folder.read("log.csv");
    folder.run_with_input(&["check", "right.toml", "--data", "-"], &log).expect(0);
    let short: String = log.lines().take(5).map(|line| format!("{line}\n")).collect();
    let finished = folder.run_with_input(&["check", "right.toml", "--data", "-", "--json"], short).expect(1);
    let json = finished.json();
    assert_eq!(json["consistency"]["verdict"], "too_few_innovations", "{json}");
    assert!(target(&json, "largest autocorrelation of z")["measured"].is_null(), "{json}");
    assert!(json["consistency"]["nis_distribution"]["p_value"].is_null(), "{json}");
}

#[test]
fn broken_input_is_refused() {
    let folder = Folder::with_level();
    for (arguments, named) in [
        (&["check", "nowhere.toml"][..], "nowhere.toml"),
        (&["check", "problem.toml", "--data", "nowhere.csv"], "nowhere.csv"),
        (&["check", "problem.toml", "--parameters", "nowhere.toml"], "nowhere.toml"),
        (&["check", "log.csv"], "log.csv"),
    ] {
        let message = folder.run(arguments).refusal();
        assert!(message.contains(named), "{arguments:?}: {message}");
    }
    folder.run(&["check"]).expect(2);
    folder.write("log.csv", "t,z\n0,\n1,\n");
    assert!(folder.run(&["check", "problem.toml"]).refusal().contains("log.csv"), "no measurement at all");
}

/// NEES takes the rows where truth of all states is; rmse takes each state's own.
#[test]
fn truth_may_have_gaps() {
    let folder = Folder::with_level();
    let with_truth = LEVEL.replace("measurements = [\"z\"]", "measurements = [\"z\"]\ntruth = { x = \"true\" }");
    folder.write("problem.toml", with_truth);
    folder.write("log.csv", "t,z,true\n0,1,1\n1,2,\n2,3,3\n3,4,nan\n4,,5\n");
    let json = folder.run(&["check", "problem.toml", "--json"]).expect(1).json();
    assert_eq!(json["consistency"]["nees"]["rows"], 3, "{json}");
    folder.write("log.csv", "t,z,true\n0,1,\n1,2,\n2,3,\n");
    let json = folder.run(&["check", "problem.toml", "--json"]).expect(1).json();
    assert!(json["consistency"]["nees"].is_null(), "{json}");
    let json = folder.run(&["filter", "problem.toml", "--smooth", "--json"]).expect(0).json();
    assert!(json["rmse"].is_null(), "truth without a value: {json}");
}

/// The growth model by other filters: a table, a sentence, and the exit code of the problem's own.
#[test]
fn filters_are_compared_on_one_log() {
    let folder = Folder::new();
    folder.write("problem.toml", include_str!("../data/nonlinear/growth.toml"));
    folder.write("growth.csv", include_str!("../data/nonlinear/growth.csv"));
    let plain = folder.run(&["check", "problem.toml"]).expect(1).stdout;
    let text = folder.run(&["check", "problem.toml", "--filters", "unscented,iterated,unscented"]).expect(1).stdout;
    assert!(text.ends_with(&plain), "targets and verdict are those of the problem's own filter: {text}");
    assert_eq!(text.matches("\n  unscented ").count(), 1, "one row a filter: {text}");
    let sentence = "The unscented filter is more likely than the extended by 718 +- ";
    assert!(text.contains(sentence) && text.contains("extended (own)"), "{text}");
    let arguments = ["check", "problem.toml", "--filters", "extended,unscented", "--json"];
    let json = folder.run(&arguments).expect(1).json();
    let filters = json["linearity"].as_array().unwrap();
    assert_eq!(
        filters.iter().map(|one| one["filter"].as_str().unwrap()).collect::<Vec<_>>(),
        ["extended", "unscented"]
    );
    assert!(filters[1]["difference"].as_f64().unwrap() < -500.0 && filters[1]["verdict"] == "better", "{json}");
    for key in ["nll", "nll_per_row", "standard_error", "nis_mean", "amplification"] {
        assert!(filters.iter().all(|one| one[key].is_f64()), "{key}: {json}");
    }
    assert!(filters[0]["rmse"]["x"].as_f64() > filters[1]["rmse"]["x"].as_f64() && filters[0]["failed"].is_null());
    assert_eq!(json["verdict"]["linearising"], "costs", "{json}");
    let json = folder.run(&["check", "problem.toml", "--json"]).expect(1).json();
    assert!(json.get("linearity").is_none() && json.get("verdict").is_none(), "not asked for: {json}");
}

#[test]
fn names_that_are_no_filter_are_refused() {
    let folder = Folder::with_level();
    let refused = |names: &str| folder.run(&["check", "problem.toml", "--filters", names]).refusal();
    let message = refused("extended,unscentd");
    assert!(message.starts_with("--filters: there is no filter `unscentd`: did you mean `unscented`?"), "{message}");
    assert!(refused("sage-husa").contains("adapts its noise"), "{}", refused("sage-husa"));
    let finished = folder.run(&["check", "problem.toml", "--filters", "kalman,extended"]);
    assert!(finished.stdout.contains("Every filter is the Kalman filter here"), "{}", finished.stdout);
}

/// Where the problem's own filter fails, what was found of all is told before the failure.
#[test]
fn a_filter_that_fails_is_a_row_with_its_reason() {
    let folder = Folder::with_level();
    // It runs away where nothing is measured.
    let away =
        LEVEL.replace("f = [\"x\"]", "f = [\"x + x^3\"]").replace("[tune]", "[filter]\nkind = \"extended\"\n[tune]");
    folder.write("problem.toml", away);
    folder.write("log.csv", (0..40).fold("t,z\n0,3\n".to_owned(), |log, k| log + &format!("{},\n", k + 1)));
    let finished = folder.run(&["check", "problem.toml", "--filters", "iterated"]).expect(2);
    let sentence = "Nothing can be told of linearising: no filter runs on this log.";
    assert!(finished.stdout.contains(sentence), "{}{}", finished.stdout, finished.stderr);
    let reasons = finished.stdout.matches("log.csv:").count();
    assert_eq!(reasons, 2, "one a filter: {}", finished.stdout);
    assert!(finished.stderr.contains("error: log.csv:"), "{}", finished.stderr);
}
