//! Runs of a few candidates by a program in f64, row by row.

use super::nominal::Nominal;
use super::program::{Initial, Program};
use crate::tape::lanes::{Register, run_apart};

impl Program {
    /// The nominal of the deviation form: the predicted states of a candidate, in the problem's own units, by this program,
    /// which must be one in f64.
    #[must_use]
    pub fn nominal(&self, candidate: &[f64]) -> Nominal {
        let n = self.units().states.len();
        let mut states = Vec::with_capacity(n * self.rows());
        let before = |registers: &[Register<f64, 1, 1>]| states.extend(self.predicted(registers));
        self.walk(&[candidate.to_vec()], before, |_, _| ());
        Nominal::new(candidate.to_vec(), states, n)
    }

    /// Runs up to `C` candidates side by side through the log (the last one fills the lanes that are left): `before` sees the
    /// registers at each row, `after` what the row has made of them.
    pub(super) fn walk<const C: usize>(
        &self,
        candidates: &[Vec<f64>],
        mut before: impl FnMut(&[Register<f64, C, 1>]),
        mut after: impl FnMut(usize, &mut [Register<f64, C, 1>]),
    ) {
        let splat = Register::<f64, C, 1>::splat;
        for (t, span) in self.spans().iter().enumerate() {
            let mut prologue = vec![splat(0.0); self.prologue().registers.max(self.parameters())];
            for (lane, candidate) in (0..C).map(|lane| (lane, &candidates[lane.min(candidates.len() - 1)])) {
                candidate.iter().zip(&mut prologue).for_each(|(v, r)| r.lanes_mut()[lane] = *v);
            }
            run_apart(&self.prologue().operations, &mut prologue, &span.scalars);
            let mut registers = vec![splat(0.0); self.registers()];
            for (register, initial) in registers.iter_mut().zip(self.initial()) {
                *register = match initial {
                    Initial::Result(result) => prologue[result],
                    Initial::Number(value) => splat(value),
                };
            }
            let mut cursor = self.cursor(t);
            for row in span.rows.clone() {
                before(&registers);
                let (step, columns) = cursor.step(row);
                let scalars = [columns, step.constants()].concat();
                run_apart(&step.tape().operations, &mut registers, &scalars);
                after(row, &mut registers);
            }
        }
    }

    /// The predicted states in the problem's own units.
    fn predicted<'a>(&'a self, registers: &'a [Register<f64, 1, 1>]) -> impl Iterator<Item = f64> + 'a {
        let mean = self.mean(|register| registers[register].lanes()[0]);
        mean.into_iter().zip(&self.units().states).map(|(x, unit)| x * 2.0_f64.powi(*unit))
    }
}
