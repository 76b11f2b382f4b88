//! From traced steps to a program: what is worked out once, what once a candidate, and what in every row.

use super::carried::{Carried, Role, narrow};
use super::carry::Partition;
use super::error::TraceError;
use super::memory::Remembering;
use super::positivity::Positivity;
use super::program::{Program, Span, Step};
use super::score::Traced;
use super::start::starts;
use super::step::{Request, Traces};
use super::tracer::Tracer;
use crate::precision::Precision;
use crate::tape::{Calculator, Graph, Id, Leaf, Output, Tape, Unary};
use std::ops::Range;

/// Schedules the prologue and the steps, and fills the record. `initial` are the entries before the first row.
///
/// # Errors
/// If a tape has more values than operations can name, or a trajectory cannot start.
pub(super) fn assemble(
    t: &mut Tracer<'_>,
    filter: &Remembering,
    request: &Request<'_>,
    steps: &[Traces],
    partition: &Partition,
    initial: &[Id],
) -> Result<Program, TraceError> {
    let representatives = partition.representatives();
    let slots = Slots::new(steps);
    let positive: Vec<Vec<Id>> = steps.iter().map(|step| unwatched(&mut t.g, step)).collect();
    let names = filter.names(&t.problem.model);
    let mut carried: Vec<Carried> =
        representatives.iter().map(|e| Carried { name: names[*e].clone(), role: Role::State }).collect();
    carried.extend(slots.carried(steps));
    if positive.iter().any(|positive| !positive.is_empty()) {
        carried.push(Carried { name: "check".to_owned(), role: Role::Check });
    }
    let leaves: Vec<Id> = (0..carried.len()).map(|i| t.g.leaf(Leaf::Carried(narrow(i)))).collect();
    let mut next: Vec<Vec<Id>> = Vec::with_capacity(steps.len());
    for (step, positive) in steps.iter().zip(&positive) {
        let mut ends: Vec<Id> = representatives.iter().map(|e| step.next[*e]).collect();
        ends.extend(slots.advance(&mut t.g, step, positive, &leaves[representatives.len()..]));
        next.push(ends);
    }
    let invariants = frontier(&t.g, &next.concat());
    let inputs: Vec<Id> = leaves.iter().chain(&invariants).copied().collect();
    let ends = next.iter().enumerate();
    let tapes = ends.map(|(kind, ends)| schedule(t, kind, &inputs, ends)).collect::<Result<Vec<_>, _>>()?;
    let spans = t.rows.spans();
    let starts = starts(t, &spans)?;
    let results: Vec<Id> = representatives.iter().map(|e| initial[*e]).chain(invariants.iter().copied()).collect();
    let (prologue, scalars) = prologue(t, &results, &starts)?;
    Ok(Program {
        precision: if request.nominal.is_some() { Precision::F32 } else { Precision::F64 },
        carrying: request.carrying,
        prologue,
        parameters: t.problem.parameters.dimension(),
        steps: tapes,
        kinds: t.columns.kinds.of().to_vec(),
        varies: representatives.iter().map(|e| !t.g.depends(initial[*e]).is_uniform()).collect(),
        carried,
        invariants: invariants.len(),
        spans: counted(spans, scalars, t.columns.kinds.of(), steps.len()),
        positivity: Positivity::default(),
        constraints: Vec::new(),
        units: t.units.clone(),
        entries: partition.entries(),
        modes: filter.family.modes(),
        parameter_names: t.problem.parameters.names().iter().map(|n| (*n).to_owned()).collect(),
        scorers: request.objectives.iter().cloned().zip(slots.traced(&steps[0].traced)).collect(),
    })
}

/// Which of the sums that were asked for are one: those that are the same in every kind of rows.
struct Slots {
    /// For each that was asked for, its slot.
    of: Vec<usize>,
    /// For each slot, the first that was asked for.
    first: Vec<usize>,
}

impl Slots {
    fn new(steps: &[Traces]) -> Self {
        let mut slots = Self { of: vec![], first: vec![] };
        for asked in 0..steps[0].sums.len() {
            let same = |first: &usize| steps.iter().all(|step| step.sums[*first] == step.sums[asked]);
            let slot = slots.first.iter().position(same).unwrap_or(slots.first.len());
            if slot == slots.first.len() {
                slots.first.push(asked);
            }
            slots.of.push(slot);
        }
        slots
    }

    fn carried(&self, steps: &[Traces]) -> impl Iterator<Item = Carried> {
        let roles = self.first.iter().map(|asked| steps[0].sums[*asked].0);
        roles.enumerate().map(|(i, role)| {
            let name = if role == Role::Product { format!("product{i}") } else { format!("sum{i}") };
            Carried { name, role }
        })
    }

    /// The sums of objectives, by their slots.
    fn traced(&self, traced: &[Traced]) -> Vec<Traced> {
        traced.iter().map(|traced| traced.in_slots(&self.of)).collect()
    }

    /// Next values of the sums and of the check, which stand in `leaves`.
    fn advance(&self, g: &mut Graph, step: &Traces, positive: &[Id], leaves: &[Id]) -> Vec<Id> {
        let mut next: Vec<Id> = Vec::with_capacity(leaves.len());
        for (asked, leaf) in self.first.iter().zip(leaves) {
            let (role, value) = step.sums[*asked];
            next.push(if role == Role::Product { g.mul(*leaf, value) } else { g.add(*leaf, value) });
        }
        if let Some(check) = leaves.get(self.first.len()) {
            let failed = g.constant(-1.0);
            next.push(positive.iter().fold(*check, |check, value| g.select(*value, check, failed)));
        }
        next
    }
}

/// What has to be positive and no product watches over.
fn unwatched(g: &mut Graph, step: &Traces) -> Vec<Id> {
    let mut positive = step.positive.clone();
    positive.retain(|value| {
        let factor = g.unary(Unary::Positive, *value);
        !step.sums.contains(&(Role::Product, factor))
    });
    positive
}

/// Nodes that are the same in every row but not for every candidate, where they meet what changes from row to row.
fn frontier(g: &Graph, roots: &[Id]) -> Vec<Id> {
    let is_invariant = |id: Id| g.depends(id).is_invariant() && !g.depends(id).is_constant();
    let varying = g.reachable(roots, |id| !is_invariant(id) && !g.depends(id).is_uniform());
    let mut found: Vec<Id> = varying.iter().flat_map(|id| g.operands(g.node(*id)).into_iter().flatten()).collect();
    found.extend_from_slice(roots);
    found.retain(|id| is_invariant(*id));
    found.sort_unstable();
    found.dedup();
    found
}

fn outputs(ids: &[Id], first: usize) -> Vec<Output> {
    ids.iter().enumerate().map(|(i, id)| Output { id: *id, register: first + i }).collect()
}

/// The tape of a kind of rows, and its record: the scalars of each of its rows in f64.
fn schedule(t: &Tracer<'_>, kind: usize, inputs: &[Id], next: &[Id]) -> Result<Step, TraceError> {
    let mut tape = Tape::new(&t.g, inputs, &outputs(next, 0))?;
    tape.scalars_first(|id| !t.g.depends(id).is_constant());
    let columns = tape.scalars.iter().filter(|id| !t.g.depends(**id).is_constant()).count();
    let constants = tape.scalars[columns..].iter().filter_map(|id| t.g.value(*id)).collect();
    let rows = t.columns.kinds.rows(kind, t.rows.len());
    let mut calculator = Calculator::new(&t.g, &tape.scalars[..columns]);
    let mut record = Vec::with_capacity(rows * columns);
    for row in 0..rows {
        record.extend(calculator.evaluate(|leaf| t.at(leaf, row)));
    }
    Ok(Step { tape, columns, constants, record: record.into(), rows })
}

/// The prologue, and the values of its scalars for each trajectory.
fn prologue(t: &mut Tracer<'_>, results: &[Id], starts: &[Vec<f64>]) -> Result<(Tape, Vec<Vec<f64>>), TraceError> {
    let d = t.problem.parameters.dimension();
    let inputs: Vec<Id> = (0..d).map(|i| t.g.leaf(Leaf::Parameter(narrow(i)))).collect();
    let tape = Tape::new(&t.g, &inputs, &outputs(results, d))?;
    let mut calculator = Calculator::new(&t.g, &tape.scalars);
    let mut values = |start: &Vec<f64>| {
        let leaf = |leaf| match leaf {
            Leaf::Start(i) => start[i as usize],
            _ => f64::NAN,
        };
        calculator.evaluate(leaf).collect()
    };
    let scalars = starts.iter().map(&mut values).collect();
    Ok((tape, scalars))
}

/// Trajectories with how many rows of each kind come before theirs.
fn counted(spans: Vec<Range<usize>>, scalars: Vec<Vec<f64>>, kinds: &[u8], steps: usize) -> Vec<Span> {
    let mut before = vec![0; steps];
    let span = |(rows, scalars): (Range<usize>, Vec<f64>)| {
        let span = Span { rows: rows.clone(), scalars, before: before.clone() };
        match kinds.get(rows.clone()) {
            Some(kinds) => kinds.iter().for_each(|kind| before[usize::from(*kind)] += 1),
            None => before[0] += rows.len(),
        }
        span
    };
    spans.into_iter().zip(scalars).map(span).collect()
}
