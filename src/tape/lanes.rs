//! Runs a tape on the CPU: every operation over a block of candidates, one candidate a lane.
//!
//! A register is `B` chunks of `C` lanes; `C` fills one vector register of the widest instruction set, so that the inner
//! loops compile to plain vector code for whatever the caller's `#[target_feature]` allows. No operation ever contracts
//! `a * b + c`, so every instruction set and every block size gives the same bits.

use super::codes::{Binary, Unary};
use super::straight_line::{Argument, Code, Operation, Tape};
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that fits a lane: `f32` or `f64`.
pub trait Lane:
    Copy
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Steps after which a running product must be [split](Self::split), so that factors from 2e-19 to 1e19 (f32) or
    /// 1e-38 to 1e38 (f64) cannot overflow or underflow it.
    const STEPS_PER_SPLIT: usize;

    /// Its root.
    fn sqrt(self) -> Self;
    /// Its size.
    fn abs(self) -> Self;
    /// Rounded once.
    fn from_f64(value: f64) -> Self;
    /// Exact.
    fn to_f64(self) -> f64;
    /// Replaces lanes by an operation of them.
    fn unary(op: Unary, lanes: &mut [Self]);
    /// Replaces lanes by an operation of them and of as many others.
    fn binary(op: Binary, lanes: &mut [Self], others: &[Self]);
    /// A positive normal number as a mantissa in [1, 2) and a power of two. 0 keeps the mantissa 0 (a product that has met
    /// a factor that is not positive stays 0), and what is not finite becomes NaN.
    fn split(self) -> (Self, Self);
}

macro_rules! lane {
    ($float:ty, $column:ident, $bits:ty, $mantissa_bits:literal, $bias:literal, $steps:literal) => {
        impl Lane for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const STEPS_PER_SPLIT: usize = $steps;

            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }

            #[inline]
            fn unary(op: Unary, lanes: &mut [Self]) {
                (op.row().$column)(lanes);
            }

            #[inline]
            fn binary(op: Binary, lanes: &mut [Self], others: &[Self]) {
                (op.row().$column)(lanes, others);
            }

            #[inline(always)]
            fn split(self) -> (Self, Self) {
                const ONE: $bits = $bias << $mantissa_bits;
                const EXPONENT: $bits = (2 * $bias + 1) << $mantissa_bits;
                let bits = self.to_bits();
                let exponent = ((bits & EXPONENT) >> $mantissa_bits) as i32 - $bias;
                let mantissa = Self::from_bits(bits & !EXPONENT | ONE);
                // Times 0, what is too small becomes 0 and what is not finite NaN.
                let normal = (bits & EXPONENT).wrapping_sub(1) < EXPONENT - 1;
                let mantissa = if normal { mantissa } else { self * 0.0 };
                (mantissa, exponent as Self)
            }
        }
    };
}

lane!(f32, single, u32, 23, 127, 2);
lane!(f64, double, u64, 52, 1023, 8);

/// A register: `B` chunks of `C` candidates. Aligned to a cache line, or every wide access would touch two.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Register<T, const C: usize, const B: usize>([[T; C]; B]);

impl<T: Copy, const C: usize, const B: usize> Register<T, C, B> {
    /// The same value in every lane.
    #[inline(always)]
    pub const fn splat(value: T) -> Self {
        Self([[value; C]; B])
    }

    /// The value of each lane, in order.
    #[inline(always)]
    pub const fn lanes(&self) -> &[T] {
        self.0.as_flattened()
    }

    /// The value of each lane, to change.
    #[inline(always)]
    pub const fn lanes_mut(&mut self) -> &mut [T] {
        self.0.as_flattened_mut()
    }
}

/// Runs `tape` once.
///
/// # Panics
/// If `registers` is shorter than [`Tape::registers`] or `scalars` than [`Tape::scalars`].
#[inline(always)]
pub fn run<T: Lane, const C: usize, const B: usize>(
    tape: &[Operation],
    registers: &mut [Register<T, C, B>],
    scalars: &[T],
) {
    for operation in tape {
        execute(operation, registers, scalars);
    }
}

/// [`run`] outside the evaluator's time loop: not inlined, so that each shape of register is compiled once.
///
/// # Panics
/// As [`run`].
#[inline(never)]
pub fn run_apart<T: Lane, const C: usize, const B: usize>(
    tape: &[Operation],
    registers: &mut [Register<T, C, B>],
    scalars: &[T],
) {
    run(tape, registers, scalars);
}

/// Runs `tape` on one candidate in f64.
pub fn run_one(tape: &Tape, registers: &mut Vec<f64>, scalars: &[f64]) {
    let mut wide: Vec<Register<f64, 1, 1>> = registers.iter().map(|v| Register::splat(*v)).collect();
    wide.resize(tape.registers.max(wide.len()), Register::splat(0.0));
    run_apart(&tape.operations, &mut wide, scalars);
    *registers = wide.into_iter().map(|r| r.0[0][0]).collect();
}

/// `r[to] = f(registers, scalars)`, chunk by chunk. Every operand of a chunk is loaded before its result is stored, and each
/// has a name of its own: arrays of operands would be transposed in memory instead of staying in vector registers.
macro_rules! chunks {
    ($r:ident[$to:ident], [$($register:ident),*], $s:ident[$($scalar:ident),*], $f:expr) => {{
        $(let $scalar = $s[$scalar as usize];)*
        for k in 0..B {
            $(let $register = $r[$register as usize].0[k];)*
            $r[$to].0[k] = from_fn(|_lane| {
                $(let $register = $register[_lane];)*
                $f
            });
        }
    }};
}

#[inline(always)]
fn execute<T: Lane, const C: usize, const B: usize>(op: &Operation, r: &mut [Register<T, C, B>], s: &[T]) {
    use Argument::{Register as R, Scalar as S};
    use Binary::{Add, Divide, Multiply, Subtract};
    let to = op.register as usize;
    match (op.code, op.arguments) {
        (Code::Copy, [R(a), ..]) => chunks!(r[to], [a], s[], a),
        (Code::Copy, [S(a), ..]) => chunks!(r[to], [], s[a], a),
        (Code::Unary(Unary::Negate), [R(a), ..]) => chunks!(r[to], [a], s[], -a),
        (Code::Unary(Unary::Positive), [R(a), ..]) => chunks!(r[to], [a], s[], positive(a)),
        (Code::Unary(Unary::Abs), [R(a), ..]) => chunks!(r[to], [a], s[], a.abs()),
        (Code::Unary(Unary::Sqrt), [R(a), ..]) => chunks!(r[to], [a], s[], a.sqrt()),
        (Code::Binary(Add), [R(a), R(b), ..]) => chunks!(r[to], [a, b], s[], a + b),
        (Code::Binary(Add), [R(a), S(b), ..]) => chunks!(r[to], [a], s[b], a + b),
        (Code::Binary(Subtract), [R(a), R(b), ..]) => chunks!(r[to], [a, b], s[], a - b),
        (Code::Binary(Subtract), [R(a), S(b), ..]) => chunks!(r[to], [a], s[b], a - b),
        (Code::Binary(Subtract), [S(a), R(b), ..]) => chunks!(r[to], [b], s[a], a - b),
        (Code::Binary(Multiply), [R(a), R(b), ..]) => chunks!(r[to], [a, b], s[], a * b),
        (Code::Binary(Multiply), [R(a), S(b), ..]) => chunks!(r[to], [a], s[b], a * b),
        (Code::Binary(Divide), [R(a), R(b), ..]) => chunks!(r[to], [a, b], s[], a / b),
        (Code::Binary(Divide), [R(a), S(b), ..]) => chunks!(r[to], [a], s[b], a / b),
        (Code::Binary(Divide), [S(a), R(b), ..]) => chunks!(r[to], [b], s[a], a / b),
        (Code::MultiplyAdd, [R(a), R(b), R(c), ..]) => chunks!(r[to], [a, b, c], s[], a * b + c),
        (Code::MultiplyAdd, [R(a), S(b), R(c), ..]) => chunks!(r[to], [a, c], s[b], a * b + c),
        (Code::MultiplyAdd, [R(a), R(b), S(c), ..]) => chunks!(r[to], [a, b], s[c], a * b + c),
        (Code::MultiplyAdd, [R(a), S(b), S(c), ..]) => chunks!(r[to], [a], s[b, c], a * b + c),
        (Code::MultiplySubtract, [R(a), R(b), R(c), ..]) => chunks!(r[to], [a, b, c], s[], a * b - c),
        (Code::MultiplySubtract, [R(a), S(b), R(c), ..]) => chunks!(r[to], [a, c], s[b], a * b - c),
        (Code::SubtractProduct, [R(a), R(b), R(c), ..]) => chunks!(r[to], [a, b, c], s[], c - a * b),
        (Code::SubtractProduct, [R(a), S(b), R(c), ..]) => chunks!(r[to], [a, c], s[b], c - a * b),
        (Code::SubtractProduct, [R(a), R(b), S(c), ..]) => chunks!(r[to], [a, b], s[c], c - a * b),
        (Code::Dot, [R(a), R(b), R(c), R(d), _]) => chunks!(r[to], [a, b, c, d], s[], a * b + c * d),
        (Code::Dot, [R(a), R(b), R(c), S(d), _]) => chunks!(r[to], [a, b, c], s[d], a * b + c * d),
        (Code::Dot, [R(a), S(b), R(c), R(d), _]) => chunks!(r[to], [a, c, d], s[b], a * b + c * d),
        (Code::Dot, [R(a), S(b), R(c), S(d), _]) => chunks!(r[to], [a, c], s[b, d], a * b + c * d),
        (Code::DotAdd, [R(a), R(b), R(c), R(d), R(e)]) => chunks!(r[to], [a, b, c, d, e], s[], (a * b + e) + c * d),
        (Code::DotAdd, [R(a), R(b), R(c), S(d), R(e)]) => chunks!(r[to], [a, b, c, e], s[d], (a * b + e) + c * d),
        (Code::DotAdd, [R(a), S(b), R(c), R(d), R(e)]) => chunks!(r[to], [a, c, d, e], s[b], (a * b + e) + c * d),
        (Code::DotAdd, [R(a), S(b), R(c), S(d), R(e)]) => chunks!(r[to], [a, c, e], s[b, d], (a * b + e) + c * d),
        (Code::MultiplyPositive, [R(a), R(b), ..]) => chunks!(r[to], [a, b], s[], a * positive(b)),
        (Code::Select, [S(a), R(b), S(c), ..]) => chunks!(r[to], [b], s[a, c], if a > T::ZERO { b } else { c }),
        (Code::Select, [R(a), R(b), S(c), ..]) => chunks!(r[to], [a, b], s[c], if a > T::ZERO { b } else { c }),
        (Code::Select, [R(a), S(b), S(c), ..]) => chunks!(r[to], [a], s[b, c], if a > T::ZERO { b } else { c }),
        _ => general(op, r, s),
    }
}

#[inline(always)]
fn positive<T: Lane>(a: T) -> T {
    if a > T::ZERO { a } else { T::ZERO }
}

/// Any operation with operands from anywhere: the way of functions and of rare places of operands.
fn general<T: Lane, const C: usize, const B: usize>(op: &Operation, r: &mut [Register<T, C, B>], s: &[T]) {
    let [a, b, c, d, e] = op.arguments.map(|argument| match argument {
        Argument::Register(register) => r[register as usize],
        Argument::NONE => Register::splat(T::ZERO),
        Argument::Scalar(scalar) => Register::splat(s[scalar as usize]),
    });
    let to = &mut r[op.register as usize];
    *to = a;
    match op.code {
        Code::Copy => {}
        Code::Unary(unary) => T::unary(unary, to.lanes_mut()),
        Code::Binary(binary) => T::binary(binary, to.lanes_mut(), b.lanes()),
        _ => fused(op.code, to.lanes_mut(), [&b, &c, &d, &e].map(Register::lanes)),
    }
}

/// Fused operations lane by lane; `lanes` hold the first operand.
fn fused<T: Lane>(code: Code, lanes: &mut [T], [b, c, d, e]: [&[T]; 4]) {
    for (lane, to) in lanes.iter_mut().enumerate() {
        let (a, b, c, d, e) = (*to, b[lane], c[lane], d[lane], e[lane]);
        *to = match code {
            Code::Copy | Code::Unary(_) | Code::Binary(_) => a,
            Code::Select if a > T::ZERO => b,
            Code::Select => c,
            Code::MultiplyAdd => a * b + c,
            Code::MultiplySubtract => a * b - c,
            Code::SubtractProduct => c - a * b,
            Code::Dot => a * b + c * d,
            Code::DotAdd => (a * b + e) + c * d,
            Code::MultiplyPositive => a * positive(b),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_is_exact() {
        for value in [1.0, 0.75, 1e300, 3e-300, 6.02e23] {
            let (mantissa, exponent) = f64::split(value);
            assert!((1.0..2.0).contains(&mantissa), "{value}: mantissa {mantissa}");
            assert_eq!((mantissa * exponent.exp2()).to_bits(), value.to_bits(), "{value} is mantissa x 2^exponent");
        }
        let (mantissa, exponent) = f32::split(1e-20);
        assert_eq!((mantissa * exponent.exp2()).to_bits(), 1e-20_f32.to_bits(), "f32");
        assert!(f64::INFINITY.split().0.is_nan(), "overflow is not hidden");
    }

    /// Products of the smallest and largest factors that are promised, split as often as promised.
    #[test]
    fn products_between_splits_do_not_overflow() {
        fn logarithm<T: Lane>(factor: f64) -> f64 {
            let (mut product, mut twos) = (T::ONE, 0.0);
            for k in 1..=24 {
                product = product * T::from_f64(factor);
                if k % T::STEPS_PER_SPLIT == 0 {
                    let (mantissa, exponent) = product.split();
                    product = mantissa;
                    twos += exponent.to_f64();
                }
            }
            (product.to_f64().ln() + twos * std::f64::consts::LN_2) / 24.0
        }
        for factor in [1e-38_f64, 1e-19, 0.3, 1e19, 1e38] {
            assert!((logarithm::<f64>(factor) - factor.ln()).abs() < 1e-12, "f64, {factor}");
        }
        for factor in [2e-19_f64, 0.3, 1e19] {
            assert!((logarithm::<f32>(factor) - factor.ln()).abs() < 1e-6, "f32, {factor}");
        }
    }
}
