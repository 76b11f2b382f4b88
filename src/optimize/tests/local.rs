//! Nelder-Mead.

use super::*;
use crate::optimize::nelder_mead::{NelderMead, Options};

const EDGE: f64 = 0.1;

fn polish(landscape: Landscape, space: &Space, start: &[f64], options: Options) -> (Vec<f64>, f64, Mock) {
    let mut mock = Mock::new(landscape);
    let mut search = NelderMead::new(space, start, &vec![EDGE; start.len()], options).expect("a box");
    let (_, seen) = drive(&mut search, &mut mock);
    let (x, cost) = search.best().expect("a best");
    assert!(options.speculative || cost.to_bits() == seen.to_bits(), "the best told is kept: {cost:e}, {seen:e}");
    assert_eq!(search.evaluations() as u64, mock.candidates, "every candidate sent is counted");
    (x.to_vec(), cost, mock)
}

#[test]
fn both_ways_of_asking_take_the_same_path() {
    let cases =
        [(Landscape::Sphere, 1), (Landscape::Sphere, 4), (Landscape::Rosenbrock, 2), (Landscape::Rosenbrock, 5)];
    for (landscape, dimension) in cases {
        let space = Space::boxed(&Mock::bounds(dimension));
        let options = |speculative| Options { evaluations: 5000, speculative, ..Options::default() };
        let start = vec![0.5; dimension];
        let (one, cost, sequential) = polish(landscape, &space, &start, options(false));
        let (many, _, speculative) = polish(landscape, &space, &start, options(true));
        assert_eq!(one, many, "{landscape:?} in {dimension}");
        assert!(cost < 1e-17, "{landscape:?} in {dimension}: {cost:e} (at most 4e-19 measured)");
        assert!(speculative.calls < sequential.calls && speculative.candidates > sequential.candidates);
    }
}

#[test]
fn budget_and_bounds_hold() {
    let space = Space::boxed(&[[-1.0, 0.5], [-0.25, 1.0]]);
    for evaluations in [0, 2, 3, 50, 300] {
        let options = Options { evaluations, ..Options::default() };
        let mut mock = Mock::new(Landscape::Sphere);
        let mut search = NelderMead::new(&space, &[0.5, 1.0], &[EDGE; 2], options).expect("a box");
        let (populations, best) = drive(&mut search, &mut mock);
        assert!(mock.candidates <= evaluations as u64, "{evaluations}: {}", mock.candidates);
        let inside = |x: &[f64]| (-1.0..=0.5).contains(&x[0]) && (-0.25..=1.0).contains(&x[1]);
        assert!(populations.iter().flat_map(Population::rows).all(inside));
        assert!(
            evaluations < 300 || (best - Landscape::Sphere.value(&[0.5, -0.25])).abs() < 1e-12,
            "{best} in the corner"
        );
    }
}

/// The minimum must not be claimed where two vertices straddle it at equal cost.
#[test]
fn equal_costs_alone_do_not_stop_it() {
    let optimum = Landscape::optimum(0);
    let space = Space::boxed(&[[optimum - 5.0, optimum + 5.0]]);
    let (x, _, _) = polish(Landscape::Sphere, &space, &[optimum - 0.5 * EDGE], Options::default());
    assert!((x[0] - optimum).abs() < 1e-9, "{} against {optimum}", x[0]);
}

#[test]
fn failures_and_wrong_starts() {
    let space = Space::boxed(&Mock::bounds(2));
    let mut search = NelderMead::new(&space, &[0.0, 0.0], &[EDGE; 2], Options::default()).expect("a box");
    let mut mock = Mock::new(Landscape::Sphere).failing(|_| true);
    let (populations, _) = drive(&mut search, &mut mock);
    assert!(populations.iter().flat_map(Population::rows).flatten().all(|x| x.is_finite()));
    for (start, edges) in [(&[0.0][..], &[EDGE; 2][..]), (&[0.0; 2], &[EDGE]), (&[0.0; 2], &[EDGE, 0.0])] {
        assert!(NelderMead::new(&space, start, edges, Options::default()).is_err(), "{start:?}, {edges:?}");
    }
}
