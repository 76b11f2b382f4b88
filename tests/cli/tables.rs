//! Curves in formulas and names for formulas, through the verbs.

use crate::command::{Folder, LEVEL};

/// The local level with R from a curve of r, by way of a name.
fn folder() -> Folder {
    let folder = Folder::with_level();
    std::fs::create_dir(folder.path("tables")).unwrap();
    folder.write("tables/c.csv", "r,R\n0,0\n10,5\n100,200\n");
    let named = "\n[model.let]\nnoise = \"table('tables/c.csv', r) + 0.1\"\n\n[parameters]";
    folder.write("problem.toml", LEVEL.replace("z = \"r\"", "z = \"noise\"").replace("\n[parameters]", named));
    folder
}

const TUNE: [&str; 6] = ["tune", "problem.toml", "--json", "--quiet", "--out", "out"];

#[test]
fn a_tuned_problem_finds_its_table() {
    let folder = folder();
    let json = folder.run(&TUNE).expect(0).json();
    assert_eq!(json["certificate"]["order_held"], true, "{json}");
    let tuned = folder.read("out/tuned.toml");
    assert!(tuned.contains("noise = 'table(\"../tables/c.csv\", r) + 0.1'"), "{tuned}");
    let again = folder.run(&["tune", "out/tuned.toml", "--json", "--quiet", "--generations", "0"]).expect(0).json();
    let nll = |json: &serde_json::Value| json["objectives"]["nll"].as_f64().unwrap();
    assert!((nll(&again["baseline"]) - nll(&json)).abs() < 1e-9, "{again}");
    folder.run(&["filter", "problem.toml", "--parameters", "out", "--quiet"]).expect(0);
}

#[test]
fn a_search_is_resumed_with_the_numbers_of_its_table_alone() {
    let folder = folder();
    let whole = folder.run(&TUNE).expect(0).json();
    let resumed = folder.run(&["tune", "--resume", "out", "--json", "--quiet"]).expect(0).json();
    assert_eq!(resumed["parameters"], whole["parameters"]);
    folder.write("tables/c.csv", "r,R\n0,0\n10,5\n100,201\n");
    let sentence = folder.run(&["tune", "--resume", "out", "--quiet"]).refusal();
    assert!(sentence.contains("it is of another problem than this"), "{sentence}");
    folder.write("tables/c.csv", "r,R\n0,0\n10,x\n");
    let sentence = folder.run(&["filter", "problem.toml"]).refusal();
    assert!(sentence.starts_with("problem.toml:17:16: tables/c.csv:3:4: expected a number, found \"x\""), "{sentence}");
}
