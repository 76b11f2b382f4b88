//! The tuned problem file, and candidates taken from one.

use proptest::prelude::*;

use crate::model::{Problem, Value};

const TEXT: &str = r#"# A story.
[data]
file = "log.csv"   # the log
measurements = ["z1", "z2"]

[model]
kind = "random-walk"
q = ["qa", "qb"]
R = { factor = "M", form = "lower" }
x0 = "measurement"
P0 = [1, 1]

[parameters]
# Process noise.
qa = { min = 0.01, max = 10, scale = "log", start = 1 }  # start from experience
M = { init = [0, 3], start = 2, unit = "m" }
M21 = 0.5        # fixed

[parameters.qb]
min = 0          # none at all
max = 1
"#;

fn problem() -> Problem {
    Problem::parse(TEXT, "p.toml").unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn elements_follow_and_one_declared_by_itself_is_its_own() {
    let parameters = problem().parameters;
    let names: Vec<&str> = parameters.all.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["qa", "M21", "qb", "M11", "M22"], "the template is none");
    assert_eq!(parameters.names(), ["qa", "qb", "M11", "M22"]);
    assert_eq!(parameters.all[1].value, Value::Fixed(0.5));
    assert_eq!(parameters.all[3].unit.as_deref(), Some("m"));
    assert_eq!(parameters.baseline(), [1.0, 0.5, 2.0, 2.0]);
}

#[test]
fn the_users_text_is_kept_and_only_starts_change() {
    let tuned = problem().tuned(&[0.125, 1e-7, 1.5, -2.5]);
    let expected = TEXT
        .replace("start = 1 }", "start = 0.125 }")
        .replace(
            "M21 = 0.5        # fixed\n",
            "M21 = 0.5        # fixed\nM11 = { init = [0.0, 3.0], start = 1.5, unit = \"m\" }\nM22 = { init = [0.0, 3.0], start = -2.5, unit = \"m\" }\n",
        )
        .replace("max = 1\n", "max = 1\nstart = 1e-7\n");
    assert_eq!(tuned, expected);
}

#[test]
fn a_tuned_file_for_another_folder_finds_the_log() {
    let tuned = problem().tuned_with_file(&[0.125, 0.25, 1.5, -2.5], "../data/log.csv");
    assert!(tuned.contains("file = \"../data/log.csv\"   # the log\n"), "{tuned}");
    assert_eq!(Problem::parse(&tuned, "t.toml").unwrap().data.file.as_deref(), Some("../data/log.csv"));
}

#[test]
fn a_file_of_another_problem_is_refused() {
    let other = Problem::parse(&TEXT.replace("qb", "qc"), "other.toml").unwrap();
    let message = problem().candidate_from(&other).unwrap_err().to_string();
    assert_eq!(message, "other.toml: the parameter `qb`, which p.toml searches, is not in this file");
    let other = Problem::parse(&TEXT.replace("max = 1\n", "max = 9\nstart = 8\n"), "other.toml").unwrap();
    let message = problem().candidate_from(&other).unwrap_err().to_string();
    assert_eq!(message, "other.toml: `qb` is 8: p.toml expects a number from 0 to 1");
}

proptest! {
    #[test]
    fn a_winner_comes_back_to_the_bit(
        a in 0.01..10.0f64, b in 0.0..1.0f64, c in 1e-12..1e12f64, d in 1e-12..1e12f64, sign in any::<bool>(),
    ) {
        let winner = [a, b, c, if sign { d } else { -d }];
        let again = Problem::parse(&problem().tuned(&winner), "tuned.toml");
        let again = again.map_err(|e| TestCaseError::fail(e.to_string()))?;
        let back = problem().candidate_from(&again).map_err(|e| TestCaseError::fail(e.to_string()))?;
        prop_assert_eq!(back.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), winner.map(f64::to_bits).to_vec());
    }
}

#[test]
fn a_factor_that_rounds_to_a_singular_matrix_is_still_read() {
    let text = TEXT.replace("M21 = 0.5        # fixed", "M21 = 1e9\nM11 = 1\nM22 = 1e-3");
    assert!(Problem::parse(&text, "p.toml").is_ok(), "R = M M' is a covariance by construction");
}
