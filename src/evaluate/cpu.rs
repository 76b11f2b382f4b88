//! The CPU evaluator: the tape over blocks of candidates, blocks over threads.

use super::block::{Blocks, Rounded, Totals, instruction_set};
use super::{Backend, Device, Evaluation, Evaluator, Population, Precision, Status, scored};
use crate::filter::Program;
use crate::words::counted;
use rayon::prelude::*;
use std::num::NonZero;

/// Candidates of the narrowest block.
const NARROWEST: usize = 8;

/// How the CPU evaluator runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CpuOptions {
    /// Number format of the filter; f32 runs in deviation from an f64 nominal.
    pub precision: Precision,
    /// Number of threads; `None` = one a core. It never changes a result.
    pub threads: Option<NonZero<usize>>,
}

impl Default for CpuOptions {
    fn default() -> Self {
        Self { precision: Precision::F64, threads: None }
    }
}

/// Scores populations on the CPU.
#[derive(Debug)]
pub struct CpuEvaluator {
    machine: Machine,
    threads: usize,
    pool: Option<rayon::ThreadPool>,
}

#[derive(Debug)]
enum Machine {
    F32(Rounded<f32>),
    F64(Rounded<f64>),
}

impl CpuEvaluator {
    /// An evaluator that runs a traced program, in the precision that it is for.
    #[must_use]
    pub fn of_program(program: Program, threads: Option<NonZero<usize>>) -> Self {
        let machine = match program.precision() {
            Precision::F64 => Machine::F64(Rounded::new(program)),
            Precision::F32 => Machine::F32(Rounded::new(program)),
        };
        Self { machine, threads: threads.map_or_else(cores, NonZero::get), pool: None }
    }

    /// The program that runs.
    #[must_use]
    pub const fn program(&self) -> &Program {
        match &self.machine {
            Machine::F32(rounded) => &rounded.program,
            Machine::F64(rounded) => &rounded.program,
        }
    }

    /// Candidates of the widest block.
    fn widest(&self) -> usize {
        match &self.machine {
            Machine::F32(rounded) => f32::widest(&rounded.program),
            Machine::F64(rounded) => f64::widest(&rounded.program),
        }
    }

    /// Candidates a task, of `population`: whole blocks, so many that a task takes about a millisecond. Of a population
    /// that is no more than a block a thread the blocks are narrower, where the log is so long that threads pay.
    fn task(&self, population: usize) -> usize {
        /// Lane operations a core does in about a millisecond.
        const OPERATIONS: usize = 4_000_000;
        let program = self.program();
        let candidate = program.operations();
        let narrow = population.div_ceil(self.threads).next_multiple_of(NARROWEST);
        if narrow < self.widest() && candidate * narrow >= OPERATIONS / 4 {
            return narrow;
        }
        OPERATIONS.div_ceil((candidate * self.widest()).max(1)) * self.widest()
    }

    /// Scores and status of some candidates (row-major).
    fn score(&self, candidates: &[f64]) -> (Vec<f64>, Vec<Status>) {
        let program = self.program();
        let (d, k) = (program.parameters().max(1), program.scorers());
        let mut costs = vec![0.0; candidates.len() / d * k];
        let mut status = Vec::with_capacity(candidates.len() / d);
        let blocks = candidates.chunks(self.widest() * d).zip(costs.chunks_mut(self.widest() * k.max(1)));
        for (block, costs) in blocks {
            let totals: Totals = match &self.machine {
                Machine::F32(rounded) => f32::run(rounded, block),
                Machine::F64(rounded) => f64::run(rounded, block),
            };
            let width = program.folded();
            for (i, costs) in costs.chunks_exact_mut(k.max(1)).enumerate() {
                program.costs(&totals.folded[i * width..(i + 1) * width], costs);
            }
            status.extend(totals.status);
        }
        for i in program.positivity().refused(candidates) {
            status[i] = status[i].union(Status::NOT_POSITIVE);
        }
        (costs, status)
    }

    /// Scores tasks on the evaluator's threads.
    fn score_parallel(&mut self, values: &[f64], task: usize) -> Vec<(Vec<f64>, Vec<Status>)> {
        let stride = task * self.program().parameters().max(1);
        if self.pool.is_none() {
            self.pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build().ok();
        }
        match &self.pool {
            Some(pool) => pool.install(|| values.par_chunks(stride).map(|chunk| self.score(chunk)).collect()),
            None => vec![self.score(values)],
        }
    }
}

impl Evaluator for CpuEvaluator {
    fn objectives(&self) -> usize {
        self.program().objectives()
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        let values = population.values();
        let task = self.task(population.len());
        let parts = if self.threads == 1 || population.len() <= task {
            vec![self.score(values)]
        } else {
            self.score_parallel(values, task)
        };
        scored(self.program(), parts)
    }

    fn device(&self) -> Device {
        let precision = self.program().precision();
        Device {
            backend: Backend::Cpu,
            adapter: format!("{}, {}", instruction_set(), counted(self.threads, "thread")).into(),
            precision,
        }
    }

    fn rows(&self) -> usize {
        self.program().rows()
    }
}

/// Number of cores this process may use.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}
