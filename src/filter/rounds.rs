//! Rounds of tracing: steps are traced again until nothing is carried twice, and then scheduled.

use super::assemble::assemble;
use super::carry::Partition;
use super::columns::Columns;
use super::error::TraceError;
use super::families;
use super::fold::fold;
use super::memory::{Memory, Remembering};
use super::positivity::Positivity;
use super::program::Program;
use super::rows::Rows;
use super::step::{Request, Traces};
use super::tracer::Tracer;
use crate::model::Problem;
use crate::tape::Id;

/// Traces the filter over rows.
///
/// # Errors
/// If the model does not fit the filter, or the step has more values than operations can name.
pub(super) fn trace_rows(
    problem: &Problem,
    rows: &Rows<'_>,
    columns: &mut Columns,
    request: &Request<'_>,
) -> Result<Program, TraceError> {
    let memory = Memory::of(request.objectives.iter().flat_map(|objective| objective.memory(&problem.model)));
    let filter = Remembering { family: families::of(problem, request.carrying), memory };
    let (mut partition, mut parted) = (None, false);
    loop {
        let mut t = Tracer::new(problem, rows, columns, request.units, request.nominal);
        t.columns.of_all();
        let initial = filter.start(&mut t)?;
        let opaque = filter.opaque(&problem.model);
        let current = partition.unwrap_or_else(|| Partition::by_initial(&t.g, &initial, opaque));
        let mut steps = trace_steps(&mut t, &filter, &current, request)?;
        // Which columns there are is known after a step with masks; what they decide is the same in every round.
        if !parted {
            parted = true;
            if t.columns.part_rows(rows.len(), t.g.len()) {
                partition = None;
                continue;
            }
        }
        if let Some(refined) = refine(&t, &current, &steps) {
            partition = Some(refined);
            continue;
        }
        steps.iter_mut().enumerate().for_each(|(kind, step)| fold(&mut t, kind, step));
        let mut program = assemble(&mut t, &filter, request, &steps, &current, &initial)?;
        if request.watch.is_none() {
            program.positivity = Positivity::new(problem, rows)?;
        }
        return Ok(program);
    }
}

/// A step for each kind of rows.
fn trace_steps(
    t: &mut Tracer<'_>,
    filter: &Remembering,
    partition: &Partition,
    request: &Request<'_>,
) -> Result<Vec<Traces>, TraceError> {
    let prior: Vec<Id> = partition.nodes(&mut t.g);
    let mut steps = Vec::with_capacity(t.columns.kinds.len());
    for kind in 0..t.columns.kinds.len() {
        t.columns.of_kind(kind);
        steps.push(Traces::new(t, filter, &prior, request)?);
    }
    t.columns.of_all();
    Ok(steps)
}

/// The partition that holds after every step; `None` where it is `current`.
fn refine(t: &Tracer<'_>, current: &Partition, steps: &[Traces]) -> Option<Partition> {
    let refined =
        steps.iter().fold(current.clone(), |partition, step| partition.refine(&t.g, &step.next).unwrap_or(partition));
    (refined != *current).then_some(refined)
}
