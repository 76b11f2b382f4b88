//! What a candidate brings to the kernel, computed on the host in f64 and rounded once: invariants, initial states.

use super::layout::{Layout, Round};
use crate::filter::{Initial, Program, Span};
use crate::precision::Precision;
use crate::tape::lanes::{Lane, Register, run_apart, run_one};
use bytemuck::Pod;
use rayon::prelude::*;

const C: usize = 8;
const B: usize = 8;
/// Candidates that a thread takes at a time: whole blocks.
const TASK: usize = 32 * C * B;

/// Registers of the prologue that go to the GPU for every trajectory (invariants) or for each (initial states).
fn registers(program: &Program) -> (Vec<usize>, Vec<usize>) {
    let results = program.initial().filter_map(|initial| match initial {
        Initial::Result(register) => Some(register),
        Initial::Number(_) => None,
    });
    let results: Vec<usize> = results.collect();
    let (states, invariants) = results.split_at(program.varies().len());
    let varying = states.iter().zip(program.varies()).filter(|(_, varies)| **varies);
    (invariants.to_vec(), varying.map(|(register, _)| *register).collect())
}

/// Rows of the prologue buffer: the invariants, then the varying initial states of each trajectory of a round.
pub(super) fn rows(program: &Program, layout: &Layout) -> usize {
    program.invariants() + layout.most_initial()
}

/// Hands over the prologue buffer of some candidates (row-major) in a round, `stride` candidates a row.
pub(super) fn with_buffer(
    program: &Program,
    round: &Round,
    candidates: &[f64],
    stride: usize,
    take: impl FnOnce(&[u8]),
) {
    match program.precision() {
        Precision::F32 => take(bytemuck::cast_slice(&values::<f32>(program, round, candidates, stride))),
        Precision::F64 => take(bytemuck::cast_slice(&values::<f64>(program, round, candidates, stride))),
    }
}

fn values<T: Lane + Pod>(program: &Program, round: &Round, candidates: &[f64], stride: usize) -> Vec<T> {
    let (invariants, varying) = registers(program);
    let rows = invariants.len() + varying.len() * round.trajectories.len();
    let mut values = vec![T::ZERO; rows * stride];
    let mut tasks: Vec<Vec<&mut [T]>> = (0..stride.div_ceil(TASK)).map(|_| Vec::with_capacity(rows)).collect();
    for row in values.chunks_mut(stride.max(1)) {
        tasks.iter_mut().zip(row.chunks_mut(TASK)).for_each(|(task, part)| task.push(part));
    }
    let candidates = candidates.par_chunks(TASK * program.parameters().max(1));
    tasks.into_par_iter().zip(candidates).for_each(|(mut rows, candidates)| {
        let (shared, own) = rows.split_at_mut(invariants.len());
        fill(program, &program.spans()[round.trajectories.start], candidates, &invariants, shared);
        for (t, rows) in round.trajectories.clone().zip(own.chunks_mut(varying.len().max(1))) {
            fill(program, &program.spans()[t], candidates, &varying, rows);
        }
    });
    values
}

/// Runs the prologue in blocks and copies some registers out, one row each.
fn fill<T: Lane>(program: &Program, span: &Span, candidates: &[f64], wanted: &[usize], rows: &mut [&mut [T]]) {
    let d = program.parameters().max(1);
    let mut registers = vec![Register::<f64, C, B>::splat(0.0); program.prologue().registers];
    for (block, candidates) in candidates.chunks(C * B * d).enumerate() {
        let n = candidates.len() / d;
        for (lane, candidate) in candidates.chunks_exact(d).enumerate() {
            candidate.iter().enumerate().for_each(|(p, v)| registers[p].lanes_mut()[lane] = *v);
        }
        run_apart(&program.prologue().operations, &mut registers, &span.scalars);
        for (row, register) in rows.iter_mut().zip(wanted) {
            let lanes = registers[*register].lanes();
            row[block * C * B..][..n].iter_mut().zip(lanes).for_each(|(to, from)| *to = T::from_f64(*from));
        }
    }
}

/// The initial states of a trajectory that are the same for every candidate, in carried order.
pub(super) fn starts(program: &Program, span: &Span, candidate: &[f64]) -> Vec<f64> {
    let mut registers = candidate.to_vec();
    run_one(program.prologue(), &mut registers, &span.scalars);
    let uniform = (0..program.varies().len()).filter(|i| !program.varies()[*i]);
    uniform.map(|i| registers[program.parameters() + i]).collect()
}
