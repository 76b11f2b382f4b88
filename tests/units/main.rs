//! A filter does not depend on the units of its states and measurements: powers of two change no bit, others only what
//! decimal numbers round, and none the status, in either precision.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::float_cmp, reason = "the same bits are promised")]

mod family;

use family::{FAMILIES, Family, OBJECTIVES, Unit, candidates, log, updates};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Precision, Status};
use kfgpu::filter::Form;
use kfgpu::reference;
use std::f64::consts::LN_2;

const PRECISIONS: [Precision; 2] = [Precision::F64, Precision::F32];

fn build(family: &Family, unit: Unit, precision: Precision) -> CpuEvaluator {
    let options = CpuOptions { precision, threads: std::num::NonZero::new(1) };
    CpuEvaluator::new(&family.problem(unit), &log(unit), options).unwrap_or_else(|e| panic!("{}: {e}", family.name))
}

fn evaluate(family: &Family, unit: Unit, precision: Precision) -> Evaluation {
    build(family, unit, precision).evaluate(&candidates())
}

/// Costs in plain units, from those in `unit`.
fn plain(costs: &[f64], unit: f64, updates: f64) -> Vec<f64> {
    let costs = OBJECTIVES.iter().zip(costs);
    costs
        .map(|((name, power), cost)| if *name == "nll" { cost - updates * unit.ln() } else { cost / unit.powi(*power) })
        .collect()
}

#[test]
fn powers_of_two_change_no_bit() {
    for family in &FAMILIES {
        for precision in PRECISIONS {
            let expected = evaluate(family, Unit::of(1.0), precision);
            for exponent in [-240, -100, -30, -7, 9, 40, 100, 240] {
                let found = evaluate(family, Unit::of(2.0_f64.powi(exponent)), precision);
                for i in 0..expected.len() {
                    let what = format!("{}, {precision}, 2^{exponent}, candidate {i}", family.name);
                    assert_eq!((found.status(i), expected.status(i)), (Status::OK, Status::OK), "{what}");
                    for (((name, power), found), expected) in
                        OBJECTIVES.iter().zip(found.costs(i)).zip(expected.costs(i))
                    {
                        if *name == "nll" {
                            let constant = updates(family) * f64::from(exponent) * LN_2;
                            let error = (found - constant - expected).abs();
                            assert!(error <= 1e-14 * (constant.abs() + expected.abs()), "{what}: nll {found}");
                        } else {
                            assert_eq!(*found, expected * 2.0_f64.powi(exponent * power), "{what}: {name}");
                        }
                    }
                }
            }
        }
    }
}

/// Two states and the measurements, each in a unit of its own.
#[test]
fn states_and_measurements_have_units_of_their_own() {
    for family in FAMILIES.iter().filter(|family| !family.diffuse) {
        let expected = evaluate(family, Unit::of(1.0), Precision::F64);
        let single = evaluate(family, Unit::of(1.0), Precision::F32);
        for [a, b, m] in [[-300, 280, 5], [90, -90, -200], [0, 0, 130], [12, 3, -9]] {
            // `rmse` and `distance` add up states, so they need one unit for both.
            let unit = Unit { states: [a, b].map(|e| 2.0_f64.powi(e)), measurements: 2.0_f64.powi(m) };
            let compared = |name: &str| !["nll", "mse_innovation", "rmse", "distance"].contains(&name);
            // Units of their own are factors in sums, whose order may differ in the last bit.
            for (precision, expected, tolerance) in
                [(Precision::F64, &expected, 2e-15), (Precision::F32, &single, 3e-4)]
            {
                let found = evaluate(family, unit, precision);
                for i in 0..expected.len() {
                    let what = format!("{}, {precision}, 2^{:?}, candidate {i}", family.name, [a, b, m]);
                    assert_eq!(found.status(i), Status::OK, "{what}");
                    let costs = OBJECTIVES.iter().zip(found.costs(i).iter().zip(expected.costs(i)));
                    for ((name, _), (found, expected)) in costs.filter(|((name, _), _)| compared(name)) {
                        let error = (found - expected).abs();
                        // A measurement that starts a state passes through a pseudo-inverse, which rounds.
                        let rounding: f64 = if family.name.starts_with("x0") { 1e-11 } else { tolerance };
                        assert!(
                            error <= rounding.max(tolerance) * (1.0 + expected),
                            "{what}: {name} {found} for {expected}"
                        );
                    }
                    let constant = updates(family) * f64::from(m) * LN_2;
                    let error = (found.costs(i)[0] - constant - expected.costs(i)[0]).abs();
                    assert!(error <= 1e-5 * (constant.abs() + expected.costs(i)[0].abs()), "{what}: nll");
                }
            }
        }
    }
}

/// nA, nm and 1e10 money, and what f64 holds: against the reference in plain units.
#[test]
fn decimal_units_keep_the_promise() {
    for family in &FAMILIES {
        let problem = family.problem(Unit::of(1.0));
        let reference = candidates()
            .rows()
            .map(|c| reference::costs(&problem, &log(Unit::of(1.0)), c).unwrap())
            .collect::<Vec<_>>();
        for unit in [1e-30, 1e-20, 1e-12, 1e-9, 1e-6, 1e6, 1e10, 1e12, 1e30, 1e60] {
            // A full P in f64 loses digits to a diffuse start, in any units.
            let double = if family.diffuse { 1e-7 } else { 1e-9 };
            for (precision, promise) in [(Precision::F64, double), (Precision::F32, 1e-4)] {
                let found = evaluate(family, Unit::of(unit), precision);
                for (i, expected) in reference.iter().enumerate() {
                    assert_eq!(found.status(i), Status::OK, "{}, {precision}, {unit:e}, candidate {i}", family.name);
                    let plain = plain(found.costs(i), unit, updates(family));
                    for ((name, _), (found, expected)) in OBJECTIVES.iter().zip(plain.iter().zip(expected)) {
                        let bound = promise * (1.0 + expected.abs());
                        let what = format!("{}, {precision}, {unit:e}, candidate {i}", family.name);
                        assert!((found - expected).abs() <= bound, "{what}: {name} {found} for {expected}");
                    }
                }
            }
        }
    }
}

/// Only what leaves the range is put in other units, and one for all costs no operation.
#[test]
fn ordinary_units_stay_and_one_unit_for_all_is_free() {
    for family in &FAMILIES {
        for precision in PRECISIONS {
            let own = build(family, Unit::of(1.0), precision);
            assert!(own.program().units().are_own(), "{}, {precision}: {:?}", family.name, own.program().units());
            let form =
                if family.diffuse && precision == Precision::F32 { Form::Factored } else { own.program().form() };
            assert_eq!(own.program().form(), form, "{}", family.name);
            let tiny = build(family, Unit::of(2.0_f64.powi(-210)), precision);
            assert!(!tiny.program().units().are_own(), "{}, {precision}", family.name);
            let operations = |evaluator: &CpuEvaluator| evaluator.program().operations();
            assert_eq!(operations(&tiny), operations(&own), "{}, {precision}", family.name);
        }
    }
}
