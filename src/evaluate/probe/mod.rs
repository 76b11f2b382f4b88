//! One row of one candidate's run, as each machine has it: what stands before it, and every operation of its step.

mod parting;
#[cfg(test)]
mod tests;

pub use parting::{Parting, Source};

use super::block::{Blocks, Rounded, behind};
use super::single;
use crate::data::Log;
use crate::filter::{Program, Step, TraceError, trace_around};
use crate::model::Problem;
use crate::precision::Precision;
use crate::tape::lanes::{Lane, Register, run};

/// A row that is looked at.
#[derive(Debug, Clone)]
pub struct Probe {
    /// Cut to the rows of the trajectory up to this one.
    program: Program,
    candidate: Vec<f64>,
    /// The states of the nominal at the row; empty in f64.
    nominal: Vec<f64>,
}

/// What a machine has in the row. Numbers of f32 stand in f64, exactly.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Carried registers, then invariants, before the row.
    pub before: Vec<f64>,
    /// The value of each operation, in order.
    pub values: Vec<f64>,
}

impl Probe {
    /// Row `row` (of those that the filter uses, from 0) of trajectory `t` by the program that scores the problem's objectives
    /// in f64.
    ///
    /// # Errors
    /// If the filter cannot be traced.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn double(
        problem: &Problem,
        log: &Log,
        (t, row): (usize, usize),
        candidate: &[f64],
    ) -> Result<Self, TraceError> {
        let (program, _) = trace_around(problem, log, &problem.tune.scorers(), None, None)?;
        Ok(Self::new(&program, (t, row), candidate, vec![]))
    }

    /// The same in f32, whether or not f32 keeps its promise over this log.
    ///
    /// # Errors
    /// As [`Self::double`], and if the model has no deviation form.
    ///
    /// # Panics
    /// As [`Self::double`].
    pub fn single(
        problem: &Problem,
        log: &Log,
        (t, row): (usize, usize),
        candidate: &[f64],
    ) -> Result<Self, TraceError> {
        let nominal = single::nominal(problem, log, None)?;
        let (program, nominal) = trace_around(problem, log, &problem.tune.scorers(), Some(nominal), None)?;
        let record = program.spans()[t].rows.start + row;
        let nominal = nominal.map_or_else(Vec::new, |nominal| nominal.row(record).to_vec());
        Ok(Self::new(&program, (t, row), candidate, nominal))
    }

    fn new(program: &Program, (t, row): (usize, usize), candidate: &[f64], nominal: Vec<f64>) -> Self {
        let rows = program.spans()[t].rows.len();
        assert!(row < rows, "row {row} of a trajectory with {rows}");
        Self { program: program.cut(t, row + 1), candidate: candidate.to_vec(), nominal }
    }

    /// The program up to the row.
    #[must_use]
    pub const fn program(&self) -> &Program {
        &self.program
    }

    /// The parameters that it is run with.
    #[must_use]
    pub fn candidate(&self) -> &[f64] {
        &self.candidate
    }

    /// The step of the row, and its columns.
    #[must_use]
    pub fn step(&self) -> (&Step, &[f64]) {
        let mut cursor = self.program.cursor(0);
        let last = self.program.rows() - 1;
        (0..last).for_each(|row| {
            cursor.next(row);
        });
        cursor.step(last)
    }

    /// What the CPU's lanes have, in the precision of the program.
    #[must_use]
    pub fn on_lanes(&self) -> Seen {
        match self.program.precision() {
            Precision::F32 => self.run::<f32>(),
            Precision::F64 => self.run::<f64>(),
        }
    }

    /// What the same tape and record come to in f64 from the start of the trajectory.
    #[must_use]
    pub fn in_f64(&self) -> Seen {
        self.run::<f64>()
    }

    fn run<T: Blocks>(&self) -> Seen {
        // Products are split where the program's own precision splits them.
        let split = match self.program.precision() {
            Precision::F32 => f32::STEPS_PER_SPLIT,
            Precision::F64 => f64::STEPS_PER_SPLIT,
        };
        let ahead = Rounded::<T>::new(self.program.cut(0, self.program.rows() - 1));
        let mut registers = behind(&ahead, &self.candidate, split);
        registers.truncate(self.program.carried().len() + self.program.invariants());
        let before: Vec<f64> = registers.iter().map(|register| register.lanes()[0].to_f64()).collect();
        Seen { values: self.values::<T>(&before), before }
    }

    /// The value of each operation of the step from what stands before the row.
    fn values<T: Lane>(&self, before: &[f64]) -> Vec<f64> {
        let mut registers: Vec<Register<T, 1, 1>> = before.iter().map(|v| Register::splat(T::from_f64(*v))).collect();
        registers.resize(self.program.registers(), Register::splat(T::ZERO));
        let scalars: Vec<T> = self.scalars().into_iter().map(T::from_f64).collect();
        let operations = &self.step().0.tape().operations;
        let values = operations.iter().map(|operation| {
            run(std::slice::from_ref(operation), &mut registers, &scalars);
            registers[usize::from(operation.register)].lanes()[0].to_f64()
        });
        values.collect()
    }

    /// The scalars of the row's step.
    fn scalars(&self) -> Vec<f64> {
        let (step, columns) = self.step();
        [columns, step.constants()].concat()
    }

    /// The prior of the row in the problem's own units: n states, then the upper triangle of P row by row.
    #[must_use]
    pub fn prior(&self, seen: &Seen) -> Vec<f64> {
        self.program.prior(&seen.before, &self.nominal)
    }
}
