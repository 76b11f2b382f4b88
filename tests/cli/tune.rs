//! `kfgpu tune`: the result, its files, its stops.

use std::collections::BTreeSet;

use serde_json::Value;

use crate::command::{Finished, Folder, level_log};

/// A result without what may differ from run to run: times, and the number of threads in the device's name.
pub(crate) fn without_times(mut json: Value) -> Value {
    let object = json.as_object_mut().unwrap();
    for key in ["wall_s", "evaluate_s"] {
        assert!(object.remove(key).is_some_and(|v| v.is_f64()), "{key} is there");
    }
    assert!(object["device"].as_object_mut().unwrap().remove("adapter").is_some(), "the device has a name");
    json
}

fn tune(folder: &Folder, more: &[&str]) -> Value {
    let arguments = [&["tune", "problem.toml", "--json"], more].concat();
    folder.run(&arguments).expect(0).json()
}

#[test]
fn the_built_in_example_runs_anywhere() {
    let finished = Folder::new().run(&["tune"]).expect(0);
    for part in ["sigma2_eps", "sigma2_eta", "641.58", "baseline", "tuned", "in-sample", "F = [[1]]", "K = "] {
        assert!(finished.stdout.contains(part), "{part:?} in:\n{}", finished.stdout);
    }
    assert!(finished.stderr.contains("100 rows"), "{}", finished.stderr);
}

#[test]
fn json_has_every_promised_field() {
    let json = tune(&Folder::with_level(), &[]);
    for (object, fields) in [
        ("parameters", &["q", "r"][..]),
        ("objectives", &["nll"]),
        ("baseline", &["parameters", "objectives"]),
        ("consistency", &["nis_mean", "nis_low", "nis_high", "verdict"]),
        ("certificate", &["objectives_f64", "objectives_search", "largest_relative_gap", "order_held"]),
        ("device", &["backend", "adapter", "precision"]),
        ("matrices", &["F", "Q", "R", "K"]),
        ("polish", &["evaluations", "starts", "before", "after", "ended", "left_at_start"]),
    ] {
        for field in fields {
            assert!(!json[object][field].is_null(), "{object}.{field} in {json}");
        }
    }
    for field in ["evaluations", "generations", "seed", "stop", "wall_s", "evaluate_s", "warnings"] {
        assert!(!json[field].is_null(), "{field} in {json}");
    }
    assert!(json.as_object().unwrap().contains_key("validation"), "{json}");
    assert!(json.as_object().unwrap().contains_key("front"), "{json}");
    assert!(json["converged"] == true && json["gradient_norm"].as_f64().unwrap() < 0.015, "{json}");
    assert_eq!(json["units"]["q"], "m^2");
    assert_eq!(json["baseline"]["parameters"]["r"], 50.0);
    assert_eq!(json["seed"], 7);
    assert_eq!(json["stop"], "generations");
    assert_eq!(json["matrices"]["R"][0][0], json["parameters"]["r"]);
    let (tuned, baseline) = (json["objectives"]["nll"].as_f64(), json["baseline"]["objectives"]["nll"].as_f64());
    assert!(tuned < baseline, "{json}");
}

#[test]
fn one_seed_is_one_result_on_any_number_of_threads() {
    let folder = Folder::with_level();
    let one = without_times(tune(&folder, &["--threads", "1"]));
    let two = without_times(tune(&folder, &["--threads", "2"]));
    assert_eq!(one.to_string(), two.to_string());
    let other = without_times(tune(&folder, &["--seed", "8", "--no-polish"]));
    assert_ne!(other["certificate"], one["certificate"], "another seed searches elsewhere");
}

#[test]
fn flags_take_the_place_of_the_file() {
    let folder = Folder::with_level();
    let json = tune(&folder, &["--algorithm", "random", "--population", "12", "--generations", "3", "--seed", "99"]);
    assert_eq!(json["algorithm"], "random");
    assert_eq!(json["seed"], 99);
    assert_eq!(json["generations"], 3);
    assert_eq!(json["evaluations"], 48);
    let json = tune(&folder, &["--objectives", "mse_innovation"]);
    assert!(json["objectives"]["mse_innovation"].is_f64(), "{json}");
    let json = tune(&folder, &["--no-polish"]);
    assert!(json["polish"].is_null() && json["converged"].is_null() && json["gradient_norm"].is_null(), "{json}");
    let json = tune(&folder, &["--precision", "f32"]);
    assert_eq!(json["device"]["precision"], "f32");
    assert!(json["certificate"]["largest_relative_gap"].as_f64().unwrap() > 0.0, "f32 costs something: {json}");
}

#[test]
fn the_folder_holds_everything_and_its_problem_runs() {
    let folder = Folder::with_level();
    let json = tune(&folder, &["--out", "results/first"]);
    assert_eq!(folder.names("results/first"), crate::command::RUN_FILES);
    let written: Value = serde_json::from_str(&folder.read("results/first/result.json")).unwrap();
    assert_eq!(written, json);
    let history = folder.read("results/first/history.csv");
    assert_eq!(history.lines().count(), 12, "header, generation 0 and ten more:\n{history}");

    let again = folder.run(&["filter", "results/first/tuned.toml", "--json"]).expect(0).json();
    assert_eq!(again["parameters"], json["parameters"]);
    assert_eq!(again["objectives"], json["objectives"]);
}

#[test]
fn the_built_in_example_leaves_a_problem_that_runs() {
    let folder = Folder::new();
    folder.run(&["tune", "--out", "nile", "--generations", "5"]).expect(0);
    folder.run(&["filter", "nile/tuned.toml", "--quiet"]).expect(0);
}

#[test]
fn a_log_given_by_flag_is_named_in_the_tuned_problem() {
    let folder = Folder::with_level();
    folder.write("other.csv", level_log(40));
    let json = tune(&folder, &["--data", "other.csv", "--out", "out"]);
    let again = folder.run(&["filter", "out/tuned.toml", "--json"]).expect(0).json();
    assert_eq!(again["objectives"], json["objectives"]);
    let piped = folder.run_with_input(&["tune", "problem.toml", "--json", "--data", "-"], folder.read("other.csv"));
    assert_eq!(piped.expect(0).json()["objectives"], json["objectives"]);
}

#[test]
fn stops() {
    let folder = Folder::with_level();
    let json = tune(&folder, &["--evaluations", "50", "--generations", "1000"]);
    assert_eq!(json["stop"], "evaluations");
    assert!(json["evaluations"].as_u64().unwrap() <= 64, "{json}");
    let json = tune(&folder, &["--target", "400", "--generations", "100000"]);
    assert_eq!(json["stop"], "target");
    let json = tune(&folder, &["--stall", "5", "--generations", "100000"]);
    assert_eq!(json["stop"], "stall");
    let json = tune(&folder, &["--wall-time", "0.2", "--generations", "1000000"]);
    assert_eq!(json["stop"], "wall_time");
}

#[test]
fn nothing_usable_exits_1_and_says_so_everywhere() {
    let folder = Folder::with_level();
    // The variance overflows at the second row, whatever is tried.
    folder.write("problem.toml", folder.read("problem.toml").replace("f = [\"x\"]", "f = [\"1e200*x\"]"));
    let finished = folder.run(&["tune", "problem.toml", "--json", "--out", "out"]).expect(1);
    assert!(finished.stderr.contains("error: no usable candidate"), "{}", finished.stderr);
    let json = finished.json();
    assert!(json["parameters"].is_null() && json["objectives"].is_null(), "{json}");
    assert!(json["baseline"]["objectives"].is_null(), "{json}");
    assert_eq!(json["failed"], json["evaluations"]);
    let keys = |json: &Value| json.as_object().unwrap().keys().cloned().collect::<BTreeSet<String>>();
    let found = tune(&Folder::with_level(), &["--generations", "1"]);
    assert_eq!(keys(&json), keys(&found), "what is not there is null");
    assert_eq!(
        folder.names("out"),
        ["checkpoint.kfgpu", "history.csv", "report.md", "result.json"],
        "there is no tuned problem"
    );

    let finished = folder.run(&["filter", "problem.toml"]).expect(2);
    assert!(finished.stderr.contains("error: log.csv:"), "{}", finished.stderr);
}

#[test]
fn a_problem_file_in_its_own_folder_of_results_is_never_lost() {
    let folder = Folder::with_level();
    tune(&folder, &["--out", "out"]);
    let broken = folder.read("out/tuned.toml").replace("f = [\"x\"]", "f = [\"1e200*x\"]");
    folder.write("out/tuned.toml", &broken);
    folder.run(&["tune", "out/tuned.toml", "--out", "out"]).expect(1);
    assert_eq!(folder.read("out/tuned.toml"), broken, "nothing was tuned, and it is the user's own");
    assert!(!folder.names("out").contains(&"figures".to_owned()), "what the earlier run left is gone");
}

#[test]
fn what_needs_a_second_look_is_said_and_recorded() {
    let folder = Folder::with_level();
    // The variance of x is q - 20, so candidates with a smaller q may fail.
    let failing =
        folder.read("problem.toml").replace("x = \"q\"", "x = \"q - 20\"").replace("start = 1,", "start = 90,");
    folder.write("failing.toml", failing);
    let finished = folder.run(&["tune", "failing.toml", "--json"]).expect(0);
    let json = finished.json();
    assert!(json["failed"].as_u64().unwrap() > 0, "{json}");
    let warning = format!("{} of {} evaluations failed", json["failed"], json["evaluations"]);
    assert!(json["warnings"].to_string().contains(&warning), "{json}");
    assert!(finished.stderr.contains(&format!("warning: {warning}")), "{}", finished.stderr);

    let optimum = tune(&folder, &["--generations", "40"])["parameters"].clone();
    let (q, r) = (optimum["q"].to_string(), optimum["r"].to_string());
    let solved = folder.read("problem.toml").replace("start = 1,", &format!("start = {q},"));
    folder.write("problem.toml", solved.replace("start = 50", &format!("start = {r}")));
    let json = tune(&folder, &["--algorithm", "random", "--generations", "1", "--no-start", "--no-polish"]);
    assert!(json["warnings"].to_string().contains("no better than the baseline"), "{json}");
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::with_level();
    let mut child = folder.spawn(&["tune", "problem.toml", "--quiet"]);
    drop(child.stdout.take());
    let finished = Finished::from(child.wait_with_output().unwrap()).expect(0);
    assert_eq!(finished.stderr, "");
}

#[test]
fn nothing_draws_on_a_pipe() {
    let finished = Folder::with_level().run(&["tune", "problem.toml"]).expect(0);
    assert!(!finished.stderr.contains('\u{1b}') && !finished.stderr.contains('\r'), "{:?}", finished.stderr);
    assert!(!finished.stdout.contains('\u{1b}'), "{:?}", finished.stdout);
}

/// The second sensor is silent in the rows tuned on: its bias and its variance keep the values that the user gave.
#[test]
fn undetermined_parameters_stay_at_their_start() {
    let folder = Folder::new();
    let rows = level_log(60);
    let log = rows.lines().enumerate().map(|(i, line)| match (i, line.rsplit(',').next()) {
        (0, _) => format!("{line},second\n"),
        (i, Some(value)) if i > 45 => format!("{line},{value}\n"),
        _ => format!("{line},\n"),
    });
    folder.write("log.csv", log.collect::<String>());
    let text = crate::command::LEVEL
        .replace("measurements = [\"z\"]", "measurements = [\"z\", \"second\"]")
        .replace("h = [\"x\"]", "h = [\"x\", \"x + bias\"]")
        .replace("R = { z = \"r\" }", "R = [\"r\", \"r2\"]")
        .replace(
            "[parameters]\n",
            "[parameters]\nbias = { min = -9, max = 9, start = 2.5 }\nr2 = { min = 1e-4, max = 1e4, scale = \"log\", start = 7 }\n",
        );
    folder.write("problem.toml", &text);
    let json = tune(&folder, &["--validate", "0.3"]);
    assert_eq!((&json["parameters"]["bias"], &json["parameters"]["r2"]), (&2.5.into(), &7.0.into()), "{text}\n{json}");
    assert_eq!(json["polish"]["left_at_start"], serde_json::json!(["bias", "r2"]));
    assert_eq!(json["converged"], true, "{json}");
    let report = folder.run(&["tune", "problem.toml", "--validate", "0.3"]).expect(0).stdout;
    for part in
        ["undetermined, left at its start", "bias is not determined by this log", "r2 is not determined by this log"]
    {
        assert!(report.contains(part), "{part}: {report}");
    }
}
