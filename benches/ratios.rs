//! How many times faster than the nalgebra baseline, and how far from the filter written by hand.
//!
//! `cargo bench --bench ratios`. Everything runs on one thread and is timed by the CPU time of the process, so that
//! waiting for a busy core does not count. Contenders take turns, and a ratio is the median over rounds of the ratio
//! within a round, so that a core that slows down slows all of them.

mod baseline;
mod contenders;
mod handwritten;

use contenders::Match;
use kfgpu::bench::cpu_time;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

const ROUNDS: usize = 25;

#[expect(clippy::print_stdout, reason = "the table is the result")]
fn main() {
    // `cargo test --benches` runs this with `--test`: one round shows that it works.
    let rounds = if std::env::args().any(|a| a == "--test") { 1 } else { ROUNDS };
    println!("| workload | program | Mstep per CPU-second | x nalgebra f64 | x by hand, same precision |");
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

/// CPU time, or wall time where the system does not tell it.
fn now() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    cpu_time().unwrap_or_else(|| START.elapsed())
}

/// Seconds of every contender in every round.
fn measure(game: &mut Match, rounds: usize) -> Vec<Vec<f64>> {
    game.contenders.iter_mut().for_each(|contender| (contender.evaluate)());
    let turn = |game: &mut Match| {
        let contenders = game.contenders.iter_mut();
        contenders
            .map(|contender| {
                let start = now();
                (contender.evaluate)();
                (now() - start).as_secs_f64()
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
