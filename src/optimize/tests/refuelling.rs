//! PIO against PSO on the problem that the KF-PIO study tunes: R = M M' of a planar filter, scored against the truth.
//!
//! P_1, Q and H are identities, so in R's eigenvectors the filter is two scalar filters with R = the eigenvalues, and the
//! score is what they give. Truth moves exactly by the input, so only the error is carried.

use super::*;
use crate::random::{Purpose, Stream};
use rand_distr::{Distribution, StandardNormal};

const STEPS: usize = 50;

/// Measurement noise n_1 .. n_N with the standard deviation of the study.
fn noise(data_set: u64) -> Vec<[f64; 2]> {
    let mut stream = Stream::new(data_set, Purpose::MeasurementNoise, 0, 0);
    let mut draw = || 84.04 / STEPS as f64 * Distribution::<f64>::sample(&StandardNormal, &mut stream);
    (0..STEPS).map(|_| [draw(), draw()]).collect()
}

/// J = sum of |estimate - truth| for R = M M', M = [m0 m1; m2 m3].
fn score(m: &[f64], noise: &[[f64; 2]]) -> f64 {
    let (a, b, c) = (m[0] * m[0] + m[1] * m[1], m[0] * m[2] + m[1] * m[3], m[2] * m[2] + m[3] * m[3]);
    let half = (0.25 * (a - c).powi(2) + b * b).sqrt();
    let eigenvalues = [0.5 * (a + c) + half, (0.5 * (a + c) - half).max(0.0)];
    let (sin, cos) = (0.5 * (2.0 * b).atan2(a - c)).sin_cos();
    let rotated = |n: [f64; 2]| [cos * n[0] + sin * n[1], cos * n[1] - sin * n[0]];
    let (mut error, mut p) = (rotated(noise[0]), [1.0; 2]);
    let mut total = error[0].hypot(error[1]);
    for n in &noise[1..] {
        let n = rotated(*n);
        for d in 0..2 {
            let gain = (p[d] + 1.0) / (p[d] + 1.0 + eigenvalues[d]);
            error[d] += gain * (n[d] - error[d]);
            p[d] = (1.0 - gain) * (p[d] + 1.0);
        }
        total += error[0].hypot(error[1]);
    }
    total
}

fn search(name: &str, seed: u64, noise: &[[f64; 2]]) -> f64 {
    let space = Space {
        lower: vec![f64::NEG_INFINITY; 4],
        upper: vec![f64::INFINITY; 4],
        init: vec![[0.0, 10.0_f64.sqrt()]; 4],
        seeds: Vec::new(),
    };
    let mut optimizer = build(name, &space, &settings(200, 150, seed)).expect(name);
    let mut best = f64::INFINITY;
    while let Some(population) = optimizer.ask() {
        let costs: Vec<f64> = population.rows().map(|m| score(m, noise)).collect();
        best = costs.iter().copied().fold(best, f64::min);
        let status = vec![crate::population::Status::OK; costs.len()];
        optimizer.tell(&population, &Evaluation::new(1, costs, status));
    }
    best
}

/// E J at R = I is 71.34 by the closed form of the error variance; the standard error of 1000 sets is 0.19.
#[test]
fn untuned_score_matches_the_closed_form() {
    let mean = (0..1000).map(|set| score(&[1.0, 0.0, 0.0, 1.0], &noise(set))).sum::<f64>() / 1000.0;
    assert!((mean - 71.34).abs() < 0.8, "{mean}");
}

/// A separate program found the median of PIO/PSO at 1.17 to 1.25 and PIO+ within 1 % of PSO; here 12 data sets.
#[test]
fn published_pio_stops_early_and_the_repaired_form_does_not() {
    let (mut pio, mut plus) = (Vec::new(), Vec::new());
    for set in 0..12 {
        let noise = noise(1000 + set);
        let pso = search("pso", set, &noise);
        pio.push(search("pio", set, &noise) / pso);
        plus.push(search("pio+", set, &noise) / pso);
    }
    pio.sort_by(f64::total_cmp);
    println!("PIO/PSO {pio:.3?}\nPIO+/PSO {plus:.4?}");
    assert!((1.08..1.35).contains(&pio[6]) && pio[0] > 1.01, "{pio:?}");
    assert!(plus.iter().all(|ratio| (0.99..1.01).contains(ratio)), "{plus:?}");
}
