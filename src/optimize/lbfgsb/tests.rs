//! Published problems with known minima: W. Hock, K. Schittkowski, *Test Examples for Nonlinear Programming Codes*, Lecture
//! Notes in Economics and Mathematical Systems 187 (1981), doi 10.1007/978-3-642-48320-2 (HS and number), with bounds that
//! hold with equality at the minimum; E. M. L. Beale (1958); H. H. Rosenbrock (1960).

use super::*;
use std::f64::consts::PI;

type Cost = fn(&[f64]) -> f64;

const INF: f64 = f64::INFINITY;

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|p| 100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]).powi(2)).sum()
}

/// Extended Rosenbrock: independent pairs.
fn extended(x: &[f64]) -> f64 {
    x.chunks_exact(2).map(rosenbrock).sum()
}

fn beale(x: &[f64]) -> f64 {
    let [x, y] = [x[0], x[1]];
    (1.5 - x + x * y).powi(2) + (2.25 - x + x * y * y).powi(2) + (2.625 - x + x * y.powi(3)).powi(2)
}

fn wood(x: &[f64]) -> f64 {
    let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
    100.0 * (b - a * a).powi(2)
        + (1.0 - a).powi(2)
        + 90.0 * (d - c * c).powi(2)
        + (1.0 - c).powi(2)
        + 10.1 * ((b - 1.0).powi(2) + (d - 1.0).powi(2))
        + 19.8 * (b - 1.0) * (d - 1.0)
}

fn mccormick(x: &[f64]) -> f64 {
    (x[0] + x[1]).sin() + (x[0] - x[1]).powi(2) - 1.5 * x[0] + 2.5 * x[1] + 1.0
}

fn space(lower: &[f64], upper: &[f64]) -> Space {
    let finite = |x: f64| x.clamp(-10.0, 10.0);
    let init = lower.iter().zip(upper).map(|(l, u)| [finite(*l), finite(*u)]).collect();
    Space { lower: lower.to_vec(), upper: upper.to_vec(), init, seeds: Vec::new() }
}

fn search(space: &Space, start: &[f64], source: Option<Box<dyn Gradient>>) -> Lbfgsb {
    let units = vec![1.0; start.len()];
    let differences = || Box::new(Differences::new(space, &vec![1e-3; start.len()], &units, 1.0));
    let source = source.unwrap_or_else(|| differences());
    let options = Options { evaluations: 300 * (2 * start.len() + 4), nat: 1.0, units: units.clone() };
    Lbfgsb::new(space, start, source, options).expect("a box")
}

/// Runs a search to its end; checks that every point asked for is in the box.
fn drive(search: &mut Lbfgsb, cost: &dyn Fn(&[f64]) -> f64) -> usize {
    let mut batches = 0;
    while let Some(batch) = search.ask() {
        let inside = |x: &f64, l: &f64, u: &f64| l <= x && x <= u;
        for row in batch.rows() {
            let bounds = search.space.lower.iter().zip(&search.space.upper);
            assert!(row.iter().zip(bounds).all(|(x, (l, u))| inside(x, l, u)), "{row:?} leaves the box");
        }
        let costs: Vec<f64> = batch.rows().map(cost).collect();
        let status = vec![crate::population::Status::OK; costs.len()];
        search.tell(&batch, &Evaluation::new(1, costs, status));
        batches += 1;
    }
    batches
}

struct Known {
    name: &'static str,
    cost: Cost,
    start: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    minimum: f64,
    at: Vec<f64>,
}

fn published() -> Vec<Known> {
    let free = |n: usize| (vec![-INF; n], vec![INF; n]);
    let known = |name, cost: Cost, start: &[f64], (lower, upper): (Vec<f64>, Vec<f64>), minimum, at: &[f64]| Known {
        name,
        cost,
        start: start.to_vec(),
        lower,
        upper,
        minimum,
        at: at.to_vec(),
    };
    let (a, b) = ((598.0_f64 / 1200.0).sqrt(), 400.0 * (598.0_f64 / 1200.0).sqrt().powi(3));
    let hs2 = |root: f64| 2.0 * a * (((1.0 / b).acos() + root * 2.0 * PI) / 3.0).cos();
    let twenty: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { -1.2 } else { 1.0 }).collect();
    vec![
        known("Rosenbrock", rosenbrock, &[-1.2, 1.0], free(2), 0.0, &[1.0, 1.0]),
        known("HS 1", rosenbrock, &[-2.0, 1.0], (vec![-INF, -1.5], vec![INF; 2]), 0.0, &[1.0, 1.0]),
        known("HS 2", rosenbrock, &[1.5, 2.0], (vec![-INF, 1.5], vec![INF; 2]), 0.050_426_187_9, &[hs2(0.0), 1.5]),
        // From the start that is given there, the nearest minimum is a local one.
        known("HS 2", rosenbrock, &[-2.0, 1.0], (vec![-INF, 1.5], vec![INF; 2]), 4.941_229_318, &[hs2(1.0), 1.5]),
        known("Rosenbrock in a box", rosenbrock, &[-1.2, 1.0], (vec![-2.0; 2], vec![0.5, 2.0]), 0.25, &[0.5, 0.25]),
        known("extended Rosenbrock", extended, &twenty, free(20), 0.0, &[1.0; 20]),
        known(
            "HS 3",
            |x| x[1] + 1e-5 * (x[1] - x[0]).powi(2),
            &[10.0, 1.0],
            (vec![-INF, 0.0], vec![INF; 2]),
            0.0,
            &[0.0, 0.0],
        ),
        known(
            "HS 4",
            |x| (x[0] + 1.0).powi(3) / 3.0 + x[1],
            &[1.125, 0.125],
            (vec![1.0, 0.0], vec![INF; 2]),
            8.0 / 3.0,
            &[1.0, 0.0],
        ),
        known(
            "HS 5",
            mccormick,
            &[0.0, 0.0],
            (vec![-1.5, -3.0], vec![4.0, 3.0]),
            -0.5 * 3.0_f64.sqrt() - PI / 3.0,
            &[-PI / 3.0 + 0.5, -PI / 3.0 - 0.5],
        ),
        known("HS 38", wood, &[-3.0, -1.0, -3.0, -1.0], (vec![-10.0; 4], vec![10.0; 4]), 0.0, &[1.0; 4]),
        known(
            "HS 45",
            |x| 2.0 - x.iter().product::<f64>() / 120.0,
            &[0.5, 1.0, 1.5, 2.0, 2.5],
            (vec![0.0; 5], vec![1.0, 2.0, 3.0, 4.0, 5.0]),
            1.0,
            &[1.0, 2.0, 3.0, 4.0, 5.0],
        ),
        known("Beale", beale, &[1.0, 1.0], free(2), 0.0, &[3.0, 0.5]),
    ]
}

/// The gain that is left is below what it stops at, and the bounds that hold at the minimum are met exactly.
#[test]
fn published_minima_are_reached() {
    for Known { name, cost, start, lower, upper, minimum, at } in published() {
        let space = space(&lower, &upper);
        let mut search = search(&space, &start, None);
        let batches = drive(&mut search, &cost);
        let (x, found) = search.best().expect("a cost");
        let (sent, norm) = (search.evaluations(), search.gradient_norm().expect("a gradient"));
        println!("{name}: {:.1e} above the minimum, norm {norm:.1e}, {batches} batches, {sent} costs", found - minimum);
        assert_eq!(search.standing(), Standing::Converged, "{name}: {x:?} {found}");
        assert!((-1e-9..2.0 * GOAL).contains(&(found - minimum)), "{name}: {found} at {x:?}, {minimum} is the minimum");
        for d in 0..x.len() {
            let held = at[d] <= lower[d] || at[d] >= upper[d];
            let allowed = if held { 0.0 } else { 2e-2 };
            assert!((x[d] - at[d]).abs() <= allowed, "{name}: {x:?}, not {at:?}");
        }
    }
}

/// c' x + x' A x / 2 with A = tridiagonal(-1, 4, -1) in five coordinates and c = (-8, 1, -10, 9, 1) in [0, 2]: x = (2, 0.75,
/// 2, 0, 0) has gradients (-0.75, 0, -2.75, 7, 1), so that it meets the conditions of Kuhn and Tucker.
#[test]
fn a_quadratic_with_bounds_meets_the_conditions_of_kuhn_and_tucker() {
    const C: [f64; 5] = [-8.0, 1.0, -10.0, 9.0, 1.0];
    fn gradient(x: &[f64]) -> Vec<f64> {
        let beside = |d: usize| if d > 0 { x[d - 1] } else { 0.0 } + x.get(d + 1).copied().unwrap_or(0.0);
        (0..5).map(|d| C[d] + 4.0 * x[d] - beside(d)).collect()
    }
    struct Exact;
    impl Gradient for Exact {
        fn points(&mut self, _: &[f64]) -> Vec<Vec<f64>> {
            Vec::new()
        }
        fn slope(&mut self, x: &[f64], _: f64, _: &[f64]) -> Slope {
            Slope { gradient: gradient(x), curvature: Vec::new() }
        }
    }
    let cost = |x: &[f64]| gradient(x).iter().zip(x).zip(C).map(|((g, x), c)| 0.5 * (g + c) * x).sum::<f64>();
    let expected = [2.0, 0.75, 2.0, 0.0, 0.0];
    let space = space(&[0.0; 5], &[2.0; 5]);
    for exact in [true, false] {
        let mut search = search(&space, &[1.0; 5], exact.then(|| Box::new(Exact) as Box<dyn Gradient>));
        drive(&mut search, &cost);
        let (x, _) = search.best().expect("a cost");
        assert_eq!(search.standing(), Standing::Converged);
        assert!(x.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-3), "{x:?}, exact gradients: {exact}");
        let held = [0, 2, 3, 4].map(|d| (x[d] - expected[d]).abs());
        assert!(held.iter().all(|gap| *gap <= 0.0), "bounds are met exactly: {x:?}");
    }
}

/// Along the trade-off and along a coordinate without any influence nothing moves; all else is found.
#[test]
fn flat_directions_stop_nothing() {
    let cost = |x: &[f64]| 700.0 + (x[0] + x[1] - 1.0).powi(2) + (x[2] - 0.5).powi(2);
    let space = space(&[-5.0; 4], &[5.0; 4]);
    let mut search = search(&space, &[2.0, 1.0, -3.0, 4.0], None);
    drive(&mut search, &cost);
    let (x, found) = search.best().expect("a cost");
    assert_eq!((search.standing(), x[3]), (Standing::Converged, 4.0));
    assert!(found - 700.0 < GOAL, "{found} at {x:?}");
}

/// 1000 - exp(x) on the shelf at x = -18 has a slope of 1.5e-8: the probe sees what lies beyond, up to the minimum at 1.
#[test]
fn a_shelf_is_no_optimum() {
    let cost = |x: &[f64]| 1000.0 - 40.0 * x[0].exp() * (2.0 - x[0]) + (x[1] - 1.0).powi(2);
    let space = space(&[-18.4, -5.0], &[2.3, 5.0]);
    for start in [-18.4, -18.0, -14.0] {
        let mut search = search(&space, &[start, 0.0], None);
        drive(&mut search, &cost);
        let (x, found) = search.best().expect("a cost");
        assert_eq!(search.standing(), Standing::Converged, "from {start}");
        assert!((found - (1000.0 - 40.0 * 1.0_f64.exp())).abs() < 2.0 * GOAL, "from {start}: {found} at {x:?}");
    }
}

/// x - ln x runs for x > 0 alone: what fails is a wall, also for the differences beside it.
#[test]
fn walls_shorten_steps() {
    let cost = |x: &[f64]| if x[0] > 0.0 { x[0] - x[0].ln() } else { f64::NAN };
    let space = space(&[-INF], &[INF]);
    for start in [4.0, 1e-4] {
        let mut search = search(&space, &[start], None);
        drive(&mut search, &cost);
        let (x, found) = search.best().expect("a cost");
        assert_eq!(search.standing(), Standing::Converged, "from {start}");
        assert!(found - 1.0 < GOAL && (x[0] - 1.0).abs() < 2e-3, "{found} at {x:?}");
    }
    let mut nowhere = search(&space, &[1.0], None);
    drive(&mut nowhere, &|_| f64::NAN);
    assert_eq!((nowhere.best(), nowhere.standing()), (None, Standing::Stuck));
}

#[test]
fn a_kink_and_a_budget_are_no_convergence() {
    let space = space(&[-5.0; 2], &[5.0; 2]);
    let mut kinked = search(&space, &[3.0, 2.0], None);
    drive(&mut kinked, &|x| (x[0] - x[1]).abs() * 10.0 + 0.1 * (x[0] + x[1] - 3.0).powi(2) + x[0].abs());
    assert_ne!(kinked.standing(), Standing::Converged, "{:?}", kinked.best());
    for evaluations in [0, 3, 20] {
        let options = Options { evaluations, nat: 1.0, units: vec![1.0; 2] };
        let source = Differences::new(&space, &[1e-3; 2], &[1.0; 2], 1.0);
        let mut short = Lbfgsb::new(&space, &[-1.2, 1.0], Box::new(source), options).expect("a box");
        drive(&mut short, &|x| rosenbrock(x));
        assert!(short.evaluations() <= evaluations && short.standing() == Standing::Unfinished);
    }
}

#[test]
fn wrong_starts_are_refused() {
    let space = space(&[-5.0; 2], &[5.0; 2]);
    for (start, units) in [(&[0.0][..], &[1.0; 2][..]), (&[0.0; 2], &[1.0]), (&[0.0; 2], &[1.0, 0.0])] {
        let options = Options { evaluations: 9, nat: 1.0, units: units.to_vec() };
        let source = Box::new(Differences::new(&space, &[1e-3; 2], &[1.0; 2], 1.0));
        assert!(Lbfgsb::new(&space, start, source, options).is_err(), "{start:?}, {units:?}");
    }
}

/// Central and one-sided differences of a cubic: exact to the third derivative over the square of the step.
#[test]
fn differences_look_inwards_at_a_bound() {
    let cost = |x: f64| x.powi(3) - 2.0 * x * x + x;
    let space = space(&[0.0], &[3.0]);
    for x in [0.0, 1.0, 3.0, 2.9995] {
        let mut source = Differences::new(&space, &[1e-3], &[1.0], 1.0);
        let points = source.points(&[x]);
        let costs: Vec<f64> = points.iter().map(|p| cost(p[0])).collect();
        assert!(points.iter().all(|p| (0.0..=3.0).contains(&p[0])), "{points:?}");
        let slope = source.slope(&[x], cost(x), &costs);
        let expected = [3.0 * x * x - 4.0 * x + 1.0, 6.0 * x - 4.0];
        assert!((slope.gradient[0] - expected[0]).abs() < 3e-6, "{x}: {slope:?}, {expected:?}");
        assert!((slope.curvature[0] - expected[1]).abs() < 1e-2, "{x}: {slope:?}, {expected:?}");
    }
}
