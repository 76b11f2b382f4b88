//! Indicators against closed forms, brute force and another program.

use super::*;
use crate::evaluate::mock::MultiObjective;
use crate::random::{Purpose, Stream};
use std::f64::consts::PI;

fn slices(points: &[Vec<f64>]) -> Vec<&[f64]> {
    points.iter().map(Vec::as_slice).collect()
}

fn random_points(case: u64, count: usize, objectives: usize) -> Vec<Vec<f64>> {
    let mut stream = Stream::new(2, Purpose::Workload, case, objectives as u64);
    // On a lattice of 12 steps, so that costs coincide; some points lie outside the reference at 1.
    (0..count).map(|_| (0..objectives).map(|_| (stream.uniform() * 13.0).floor() / 12.0).collect()).collect()
}

/// Inclusion and exclusion over all subsets of boxes.
fn by_inclusion_exclusion(points: &[Vec<f64>]) -> f64 {
    let objectives = points[0].len();
    let mut volume = 0.0;
    for subset in 1..1_u32 << points.len() {
        let members = || points.iter().enumerate().filter(|(i, _)| subset >> i & 1 == 1).map(|(_, p)| p);
        let edge = |m: usize| (1.0 - members().map(|p| p[m]).fold(f64::MIN, f64::max)).max(0.0);
        let common: f64 = (0..objectives).map(edge).product();
        volume += if subset.count_ones() % 2 == 1 { common } else { -common };
    }
    volume
}

#[test]
fn hypervolume_equals_inclusion_and_exclusion() {
    let mut largest: f64 = 0.0;
    for (case, objectives) in (0..200).flat_map(|case| [1, 2, 3, 4, 5].map(|m| (case, m))) {
        let points = random_points(case, 1 + case as usize % 9, objectives);
        let found = hypervolume(&slices(&points), &vec![1.0; objectives]);
        let error = (found - by_inclusion_exclusion(&points)).abs();
        assert!(error < 1e-12, "case {case}, {objectives} objectives: {error:e}");
        largest = largest.max(error);
    }
    println!("largest error {largest:e}");
}

/// Volumes do not depend on the order of points or of objectives; more points than inclusion and exclusion can take.
#[test]
fn hypervolume_of_large_sets_is_symmetric() {
    for objectives in [2, 3, 4] {
        let mut points = random_points(7, 60, objectives);
        points.iter_mut().for_each(|p| p[0] *= 0.99);
        let volume = hypervolume(&slices(&points), &vec![1.0; objectives]);
        points.reverse();
        points.iter_mut().for_each(|p| p.rotate_left(1));
        let turned = hypervolume(&slices(&points), &vec![1.0; objectives]);
        assert!((volume - turned).abs() < 1e-12 && volume > 0.5, "{objectives}: {volume} against {turned}");
    }
}

/// k points on the line f1 + f2 = 1 between its ends dominate 1/2 - 1/(2 (k - 1)) of the unit square.
#[test]
fn closed_forms_of_hypervolume() {
    let line: Vec<Vec<f64>> = (0..=50).map(|i| vec![f64::from(i) / 50.0, 1.0 - f64::from(i) / 50.0]).collect();
    assert!((hypervolume(&slices(&line), &[1.0, 1.0]) - (0.5 - 0.01)).abs() < 1e-14);
    let one_box = hypervolume(&[&[0.5; 4]], &[1.0, 2.0, 3.0, 0.75]);
    assert!((one_box - 0.5 * 1.5 * 2.5 * 0.25).abs() < 1e-15, "{one_box}");
    assert!(hypervolume(&[], &[1.0, 1.0]).abs() < f64::MIN_POSITIVE);
    assert!(hypervolume(&[&[1.0, 0.0], &[f64::NAN, 0.0]], &[1.0, 1.0]).abs() < f64::MIN_POSITIVE, "on the edge");
    // The ball's orthant of radius 1 in the box of edge 1.1; the lattice converges to it from below.
    for (objectives, ball, steps) in [(2, PI / 4.0, 4000), (3, PI / 6.0, 120), (4, PI * PI / 32.0, 24)] {
        let front = MultiObjective::Dtlz2(objectives).front(steps);
        let exact = 1.1_f64.powi(objectives as i32) - ball;
        let found = hypervolume(&slices(&front), &vec![1.1; objectives]);
        println!("{objectives}: {found} of {exact}");
        assert!(found < exact && found > exact * [0.0, 0.0, 0.9995, 0.99, 0.92][objectives], "{found} of {exact}");
    }
}

#[test]
fn hypervolume_of_fronts_another_program_sampled() {
    #[derive(serde::Deserialize)]
    struct Sampled {
        hv_front_sampled: f64,
    }
    let text = include_str!("../../../tests/golden/golden_moo.json");
    let golden: serde_json::Value = serde_json::from_str(text).expect("the golden file");
    let cases = [
        ("zdt1", MultiObjective::Zdt1, 2000),
        ("zdt2", MultiObjective::Zdt2, 2000),
        ("zdt3", MultiObjective::Zdt3, 2000),
        ("dtlz2", MultiObjective::Dtlz2(3), 30),
    ];
    for (name, function, n) in cases {
        let theirs: Sampled = serde_json::from_value(golden[name].clone()).expect(name);
        let ours = hypervolume(&slices(&function.front(n)), &vec![1.1; function.objectives()]);
        let error = (ours - theirs.hv_front_sampled).abs();
        println!("{name}: {error:e}");
        assert!(error < 1e-9, "{name}: {ours} against {}", theirs.hv_front_sampled);
    }
}

/// By hand: truth (0, 1), (1, 0); the front's point (1, 1) is 1 from each, its point (0.5, -0.5) is ahead of (1, 0).
#[test]
fn distances_to_the_true_front_by_hand() {
    let truth: [&[f64]; 2] = [&[0.0, 1.0], &[1.0, 0.0]];
    assert!((igd(&[&[1.0, 1.0]], &truth) - 1.0).abs() < 1e-15);
    assert!((igd_plus(&[&[1.0, 1.0]], &truth) - 1.0).abs() < 1e-15);
    let ahead: [&[f64]; 1] = [&[0.5, -0.5]];
    assert!((igd(&ahead, &truth) - 0.5 * (2.5_f64.sqrt() + 0.5_f64.sqrt())).abs() < 1e-15);
    assert!((igd_plus(&ahead, &truth) - 0.5 * 0.5).abs() < 1e-15, "0.5 behind (0, 1) in the first cost only");
    assert!(igd(&[], &truth).is_infinite() && igd(&ahead, &[]).is_infinite());
}

/// A front of which every point is dominated by the other front, and that IGD nevertheless calls the better one.
#[test]
fn igd_plus_agrees_with_dominance() {
    let truth: [&[f64]; 5] = [&[0.0, 10.0], &[1.0, 6.0], &[2.0, 2.0], &[6.0, 1.0], &[10.0, 0.0]];
    let better: [&[f64]; 3] = [&[2.0, 4.0], &[3.0, 3.0], &[4.0, 2.0]];
    let worse: [&[f64]; 3] = [&[2.0, 8.0], &[4.0, 4.0], &[8.0, 2.0]];
    assert!(igd(&worse, &truth) < igd(&better, &truth));
    assert!(igd_plus(&worse, &truth) > igd_plus(&better, &truth));
}

#[test]
fn spread_by_hand() {
    let ends: [&[f64]; 2] = [&[0.0, 4.0], &[4.0, 0.0]];
    let even: [&[f64]; 3] = [&[2.0, 2.0], &[4.0, 0.0], &[0.0, 4.0]];
    assert!(spread(&even, &ends) < 1e-15);
    // Gaps of 1 and 3 diagonals, mean 2, to the ends: (1 + 1) / (4) of the same unit.
    let uneven: [&[f64]; 3] = [&[0.0, 4.0], &[1.0, 3.0], &[4.0, 0.0]];
    assert!((spread(&uneven, &ends) - 0.5).abs() < 1e-15);
    // Two points one diagonal from each end, two apart: (1 + 1 + 0) / (1 + 1 + 2).
    let short: [&[f64]; 2] = [&[1.0, 3.0], &[3.0, 1.0]];
    assert!((spread(&short, &ends) - 0.5).abs() < 1e-15);
    assert!(spread(&ends[..1], &ends).is_infinite());
    // Three objectives: nearest neighbours 1, 1, 2, mean 4/3, both ends in the front: (1/3 + 1/3 + 2/3) / 4.
    let line: [&[f64]; 3] = [&[0.0, 0.0, 0.0], &[1.0, 0.0, 0.0], &[3.0, 0.0, 0.0]];
    assert!((spread(&line, &[line[0], line[2]]) - 1.0 / 3.0).abs() < 1e-15);
}
