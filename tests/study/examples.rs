//! Shipped problems of nonlinear and of doubtful models against optima that other programs found.

use super::{open, tune};
use kfgpu::evaluate::CpuOptions;
use kfgpu::model::TuneSpec;
use kfgpu::reference::costs_held_out;
use kfgpu::study::Split;

/// 1671.29 by Nelder-Mead in numpy, good to about 0.1.
#[test]
fn a_robot_and_its_radios_are_calibrated_together() {
    let case = open("plaza2.toml");
    let spec = TuneSpec { population: 32, generations: 8, ..case.0.tune.clone() };
    let winner = tune(&case, &spec, CpuOptions::default()).winner.expect("a winner");
    assert!(winner.objectives[0] < 1671.3, "nll {}", winner.objectives[0]);
    let b = case.0.parameters.names().iter().position(|name| *name == "b").expect("b");
    assert!((winner.candidate[b] - 1.0693).abs() < 1e-3, "{:?}", winner.candidate);
}

/// What is tuned on the first half serves on the second: far better than radios taken at their word, and as good as the start
/// (which has the scale of the whole log) within 8.7 nats, the standard error that a report gives of their difference.
#[test]
fn what_the_first_half_says_of_the_radios_holds_in_the_second() {
    let (mut problem, log) = open("plaza2.toml");
    problem.data.validate = Some(kfgpu::data::ValidateSpec { share: 0.5, by: None });
    let split = Split::of(&problem, log).expect("a split");
    let held_out = split.held_out.expect("rows are held out");
    let spec = TuneSpec { population: 32, generations: 8, ..problem.tune.clone() };
    let case = (problem, split.train);
    let winner = tune(&case, &spec, CpuOptions::default()).winner.expect("a winner");
    let of = |candidate: &[f64]| costs_held_out(&case.0, &held_out, candidate).expect("runs")[0];
    let start = case.0.parameters.baseline();
    let mut at_their_word = start.clone();
    at_their_word[case.0.parameters.names().iter().position(|name| *name == "b").expect("b")] = 1.0;
    let (tuned, at_their_word, start) = (of(&winner.candidate), of(&at_their_word), of(&start));
    println!("held out: nll {tuned} tuned, {start} at the start, {at_their_word} without a scale");
    assert!(tuned < at_their_word - 1000.0, "{tuned}, without a scale {at_their_word}");
    assert!((tuned - start).abs() < 8.7, "{tuned}, at the start {start}");
}

/// statsmodels: 2208.3993 at phi 0.97917, sigma 0.16991, beta 0.6127.
#[test]
fn volatility_reaches_the_known_quasi_likelihood() {
    let case = open("volatility.toml");
    let winner = tune(&case, &case.0.tune, CpuOptions::default()).winner.expect("a winner");
    assert!((winner.objectives[0] - 2_208.399_345).abs() < 1e-5, "nll {}", winner.objectives[0]);
    for (found, known) in winner.candidate.iter().zip([0.97917, 0.16991, 0.6127]) {
        assert!((found / known - 1.0).abs() < 1e-3, "{:?}", winner.candidate);
    }
}
