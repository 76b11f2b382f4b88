//! Where two runs of a row part: the first operation whose results are farther apart than rounding explains, and why.

use super::{Probe, Seen};
use crate::filter::{Program, Role};
use crate::precision::Precision;
use crate::tape::lanes::{Lane, Register, run};
use crate::tape::{Argument, Operation};

/// The first operation in which a run parts from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parting {
    /// Its place in the step.
    pub operation: usize,
    /// How far apart the results are, as a share of the operation's [largest term](Operation::size), or of what one standard
    /// deviation of a state makes of its result where that is more: a state in deviation form may be 0 but for rounding.
    pub share: f64,
    /// Where the difference comes from.
    pub source: Source,
}

/// Where a difference comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// The operation itself.
    Own,
    /// What stood in a register before the row: an earlier row.
    Before {
        /// Carried, or an invariant.
        register: usize,
        /// How far apart the values are, as a share of them.
        share: f64,
    },
    /// An earlier operation of the row whose terms cancel: rounding that was small beside them is not beside their sum.
    Cancelled {
        /// Its place in the step.
        operation: usize,
        /// Its result as a share of its largest term.
        left: f64,
    },
}

/// The operations of the row with where their operands come from.
struct Trail<'a> {
    program: &'a Program,
    operations: &'a [Operation],
    /// For each operand the operation that wrote it, if one of this row did.
    writers: Vec<[Option<usize>; 5]>,
    scalars: Vec<f64>,
    /// For each operation, and for each register before the row, what one standard deviation of a state makes of it.
    effects: Vec<f64>,
    spreads: Vec<f64>,
}

impl Probe {
    /// For each operation how far `found` is from `expected`, as [`Parting::share`]; `None` for running products,
    /// from which each machine takes powers of two, and where chunks begin everything.
    #[must_use]
    pub fn shares(&self, found: &Seen, expected: &Seen) -> Vec<Option<f64>> {
        let trail = Trail::new(self, &expected.before);
        (0..trail.operations.len()).map(|i| trail.share(i, found, expected)).collect()
    }

    /// Where `found` parts from `expected`: two runs of this row, from the start of the trajectory.
    #[must_use]
    pub fn parting(&self, found: &Seen, expected: &Seen) -> Option<Parting> {
        self.parting_beyond(self.bound(), found, expected)
    }

    pub(super) fn parting_beyond(&self, bound: f64, found: &Seen, expected: &Seen) -> Option<Parting> {
        let trail = Trail::new(self, &expected.before);
        let mut shares = (0..trail.operations.len()).map(|i| (i, trail.share(i, found, expected).unwrap_or(0.0)));
        let (operation, share) = shares.find(|(_, share)| *share > bound)?;
        Some(Parting { operation, share, source: trail.source(operation, found, expected, bound) })
    }

    /// The first operation that `found` gets wrong from operands of its own, and by what share of them: wherever those come
    /// from, + - * / and roots are right to a few roundings, and functions to [`Self::bound`].
    #[must_use]
    pub fn wrong(&self, found: &Seen) -> Option<(usize, f64)> {
        let trail = Trail::new(self, &found.before);
        let mut shares = (0..trail.operations.len()).map(|i| (i, trail.own_share(i, found)));
        shares.find(|(i, share)| *share > self.own_bound(&trail.operations[*i]))
    }

    /// From which share on runs part.
    #[must_use]
    pub fn bound(&self) -> f64 {
        ROUNDINGS * epsilon(self.program.precision())
    }

    /// The largest change of each operation's result, and of each register before the row, when one of the states that stand
    /// `before` it moves by its standard deviation.
    fn effects(&self, before: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let values = self.values::<f64>(before);
        let (mut effects, mut spreads) = (vec![0.0_f64; values.len()], vec![0.0; before.len()]);
        for (register, spread) in self.program.spreads(before) {
            spreads[register] = spread;
            let mut moved = before.to_vec();
            moved[register] += spread;
            let moved = self.values::<f64>(&moved);
            let changes = values.iter().zip(moved).map(|(value, moved)| (moved - value).abs());
            effects.iter_mut().zip(changes).for_each(|(effect, change)| *effect = effect.max(change));
        }
        (effects, spreads)
    }

    fn own_bound(&self, operation: &Operation) -> f64 {
        if operation.is_arithmetic() { OWN_ROUNDINGS * epsilon(self.program.precision()) } else { self.bound() }
    }
}

/// Roundings from which on runs part: half of the digits of f32. The examples gather 22 over their logs, 450 where P is close
/// to singular, and an adaptive filter, which takes differences of squares, 2200.
const ROUNDINGS: f64 = 4096.0;

/// Roundings that one operation may have: WGSL allows a division 2.5 units in the last place, and fuses.
const OWN_ROUNDINGS: f64 = 8.0;

const fn epsilon(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => f32::EPSILON as f64,
        Precision::F64 => f64::EPSILON,
    }
}

impl<'a> Trail<'a> {
    /// With `before` standing before the row.
    fn new(probe: &'a Probe, before: &[f64]) -> Self {
        let operations = &*probe.step().0.tape().operations;
        let mut latest = vec![None; probe.program.registers()];
        let of = |(i, operation): (usize, &Operation)| {
            let writers = operation.arguments.map(|argument| match argument {
                Argument::Register(register) => latest[usize::from(register)],
                Argument::Scalar(_) => None,
            });
            latest[usize::from(operation.register)] = Some(i);
            writers
        };
        let writers = operations.iter().enumerate().map(of).collect();
        let (effects, spreads) = probe.effects(before);
        Self { program: &probe.program, operations, writers, scalars: probe.scalars(), effects, spreads }
    }

    /// Operand `a` of operation `i`; 0 where it has none.
    fn operand(&self, i: usize, a: usize, seen: &Seen) -> f64 {
        match (self.operations[i].arguments[a], self.writers[i][a]) {
            (Argument::NONE, _) => 0.0,
            (Argument::Scalar(scalar), _) => self.scalars[usize::from(scalar)],
            (Argument::Register(_), Some(writer)) => seen.values[writer],
            (Argument::Register(register), None) => seen.before[usize::from(register)],
        }
    }

    /// What a standard deviation makes of operand `a` of operation `i`.
    fn effect(&self, i: usize, a: usize) -> f64 {
        match (self.operations[i].arguments[a], self.writers[i][a]) {
            (Argument::Scalar(_), _) => 0.0,
            (Argument::Register(_), Some(writer)) => self.effects[writer],
            (Argument::Register(register), None) => self.spreads[usize::from(register)],
        }
    }

    /// The largest term of operation `i`.
    fn size(&self, i: usize, seen: &Seen) -> f64 {
        self.operations[i].size([0, 1, 2, 3, 4].map(|a| self.operand(i, a, seen)), seen.values[i])
    }

    fn share(&self, i: usize, found: &Seen, expected: &Seen) -> Option<f64> {
        let is_product = |argument: &Argument, writer: &Option<usize>| match (argument, writer) {
            (Argument::Register(register), None) => {
                self.program.carried().get(usize::from(*register)).is_some_and(|c| c.role == Role::Product)
            }
            _ => false,
        };
        let skipped = self.operations[i].arguments.iter().zip(&self.writers[i]).any(|(a, w)| is_product(a, w));
        let size = || self.size(i, expected).max(self.effects[i]);
        (!skipped).then(|| apart(found.values[i], expected.values[i], size()))
    }

    /// How far the result of operation `i` is from what its own operands come to on the lanes.
    fn own_share(&self, i: usize, seen: &Seen) -> f64 {
        let computed = match self.program.precision() {
            Precision::F32 => self.again::<f32>(i, seen),
            Precision::F64 => self.again::<f64>(i, seen),
        };
        apart(seen.values[i], computed, self.size(i, seen))
    }

    /// Operation `i` alone on the lanes, from the operands of `seen`.
    fn again<T: Lane>(&self, i: usize, seen: &Seen) -> f64 {
        let mut registers = [0, 1, 2, 3, 4].map(|a| Register::<T, 1, 1>::splat(T::from_f64(self.operand(i, a, seen))));
        let mut operation = self.operations[i];
        operation.register = 0;
        for (argument, register) in operation.arguments.iter_mut().zip(0..) {
            if *argument != Argument::NONE {
                *argument = Argument::Register(register);
            }
        }
        run(&[operation], &mut registers, &[]);
        registers[0].lanes()[0].to_f64()
    }

    /// Where the difference of operation `i` comes from: its operand that is farthest off, if one is.
    fn source(&self, i: usize, found: &Seen, expected: &Seen, bound: f64) -> Source {
        let off = |a: usize| {
            let (value, effect) = (self.operand(i, a, expected), self.effect(i, a));
            (a, apart(self.operand(i, a, found), value, value.abs().max(effect)))
        };
        let Some((a, share)) = (0..5).map(off).max_by(|(_, a), (_, b)| a.total_cmp(b)) else { return Source::Own };
        // Of a product the shares of two operands add up.
        match (self.operations[i].arguments[a], self.writers[i][a]) {
            _ if share <= bound / 2.0 => Source::Own,
            (Argument::Register(register), None) => Source::Before { register: register.into(), share },
            (_, Some(operation)) => {
                let value = expected.values[operation].abs().max(self.effects[operation]);
                let left = value / self.size(operation, expected);
                Source::Cancelled { operation, left }
            }
            (Argument::Scalar(_), None) => Source::Own,
        }
    }
}

/// How far two values are apart as a share of `size`; what even f32 cannot tell from 0 is 0.
fn apart(found: f64, expected: f64, size: f64) -> f64 {
    let error = (found - expected).abs();
    if found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan() || error < f32::MIN_POSITIVE.into()
    {
        return 0.0;
    }
    let share = error / size;
    if share.is_nan() { f64::INFINITY } else { share }
}
