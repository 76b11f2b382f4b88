//! The exact steps of PSO and PIO against a second implementation: plain arrays, the same draws.

use super::*;
use crate::population::Status;
use crate::random::{Purpose, Stream};

const SEED: u64 = 11;
type Point = [f64; 2];

fn cost(x: Point) -> f64 {
    Landscape::Rosenbrock.value(&x)
}

fn points(population: &Population) -> Vec<Point> {
    population.rows().map(|row| [row[0], row[1]]).collect()
}

fn argmin(all: &[Point]) -> Point {
    all.iter().copied().fold([f64::NAN; 2], |best, x| if best[0].is_nan() || cost(x) < cost(best) { x } else { best })
}

fn assert_close(ours: &[Point], theirs: &[Point], what: &str) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (a, b) in ours.iter().flatten().zip(theirs.iter().flatten()) {
        assert!((a - b).abs() <= 1e-13 * b.abs().max(1.0), "{what}: {a} against {b}");
    }
}

fn populations(name: &str, population: usize, generations: usize) -> Vec<Vec<Point>> {
    let space = Space::boxed(&Mock::bounds(2));
    let (all, _) = run(name, &space, settings(population, generations, SEED), Mock::new(Landscape::Rosenbrock));
    all.iter().map(points).collect()
}

fn clip(x: Point) -> Point {
    x.map(|x| x.clamp(-5.0, 5.0))
}

/// V <- w V + c r1 (P - X) + c r2 (G - X), X <- X + V; G of the previous iteration for every particle.
fn pso(start: &[Point], w: impl Fn(usize) -> f64, c: f64, iterations: usize) -> Vec<Vec<Point>> {
    let (mut x, mut v, mut own) = (start.to_vec(), vec![[0.0; 2]; start.len()], start.to_vec());
    let mut history = vec![x.clone()];
    for t in 1..=iterations {
        let best = argmin(&own);
        for i in 0..x.len() {
            let mut draw = Stream::new(SEED, Purpose::Move, t as u64, i as u64);
            for d in 0..2 {
                let r1 = draw.uniform();
                let r2 = draw.uniform();
                v[i][d] = v[i][d] * w(t) + c * (r1 * (own[i][d] - x[i][d]) + r2 * (best[d] - x[i][d]));
                x[i][d] += v[i][d];
            }
            x[i] = clip(x[i]);
        }
        for i in 0..x.len() {
            own[i] = if cost(x[i]) < cost(own[i]) { x[i] } else { own[i] };
        }
        history.push(x.clone());
    }
    history
}

#[test]
fn pso_moves_as_specified() {
    for (name, w0, w1, c) in [("pso", 0.7298, 0.7298, 1.49618), ("pso-inertia", 0.9, 0.4, 2.0)] {
        let ours = populations(name, 4, 3);
        let theirs = pso(&ours[0], |t| w0 + (w1 - w0) * (t as f64 - 1.0) / 2.0, c, 3);
        for (t, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            assert_close(ours, theirs, &format!("{name}, iteration {t}"));
        }
        assert_ne!(ours[2], ours[3], "{name} still moves");
    }
}

struct Form {
    name: &'static str,
    r: f64,
    old_velocity: bool,
    per_coordinate: bool,
    all_stay: bool,
    weight: fn(f64) -> f64,
}

fn draws(t: usize, i: usize, per_coordinate: bool) -> Point {
    let mut draw = Stream::new(SEED, Purpose::Move, t as u64, i as u64);
    let first = draw.uniform();
    [first, if per_coordinate { draw.uniform() } else { first }]
}

fn pio(start: &[Point], form: &Form, map: usize, landmark: usize) -> Vec<Vec<Point>> {
    let (mut x, mut v, mut best) = (start.to_vec(), vec![[0.0; 2]; start.len()], argmin(start));
    let mut history = vec![x.clone()];
    for t in 1..=map {
        for i in 0..x.len() {
            let rand = draws(t, i, form.per_coordinate);
            let (x_old, v_old) = (x[i], v[i]);
            for d in 0..2 {
                v[i][d] = v_old[d] * (-form.r * t as f64).exp() + rand[d] * (best[d] - x_old[d]);
                x[i][d] = x_old[d] + if form.old_velocity { v_old[d] } else { v[i][d] };
            }
            x[i] = clip(x[i]);
        }
        best = argmin(&[&[best], x.as_slice()].concat());
        history.push(x.clone());
    }
    let mut np = x.len();
    for t in map + 1..=map + landmark {
        np = (np / 2).max(1);
        x.sort_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        let total: f64 = x[..np].iter().map(|x| (form.weight)(cost(*x))).sum();
        let centre = [0, 1].map(|d| x[..np].iter().map(|x| (form.weight)(cost(*x)) * x[d]).sum::<f64>() / total);
        if !form.all_stay {
            x.truncate(np);
        }
        for (i, x) in x.iter_mut().enumerate() {
            let rand = draws(t, i, form.per_coordinate);
            *x = [0, 1].map(|d| x[d] + rand[d] * (centre[d] - x[d]));
        }
        history.push(x.clone());
    }
    history
}

#[test]
fn pio_moves_as_specified() {
    let inverse = |j: f64| 1.0 / (j + 1e-12);
    let forms = [
        Form { name: "pio", r: 0.2, old_velocity: false, per_coordinate: false, all_stay: false, weight: inverse },
        Form { name: "pio-printed", r: 0.2, old_velocity: true, per_coordinate: false, all_stay: false, weight: |j| j },
        Form { name: "pio+", r: 0.01, old_velocity: false, per_coordinate: true, all_stay: true, weight: inverse },
    ];
    for form in &forms {
        let ours = populations(form.name, 9, 6);
        let theirs = pio(&ours[0], form, 4, 2);
        assert_eq!((ours.len(), theirs.len()), (7, 7), "{}", form.name);
        for (t, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            assert_close(ours, theirs, &format!("{}, generation {t}", form.name));
        }
        let flock: Vec<usize> = ours[4..].iter().map(Vec::len).collect();
        assert_eq!(flock, if form.all_stay { [9, 9, 9] } else { [9, 4, 2] }, "{}", form.name);
    }
}

/// A memetic wrapper may tell of other positions than were asked for: a flock that was moved to one point has nowhere
/// to go, by the best position as by the landmark.
#[test]
fn a_flock_goes_on_from_where_it_is_told_to_be() {
    let point = [0.5, -0.25];
    for name in ["pio", "pio-printed", "pio+"] {
        let mut flock = build(name, &Space::boxed(&Mock::bounds(2)), &settings(8, 9, 5)).expect(name);
        let first = flock.ask().expect("generation 0");
        flock.tell(&Population::from_rows(2, point.repeat(8)), &Evaluation::new(1, vec![1.0; 8], vec![Status::OK; 8]));
        assert!(first.rows().all(|x| x != point), "{name}: it was elsewhere");
        while let Some(asked) = flock.ask() {
            let there = |x: &[f64]| x.iter().zip(point).all(|(x, point)| (x - point).abs() < 1e-14);
            assert!(asked.rows().all(there), "{name}: {asked:?}");
            let costs = vec![1.0; asked.len()];
            flock.tell(&asked, &Evaluation::new(1, costs, vec![Status::OK; asked.len()]));
        }
    }
}
