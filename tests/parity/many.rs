//! Many short trajectories: neither time nor memory grows faster than their number.

use crate::case::{Case, INNOVATIONS, Text};
use crate::logs::{Gap, Shape};
use crate::promise::{double, single, unequal_status, worst};
use crate::{build, evaluate};
use kfgpu::evaluate::Precision;

const MANY: &[usize] = &[2; 50_000];

fn case(x0: &'static str, lengths: &'static [usize]) -> Case {
    let model =
        format!("kind = \"constant-velocity\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = {x0}\nP0 = [10, \"q\"]");
    let text = Text { model: &model, objectives: INNOVATIONS, ..Text::BASIC };
    // A start from a measurement needs one in every trajectory.
    let gaps: &[Gap] = if x0.starts_with('[') { &[Gap::Components(0.1)] } else { &[] };
    Case::new(x0, &text, Shape::regular(lengths).without(gaps).from(3.0), 2)
}

/// Once quadratic: a minute for each of the traces, and 30 million intervals.
#[test]
fn fifty_thousand_trajectories_are_traced_and_scored() {
    for x0 in ["[0, 0]", "\"measurement\""] {
        let case = case(x0, MANY);
        let costs = case.reference();
        assert!(costs.iter().all(Result::is_ok), "{x0}: the reference scores it");
        for (precision, promise) in [(Precision::F64, double as fn(&Case, _, f64) -> f64), (Precision::F32, single)] {
            let found = evaluate(&case, precision);
            assert_eq!(unequal_status(&case, &costs, &found), Vec::<String>::new());
            let error = worst(&case, &costs, &found, promise);
            assert!(error < 1.0, "{x0} in {precision}: {error:.2e} times the promise");
        }
    }
}

#[test]
fn what_a_candidate_takes_does_not_grow_with_the_trajectories() {
    let [few, many] = [&[2; 3][..], MANY].map(|lengths| {
        let evaluator = build(&case("[0, 0]", lengths), Precision::F64).unwrap();
        (evaluator.program().spans().len(), evaluator.program().folded())
    });
    assert_eq!(few.1, many.1, "numbers a candidate, of {} and of {} trajectories", few.0, many.0);
}
