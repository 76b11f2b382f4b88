//! Several trajectories in one dispatch: the same bits as one after the other, and far fewer dispatches.

use crate::case::{Case, INNOVATIONS, Text};
use crate::logs::{Gap, Shape};
use crate::promise::{single, worst};
use crate::{adapter, bits, gpu, options};
use kfgpu::evaluate::gpu::GpuOptions;
use kfgpu::evaluate::{Evaluator, Precision};

/// States that start alike for all candidates, and states that do not.
const VELOCITY: Text<'static> = Text {
    model: "kind = \"constant-velocity\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0, 0]\nP0 = [10, \"q\"]",
    objectives: INNOVATIONS,
    ..Text::BASIC
};

/// A start that differs from trajectory to trajectory.
const MEASURED: Text<'static> = Text {
    model: "kind = \"constant-velocity\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = \"measurement\"\nP0 = [10, \"q\"]",
    ..VELOCITY
};

const LEVEL: Text<'static> = Text {
    model: "kind = \"local-level\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\nP0 = [10]",
    ..Text::BASIC
};

const ADAPTIVE: Text<'static> = Text {
    filter: "kind = \"sage-husa-r\"\nforgetting = \"b\"\nfloor = 0.1",
    parameters: "q = { min = 0.01, max = 10, scale = \"log\", start = 0.3 }\n\
                 r = { min = 0.5, max = 20, scale = \"log\", start = 2 }\nb = { min = 0.9, max = 1, start = 0.98 }",
    ..LEVEL
};

/// Logs of every kind: one row, none, lengths that differ, one over several dispatches among short ones.
const SHAPES: [(&str, &[usize]); 4] = [
    ("one trajectory", &[70]),
    ("different lengths", &[40, 1, 0, 31, 65, 1, 200]),
    ("a long one among short ones", &[30, 9000, 1, 50, 4500, 20]),
    ("more than fit one dispatch", &[77; 150]),
];

fn cases() -> Vec<Case> {
    let texts = [("velocity", VELOCITY), ("level", LEVEL), ("adaptive", ADAPTIVE)];
    let shape = |lengths| Shape::regular(lengths).without(&[Gap::Components(0.1)]);
    let cases = texts.iter().flat_map(|(name, text)| {
        SHAPES.map(|(what, lengths)| Case::new(format!("{name}, {what}"), text, shape(lengths), 70))
    });
    let measured = Case::new("measured", &MEASURED, Shape::regular(&[60, 1, 90, 4200, 30]).from(100.0), 70);
    cases.chain([measured]).collect()
}

#[test]
fn trajectories_side_by_side_have_the_bits_of_one_after_the_other() {
    let Some(adapter) = adapter() else { return };
    for case in cases() {
        for precision in [Precision::F32, Precision::F64] {
            let grouped = |largest_group| {
                let options = GpuOptions { largest_group, ..options(&adapter, precision) };
                let mut evaluator = gpu(&case, &options);
                let found = bits(&evaluator.evaluate(&case.population));
                assert_eq!(evaluator.failure(), None, "{}: the GPU itself computed it", case.name);
                (found, evaluator.dispatches())
            };
            let (alone, dispatches) = grouped(Some(1));
            for largest in [Some(2), Some(7), None] {
                let (found, fewer) = grouped(largest);
                assert!(found == alone, "{} in {precision}: groups of up to {largest:?} change bits", case.name);
                assert!(fewer <= dispatches, "{}: {fewer} dispatches, one by one {dispatches}", case.name);
            }
        }
    }
}

#[test]
fn grouped_trajectories_keep_the_promise() {
    let Some(adapter) = adapter() else { return };
    for case in cases() {
        let found = gpu(&case, &options(&adapter, Precision::F32)).evaluate(&case.population);
        let error = worst(&case, &case.reference(), &found, single);
        println!("{}: {error:.1e} of the promise", case.name);
        assert!(error < 1.0, "{}: {error:.2e} times the promise", case.name);
    }
}

/// A row of z and its mask is one pack, so 53 trajectories of 77 rows fit the 4096 packs of a dispatch.
#[test]
fn short_trajectories_share_dispatches() {
    let Some(adapter) = adapter() else { return };
    let shape = Shape::regular(&[77; 150]).without(&[Gap::Components(0.1)]);
    let case = Case::new("dispatches", &Text { objectives: "[\"nll\"]", ..LEVEL }, shape, 3);
    let dispatches = |largest_group| {
        let options = GpuOptions { largest_group, ..options(&adapter, Precision::F32) };
        gpu(&case, &options).dispatches()
    };
    assert_eq!(dispatches(Some(1)), 150, "one by one");
    assert_eq!(dispatches(None), 150usize.div_ceil(4096 / 77), "as many as fit 4096 rows of one pack");
}
