//! The filter's log-likelihood is the joint Gaussian log-density of all measurements, by an LU factorisation of their
//! covariance.

use std::f64::consts::TAU;

use kfgpu::data::Log;
use kfgpu::objective::{Kind, Objective};

use super::joint::{Draws, Joint, draw_log, model};
use super::support::{Linear, cost};

/// -ln N(z; mean, A A') of the present measurements, with one column of A per unit normal noise.
fn joint_nll(model: &Linear, log: &Log) -> f64 {
    let Joint { measured, .. } = Joint::of(model, &log.trajectories[0]);
    if measured.mean.is_empty() {
        return 0.0;
    }
    let lu = (&measured.map * measured.map.transpose()).lu();
    let quadratic = measured.mean.dot(&lu.solve(&measured.mean).expect("a covariance is invertible"));
    let components = u32::try_from(measured.mean.len()).expect("a short log");
    0.5 * (f64::from(components) * TAU.ln() + lu.determinant().ln() + quadratic)
}

#[test]
fn nll_is_the_joint_log_density() {
    let mut worst = 0.0f64;
    for case in 0..300 {
        let mut draws = Draws(case);
        let pick = |case: u64, of: u64| usize::try_from(case % of).expect("small");
        let (n, m, inputs, rows) =
            (1 + pick(case, 3), 1 + pick(case / 3, 2), pick(case / 6, 3), 1 + pick(case / 18, 5));
        let model = model(&mut draws, n, m, inputs);
        let log = draw_log(&mut draws, &model, rows);
        let expected = joint_nll(&model, &log);
        let found = cost(&model.problem(), &log, Objective::new(Kind::Nll));
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error < 1e-9, "case {case}, n={n} m={m} T={rows}: filter {found}, joint density {expected}");
        worst = worst.max(error);
    }
    println!("largest relative error of nll over 300 random logs: {worst:.1e}");
}
