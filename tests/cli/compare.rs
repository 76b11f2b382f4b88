//! `kfgpu compare`, and what a run leaves in its folder.

use serde_json::Value;

use crate::command::{Folder, level_log};

/// A folder with two runs that differ in their search.
fn two_runs() -> Folder {
    let folder = Folder::with_level();
    folder.run(&["tune", "problem.toml", "--out", "a", "--quiet"]).expect(0);
    let rough = ["tune", "problem.toml", "--out", "b", "--algorithm", "random", "--generations", "1", "--no-polish"];
    folder.run(&rough).expect(0);
    folder
}

fn result(folder: &Folder, run: &str) -> Value {
    serde_json::from_str(&folder.read(&format!("{run}/result.json"))).unwrap()
}

#[test]
fn runs_stand_side_by_side() {
    let folder = two_runs();
    let table = folder.run(&["compare", "a", "b/result.json"]).expect(0).stdout;
    for part in
        ["pso, seed 7", "random, seed 7", "q [m^2]", "nll", "mean NIS", "verdict", "evaluations", "lowest of the runs"]
    {
        assert!(table.contains(part), "{part:?} in:\n{table}");
    }
    let json = folder.run(&["compare", "a", "b", "--json"]).expect(0).json();
    assert_eq!((&json["comparable"], &json["best"]["nll"]), (&true.into(), &0.into()));
    for (i, run) in ["a", "b"].iter().enumerate() {
        let (found, written) = (&json["runs"][i], result(&folder, run));
        assert_eq!(found["path"], *run);
        for field in ["parameters", "objectives", "baseline", "evaluations", "log", "definitions", "units"] {
            assert_eq!(found[field], written[field], "{field} of {run}");
        }
    }
}

/// Of a log with one row a second, the second model drops the time column.
#[test]
fn two_models_of_one_log_are_comparable_without_its_time() {
    let folder = Folder::with_level();
    folder.write("log.csv", level_log(60).replace("\n1,", "\n1.5,"));
    folder.write("untimed.toml", folder.read("problem.toml").replace("time = \"t\"\n", ""));
    let short = ["--generations", "2", "--quiet"];
    folder.run(&[&["tune", "problem.toml", "--out", "timed"], &short[..]].concat()).expect(0);
    folder.run(&[&["tune", "untimed.toml", "--out", "untimed"], &short[..]].concat()).expect(0);
    let json = folder.run(&["compare", "timed", "untimed", "--json"]).expect(0).json();
    assert_eq!(json["comparable"], true, "{}", json["differences"]);
    let sum = |run: &str| result(&folder, run)["log"]["sha256"].clone();
    assert_ne!(sum("timed"), sum("untimed"), "their logs have other numbers");
}

#[test]
fn a_run_is_its_folder_or_any_file_there() {
    let folder = two_runs();
    let plain = folder.run(&["compare", "a", "b", "--json"]).expect(0).json();
    let files = folder.run(&["compare", "a/tuned.toml", "b/checkpoint.kfgpu", "--json"]).expect(0).json();
    assert_eq!(files["runs"][1]["parameters"], plain["runs"][1]["parameters"]);
    let parameters = &result(&folder, "a")["parameters"];
    for verb in ["filter", "check"] {
        for run in ["a", "a/tuned.toml", "a/result.json"] {
            let json = folder.run(&[verb, "problem.toml", "--json", "--parameters", run]);
            assert_eq!(&json.json()["parameters"], parameters, "{verb} --parameters {run}");
        }
    }
    for run in ["a", "a/checkpoint.kfgpu", "a/result.json"] {
        let json = folder.run(&["tune", "--json", "--resume", run]).expect(0).json();
        assert_eq!(&json["parameters"], parameters, "--resume {run}");
    }
    std::fs::create_dir(folder.path("empty")).unwrap();
    let message = folder.run(&["filter", "problem.toml", "--parameters", "empty"]).refusal();
    assert!(
        message.starts_with("empty: is not the folder of a finished run, because it has no tuned.toml"),
        "{message}"
    );
}

#[test]
fn other_logs_and_splits_are_not_comparable() {
    let folder = two_runs();
    folder.write("other.csv", level_log(61));
    folder.run(&["tune", "problem.toml", "--data", "other.csv", "--out", "other"]).expect(0);
    folder.run(&["tune", "problem.toml", "--validate", "0.3", "--out", "held"]).expect(0);
    let text = folder.run(&["compare", "a", "b", "other", "held"]).expect(0).stdout;
    assert!(text.contains("not comparable"), "{text}");
    assert!(text.contains("another log: other on other.csv, 61 rows in 1 trajectory; a on log.csv, 60 rows"), "{text}");
    assert!(text.contains("another split: held holds out 18 of 60 rows (by time); a nothing."), "{text}");
    assert!(!text.contains('*'), "no best is named:\n{text}");
    let json = folder.run(&["compare", "a", "held", "--json"]).expect(0).json();
    assert_eq!((&json["comparable"], &json["best"]["nll"]), (&false.into(), &Value::Null));
}

#[test]
fn what_is_no_run_is_refused() {
    let folder = two_runs();
    std::fs::create_dir(folder.path("empty")).unwrap();
    folder.write("broken.json", folder.read("a/result.json").split_at(100).0);
    folder.write("list.json", "[1, 2]");
    folder.write("binary.json", [0xff, 0xfe, 0x00]);
    folder.write("failing.toml", folder.read("problem.toml").replace("f = [\"x\"]", "f = [\"1e200*x\"]"));
    folder.run(&["tune", "failing.toml", "--out", "failed"]).expect(1);
    folder.run(&["tune", "problem.toml", "--objectives", "nis", "--out", "nis"]).expect(0);
    for (run, expected) in [
        ("nowhere", "nowhere: no such run (name a folder that `tune --out` wrote, or its result.json)"),
        ("empty", "empty: is not the folder of a finished run, because it has no result.json"),
        ("broken.json", "broken.json:1:100: is not a result of `kfgpu tune`: EOF while parsing"),
        ("list.json", "list.json:1:"),
        ("binary.json", "binary.json: is not text"),
        ("failed", "failed/result.json: the run found no usable candidate, so there is nothing to compare"),
        ("nis", "nis has `nis` and a has `nll`: they share no objective"),
    ] {
        let sentence = folder.run(&["compare", "a", run]).refusal();
        assert!(sentence.starts_with(expected), "{run}: {sentence}");
    }
    folder.run(&["compare", "a"]).expect(2);
}

#[test]
fn the_report_stands_in_the_folder_with_its_pictures() {
    let folder = two_runs();
    folder.run(&["tune", "problem.toml", "--validate", "0.3", "--out", "held"]).expect(0);
    let (plain, held) = (folder.read("a/report.md"), folder.read("held/report.md"));
    for part in [
        "# Tuning of problem.toml on log.csv",
        "## Verdict",
        "## Parameters",
        "## Objectives",
        "## Consistency",
        "## Pictures",
        "## Tuned filter (dt = ",
        "## The search",
        "Certificate:",
        "## Words",
        "0.001 to 100",
        "m^2",
    ] {
        assert!(plain.contains(part) && held.contains(part), "{part:?} in:\n{plain}");
    }
    assert!(plain.contains("Nothing was held out") && !plain.contains("| held out |"), "{plain}");
    assert!(held.contains("| held out |") && held.contains("Overfit gap") && held.contains(" +- "), "{held}");
    for (run, report) in [("a", &plain), ("held", &held)] {
        let links: Vec<&str> = report.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
        assert!(links.len() >= 6, "{links:?}");
        for link in links {
            assert!(folder.path(run).join(link).is_file(), "{run}/{link} is there");
        }
        let found = result(&folder, run);
        let q = found["parameters"]["q"].as_f64().unwrap();
        assert!(report.contains(&q.to_string()[..5]), "q = {q} in:\n{report}");
    }
    // A table has as many cells in every row.
    let cells = |line: &str| line.replace("\\|", "").matches('|').count();
    let rows: Vec<&str> = held.lines().collect();
    for pair in rows.windows(2).filter(|pair| pair.iter().all(|line| line.starts_with('|'))) {
        assert_eq!(cells(pair[0]), cells(pair[1]), "{pair:?}");
    }
}

#[test]
fn a_later_run_leaves_nothing_of_an_earlier_one() {
    let folder = Folder::with_level();
    folder.run(&["tune", "problem.toml", "--out", "out"]).expect(0);
    folder.write("out/mine.txt", "kept");
    let before = folder.names("out");
    assert!(before.contains(&"tuned.toml".to_owned()) && before.contains(&"figures".to_owned()), "{before:?}");
    // Wrong input touches nothing.
    let result = folder.read("out/result.json");
    folder.run(&["tune", "problem.toml", "--out", "out", "--validate", "2"]).refusal();
    assert_eq!((folder.names("out"), folder.read("out/result.json")), (before, result));

    folder.write("failing.toml", folder.read("problem.toml").replace("f = [\"x\"]", "f = [\"1e200*x\"]"));
    folder.run(&["tune", "failing.toml", "--out", "out"]).expect(1);
    let names = folder.names("out");
    for gone in ["tuned.toml", "figures", "front.csv"] {
        assert!(!names.contains(&gone.to_owned()), "{gone} in {names:?}");
    }
    for there in ["mine.txt", "report.md", "result.json", "history.csv"] {
        assert!(names.contains(&there.to_owned()), "{there} in {names:?}");
    }
    assert!(
        folder.read("out/report.md").contains("**No usable candidate was found: "),
        "{}",
        folder.read("out/report.md")
    );
}

#[test]
fn a_resumed_run_holds_out_the_same() {
    let folder = Folder::with_level();
    let flags = ["tune", "problem.toml", "--validate", "0.3", "--json"];
    let whole = folder.run(&flags).expect(0).json();
    folder.run(&[&flags[..], &["--evaluations", "64", "--out", "out"]].concat()).expect(0);
    let resumed = folder.run(&["tune", "--resume", "out", "--evaluations", "100000", "--json"]).expect(0).json();
    for field in ["parameters", "objectives", "validation", "consistency_on", "evaluations"] {
        assert_eq!(resumed[field], whole[field], "{field}");
    }
}
