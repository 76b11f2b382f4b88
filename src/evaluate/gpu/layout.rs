//! How a program lies in GPU memory: the record in chunks of rows, dispatches of one or more chunks, totals.

use crate::filter::{Program, Role, Step};
use crate::precision::Precision;
use crate::tape::lanes::Lane;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// What one dispatch needs to know; `Dispatch` of `shaders/filter.wgsl` has the same fields.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Header {
    /// Candidates in this part of the population.
    pub(super) candidates: u32,
    /// Candidates a row of every structure-of-arrays buffer.
    pub(super) stride: u32,
    /// The first of its chunks.
    pub(super) chunk: u32,
    pub(super) reserved: u32,
}

/// What an invocation needs to know of its chunk; `Chunk` of `shaders/filter.wgsl` begins with the same fields.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Entry {
    /// Pack of the dispatch's record where its rows begin.
    pub(super) record: u32,
    /// Rows of the log.
    pub(super) rows: u32,
    /// 1 in the first chunk of a trajectory.
    pub(super) first: u32,
    /// 1 in the last chunk of a trajectory.
    pub(super) last: u32,
    /// Row of the prologue buffer where the trajectory's initial states begin.
    pub(super) initial: u32,
    /// Row of the totals buffer where the chunk's begin.
    pub(super) totals: u32,
    pub(super) reserved: [u32; 2],
}

/// Sizes of a program.
#[derive(Debug, Clone, Copy)]
struct Shape {
    precision: Precision,
    /// Numbers of the record that a row takes.
    columns: usize,
    totals_a_chunk: usize,
    varying: usize,
    uniform: usize,
}

impl Shape {
    fn of(program: &Program) -> Self {
        let count = |role| program.carried().iter().filter(|c| c.role == role).count();
        let varying = program.varies().iter().filter(|v| **v).count();
        Self {
            precision: program.precision(),
            columns: numbers_a_row(program),
            totals_a_chunk: count(Role::Sum) + 2 * count(Role::Product) + 1,
            varying,
            uniform: count(Role::State) - varying,
        }
    }
}

/// Numbers of the record that a row takes: which step runs, where there are several, and the columns of the widest.
pub(super) fn numbers_a_row(program: &Program) -> usize {
    let columns = program.steps().iter().map(Step::columns).max().unwrap_or(0);
    columns + usize::from(program.steps().len() > 1)
}

/// Rows of one trajectory that one invocation runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Chunk {
    /// Which trajectory.
    pub(super) trajectory: usize,
    /// Rows of the record.
    pub(super) rows: Range<usize>,
    /// Whether the trajectory begins here.
    pub(super) first: bool,
    /// Whether it ends here.
    pub(super) last: bool,
}

/// Dispatches whose totals are read back together, so that memory does not grow with the number of trajectories.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Round {
    /// Of [`Layout::dispatches`].
    pub(super) dispatches: Range<usize>,
    /// Of [`Layout::chunks`].
    pub(super) chunks: Range<usize>,
    /// Those that its chunks belong to; the first and the last may go on in another round.
    pub(super) trajectories: Range<usize>,
}

/// Sizes and places of a program's data. They depend on the problem alone, never on the adapter.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    /// Packs (16 bytes) of the record that one row takes.
    pub(super) packs_a_row: usize,
    /// The chunks, in the order they are dispatched.
    pub(super) chunks: Vec<Chunk>,
    /// The chunks of each dispatch. They belong to different trajectories, and their records fit what a dispatch sees.
    pub(super) dispatches: Vec<Range<usize>>,
    /// The dispatches of each round.
    pub(super) rounds: Vec<Round>,
    /// Totals a chunk: one a sum, two a product (exponent, mantissa), one for the check.
    pub(super) totals_a_chunk: usize,
    /// Carried states whose initial value depends on the candidate.
    pub(super) varying: usize,
    /// Carried states whose initial value does not.
    pub(super) uniform: usize,
    /// Rows behind the totals of a round for what is carried into the last row of a trajectory and every value of its step;
    /// 0 where nobody looks.
    pub(super) traced: usize,
}

impl Layout {
    /// Packs of the record that a dispatch sees: 64 KiB, what every adapter binds as a uniform.
    pub(super) const RECORD: usize = 4096;
    /// Numbers a candidate that a round may write, unless a single dispatch writes more.
    const ROUND: usize = 8192;

    pub(super) fn new(program: &Program) -> Self {
        Self::grouped(program, usize::MAX)
    }

    /// With room for what the last row leaves.
    pub(super) fn traced(program: &Program) -> Self {
        let operations = program.steps().iter().map(|step| step.tape().operations.len()).max().unwrap_or(0);
        Self { traced: program.carried().len() + operations, ..Self::new(program) }
    }

    /// With at most `largest` trajectories in a dispatch.
    pub(super) fn grouped(program: &Program, largest: usize) -> Self {
        let spans: Vec<Range<usize>> = program.spans().iter().map(|span| span.rows.clone()).collect();
        Self::arranged(&Shape::of(program), &spans, largest)
    }

    fn arranged(shape: &Shape, spans: &[Range<usize>], largest: usize) -> Self {
        let packs_a_row = shape.columns.div_ceil(Self::width(shape.precision)).max(1);
        // Whole blocks of rows, so that sums are moved at the same rows wherever a chunk ends.
        let rows = (Self::RECORD / packs_a_row / Program::BLOCK).max(1) * Program::BLOCK;
        let mut chunks = Vec::new();
        for (trajectory, span) in spans.iter().enumerate() {
            for begin in span.clone().step_by(rows) {
                let end = (begin + rows).min(span.end);
                let (first, last) = (begin == span.start, end == span.end);
                chunks.push(Chunk { trajectory, rows: begin..end, first, last });
            }
        }
        let Shape { totals_a_chunk, varying, uniform, .. } = *shape;
        let dispatches = dispatches(&chunks, packs_a_row, largest);
        Self {
            packs_a_row,
            rounds: rounds(&chunks, &dispatches, Self::ROUND / totals_a_chunk.max(varying)),
            dispatches,
            chunks,
            totals_a_chunk,
            varying,
            uniform,
            traced: 0,
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

    /// Packs of uniform initial states in an entry.
    pub(super) fn starts(&self) -> usize {
        // The width of f64 serves both formats.
        self.uniform.div_ceil(2).max(1)
    }

    /// Bytes of one entry with its starts.
    pub(super) fn entry_bytes(&self) -> usize {
        size_of::<Entry>() + 16 * self.starts()
    }

    /// Rows of the totals buffer: enough for every round, and what is traced.
    pub(super) fn totals_rows(&self) -> usize {
        self.rounds.iter().map(|round| round.chunks.len()).max().unwrap_or(0) * self.totals_a_chunk + self.traced
    }

    /// Varying initial states of the round that has most.
    pub(super) fn most_initial(&self) -> usize {
        self.rounds.iter().map(|round| round.trajectories.len()).max().unwrap_or(0) * self.varying
    }

    /// For each chunk the pack of its dispatch's record where its rows begin.
    pub(super) fn begins(&self) -> Vec<usize> {
        let mut begins = Vec::with_capacity(self.chunks.len());
        for dispatch in &self.dispatches {
            let mut next = 0;
            for chunk in &self.chunks[dispatch.clone()] {
                begins.push(next);
                next += chunk.rows.len() * self.packs_a_row;
            }
        }
        begins
    }
}

/// Consecutive chunks side by side while their records fit and there are no more than `largest`. A chunk whose trajectory
/// goes on stands alone, because what is carried to the next dispatch has one place.
fn dispatches(chunks: &[Chunk], packs_a_row: usize, largest: usize) -> Vec<Range<usize>> {
    let mut dispatches: Vec<Range<usize>> = Vec::new();
    let mut packs = 0;
    for (i, chunk) in chunks.iter().enumerate() {
        let own = chunk.rows.len() * packs_a_row;
        match dispatches.last_mut() {
            Some(open)
                if open.len() < largest && chunk.last && chunks[open.start].last && packs + own <= Layout::RECORD =>
            {
                open.end = i + 1;
                packs += own;
            }
            _ => {
                dispatches.push(i..i + 1);
                packs = own;
            }
        }
    }
    dispatches
}

/// Consecutive dispatches of up to `largest` chunks together.
fn rounds(chunks: &[Chunk], dispatches: &[Range<usize>], largest: usize) -> Vec<Round> {
    let mut rounds: Vec<Round> = Vec::new();
    for (i, dispatch) in dispatches.iter().enumerate() {
        let last = chunks[dispatch.end - 1].trajectory + 1;
        match rounds.last_mut() {
            Some(open) if open.chunks.len() + dispatch.len() <= largest => {
                (open.dispatches.end, open.chunks.end, open.trajectories.end) = (i + 1, dispatch.end, last);
            }
            _ => {
                let trajectories = chunks[dispatch.start].trajectory..last;
                rounds.push(Round { dispatches: i..i + 1, chunks: dispatch.clone(), trajectories });
            }
        }
    }
    rounds
}

/// Numbers as the bytes of a kernel's format.
pub(super) fn bytes(values: impl IntoIterator<Item = f64>, precision: Precision) -> Vec<u8> {
    fn rounded<T: Lane + Pod>(values: impl Iterator<Item = f64>) -> Vec<u8> {
        let values: Vec<T> = values.map(T::from_f64).collect();
        bytemuck::cast_slice(&values).to_vec()
    }
    match precision {
        Precision::F32 => rounded::<f32>(values.into_iter()),
        Precision::F64 => rounded::<f64>(values.into_iter()),
    }
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

    type Members = Vec<(String, usize)>;

    /// Name and offset of the members of a structure as naga lays them out, and its size.
    fn members_by_naga(source: &str, name: &str) -> (Members, usize) {
        let module = naga::front::wgsl::parse_str(source).unwrap();
        let found = module.types.iter().find_map(|(_, t)| match &t.inner {
            naga::TypeInner::Struct { members, span } if t.name.as_deref() == Some(name) => Some((members, *span)),
            _ => None,
        });
        let (members, span) = found.unwrap();
        let place = |m: &naga::StructMember| (m.name.clone().unwrap(), m.offset as usize);
        (members.iter().map(place).collect(), span as usize)
    }

    fn named(members: &[(&str, usize)]) -> Members {
        members.iter().map(|(name, offset)| ((*name).to_owned(), *offset)).collect()
    }

    #[test]
    fn headers_and_entries_lie_where_the_kernel_reads_them() {
        for precision in [Precision::F32, Precision::F64] {
            let evaluator = evaluator(precision);
            let layout = Layout::new(evaluator.program());
            let source = super::super::assemble(evaluator.program()).unwrap();
            let header = named(&[
                ("candidates", offset_of!(Header, candidates)),
                ("stride", offset_of!(Header, stride)),
                ("chunk", offset_of!(Header, chunk)),
                ("reserved", offset_of!(Header, reserved)),
            ]);
            assert_eq!(members_by_naga(&source, "Dispatch"), (header, size_of::<Header>()), "{precision}");
            let reserved = offset_of!(Entry, reserved);
            let entry = named(&[
                ("record", offset_of!(Entry, record)),
                ("rows", offset_of!(Entry, rows)),
                ("first", offset_of!(Entry, first)),
                ("last", offset_of!(Entry, last)),
                ("initial", offset_of!(Entry, initial)),
                ("totals", offset_of!(Entry, totals)),
                ("reserved_a", reserved),
                ("reserved_b", reserved + 4),
                ("starts", size_of::<Entry>()),
            ]);
            assert_eq!(
                members_by_naga(&source, "Chunk"),
                (entry, layout.entry_bytes()),
                "{precision}: with its starts"
            );
        }
    }

    #[test]
    fn chunks_hold_whole_blocks_and_cover_every_row_once() {
        let shape = Shape::of(evaluator(Precision::F32).program());
        let spans = [0..5, 5..5, 5..9000];
        let layout = |columns| Layout::arranged(&Shape { columns, ..shape }, &spans, usize::MAX);
        for columns in [1, 4, 5, 40, 512] {
            let layout = layout(columns);
            assert!(layout.fits(), "{columns} columns");
            let rows: Vec<usize> = layout.chunks.iter().flat_map(|c| c.rows.clone()).collect();
            assert_eq!(rows, (0..9000).collect::<Vec<_>>(), "{columns} columns: every row once, in order");
            for (chunk, next) in layout.chunks.iter().zip(layout.chunks.iter().skip(1)) {
                assert!(chunk.rows.len() * layout.packs_a_row <= Layout::RECORD, "{columns} columns: {chunk:?}");
                assert!(next.first || chunk.rows.len().is_multiple_of(Program::BLOCK), "{columns} columns: {chunk:?}");
            }
            assert_eq!(layout.chunks.iter().filter(|c| c.first).count(), 2, "an empty trajectory has no chunk");
        }
        assert!(!layout(513).fits(), "a block of rows does not fit the record");
    }

    #[test]
    fn rounds_bound_what_many_trajectories_write() {
        let shape = Shape { columns: 5, ..Shape::of(evaluator(Precision::F32).program()) };
        for lengths in [&[2; 50_000][..], &[5000; 40], &[1, 400_000, 1]] {
            let layout = Layout::arranged(&shape, &spans(lengths), usize::MAX);
            // 2048 rows a dispatch, so at most as many trajectories.
            assert!(layout.totals_rows() <= 2048 * layout.totals_a_chunk, "{} rows", layout.totals_rows());
            let chunks: Vec<usize> = layout.rounds.iter().flat_map(|round| round.chunks.clone()).collect();
            assert_eq!(chunks, (0..layout.chunks.len()).collect::<Vec<_>>(), "every chunk in one round");
            for round in &layout.rounds {
                let of = |c: usize| layout.chunks[c].trajectory;
                assert_eq!(round.trajectories, of(round.chunks.start)..of(round.chunks.end - 1) + 1);
                let dispatches = &layout.dispatches[round.dispatches.clone()];
                assert_eq!(round.chunks, dispatches[0].start..dispatches[dispatches.len() - 1].end);
            }
        }
    }

    fn spans(lengths: &[usize]) -> Vec<Range<usize>> {
        let mut next = 0;
        let span = |length: &usize| {
            next += length;
            next - length..next
        };
        lengths.iter().map(span).collect()
    }

    #[test]
    fn a_dispatch_takes_the_trajectories_that_fit_its_record() {
        let shape = Shape { columns: 5, ..Shape::of(evaluator(Precision::F32).program()) };
        // 2 packs a row: 2048 rows a dispatch.
        for (lengths, sizes) in [
            (&[2048][..], &[1][..]),
            (&[1024, 1024, 1], &[2, 1]),
            (&[2000, 0, 48, 1], &[2, 1]),
            // A long one goes on alone, and only its last chunk has room for others.
            (&[10, 2049, 2047, 1], &[1, 1, 2, 1]),
            (&[10, 5000, 10, 10], &[1, 1, 1, 3]),
            (&[1; 2100], &[2048, 52]),
        ] {
            let spans = spans(lengths);
            let layout = Layout::arranged(&shape, &spans, usize::MAX);
            let found: Vec<usize> = layout.dispatches.iter().map(Range::len).collect();
            assert_eq!(found, sizes, "{} trajectories", lengths.len());
            let chunks: Vec<usize> = layout.dispatches.iter().cloned().flatten().collect();
            assert_eq!(chunks, (0..layout.chunks.len()).collect::<Vec<_>>(), "every chunk once, in order");
            let begins = layout.begins();
            for dispatch in &layout.dispatches {
                let last = dispatch.end - 1;
                let packs = begins[last] + layout.chunks[last].rows.len() * layout.packs_a_row;
                assert!(begins[dispatch.start] == 0 && packs <= Layout::RECORD, "{dispatch:?}: {packs} packs");
                let mut of: Vec<usize> = layout.chunks[dispatch.clone()].iter().map(|c| c.trajectory).collect();
                of.dedup();
                assert_eq!(of.len(), dispatch.len(), "{dispatch:?}: one chunk a trajectory");
            }
            assert!(layout.rounds.len() == 1 || lengths.len() > 2000, "short logs come back at once");
            let alone = Layout::arranged(&shape, &spans, 1);
            assert_eq!(alone.dispatches.len(), layout.chunks.len(), "one chunk a dispatch where that is asked for");
        }
    }
}
