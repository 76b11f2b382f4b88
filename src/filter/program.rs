//! A traced filter over a log, ready to run: the prologue, the step, and the record they read.

use super::carry::Entry;
use super::form::Form;
use super::nominal::Nominal;
use super::positivity::Positivity;
use super::score::{Pools, Traced};
use super::units::Units;
use crate::objective::{Constraint, Objective};
use crate::tape::{Names, Tape};
use std::fmt::{self, Display, Formatter};
use std::ops::Range;
use std::sync::Arc;

/// What becomes of a carried register.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// An entry of x, of the covariance or of what is adapted: starts from the prologue, stays.
    State,
    /// A running sum: starts at 0, is moved to an f64 total every [`Program::BLOCK`] rows.
    Sum,
    /// A running product: starts at 1, its exponent is taken out every few rows; the total is its logarithm. It stays 0
    /// once a factor was not positive.
    Product,
    /// 1 as long as the innovation variances that no product watches over were positive, -1 after one was not.
    Check,
}

/// A register carried from row to row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Carried {
    /// `x.d`, `P.d.v` (or `U.d.v`, `D.d`), `sum0`, ...
    pub name: String,
    /// What becomes of it.
    pub role: Role,
}

/// The rows of one trajectory, and the values its prologue reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Rows of the record.
    pub rows: Range<usize>,
    /// Scalars of [`Program::prologue`].
    pub scalars: Vec<f64>,
}

/// A traced filter over a log.
///
/// For each trajectory the prologue turns a candidate into the carried states and the invariants (in f64, rounded once),
/// and the step runs once a row. Carried registers come first, then invariants, then temporaries.
#[derive(Debug, Clone)]
pub struct Program {
    /// The form of the covariance that is carried.
    pub form: Form,
    /// Whether an update after a long gap takes P down so far that x is anchored to what is measured.
    pub anchored: bool,
    /// Once a trajectory, in f64: searched parameters in registers 0.., results behind them: states, then invariants.
    pub prologue: Tape,
    /// Number of searched parameters.
    pub parameters: usize,
    /// Once a row.
    pub step: Tape,
    /// The carried registers, in order.
    pub carried: Vec<Carried>,
    /// For each carried state whether its initial value depends on the candidate.
    pub varies: Vec<bool>,
    /// Number of invariants.
    pub invariants: usize,
    /// Row-major f64 table of the scalars of [`Self::step`] that change from row to row.
    pub record: Arc<Vec<f64>>,
    /// Number of columns of the record.
    pub columns: usize,
    /// The other scalars of the step: constants that follow the columns.
    pub constants: Vec<f64>,
    /// Trajectories.
    pub spans: Vec<Span>,
    /// Which candidates have covariances for Q, R and P0.
    pub positivity: Positivity,
    /// What the last scorers are held against: their values become violations, not costs.
    pub constraints: Vec<Constraint>,
    /// The units in which states and measurements stand in the step.
    pub units: Units,
    /// The nominal, in the deviation form, in the problem's own units.
    pub nominal: Option<Nominal>,
    /// Entries of the predicted x, then of the predicted covariance: the upper triangle of P, or D with U above it,
    /// then of what an adaptive filter carries.
    pub entries: Vec<Entry>,
    pub(super) names: Vec<String>,
    pub(super) parameter_names: Vec<String>,
    pub(super) scorers: Vec<(Objective, Traced)>,
}

impl Program {
    /// Rows after which sums are moved to their f64 totals.
    pub const BLOCK: usize = 32;

    /// Rows of all trajectories.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.spans.iter().map(|span| span.rows.len()).sum()
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

    /// Names of the step's scalars: `row.0`, ..., then the constants themselves.
    #[must_use]
    pub fn scalar_names(&self) -> Vec<String> {
        let columns = self.names.iter().cloned();
        columns.chain(self.constants.iter().map(|c| format!("{c}"))).collect()
    }
}

impl Display for Program {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { form, parameters, invariants, columns, .. } = self;
        let rows = self.rows();
        writeln!(
            f,
            "# {rows} rows, {columns} columns a row, {parameters} searched parameters, {} carried, {invariants} invariants",
            self.carried.len()
        )?;
        writeln!(f, "# carries x and {form}")?;
        if !self.units.are_own() {
            let Units { states, measurements } = &self.units;
            writeln!(f, "# in units of 2 to the {states:?} (states) and {measurements:?} (measurements)")?;
        }
        writeln!(f, "# prologue, once a trajectory in f64: {}", self.prologue.counts())?;
        let names: Vec<String> = self
            .parameter_names
            .iter()
            .cloned()
            .chain(
                self.register_names()
                    .into_iter()
                    .filter(|n| !n.starts_with("sum") && !n.starts_with("product") && n != "check"),
            )
            .collect();
        let names = Names { registers: &names, scalars: &[] };
        for operation in &self.prologue.operations {
            writeln!(f, "    {}", names.line(operation))?;
        }
        writeln!(f, "# step, once a row: {}; {} registers", self.step.counts(), self.step.registers)?;
        let (registers, scalars) = (self.register_names(), self.scalar_names());
        let names = Names { registers: &registers, scalars: &scalars };
        for operation in &self.step.operations {
            writeln!(f, "    {}", names.line(operation))?;
        }
        Ok(())
    }
}

impl Program {
    /// Names of the carried registers and the invariants.
    fn register_names(&self) -> Vec<String> {
        let invariants = (0..self.invariants).map(|i| format!("i{i}"));
        self.carried.iter().map(|c| c.name.clone()).chain(invariants).collect()
    }
}
