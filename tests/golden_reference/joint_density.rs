//! The filter's log-likelihood is the joint Gaussian log-density of all measurements, by an LU factorisation of their
//! covariance.

use kfgpu::data::{Log, SplitBy, ValidateSpec};
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::costs_held_out;
use kfgpu::study::Split;
use std::f64::consts::TAU;

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

/// -ln p(future | past) is the difference of two joint densities, of which the filter knows nothing.
#[test]
fn held_out_nll_is_that_of_the_future_given_the_past() {
    let mut worst = 0.0f64;
    let mut scored = 0;
    for case in 0..100 {
        let mut draws = Draws(1000 + case);
        let model = model(&mut draws, 2, 2, 1);
        let log = draw_log(&mut draws, &model, 7);
        let mut problem = model.problem();
        problem.data.file = Some("log.csv".into());
        problem.data.validate = Some(ValidateSpec { share: 0.4, by: Some(SplitBy::Time) });
        // Draws without a measurement in one of the parts are refused.
        let Ok(Split { train, held_out: Some(held_out) }) = Split::of(&problem, log.clone()) else { continue };
        assert_eq!((train.rows(), held_out.rows()), (4, 3), "0.4 of 7 rows is 2.8");
        let expected = joint_nll(&model, &log) - joint_nll(&model, &train);
        let found = costs_held_out(&problem, &held_out, &[]).expect("the run succeeds")[0];
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error < 1e-9, "case {case}: filter {found}, conditional density {expected}");
        (worst, scored) = (worst.max(error), scored + 1);
    }
    assert!(scored > 80, "{scored} of 100 logs can be parted");
    println!("largest relative error of the held-out nll over {scored} random logs: {worst:.1e}");
}
