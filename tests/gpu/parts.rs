//! Cutting in time and population, and the order of candidates, never change a bit.

use crate::case::{Case, INNOVATIONS, Text};
use crate::logs::{Gap, Shape};
use crate::promise::{single, worst};
use crate::{adapter, bits, gpu, options};
use kfgpu::evaluate::gpu::GpuOptions;
use kfgpu::evaluate::{Evaluator, Population, Precision};

const LEVEL: Text<'static> = Text {
    model: "kind = \"local-level\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\nP0 = [10]",
    ..Text::BASIC
};

const VELOCITY: Text<'static> = Text {
    model: "kind = \"constant-velocity\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0, 0]\nP0 = [10, \"q\"]",
    objectives: INNOVATIONS,
    ..Text::BASIC
};

/// More rows than a loop of Mesa's software renderer runs before it silently stops (65,535).
#[test]
fn seventy_thousand_rows_take_several_chunks() {
    let Some(adapter) = adapter() else { return };
    let case = Case::new("70,000 rows", &LEVEL, Shape::regular(&[70_000]).without(&[Gap::Components(0.1)]), 9);
    let costs = case.reference();
    for precision in [Precision::F32, Precision::F64] {
        let found = gpu(&case, &options(&adapter, precision)).evaluate(&case.population);
        let error = worst(&case, &costs, &found, single);
        println!("{} {precision}: {error:.1e} of the promise of f32", case.name);
        assert!(error < 1.0, "{precision}: {error:.2e} times the promise");
    }
}

/// What objectives remember waits between chunks, and starts anew with every trajectory.
#[test]
fn a_memory_goes_from_chunk_to_chunk() {
    let Some(adapter) = adapter() else { return };
    let two = "{ name = \"whiteness\", lags = 12 }, { name = \"prediction\", ahead = [1, 6] }";
    let shape = Shape::regular(&[40, 20_000, 30]).without(&[Gap::Components(0.1)]);
    // WGSL has no exp in f64, which the distribution of the NIS needs.
    for (precision, first) in [(Precision::F32, "\"nis_distribution\", "), (Precision::F64, "")] {
        let case =
            Case::new("memory over chunks", &Text { objectives: &format!("[{first}{two}]"), ..VELOCITY }, shape, 9);
        let found = gpu(&case, &options(&adapter, precision)).evaluate(&case.population);
        let error = worst(&case, &case.reference(), &found, single);
        println!("{} {precision}: {error:.1e} of the promise of f32", case.name);
        assert!(error < 1.0, "{precision}: {error:.2e} times the promise");
    }
}

/// Candidates of `case` at these places.
fn picked(case: &Case, places: impl Iterator<Item = usize>) -> Population {
    let values = places.flat_map(|i| case.population.row(i).to_vec()).collect();
    Population::from_rows(case.population.dimension(), values)
}

/// Several trajectories, initial states that differ from candidate to candidate, and a failing candidate in the middle.
fn pooled() -> Case {
    let mut case = Case::new("pooled", &VELOCITY, Shape::regular(&[40, 0, 31, 65]), 257);
    case.population.row_mut(100).copy_from_slice(&[-1.0, -1e9]);
    case
}

#[test]
fn parts_of_a_population_change_no_bit() {
    let Some(adapter) = adapter() else { return };
    let case = pooled();
    let whole = gpu(&case, &options(&adapter, Precision::F32)).evaluate(&case.population);
    for largest_part in [1, 64, 128, 200] {
        let options = GpuOptions { largest_part: Some(largest_part), ..options(&adapter, Precision::F32) };
        let found = gpu(&case, &options).evaluate(&case.population);
        assert_eq!(bits(&found), bits(&whole), "parts of {largest_part}");
    }
}

#[test]
fn one_evaluator_takes_populations_of_any_size_in_any_order() {
    let Some(adapter) = adapter() else { return };
    let case = pooled();
    let mut evaluator = gpu(&case, &options(&adapter, Precision::F32));
    let whole = bits(&evaluator.evaluate(&case.population));
    for size in [1, 63, 64, 65, 256, 257] {
        // A stride prime to 257 shuffles.
        let places: Vec<usize> = (0..size).map(|i| i * 89 % 257).collect();
        let found = bits(&evaluator.evaluate(&picked(&case, places.iter().copied())));
        let expected: Vec<_> = places.iter().map(|i| whole[*i].clone()).collect();
        assert_eq!(found, expected, "{size} candidates");
    }
    assert!(evaluator.evaluate(&Population::new(2)).is_empty(), "no candidates, no costs");
    assert_eq!(evaluator.failure(), None, "the GPU itself computed all of it");
}

#[test]
fn a_failing_candidate_fails_alone() {
    let Some(adapter) = adapter() else { return };
    let case = pooled();
    let found = gpu(&case, &options(&adapter, Precision::F32)).evaluate(&case.population);
    let failed: Vec<usize> = (0..257).filter(|i| !found.status(*i).is_ok()).collect();
    assert_eq!(failed, [100], "and no other");
    assert!(found.costs(100).iter().all(|cost| *cost == f64::MAX), "{:?}", found.costs(100));
}

/// A million candidates of a log in many chunks: more totals than one binding of a software adapter holds.
#[test]
fn a_population_over_the_binding_limit_is_cut_by_itself() {
    let Some(adapter) = adapter() else { return };
    let binding = kfgpu::evaluate::gpu::adapters().iter().find(|a| a.name == adapter).map_or(0, |a| a.max_binding);
    // 3 numbers a trajectory of one row each: sum, exponent, mantissa.
    let case = Case::new("many trajectories", &LEVEL_NLL, Shape::regular(&[2; 100]), 257);
    let candidates = usize::try_from((128 << 20) / (100 * 3 * 4)).unwrap() + 20_000;
    println!("{candidates} candidates, binding of {} MiB", binding >> 20);
    let mut evaluator = gpu(&case, &options(&adapter, Precision::F32));
    let whole = bits(&evaluator.evaluate(&case.population));
    let found = evaluator.evaluate(&picked(&case, (0..candidates).map(|i| i % 257)));
    assert_eq!(evaluator.failure(), None, "the GPU itself computed it");
    let found = bits(&found);
    assert!((0..candidates).all(|i| found[i] == whole[i % 257]), "the same candidate, the same bits");
}

const LEVEL_NLL: Text<'static> = Text { objectives: "[\"nll\"]", ..LEVEL };
