//! Robust updates by hand: weights and densities of a row, that the densities integrate to one, and what they come to at their
//! ends.
//!
//! Level: F = H = 1, P0 = R = 1, x0 = 0. A first row with z = 4 has S = 2, K = 1/2, NIS = 8.

use std::f64::consts::{PI, TAU};

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
use kfgpu::model::family::{Outliers, Robust};
use kfgpu::model::{Expr, Parameter, Scale, Search, Value};
use kfgpu::reference::{Step, run, smooth};

use super::support::{Linear, close, log, matrix, scalars, trajectory, vector};

const NAN: f64 = f64::NAN;

fn outliers(eps: f64, volume: &[f64]) -> Outliers {
    let volume = (!volume.is_empty()).then(|| volume.iter().map(|v| Expr::number(*v)).collect());
    Outliers { eps: Expr::number(eps), volume }
}

fn gate(gate: f64, limit: usize) -> Robust {
    Robust::Gate { gate: Expr::number(gate), limit, outliers: outliers(0.05, &[20.0]) }
}

fn correntropy(k: f64) -> Robust {
    Robust::Correntropy { k: Expr::number(k), outliers: outliers(0.05, &[20.0]) }
}

fn student(dof: f64) -> Robust {
    Robust::StudentT { dof: Expr::number(dof) }
}

fn huber(k: f64) -> Robust {
    Robust::Huber { k: Expr::number(k) }
}

/// The steps of a level with these measurements.
fn level(robust: &Robust, z: &[f64]) -> Vec<Step> {
    let mut problem = Linear::level(1.0, 1.0, 1.0).problem();
    problem.robust = Some(robust.clone());
    run(&problem, &log(vec![scalars(z)]), &[]).expect("runs").trajectories.remove(0)
}

/// x, P, nll and what is rejected after z = 4.
fn first(robust: &Robust) -> [f64; 4] {
    let step = &level(robust, &[4.0])[0];
    let update = step.update.as_ref().expect("measured");
    [step.posterior.x[0], step.posterior.p[(0, 0)], update.nll, update.rejected]
}

/// x = w K nu, P = P0 - w K S K'.
fn weighed(w: f64, nll: f64) -> [f64; 4] {
    [2.0 * w, 1.0 - 0.5 * w, nll, 1.0 - w]
}

fn equal(found: [f64; 4], expected: [f64; 4]) {
    found.iter().zip(expected).for_each(|(found, expected)| close(*found, expected, 1e-13));
}

#[test]
fn weights_and_densities_are_those_of_their_definitions() {
    let normal = (-4.0_f64).exp() / (2.0 * TAU).sqrt();
    let mixed = |eps: f64, volume: f64| -((1.0 - eps) * normal + eps / volume).ln();
    equal(first(&gate(9.0, 0)), weighed(1.0, mixed(0.05, 20.0)));
    equal(first(&gate(7.0, 0)), weighed(0.0, mixed(0.05, 20.0)));
    equal(first(&correntropy(2.0)), weighed((-1.0_f64).exp(), mixed(0.05, 20.0)));
    // t with v = 3, scale S (v - 2) / v = 2/3: G(2) / (G(3/2) sqrt(2 pi)) (1 + 16/2)^-2.
    let t = 1.0 / (PI.sqrt() / 2.0 * TAU.sqrt()) / 81.0;
    equal(first(&student(3.0)), weighed(4.0 / 11.0, -t.ln()));
    // d = sqrt 8, rho = d - 1/2.
    let c = TAU.sqrt() * 0.682_689_492_137_085_9 + 2.0 * (-0.5_f64).exp();
    let d = 8.0_f64.sqrt();
    equal(first(&huber(1.0)), weighed(1.0 / d, d - 0.5 + (2.0_f64.sqrt() * c).ln()));
    let (eps, volume) = (0.25, 10.0);
    let b = 0.75 * normal / (0.75 * normal + 0.025);
    let spread = b * (1.0 - b) * 4.0;
    let [x, p, nll, rejected] = weighed(b, mixed(eps, volume));
    equal(first(&Robust::Mixture(outliers(eps, &[volume]))), [x, p + spread, nll, rejected]);
}

/// V of a row is the product over what is there; without `volume` the range of the log, or what the log was told.
#[test]
fn the_volume_is_of_the_components_that_are_there() {
    let mut problem =
        Linear { h: matrix([[1.0], [1.0]]), r: matrix([[1.0, 0.0], [0.0, 1.0]]), ..Linear::level(1.0, 1.0, 1.0) };
    (problem.offset, problem.d) = (vector([0.0, 0.0]), nalgebra::DMatrix::zeros(2, 0));
    let mut problem = problem.problem();
    problem.robust = Some(Robust::Mixture(outliers(0.5, &[])));
    // So far off that only the outliers count: nll = ln (V / eps).
    let rows: [(f64, &[f64]); 3] = [(0.0, &[1e3, NAN]), (1.0, &[NAN, -1e3]), (2.0, &[2e3, 4e3])];
    let mut log = log(vec![trajectory(&rows)]);
    let nlls = |log: &Log| {
        let steps = run(&problem, log, &[]).expect("runs").trajectories.remove(0);
        steps.iter().map(|step| step.update.as_ref().expect("measured").nll).collect::<Vec<_>>()
    };
    for (ranges, expected) in [(None, [1e3, 5e3]), (Some(vec![7.0, 3.0]), [7.0, 3.0])] {
        log.ranges = ranges;
        let found = nlls(&log);
        let wanted = [expected[0], expected[1], expected[0] * expected[1]].map(|v: f64| (2.0 * v).ln());
        found.iter().zip(wanted).for_each(|(found, wanted)| close(*found, wanted, 1e-12));
    }
}

#[test]
fn a_gate_opens_after_as_many_rejections_as_it_is_told() {
    let weights = |limit| {
        let steps = level(&gate(1.0, limit), &[50.0, 60.0, NAN, 70.0, 80.0]);
        steps.iter().map(|s| s.update.as_ref().map_or(NAN, |u| 1.0 - u.rejected)).collect::<Vec<_>>()
    };
    let same = |found: Vec<f64>, expected: [f64; 5]| {
        assert!(
            found.iter().zip(expected).all(|(f, e)| f.to_bits() == e.to_bits() || f.is_nan() && e.is_nan()),
            "{found:?}"
        );
    };
    same(weights(0), [0.0, 0.0, NAN, 0.0, 0.0]);
    // A row without a measurement is not counted; after the row that updates, counting starts anew.
    same(weights(2), [0.0, 0.0, NAN, 1.0, 0.0]);
}

/// Midpoints of (-pi/2, pi/2), as z = tan u and dz / du: the whole line.
fn line(points: u32) -> impl Iterator<Item = (f64, f64)> {
    let step = PI / f64::from(points);
    (0..points).map(move |i| (f64::from(i) + 0.5) * step - PI / 2.0).map(move |u| (u.tan(), step / u.cos().powi(2)))
}

/// The same of a range around 0.
fn range(length: f64, points: u32) -> impl Iterator<Item = (f64, f64)> {
    let step = length / f64::from(points);
    (0..points).map(move |i| ((f64::from(i) + 0.5) * step - 0.5 * length, step))
}

/// Rows of one trajectory each, all with the same prior: the integral of exp(-nll) with these weights.
fn integral(robust: &Robust, linear: &Linear, grid: &[(Vec<f64>, f64)]) -> f64 {
    let mut problem = linear.problem();
    problem.robust = Some(robust.clone());
    let log = log(grid.iter().map(|(z, _)| trajectory(&[(0.0, z.as_slice())])).collect());
    let run = run(&problem, &log, &[]).expect("runs");
    let nll = |steps: &Vec<Step>| steps[0].update.as_ref().expect("measured").nll;
    // The code that searches scores the same.
    let total: f64 = run.trajectories.iter().map(nll).sum();
    let unused = Search { min: 0.0, max: 1.0, scale: Scale::Linear, init: [0.0, 1.0], start: None };
    let value = Value::Searched(unused);
    problem.parameters.all.push(Parameter { name: "unused".to_owned(), unit: None, value });
    let mut lanes = CpuEvaluator::new(&problem, &log, CpuOptions::default()).expect("traced");
    let found = lanes.evaluate(&Population::from_rows(1, vec![0.5])).costs(0)[0];
    assert!((found / total - 1.0).abs() < 1e-11, "{found} of {total}");
    run.trajectories.iter().zip(grid).map(|(steps, (_, weight))| weight * (-nll(steps)).exp()).sum()
}

#[test]
fn densities_integrate_to_one() {
    let one = Linear::level(1.0, 1.0, 1.0);
    let in_volume = |eps| Robust::Mixture(outliers(eps, &[40.0]));
    let whole: Vec<_> = line(4000).map(|(z, w)| (vec![z], w)).collect();
    let part: Vec<_> = range(40.0, 4000).map(|(z, w)| (vec![z], w)).collect();
    for (robust, grid) in [
        (in_volume(0.05), &part),
        (in_volume(0.9), &part),
        (gate(4.0, 0), &range(20.0, 4000).map(|(z, w)| (vec![z], w)).collect()),
        (student(2.5), &whole),
        (student(5.0), &whole),
        (huber(0.5), &whole),
        (huber(1.345), &whole),
    ] {
        close(integral(&robust, &one, grid), 1.0, 2e-6);
    }
    let two = Linear {
        h: matrix([[1.0], [0.5]]),
        r: matrix([[1.0, 0.3], [0.3, 2.0]]),
        d: nalgebra::DMatrix::zeros(2, 0),
        offset: vector([0.0, 0.0]),
        ..one
    };
    let square = |axis: Vec<(f64, f64)>| -> Vec<(Vec<f64>, f64)> {
        let row = |(a, v): &(f64, f64)| axis.iter().map(|(b, w)| (vec![*a, *b], v * w)).collect::<Vec<_>>();
        axis.iter().flat_map(row).collect()
    };
    let whole = square(line(160).collect());
    for robust in [student(4.0), huber(1.0), huber(2.0)] {
        close(integral(&robust, &two, &whole), 1.0, 1e-3);
    }
    let robust = Robust::Mixture(outliers(0.1, &[30.0, 30.0]));
    close(integral(&robust, &two, &square(range(30.0, 160).collect())), 1.0, 1e-6);
}

/// Three measurements are weighed one decorrelated scalar after the other; wide thresholds leave the plain filter, whatever the
/// kind, and so do outliers that are impossible.
#[test]
fn at_their_ends_kinds_are_the_plain_filter() {
    let linear = Linear {
        f: matrix([[1.0, 0.1], [0.0, 0.9]]),
        b: nalgebra::DMatrix::zeros(2, 0),
        q: matrix([[0.2, 0.0], [0.0, 0.3]]),
        h: matrix([[1.0, 0.0], [1.0, -0.5], [0.3, 1.0]]),
        d: nalgebra::DMatrix::zeros(3, 0),
        offset: vector([0.0, 0.1, 0.0]),
        r: matrix([[1.0, 0.4, 0.0], [0.4, 2.0, 0.3], [0.0, 0.3, 1.0]]),
        start: Some(vector([0.5, 0.0])),
        p0: matrix([[2.0, 0.5], [0.5, 1.0]]),
        ..Linear::level(1.0, 1.0, 1.0)
    };
    let rows: [(f64, &[f64]); 4] =
        [(0.0, &[1.0, 0.4, -2.0]), (1.0, &[NAN, 3.0, 1.0]), (2.0, &[NAN; 3]), (3.0, &[0.5, NAN, -1.5])];
    let (plain, log) = (linear.problem(), log(vec![trajectory(&rows)]));
    let steps = run(&plain, &log, &[]).expect("runs").trajectories.remove(0);
    for robust in
        [huber(1e3), student(1e5), correntropy(1e8), gate(1e9, 0), Robust::Mixture(outliers(1e-300, &[1.0, 1.0, 1.0]))]
    {
        let mut problem = plain.clone();
        let own = matches!(robust, Robust::Huber { .. } | Robust::StudentT { .. } | Robust::Mixture(_));
        let name = robust.name();
        // A t of 1e5 degrees of freedom is a gaussian but for as much; with more the gamma functions lose digits.
        let tolerance = if name == "student-t" { 1e-3 } else { 1e-7 };
        problem.robust = Some(match robust {
            Robust::Gate { gate, limit, .. } => Robust::Gate { gate, limit, outliers: outliers(0.05, &[]) },
            Robust::Correntropy { k, .. } => Robust::Correntropy { k, outliers: outliers(0.05, &[]) },
            other => other,
        });
        let found = run(&problem, &log, &[]).expect("runs").trajectories.remove(0);
        for (found, step) in found.iter().zip(&steps) {
            assert!((&found.posterior.x - &step.posterior.x).amax() < tolerance, "{name}: {found:?}");
            assert!((&found.posterior.p - &step.posterior.p).amax() < tolerance, "{name}: {found:?}");
            let (Some(found), Some(plain)) = (&found.update, &step.update) else { continue };
            assert!(!own || (found.nll - plain.nll).abs() < tolerance, "{name}: {} of {}", found.nll, plain.nll);
            assert!(found.rejected.abs() < tolerance, "{name}: {}", found.rejected);
        }
    }
}

/// Rauch, Tung and Striebel's recursion over what the filter predicted and estimated; the mixture is smoothed as a filter with
/// the same gains, whose P does not hold the spread of the two means.
#[test]
fn smoothed_states_are_those_of_the_recursion() {
    let z: Vec<f64> = (0..40).map(|k| f64::from(k % 7) * 0.4 + if k % 9 == 4 { 15.0 } else { 0.0 }).collect();
    let log = log(vec![scalars(&z)]);
    for robust in [huber(1.345), student(4.0), correntropy(2.0), gate(6.0, 0)] {
        let mut problem = Linear::level(0.3, 1.0, 1.0).problem();
        problem.robust = Some(robust.clone());
        let steps = run(&problem, &log, &[]).expect("runs").trajectories.remove(0);
        let found = smooth(&problem, &log, &[]).expect("smooths").remove(0);
        let (mut x, mut p) = (steps[39].posterior.x[0], steps[39].posterior.p[(0, 0)]);
        for k in (0..40).rev() {
            if let Some(after) = steps.get(k + 1) {
                let own = &steps[k].posterior;
                let gain = own.p[(0, 0)] / after.prior.p[(0, 0)];
                (x, p) = (
                    own.x[0] + gain * (x - after.prior.x[0]),
                    own.p[(0, 0)] + gain * (p - after.prior.p[(0, 0)]) * gain,
                );
            }
            close(found[k].estimate.x[0], x, 1e-11);
            close(found[k].estimate.p[(0, 0)], p, 1e-11);
        }
    }
}
