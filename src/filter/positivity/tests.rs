//! The checks against the rule on plain matrices, and what is proven without them.

use super::*;
use crate::data::{Log, Table, Trajectory};
use crate::model::is_covariance;
use crate::reference::Matrices;
use proptest::prelude::*;

fn problem(q: &str, r: &str, parameters: &str) -> Problem {
    let text = format!(
        "[data]\nfile = \"none.csv\"\nmeasurements = [\"z1\", \"z2\"]\n[model]\nstate = [\"x\", \"y\"]\nf = [\"x\", \"y\"]\n\
         h = [\"x\", \"y\"]\nQ = {q}\nR = {r}\nx0 = [0, 0]\nP0 = [1, 1]\n[parameters]\n{parameters}\n"
    );
    Problem::parse(&text, "positivity.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn positivity(problem: &Problem, time: &[f64]) -> Positivity {
    let rows = time.len();
    let mut trajectory = Trajectory {
        id: String::new(),
        line: vec![2; rows],
        time: time.to_vec(),
        z: Table::new(2),
        u: Table::new(0),
        truth: Table::new(0),
    };
    for _ in 0..rows {
        trajectory.z.push(&[0.0, 0.0]);
        trajectory.u.push(&[]);
        trajectory.truth.push(&[]);
    }
    let measurements = vec!["z1".to_owned(), "z2".to_owned()];
    let log = Log {
        times: crate::data::Times::default(),
        source: "none.csv".to_owned(),
        measurements,
        inputs: vec![],
        truth: vec![],
        trajectories: vec![trajectory],
        ..Log::default()
    };
    Positivity::new(problem, &Rows::new(problem, &log)).unwrap()
}

const TIME: [f64; 5] = [0.0, 1.0, 2.0, 4.5, 5.5];
const AB: &str =
    "a = { init = [0, 1], start = 0.5 }\nb = { init = [0, 1], start = 0.5 }\nc = { init = [0, 1], start = 0 }";

#[test]
fn what_the_form_proves_is_not_computed() {
    let chain = "[[\"a*dt^3/3\", \"a*dt^2/2\"], [\"a*dt^2/2\", \"a*dt + b/4\"]]";
    let proven = positivity(&problem(chain, "[\"b\", \"1 + c^2\"]", AB), &TIME);
    assert!(proven.proof.is_some(), "strengths times a chain of integrators");
    assert_eq!(proven.refused(&[0.1, 0.2, 5.0]), [0; 0]);
    assert_eq!(proven.refused(&[-0.1, 0.2, 5.0, 0.1, 0.2, -5.0, 0.1, 0.0, 1.0]), [0, 2], "the others are computed");
    let wrong = chain.replace("dt^2/2", "dt^2/2*1.2");
    let start =
        "a = { init = [0, 1], start = 0 }\nb = { init = [0, 1], start = 0.5 }\nc = { init = [0, 1], start = 0 }";
    let open = positivity(&problem(&wrong, "[\"b\", \"1 + c^2\"]", start), &TIME);
    assert!(open.proof.is_none(), "a shape that is no covariance");
    assert_eq!(open.refused(&[0.1, 0.001, 0.0, 0.0, 0.2, 0.0]), [0]);
}

#[test]
fn bounds_are_premises_and_not_facts() {
    let bounded = "a = { min = 1, max = 9 }\nb = { min = 0, max = 9 }\nc = { min = -1, max = 1, start = 0 }";
    let positivity = positivity(&problem("[\"b\", \"c^2\"]", "[\"a\", \"exp(c)\"]", bounded), &TIME);
    assert!(positivity.proof.is_some());
    assert_eq!(positivity.refused(&[1.0, 0.0, -1.0, -5.0, 1.0, 0.0, 2.0, -1e-9, 0.0, f64::NAN, 1.0, 0.0]), [1, 2, 3]);
}

#[test]
fn factors_may_be_singular() {
    let factor = "M = { min = -2, max = 2, start = 1 }";
    let positivity = positivity(&problem("[0.1, 0.1]", "{ factor = \"M\", form = \"lower\" }", factor), &TIME);
    assert_eq!(positivity.refused(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]), [0; 0]);
}

proptest! {
    /// Whatever is proven or computed, the verdict is that of the rule on the matrices that the reference evaluates.
    #[test]
    fn verdicts_are_those_of_the_rule(values in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 1..20), snap in 0usize..4) {
        let q = "[[\"a + b*dt\", \"c*dt\"], [\"c*dt\", \"b*dt^2\"]]";
        let problem = problem(q, "[[\"a\", \"c\"], [\"c\", \"b + 0.1\"]]", AB);
        let values: Vec<[f64; 3]> = values.iter().map(|v| v.map(|v| if v.abs() < 0.2 * snap as f64 { 0.0 } else { v })).collect();
        let found = positivity(&problem, &TIME).refused(values.as_flattened());
        let expected = values.iter().enumerate().filter(|(_, candidate)| {
            let matrices = [1.0, 2.5].map(|dt| Matrices::of(&problem, &candidate[..], dt));
            !is_covariance(&matrices[0].r, false) || matrices.iter().any(|m| !is_covariance(&m.q, true))
        });
        prop_assert_eq!(found, expected.map(|(i, _)| i).collect::<Vec<_>>());
    }
}
