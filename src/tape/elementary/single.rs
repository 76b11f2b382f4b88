//! f32, with the polynomials of Cephes 2.x (files `sinf.c`, `expf.c`, `logf.c`, `atanf.c`): errors of 1 to 3 ulp. Angles are
//! reduced in f64, or near multiples of pi/2 all digits would be lost; powers are taken in f64 altogether.

#![expect(clippy::excessive_precision, reason = "coefficients as they were published")]

use super::double;
use std::f64::consts::FRAC_2_PI;

over_lanes! { f32:
    sin = |a| super::sin(a);
    cos = |a| super::cos(a);
    exp = |a| super::exp(a);
    expm1 = |a| super::expm1(a);
    ln = |a| super::ln(a);
    log1p = |a| super::log1p(a);
    wrap = |a| super::wrap(a);
    atan2 = |a, b| super::atan2(a, b);
    power = |a, b| super::power(a, b);
}

/// 1.5 x 2^23: what is added to it is rounded to a whole number, which then stands in the low bits of the sum.
const MAGIC: f32 = 12_582_912.0;

/// The nearest whole number, and the same as an integer.
#[inline(always)]
fn whole(a: f32) -> (f32, u32) {
    let sum = a + MAGIC;
    (sum - MAGIC, sum.to_bits().wrapping_sub(MAGIC.to_bits()))
}

/// Angles are reduced by quarter turns up to here.
pub(in crate::tape) const FAR: f32 = 1e5;

/// c_0 + c_1 x + c_2 x^2 + ...
#[inline(always)]
fn horner<const N: usize>(x: f32, coefficients: [f32; N]) -> f32 {
    coefficients.into_iter().rev().reduce(|sum, c| sum * x + c).unwrap_or(0.0)
}

/// The sine of an angle `quarters` quarter turns on.
#[inline(always)]
fn sin_from(a: f32, quarters: u32) -> f32 {
    const MAGIC: f64 = 6_755_399_441_055_744.0;
    // 33 bits of pi/2, and the rest.
    const QUARTER: [f64; 2] = [1.570_796_326_734_125_614_17, 6.077_100_506_506_192_249_32e-11];
    const S: [f32; 3] = [-1.666_665_461_1e-1, 8.332_160_873_6e-3, -1.951_529_589_1e-4];
    const C: [f32; 3] = [4.166_664_568_298_827e-2, -1.388_731_625_493_765e-3, 2.443_315_711_809_948e-5];
    let a = f64::from(a);
    let sum = a * FRAC_2_PI + MAGIC;
    let n = sum - MAGIC;
    let quarters = quarters.wrapping_add(sum.to_bits() as u32);
    let x = ((a - n * QUARTER[0]) - n * QUARTER[1]) as f32;
    let z = x * x;
    let sin = x + x * (z * horner(z, S));
    let cos = 1.0 - 0.5 * z + z * z * horner(z, C);
    let value = if quarters & 1 == 0 { sin } else { cos };
    f32::from_bits(value.to_bits() ^ ((quarters & 2) << 30))
}

/// Within [`FAR`].
#[inline(always)]
pub(super) fn sin(a: f32) -> f32 {
    sin_from(a, 0)
}

/// Within [`FAR`].
#[inline(always)]
pub(super) fn cos(a: f32) -> f32 {
    sin_from(a, 1)
}

/// An angle in [-pi, pi], within [`FAR`].
#[inline(always)]
pub(super) fn wrap(a: f32) -> f32 {
    double::wrap(f64::from(a)) as f32
}

const LN_2: [f32; 2] = [0.693_359_375, -2.121_944_40e-4];

/// a 2^k for whole k from -254 to 254, rounded once.
#[inline(always)]
fn times_power(a: f32, k: u32) -> f32 {
    const BIAS: u32 = 127;
    let biased = k.wrapping_add(2 * BIAS);
    let half = biased >> 1;
    a * f32::from_bits(half << 23) * f32::from_bits((biased - half) << 23)
}

/// `a` within bounds; NaN stays.
#[inline(always)]
fn clamped(a: f32, low: f32, high: f32) -> f32 {
    let a = if a > high { high } else { a };
    if a < low { low } else { a }
}

/// exp(x) - 1 within ln(2) / 2.
#[inline(always)]
fn expm1_near(x: f32) -> f32 {
    const E: [f32; 6] = [
        5.000_000_120_1e-1,
        1.666_666_545_9e-1,
        4.166_579_589_4e-2,
        8.333_451_907_3e-3,
        1.398_199_950_7e-3,
        1.987_569_150_0e-4,
    ];
    x + x * x * horner(x, E)
}

#[inline(always)]
pub(super) fn exp(a: f32) -> f32 {
    let a = clamped(a, -105.0, 89.0);
    let (n, k) = whole(a * std::f32::consts::LOG2_E);
    times_power(1.0 + expm1_near((a - n * LN_2[0]) - n * LN_2[1]), k)
}

#[inline(always)]
pub(super) fn expm1(a: f32) -> f32 {
    let a = clamped(a, -20.0, 89.0);
    let (n, k) = whole(a * std::f32::consts::LOG2_E);
    let few = if n > 30.0 { 30 } else { k };
    let inverse = f32::from_bits(127_u32.wrapping_sub(few) << 23);
    let value = times_power((1.0 - inverse) + expm1_near((a - n * LN_2[0]) - n * LN_2[1]), k);
    if n == 0.0 { expm1_near(a) } else { value }
}

/// A positive normal number as 2^k m with m from sqrt(1/2) to sqrt(2): k and m.
#[inline(always)]
fn mantissa(a: f32) -> (f32, f32) {
    const ROOT: u32 = 0x3f35_04f3;
    let bits = a.to_bits().wrapping_add(0x3f80_0000 - ROOT);
    let k = ((bits >> 23) as i32 - 127) as f32;
    (k, f32::from_bits((bits & 0x007f_ffff) + ROOT))
}

/// k ln 2 + ln(1 + f) + c for small c.
#[inline(always)]
fn ln_sum(k: f32, f: f32, c: f32) -> f32 {
    const L: [f32; 9] = [
        3.333_333_117_4e-1,
        -2.499_999_399_3e-1,
        2.000_071_476_5e-1,
        -1.666_805_766_5e-1,
        1.424_932_278_7e-1,
        -1.242_014_084_6e-1,
        1.167_699_874_0e-1,
        -1.151_461_031_0e-1,
        7.037_683_629_2e-2,
    ];
    let z = f * f;
    let small = f * z * horner(f, L) + (k * LN_2[1] + c);
    (f + (small - 0.5 * z)) + k * LN_2[0]
}

#[inline(always)]
pub(super) fn ln(a: f32) -> f32 {
    let (scaled, less) = if a < f32::MIN_POSITIVE { (a * 33_554_432.0, 25.0) } else { (a, 0.0) };
    let (k, m) = mantissa(scaled);
    let value = ln_sum(k - less, m - 1.0, 0.0);
    let value = if a < f32::INFINITY { value } else { a };
    let value = if a == 0.0 { f32::NEG_INFINITY } else { value };
    if a < 0.0 { f32::NAN } else { value }
}

#[inline(always)]
pub(super) fn log1p(a: f32) -> f32 {
    let sum = 1.0 + a;
    let (k, m) = mantissa(sum);
    let lost = if k >= 2.0 { 1.0 - (sum - a) } else { a - (sum - 1.0) };
    let near = a > -0.2928 && a < 0.4142;
    let (f, c) = if near { (a, 0.0) } else { (m - 1.0, lost / sum) };
    let value = ln_sum(k, f, c);
    let value = if a < f32::INFINITY { value } else { a };
    let value = if sum == 0.0 { f32::NEG_INFINITY } else { value };
    if a < -1.0 { f32::NAN } else { value }
}

/// The angle of (x, y), in (-pi, pi].
#[inline(always)]
pub(super) fn atan2(y: f32, x: f32) -> f32 {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    const T: [f32; 4] = [-3.333_294_915_39e-1, 1.997_771_064_78e-1, -1.387_768_560_32e-1, 8.053_744_495_38e-2];
    let [a, b] = proportional(y.abs(), x.abs());
    let chosen = if a < 0.414_213_56 * b { (a, b, 0.0) } else { (a - b, a + b, FRAC_PI_4) };
    let (numerator, denominator, centre) = if a < 2.414_213_6 * b { chosen } else { (-b, a, FRAC_PI_2) };
    let t = numerator / denominator;
    let z = t * t;
    let angle = centre + (t + t * (z * horner(z, T)));
    let angle = if a + b == 0.0 { 0.0 } else { angle };
    let angle = if x.is_sign_negative() { PI - angle } else { angle };
    angle.copysign(y)
}

/// Two sizes, made so that their sum does not overflow; equal where both are infinite.
#[inline(always)]
fn proportional(a: f32, b: f32) -> [f32; 2] {
    let largest = if a > b { a } else { b };
    let factor = if largest > 1e38 { 0.125 } else { 1.0 };
    let factor = if largest < 1e-30 { 16_777_216.0 } else { factor };
    let both = a == f32::INFINITY && b == f32::INFINITY;
    if both { [1.0, 1.0] } else { [a * factor, b * factor] }
}

/// a^b; of a negative a for whole b alone.
#[inline(always)]
pub(super) fn power(a: f32, b: f32) -> f32 {
    let size = double::exp(f64::from(b) * double::ln(f64::from(a.abs()))) as f32;
    let half = 0.5 * b;
    let odd = half.fract() != 0.0;
    let signed = if odd { -size } else { size };
    let negative = if b.fract() == 0.0 { signed } else { f32::NAN };
    let value = if a < 0.0 { negative } else { size };
    if b == 0.0 { 1.0 } else { value }
}
