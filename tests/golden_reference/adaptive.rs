//! Adaptive filters by hand: a local level (F = H = 1), P0 = 1, Q = 1, R = 1, x0 = 0.
//!
//! Row 0 with z: S = 2, K = 1/2, nu = z, x = z / 2, P = 1/2. With b = 1/2, d_1 = 2/3 and d_2 = 4/7.

use kfgpu::data::Log;
use kfgpu::model::family::{Fuzzy, SageHusa, SageHusaR};
use kfgpu::model::{Expr, FilterKind};
use kfgpu::reference::{Cause, Run, run};

use super::support::{Linear, close, log, scalars};

const NAN: f64 = f64::NAN;

fn filtered(kind: &FilterKind, log: &Log) -> Run {
    let mut problem = Linear::level(1.0, 1.0, 1.0).problem();
    problem.filter = kind.clone();
    run(&problem, log, &[]).expect("the run succeeds")
}

/// S of each row, NaN where nothing is measured.
fn variances(kind: &FilterKind, z: &[f64]) -> Vec<f64> {
    let run = filtered(kind, &log(vec![scalars(z)]));
    run.trajectories[0].iter().map(|step| step.update.as_ref().map_or(NAN, |u| u.s[(0, 0)])).collect()
}

fn sage_husa(forgetting: f64) -> FilterKind {
    FilterKind::SageHusa(SageHusa { forgetting: Expr::number(forgetting) })
}

fn sage_husa_r(forgetting: f64, floor: f64) -> FilterKind {
    FilterKind::SageHusaR(SageHusaR { forgetting: Expr::number(forgetting), floor: Expr::number(floor) })
}

fn fuzzy(window: usize) -> FilterKind {
    FilterKind::Fuzzy(Fuzzy { window, gain: Expr::number(0.1), width: Expr::number(0.5) })
}

/// z = 4: K nu = 2, Q = 1/3 + 2/3 * 4 = 3, prior P = 7/2.
#[test]
fn sage_husa_mixes_in_the_square_of_the_correction() {
    let s = variances(&sage_husa(0.5), &[4.0, 0.0]);
    close(s[0], 2.0, 1e-15);
    close(s[1], 3.5 + 1.0, 1e-14);
}

/// The missing row adapts nothing and does not count: Q stays 3, prior P = 1/2 + 3 + 3, S = 15/2, K = 13/15; the next
/// fading factor is d_2 = 4/7.
#[test]
fn sage_husa_counts_measured_rows_only() {
    let s = variances(&sage_husa(0.5), &[4.0, NAN, 4.5, 0.0]);
    close(s[2], 7.5, 1e-14);
    let gain: f64 = 13.0 / 15.0;
    let q = 3.0 / 7.0 * 3.0 + 4.0 / 7.0 * (gain * 2.5).powi(2);
    close(s[3], (1.0 - gain) * 6.5 + q + 1.0, 1e-13);
}

/// b = 1 forgets nothing: d_k = 1 / (k + 1).
#[test]
fn sage_husa_without_forgetting_is_a_mean() {
    let s = variances(&sage_husa(1.0), &[4.0, 0.0]);
    close(s[1], 0.5 + (0.5 + 0.5 * 4.0) + 1.0, 1e-14);
}

/// z = 4: R = 1/3 + 2/3 (16 - 1) = 31/3. z = 0: R = 1/3 - 2/3 < 0, so the floor 1/4 holds.
#[test]
fn sage_husa_of_r_takes_the_predicted_variance_away_and_stays_above_its_floor() {
    close(variances(&sage_husa_r(0.5, 0.25), &[4.0, 0.0])[1], 1.5 + 31.0 / 3.0, 1e-14);
    close(variances(&sage_husa_r(0.5, 0.25), &[0.0, 0.0])[1], 1.5 + 0.25, 1e-14);
    let with_gap = variances(&sage_husa_r(0.5, 0.25), &[4.0, NAN, 0.0]);
    close(with_gap[2], 2.5 + 31.0 / 3.0, 1e-14);
}

/// Window 2. Row 0: one square, R rests. Row 1: prior P = 3/2, S = 5/2; squares 0 and nu^2 with nu = z.
/// z^2 = 6: DoM = 3 / 2.5 - 1 = 1/5, membership of Positive 2/5, R = 1 + 0.1 * 2/5.
#[test]
fn fuzzy_waits_for_a_full_window_and_weighs_its_rules() {
    let z = 6f64.sqrt();
    let s = variances(&fuzzy(2), &[0.0, z, 0.0]);
    close(s[1], 2.5, 1e-15);
    let posterior = 1.5 / 2.5;
    close(s[2], posterior + 1.0 + 1.04, 1e-14);
    // Both squares 0: DoM = -1, beyond the width, and R falls by the whole gain.
    close(variances(&fuzzy(2), &[0.0, 0.0, 0.0])[2], posterior + 1.0 + 0.9, 1e-14);
    // A missing row pushes nothing and changes nothing: row 2 is the second measured one, with prior P = 5/2.
    let with_gap = variances(&fuzzy(2), &[0.0, NAN, 7f64.sqrt(), 0.0]);
    close(with_gap[2], 3.5, 1e-15);
    close(with_gap[3], 2.5 / 3.5 + 1.0 + 1.0, 1e-14);
}

#[test]
fn every_trajectory_starts_anew() {
    let z = [3.0, -1.0, 4.0, 0.5, NAN, 2.0];
    for kind in [sage_husa(0.9), sage_husa_r(0.9, 0.1), fuzzy(2)] {
        let run = filtered(&kind, &log(vec![scalars(&z), scalars(&z)]));
        assert_eq!(run.trajectories[0], run.trajectories[1], "{kind:?}");
    }
}

#[test]
fn a_setting_outside_its_range_fails_the_candidate() {
    let mut problem = Linear::level(1.0, 1.0, 1.0).problem();
    for (kind, key) in [
        (sage_husa(1.01), "forgetting"),
        (sage_husa_r(0.0, 0.1), "forgetting"),
        (sage_husa_r(0.9, -0.1), "floor"),
        (FilterKind::Fuzzy(Fuzzy { window: 2, gain: Expr::number(1.0), width: Expr::number(1.0) }), "gain"),
        (FilterKind::Fuzzy(Fuzzy { window: 2, gain: Expr::number(0.1), width: Expr::number(0.0) }), "width"),
    ] {
        problem.filter = kind;
        let failure = run(&problem, &log(vec![scalars(&[1.0])]), &[]).expect_err("out of range");
        assert_eq!(failure.what, Cause::Setting { key });
    }
}
