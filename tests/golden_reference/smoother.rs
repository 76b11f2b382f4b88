//! The smoother against three computations that share nothing with it: the conditional distribution of every state
//! given all measurements, from one Gaussian of all of them; the recursion of Rauch, Tung and Striebel as published, of
//! adaptive filters too; and for diffuse starts the inverse of the information matrix of all states together.

use kfgpu::data::Log;
use kfgpu::model::family::{Fuzzy, SageHusa, SageHusaR};
use kfgpu::model::{Expr, FilterKind, First, Problem};
use kfgpu::reference::{Estimate, Smoothed, run, smooth};
use nalgebra::{DMatrix, DVector};

use super::joint::{Draws, Joint, draw_log, model};
use super::support::{Linear, log, matrix, scalars, trajectory, vector};

fn smoothed(model: &Linear, log: &Log) -> Vec<Smoothed> {
    smooth(&model.problem(), log, &[]).expect("runs").remove(0)
}

/// Largest |found - expected| in units of the largest number of `expected` (or of 1).
fn error(found: &Estimate, x: &DVector<f64>, p: &DMatrix<f64>) -> f64 {
    let relative = |difference: f64, size: f64| difference / size.max(1.0);
    relative((&found.x - x).amax(), x.amax()).max(relative((&found.p - p).amax(), p.amax()))
}

/// The random models, made harder one by one.
fn variant(case: u64, mut model: Linear) -> (&'static str, Linear) {
    let n = model.q.nrows();
    let name = match case % 7 {
        0 => "as drawn",
        1 => {
            model.q.fill(0.0);
            "Q = 0"
        }
        2 => {
            let direction = model.q.column(0).into_owned();
            model.q = &direction * direction.transpose();
            "Q of rank 1"
        }
        3 => {
            model.p0.fill(0.0);
            "an exact x0: every predicted P is singular at first"
        }
        4 => {
            model.f.row_mut(0).fill(0.0);
            model.drift = Some(DMatrix::zeros(n, n));
            model.q.row_mut(0).fill(0.0);
            model.q.column_mut(0).fill(0.0);
            "F singular, and a state that the transition sets to 0"
        }
        5 => {
            model.first = First::Predict { dt: Some(0.7) };
            "predict first"
        }
        _ => {
            model.start = None;
            "x0 from the first complete measurement"
        }
    };
    (name, model)
}

#[test]
fn smoothed_states_are_conditional_on_all_measurements() {
    let mut worst = 0.0f64;
    for case in 0..420 {
        let mut draws = Draws(case);
        let pick = |case: u64, of: u64| usize::try_from(case % of).expect("small");
        let inputs = if case % 7 == 5 { 0 } else { pick(case / 6, 3) };
        let (n, m, rows) = (1 + pick(case, 3), 1 + pick(case / 3, 2), 1 + pick(case / 7, 6));
        let (name, model) = variant(case, model(&mut draws, n, m, inputs));
        let log = draw_log(&mut draws, &model, rows);
        let t = &log.trajectories[0];
        if model.start.is_none() && !(0..t.len()).any(|k| t.is_complete(k)) {
            assert!(smoothed(&model, &log).is_empty(), "case {case}: nothing to start from");
            continue;
        }
        let (joint, found) = (Joint::of(&model, t), smoothed(&model, &log));
        assert_eq!(found.iter().map(|s| s.row).collect::<Vec<_>>(), joint.rows, "case {case}, {name}: rows");
        for (i, Smoothed { row, estimate, .. }) in found.iter().enumerate() {
            let (x, p) = joint.conditional(i);
            let error = error(estimate, &x, &p);
            assert!(error < 1e-9, "case {case}, {name}, row {row}: {error:.1e}\n{estimate:?}\nexpected {x} {p}");
            worst = worst.max(error);
        }
    }
    println!("largest relative error of smoothed means and covariances over 420 random logs: {worst:.1e}");
}

/// x + C (xs - x'), P + C (Ps - P') C' with C = P F' P'^-1, as printed; it asks the filter what it predicted and needs
/// neither Q nor R.
fn rauch_tung_striebel(model: &Linear, filter: &FilterKind, log: &Log) -> Vec<Estimate> {
    let problem = Problem { filter: filter.clone(), ..model.problem() };
    let steps = run(&problem, log, &[]).expect("runs").trajectories.remove(0);
    let t = &log.trajectories[0];
    let mut next = steps[steps.len() - 1].posterior.clone();
    let mut all = vec![next.clone()];
    for pair in steps.windows(2).rev() {
        let [now, after] = pair else { unreachable!("windows of two") };
        let dt = t.dt(now.row).expect("a row follows");
        let f = model.drift.as_ref().map_or_else(|| model.f.clone(), |drift| &model.f + dt * drift);
        let c = &now.posterior.p * f.transpose() * after.prior.p.clone().try_inverse().expect("Q is positive definite");
        let x = &now.posterior.x + &c * (next.x - &after.prior.x);
        let p = &now.posterior.p + &c * (next.p - &after.prior.p) * c.transpose();
        next = Estimate { x, p };
        all.push(next.clone());
    }
    all.reverse();
    all
}

#[test]
fn long_logs_agree_with_the_recursion_as_published() {
    let mut worst = 0.0f64;
    for case in 0..12 {
        let mut draws = Draws(1_000 + case);
        let n = 1 + usize::try_from(case % 4).expect("small");
        let mut model = model(&mut draws, n, 2, 1);
        // Stable over 300 rows of any interval.
        model.f = draws.matrix(n, n) * (0.9 / n as f64);
        model.drift = Some(DMatrix::zeros(n, n));
        let log = draw_log(&mut draws, &model, 300);
        let steps = run(&model.problem(), &log, &[]).expect("runs").trajectories.remove(0);
        let found = smoothed(&model, &log);
        assert_eq!(found[299].estimate, steps[299].posterior, "nothing follows the last row");
        for ((step, found), expected) in
            steps.iter().zip(&found).zip(rauch_tung_striebel(&model, &FilterKind::default(), &log))
        {
            let error = error(&found.estimate, &expected.x, &expected.p);
            assert!(error < 1e-10, "case {case}, row {}: {error:.1e}", step.row);
            worst = worst.max(error);
            let gains = &step.posterior.p - &found.estimate.p;
            let least = gains.symmetric_eigen().eigenvalues.min();
            assert!(least > -1e-12, "case {case}, row {}: smoothing loses {least:e}", step.row);
        }
    }
    println!("largest difference from the published recursion over 12 logs of 300 rows: {worst:.1e}");
}

/// With missing values, irregular intervals, inputs, and every way to start.
#[test]
fn adaptive_filters_are_smoothed_with_the_noise_they_used() {
    let setting = Expr::number;
    let kinds = [
        FilterKind::SageHusa(SageHusa { forgetting: setting(0.9) }),
        FilterKind::SageHusaR(SageHusaR { forgetting: setting(0.9), floor: setting(0.05) }),
        FilterKind::Fuzzy(Fuzzy { window: 3, gain: setting(0.3), width: setting(0.5) }),
    ];
    let mut worst = [0.0f64; 3];
    for case in 0..36 {
        let mut draws = Draws(2_000 + case);
        let pick = |case: u64, of: u64| usize::try_from(case % of).expect("small");
        let n = 1 + pick(case, 3);
        let mut model = model(&mut draws, n, 1 + pick(case / 3, 2), if case % 6 == 5 { 0 } else { 1 });
        model.f = draws.matrix(n, n) * (0.9 / n as f64);
        model.drift = Some(DMatrix::zeros(n, n));
        model.r = DMatrix::from_diagonal(&model.r.diagonal());
        model.first = if case % 6 == 5 { First::Predict { dt: Some(0.7) } } else { First::Update };
        model.start = model.start.filter(|_| case % 6 != 4);
        let log = draw_log(&mut draws, &model, 40);
        let plain = smoothed(&model, &log);
        for (kind, worst) in kinds.iter().zip(&mut worst) {
            let problem = Problem { filter: kind.clone(), ..model.problem() };
            let found = smooth(&problem, &log, &[]).expect("runs").remove(0);
            let expected = rauch_tung_striebel(&model, kind, &log);
            assert_eq!(found.len(), expected.len(), "case {case}, {kind:?}");
            assert_ne!(found, plain, "case {case}, {kind:?}: it adapts");
            for (found, expected) in found.iter().zip(&expected) {
                *worst = worst.max(error(&found.estimate, &expected.x, &expected.p));
            }
        }
    }
    println!("largest difference from the published recursion, by kind, over 36 logs of 40 rows: {worst:?}");
    assert!(worst.iter().all(|worst| *worst < 1e-10), "{worst:?}");
}

/// Constant velocity with unit R and a diffuse P0: mean and covariance by the information matrix of all states
/// together, which a diffuse P0 does not harm.
fn by_information(model: &Linear, log: &Log) -> Vec<Estimate> {
    let (n, rows) = (model.f.nrows(), log.trajectories[0].len());
    let inverse = |p: &DMatrix<f64>| p.clone().try_inverse().expect("positive definite");
    let (q, r) = (inverse(&model.q), inverse(&model.r));
    let (mut information, mut vector) = (DMatrix::zeros(n * rows, n * rows), DVector::zeros(n * rows));
    let mut first = information.view_mut((0, 0), (n, n));
    first += inverse(&model.p0);
    for k in 0..rows {
        let z = DVector::from_column_slice(log.trajectories[0].z.row(k));
        if !z.iter().any(|z| z.is_nan()) {
            let mut here = information.view_mut((n * k, n * k), (n, n));
            here += model.h.transpose() * &r * &model.h;
            let mut here = vector.rows_mut(n * k, n);
            here += model.h.transpose() * &r * z;
        }
        if k + 1 < rows {
            let mut difference = DMatrix::zeros(n, 2 * n);
            difference.columns_mut(0, n).copy_from(&-&model.f);
            difference.columns_mut(n, n).copy_from(&DMatrix::identity(n, n));
            let mut here = information.view_mut((n * k, n * k), (2 * n, 2 * n));
            here += difference.transpose() * &q * &difference;
        }
    }
    let covariance = information.try_inverse().expect("positive definite");
    let x = &covariance * vector;
    let of = |k: usize| Estimate { x: x.rows(n * k, n).into(), p: covariance.view((n * k, n * k), (n, n)).into() };
    (0..rows).map(of).collect()
}

#[test]
fn a_diffuse_start_costs_known_digits() {
    for (p0, tolerance) in [(1e4, 4e-11), (1e8, 2e-7), (1e12, 4e-4)] {
        let model = Linear {
            f: matrix([[1.0, 1.0], [0.0, 1.0]]),
            b: DMatrix::zeros(2, 0),
            q: matrix([[0.01 / 3.0, 0.005], [0.005, 0.01]]),
            h: matrix([[1.0, 0.0]]),
            start: Some(vector([0.0, 0.0])),
            p0: matrix([[p0, 0.0], [0.0, p0]]),
            ..Linear::level(0.0, 1.0, 1.0)
        };
        let mut draws = Draws(3);
        let z: Vec<f64> =
            (0..60).map(|k| if k == 1 { f64::NAN } else { 5.0 * draws.number() + f64::from(k) }).collect();
        let log = log(vec![scalars(&z)]);
        let (found, expected) = (smoothed(&model, &log), by_information(&model, &log));
        let worst = found.iter().zip(&expected).map(|(f, e)| error(&f.estimate, &e.x, &e.p)).fold(0.0, f64::max);
        println!("P0/R = {p0:e}: largest error of the smoother {worst:.1e}");
        assert!(worst < tolerance, "P0/R = {p0:e}: {worst:e}");
        assert!(found.iter().all(|s| s.estimate.p.diagonal().iter().all(|v| *v >= 0.0)), "no variance is negative");
    }
}

/// Nothing drives the states, so every row is x0 seen through F^k. One mode decays to 1e-18: predicted covariances are
/// singular to rounding, where the published recursion with a pseudo-inverse was measured to be wrong by 2e-2.
#[test]
fn decaying_modes_without_noise_are_smoothed() {
    let turn = matrix([[1.0, 0.4], [-0.3, 1.0]]);
    for (modes, tolerance) in [([1.0, 1.0], 1e-13), ([1.0, 0.5], 1e-13), ([0.9, 0.2], 1e-13), ([1.05, 0.6], 1e-10)] {
        let back = turn.clone().try_inverse().expect("invertible");
        let model = Linear {
            f: &turn * DMatrix::from_diagonal(&vector(modes)) * back,
            b: DMatrix::zeros(2, 0),
            q: DMatrix::zeros(2, 2),
            h: matrix([[1.0, 0.2]]),
            start: Some(vector([0.0, 0.0])),
            p0: matrix([[4.0, 1.0], [1.0, 3.0]]),
            drift: Some(DMatrix::zeros(2, 2)),
            ..Linear::level(0.0, 1.0, 1.0)
        };
        let mut draws = Draws(4);
        let z: Vec<f64> = (0..60).map(|_| 2.0 + draws.number()).collect();
        let log = log(vec![scalars(&z)]);
        let joint = Joint::of(&model, &log.trajectories[0]);
        let errors = smoothed(&model, &log).into_iter().enumerate().map(|(k, found)| {
            let (x, p) = joint.conditional(k);
            error(&found.estimate, &x, &p)
        });
        let worst = errors.fold(0.0, f64::max);
        println!("modes {modes:?}: largest error of the smoother {worst:.1e}");
        assert!(worst < tolerance, "modes {modes:?}: {worst:e}");
    }
}

#[test]
fn trajectories_are_smoothed_apart_and_failures_have_a_place() {
    let model = Linear::level(1.0, 1.0, 4.0);
    let one = || trajectory(&[(0.0, &[1.0]), (1.0, &[f64::NAN]), (2.5, &[4.0])]);
    let two = scalars(&[-3.0, 9.0]);
    let problem = model.problem();
    let apart = smooth(&problem, &log(vec![one()]), &[]).expect("runs");
    let together = smooth(&problem, &log(vec![two, one()]), &[]).expect("runs");
    assert_eq!(apart[0], together[1], "what stands beside a trajectory changes nothing");
    // Row 1 lies between x = 0.8 with P = 0.8 and the measurement 4 with 1 + 1: by hand, 0.8 + 1.8 (3.2 / 3.8).
    assert!((apart[0][1].estimate.x[0] - (0.8 + 1.8 * 3.2 / 3.8)).abs() < 1e-14, "{:?}", apart[0][1]);
    let failing = Linear::level(1.0, -9.0, 4.0).problem();
    let failure = smooth(&failing, &log(vec![one()]), &[]).expect_err("S is negative");
    assert_eq!((failure.trajectory, failure.row), (0, 0), "{failure}");
}
