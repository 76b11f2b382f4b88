//! The track of one candidate: what a program in f64 predicts, row by row.

use super::carry::Entry;
use super::nominal::Nominal;
use super::program::{Program, Role};
use crate::tape::lanes::run_one;

impl Program {
    /// The nominal of the deviation form: the predicted states of a candidate, in the problem's own units, by this program,
    /// which must be one in f64 with its record.
    #[must_use]
    pub fn nominal(&self, candidate: &[f64]) -> Nominal {
        let n = self.units.states.len();
        let rows = self.spans.last().map_or(0, |span| span.rows.end);
        let mut states = Vec::with_capacity(n * rows);
        for span in &self.spans {
            let mut registers = candidate.to_vec();
            run_one(&self.prologue, &mut registers, &span.scalars);
            let mut results = registers.split_off(self.parameters);
            let invariants = results.split_off(self.varies.len());
            let own = self.carried.iter().map(|carried| match carried.role {
                Role::State | Role::Sum => 0.0,
                Role::Product | Role::Check => 1.0,
            });
            results.extend(own.skip(self.varies.len()));
            registers = results.into_iter().chain(invariants).collect();
            for row in span.rows.clone() {
                states.extend(self.predicted(&registers));
                let record = &self.record[row * self.columns..(row + 1) * self.columns];
                let scalars: Vec<f64> = record.iter().chain(&self.constants).copied().collect();
                run_one(&self.step, &mut registers, &scalars);
            }
        }
        Nominal::new(candidate.to_vec(), states, n)
    }

    /// The predicted states in the problem's own units.
    fn predicted<'a>(&'a self, registers: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.entries.iter().zip(&self.units.states).map(|(entry, unit)| {
            let value = match entry {
                Entry::Constant(value) => *value,
                Entry::Carried(i) => registers[*i],
            };
            value * 2.0_f64.powi(*unit)
        })
    }
}
