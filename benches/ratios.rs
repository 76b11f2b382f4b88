//! How many times faster than the nalgebra baseline, and how far from the filter written by hand.
//!
//! `cargo bench --bench ratios` (for one core: `taskset -c 0 cargo bench --bench ratios`). Contenders take turns, and a
//! ratio is the median over rounds of the ratio within a round, so that a machine that slows down slows all of them.

mod baseline;
mod contenders;
mod handwritten;

use contenders::Match;
use std::time::Instant;

const ROUNDS: usize = 15;

#[expect(clippy::print_stdout, reason = "the table is the result")]
fn main() {
    // `cargo test --benches` runs this with `--test`: one round shows that it works.
    let rounds = if std::env::args().any(|a| a == "--test") { 1 } else { ROUNDS };
    println!("| workload | program | Mstep/s | x nalgebra f64 | x by hand, same precision |");
    println!("|---|---|---|---|---|");
    for mut game in contenders::matches() {
        let seconds = measure(&mut game, rounds);
        for (i, contender) in game.contenders.iter().enumerate() {
            let by_hand = if contender.name.ends_with("f32") { 2 } else { 1 };
            let rate = game.steps as f64 / median(seconds.iter().map(|round| round[i])) / 1e6;
            let to = |other: usize| median(seconds.iter().map(|round| round[other] / round[i]));
            let (name, workload) = (contender.name, game.workload);
            println!("| {workload} | {name} | {rate:.1} | {:.2} | {:.2} |", to(0), to(by_hand));
        }
    }
}

/// Seconds of every contender in every round.
fn measure(game: &mut Match, rounds: usize) -> Vec<Vec<f64>> {
    game.contenders.iter_mut().for_each(|contender| (contender.evaluate)());
    let turn = |game: &mut Match| {
        let contenders = game.contenders.iter_mut();
        contenders
            .map(|contender| {
                let start = Instant::now();
                (contender.evaluate)();
                start.elapsed().as_secs_f64()
            })
            .collect()
    };
    (0..rounds).map(|_| turn(game)).collect()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
