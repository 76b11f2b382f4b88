//! What is uploaded once for a program: the record in the order of its dispatches, and an entry for each chunk.

use super::device::Gpu;
use super::layout::{Chunk, Entry, Layout, bytes};
use super::prologue;
use crate::filter::{Cursor, Program};
use std::ops::Range;
use wgpu::BufferUsages as Usage;

/// Sizes as the kernel reads them; what the adapter's limits allow is far smaller.
pub(super) fn word(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

/// The entry of every chunk, with the initial states of its trajectory that are the same for every candidate.
pub(super) fn entries(gpu: &Gpu, program: &Program, layout: &Layout, baseline: &[f64]) -> wgpu::Buffer {
    let mut data = vec![0; layout.entry_bytes() * layout.chunks.len()];
    let rounds = layout.rounds.iter().flat_map(|round| round.chunks.clone().map(move |c| (c, round)));
    let chunks = layout.chunks.iter().zip(layout.begins()).zip(rounds);
    for (((chunk, begin), (c, round)), slot) in chunks.zip(data.chunks_mut(layout.entry_bytes())) {
        let entry = Entry {
            record: word(begin),
            rows: word(chunk.rows.len()),
            first: u32::from(chunk.first),
            last: u32::from(chunk.last),
            initial: word(program.invariants() + (chunk.trajectory - round.trajectories.start) * layout.varying),
            totals: word((c - round.chunks.start) * layout.totals_a_chunk),
            reserved: [0; 2],
        };
        let (head, starts) = slot.split_at_mut(size_of::<Entry>());
        head.copy_from_slice(bytemuck::bytes_of(&entry));
        if chunk.first {
            let values = prologue::starts(program, &program.spans()[chunk.trajectory], baseline);
            let values = bytes(values, program.precision());
            starts[..values.len()].copy_from_slice(&values);
        }
    }
    upload(gpu, "chunks", &data, Usage::STORAGE)
}

/// Bytes of the record of all dispatches, as [`record`] lays them out.
pub(super) fn record_bytes(gpu: &Gpu, layout: &Layout) -> u64 {
    let alignment = u64::from(gpu.limits.min_uniform_buffer_offset_alignment.max(16));
    let rows = |dispatch: &Range<usize>| layout.chunks[dispatch.clone()].iter().map(|c| c.rows.len()).sum::<usize>();
    let bytes = |dispatch| 16 * (rows(dispatch) * layout.packs_a_row) as u64;
    let dispatches: u64 = layout.dispatches.iter().map(|d| bytes(d).next_multiple_of(alignment)).sum();
    dispatches + 16 * Layout::RECORD as u64
}

/// The record of every dispatch in one buffer, its chunks one behind the other; dispatches overlap in the padding that each
/// binds behind its own.
pub(super) fn record(gpu: &Gpu, program: &Program, layout: &Layout) -> (wgpu::Buffer, Vec<u32>) {
    let alignment = gpu.limits.min_uniform_buffer_offset_alignment.max(16) as usize;
    let mut offsets = Vec::with_capacity(layout.dispatches.len());
    let mut data: Vec<u8> = Vec::new();
    let mut cursor = program.cursor(0);
    for dispatch in &layout.dispatches {
        data.resize(data.len().next_multiple_of(alignment), 0);
        offsets.push(word(data.len()));
        for chunk in &layout.chunks[dispatch.clone()] {
            if chunk.first {
                cursor = program.cursor(chunk.trajectory);
            }
            data.extend(chunk_record(program, layout, chunk, &mut cursor));
        }
    }
    data.resize(data.len() + 16 * Layout::RECORD, 0);
    (upload(gpu, "record", &data, Usage::UNIFORM), offsets)
}

fn upload(gpu: &Gpu, label: &str, data: &[u8], usage: Usage) -> wgpu::Buffer {
    let buffer = gpu.buffer(label, data.len() as u64, usage | Usage::COPY_DST);
    gpu.queue.write_buffer(&buffer, 0, data);
    buffer
}

/// The record of a chunk, each row padded to whole packs. Where there are several steps, a row begins with its own.
fn chunk_record(program: &Program, layout: &Layout, chunk: &Chunk, cursor: &mut Cursor<'_>) -> Vec<u8> {
    let (several, padded) = (program.steps().len() > 1, layout.packs_a_row * Layout::width(program.precision()));
    let row = |row: usize| {
        #[expect(clippy::cast_precision_loss, reason = "a handful of kinds")]
        let kind = several.then_some(program.kind(row) as f64);
        let (_, columns) = cursor.step(row);
        let rest = padded - columns.len() - usize::from(several);
        kind.into_iter().chain(columns.iter().copied()).chain(std::iter::repeat_n(0.0, rest))
    };
    bytes(chunk.rows.clone().flat_map(row), program.precision())
}
