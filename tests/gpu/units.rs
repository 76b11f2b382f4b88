//! The kernel in other units.

use crate::family::{FAMILIES, OBJECTIVES, Unit, candidates, log};
use crate::{adapter, adapter_with_f64, options};
use kfgpu::evaluate::gpu::GpuEvaluator;
use kfgpu::evaluate::{Evaluation, Evaluator, Precision, Status};

fn same_bits(adapter: &str, precision: Precision) {
    for family in &FAMILIES {
        let evaluate = |exponent: i32| -> Evaluation {
            let unit = Unit::of(2.0_f64.powi(exponent));
            let mut evaluator =
                GpuEvaluator::new(&family.problem(unit), &log(unit), &options(adapter, precision)).unwrap();
            let found = evaluator.evaluate(&candidates());
            assert_eq!(evaluator.failure(), None, "{}: the GPU itself computed this", family.name);
            found
        };
        let expected = evaluate(0);
        for exponent in [-200, -40, 40, 200] {
            let found = evaluate(exponent);
            for i in 0..expected.len() {
                let what = format!("{}, {precision}, 2^{exponent}, candidate {i}", family.name);
                assert_eq!(found.status(i), Status::OK, "{what}");
                let costs = OBJECTIVES.iter().zip(found.costs(i).iter().zip(expected.costs(i)));
                for ((name, power), (found, expected)) in costs.skip(1) {
                    assert_eq!(*found, expected * 2.0_f64.powi(exponent * power), "{what}: {name}");
                }
            }
        }
    }
}

#[test]
fn powers_of_two_change_no_bit_in_f32() {
    let Some(adapter) = adapter() else { return };
    same_bits(&adapter, Precision::F32);
}

#[test]
fn powers_of_two_change_no_bit_in_f64() {
    let Some(adapter) = adapter_with_f64() else { return };
    same_bits(&adapter, Precision::F64);
}
