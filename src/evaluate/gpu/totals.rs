//! From the totals of chunks to costs: the last sums, in f64 on the host.

use super::layout::{Layout, Round};
use crate::evaluate::{Precision, Status};
use crate::filter::{Program, Role};
use rayon::prelude::*;
use std::f64::consts::LN_2;

/// Totals of a round as they came back: rows of `stride` numbers.
pub(super) struct Totals<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: usize,
    pub(super) precision: Precision,
}

impl Totals<'_> {
    /// What a candidate has in a row.
    pub(super) fn at(&self, row: usize, candidate: usize) -> f64 {
        let i = row * self.stride + candidate;
        let read = |size: usize| &self.bytes[i * size..(i + 1) * size];
        match self.precision {
            Precision::F32 => f64::from(f32::from_ne_bytes(read(4).try_into().unwrap_or_default())),
            Precision::F64 => f64::from_ne_bytes(read(8).try_into().unwrap_or_default()),
        }
    }
}

/// What the rounds of a part of a population have come to so far.
pub(super) struct Sums<'a> {
    program: &'a Program,
    layout: &'a Layout,
    /// For each candidate the totals of the trajectory that is open, then what those before it were folded into.
    sums: Vec<f64>,
    status: Vec<Status>,
}

/// Candidates that a thread takes at a time.
const TASK: usize = 4096;

impl<'a> Sums<'a> {
    /// Of `n` candidates.
    pub(super) fn new(program: &'a Program, layout: &'a Layout, n: usize) -> Self {
        let width = program.totals() + program.folded();
        Self { program, layout, sums: vec![0.0; n * width.max(1)], status: vec![Status::OK; n] }
    }

    fn width(&self) -> usize {
        (self.program.totals() + self.program.folded()).max(1)
    }

    /// Adds a round.
    pub(super) fn add(&mut self, round: &Round, totals: &Totals<'_>) {
        let (program, layout, width) = (self.program, self.layout, self.width());
        let work = self.sums.par_chunks_mut(width).zip(self.status.par_iter_mut()).enumerate();
        work.with_min_len(TASK).for_each(|(candidate, (sums, status))| {
            let (open, folded) = sums.split_at_mut(program.totals());
            for (c, chunk) in layout.chunks[round.chunks.clone()].iter().enumerate() {
                let mut row = c * layout.totals_a_chunk;
                *status = status.union(add(program, open, || {
                    row += 1;
                    totals.at(row - 1, candidate)
                }));
                if chunk.last {
                    program.fold(chunk.trajectory, open, folded);
                    open.fill(0.0);
                }
            }
        });
    }

    /// Costs and status of every candidate.
    pub(super) fn finish(self) -> (Vec<f64>, Vec<Status>) {
        let (program, width, k) = (self.program, self.width(), self.program.scorers());
        let mut costs = vec![0.0; self.status.len() * k];
        let work = costs.par_chunks_mut(k.max(1)).zip(self.sums.par_chunks(width)).with_min_len(TASK);
        work.for_each(|(costs, sums)| program.costs(&sums[program.totals()..], costs));
        (costs, self.status)
    }
}

/// Adds the totals of one chunk, in the order in which the kernel stores them.
fn add(program: &Program, open: &mut [f64], mut next: impl FnMut() -> f64) -> Status {
    let mut status = Status::OK;
    let mut open = open.iter_mut();
    for carried in program.carried() {
        match carried.role {
            Role::State => {}
            Role::Check if next() <= 0.0 => status = status.union(Status::NOT_POSITIVE),
            Role::Check => {}
            role => {
                let Some(sum) = open.next() else { continue };
                let total = if role == Role::Sum { next() } else { next() * LN_2 + next().ln() };
                // The mantissa of a product that met a variance not positive, or not finite, is 0.
                if role == Role::Product && !total.is_finite() {
                    status = status.union(Status::NOT_POSITIVE);
                }
                *sum += total;
            }
        }
    }
    status
}
