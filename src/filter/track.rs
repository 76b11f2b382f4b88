//! The track of one candidate: what a program in f64 predicts, row by row.

use super::carry::Entry;
use super::nominal::Nominal;
use super::program::{Program, Role, Span};
use crate::tape::lanes::{Register, run_apart, run_one};

/// A register of one candidate.
type One = Register<f64, 1, 1>;

impl Program {
    /// The nominal of the deviation form: the predicted states of a candidate, in the problem's own units, by this program,
    /// which must be one in f64 with its record.
    #[must_use]
    pub fn nominal(&self, candidate: &[f64]) -> Nominal {
        let n = self.units.states.len();
        let rows = self.spans.last().map_or(0, |span| span.rows.end);
        let mut states = Vec::with_capacity(n * rows);
        let mut scalars = vec![0.0; self.columns];
        scalars.extend_from_slice(&self.constants);
        for span in &self.spans {
            let mut registers = self.start(candidate, span);
            for row in span.rows.clone() {
                states.extend(self.predicted(&registers));
                scalars[..self.columns].copy_from_slice(&self.record[row * self.columns..(row + 1) * self.columns]);
                run_apart(&self.step.operations, &mut registers, &scalars);
            }
        }
        Nominal::new(candidate.to_vec(), states, n)
    }

    /// The registers of the step at the first row of a trajectory.
    fn start(&self, candidate: &[f64], span: &Span) -> Vec<One> {
        let mut results = candidate.to_vec();
        run_one(&self.prologue, &mut results, &span.scalars);
        let (states, rest) = results[self.parameters..].split_at(self.varies.len());
        let others =
            self.carried[states.len()..].iter().map(|carried| if carried.role == Role::Sum { 0.0 } else { 1.0 });
        let values = states.iter().copied().chain(others).chain(rest[..self.invariants].iter().copied());
        let mut registers: Vec<One> = values.map(One::splat).collect();
        registers.resize(self.step.registers.max(registers.len()), One::splat(0.0));
        registers
    }

    /// The predicted states in the problem's own units.
    fn predicted<'a>(&'a self, registers: &'a [One]) -> impl Iterator<Item = f64> + 'a {
        self.entries.iter().zip(&self.units.states).map(|(entry, unit)| {
            let value = match entry {
                Entry::Constant(value) => *value,
                Entry::Carried(i) => registers[*i].lanes()[0],
            };
            value * 2.0_f64.powi(*unit)
        })
    }
}
