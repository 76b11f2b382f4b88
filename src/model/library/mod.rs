//! Built-in motion models and sensors. They expand to the same formulas that a user could type, and nothing downstream knows
//! the difference.
//!
//! Adding one: a file with a `BuiltIn`, and a row in [`ALL`]; a sensor is a row in [`SENSORS`].

mod constant_acceleration;
mod constant_velocity;
mod coordinated_turn;
mod local_level;
mod local_linear_trend;
mod random_walk;
mod sensor;
mod singer;
mod unicycle;

#[cfg(test)]
mod tests;

use super::error::Fault;
use super::{Binary, Expr, ExprKind, Function, Span, Symbol};

pub(crate) use sensor::{SENSORS, Sensor, offset};

/// Every built-in model.
pub(crate) const ALL: [BuiltIn; 8] = [
    local_level::MODEL,
    local_linear_trend::MODEL,
    random_walk::MODEL,
    constant_velocity::MODEL,
    constant_acceleration::MODEL,
    singer::MODEL,
    coordinated_turn::MODEL,
    unicycle::MODEL,
];

/// Names of the built-in models, as `kind` in problem files has them.
pub fn built_in_models() -> impl Iterator<Item = &'static str> {
    ALL.iter().map(|model| model.name)
}

/// Names of the built-in sensors, as `h` in problem files has them.
pub fn built_in_sensors() -> impl Iterator<Item = &'static str> {
    SENSORS.iter().map(|sensor| sensor.name)
}

/// One built-in model: per axis d components, the first of which is a position. Where nothing else is said, that is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BuiltIn {
    /// Name in problem files (`kind = "..."`).
    pub(crate) name: &'static str,
    /// Least and largest number of axes.
    pub(crate) axes: [usize; 2],
    /// A state before those of the axes.
    pub(crate) leading: Option<Leading>,
    /// State name of each component: prefix + axis.
    pub(crate) components: &'static [&'static str],
    /// Keys of its own: noise strengths, and what else it asks for.
    pub(crate) strengths: &'static [&'static str],
    /// Reads them, and writes the model out.
    pub(crate) read: fn(&dyn Keys) -> Result<Motion, Fault>,
}

/// A state that belongs to no axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leading {
    pub(crate) name: &'static str,
    /// Whether it is an angle.
    pub(crate) angle: bool,
    /// The key that stands for it where it is known; there is no such state then.
    pub(crate) unless: Option<&'static str>,
}

/// What `[model]` says of a built-in model.
pub(crate) trait Keys {
    /// Number of axes.
    fn axes(&self) -> usize;

    /// Whether the key is there.
    fn has(&self, key: &str) -> bool;

    /// What noise strengths mean.
    fn noise(&self) -> Result<Noise, Fault>;

    /// A formula of parameters for each axis.
    fn strengths(&self, key: &'static str) -> Result<Vec<Expr>, Fault>;

    /// A formula of parameters.
    fn strength(&self, key: &'static str) -> Result<Expr, Fault>;

    /// A formula of inputs, parameters and dt; without the key, the input or parameter of its name, which is `what`.
    fn known(&self, key: &'static str, what: &'static str) -> Result<Expr, Fault>;

    /// The error for a key that is there.
    fn refuse(&self, key: &'static str, problem: String) -> Fault;
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
    /// State names: the leading one, then component by component, `x, y, vx, vy`.
    pub(crate) fn states(&self, axes: &[String], has: impl Fn(&str) -> bool) -> Vec<String> {
        let leading = self.leading.filter(|leading| !leading.unless.is_some_and(has));
        let of_axes = self.components.iter().flat_map(|prefix| axes.iter().map(move |axis| format!("{prefix}{axis}")));
        leading.iter().map(|leading| leading.name.to_owned()).chain(of_axes).collect()
    }
}

/// Q of one axis, d x d row-major, from one strength per key.
type NoiseOfAxis = fn(Noise, &[Expr]) -> Vec<Expr>;

/// Chains of integrators: each component of an axis is the derivative of the one before.
fn chains(
    keys: &dyn Keys,
    depth: usize,
    strengths: &[&'static str],
    process_noise: NoiseOfAxis,
) -> Result<Motion, Fault> {
    let (axes, noise) = (keys.axes(), keys.noise()?);
    let by_key: Vec<Vec<Expr>> = strengths.iter().map(|key| keys.strengths(key)).collect::<Result<_, _>>()?;
    let of_axis = |axis: usize| process_noise(noise, &by_key.iter().map(|all| all[axis].clone()).collect::<Vec<_>>());
    let transition = |component: usize, axis: usize| integrate((component..depth).map(|c| c * axes + axis));
    Ok(by_axes(axes, depth, transition, of_axis))
}

/// Axes that do not mix: the next value of a component, and Q of an axis; the first component is measured.
fn by_axes(
    axes: usize,
    depth: usize,
    transition: impl Fn(usize, usize) -> Expr,
    process_noise: impl Fn(usize) -> Vec<Expr>,
) -> Motion {
    let n = axes * depth;
    let state = |component: usize, axis: usize| component * axes + axis;
    let mut motion = Motion { f: Vec::with_capacity(n), h: Vec::new(), q: vec![Expr::number(0.0); n * n] };
    for component in 0..depth {
        motion.f.extend((0..axes).map(|axis| transition(component, axis)));
    }
    motion.h.extend((0..axes).map(|axis| Expr::symbol(Symbol::State(axis))));
    for axis in 0..axes {
        for (i, entry) in process_noise(axis).into_iter().enumerate() {
            motion.q[state(i / depth, axis) * n + state(i % depth, axis)] = entry;
        }
    }
    motion
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
        _ => self::power(Expr::symbol(Symbol::Dt), power),
    }
}

fn times(a: Expr, b: Expr) -> Expr {
    Expr::binary(Binary::Multiply, a, b)
}

fn over(a: Expr, b: Expr) -> Expr {
    Expr::binary(Binary::Divide, a, b)
}

fn plus(a: Expr, b: Expr) -> Expr {
    Expr::binary(Binary::Add, a, b)
}

fn minus(a: Expr, b: Expr) -> Expr {
    Expr::binary(Binary::Subtract, a, b)
}

fn power(a: Expr, exponent: u8) -> Expr {
    Expr::binary(Binary::Power, a, Expr::number(f64::from(exponent)))
}

fn call(function: Function, arguments: &[Expr]) -> Expr {
    Expr { kind: ExprKind::Call(function, arguments.to_vec()), span: Span::default() }
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
