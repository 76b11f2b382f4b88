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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Log;
    use crate::evaluate::{CpuEvaluator, CpuOptions};
    use crate::model::Problem;
    use std::mem::offset_of;
    use std::path::Path;

    fn evaluator(precision: Precision) -> CpuEvaluator {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/uav_gps_ca.toml");
        let problem = Problem::open(&path).unwrap();
        let log = Log::open(&problem.data, path.parent().unwrap()).unwrap();
        CpuEvaluator::new(&problem, &log, CpuOptions { precision, threads: None }).unwrap()
    }

    /// Name and offset of the members of `Chunk` as naga lays them out, and its size.
    fn chunk_by_naga(source: &str) -> (Vec<(String, usize)>, usize) {
        let module = naga::front::wgsl::parse_str(source).unwrap();
        let found = module.types.iter().find_map(|(_, t)| match &t.inner {
            naga::TypeInner::Struct { members, span } if t.name.as_deref() == Some("Chunk") => Some((members, *span)),
            _ => None,
        });
        let (members, span) = found.unwrap();
        let place = |m: &naga::StructMember| (m.name.clone().unwrap(), m.offset as usize);
        (members.iter().map(place).collect(), span as usize)
    }

    #[test]
    fn the_header_lies_where_the_kernel_reads_it() {
        for precision in [Precision::F32, Precision::F64] {
            let evaluator = evaluator(precision);
            let layout = Layout::new(evaluator.program(), precision);
            let source = super::super::assemble(evaluator.program(), precision).unwrap();
            let (members, span) = chunk_by_naga(&source);
            let reserved = offset_of!(Header, reserved);
            let expected = [
                ("candidates", offset_of!(Header, candidates)),
                ("stride", offset_of!(Header, stride)),
                ("rows", offset_of!(Header, rows)),
                ("first", offset_of!(Header, first)),
                ("initial", offset_of!(Header, initial)),
                ("totals", offset_of!(Header, totals)),
                ("reserved_a", reserved),
                ("reserved_b", reserved + 4),
                ("starts", size_of::<Header>()),
            ];
            let members: Vec<(&str, usize)> = members.iter().map(|(name, offset)| (name.as_str(), *offset)).collect();
            assert_eq!(members, expected, "{precision}");
            assert_eq!(span, layout.header_bytes(), "{precision}: the whole header");
        }
    }

    #[test]
    fn chunks_hold_whole_blocks_and_cover_every_row_once() {
        let evaluator = evaluator(Precision::F32);
        let mut program = evaluator.program().clone();
        let scalars = vec![];
        let spans = [0..5, 5..5, 5..9000];
        program.spans = spans.into_iter().map(|rows| crate::filter::Span { rows, scalars: scalars.clone() }).collect();
        for columns in [1, 4, 5, 40, 512] {
            program.columns = columns;
            let layout = Layout::new(&program, Precision::F32);
            assert!(layout.fits(), "{columns} columns");
            let rows: Vec<usize> = layout.chunks.iter().flat_map(|c| c.rows.clone()).collect();
            assert_eq!(rows, (0..9000).collect::<Vec<_>>(), "{columns} columns: every row once, in order");
            for (chunk, next) in layout.chunks.iter().zip(layout.chunks.iter().skip(1)) {
                assert!(chunk.rows.len() * layout.packs_a_row <= Layout::RECORD, "{columns} columns: {chunk:?}");
                assert!(next.first || chunk.rows.len().is_multiple_of(Program::BLOCK), "{columns} columns: {chunk:?}");
            }
            assert_eq!(layout.chunks.iter().filter(|c| c.first).count(), 2, "an empty trajectory has no chunk");
        }
        program.columns = 513;
        assert!(!Layout::new(&program, Precision::F32).fits(), "a block of rows does not fit the record");
    }
}
