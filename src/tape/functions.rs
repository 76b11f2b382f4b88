//! The functions of formulas, a row for each: its name, its operands, and the nodes that it becomes. Values, derivatives,
//! differences and WGSL are those of these nodes ([`super::operations`]).

use super::codes::{Binary, Unary};
use super::graph::{Graph, Id};
use std::f64::consts::{FRAC_2_SQRT_PI, LOG10_E, TAU};

/// Declares [`Function`] by its rows: variant, name, operands, nodes.
macro_rules! functions {
    ($($variant:ident $name:literal |$g:ident, $($operand:ident),+| $nodes:expr;)+) => {
        /// Functions a formula may call.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[expect(missing_docs, reason = "the names are the functions")]
        pub enum Function { $($variant),+ }

        impl Function {
            /// Every function with the name it has in formulas.
            pub const ALL: [(&'static str, Self); [$($name),+].len()] = [$(($name, Self::$variant)),+];

            /// Its name in formulas.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// Number of arguments.
            #[must_use]
            pub const fn arity(self) -> usize {
                match self { $(Self::$variant => [$(stringify!($operand)),+].len()),+ }
            }
        }

        impl Graph {
            /// A function of formulas; NaN where `arguments` are not as many as [`Function::arity`] says.
            pub fn call(&mut self, function: Function, arguments: &[Id]) -> Id {
                match (function, arguments) {
                    $((Function::$variant, &[$($operand),+]) => { let $g = &mut *self; $nodes })+
                    _ => self.constant(f64::NAN),
                }
            }
        }
    };
}

functions! {
    Sqrt "sqrt" |g, a| g.unary(Unary::Sqrt, a);
    Exp "exp" |g, a| g.unary(Unary::Exp, a);
    Expm1 "expm1" |g, a| g.unary(Unary::Expm1, a);
    Ln "ln" |g, a| g.unary(Unary::Ln, a);
    Log1p "log1p" |g, a| g.unary(Unary::Log1p, a);
    Log10 "log10" |g, a| {
        let (ln, scale) = (g.unary(Unary::Ln, a), g.constant(LOG10_E));
        g.mul(ln, scale)
    };
    Sin "sin" |g, a| g.unary(Unary::Sin, a);
    Cos "cos" |g, a| g.unary(Unary::Cos, a);
    Tan "tan" |g, a| {
        let (sin, cos) = (g.unary(Unary::Sin, a), g.unary(Unary::Cos, a));
        g.div(sin, cos)
    };
    Asin "asin" |g, a| {
        let x = complement(g, a);
        g.binary(Binary::Atan2, a, x)
    };
    Acos "acos" |g, a| {
        let y = complement(g, a);
        g.binary(Binary::Atan2, y, a)
    };
    Atan "atan" |g, a| {
        let one = g.constant(1.0);
        g.binary(Binary::Atan2, a, one)
    };
    Atan2 "atan2" |g, y, x| g.binary(Binary::Atan2, y, x);
    Tanh "tanh" |g, a| tanh(g, a);
    Sinc "sinc" |g, a| sinc(g, a);
    Cosc "cosc" |g, a| {
        let half = g.constant(0.5);
        let half = g.mul(half, a);
        let (sin, sinc) = (g.unary(Unary::Sin, half), sinc(g, half));
        g.mul(sin, sinc)
    };
    Wrap "wrap" |g, a| g.unary(Unary::Wrap, a);
    Floor "floor" |g, a| g.unary(Unary::Floor, a);
    Round "round" |g, a| g.unary(Unary::Round, a);
    Sign "sign" |g, a| {
        let [zero, plus, minus] = [0.0, 1.0, -1.0].map(|value| g.constant(value));
        let below = g.neg(a);
        let not_above = g.select(below, minus, zero);
        g.select(a, plus, not_above)
    };
    Abs "abs" |g, a| g.unary(Unary::Abs, a);
    Min "min" |g, a, b| g.binary(Binary::Min, a, b);
    Max "max" |g, a, b| g.binary(Binary::Max, a, b);
    Erf "erf" |g, a| erf(g, a);
    Lgamma "lgamma" |g, a| lgamma(g, a);
}

/// sqrt(1 - a^2), without its cancellation.
fn complement(g: &mut Graph, a: Id) -> Id {
    let one = g.constant(1.0);
    let (less, more) = (g.sub(one, a), g.add(one, a));
    let product = g.mul(less, more);
    g.unary(Unary::Sqrt, product)
}

/// -e / (e + 2) with e = exp(-2 |a|) - 1, and the sign of a.
fn tanh(g: &mut Graph, a: Id) -> Id {
    let (minus_two, two) = (g.constant(-2.0), g.constant(2.0));
    let size = g.unary(Unary::Abs, a);
    let exponent = g.mul(minus_two, size);
    let e = g.unary(Unary::Expm1, exponent);
    let sum = g.add(e, two);
    let below = g.div(e, sum);
    let above = g.neg(below);
    g.select(a, above, below)
}

/// c_0 + c_1 x + c_2 x^2 + ...
fn polynomial(g: &mut Graph, x: Id, coefficients: &[f64]) -> Id {
    coefficients.iter().rev().fold(g.constant(0.0), |sum, c| {
        let (product, c) = (g.mul(sum, x), g.constant(*c));
        g.add(product, c)
    })
}

/// sin a / a: within 1 its series, in which nothing cancels, nor in its derivative.
fn sinc(g: &mut Graph, a: Id) -> Id {
    let series: Vec<f64> = (0..10)
        .scan(1.0, |term, k| {
            let value = *term;
            *term /= -f64::from((2 * k + 2) * (2 * k + 3));
            Some(value)
        })
        .collect();
    let (one, square) = (g.constant(1.0), g.mul(a, a));
    let near = g.sub(one, square);
    let within = polynomial(g, square, &series);
    let not_zero = g.select(near, one, a);
    let sin = g.unary(Unary::Sin, a);
    let beyond = g.div(sin, not_zero);
    g.select(near, within, beyond)
}

/// The error function: within 1 by a polynomial in a^2, beyond as 1 - exp(-a^2) times one in 1 / (4 + |a|), both by Chebyshev
/// interpolation with 60 digits (`tests/functions/erf.py`); from 6 on it is 1.
fn erf(g: &mut Graph, a: Id) -> Id {
    const NEAR: [f64; 12] = [
        FRAC_2_SQRT_PI,
        -0.37612638903183543,
        0.11283791670945006,
        -0.02686617064323777,
        0.0052239776071164225,
        -0.0008548325975389692,
        0.00012055294904839707,
        -1.492473690741966e-05,
        1.6447424703317362e-06,
        -1.6208483801871705e-07,
        1.3720064546777686e-08,
        -7.795898827002142e-10,
    ];
    /// erfcx in y = (1 / (4 + |a|) - 3/20) 20, which goes from 1 at 1 to -1 at 6.
    const FAR: [f64; 16] = [
        0.19907263099386566,
        0.14812992991458332,
        0.055891085566079926,
        0.018078437227012082,
        0.004990286041095359,
        0.0011615374405673708,
        0.00022259643172453767,
        3.346127706454e-05,
        3.498817724639476e-06,
        1.4320649275925599e-07,
        -2.5772220860626256e-08,
        -4.956466489229388e-09,
        -1.0609088834225667e-10,
        6.917780982018686e-11,
        5.9943243455437045e-12,
        -7.970561922845925e-13,
    ];
    let [one, four, middle, scale] = [1.0, 4.0, 0.15, 20.0].map(|value| g.constant(value));
    let square = g.mul(a, a);
    let inside = g.sub(one, square);
    let near = polynomial(g, square, &NEAR);
    let near = g.mul(a, near);
    let (size, six) = (g.unary(Unary::Abs, a), g.constant(6.0));
    let size = g.binary(Binary::Min, size, six);
    let sum = g.add(four, size);
    let inverse = g.div(one, sum);
    let y = g.sub(inverse, middle);
    let y = g.mul(y, scale);
    let tail = polynomial(g, y, &FAR);
    let exponent = g.mul(size, size);
    let exponent = g.neg(exponent);
    let exp = g.unary(Unary::Exp, exponent);
    let complement = g.mul(exp, tail);
    let above = g.sub(one, complement);
    let below = g.neg(above);
    let far = g.select(a, above, below);
    g.select(inside, near, far)
}

/// ln Gamma(a), by Stirling's series from 8 on and before that by the recurrence Gamma(a) = Gamma(a + 8) / (a (a + 1) ... (a + 7));
/// NaN for a <= 0. Both are whole branches, so that a difference across 8 keeps its digits.
fn lgamma(g: &mut Graph, a: Id) -> Id {
    let [seven, eight, nine, minus_one] = [7.0, 8.0, 9.0, -1.0].map(|value| g.constant(value));
    // Bounded beyond where they are used, against overflow; at 8 itself the slope is a's.
    let (low, high) = (g.binary(Binary::Min, a, nine), g.binary(Binary::Max, a, seven));
    let product = (1..8).fold(low, |product, k| {
        let k = g.constant(f64::from(k));
        let factor = g.add(low, k);
        g.mul(product, factor)
    });
    let product = g.select(a, product, minus_one);
    let (ln, shifted) = (g.unary(Unary::Ln, product), g.add(low, eight));
    let far = stirling(g, shifted);
    let below = g.sub(far, ln);
    let above = stirling(g, high);
    let small = g.sub(eight, a);
    g.select(small, below, above)
}

/// ln Gamma(a) for a from 8 (Abramowitz and Stegun 6.1.41).
fn stirling(g: &mut Graph, a: Id) -> Id {
    /// B_2k / (2k (2k - 1)).
    const SERIES: [f64; 8] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
        -3617.0 / 122_400.0,
    ];
    let [one, half, constant] = [1.0, 0.5, 0.5 * TAU.ln()].map(|value| g.constant(value));
    let inverse = g.div(one, a);
    let square = g.mul(inverse, inverse);
    let series = polynomial(g, square, &SERIES);
    let series = g.mul(series, inverse);
    let (ln, less) = (g.unary(Unary::Ln, a), g.sub(a, half));
    let leading = g.mul(less, ln);
    let leading = g.sub(leading, a);
    let rest = g.add(series, constant);
    g.add(leading, rest)
}
