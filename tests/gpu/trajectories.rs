//! Many short trajectories: what comes back at a time does not grow with their number.

use crate::case::{Case, INNOVATIONS, Text};
use crate::logs::{Gap, Shape};
use crate::promise::{single, worst};
use crate::{adapter, gpu, options};
use kfgpu::evaluate::{Evaluator, Precision};

/// Starts that differ from trajectory to trajectory and from candidate to candidate, and long ones among the short.
#[test]
fn fifty_thousand_trajectories_come_back_in_rounds() {
    const LENGTHS: &[usize] = &{
        let mut lengths = [2; 50_000];
        (lengths[7], lengths[40_000]) = (9000, 0);
        lengths
    };
    let Some(adapter) = adapter() else { return };
    let text = Text {
        model: "kind = \"constant-velocity\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [\"q\", \"r\"]\nP0 = [10, \"q\"]",
        objectives: INNOVATIONS,
        ..Text::BASIC
    };
    let case = Case::new("50,000 trajectories", &text, Shape::regular(LENGTHS).without(&[Gap::Components(0.1)]), 3);
    let mut evaluator = gpu(&case, &options(&adapter, Precision::F32));
    let found = evaluator.evaluate(&case.population);
    assert_eq!(evaluator.failure(), None, "the GPU itself computed this");
    let error = worst(&case, &case.reference(), &found, single);
    println!("{}: {error:.1e} of the promise", case.name);
    assert!(error < 1.0, "{error:.2e} times the promise");
}
