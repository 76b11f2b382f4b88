//! The smoother of nonlinear filters against the recursions as published: Rauch, Tung and Striebel's with the Jacobian at the
//! posterior mean, and Särkkä's (2008, doi:10.1109/TAC.2008.919531) with the cross-covariance of the sigma points.

use kfgpu::data::Log;
use kfgpu::model::Problem;
use kfgpu::reference::{Estimate, Scope, Step, evaluate, gradient, run, smooth};
use nalgebra::{Cholesky, DMatrix, DVector};

use super::nonlinear::problem;

/// Cov(x, f(x)) of a row's posterior over `dt` by its Jacobian, or by sigma points at x +- sqrt(c) L_j.
fn cross(problem: &Problem, spread: Option<f64>, at: &Estimate, inputs: &[f64], dt: f64) -> DMatrix<f64> {
    let n = at.x.len();
    let baseline = problem.parameters.baseline();
    let parameters = problem.parameters.resolve(&baseline);
    let scope = |x: &DVector<f64>| -> Vec<f64> { x.iter().copied().collect() };
    let f = |x: &DVector<f64>| {
        let states = scope(x);
        let scope = Scope { states: &states, parameters: &parameters, inputs, dt };
        DVector::from_iterator(n, problem.model.f.iter().map(|f| evaluate(f, &scope)))
    };
    let Some(spread) = spread else {
        let states = scope(&at.x);
        let scope = Scope { states: &states, parameters: &parameters, inputs, dt };
        let slopes: Vec<f64> = problem.model.f.iter().flat_map(|f| gradient(f, &scope)).collect();
        return &at.p * DMatrix::from_row_slice(n, n, &slopes).transpose();
    };
    let root = Cholesky::new(at.p.clone()).expect("positive definite").l();
    let columns = (0..n).map(|j| root.column(j) * spread.sqrt());
    columns.fold(DMatrix::zeros(n, n), |sum, step| {
        let odd = f(&(&at.x + &step)) - f(&(&at.x - &step));
        sum + step * odd.transpose() / (2.0 * spread)
    })
}

fn recursion(problem: &Problem, log: &Log, spread: Option<f64>) -> (Vec<Step>, Vec<Estimate>) {
    let steps = run(problem, log, &problem.parameters.baseline()).expect("runs").trajectories.remove(0);
    let t = &log.trajectories[0];
    let mut all = vec![steps[steps.len() - 1].posterior.clone()];
    for pair in steps.windows(2).rev() {
        let [now, after] = pair else { unreachable!("windows of two") };
        let dt = t.dt(now.row).expect("a row follows");
        let cross = cross(problem, spread, &now.posterior, t.u.row(now.row), dt);
        let gain = cross * after.prior.p.clone().try_inverse().expect("Q is positive definite");
        let next = &all[all.len() - 1];
        let x = &now.posterior.x + &gain * (&next.x - &after.prior.x);
        let p = &now.posterior.p + &gain * (&next.p - &after.prior.p) * gain.transpose();
        all.push(Estimate { x, p });
    }
    all.reverse();
    (steps, all)
}

/// Largest difference in standard deviations of the filter.
fn apart(found: &Estimate, expected: &Estimate, filtered: &Estimate) -> f64 {
    let sd: Vec<f64> = filtered.p.diagonal().iter().map(|p| p.sqrt()).collect();
    let n = sd.len();
    let x = (0..n).map(|i| (found.x[i] - expected.x[i]).abs() / sd[i]);
    let p = (0..n * n).map(|k| (found.p[k] - expected.p[k]).abs() / sd[k / n] / sd[k % n]);
    x.chain(p).fold(0.0, f64::max)
}

#[test]
fn smoothed_states_are_those_of_the_recursions_as_published() {
    for (name, n) in [("radar", 4.0), ("ct", 5.0), ("bearings_only", 4.0), ("growth", 1.0), ("plaza2", 3.0)] {
        for (filter, spread) in [
            ("kind = \"extended\"", None),
            ("kind = \"iterated\"\niterations = 4", None),
            ("kind = \"cubature\"", Some(n)),
            ("kind = \"unscented\"\nalpha = 0.7\nbeta = 2\nkappa = 1", Some(0.49 * (n + 1.0))),
        ] {
            let (problem, log) = problem(name, filter);
            let (steps, expected) = recursion(&problem, &log, spread);
            let found = smooth(&problem, &log, &problem.parameters.baseline()).expect("smooths").remove(0);
            let all = steps.iter().zip(&found).zip(&expected);
            let worst = all.map(|((s, f), e)| apart(&f.estimate, e, &s.posterior)).fold(0.0, f64::max);
            println!("{name}, {filter:?}: {worst:.1e} standard deviations");
            assert_eq!(found.len(), steps.len());
            assert!(worst < 1e-8, "{name}, {filter:?}: {worst:.1e} standard deviations");
        }
    }
}

/// What smoothing is for: the positions of the simulated targets are nearer to the truth.
#[test]
fn smoothed_tracks_are_nearer_to_the_truth() {
    for name in ["radar", "ct"] {
        for filter in ["kind = \"extended\"", "kind = \"cubature\""] {
            let (problem, log) = problem(name, filter);
            let candidate = problem.parameters.baseline();
            let steps = run(&problem, &log, &candidate).expect("runs").trajectories.remove(0);
            let smoothed = smooth(&problem, &log, &candidate).expect("smooths").remove(0);
            let error = |row: usize, x: &DVector<f64>| {
                let truth = log.trajectories[0].truth.row(row);
                (x[0] - truth[0]).powi(2) + (x[1] - truth[1]).powi(2)
            };
            let filtered: f64 = steps.iter().map(|step| error(step.row, &step.posterior.x)).sum();
            let better: f64 = smoothed.iter().map(|found| error(found.row, &found.estimate.x)).sum();
            assert!(better < 0.8 * filtered, "{name}, {filter}: {better} of {filtered}");
        }
    }
}
