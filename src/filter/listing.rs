//! A program, printed: what `kfgpu tape` shows.

use super::program::{Program, Step};
use super::units::Units;
use crate::tape::{Counts, Names};
use std::fmt::{self, Display, Formatter};

impl Display for Program {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.summarise(f)?;
        writeln!(f, "# prologue, once a trajectory in f64: {}", self.prologue().counts())?;
        let registers = self.register_names();
        let results = registers.iter().filter(|n| !n.starts_with("sum") && !n.starts_with("product") && *n != "check");
        let names: Vec<String> = self.parameter_names.iter().chain(results).cloned().collect();
        let names = Names { registers: &names, scalars: &[] };
        for operation in &self.prologue().operations {
            writeln!(f, "    {}", names.line(operation))?;
        }
        for (kind, step) in self.steps().iter().enumerate() {
            let rows = match self.steps().len() {
                1 => "step, once a row".to_owned(),
                _ => format!("step {kind}, in {} of the rows", step.rows()),
            };
            writeln!(f, "# {rows}: {}; {} registers", step.tape().counts(), step.tape().registers)?;
            for line in self.lines(step) {
                writeln!(f, "    {line}")?;
            }
        }
        Ok(())
    }
}

impl Program {
    /// What a row costs a candidate, in the mean over the log.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let rows = self.rows().max(1);
        let mean = |count: fn(&Counts) -> usize| {
            let total: usize = self.steps().iter().map(|step| step.rows() * count(&step.tape().counts())).sum();
            (total + rows / 2) / rows
        };
        Counts {
            flops: mean(|counts| counts.flops),
            divisions: mean(|counts| counts.divisions),
            others: mean(|counts| counts.others),
            copies: mean(|counts| counts.copies),
            operations: mean(|counts| counts.operations),
        }
    }

    fn summarise(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let columns = self.steps().iter().map(Step::columns).max().unwrap_or(0);
        writeln!(
            f,
            "# {} rows, {columns} columns a row, {} searched parameters, {} carried, {} invariants",
            self.rows(),
            self.parameters(),
            self.carried().len(),
            self.invariants()
        )?;
        writeln!(f, "# carries x and {}", self.form())?;
        if !self.units().are_own() {
            let Units { states, measurements } = self.units();
            writeln!(f, "# in units of 2 to the {states:?} (states) and {measurements:?} (measurements)")?;
        }
        Ok(())
    }

    /// The operations of a step as text.
    #[must_use]
    pub fn lines(&self, step: &Step) -> Vec<String> {
        let names = Names { registers: &self.register_names(), scalars: &step.scalar_names() };
        step.tape().operations.iter().map(|operation| names.line(operation)).collect()
    }

    /// Names of the carried registers and the invariants.
    #[must_use]
    pub fn register_names(&self) -> Vec<String> {
        let invariants = (0..self.invariants()).map(|i| format!("i{i}"));
        self.carried().iter().map(|c| c.name.clone()).chain(invariants).collect()
    }
}
