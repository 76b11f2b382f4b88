//! From a problem and its log to a [`Program`].

use super::adaptive::Memory;
use super::carry::Partition;
use super::columns::{Columns, Key, Rows};
use super::covariance::Covariance;
use super::error::TraceError;
use super::form::{Carrying, Form};
use super::nominal::Nominal;
use super::positivity::Positivity;
use super::probe::Watch;
use super::program::{Carried, Program, Role, Span};
use super::score::{Scoring, Traced};
use super::start::starts;
use super::tracer::{Tracer, narrow};
use super::units::Units;
use crate::data::Log;
use crate::model::Problem;
use crate::objective::Objective;
use crate::tape::{Calculator, Graph, Id, Leaf, Output, Tape, Unary};

/// Traces the filter of `problem` over `log` for some objectives.
///
/// With `nominal` the deviation form is traced, which single precision needs; the covariance is then carried in the
/// [`Form`] that P0 and R call for, and without one in full.
///
/// # Errors
/// If the log has other columns than the problem, f or h is not affine in the states, `first = "predict"` has no interval,
/// the step has more values than operations can name, or the deviation form cannot express a searched parameter.
pub fn trace(
    problem: &Problem,
    log: &Log,
    objectives: &[Objective],
    nominal: Option<Nominal>,
) -> Result<Program, TraceError> {
    trace_as(problem, log, objectives, nominal, None)
}

/// [`trace`] with a given form of the covariance.
///
/// # Errors
/// As [`trace`].
pub fn trace_as(
    problem: &Problem,
    log: &Log,
    objectives: &[Objective],
    nominal: Option<Nominal>,
    form: Option<Form>,
) -> Result<Program, TraceError> {
    check_columns(problem, log)?;
    let rows = Rows::new(problem, log);
    let (carrying, track) = Carrying::choose(problem, &rows, nominal.is_some(), form)?;
    // After a gap a predicted state is wherever the gap has led it, and nothing measured is near.
    let nominal = match track {
        Some(track) => nominal.map(|nominal| nominal.on(track)),
        None => nominal,
    };
    trace_rows(problem, &rows, objectives, nominal, carrying, None)
}

/// Traces the filter over rows; a probe's watch adds its sums behind those of the objectives.
pub(super) fn trace_rows(
    problem: &Problem,
    rows: &Rows<'_>,
    objectives: &[Objective],
    nominal: Option<Nominal>,
    Carrying { form: chosen, anchored }: Carrying,
    watch: Option<&Watch>,
) -> Result<Program, TraceError> {
    let mut columns = Columns::default();
    let mut units = Units::own(problem.model.states.len(), problem.model.measurements.len());
    let (g, nominal_of) = (Graph::default(), nominal.as_ref());
    let mut tracer = Tracer { g, columns: &mut columns, rows, problem, nominal: nominal_of, units: &units, anchored };
    units = Units::choose(&mut tracer)?;
    let mut partition = None;
    loop {
        let g = Graph::default();
        let mut tracer =
            Tracer { g, columns: &mut columns, rows, problem, nominal: nominal_of, units: &units, anchored };
        let (x, p) = tracer.start(chosen)?;
        let memory = tracer.start_memory(chosen);
        let initial: Vec<Id> = x.into_iter().chain(p.entries()).chain(memory.entries()).collect();
        let buffered = Memory::buffered(&problem.filter, problem.model.measurements.len());
        let current = partition.unwrap_or_else(|| Partition::by_initial(&tracer.g, &initial, buffered));
        let step = Step::trace(&mut tracer, chosen, &current, objectives, watch)?;
        if let Some(refined) = current.refine(&tracer.g, &step.next) {
            partition = Some(refined);
            continue;
        }
        let mut program = step.assemble(&mut tracer, &current, &initial, objectives)?;
        program.nominal = nominal;
        if watch.is_none() {
            program.positivity = Positivity::new(problem, rows)?;
        }
        return Ok(program);
    }
}

/// Values are found by their place: measurements and inputs of the log are those of the model, in its order.
fn check_columns(problem: &Problem, log: &Log) -> Result<(), TraceError> {
    let expected = [problem.model.measurements.len(), problem.model.inputs.len()];
    let found = [log.measurements.len(), log.inputs.len()];
    if found == expected { Ok(()) } else { Err(TraceError::WrongColumns { found, expected }) }
}

/// One traced step, not yet scheduled.
struct Step {
    form: Form,
    /// Entries of x, of the covariance and of what is adapted, after the step.
    next: Vec<Id>,
    sums: Vec<(Role, Id)>,
    /// What a candidate fails without, unless a product watches over it.
    positive: Vec<Id>,
    traced: Vec<Traced>,
}

impl Step {
    fn trace(
        tracer: &mut Tracer<'_>,
        form: Form,
        partition: &Partition,
        objectives: &[Objective],
        watch: Option<&Watch>,
    ) -> Result<Self, TraceError> {
        let model = &tracer.problem.model;
        let n = model.states.len();
        let mut recursion = tracer.recursion()?;
        let law = tracer.law(&recursion.R);
        let entries = partition.nodes(&mut tracer.g);
        let (entries, memory) = entries.split_at(n + n * (n + 1) / 2);
        let memory = Memory::from_entries(&mut tracer.g, (form, &tracer.problem.filter), model, memory);
        memory.adopt(&mut tracer.g, &mut recursion);
        let prior = Covariance::from_entries(&mut tracer.g, form, n, &entries[n..]);
        let (update, x, p) = recursion.update(&mut tracer.g, &entries[..n], &prior);
        let mut sums = Vec::new();
        let mut positive = [&update.pivots[..], &law.in_range].concat();
        let mut scoring = Scoring {
            g: &mut tracer.g,
            columns: tracer.columns,
            rows: tracer.rows,
            problem: tracer.problem,
            nominal: tracer.nominal,
            units: tracer.units,
            update: &update,
            x: &x,
            p: &p,
            sums: &mut sums,
            positive: &mut positive,
            asked: (0, 0),
        };
        let of = |(scorer, objective): (usize, &Objective)| {
            scoring.asked = (scorer, 0);
            objective.trace(&mut scoring)
        };
        let traced = objectives.iter().enumerate().map(of).collect();
        positive.retain(|value| {
            let factor = tracer.g.unary(Unary::Positive, *value);
            !sums.contains(&(Role::Product, factor))
        });
        if let Some(watch) = watch {
            let after = tracer.columns.node(&mut tracer.g, Key::AfterGap, || watch.after());
            sums.extend(watch.sums((&mut tracer.g, after), &recursion, (&prior, &p), &x));
        }
        let memory = memory.adapt(&mut tracer.g, &law, &recursion, (&prior, &update));
        memory.adopt(&mut tracer.g, &mut recursion);
        let (x, p) = recursion.predict(&mut tracer.g, &x, &p);
        let next = x.into_iter().chain(p.entries()).chain(memory.entries()).collect();
        Ok(Self { form, next, sums, positive, traced })
    }

    /// Schedules the prologue and the step, and fills the record.
    fn assemble(
        self,
        tracer: &mut Tracer<'_>,
        partition: &Partition,
        initial: &[Id],
        objectives: &[Objective],
    ) -> Result<Program, TraceError> {
        let spans = tracer.rows.spans();
        let starts = starts(tracer, &spans)?;
        let representatives = partition.representatives();
        let carried = self.carried(tracer.problem, &representatives);
        let leaves: Vec<Id> = (0..carried.len()).map(|i| tracer.g.leaf(Leaf::Carried(narrow(i)))).collect();
        let mut next: Vec<Id> = representatives.iter().map(|e| self.next[*e]).collect();
        next.extend(self.advance(&mut tracer.g, &leaves[representatives.len()..]));
        let g = &tracer.g;
        let invariants = frontier(g, &next);
        let inputs: Vec<Id> = leaves.iter().chain(&invariants).copied().collect();
        let mut step = Tape::new(g, &inputs, &outputs(&next, 0))?;
        step.scalars_first(|id| !g.depends(id).is_constant());
        let columns = step.scalars.iter().filter(|id| !g.depends(**id).is_constant()).count();
        let constants = step.scalars[columns..].iter().filter_map(|id| g.value(*id)).collect();
        let record = record(tracer, &step.scalars[..columns]);
        let names = step.scalars[..columns].iter().enumerate().map(|(c, _)| format!("row.{c}")).collect();
        let (prologue, scalars) = prologue(tracer, &representatives, initial, &invariants, &starts)?;
        let varies = representatives.iter().map(|e| !tracer.g.depends(initial[*e]).is_uniform()).collect();
        let spans = spans.into_iter().zip(scalars).map(|(rows, scalars)| Span { rows, scalars }).collect();
        Ok(Program {
            form: self.form,
            anchored: tracer.anchored,
            prologue,
            parameters: tracer.problem.parameters.dimension(),
            step,
            carried,
            varies,
            invariants: invariants.len(),
            record: record.into(),
            columns,
            constants,
            spans,
            positivity: Positivity::default(),
            constraints: Vec::new(),
            units: tracer.units.clone(),
            nominal: None,
            entries: partition.entries(),
            names,
            parameter_names: tracer.problem.parameters.names().iter().map(|n| (*n).to_owned()).collect(),
            scorers: objectives.iter().cloned().zip(self.traced).collect(),
        })
    }

    /// The carried registers: states, sums, and the check.
    fn carried(&self, problem: &Problem, representatives: &[usize]) -> Vec<Carried> {
        let states = &problem.model.states;
        let x = states.iter().map(|s| format!("x.{s}"));
        let memory = Memory::names(self.form, &problem.filter, &problem.model);
        let names: Vec<String> = x.chain(Covariance::names(self.form, states)).chain(memory).collect();
        let mut carried: Vec<Carried> =
            representatives.iter().map(|e| Carried { name: names[*e].clone(), role: Role::State }).collect();
        for (i, (role, _)) in self.sums.iter().enumerate() {
            let name = if *role == Role::Product { format!("product{i}") } else { format!("sum{i}") };
            carried.push(Carried { name, role: *role });
        }
        if !self.positive.is_empty() {
            carried.push(Carried { name: "check".to_owned(), role: Role::Check });
        }
        carried
    }

    /// Next values of the sums and of the check.
    fn advance(&self, g: &mut Graph, leaves: &[Id]) -> Vec<Id> {
        let mut next: Vec<Id> = Vec::with_capacity(leaves.len());
        for ((role, value), leaf) in self.sums.iter().zip(leaves) {
            next.push(if *role == Role::Product { g.mul(*leaf, *value) } else { g.add(*leaf, *value) });
        }
        if let Some(check) = leaves.get(self.sums.len()) {
            let failed = g.constant(-1.0);
            next.push(self.positive.iter().fold(*check, |check, value| g.select(*value, check, failed)));
        }
        next
    }
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

/// The scalars of every row, row-major, in f64.
fn record(tracer: &Tracer<'_>, scalars: &[Id]) -> Vec<f64> {
    let rows = tracer.rows.spans().last().map_or(0, |s| s.end);
    let mut calculator = Calculator::new(&tracer.g, scalars);
    let mut record = Vec::with_capacity(rows * scalars.len());
    for row in 0..rows {
        record.extend(calculator.evaluate(|leaf| match leaf {
            Leaf::Column(c) => tracer.columns.value(c, row),
            _ => f64::NAN,
        }));
    }
    record
}

/// The prologue, and the values of its scalars for each trajectory.
fn prologue(
    tracer: &mut Tracer<'_>,
    representatives: &[usize],
    initial: &[Id],
    invariants: &[Id],
    starts: &[Vec<f64>],
) -> Result<(Tape, Vec<Vec<f64>>), TraceError> {
    let d = tracer.problem.parameters.dimension();
    let inputs: Vec<Id> = (0..d).map(|i| tracer.g.leaf(Leaf::Parameter(narrow(i)))).collect();
    let results: Vec<Id> = representatives.iter().map(|e| initial[*e]).chain(invariants.iter().copied()).collect();
    let tape = Tape::new(&tracer.g, &inputs, &outputs(&results, d))?;
    let mut calculator = Calculator::new(&tracer.g, &tape.scalars);
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
