//! From the totals of chunks to costs: the last sums, in f64 on the host.

use super::layout::Layout;
use crate::evaluate::{Precision, Status};
use crate::filter::{Program, Role};
use rayon::prelude::*;

/// Totals of a part of a population as they came back: rows of `stride` numbers.
pub(super) struct Totals<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: usize,
    pub(super) precision: Precision,
}

impl Totals<'_> {
    fn at(&self, row: usize, candidate: usize) -> f64 {
        let i = row * self.stride + candidate;
        let read = |size: usize| &self.bytes[i * size..(i + 1) * size];
        match self.precision {
            Precision::F32 => f64::from(f32::from_ne_bytes(read(4).try_into().unwrap_or_default())),
            Precision::F64 => f64::from_ne_bytes(read(8).try_into().unwrap_or_default()),
        }
    }

    /// Costs and status of the first `n` candidates.
    pub(super) fn finish(&self, program: &Program, layout: &Layout, n: usize) -> (Vec<f64>, Vec<Status>) {
        let k = program.scorers();
        let mut costs = vec![0.0; n * k];
        let mut status = vec![Status::OK; n];
        let work = costs.par_chunks_mut(k.max(1)).zip(status.par_iter_mut()).enumerate();
        work.with_min_len(4096).for_each(|(candidate, (costs, status))| {
            *status = self.candidate(program, layout, candidate, costs);
        });
        (costs, status)
    }

    fn candidate(&self, program: &Program, layout: &Layout, candidate: usize, costs: &mut [f64]) -> Status {
        let width = program.totals();
        let mut sums = vec![0.0; program.spans.len() * width];
        let mut status = Status::OK;
        for (c, chunk) in layout.chunks.iter().enumerate() {
            let sums = &mut sums[chunk.trajectory * width..][..width];
            let mut row = c * layout.totals_a_chunk;
            let mut next = || {
                row += 1;
                self.at(row - 1, candidate)
            };
            let mut slot = 0;
            for carried in &program.carried {
                match carried.role {
                    Role::State => continue,
                    Role::Sum => sums[slot] += next(),
                    Role::Product => {
                        let logarithm = next() * std::f64::consts::LN_2 + next().ln();
                        sums[slot] += logarithm;
                        // The mantissa of a product that met a variance not positive, or not finite, is 0.
                        if !logarithm.is_finite() {
                            status = status.union(Status::NOT_POSITIVE);
                        }
                    }
                    Role::Check if next() <= 0.0 => status = status.union(Status::NOT_POSITIVE),
                    Role::Check => {}
                }
                slot += 1;
            }
        }
        program.costs(&sums, costs);
        status
    }
}
