//! Each rule of `docs/semantics.md` on a case small enough to compute by hand.
//!
//! The recurring case: local level, P0 = 3, R = 1, Q = 1/4, measurements 4 then 2, x0 = 0.
//! Row 0: S = 4, nu = 4, K = 3/4, x = 3, P = 3/4. Row 1: prior P = 1, S = 2, nu = -1, K = 1/2, x = 5/2, P = 1/2.

use std::f64::consts::TAU;

use kfgpu::model::First;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{Cause, run};
use nalgebra::{DMatrix, DVector};

use super::support::{Linear, close, cost, log, matrix, scalars, table, trajectory, vector, with_truth};

const NAN: f64 = f64::NAN;

fn level() -> Linear {
    Linear::level(0.25, 1.0, 3.0)
}

fn of(kind: Kind) -> Objective {
    Objective::new(kind)
}

#[test]
fn nll_is_the_total_with_two_pi() {
    let found = cost(&level().problem(), &log(vec![scalars(&[4.0, 2.0])]), of(Kind::Nll));
    let expected = 0.5 * (2.0 * TAU.ln() + 4f64.ln() + 2f64.ln() + 16.0 / 4.0 + 1.0 / 2.0);
    close(found, expected, 1e-14);
}

#[test]
fn mse_innovation_divides_by_present_components() {
    let problem = level().problem();
    close(cost(&problem, &log(vec![scalars(&[4.0, 2.0])]), of(Kind::MseInnovation)), (16.0 + 1.0) / 2.0, 1e-14);
    let with_gap = log(vec![scalars(&[4.0, NAN, 2.0])]);
    close(cost(&problem, &with_gap, of(Kind::MseInnovation)), (16.0 + 1.0) / 2.0, 1e-14);
}

#[test]
fn nis_is_the_distance_of_the_mean_from_one() {
    let (problem, log) = (level().problem(), log(vec![scalars(&[4.0, 2.0])]));
    close(run(&problem, &log, &[]).expect("runs").nis_mean(), (4.0 + 0.5) / 2.0, 1e-14);
    close(cost(&problem, &log, of(Kind::Nis)), 1.25, 1e-14);
}

/// With one component F(x) = erf(sqrt(x / 2)); with two F(x) = 1 - exp(-x / 2).
#[test]
fn nis_distribution_is_neymans_smooth_statistic() {
    let (problem, log) = (level().problem(), log(vec![scalars(&[4.0, NAN, 2.0])]));
    // NIS 4 and, after a row without a measurement, 1 / 2.25.
    let [first, second] = [0.954_499_736_103_641_6, 0.495_014_924_906_153_9];
    let legendre = |u: f64| {
        let v: f64 = 2.0 * u - 1.0;
        [
            3f64.sqrt() * v,
            5f64.sqrt() / 2.0 * (3.0 * v * v - 1.0),
            7f64.sqrt() / 2.0 * (5.0 * v.powi(3) - 3.0 * v),
            3.0 / 8.0 * (35.0 * v.powi(4) - 30.0 * v * v + 3.0),
        ]
    };
    let expected: f64 = legendre(first).iter().zip(legendre(second)).map(|(a, b)| ((a + b) / 2.0).powi(2)).sum();
    close(cost(&problem, &log, of(Kind::NisDistribution)), expected, 1e-13);
    let skipping = Objective { skip: 1, ..of(Kind::NisDistribution) };
    close(cost(&problem, &log, skipping), legendre(second).iter().map(|phi| phi * phi).sum(), 1e-13);
}

/// Standardised innovations, with the gap: 2; then P = 1.25, S = 2.25, nu = -1, K = 5/9, x = 22/9, P = 5/9; then P = 29/36,
/// S = 65/36, nu = -13/9.
#[test]
fn whiteness_sums_squared_autocorrelations_within_trajectories() {
    let problem = level().problem();
    let [a, b, c] = [2.0, -1.0 / 1.5, -13.0 / 9.0 / (65f64 / 36.0).sqrt()];
    let gap = [4.0, NAN, 2.0, 1.0];
    let whiteness = |lags, skip| Objective { lags, skip, ..of(Kind::Whiteness) };
    let power: f64 = a * a + b * b + c * c;
    let [first, second] = [(a * b + b * c) / power, a * c / power];
    let found = |lags, skip| cost(&problem, &log(vec![scalars(&gap)]), whiteness(lags, skip));
    close(found(1, 0), first * first, 1e-13);
    close(found(2, 0), first * first + second * second, 1e-13);
    close(found(10, 0), first * first + second * second, 1e-13);
    // Without the first value.
    close(found(10, 1), (b * c / (b * b + c * c)).powi(2), 1e-13);
    // A pair of the second trajectory joins, none between the two.
    let two = log(vec![scalars(&gap), scalars(&[4.0, NAN, 2.0])]);
    let power = power + a * a + b * b;
    let [first, second] = [(2.0 * a * b + b * c) / power, a * c / power];
    close(cost(&problem, &two, whiteness(10, 0)), first * first + second * second, 1e-13);
    let alone = cost(&problem, &log(vec![scalars(&[4.0]), scalars(&[2.0])]), whiteness(10, 0));
    assert!(alone.is_nan(), "no pair, no whiteness: {alone}");
}

/// x' = x / 2 + u, z = x: x0 = 0 and Q = 0, P0 = 3, R = 1. Row 0: nu = 4, K = 3/4, x = 3. Row 1: x = 3/2 + 1, P = 3/16; nothing
/// measured. Row 2: x = 5/4 - 1, P = 3/64, nu = 2 - 1/4, K = 3/67.
#[test]
fn prediction_compares_with_the_measurement_some_rows_later() {
    let model = Linear { f: matrix([[0.5]]), b: matrix([[1.0]]), d: matrix([[0.0]]), ..Linear::level(0.0, 1.0, 3.0) };
    let problem = model.problem();
    let mut driven = scalars(&[4.0, NAN, 2.0]);
    driven.u = table(&[&[1.0], &[-1.0], &[0.0]]);
    let three = log(vec![driven]);
    let ahead = |ahead: &[usize]| Objective { ahead: ahead.to_vec(), ..of(Kind::Prediction) };
    let found = |ahead: &[usize]| cost(&problem, &three, Objective { ahead: ahead.to_vec(), ..of(Kind::Prediction) });
    let one = (16.0 + 1.75 * 1.75) / 2.0;
    close(found(&[1]), one, 1e-14);
    // Of x1 = 0 / 2 + 1, which is where x0 leads, and 1 / 2 - 1.
    let three_ahead = 2.5 * 2.5;
    close(found(&[3]), three_ahead, 1e-14);
    // Two rows ahead of row 2 is the prior of row 1, 5/2: as good as the prior of row 2, for row 1 has no measurement.
    close(found(&[2]), 1.75 * 1.75, 1e-14);
    close(found(&[3, 1]), (three_ahead + one) / 2.0, 1e-14);
    close(cost(&problem, &three, Objective { skip: 1, ..ahead(&[1]) }), 1.75 * 1.75, 1e-14);
    assert!(found(&[4]).is_nan(), "no row has so many before it");
    // From the measurement: x = 4 at row 0, which is no prediction; row 2 is predicted from there as 4 -> 3 -> 1/2.
    let problem = Linear { start: None, ..model }.problem();
    close(cost(&problem, &three, ahead(&[2])), 1.5 * 1.5, 1e-14);
    assert!(cost(&problem, &three, ahead(&[3])).is_nan(), "nothing is older than the start");
}

#[test]
fn skip_drops_first_rows_from_any_objective_but_filters_them() {
    let log = log(vec![with_truth(scalars(&[4.0, 2.0]), &[&[0.0], &[2.0]])]);
    let problem = level().problem();
    let skipping = |kind| Objective { skip: 1, ..of(kind) };
    close(cost(&problem, &log, skipping(Kind::Nll)), 0.5 * (TAU.ln() + 2f64.ln() + 0.5), 1e-14);
    close(cost(&problem, &log, skipping(Kind::MseInnovation)), 1.0, 1e-14);
    close(cost(&problem, &log, skipping(Kind::Nis)), 0.5, 1e-14);
    close(cost(&problem, &log, skipping(Kind::Mismatch)), 0.5, 1e-14);
    close(cost(&problem, &log, skipping(Kind::Nees)), 0.5, 1e-14);
    close(cost(&problem, &log, skipping(Kind::Rmse)), 0.5, 1e-14);
    close(cost(&problem, &log, skipping(Kind::Distance)), 0.5, 1e-14);
}

#[test]
fn mismatch_averages_the_last_measured_rows() {
    let (problem, two) = (level().problem(), log(vec![scalars(&[4.0, 2.0])]));
    // Ca = (16 + 1) / 2, Ct = (4 + 2) / 2.
    close(cost(&problem, &two, of(Kind::Mismatch)), 17.0 / 6.0 - 1.0, 1e-14);
    let last = Objective { ct_last: true, ..of(Kind::Mismatch) };
    close(cost(&problem, &two, last), 17.0 / 2.0 / 2.0 - 1.0, 1e-14);
    // A window of one row, which is row 1 although row 2 has no measurement.
    let one = Objective { window: 1, ..of(Kind::Mismatch) };
    close(cost(&problem, &log(vec![scalars(&[4.0, 2.0, NAN])]), one), 0.5, 1e-14);
}

#[test]
fn mismatch_is_a_mean_over_trajectories_and_the_rest_is_pooled_by_count() {
    let problem = level().problem();
    let log = log(vec![scalars(&[4.0, 2.0]), scalars(&[2.0])]);
    // The second trajectory starts again from x0, P0: S = 4, nu = 2.
    close(cost(&problem, &log, of(Kind::Mismatch)), ((17.0 / 6.0 - 1.0) + 0.0) / 2.0, 1e-14);
    close(cost(&problem, &log, of(Kind::MseInnovation)), (16.0 + 1.0 + 4.0) / 3.0, 1e-14);
    close(cost(&problem, &log, of(Kind::Nis)), (4.0 + 0.5 + 1.0) / 3.0 - 1.0, 1e-14);
    let nll = 0.5 * (3.0 * TAU.ln() + 2.0 * 4f64.ln() + 2f64.ln() + 5.5);
    close(cost(&problem, &log, of(Kind::Nll)), nll, 1e-14);
}

#[test]
fn nees_is_normalised_by_n_and_rows_with_full_truth() {
    let log = log(vec![with_truth(scalars(&[4.0, 2.0, NAN]), &[&[0.0], &[2.0], &[NAN]])]);
    // e = 3, P = 3/4: 12. e = 1/2, P = 1/2: 1/2. The third row has no truth.
    close(cost(&level().problem(), &log, of(Kind::Nees)), 12.5 / 2.0 - 1.0, 1e-13);
}

#[test]
fn rmse_and_distance_use_posterior_errors_of_named_states() {
    let log = log(vec![with_truth(scalars(&[4.0, 2.0]), &[&[0.0], &[2.0]])]);
    let named = |kind| Objective { states: vec![0], ..of(kind) };
    close(cost(&level().problem(), &log, named(Kind::Rmse)), ((9.0 + 0.25) / 2f64).sqrt(), 1e-14);
    close(cost(&level().problem(), &log, named(Kind::Distance)), 3.5, 1e-14);
}

#[test]
fn rmse_is_not_divided_by_n_and_takes_only_rows_with_all_named_truth() {
    let model = Linear {
        f: DMatrix::identity(2, 2),
        b: DMatrix::zeros(2, 0),
        q: DMatrix::zeros(2, 2),
        h: matrix([[1.0, 0.0]]),
        d: DMatrix::zeros(1, 0),
        start: Some(vector([0.0, 0.0])),
        p0: DMatrix::identity(2, 2),
        ..level()
    };
    let truth: [&[f64]; 3] = [&[3.0, 4.0], &[3.0, NAN], &[NAN, 5.0]];
    let log = log(vec![with_truth(scalars(&[NAN; 3]), &truth)]);
    let named = |kind, states: &[usize]| Objective { states: states.to_vec(), ..of(kind) };
    let problem = model.problem();
    close(cost(&problem, &log, named(Kind::Rmse, &[0, 1])), 5.0, 1e-14);
    close(cost(&problem, &log, named(Kind::Distance, &[0, 1])), 5.0, 1e-14);
    close(cost(&problem, &log, named(Kind::Distance, &[0])), 6.0, 1e-14);
    close(cost(&problem, &log, named(Kind::Rmse, &[1])), ((16.0 + 25.0) / 2f64).sqrt(), 1e-14);
    close(cost(&problem, &log, of(Kind::Nees)), 25.0 / 2.0 - 1.0, 1e-14);
}

#[test]
fn a_row_without_measurement_only_predicts() {
    let run = run(&level().problem(), &log(vec![scalars(&[4.0, NAN, 2.0])]), &[]).expect("runs");
    let steps = &run.trajectories[0];
    assert!(steps[1].update.is_none(), "nothing was measured at row 1");
    close(steps[1].posterior.p[(0, 0)], 1.0, 1e-14);
    close(steps[2].prior.p[(0, 0)], 1.25, 1e-14);
    close(steps[2].posterior.x[0], 3.0 - 1.25 / 2.25, 1e-14);
}

#[test]
fn x0_holds_at_the_first_row_even_when_it_is_not_measured() {
    let run = run(&level().problem(), &log(vec![scalars(&[NAN, 4.0])]), &[]).expect("runs");
    close(run.trajectories[0][0].posterior.p[(0, 0)], 3.0, 1e-14);
    close(run.trajectories[0][1].prior.p[(0, 0)], 3.25, 1e-14);
}

#[test]
fn predict_first_takes_one_step_before_the_first_row() {
    // With G = 1 a step of dt takes x to (1 + dt) x and adds dt/4 to P.
    let growing = |dt| Linear {
        first: First::Predict { dt },
        drift: Some(matrix([[1.0]])),
        start: Some(vector([2.0])),
        ..level()
    };
    let regular = log(vec![trajectory(&[(10.0, &[NAN]), (10.5, &[NAN])])]);
    for (dt, expected) in [(None, 0.5f64), (Some(2.0), 2.0)] {
        let run = run(&growing(dt).problem(), &regular, &[]).expect("runs");
        let prior = &run.trajectories[0][0].prior;
        close(prior.x[0], 2.0 * (1.0 + expected), 1e-14);
        close(prior.p[(0, 0)], (1.0 + expected).powi(2) * 3.0 + 0.25 * expected, 1e-13);
    }
    let irregular = log(vec![trajectory(&[(0.0, &[NAN]), (1.0, &[NAN]), (3.0, &[NAN])])]);
    let failure = run(&growing(None).problem(), &irregular, &[]).expect_err("no interval to take");
    assert_eq!(failure.what, Cause::NoFirstInterval, "the error names the missing first_dt");
}

#[test]
fn x0_from_a_measurement_is_no_update_but_counts_in_rmse() {
    let model = Linear { start: None, offset: vector([10.0]), ..level() };
    let log = log(vec![with_truth(scalars(&[NAN, 14.0, 12.0]), &[&[9.0], &[3.0], &[2.0]])]);
    let problem = model.problem();
    let run = run(&problem, &log, &[]).expect("runs");
    let steps = &run.trajectories[0];
    assert_eq!(steps.iter().map(|s| s.row).collect::<Vec<_>>(), [1, 2], "row 0 comes before the first measurement");
    assert!(steps[0].update.is_none(), "the row that gives x0 is no update");
    close(steps[0].posterior.x[0], 4.0, 1e-14);
    close(steps[0].posterior.p[(0, 0)], 3.0, 1e-14);
    // Row 2: prior P = 3.25, S = 4.25, nu = 12 - 10 - 4 = -2.
    close(cost(&problem, &log, of(Kind::Nll)), 0.5 * (TAU.ln() + 4.25f64.ln() + 4.0 / 4.25), 1e-14);
    close(cost(&problem, &log, of(Kind::MseInnovation)), 4.0, 1e-14);
    let last_error = 4.0 - 2.0 * 3.25 / 4.25 - 2.0;
    close(cost(&problem, &log, of(Kind::Distance)), 1.0 + last_error, 1e-14);
}

#[test]
fn x0_from_a_measurement_waits_for_a_complete_one_and_leaves_unseen_directions_at_zero() {
    let model = Linear {
        f: DMatrix::identity(3, 3),
        b: DMatrix::zeros(3, 0),
        q: DMatrix::zeros(3, 3),
        h: matrix([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        d: DMatrix::zeros(2, 0),
        offset: DVector::zeros(2),
        r: DMatrix::identity(2, 2),
        start: None,
        p0: DMatrix::identity(3, 3),
        ..level()
    };
    let log = log(vec![trajectory(&[(0.0, &[1.0, NAN]), (1.0, &[6.0, 7.0])]), trajectory(&[(0.0, &[NAN, 1.0])])]);
    let run = run(&model.problem(), &log, &[]).expect("runs");
    assert_eq!(run.trajectories[0].len(), 1, "only row 1 is complete");
    let x = &run.trajectories[0][0].posterior.x;
    assert!((x - vector([3.0, 7.0, 0.0])).amax() < 1e-14, "pinv(H) z = (3, 7, 0), found {x}");
    assert!(run.trajectories[1].is_empty(), "no complete measurement, no step");
}

#[test]
fn a_missing_component_is_left_out_of_h_and_r() {
    let model = Linear {
        h: matrix([[1.0], [1.0]]),
        d: DMatrix::zeros(2, 0),
        offset: DVector::zeros(2),
        r: matrix([[1.0, 0.5], [0.5, 2.0]]),
        ..level()
    };
    let run = run(&model.problem(), &log(vec![trajectory(&[(0.0, &[NAN, 5.0]), (1.0, &[2.0, NAN])])]), &[]);
    let run = run.expect("runs");
    let first = run.trajectories[0][0].update.as_ref().expect("row 0 has one component");
    assert_eq!(first.present, [1], "the second component");
    close(first.s[(0, 0)], 5.0, 1e-14);
    close(first.nu[0], 5.0, 1e-14);
    // K = 3/5, x = 3, P = 6/5; then P = 29/20, S = 49/20, nu = -1.
    let second = run.trajectories[0][1].update.as_ref().expect("row 1 has one component");
    assert_eq!(second.present, [0], "the first component");
    close(second.s[(0, 0)], 2.45, 1e-14);
    close(second.nu[0], -1.0, 1e-14);
}

#[test]
fn inputs_of_a_row_act_on_the_step_after_it_and_on_its_own_measurement() {
    let model = Linear { b: matrix([[1.0]]), d: matrix([[10.0]]), ..level() };
    let mut rows = scalars(&[NAN, 34.0]);
    rows.u = table(&[&[2.0], &[3.0]]);
    let run = run(&model.problem(), &log(vec![rows]), &[]).expect("runs");
    let step = &run.trajectories[0][1];
    close(step.prior.x[0], 2.0, 1e-14);
    close(step.update.as_ref().expect("measured").nu[0], 34.0 - 2.0 - 30.0, 1e-14);
}

#[test]
fn an_empty_input_on_the_last_row_is_not_used() {
    let problem = Linear { b: matrix([[1.0]]), ..level() }.problem();
    let mut rows = scalars(&[4.0, 2.0]);
    rows.u = table(&[&[1.0], &[NAN]]);
    let run = run(&problem, &log(vec![rows]), &[]).expect("the last row's input acts on nothing");
    close(run.trajectories[0][1].update.as_ref().expect("measured").nu[0], -2.0, 1e-14);
}

#[test]
fn dt_is_the_interval_to_the_next_row() {
    let model = Linear { drift: Some(matrix([[0.0]])), ..level() };
    let log = log(vec![trajectory(&[(0.0, &[4.0]), (1.0, &[NAN]), (4.0, &[NAN])])]);
    let run = run(&model.problem(), &log, &[]).expect("runs");
    let variances: Vec<f64> = run.trajectories[0].iter().map(|s| s.posterior.p[(0, 0)]).collect();
    for (found, expected) in variances.iter().zip([0.75, 1.0, 1.75]) {
        close(*found, expected, 1e-15); // P grows by dt / 4
    }
}

#[test]
fn failures_name_their_place() {
    let negative = Linear::level(0.25, -5.0, 3.0);
    let failure = run(&negative.problem(), &log(vec![scalars(&[NAN, 4.0])]), &[]).expect_err("R = -5");
    assert_eq!((failure.row, failure.line, failure.what), (0, 2, Cause::NotCovariance { matrix: "R" }), "{failure}");
    let exploding = Linear { f: matrix([[1e200]]), ..level() };
    let failure = run(&exploding.problem(), &log(vec![scalars(&[4.0, NAN, 4.0])]), &[]).expect_err("overflows");
    assert_eq!(failure.what, Cause::NotFinite, "{failure}");
}
