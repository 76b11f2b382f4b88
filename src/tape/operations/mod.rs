//! The operations of graph and tape. Each has one row that says all that is known of it: its value on lanes, its name in WGSL,
//! its derivative and its difference. What formulas call is written in these (see [`super::functions`]).

/// A function of lanes from one of a number, of one or two operands.
macro_rules! lanes {
    (|$a:ident| $value:expr) => {
        |lanes| {
            for lane in lanes {
                let $a = *lane;
                *lane = $value;
            }
        }
    };
    (|$a:ident, $b:ident| $value:expr) => {
        |lanes, others| {
            for (lane, other) in lanes.iter_mut().zip(others) {
                let ($a, $b) = (*lane, *other);
                *lane = $value;
            }
        }
    };
}

mod arithmetic;
mod circular;
mod exponential;
mod rounding;

use super::codes::{Binary, Unary};
use super::graph::{Graph, Id};
use super::moved::Moved;

/// Replaces lanes by a function of them.
type OnLanes<T> = fn(&mut [T]);
/// Replaces lanes by a function of them and of others.
type OnPairs<T> = fn(&mut [T], &[T]);

/// What an operation of one operand, y = op(a), is.
pub(super) struct One {
    pub(super) name: &'static str,
    pub(super) wgsl: Wgsl,
    pub(super) double: OnLanes<f64>,
    pub(super) single: OnLanes<f32>,
    /// From y, a and da to dy.
    pub(super) derivative: fn(&mut Graph, Id, Id, Id) -> Id,
    /// From a, which moves, and [y(base), y(value)] to y(value) - y(base).
    pub(super) difference: fn(&mut Graph, Moved, [Id; 2]) -> Id,
}

/// What an operation of two operands, y = op(a, b), is.
pub(super) struct Two {
    /// A name, or the sign that stands between the operands.
    pub(super) name: &'static str,
    pub(super) wgsl: Wgsl,
    pub(super) commutes: bool,
    pub(super) double: OnPairs<f64>,
    pub(super) single: OnPairs<f32>,
    /// From y, (a, b) and (da, db), not both 0, to dy.
    pub(super) derivative: fn(&mut Graph, Id, [Id; 2], [Id; 2]) -> Id,
    /// From (a, b), of which one moves, and [y(bases), y(values)] to y(values) - y(bases).
    pub(super) difference: fn(&mut Graph, [Moved; 2], [Id; 2]) -> Id,
}

impl Two {
    /// Whether its name stands between the operands.
    pub(super) const fn is_sign(&self) -> bool {
        matches!(self.wgsl, Wgsl::Sign)
    }
}

/// How WGSL writes an operation.
#[derive(Debug, Clone, Copy)]
pub(super) enum Wgsl {
    /// A sign before or between the operands.
    Sign,
    /// A function that every number format has.
    Call(&'static str),
    /// A function that f32 alone has.
    Single(&'static str),
}

impl Unary {
    pub(super) const fn row(self) -> &'static One {
        match self {
            Self::Negate => &arithmetic::NEGATE,
            Self::Sqrt => &arithmetic::SQRT,
            Self::Abs => &arithmetic::ABS,
            Self::Positive => &arithmetic::POSITIVE,
            Self::Exp => &exponential::EXP,
            Self::Ln => &exponential::LN,
            Self::Expm1 => &exponential::EXPM1,
            Self::Log1p => &exponential::LOG1P,
            Self::Sin => &circular::SIN,
            Self::Cos => &circular::COS,
            Self::Wrap => &circular::WRAP,
            Self::Floor => &rounding::FLOOR,
            Self::Round => &rounding::ROUND,
        }
    }

    /// Its value in f64, with the bits of the lanes.
    #[must_use]
    pub fn apply(self, a: f64) -> f64 {
        let mut lanes = [a];
        (self.row().double)(&mut lanes);
        lanes[0]
    }
}

impl Binary {
    pub(super) const fn row(self) -> &'static Two {
        match self {
            Self::Add => &arithmetic::ADD,
            Self::Subtract => &arithmetic::SUBTRACT,
            Self::Multiply => &arithmetic::MULTIPLY,
            Self::Divide => &arithmetic::DIVIDE,
            Self::Min => &arithmetic::MIN,
            Self::Max => &arithmetic::MAX,
            Self::Atan2 => &circular::ATAN2,
            Self::Power => &exponential::POWER,
        }
    }

    /// Its value in f64, with the bits of the lanes.
    #[must_use]
    pub fn apply(self, a: f64, b: f64) -> f64 {
        let mut lanes = [a];
        (self.row().double)(&mut lanes, &[b]);
        lanes[0]
    }
}
