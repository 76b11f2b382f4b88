//! `kfgpu tune` with several objectives, and with constraints.

use serde_json::Value;

use crate::command::{Finished, Folder, LEVEL};

/// The local level with another objective beside nll, which pulls the other way: a log too short for both.
fn run(folder: &Folder, more: &[&str]) -> Finished {
    let arguments = [&["tune", "problem.toml", "--objectives", "nll,mse_innovation", "--json"], more].concat();
    folder.run(&arguments)
}

fn marks(point: &Value) -> Vec<&str> {
    point["marks"].as_array().unwrap().iter().map(|mark| mark.as_str().unwrap()).collect()
}

fn marked<'a>(front: &'a [Value], mark: &str) -> &'a Value {
    let found: Vec<&Value> = front.iter().filter(|point| marks(point).contains(&mark)).collect();
    assert_eq!(found.len(), 1, "one member is {mark}");
    found[0]
}

#[test]
fn several_objectives_give_a_front_with_a_recommended_member() {
    let folder = Folder::with_level();
    // The level names an algorithm; without one, several objectives take nsga2.
    folder.write("problem.toml", LEVEL.replace("algorithm = \"pso\"\n", ""));
    let json = run(&folder, &["--out", "out"]).expect(0).json();
    assert_eq!(json["algorithm"], "nsga2");
    let front = json["front"].as_array().unwrap();
    assert!(front.len() > 2, "{} members", front.len());
    let recommended = marked(front, "recommended");
    assert_eq!(json["parameters"], recommended["parameters"]);
    assert_eq!(json["objectives"], recommended["objectives"]);
    for name in ["nll", "mse_innovation"] {
        let value = |point: &Value| point["objectives"][name].as_f64().unwrap();
        let best = value(marked(front, &format!("best {name}")));
        assert!(front.iter().all(|point| value(point) >= best), "{name}");
        assert_eq!(json["front_summary"]["best"][name].as_f64(), Some(best));
        let given_up = json["front_summary"]["given_up"][name].as_f64().unwrap();
        // The zero of nll is a matter of units: nats, not a share of it.
        let unit = if name == "nll" { 1.0 } else { best.abs() };
        assert!((given_up - (value(recommended) - best) / unit).abs() < 1e-12, "{name}: {given_up}");
        let reference = json["front_summary"]["reference_point"][name].as_f64().unwrap();
        assert!(reference > best, "{name}: {reference}");
    }
    assert!(json["polish"]["starts"] == 3 && json["converged"].is_null(), "both ends and the knee: {json}");
    assert!(json["feasible"] == true && json["constraints"] == Value::Array(vec![]));
    assert_eq!(
        folder.names("out"),
        ["checkpoint.kfgpu", "figures", "front.csv", "history.csv", "report.md", "result.json", "tuned.toml"]
    );
    let table = folder.read("out/front.csv");
    assert_eq!(table.lines().next(), Some("q,r,nll,mse_innovation,nis_mean,marks"));
    assert_eq!(table.lines().count(), front.len() + 1);
    let row: Vec<f64> = table.lines().nth(1).unwrap().split(',').take(4).map(|cell| cell.parse().unwrap()).collect();
    assert_eq!(Some(row[2]), front[0]["objectives"]["nll"].as_f64());
    let history = folder.read("out/history.csv");
    let cells: Vec<&str> = history.lines().last().unwrap().split(',').collect();
    let header: Vec<&str> = history.lines().next().unwrap().split(',').collect();
    let cell = |name: &str| cells[header.iter().position(|h| *h == name).unwrap()].parse::<f64>().unwrap();
    assert!(cell("hypervolume") > 0.0 && cell("front") >= 1.0);
    assert_eq!(json["front_summary"]["hypervolume"].as_f64(), Some(cell("hypervolume")));
    let again = folder.run(&["filter", "out/tuned.toml", "--json", "--quiet"]).expect(0).json();
    assert_eq!(again["objectives"]["nll"], json["objectives"]["nll"], "tuned.toml runs and is the recommended member");
}

/// A knee knows costs alone; what is recommended has a mean NIS in its band where any member has, and dominates the start
/// where any of those does.
#[test]
fn the_recommended_knee_is_consistent_where_one_is() {
    let folder = Folder::with_level();
    let json = run(&folder, &["--algorithm", "nsga2", "--out", "out"]).expect(0).json();
    let front = json["front"].as_array().unwrap();
    let (recommended, knee) = (marked(front, "recommended"), marked(front, "knee"));
    let consistent = front.iter().filter(|point| point["consistent"] == true).count();
    assert!(consistent > 0 && consistent < front.len(), "{consistent} of {}", front.len());
    assert_eq!(json["front_summary"]["consistent"], consistent);
    assert!(recommended["consistent"] == true && !knee.is_null(), "{recommended} {knee}");
    assert_eq!(json["front_summary"]["among"], "consistent_and_dominating");
    assert_eq!(
        (&json["parameters"], &json["consistency"]["nis_mean"]),
        (&recommended["parameters"], &recommended["nis_mean"])
    );
    let found = json["certificate"]["objectives_f64"]["nll"].as_f64();
    assert_eq!(found, recommended["objectives"]["nll"].as_f64(), "the certificate is of what is recommended");
    for name in ["nll", "mse_innovation"] {
        let value = |of: &Value| of["objectives"][name].as_f64().unwrap();
        assert!(value(recommended) <= value(&json["baseline"]), "{name}");
    }
}

#[test]
fn the_text_report_names_what_is_given_up() {
    let folder = Folder::with_level();
    let arguments = ["tune", "problem.toml", "--algorithm", "nsga2", "--objectives", "nll,mse_innovation"];
    let text = folder.run(&arguments).expect(0).stdout;
    for part in [
        "Front, in-sample, f64 (",
        "recommended",
        "best nll",
        "Recommended: ",
        "above its best",
        "the baseline (as good in every objective",
    ] {
        assert!(text.contains(part), "{part:?} in:\n{text}");
    }
    let rows = text.split("Front, ").nth(1).unwrap().split("\n\n").next().unwrap().lines().count();
    assert!(rows <= 12, "{rows} lines of members");
}

#[test]
fn any_member_can_be_picked() {
    let folder = Folder::with_level();
    let picked = |pick: &str| run(&folder, &["--algorithm", "random", "--pick", pick]).expect(0).json();
    let value = |json: &Value, name: &str| json["objectives"][name].as_f64().unwrap();
    let [nll, mse] = ["nll", "mse_innovation"].map(&picked);
    assert_eq!(
        [&nll, &mse].map(|json| json["front_summary"]["pick"].as_str().unwrap()),
        ["best nll", "best mse_innovation"]
    );
    assert!(value(&nll, "nll") < value(&mse, "nll") && value(&nll, "mse_innovation") > value(&mse, "mse_innovation"));
    let weighted = picked("nll=1,mse_innovation=0");
    assert_eq!(weighted["front_summary"]["pick"], "weights");
    assert_eq!(value(&weighted, "nll"), value(&nll, "nll"));
    for (pick, sentence) in [
        ("rmse", "--pick rmse: `tune.pick` names the objective `rmse`, which does not exist"),
        ("nll=0", "--pick nll=0: `tune.pick.weights`: no objective has a weight above 0"),
        ("nll=-1", "--pick nll=-1: `tune.pick.weights.nll` is -1: expected a weight from 0"),
        ("nll=much", "--pick nll=much: `tune.pick.weights.nll`: expected a number, found the string \"much\""),
        ("rmse=1", "--pick rmse=1: `tune.pick.weights` names the objective `rmse`, which does not exist"),
    ] {
        let refusal = run(&folder, &["--algorithm", "random", "--pick", pick]).refusal();
        assert!(refusal.starts_with(sentence), "{refusal}");
    }
}

#[test]
fn the_front_is_scored_on_held_out_rows() {
    let folder = Folder::with_level();
    let json = run(&folder, &["--algorithm", "nsga2", "--validate", "0.3", "--out", "out"]).expect(0).json();
    let front = json["front"].as_array().unwrap();
    let recommended = marked(front, "recommended");
    assert_eq!(recommended["held_out"], json["validation"]["winner"], "scored alike");
    assert!(front.iter().all(|point| point["held_out"]["nll"].is_f64()), "{front:?}");
    let base = ["tune", "problem.toml", "--objectives", "nll,mse_innovation", "--algorithm", "nsga2"];
    let text = folder.run(&[&base[..], &["--validate", "0.3"]].concat()).expect(0).stdout;
    assert!(text.contains("Front, training rows beside held-out rows, f64 ("), "{text}");
    assert!(text.contains("nll, training") && text.contains("nll, held out"), "{text}");
    let table = folder.read("out/front.csv");
    assert!(
        table.starts_with("q,r,nll,mse_innovation,held_out.nll,held_out.mse_innovation,nis_mean,marks\n"),
        "{table}"
    );
}

#[test]
fn a_constraint_is_kept_and_shown() {
    let folder = Folder::with_level();
    let tune = |more: &[&str]| folder.run(&[&["tune", "problem.toml", "--json"], more].concat());
    // The optimum of this log has an nis_mean of about 1; a bound well below takes the winner elsewhere.
    let free = tune(&[]).expect(0).json();
    let bound = "nis_mean <= 0.5";
    for algorithm in ["pso", "pio", "random", "nsga2"] {
        let json = tune(&["--constraint", bound, "--algorithm", algorithm]).expect(0).json();
        let check = &json["constraints"][0];
        assert_eq!(
            (&check["measure"], &check["relation"], &check["limit"]),
            (&"nis_mean".into(), &"<=".into(), &0.5.into())
        );
        assert!(check["value"].as_f64().unwrap() <= 0.5 && check["met"] == true && json["feasible"] == true, "{check}");
        let nll = |json: &Value| json["objectives"]["nll"].as_f64().unwrap();
        assert!(nll(&json) > nll(&free), "{algorithm}: a bound costs something");
    }
    let both =
        tune(&["--constraint", bound, "--constraint", "mse_innovation>=1", "--precision", "f32"]).expect(0).json();
    assert_eq!(both["constraints"].as_array().unwrap().len(), 2);
    let text = folder.run(&["tune", "problem.toml", "--constraint", bound]).expect(0).stdout;
    assert!(text.contains("nis_mean <= 0.5") && text.contains("met"), "{text}");
}

#[test]
fn a_constraint_is_held_against_held_out_rows_too() {
    let folder = Folder::with_level();
    let base = ["tune", "problem.toml", "--validate", "0.3", "--out", "out", "--constraint"];
    let json = folder.run(&[&base[..], &["nis_mean <= 0.5", "--json"]].concat()).expect(0).json();
    let (train, held_out) = (&json["constraints"][0], &json["validation"]["constraints"][0]);
    // By itself: the mean NIS of the tuned filter in the rows from 42 on.
    folder.run(&["filter", "out/tuned.toml", "--out", "run.csv"]).expect(0);
    let run = folder.read("run.csv");
    let mut rows = run.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = rows.next().unwrap().iter().position(|name| *name == "nis").expect("a column of NIS");
    let nis: Vec<f64> = rows.skip(42).map(|row| row[column].parse().unwrap()).collect();
    let mean = nis.iter().sum::<f64>() / nis.len() as f64;
    assert_eq!(nis.len(), 18);
    assert!((held_out["value"].as_f64().unwrap() - mean).abs() < 1e-9, "{held_out}: {mean}");
    assert!(train["met"] == true && train["value"] != held_out["value"], "{train}");
    assert_eq!(held_out["met"], mean <= 0.5);
}

#[test]
fn a_constraint_missed_on_held_out_rows_is_said() {
    let folder = Folder::with_level();
    // The noise grows tenfold in the rows held out.
    let log = (0..60).fold("t,z\n".to_owned(), |text, k| {
        let noise = (f64::from(k * 7919 % 13) - 6.0) * if k < 40 { 0.2 } else { 2.0 };
        format!("{text}{k},{noise:.4}\n")
    });
    folder.write("log.csv", log);
    let tune = ["tune", "problem.toml", "--validate", "0.33", "--constraint", "nis_mean <= 1.5", "--out", "out"];
    let finished = folder.run(&tune).expect(0);
    let text = finished.stdout;
    assert!(text.contains("constraint, f64") && text.contains("held out") && text.contains("not met"), "{text}");
    assert!(
        finished.stderr.contains("warning: on held-out data the tuned filter has nis_mean "),
        "{}",
        finished.stderr
    );
    let report = folder.read("out/report.md");
    for line in ["| nis\\_mean <= 1.5 | training | ", "|  | held out | ", "| not met |"] {
        assert!(report.contains(line), "{line:?} in {report}");
    }
}

#[test]
fn a_constraint_that_nothing_meets_ends_with_1_and_says_so() {
    let folder = Folder::with_level();
    for more in [&[][..], &["--objectives", "nll,mse_innovation", "--algorithm", "nsga2"]] {
        let base = ["tune", "problem.toml", "--json", "--out", "out", "--constraint", "nis_mean <= -1"];
        let finished = folder.run(&[&base[..], more].concat()).expect(1);
        let said = "error: no candidate meets every constraint; the one that violates them least has nis_mean ";
        assert!(finished.stderr.contains(said), "{}", finished.stderr);
        let json = finished.json();
        assert!(
            json["feasible"] == false && json["constraints"][0]["met"] == false && json["front"].is_null(),
            "{json}"
        );
        assert_eq!(folder.names("out"), crate::command::RUN_FILES);
    }
}

#[test]
fn mistakes_in_flags_are_refused_with_the_flag() {
    let folder = Folder::with_level();
    let refusal = |more: &[&str]| folder.run(&[&["tune", "problem.toml"], more].concat()).refusal();
    for (bound, sentence) in [
        ("nis_mean < 1.2", "`tune.constraints[1]` is `<`: expected <= or >= between the name and the limit"),
        (
            "nis_men <= 1.2",
            "`tune.constraints[1]` names the measure `nis_men`, which does not exist: did you mean `nis_mean`?",
        ),
        ("rmse <= 5", "`tune.constraints[1]`: the constraint on `rmse` needs the true states"),
    ] {
        let said = refusal(&["--constraint", bound]);
        assert!(said.starts_with(&format!("--constraint '{bound}': {sentence}")), "{said}");
    }
    let said = refusal(&["--objectives", "nll,mse_innovation", "--algorithm", "pso"]);
    assert!(said.contains("minimises one objective, received 2") && said.contains("nsga2"), "{said}");
    let said = refusal(&["--objectives", "nll,rmse"]);
    assert!(
        said.starts_with("--objectives nll,rmse: `tune.objectives[2]`: the objective `rmse` needs the true states"),
        "{said}"
    );
    let said = refusal(&["--objectives", "nll,nll"]);
    assert!(said.contains("the objective `nll` is listed twice"), "{said}");
}

#[test]
fn nsga2_takes_one_objective_and_odd_populations() {
    let folder = Folder::with_level();
    let finished =
        folder.run(&["tune", "problem.toml", "--json", "--algorithm", "nsga2", "--population", "7"]).expect(0);
    assert!(
        finished.stderr.contains("nsga2 searches for a front, and of one objective there is none"),
        "{}",
        finished.stderr
    );
    let json = finished.json();
    assert!(json["front"].is_null() && json["polish"].is_object(), "{json}");
    assert_eq!(json["evaluations"], 77);
}

#[test]
fn evaluate_shows_violations() {
    let folder = Folder::with_level();
    folder.write("candidates.csv", "q,r\n1,50\n1,0.01\n");
    let plain = folder.run(&["evaluate", "problem.toml", "candidates.csv", "--quiet"]).expect(0).table();
    let bounded =
        LEVEL.replace("objectives = [\"nll\"]", "objectives = [\"nll\"]\nconstraints = [\"nis_mean <= 1.2\"]");
    folder.write("problem.toml", bounded);
    let table = folder.run(&["evaluate", "problem.toml", "candidates.csv", "--quiet"]).expect(0).table();
    assert_eq!(table[0], ["nll", "violation", "status"]);
    assert_eq!((&table[1][0], &table[2][0]), (&plain[1][0], &plain[2][0]), "a constraint changes no cost");
    let violation = |row: &[String]| row[1].parse::<f64>().unwrap();
    assert!(violation(&table[1]) == 0.0 && violation(&table[2]) > 1.0, "{table:?}");
    let json = folder.run(&["evaluate", "problem.toml", "candidates.csv", "--quiet", "--json"]).expect(0).json();
    assert_eq!(json["violation"][0], 0.0);
}

#[test]
fn a_front_resumes_to_the_same_bits() {
    let folder = Folder::with_level();
    let whole = run(&folder, &["--algorithm", "random", "--checkpoint", "whole.kfgpu"]).expect(0).json();
    run(&folder, &["--algorithm", "random", "--checkpoint", "part.kfgpu", "--evaluations", "64"]).expect(0);
    let resumed = run(&folder, &["--algorithm", "random", "--resume", "part.kfgpu"]).expect(0).json();
    assert_eq!((&resumed["front"], &resumed["front_summary"]), (&whole["front"], &whole["front_summary"]));
}

/// NIS at half of what it should be costs likelihood, so the winner has a higher nll than the start that breaks the bound.
#[test]
fn what_meets_a_constraint_is_not_called_worse_for_its_cost() {
    let folder = Folder::with_level();
    folder.run(&["tune", "problem.toml", "--out", "best"]).expect(0);
    let arguments = ["tune", "best/tuned.toml", "--json", "--out", "out", "--constraint", "nis_mean <= 0.5"];
    let json = folder.run(&arguments).expect(0).json();
    let check = &json["constraints"][0];
    assert!(check["met"] == true && check["baseline"].as_f64() > Some(0.5), "{check}");
    assert!(json["objectives"]["nll"].as_f64() > json["baseline"]["objectives"]["nll"].as_f64(), "{json}");
    let report = folder.read("out/report.md");
    assert!(report.contains("**The tuned parameters meet every constraint, which yours do not"), "{report}");
}

/// The start is the best in one objective, so whatever is recommended beside it is a trade.
#[test]
fn a_trade_is_not_called_better() {
    let folder = Folder::with_level();
    folder.run(&["tune", "problem.toml", "--out", "best"]).expect(0);
    let arguments = ["tune", "best/tuned.toml", "--algorithm", "nsga2", "--objectives", "nll,nis", "--out", "out"];
    folder.run(&[&arguments[..], &["--pick", "nis"]].concat()).expect(0);
    let report = folder.read("out/report.md");
    let trade = "**The tuned parameters are better than yours under `nis` and worse under `nll`";
    assert!(report.contains(trade), "{report}");
}
