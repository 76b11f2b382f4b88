//! A traced filter over a log, ready to run: the prologue, the step, and the record they read.

use super::carried::{Carried, Role};
use super::carry::Entry;
use super::form::{Carrying, Form};
use super::positivity::Positivity;
use super::score::{Pools, Traced};
use super::units::Units;
use crate::objective::{Constraint, Objective};
use crate::precision::Precision;
use crate::tape::Tape;
use std::ops::Range;
use std::sync::Arc;

/// The rows of one trajectory, and the values its prologue reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Rows of the record.
    pub rows: Range<usize>,
    /// Scalars of [`Program::prologue`].
    pub scalars: Vec<f64>,
    /// For each kind how many of its rows come before those of this trajectory.
    pub before: Vec<usize>,
}

/// What happens in the rows of one kind.
#[derive(Debug, Clone)]
pub struct Step {
    /// Runs once a row.
    pub(super) tape: Tape,
    /// Number of columns of the record.
    pub(super) columns: usize,
    /// The other scalars of the tape: constants that follow the columns.
    pub(super) constants: Vec<f64>,
    /// Row-major f64 table, rows of this kind x columns: the scalars of the tape that change from row to row.
    pub(super) record: Arc<Vec<f64>>,
    /// Number of rows of this kind.
    pub(super) rows: usize,
}

/// A traced filter over a log.
///
/// For each trajectory the prologue turns a candidate into the carried states and the invariants (in f64, rounded once),
/// and a step runs once a row: the one of its kind. Carried registers come first, then invariants, then temporaries.
///
/// It comes from [`trace`](super::trace()) alone, and is what that made of it.
#[derive(Debug, Clone)]
pub struct Program {
    pub(super) precision: Precision,
    pub(super) carrying: Carrying,
    pub(super) prologue: Tape,
    pub(super) parameters: usize,
    pub(super) steps: Vec<Step>,
    /// The step of each row; empty where there is one.
    pub(super) kinds: Vec<u8>,
    pub(super) carried: Vec<Carried>,
    pub(super) varies: Vec<bool>,
    pub(super) invariants: usize,
    pub(super) spans: Vec<Span>,
    pub(super) positivity: Positivity,
    pub(super) constraints: Vec<Constraint>,
    pub(super) units: Units,
    pub(super) entries: Vec<Entry>,
    /// See [`Family::modes`](super::family::Family::modes).
    pub(super) modes: usize,
    pub(super) parameter_names: Vec<String>,
    pub(super) scorers: Vec<(Objective, Traced)>,
}

/// What a register of the step holds before the first row of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Initial {
    /// A result of the prologue, by its register there.
    Result(usize),
    /// A number.
    Number(f64),
}

impl Step {
    /// Runs once a row.
    #[must_use]
    pub const fn tape(&self) -> &Tape {
        &self.tape
    }

    /// Number of columns of the record.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// The scalars of the tape that follow the columns.
    #[must_use]
    pub fn constants(&self) -> &[f64] {
        &self.constants
    }

    /// Rows of this kind x columns, row-major.
    #[must_use]
    pub const fn record(&self) -> &Arc<Vec<f64>> {
        &self.record
    }

    /// Columns of the `row`th row of this kind.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.record[row * self.columns..(row + 1) * self.columns]
    }

    /// Number of rows of this kind.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Names of the tape's scalars: `row.0`, ..., then the constants themselves.
    #[must_use]
    pub fn scalar_names(&self) -> Vec<String> {
        let columns = (0..self.columns).map(|c| format!("row.{c}"));
        columns.chain(self.constants.iter().map(|c| format!("{c}"))).collect()
    }
}

impl Program {
    /// Rows after which sums are moved to their f64 totals.
    pub const BLOCK: usize = 32;

    /// The number format it is for: f32 is traced in deviation from a nominal.
    #[must_use]
    pub const fn precision(&self) -> Precision {
        self.precision
    }

    /// The form of the covariance that is carried.
    #[must_use]
    pub const fn form(&self) -> Form {
        self.carrying.form
    }

    /// Whether an update after a long gap takes P down so far that x is anchored to what is measured.
    #[must_use]
    pub const fn anchored(&self) -> bool {
        self.carrying.anchored
    }

    /// Once a trajectory, in f64: searched parameters in registers 0.., results behind them: states, then invariants.
    #[must_use]
    pub const fn prologue(&self) -> &Tape {
        &self.prologue
    }

    /// Number of searched parameters.
    #[must_use]
    pub const fn parameters(&self) -> usize {
        self.parameters
    }

    /// What happens in rows, one a kind of them.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// The step of a row of the log.
    #[must_use]
    pub fn kind(&self, row: usize) -> usize {
        self.kinds.get(row).map_or(0, |kind| usize::from(*kind))
    }

    /// The carried registers, in order.
    #[must_use]
    pub fn carried(&self) -> &[Carried] {
        &self.carried
    }

    /// For each carried state whether its initial value depends on the candidate.
    #[must_use]
    pub fn varies(&self) -> &[bool] {
        &self.varies
    }

    /// Number of values that depend on the candidate but not on the row.
    #[must_use]
    pub const fn invariants(&self) -> usize {
        self.invariants
    }

    /// Registers that the longest step uses.
    #[must_use]
    pub fn registers(&self) -> usize {
        let steps = self.steps.iter().map(|step| step.tape.registers);
        steps.fold(self.carried.len() + self.invariants, usize::max)
    }

    /// The trajectories.
    #[must_use]
    pub fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// Which candidates have covariances for Q, R and P0.
    #[must_use]
    pub const fn positivity(&self) -> &Positivity {
        &self.positivity
    }

    /// What the last scorers are held against: their values become violations, not costs.
    #[must_use]
    pub fn constraints(&self) -> &[Constraint] {
        &self.constraints
    }

    /// The units in which states and measurements stand in the steps.
    #[must_use]
    pub const fn units(&self) -> &Units {
        &self.units
    }

    /// Rows of all trajectories.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.spans.iter().map(|span| span.rows.len()).sum()
    }

    /// Operations of a candidate's run over the whole log.
    #[must_use]
    pub fn operations(&self) -> usize {
        self.steps.iter().map(|step| step.rows * step.tape.operations.len()).sum()
    }

    /// What the registers of the step hold before the first row of a trajectory: carried ones, then invariants.
    pub fn initial(&self) -> impl Iterator<Item = Initial> + '_ {
        let mut results = self.parameters..;
        let mut result = move || Initial::Result(results.next().unwrap_or(usize::MAX));
        let carried = self.carried.iter().map(|carried| carried.role);
        carried.chain((0..self.invariants).map(|_| Role::State)).map(move |role| match role {
            Role::State => result(),
            other => Initial::Number(other.start()),
        })
    }

    /// For each step how many of its rows come before trajectory `t`.
    #[must_use]
    pub fn cursor(&self, t: usize) -> Cursor<'_> {
        Cursor { program: self, next: self.spans.get(t).map_or_else(Vec::new, |span| span.before.clone()) }
    }

    /// Number of objectives.
    #[must_use]
    pub const fn objectives(&self) -> usize {
        self.scorers.len() - self.constraints.len()
    }

    /// Number of values that a candidate is scored by: objectives, then what constraints bound.
    #[must_use]
    pub const fn scorers(&self) -> usize {
        self.scorers.len()
    }

    /// With its last scorers held against `constraints`, as far as it has that many.
    #[must_use]
    pub fn constrained(mut self, constraints: &[Constraint]) -> Self {
        let constraints = &constraints[..constraints.len().min(self.scorers.len())];
        self.constraints = constraints.to_vec();
        self
    }

    /// Number of sums and products: a run yields that many totals a trajectory.
    #[must_use]
    pub fn totals(&self) -> usize {
        self.carried.iter().filter(|c| matches!(c.role, Role::Sum | Role::Product)).count()
    }

    /// Numbers that a candidate's trajectories are [folded](Self::fold) into: pooled totals, and one a scorer.
    #[must_use]
    pub fn folded(&self) -> usize {
        self.totals() + self.scorers.len()
    }

    /// Adds the totals of trajectory `t` to what those before it were folded into, 0 at first. The order of the
    /// trajectories is that of the log.
    pub fn fold(&self, t: usize, totals: &[f64], into: &mut [f64]) {
        let (pooled, folded) = into.split_at_mut(totals.len());
        pooled.iter_mut().zip(totals).for_each(|(pooled, total)| *pooled += total);
        for ((objective, traced), folded) in self.scorers.iter().zip(folded) {
            *folded += objective.of_trajectory(&Pools { totals, folded: 0.0, traced }, t);
        }
    }

    /// The [`Self::scorers`] of one candidate from what its trajectories were folded into.
    pub fn costs(&self, folded: &[f64], costs: &mut [f64]) {
        let (totals, folded) = folded.split_at(self.totals());
        for (((objective, traced), folded), cost) in self.scorers.iter().zip(folded).zip(costs) {
            *cost = objective.finish(&Pools { totals, folded: *folded, traced });
        }
    }
}

/// Goes through the rows of a trajectory: which step each has, and which of the step's rows it is.
#[derive(Debug, Clone)]
pub struct Cursor<'a> {
    program: &'a Program,
    next: Vec<usize>,
}

impl<'a> Cursor<'a> {
    /// The step of `row`, the next row of the log, and the place of the row among those of its kind.
    pub fn next(&mut self, row: usize) -> (usize, usize) {
        let kind = self.program.kind(row);
        self.next[kind] += 1;
        (kind, self.next[kind] - 1)
    }

    /// The step of the next row, and its columns.
    pub fn step(&mut self, row: usize) -> (&'a Step, &'a [f64]) {
        let (kind, place) = self.next(row);
        let step = &self.program.steps[kind];
        (step, step.row(place))
    }
}
