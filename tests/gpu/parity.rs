//! The whole registry: models, objectives and log shapes, 257 candidates in the main ones.

use crate::case::{Case, Costs, Double, Single};
use crate::promise::{double, misplaced, single, unequal_status, worst};
use crate::{adapter, adapter_with_f64, cases, cpu, gpu, options};
use kfgpu::evaluate::gpu::{GpuError, GpuEvaluator};
use kfgpu::evaluate::{BuildError, Evaluator, Precision};
use kfgpu::objective::Kind;
use rayon::prelude::*;
use std::sync::OnceLock;

/// The GPU may be this many times as far from the reference as the CPU in the same precision, where that is more than
/// the promise.
const SLACK: f64 = 4.0;

fn with_costs() -> &'static [(Case, Costs)] {
    static CASES: OnceLock<Vec<(Case, Costs)>> = OnceLock::new();
    CASES.get_or_init(|| {
        let with_costs = |case: Case| {
            let costs = case.reference();
            (case, costs)
        };
        cases::all().into_par_iter().map(with_costs).collect()
    })
}

/// What is wrong with a case on the adapter, in sentences.
fn judge(
    (case, costs): &(Case, Costs),
    adapter: &str,
    precision: Precision,
    promise: fn(&Case, Kind, f64) -> f64,
    promised: bool,
) -> Vec<String> {
    let mut evaluator = gpu(case, &options(adapter, precision));
    let found = evaluator.evaluate(&case.population);
    assert_eq!(evaluator.failure(), None, "{}: the GPU itself computed this", case.name);
    let lanes = cpu(case, precision).evaluate(&case.population);
    let (error, lanes_error) = (worst(case, costs, &found, promise), worst(case, costs, &lanes, promise));
    let turned = misplaced(case, costs, &found, promise);
    let name = &case.name;
    println!("{name:60} {precision} {error:.1e} of the promise, lanes {lanes_error:.1e}, {turned} pairs misplaced");
    let mut wrong = Vec::new();
    if !(error <= 1.0 || error <= SLACK * lanes_error) {
        wrong.push(format!("{name}: {error:.2e} times the promise, the lanes {lanes_error:.2e}"));
    }
    if promised {
        wrong.extend((turned > 0).then(|| format!("{name}: {turned} pairs misplaced")));
        wrong.extend(unequal_status(case, costs, &found));
        let unequal = (0..found.len()).filter(|i| found.status(*i) != lanes.status(*i));
        let sentence = |i| format!("{name}: candidate {i}: {:?}, the lanes {:?}", found.status(i), lanes.status(i));
        wrong.extend(unequal.map(sentence));
    }
    wrong
}

#[test]
fn f32_is_as_good_as_on_the_cpu_for_every_model_objective_and_log() {
    let Some(adapter) = adapter() else { return };
    let cases: Vec<_> = with_costs().iter().filter(|(case, _)| case.single != Single::Refused).collect();
    assert!(cases.len() > 100, "only {} cases judged", cases.len());
    let judge =
        |case: &&(Case, Costs)| judge(case, &adapter, Precision::F32, single, case.0.single == Single::Promised);
    let wrong: Vec<String> = cases.iter().flat_map(judge).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn f64_is_as_good_as_on_the_cpu() {
    let Some(adapter) = adapter_with_f64() else { return };
    let (mut judged, mut wrong) = (0, Vec::new());
    let cases = with_costs().iter().step_by(4);
    let all = cases.len();
    for case in cases {
        match GpuEvaluator::new(&case.0.problem, &case.0.log, &options(&adapter, Precision::F64)) {
            // Said clearly; the CPU is there for these.
            Err(GpuError::Wgsl(_)) => continue,
            _ => judged += 1,
        }
        wrong.extend(judge(case, &adapter, Precision::F64, double, case.0.double == Double::Promised));
    }
    println!("{judged} of {all} cases in f64");
    assert!(judged > all / 2, "only {judged} of {all} cases judged: WGSL lacks a function for a few of them");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_single_precision_cannot_hold_is_refused() {
    let Some(adapter) = adapter() else { return };
    for (case, _) in with_costs().iter().filter(|(case, _)| case.single == Single::Refused) {
        let error = GpuEvaluator::new(&case.problem, &case.log, &options(&adapter, Precision::F32)).err();
        let asks = matches!(error, Some(GpuError::Build(BuildError::Trace(ref error))) if error.needs_f64());
        assert!(asks, "{}: {error:?}, not a request for f64", case.name);
    }
}

/// What a kernel leaves in its buffers is not found there by the next population.
#[test]
fn a_second_evaluation_gives_the_same_bits() {
    let Some(adapter) = adapter() else { return };
    for name in ["rocket", "uav_gps_cv"] {
        let (case, _) = with_costs().iter().find(|(case, _)| case.name == name).unwrap();
        let mut evaluator = gpu(case, &options(&adapter, Precision::F32));
        let first = evaluator.evaluate(&case.population);
        assert_eq!(first, evaluator.evaluate(&case.population), "{name}");
        assert_eq!(evaluator.failure(), None, "{name}: the GPU itself computed this");
    }
}
