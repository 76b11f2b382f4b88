//! The track of one candidate: what a program in f64 predicts, row by row.

use super::carry::Entry;
use super::nominal::Nominal;
use super::program::{Initial, Program, Span};
use crate::tape::lanes::{Register, run_apart, run_one};

/// A register of one candidate.
type One = Register<f64, 1, 1>;

impl Program {
    /// The nominal of the deviation form: the predicted states of a candidate, in the problem's own units, by this program,
    /// which must be one in f64.
    #[must_use]
    pub fn nominal(&self, candidate: &[f64]) -> Nominal {
        let n = self.units().states.len();
        let mut states = Vec::with_capacity(n * self.rows());
        for (t, span) in self.spans().iter().enumerate() {
            let mut registers = self.start(candidate, span);
            let mut cursor = self.cursor(t);
            for row in span.rows.clone() {
                states.extend(self.predicted(&registers));
                let (step, columns) = cursor.step(row);
                let scalars = [columns, step.constants()].concat();
                run_apart(&step.tape().operations, &mut registers, &scalars);
            }
        }
        Nominal::new(candidate.to_vec(), states, n)
    }

    /// The registers of the step at the first row of a trajectory.
    fn start(&self, candidate: &[f64], span: &Span) -> Vec<One> {
        let mut results = candidate.to_vec();
        run_one(self.prologue(), &mut results, &span.scalars);
        let value = |initial| match initial {
            Initial::Result(register) => results[register],
            Initial::Number(value) => value,
        };
        let mut registers: Vec<One> = self.initial().map(|initial| One::splat(value(initial))).collect();
        registers.resize(self.registers(), One::splat(0.0));
        registers
    }

    /// The predicted states in the problem's own units.
    fn predicted<'a>(&'a self, registers: &'a [One]) -> impl Iterator<Item = f64> + 'a {
        self.entries.iter().zip(&self.units().states).map(|(entry, unit)| {
            let value = match entry {
                Entry::Constant(value) => *value,
                Entry::Carried(i) => registers[*i].lanes()[0],
            };
            value * 2.0_f64.powi(*unit)
        })
    }
}
