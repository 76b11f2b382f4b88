//! From how many candidates an adapter is faster than the whole processor.

use super::engine::Engine;
use super::run::Prepared;
use super::times::{Times, median};
use super::{Adapter, BenchError, Options, Target, candidates};
use crate::evaluate::{Population, Precision};

/// Fewest candidates that are tried.
const FEWEST: usize = 64;
/// Factor from one rung of the ladder to the next.
const FACTOR: usize = 4;

/// Times of one population size.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Rung {
    /// Candidates.
    #[serde(rename = "N")]
    pub candidates: usize,
    /// Median time of the processor \[s\].
    pub cpu_s: f64,
    /// Median time of the adapter, end to end \[s\].
    pub adapter_s: f64,
}

/// An adapter, end to end, against all threads of the processor in the same number format.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Crossover {
    /// The adapter's name.
    pub adapter: String,
    /// Whether it is a program on the CPU that acts as a GPU.
    pub software: bool,
    /// `f32`, or `f64` where only that was asked for.
    pub dtype: String,
    /// Threads of the processor.
    pub threads: usize,
    /// The smallest population from which on the adapter was faster at every size tried; null if there is none.
    pub candidates: Option<usize>,
    /// What was tried, smallest first.
    pub ladder: Vec<Rung>,
}

/// Climbs from 64 candidates to `options.candidates` by factors of 4, both evaluators built once.
pub(super) fn find(
    options: &Options,
    prepared: &Prepared,
    adapter: &Adapter,
    threads: usize,
    precision: Precision,
) -> Result<Crossover, BenchError> {
    let engine = |target| Engine::new(&prepared.problem, &prepared.log, &target, precision);
    let mut cpu = engine(Target::Cpu { threads })?;
    let mut gpu = engine(Target::Gpu { adapter: Some(adapter.name.clone()) })?;
    let mut ladder = Vec::new();
    for n in sizes(options.candidates) {
        let population = candidates(&prepared.problem.parameters, n);
        let cpu_s = time(&mut cpu, &population, options)?;
        ladder.push(Rung { candidates: n, cpu_s, adapter_s: time(&mut gpu, &population, options)? });
    }
    Ok(Crossover {
        adapter: adapter.name.clone(),
        software: adapter.software,
        dtype: precision.to_string(),
        threads,
        candidates: crossing(&ladder),
        ladder,
    })
}

/// 64, 256, ... below `most`, then `most` itself.
fn sizes(most: usize) -> Vec<usize> {
    let powers = std::iter::successors(Some(FEWEST), |n| n.checked_mul(FACTOR));
    powers.take_while(|n| *n < most).chain([most]).collect()
}

/// Median time after one untimed evaluation, which makes buffers of the right size.
fn time(engine: &mut Engine, population: &Population, options: &Options) -> Result<f64, BenchError> {
    engine.evaluate(population)?;
    let times = Times::measure(options.repetitions, options.budget, || Ok(engine.evaluate(population)?.1))?;
    Ok(median(&times.wall).unwrap_or(f64::NAN))
}

/// Where the adapter begins to be faster and stays so.
fn crossing(ladder: &[Rung]) -> Option<usize> {
    ladder.iter().rev().take_while(|rung| rung.adapter_s < rung.cpu_s).last().map(|rung| rung.candidates)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ladder(times: &[(f64, f64)]) -> Vec<Rung> {
        let rung = |(i, (cpu_s, adapter_s)): (usize, &(f64, f64))| Rung {
            candidates: i + 1,
            cpu_s: *cpu_s,
            adapter_s: *adapter_s,
        };
        times.iter().enumerate().map(rung).collect()
    }

    #[test]
    fn the_adapter_must_stay_ahead() {
        assert_eq!(crossing(&ladder(&[(1.0, 9.0), (4.0, 9.0), (16.0, 10.0), (64.0, 20.0)])), Some(3));
        assert_eq!(crossing(&ladder(&[(9.0, 1.0), (4.0, 9.0), (16.0, 10.0)])), Some(3), "one lucky time is none");
        assert_eq!(crossing(&ladder(&[(1.0, 0.5), (4.0, 1.0)])), Some(1), "ahead from the start");
        assert_eq!(crossing(&ladder(&[(1.0, 2.0), (4.0, 4.0)])), None, "never ahead");
        assert_eq!(crossing(&[]), None, "nothing tried");
    }

    #[test]
    fn ladders_end_at_the_population_asked_for() {
        assert_eq!(sizes(10), [10]);
        assert_eq!(sizes(64), [64]);
        assert_eq!(sizes(1024), [64, 256, 1024]);
        assert_eq!(sizes(2000), [64, 256, 1024, 2000]);
    }
}
