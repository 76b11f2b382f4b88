use super::*;

/// A result.json, with some of it replaced.
fn text(changes: &[(&str, &str)]) -> String {
    let text = r#"{"problem":"p.toml","log":{"source":"log.csv","rows":60,"trajectories":1,"sha256":"ab"},"algorithm":"pso",
"seed":7,"parameters":{"r":2.5,"q":1.25},"units":{"r":null,"q":"m^2"},"objectives":{"nll":100.5},
"definitions":{"nll":"every row"},"baseline":{"parameters":{"r":1.0,"q":1.0},"objectives":{"nll":120.0}},"validation":null,
"consistency":{"nis_mean":1.02,"nis_low":0.8,"nis_high":1.2,"verdict":"innovations_correlated"},"consistency_on":"in_sample",
"evaluations":176,"stop":"generations","wall_s":0.5,"device":{"backend":"cpu","adapter":"x","precision":"f64"}}"#;
    changes.iter().fold(text.to_owned(), |text, (old, new)| {
        assert_eq!(text.matches(old).count(), 1, "`{old}` stands once");
        text.replace(old, new)
    })
}

fn run(path: &str, changes: &[(&str, &str)]) -> Run {
    Run::read(&text(changes), path, &format!("{path}/result.json")).unwrap_or_else(|e| panic!("{e}"))
}

const HELD_OUT: &str = r#""validation":{"by":"time","share":0.3,"fresh":false,"train":{"rows":42,"trajectories":1},
"held_out":{"rows":18,"trajectories":1},"baseline":{"nll":50.0},"winner":{"nll":45.0},"worse":false}"#;

fn differences(changes: &[(&str, &str)]) -> Vec<String> {
    let comparison = Comparison::of(vec![run("a", &[]), run("b", changes)]).unwrap();
    assert_eq!(comparison.comparable, comparison.differences.is_empty());
    comparison.differences
}

#[test]
fn the_lowest_is_marked_where_runs_are_comparable() {
    let better = run("b", &[("100.5", "99.5"), ("\"q\":1.25", "\"q\":1.5")]);
    let comparison = Comparison::of(vec![run("a", &[]), better.clone()]).unwrap();
    assert_eq!(comparison.best.get("nll"), Some(&Some(1)));
    assert_eq!(comparison.best_held_out.iter().len(), 0);
    let text = comparison.to_string();
    let line =
        |start: &str| text.lines().find(|l| l.trim_start().starts_with(start)).unwrap_or_else(|| panic!("{text}"));
    assert_eq!(line("nll").split_whitespace().collect::<Vec<_>>(), ["nll", "100.50000", "99.500000", "*"]);
    assert_eq!(line("q [m^2]").split_whitespace().collect::<Vec<_>>(), ["q", "[m^2]", "1.25", "1.5"]);
    assert!(line("verdict").contains("innovations correlated"), "{text}");
    let tie = Comparison::of(vec![better.clone(), better]).unwrap();
    assert_eq!(tie.best.get("nll"), Some(&None), "neither is the lowest");
}

#[test]
fn held_out_scores_stand_beside_training_scores() {
    let other = HELD_OUT.replace("45.0", "44.0");
    let runs = vec![run("a", &[("\"validation\":null", HELD_OUT)]), run("b", &[("\"validation\":null", &other)])];
    let comparison = Comparison::of(runs).unwrap();
    assert!(comparison.comparable, "{:?}", comparison.differences);
    assert_eq!((comparison.best.get("nll"), comparison.best_held_out.get("nll")), (Some(&None), Some(&Some(1))));
    let text = comparison.to_string();
    assert!(text.contains("nll, training") && text.contains("44.000000 *"), "{text}");
    assert!(text.contains("no worse"), "{text}");
    let trade = HELD_OUT.replace("\"nll\":50.0", "\"nll\":50.0,\"rmse\":1.0");
    let trade = trade.replace("\"nll\":45.0", "\"nll\":45.0,\"rmse\":2.0");
    let runs = ["a", "b"].map(|path| run(path, &[("\"validation\":null", &trade)])).to_vec();
    let text = Comparison::of(runs).unwrap().to_string();
    assert!(text.contains("a trade") && !text.contains("no worse"), "{text}");
}

#[test]
fn runs_that_scored_other_rows_are_said_to() {
    assert_eq!(
        differences(&[("\"ab\"", "\"cd\"")]),
        [
            "another log: b on log.csv, 60 rows in 1 trajectory, with other numbers; a on log.csv, 60 rows in 1 trajectory."
        ]
    );
    assert_eq!(
        differences(&[("every row", "without the first 5 rows")]),
        ["`nll` over other rows: b (without the first 5 rows); a (every row)."]
    );
    assert_eq!(
        differences(&[("\"validation\":null", HELD_OUT)]),
        ["another split: b holds out 18 of 60 rows (by time); a nothing."]
    );
    assert_eq!(
        differences(&[("{\"nll\":100.5}", "{\"nll\":100.5,\"nis\":0.1}")]),
        ["other objectives: b has `nll`, `nis`; a has `nll`."]
    );
    assert!(
        differences(&[("p.toml", "other.toml"), ("\"pso\"", "\"pio\"")]).is_empty(),
        "another model is what one compares"
    );
}

/// One drops the time column, so that its log has other numbers.
#[test]
fn models_of_one_log_may_use_other_columns_of_it() {
    let log = |all: &str, z: &str, truth: &str| {
        format!("\"sha256\":\"{all}\",\"measurements_sha256\":\"{z}\",\"truth_sha256\":\"{truth}\"")
    };
    let comparable = |changes: &[(&str, &str)], b: &str| {
        let of = |path: &str, log: &str| run(path, &[&[("\"sha256\":\"ab\"", log)], changes].concat());
        Comparison::of(vec![of("a", &log("1", "z", "t")), of("b", b)]).unwrap().comparable
    };
    assert!(comparable(&[], &log("2", "z", "t")));
    assert!(comparable(&[], &log("2", "z", "another")), "nll needs no truth");
    let rmse = [("{\"nll\":100.5}", "{\"rmse\":1.5}")];
    assert!(comparable(&rmse, &log("2", "z", "t")) && !comparable(&rmse, &log("2", "z", "another")));
    assert!(!comparable(&[], &log("2", "another", "t")));
    assert!(!comparable(&[], &log("2", "", "")), "a result of an older version says less");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let rmse = run("b", &[("{\"nll\":100.5}", "{\"rmse\":1.5}")]);
    assert_eq!(
        Comparison::of(vec![run("a", &[]), rmse]).unwrap_err().to_string(),
        "b has `rmse` and a has `nll`: they share no objective, so there is nothing to compare"
    );
    assert_eq!(Comparison::of(vec![run("a", &[])]).unwrap_err(), CompareError::TooFew { count: 1 });
    let refused = |text: &str| Run::read(text, "a", "a/result.json").unwrap_err().to_string();
    assert_eq!(
        refused(&text(&[("{\"r\":2.5,\"q\":1.25}", "null")])),
        "a/result.json: the run found no usable candidate, so there is nothing to compare (leave it out)"
    );
    assert!(
        refused("{\"problem\":").starts_with("a/result.json:1:11: is not a result of `kfgpu tune`: EOF"),
        "{}",
        refused("{")
    );
    let missing = refused("{}");
    assert_eq!(
        missing,
        "a/result.json:1:2: is not a result of `kfgpu tune`: missing field `problem` (name a folder that `tune --out` wrote, or run the study again)"
    );
    assert!(refused(&text(&[("\"seed\":7", "\"seed\":-7")])).contains(":2:9: "), "{}", refused(&text(&[("7", "-7")])));
}

#[test]
fn results_without_checksums_are_told_apart_by_their_size() {
    let none = |path: &str, changes: &[(&str, &str)]| run(path, &[&[(",\"sha256\":\"ab\"", "")], changes].concat());
    let of = |changes: &[(&str, &str)]| Comparison::of(vec![none("a", &[]), none("b", changes)]).unwrap().comparable;
    assert!(of(&[]), "the same size");
    assert!(!of(&[("\"rows\":60", "\"rows\":61")]), "another size");
}
