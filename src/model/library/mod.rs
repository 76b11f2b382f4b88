//! Built-in motion models. Each axis is an independent chain of integrators; they expand to the same formulas that a
//! user could type, and nothing downstream knows the difference.
//!
//! Adding one: a file with a `BuiltIn`, and a row in [`ALL`].

mod constant_acceleration;
mod constant_velocity;
mod local_level;
mod local_linear_trend;
mod random_walk;

#[cfg(test)]
mod tests;

use super::{Binary, Expr, Symbol};

/// Every built-in model.
pub(crate) const ALL: [BuiltIn; 5] = [
    local_level::MODEL,
    local_linear_trend::MODEL,
    random_walk::MODEL,
    constant_velocity::MODEL,
    constant_acceleration::MODEL,
];

/// Names of the built-in models, as `kind` in problem files has them.
pub fn built_in_models() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|model| model.name)
}

/// Most axes a built-in model takes.
pub(crate) const MAX_AXES: usize = 3;

/// One built-in model: per axis d components, each the derivative of the one before; the first is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BuiltIn {
    /// Name in problem files (`kind = "..."`).
    pub(crate) name: &'static str,
    /// State name of each component: prefix + axis.
    pub(crate) components: &'static [&'static str],
    /// Keys of its noise strengths.
    pub(crate) strengths: &'static [&'static str],
    /// Q of one axis, d x d row-major, from one strength per key.
    pub(crate) process_noise: fn(Noise, &[Expr]) -> Vec<Expr>,
}

/// What a noise strength means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Noise {
    /// Spectral density of white noise on the last derivative, integrated over the step.
    Continuous,
    /// Variance of a noise that stays constant over a step (Bar-Shalom, Li and Kirubarajan 2001, section 6.3).
    Piecewise,
}

/// A built-in model written out.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Motion {
    pub(crate) f: Vec<Expr>,
    pub(crate) h: Vec<Expr>,
    pub(crate) q: Vec<Expr>,
}

impl BuiltIn {
    /// State names, component by component: `x, y, vx, vy`.
    pub(crate) fn states(&self, axes: &[String]) -> Vec<String> {
        self.components.iter().flat_map(|prefix| axes.iter().map(move |axis| format!("{prefix}{axis}"))).collect()
    }

    /// Formulas for these strengths: one list per axis, one strength per key.
    pub(crate) fn expand(&self, noise: Noise, strengths: &[Vec<Expr>]) -> Motion {
        let (axes, depth) = (strengths.len(), self.components.len());
        let n = axes * depth;
        let state = |component: usize, axis: usize| component * axes + axis;
        let mut motion = Motion { f: Vec::with_capacity(n), h: Vec::new(), q: vec![Expr::number(0.0); n * n] };
        for component in 0..depth {
            for axis in 0..axes {
                motion.f.push(integrate((component..depth).map(|c| state(c, axis))));
            }
        }
        motion.h.extend((0..axes).map(|axis| Expr::symbol(Symbol::State(axis))));
        for (axis, strengths) in strengths.iter().enumerate() {
            for (i, entry) in (self.process_noise)(noise, strengths).into_iter().enumerate() {
                motion.q[state(i / depth, axis) * n + state(i % depth, axis)] = entry;
            }
        }
        motion
    }
}

/// x + v dt + a dt^2 / 2 for the states x, v, a.
fn integrate(states: impl Iterator<Item = usize>) -> Expr {
    let mut sum: Option<Expr> = None;
    for (order, state) in (0_u8..).zip(states) {
        let state = Expr::symbol(Symbol::State(state));
        let term = match order {
            0 => state,
            1 => times(state, dt(1)),
            _ => times(times(Expr::number(0.5), state), dt(order)),
        };
        sum = Some(match sum {
            None => term,
            Some(sum) => Expr::binary(Binary::Add, sum, term),
        });
    }
    sum.unwrap_or(Expr::number(0.0))
}

/// dt^power.
fn dt(power: u8) -> Expr {
    match power {
        1 => Expr::symbol(Symbol::Dt),
        _ => Expr::binary(Binary::Power, Expr::symbol(Symbol::Dt), Expr::number(f64::from(power))),
    }
}

fn times(a: Expr, b: Expr) -> Expr {
    Expr::binary(Binary::Multiply, a, b)
}

/// strength * dt^power / divisor; power 0 and divisor 1 are left out.
fn share(strength: &Expr, power: u8, divisor: u8) -> Expr {
    let scaled = if power == 0 { strength.clone() } else { times(strength.clone(), dt(power)) };
    match divisor {
        1 => scaled,
        _ => Expr::binary(Binary::Divide, scaled, Expr::number(f64::from(divisor))),
    }
}

/// The symmetric matrix of strength * dt^power / divisor, from (power, divisor) entries in row-major order.
fn matrix(strength: &Expr, entries: &[(u8, u8)]) -> Vec<Expr> {
    entries.iter().map(|(power, divisor)| share(strength, *power, *divisor)).collect()
}
