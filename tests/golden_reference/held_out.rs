//! Held-out scores of every objective, against a scalar filter and scores written out here, row by row.

use kfgpu::data::{HeldOut, Log, SplitBy, ValidateSpec};
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{costs, costs_held_out};
use kfgpu::study::Split;
use std::f64::consts::TAU;

use super::support::{Linear, close, log, scalars, tune, with_truth};

const NAN: f64 = f64::NAN;
const Q: f64 = 0.25;
const R: f64 = 1.0;
const P0: f64 = 3.0;

/// One row of the scalar filter.
#[derive(Clone, Copy)]
struct Row {
    /// Innovation and its variance, where the row updates.
    update: Option<(f64, f64)>,
    /// Posterior error and variance, where truth is known.
    error: Option<(f64, f64)>,
    /// z less what was predicted five rows ahead: x stands still, so that it is the prior of four rows ago.
    ahead: Option<f64>,
}

/// x' = x + w, z = x + v, in scalars; `None` before a start from the measurement.
fn scalar_filter(z: &[f64], truth: &[f64], from_measurement: bool) -> Vec<Option<Row>> {
    let (mut x, mut p, mut started) = (0.0, P0, !from_measurement);
    let (mut rows, mut priors) = (Vec::new(), Vec::new());
    for (k, (&z, &truth)) in z.iter().zip(truth).enumerate() {
        let (mut update, mut ahead) = (None, None);
        if started {
            p += if k > 0 { Q } else { 0.0 };
            priors.push(x);
            if !z.is_nan() {
                ahead = priors.len().checked_sub(5).map(|at| z - priors[at]);
                let (nu, s) = (z - x, p + R);
                (x, p) = (x + p / s * nu, p * R / s);
                update = Some((nu, s));
            }
        } else if !z.is_nan() {
            (x, started) = (z, true);
        } else {
            rows.push(None);
            continue;
        }
        rows.push(Some(Row { update, error: (!truth.is_nan()).then_some((x - truth, p)), ahead }));
    }
    rows
}

/// The cost of an objective over chosen rows of each trajectory, by its definition.
fn by_definition(objective: &Objective, trajectories: &[Vec<Row>]) -> f64 {
    let count = |n: usize| f64::from(u32::try_from(n).expect("few"));
    let rows = || trajectories.iter().flatten();
    let updates: Vec<(f64, f64)> = rows().filter_map(|r| r.update).collect();
    let errors: Vec<(f64, f64)> = rows().filter_map(|r| r.error).collect();
    let mean = |values: Vec<f64>| values.iter().sum::<f64>() / count(values.len());
    match objective.kind {
        Kind::Nll => updates.iter().map(|(nu, s)| 0.5 * ((TAU * s).ln() + nu * nu / s)).sum(),
        Kind::MseInnovation => mean(updates.iter().map(|(nu, _)| nu * nu).collect()),
        Kind::Nis => (mean(updates.iter().map(|(nu, s)| nu * nu / s).collect()) - 1.0).abs(),
        Kind::NisDistribution => {
            let u: Vec<f64> = updates.iter().map(|(nu, s)| libm::erf(nu.abs() / (2.0 * s).sqrt())).collect();
            let square = |phi: fn(f64) -> f64| mean(u.iter().map(|u| phi(2.0 * u - 1.0)).collect()).powi(2);
            3.0 * square(|v| v)
                + 5.0 * square(|v| (3.0 * v * v - 1.0) / 2.0)
                + 7.0 * square(|v| (5.0 * v.powi(3) - 3.0 * v) / 2.0)
                + 9.0 * square(|v| (35.0 * v.powi(4) - 30.0 * v * v + 3.0) / 8.0)
        }
        Kind::Prediction => mean(rows().filter_map(|r| r.ahead).map(|e| e * e).collect()),
        Kind::Whiteness => {
            let series = |rows: &Vec<Row>| -> Vec<f64> {
                rows.iter().filter_map(|r| r.update).map(|(nu, s)| nu / s.sqrt()).collect()
            };
            let all: Vec<Vec<f64>> = trajectories.iter().map(series).collect();
            let sum = |lag: usize| -> f64 {
                all.iter().flat_map(|s| s.iter().zip(&s[lag.min(s.len())..])).map(|(a, b)| a * b).sum()
            };
            if all.iter().all(|s| s.len() < 2) {
                NAN
            } else {
                (1..=objective.lags).map(|lag| (sum(lag) / sum(0)).powi(2)).sum()
            }
        }
        Kind::Nees => (mean(errors.iter().map(|(e, p)| e * e / p).collect()) - 1.0).abs(),
        Kind::Rmse => mean(errors.iter().map(|(e, _)| e * e).collect()).sqrt(),
        Kind::Distance => errors.iter().map(|(e, _)| e.abs()).sum(),
        _ => {
            let of = |rows: &Vec<Row>| {
                let updates: Vec<(f64, f64)> = rows.iter().filter_map(|r| r.update).collect();
                let last = &updates[updates.len().saturating_sub(objective.window)..];
                let ct = if objective.ct_last { &last[last.len() - 1..] } else { last };
                let ratio =
                    mean(last.iter().map(|u| u.0 * u.0).collect()) / mean(ct.iter().map(|u| u.1).collect()) - 1.0;
                ratio.abs()
            };
            mean(trajectories.iter().filter(|rows| rows.iter().any(|r| r.update.is_some())).map(of).collect())
        }
    }
}

fn objectives() -> Vec<Objective> {
    let mut objectives: Vec<Objective> = Kind::ALL.iter().map(|(_, kind)| Objective::new(*kind)).collect();
    objectives.push(Objective { window: 2, ..Objective::new(Kind::Mismatch) });
    objectives.push(Objective { window: 2, ct_last: true, ..Objective::new(Kind::Mismatch) });
    let skipping = |skip| objectives.clone().into_iter().map(move |o| Objective { skip, ..o });
    // Before the held-out rows, inside them, and inside a held-out trajectory.
    let skipped: Vec<Objective> = skipping(1).chain(skipping(6)).collect();
    objectives.into_iter().chain(skipped).collect()
}

const Z: [&[f64]; 3] = [
    &[NAN, 1.0, 2.5, NAN, 2.0, 3.5, 3.0, NAN, 4.5, 2.0],
    &[0.5, NAN, -1.0, 0.3, 0.0, -2.0, 1.0, 1.5],
    &[2.0, 2.5, 3.0, NAN, 1.0, 0.0, 0.7, 0.1, 2.0],
];

fn truth(z: &[f64]) -> Vec<f64> {
    // Unknown now and then, in other rows than those without a measurement.
    (0u32..).zip(z).map(|(k, _)| if k % 4 == 1 { NAN } else { (f64::from(k) * 0.7).sin() + 1.0 }).collect()
}

fn logs() -> Log {
    let of = |z: &&[f64]| {
        let truth: Vec<[f64; 1]> = truth(z).into_iter().map(|t| [t]).collect();
        with_truth(scalars(z), &truth.iter().map(|t| t.as_slice()).collect::<Vec<_>>())
    };
    log(Z.iter().map(of).collect())
}

fn part(by: SplitBy, share: f64, from_measurement: bool) -> (Problem, Split) {
    let mut model = Linear::level(Q, R, P0);
    if from_measurement {
        model.start = None;
    }
    let mut problem = model.problem();
    problem.data.file = Some("log.csv".into());
    problem.data.validate = Some(ValidateSpec { share, by: Some(by) });
    let split = Split::of(&problem, logs()).unwrap_or_else(|e| panic!("{e}"));
    (problem, split)
}

/// The rows of trajectory `t` from row `from` on, those before `skip` left out.
fn rows(t: usize, from: usize, skip: usize, from_measurement: bool) -> Vec<Row> {
    let all = scalar_filter(Z[t], &truth(Z[t]), from_measurement);
    all.into_iter().enumerate().filter(|(k, _)| *k >= from.max(skip)).filter_map(|(_, row)| row).collect()
}

fn check(problem: &Problem, held_out: &HeldOut, expected: impl Fn(&Objective) -> f64) {
    for objective in objectives() {
        let mut problem = problem.clone();
        problem.tune = tune(vec![objective.clone()]);
        let found = costs_held_out(&problem, held_out, &[]).expect("the run succeeds")[0];
        alike(found, expected(&objective));
    }
}

/// The same number, or none in both: too few rows are left for some.
fn alike(found: f64, expected: f64) {
    if !(found.is_nan() && expected.is_nan()) {
        close(found, expected, 1e-13);
    }
}

#[test]
fn by_time_only_the_last_rows_of_each_trajectory_score() {
    for from_measurement in [false, true] {
        let (problem, split) = part(SplitBy::Time, 0.4, from_measurement);
        let held_out = split.held_out.expect("something is held out");
        // 0.4 of 10, 8 and 9 rows.
        assert_eq!(held_out.from, [6, 5, 5]);
        check(&problem, &held_out, |objective| {
            let trajectory = |t: usize| rows(t, held_out.from[t], objective.skip, from_measurement);
            by_definition(objective, &[0, 1, 2].map(trajectory))
        });
    }
}

#[test]
fn by_trajectory_whole_trajectories_score() {
    for from_measurement in [false, true] {
        let (problem, split) = part(SplitBy::Trajectory, 0.6, from_measurement);
        let held_out = split.held_out.expect("something is held out");
        // round(0.6 x 3) = 2 of three: numbers 2 and 3.
        assert_eq!((split.train.trajectories.len(), split.train.rows()), (1, Z[0].len()));
        check(&problem, &held_out, |objective| {
            by_definition(objective, &[1, 2].map(|t| rows(t, 0, objective.skip, from_measurement)))
        });
    }
}

#[test]
fn training_scores_are_those_of_the_rows_before() {
    let (mut problem, split) = part(SplitBy::Time, 0.4, true);
    let from = split.held_out.expect("something is held out").from;
    for objective in objectives().into_iter().filter(|o| o.skip < 2) {
        problem.tune = tune(vec![objective.clone()]);
        let found = costs(&problem, &split.train, &[]).expect("the run succeeds")[0];
        let before = |t: usize| {
            let all = scalar_filter(Z[t], &truth(Z[t]), true);
            all[objective.skip..from[t]].iter().filter_map(|row| *row).collect::<Vec<_>>()
        };
        alike(found, by_definition(&objective, &[0, 1, 2].map(before)));
    }
}
