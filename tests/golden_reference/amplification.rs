//! How far filters carry a change of the log by 1e-9 standard deviations.

use kfgpu::data::Log;
use kfgpu::reference::amplification;

use super::nonlinear::problem;
use super::support::{Linear, log, scalars};

/// A linear filter that forgets takes changes in: of T rows each changes nll by about 1e-9, in both directions, so A is
/// near 1 / sqrt(T), whatever its start.
#[test]
fn linear_filters_do_not_amplify() {
    let z: Vec<f64> = (0..400).map(|k| (f64::from(k) * 1.7).sin()).collect();
    let log: Log = log(vec![scalars(&z)]);
    for p0 in [1.0, 1e6, 1e10] {
        let problem = Linear::level(0.3, 0.5, p0).problem();
        let found = amplification(&problem, &log, &[]).expect("runs");
        println!("P0 = {p0:e}: A = {found:.3}");
        assert!(found > 1e-3 && found < 0.3, "P0 = {p0:e}: A = {found}");
        assert_eq!(found.to_bits(), amplification(&problem, &log, &[]).expect("runs").to_bits(), "the same draws");
    }
}

/// nll of a level with q = 0 and an exact start is a sum of squares: the draws can be told from it.
#[test]
fn of_white_noise_it_is_the_slope_of_the_likelihood() {
    let z = [3.0; 50];
    let problem = Linear { r: nalgebra::DMatrix::from_element(1, 1, 4.0), ..Linear::level(0.0, 1.0, 1.0) };
    let problem = Linear { p0: nalgebra::DMatrix::from_element(1, 1, 1e-12), ..problem };
    // d nll / d z = 3 / 4 in every row, S = 4: |sum of 50 normals| x 1.5 / 50, the worst of three.
    let found = amplification(&problem.problem(), &log(vec![scalars(&z)]), &[]).expect("runs");
    assert!((0.03..0.7).contains(&found), "A = {found}");
}

/// A filter that keeps its track does not amplify; the growth model's is chaotic.
#[test]
fn a_filter_that_loses_its_track_amplifies() {
    let of = |name: &str, filter: &str| {
        let (problem, log) = problem(name, filter);
        let found = amplification(&problem, &log, &problem.parameters.baseline()).expect("runs");
        println!("{name}, {filter:?}: A = {found:.3e}");
        found
    };
    let kinds = ["kind = \"extended\"", "kind = \"iterated\"", "kind = \"unscented\"", "kind = \"cubature\""];
    for (filter, growth) in kinds.into_iter().zip([2.0..50.0, 1.0..50.0, 0.1..2.0, 50.0..5e3]) {
        for name in ["radar", "ct", "bearings_only", "plaza2"] {
            let found = of(name, filter);
            assert!((1e-3..0.6).contains(&found), "{name}, {filter}: {found}");
        }
        let found = of("growth", filter);
        assert!(growth.contains(&found), "growth, {filter}: {found}, expected {growth:?}");
    }
}
