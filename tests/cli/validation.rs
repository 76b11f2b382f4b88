//! `tune --validate` and `--realisations`: what the search sees, what the result is judged on, what is refused.

use serde_json::Value;

use crate::command::{Folder, level_log};

fn tune(folder: &Folder, more: &[&str]) -> Value {
    let arguments = [&["tune", "problem.toml", "--json"], more].concat();
    folder.run(&arguments).expect(0).json()
}

fn number(json: &Value) -> f64 {
    json.as_f64().unwrap_or_else(|| panic!("{json} is a number"))
}

#[test]
fn the_search_sees_the_training_rows_alone() {
    let folder = Folder::with_level();
    let held_out = tune(&folder, &["--validate", "0.3", "--out", "out"]);
    // The first 42 of 60 rows as a log of their own.
    let short: String = level_log(60).lines().take(43).flat_map(|line| [line, "\n"]).collect();
    folder.write("short.csv", short);
    let alone = tune(&folder, &["--data", "short.csv"]);
    for field in ["parameters", "objectives", "certificate", "polish", "baseline", "measured_rows", "matrices"] {
        assert_eq!(held_out[field], alone[field], "{field}");
    }
    assert_eq!(held_out["log"]["rows"], 60);
    assert_eq!(alone["validation"], Value::Null);
    assert_eq!((&held_out["consistency_on"], &alone["consistency_on"]), (&"held_out".into(), &"in_sample".into()));
    assert_eq!(held_out["consistency"]["components"], 18);

    let validation = &held_out["validation"];
    assert_eq!((&validation["by"], &validation["share"]), (&"time".into(), &0.3.into()));
    assert_eq!(validation["train"]["rows"], 42);
    assert_eq!(validation["held_out"]["rows"], 18);
    // nll adds up over rows, so the held-out part is that of the whole log less that of the training rows.
    let whole = folder.run(&["filter", "out/tuned.toml", "--json"]).expect(0).json();
    let rest = number(&whole["objectives"]["nll"]) - number(&held_out["objectives"]["nll"]);
    let found = number(&validation["winner"]["nll"]);
    assert!((found - rest).abs() < 1e-9 * rest.abs(), "{found} and {rest}");

    let baseline = folder.run(&["filter", "problem.toml", "--json"]).expect(0).json();
    let rest = number(&baseline["objectives"]["nll"]) - number(&held_out["baseline"]["objectives"]["nll"]);
    assert!((number(&validation["baseline"]["nll"]) - rest).abs() < 1e-9 * rest.abs(), "{validation}");
    let per_row = |json: &Value, baseline: &Value, rows: f64| (number(baseline) - number(json)) / rows;
    let train = per_row(&held_out["objectives"]["nll"], &held_out["baseline"]["objectives"]["nll"], 42.0);
    let held = per_row(&validation["winner"]["nll"], &validation["baseline"]["nll"], 18.0);
    for (field, expected) in
        [("improvement_train", train), ("improvement_held_out", held), ("overfit_gap", train - held)]
    {
        let found = number(&validation[field]["nll"]);
        assert!((found - expected).abs() < 1e-12, "{field}: {found} and {expected}");
    }
}

#[test]
fn the_report_says_what_was_held_out() {
    let folder = Folder::with_level();
    let report = folder.run(&["tune", "problem.toml", "--validate", "0.3"]).expect(0).stdout;
    for part in [
        "Validation: the last 30 % of the rows are held out, 18 of 60; the filter runs through all of them.",
        "training",
        "held out",
        "nats a row",
        " +- ",
        "Overfit gap",
        "Consistency (held-out rows):",
    ] {
        assert!(report.contains(part), "{part:?} in:\n{report}");
    }
}

#[test]
fn worse_on_held_out_data_is_said_plainly() {
    let folder = Folder::with_level();
    // The noise grows tenfold after two thirds of the log, and the start values are right for that part.
    let log = (0..60).fold("t,z\n".to_owned(), |text, k| {
        let noise = (f64::from(k * 7919 % 13) - 6.0) * if k < 40 { 0.2 } else { 2.0 };
        format!("{text}{k},{noise:.4}\n")
    });
    folder.write("log.csv", log);
    let finished = folder.run(&["tune", "problem.toml", "--json", "--validate", "0.33"]).expect(0);
    let json = finished.json();
    assert_eq!(json["validation"]["worse"], true, "{}", json["validation"]);
    let held_out = &json["held_out"];
    assert_eq!((&held_out["verdict"], &held_out["objective"]), (&"worse".into(), &"nll".into()), "{held_out}");
    let of = |part: &str| number(&json["validation"][part]["nll"]);
    assert!((number(&held_out["difference"]) - (of("baseline") - of("winner"))).abs() < 1e-9, "{held_out}");
    assert!(number(&held_out["difference"]) < -1.96 * number(&held_out["standard_error"]), "{held_out}");
    let sentence = "tuned parameters are worse than yours on held-out data";
    assert!(json["warnings"].to_string().contains(sentence), "{}", json["warnings"]);
    assert!(finished.stderr.contains(&format!("warning: {sentence}")), "{}", finished.stderr);
    assert!(number(&json["validation"]["overfit_gap"]["nll"]) > 0.5, "{}", json["validation"]);
    let report = folder.run(&["tune", "problem.toml", "--validate", "0.33", "--quiet"]).expect(0);
    assert!(
        report.stdout.contains("The tuned parameters are worse than yours on held-out data: `nll` by "),
        "{}",
        report.stdout
    );
}

/// A start near the truth and what is tuned from it: the rows held out tell no difference, and nobody is told to keep one.
#[test]
fn what_held_out_rows_cannot_tell_is_said() {
    let folder = Folder::new();
    folder.write(
        "problem.toml",
        SIMULATED.replace("start = 10 }\nr", "start = 0.5 }\nr").replace("start = 10", "start = 4"),
    );
    folder.run(&["simulate", "problem.toml", "--out", "log.csv"]).expect(0);
    let drawn = folder.read("problem.toml");
    let (before, _) = drawn.split_once("[simulate]").unwrap();
    folder.write("problem.toml", before.replace("[data]", "[data]\nfile = \"log.csv\""));
    let finished = folder.run(&["tune", "problem.toml", "--json", "--validate", "0.4", "--out", "out"]).expect(0);
    let json = finished.json();
    assert_eq!(json["held_out"]["verdict"], "not-told-apart", "{}", json["held_out"]);
    assert_eq!(json["validation"]["worse"], false);
    assert!(!finished.stderr.contains("worse than yours"), "{}", finished.stderr);
    let report = folder.read("out/report.md");
    assert!(
        report.contains("No difference between the tuned parameters and yours that the held-out rows can tell"),
        "{report}"
    );
    assert!(!report.contains("Keep your own"), "{report}");
    let table = folder.run(&["compare", "out", "out"]).expect(0).stdout;
    assert!(table.contains("not told apart ("), "{table}");
}

/// Of a problem that `init` wrote the start is not the user's; of the tuned problem it is the winner.
#[test]
fn the_start_of_a_draft_is_called_drafted() {
    let folder = Folder::with_level();
    folder.run(&["init", "log.csv", "--out", "draft.toml"]).expect(0);
    let tuned = |problem: &str, out: &str| {
        let arguments = ["tune", problem, "--json", "--validate", "0.3", "--generations", "20", "--out", out];
        (folder.run(&arguments).expect(0).json(), folder.read(&format!("{out}/report.md")))
    };
    let (json, report) = tuned("draft.toml", "first");
    assert_eq!(json["start_of"], "drafted", "{json}");
    assert!(report.contains("the drafted start") && !report.contains("yours"), "{report}");
    let (json, report) = tuned("first/tuned.toml", "second");
    assert_eq!(json["start_of"], "yours", "{json}");
    assert!(!report.contains("the drafted start"), "{report}");
}

#[test]
fn a_filter_that_fails_on_held_out_rows_is_said_to() {
    let folder = Folder::with_level();
    // The state grows by 28 % in every step of 1 s, and overflows in the one long step that is held out.
    let text = folder.read("problem.toml").replace("f = [\"x\"]", "f = [\"x*exp(dt/4)\"]");
    folder.write("problem.toml", text);
    folder.write("log.csv", format!("{}2000,1\n", level_log(20)));
    let finished = folder.run(&["tune", "problem.toml", "--json", "--validate", "0.05"]).expect(0);
    let json = finished.json();
    assert!(json["validation"]["winner"].is_null() && json["validation"]["baseline"].is_null(), "{json}");
    assert_eq!(json["consistency_on"], "in_sample");
    assert!(finished.stderr.contains("fails on held-out data"), "{}", finished.stderr);
}

#[test]
fn flags_and_keys_choose_the_split() {
    let folder = Folder::with_level();
    let rows = (0..15).flat_map(|k| (1..=4).map(move |run| (run, k)));
    let log = rows.fold("run,t,z\n".to_owned(), |text, (run, k)| format!("{text}{run},{k},{}\n", (k * run) % 5));
    folder.write("log.csv", log);
    let text =
        folder.read("problem.toml").replace("time = \"t\"", "time = \"t\"\ntrajectory = \"run\"\nvalidate = 0.5");
    folder.write("problem.toml", &text);
    let json = tune(&folder, &["--out", "out"]);
    assert_eq!(json["validation"]["trajectories"], serde_json::json!(["2", "4"]));
    assert_eq!((&json["log"]["trajectories"], &json["validation"]["train"]["rows"]), (&4.into(), &30.into()));
    assert!(folder.read("out/tuned.toml").contains("validate = 0.5"), "the key is kept");
    assert!(tune(&folder, &["--no-validate"])["validation"].is_null());
    assert_eq!(tune(&folder, &["--validate", "0.25"])["validation"]["trajectories"], serde_json::json!(["4"]));
    folder.write("problem.toml", text.replace("= 0.5", "= { share = 0.2, by = \"time\" }"));
    let json = tune(&folder, &["--validate", "0.4", "--out", "out"]);
    assert_eq!((&json["validation"]["by"], &json["validation"]["held_out"]["rows"]), (&"time".into(), &24.into()));
    assert_eq!(tune(&folder, &["--data", "log.csv"])["validation"]["held_out"]["rows"], 12);
    let again = folder.run(&["tune", "out/tuned.toml", "--json"]).expect(0).json();
    assert_eq!(again["validation"]["held_out"], json["validation"]["held_out"], "tuned.toml holds out the same");
}

const SIMULATED: &str = "[data]\nmeasurements = [\"z\"]\n[model]\nkind = \"local-level\"\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\nP0 = [3]\n\
     [parameters]\nq = { min = 1e-2, max = 1e2, scale = \"log\", start = 10 }\nr = { min = 1e-2, max = 1e2, scale = \"log\", start = 10 }\n\
     [tune]\npopulation = 16\ngenerations = 15\n[simulate]\nsteps = 50\nparameters = { q = 0.5, r = 4 }\n";

#[test]
fn realisations_are_pooled_and_one_alone_is_warned_about() {
    let folder = Folder::new();
    folder.write("problem.toml", SIMULATED);
    let finished = folder.run(&["tune", "problem.toml", "--json"]).expect(0);
    let warning = "the log is a single simulated realisation";
    assert!(finished.stderr.contains(&format!("warning: {warning}")), "{}", finished.stderr);
    assert!(finished.json()["warnings"].to_string().contains(warning), "{}", finished.stdout);

    let finished = folder.run(&["tune", "problem.toml", "--json", "--realisations", "6", "--out", "out"]).expect(0);
    assert!(!finished.stderr.contains(warning), "{}", finished.stderr);
    let json = finished.json();
    assert_eq!((&json["log"]["trajectories"], &json["log"]["rows"]), (&6.into(), &306.into()));
    assert!(folder.read("out/tuned.toml").contains("trajectories = 6"), "{}", folder.read("out/tuned.toml"));
    // nll adds up over realisations: each is the log that `simulate` draws with as many.
    let whole = folder.run(&["filter", "out/tuned.toml", "--json"]).expect(0).json();
    assert_eq!(whole["objectives"], json["objectives"]);
}

#[test]
fn fresh_realisations_are_held_out() {
    let folder = Folder::new();
    folder.write("problem.toml", SIMULATED);
    let alone = tune(&folder, &["--realisations", "4"]);
    let json = tune(&folder, &["--realisations", "4", "--validate", "0.34"]);
    assert_eq!(json["parameters"], alone["parameters"], "nothing is taken from what is tuned on");
    let validation = &json["validation"];
    assert_eq!(validation["trajectories"], serde_json::json!(["5", "6"]), "0.34 of all is 2.06 beside 4");
    assert_eq!((&validation["fresh"], &validation["held_out"]["rows"]), (&true.into(), &102.into()));
    let of = |count: &str| {
        let text = SIMULATED.replace("steps = 50", &format!("steps = 50\ntrajectories = {count}"));
        folder.write("more.toml", text.replace("start = 10", "start = 1"));
        folder.run(&["filter", "more.toml", "--json", "--parameters", "winner.toml"]).expect(0).json()
    };
    let winner = tune(&folder, &["--realisations", "4", "--validate", "0.34", "--out", "out"]);
    assert_eq!(winner["parameters"], json["parameters"]);
    folder.write("winner.toml", folder.read("out/tuned.toml"));
    let rest = number(&of("6")["objectives"]["nll"]) - number(&of("4")["objectives"]["nll"]);
    let found = number(&validation["winner"]["nll"]);
    assert!((found - rest).abs() < 1e-9 * rest.abs(), "{found} and {rest}");
    let report = folder.run(&["tune", "problem.toml", "--validate", "0.1"]).expect(0).stdout;
    assert!(report.contains("Validation: 1 fresh realisation is held out beside 1 that is tuned on."), "{report}");
}

#[test]
fn splits_that_cannot_be_are_refused() {
    let folder = Folder::with_level();
    let refused = |arguments: &[&str]| {
        let arguments = [&["tune", "problem.toml", "--out", "out"], arguments].concat();
        let sentence = folder.run(&arguments).refusal();
        assert!(!folder.path("out").exists(), "nothing is written");
        sentence
    };
    let expected = "expected a share above 0 and below 1, or false to hold nothing out";
    for share in ["0", "1", "-0.5", "7"] {
        let found = refused(&["--validate", share]);
        assert!(
            found.starts_with(&format!("--validate {share}: `data.validate` is ")) && found.ends_with(expected),
            "{found}"
        );
    }
    for share in ["nan", "inf"] {
        assert!(refused(&["--validate", share]).ends_with("expected a finite number"), "{share}");
    }
    assert_eq!(
        refused(&["--validate", "0.001"]),
        "--validate 0.001: `data.validate`: 0.001 of the 60 rows of log.csv rounds to none, so nothing is held out (give more)"
    );
    assert_eq!(
        refused(&["--validate", "0.999"]),
        "--validate 0.999: `data.validate`: 0.999 of the 60 rows of log.csv rounds to all, so nothing is left to train on (give less)"
    );
    let one = "the log is read from log.csv, and only one drawn from [simulate] has realisations";
    assert_eq!(refused(&["--realisations", "5"]), format!("--realisations: {one}"));

    let problem = folder.read("problem.toml");
    for (value, place) in [
        (
            "{ share = 0.3, by = \"trajectory\" }",
            "5:12: `data.validate`: validation by trajectory needs at least two, and log.csv has one",
        ),
        ("{ share = 0.3, by = \"rows\" }", "5:32: `data.validate.by` is \"rows\": expected \"trajectory\" or \"time\""),
        ("{ by = \"time\" }", "5:12: [data.validate] lacks `share`: give the share to hold out, such as 0.3"),
        ("{ share = 0.3, be = 1 }", "5:27: unknown key `be` in [data.validate]"),
        (
            "true",
            "5:12: `data.validate`: expected a share such as 0.3, a table with `share` and `by`, or false, found true",
        ),
        ("1.5", "5:12: `data.validate` is 1.5: expected a share above 0 and below 1"),
        ("nan", "5:12: `data.validate` is nan: expected a finite number"),
    ] {
        folder.write("problem.toml", problem.replace("time = \"t\"", &format!("time = \"t\"\nvalidate = {value}")));
        let found = refused(&[]);
        assert!(found.starts_with(&format!("problem.toml:{place}")), "{value}: {found}");
    }
    // Nothing measured in the second half.
    let empty = (30..60).fold(level_log(30), |text, k| format!("{text}{k},\n"));
    folder.write("log.csv", empty);
    folder.write("problem.toml", problem.replace("time = \"t\"", "time = \"t\"\nvalidate = 0.5"));
    assert_eq!(
        refused(&[]),
        "problem.toml:5:12: `data.validate`: no held-out row of log.csv scores under the objective `nll`, which needs a \
         measurement there (give another share)"
    );
}
