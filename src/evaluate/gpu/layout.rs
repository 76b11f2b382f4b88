//! How a program lies in GPU memory: the record in chunks of rows, one header a chunk, totals.

use crate::evaluate::Precision;
use crate::filter::{Program, Role};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// What one dispatch needs to know; `Chunk` of `shaders/filter.wgsl` begins with the same fields.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Header {
    /// Candidates in this part of the population.
    pub(super) candidates: u32,
    /// Candidates a row of every structure-of-arrays buffer.
    pub(super) stride: u32,
    /// Rows of the log.
    pub(super) rows: u32,
    /// 1 in the first chunk of a trajectory.
    pub(super) first: u32,
    /// Row of the prologue buffer where the trajectory's initial states begin.
    pub(super) initial: u32,
    /// Row of the totals buffer where the chunk's begin.
    pub(super) totals: u32,
    pub(super) reserved: [u32; 2],
}

/// Rows of one trajectory that one dispatch runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Chunk {
    /// Which trajectory.
    pub(super) trajectory: usize,
    /// Rows of the record.
    pub(super) rows: Range<usize>,
    /// Whether the trajectory begins here.
    pub(super) first: bool,
}

/// Sizes and places of a program's data. They depend on the problem alone, never on the adapter.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Packs (16 bytes) of the record that one row takes.
    pub(super) packs_a_row: usize,
    /// The chunks, in the order they are dispatched.
    pub(super) chunks: Vec<Chunk>,
    /// Totals a chunk: one a sum, two a product (exponent, mantissa), one for the check.
    pub(super) totals_a_chunk: usize,
    /// Carried states whose initial value depends on the candidate.
    pub(super) varying: usize,
    /// Carried states whose initial value does not.
    pub(super) uniform: usize,
}

impl Layout {
    /// Packs of the record that a dispatch sees: 64 KiB, what every adapter binds as a uniform.
    pub(super) const RECORD: usize = 4096;

    pub(super) fn new(program: &Program, precision: Precision) -> Self {
        let packs_a_row = program.columns.div_ceil(Self::width(precision)).max(1);
        // Whole blocks of rows, so that sums are moved at the same rows wherever a chunk ends.
        let rows = (Self::RECORD / packs_a_row / Program::BLOCK).max(1) * Program::BLOCK;
        let mut chunks = Vec::new();
        for (trajectory, span) in program.spans.iter().enumerate() {
            for begin in span.rows.clone().step_by(rows) {
                let end = (begin + rows).min(span.rows.end);
                chunks.push(Chunk { trajectory, rows: begin..end, first: begin == span.rows.start });
            }
        }
        let count = |role| program.carried.iter().filter(|c| c.role == role).count();
        let varying = program.varies.iter().filter(|v| **v).count();
        Self {
            packs_a_row,
            chunks,
            totals_a_chunk: count(Role::Sum) + 2 * count(Role::Product) + 1,
            varying,
            uniform: count(Role::State) - varying,
        }
    }

    /// Whether a block of rows fits the record that a dispatch sees.
    pub(super) const fn fits(&self) -> bool {
        self.packs_a_row * Program::BLOCK <= Self::RECORD
    }

    /// Numbers a pack.
    pub(super) const fn width(precision: Precision) -> usize {
        match precision {
            Precision::F32 => 4,
            Precision::F64 => 2,
        }
    }

    /// Packs of uniform initial states in a header.
    pub(super) fn starts(&self) -> usize {
        // At most 16 states x 17 / 2 + 16 entries are carried; the width of f64 serves both formats.
        self.uniform.div_ceil(2).max(1)
    }

    /// Bytes of one header with its starts.
    pub(super) fn header_bytes(&self) -> usize {
        size_of::<Header>() + 16 * self.starts()
    }
}

/// Numbers as the bytes of a kernel's format.
pub(super) fn bytes(values: impl IntoIterator<Item = f64>, precision: Precision) -> Vec<u8> {
    #[expect(clippy::cast_possible_truncation, reason = "rounded once, as the CPU lanes do")]
    match precision {
        Precision::F32 => values.into_iter().flat_map(|v| (v as f32).to_ne_bytes()).collect(),
        Precision::F64 => values.into_iter().flat_map(f64::to_ne_bytes).collect(),
    }
}

/// The record of a chunk, each row padded to whole packs.
pub(super) fn record(program: &Program, layout: &Layout, chunk: &Chunk, precision: Precision) -> Vec<u8> {
    let padded = layout.packs_a_row * Layout::width(precision);
    let row = |row: usize| {
        let values = &program.record[row * program.columns..(row + 1) * program.columns];
        values.iter().copied().chain(std::iter::repeat_n(0.0, padded - program.columns))
    };
    bytes(chunk.rows.clone().flat_map(row), precision)
}
