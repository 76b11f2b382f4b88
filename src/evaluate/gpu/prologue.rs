//! What a candidate brings to the kernel, computed on the host in f64 and rounded once: invariants, initial states.

use super::layout::{Layout, bytes};
use crate::evaluate::Precision;
use crate::filter::{Program, Span};
use crate::tape::lanes::{Register, run, run_one};

const C: usize = 8;
const B: usize = 8;

/// Registers of the prologue that go to the GPU for every trajectory (invariants) or for each (initial states).
fn registers(program: &Program) -> (Vec<usize>, Vec<usize>) {
    let states = program.varies.len();
    let first = program.parameters;
    let invariants = (0..program.invariants).map(|i| first + states + i).collect();
    let varying = (0..states).filter(|i| program.varies[*i]).map(|i| first + i).collect();
    (invariants, varying)
}

/// Rows of the prologue buffer: the invariants, then the varying initial states of each trajectory.
pub(super) fn rows(program: &Program, layout: &Layout) -> usize {
    program.invariants + layout.varying * program.spans.len()
}

/// The prologue buffer of some candidates (row-major), `stride` candidates a row.
pub(super) fn buffer(
    program: &Program,
    layout: &Layout,
    candidates: &[f64],
    stride: usize,
    precision: Precision,
) -> Vec<u8> {
    let (invariants, varying) = registers(program);
    let mut values = vec![0.0; rows(program, layout) * stride];
    let (shared, own) = values.split_at_mut(invariants.len() * stride);
    if let Some(span) = program.spans.first() {
        fill(program, span, candidates, &invariants, shared, stride);
    }
    if !varying.is_empty() {
        for (span, rows) in program.spans.iter().zip(own.chunks_mut(varying.len() * stride)) {
            fill(program, span, candidates, &varying, rows, stride);
        }
    }
    bytes(values, precision)
}

/// Runs the prologue in blocks and copies some registers out, one row each.
fn fill(program: &Program, span: &Span, candidates: &[f64], wanted: &[usize], rows: &mut [f64], stride: usize) {
    let d = program.parameters.max(1);
    let mut registers = vec![Register::<f64, C, B>::splat(0.0); program.prologue.registers];
    for (block, candidates) in candidates.chunks(C * B * d).enumerate() {
        let n = candidates.len() / d;
        for (lane, candidate) in candidates.chunks_exact(d).enumerate() {
            candidate.iter().enumerate().for_each(|(p, v)| registers[p].lanes_mut()[lane] = *v);
        }
        run(&program.prologue.operations, &mut registers, &span.scalars);
        for (row, register) in wanted.iter().enumerate() {
            let at = row * stride + block * C * B;
            rows[at..at + n].copy_from_slice(&registers[*register].lanes()[..n]);
        }
    }
}

/// The initial states of a trajectory that are the same for every candidate, in carried order.
pub(super) fn starts(program: &Program, span: &Span, candidate: &[f64]) -> Vec<f64> {
    let mut registers = candidate.to_vec();
    run_one(&program.prologue, &mut registers, &span.scalars);
    let uniform = (0..program.varies.len()).filter(|i| !program.varies[*i]);
    uniform.map(|i| registers[program.parameters + i]).collect()
}
