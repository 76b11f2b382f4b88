//! f64, with the coefficients of fdlibm 5.3 (files `k_sin.c`, `k_cos.c`, `e_rem_pio2.c`, `e_exp.c`, `s_expm1.c`, `e_log.c`,
//! `s_log1p.c`, `s_atan.c`, `e_atan2.c`): errors below 1 ulp, of atan2 below 1.5.

#![expect(clippy::excessive_precision, reason = "coefficients as they were published")]

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

over_lanes! { f64:
    sin = |a| super::sin(a);
    cos = |a| super::cos(a);
    exp = |a| super::exp(a);
    expm1 = |a| super::expm1(a);
    ln = |a| super::ln(a);
    log1p = |a| super::log1p(a);
    wrap = |a| super::wrap(a);
    atan2 = |a, b| super::atan2(a, b);
}

/// 1.5 x 2^52: what is added to it is rounded to a whole number, which then stands in the low bits of the sum.
const MAGIC: f64 = 6_755_399_441_055_744.0;

/// The nearest whole number, and the same as an integer (modulo 2^51).
#[inline(always)]
fn whole(a: f64) -> (f64, u64) {
    let sum = a + MAGIC;
    (sum - MAGIC, sum.to_bits().wrapping_sub(MAGIC.to_bits()))
}

/// Angles are reduced by quarter turns up to here.
pub(in crate::tape) const FAR: f64 = 1e5;

/// pi/2 in parts of 33 bits, so that their products with whole numbers up to 2^20 are exact, and what is left of it.
const QUARTERS: [f64; 4] = [
    1.570_796_326_734_125_614_17,
    6.077_100_506_303_965_976_60e-11,
    2.022_266_248_711_166_455_80e-21,
    8.478_427_660_368_899_569_97e-32,
];

/// a - n pi/2 with its tail, for whole n.
#[inline(always)]
fn less_quarters(a: f64, n: f64) -> [f64; 2] {
    let [first, second, third, rest] = QUARTERS.map(|part| n * part);
    let left = a - first;
    let (near, lost) = less(left, second);
    let (near, lost_too) = less(near, third);
    let tail = lost + lost_too - rest;
    let sum = near + tail;
    [sum, (near - sum) + tail]
}

/// a - b and what its rounding lost, where |a| >= |b| or the difference is exact.
#[inline(always)]
fn less(a: f64, b: f64) -> (f64, f64) {
    let difference = a - b;
    (difference, (a - difference) - b)
}

/// An angle less quarter turns, with its tail, and how many those were.
#[inline(always)]
fn reduce(a: f64) -> ([f64; 2], u64) {
    let (n, quarters) = whole(a * FRAC_2_PI);
    (less_quarters(a, n), quarters)
}

/// Sine of an angle within pi/4.
#[inline(always)]
fn sin_near([x, tail]: [f64; 2]) -> f64 {
    const S1: f64 = -1.666_666_666_666_663_243_48e-1;
    const S: [f64; 5] = [
        8.333_333_333_322_489_461_24e-3,
        -1.984_126_982_985_794_931_34e-4,
        2.755_731_370_707_006_767_89e-6,
        -2.505_076_025_340_686_341_95e-8,
        1.589_690_995_211_550_102_21e-10,
    ];
    let z = x * x;
    let v = z * x;
    x - ((z * (0.5 * tail - v * horner(z, S)) - tail) - v * S1)
}

/// Cosine of an angle within pi/4.
#[inline(always)]
fn cos_near([x, tail]: [f64; 2]) -> f64 {
    const C: [f64; 6] = [
        4.166_666_666_666_660_190_37e-2,
        -1.388_888_888_887_410_957_49e-3,
        2.480_158_728_947_672_941_78e-5,
        -2.755_731_435_139_066_330_35e-7,
        2.087_572_321_298_174_827_90e-9,
        -1.135_964_755_778_819_482_65e-11,
    ];
    let z = x * x;
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * (z * horner(z, C)) - x * tail))
}

/// c_0 + c_1 x + c_2 x^2 + ...
#[inline(always)]
fn horner<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    coefficients.into_iter().rev().reduce(|sum, c| sum * x + c).unwrap_or(0.0)
}

/// The sine `quarters` quarter turns on.
#[inline(always)]
fn turned(angle: [f64; 2], quarters: u64) -> f64 {
    let (sin, cos) = (sin_near(angle), cos_near(angle));
    let value = if quarters & 1 == 0 { sin } else { cos };
    f64::from_bits(value.to_bits() ^ ((quarters & 2) << 62))
}

/// Within [`FAR`].
#[inline(always)]
pub(super) fn sin(a: f64) -> f64 {
    let (angle, quarters) = reduce(a);
    turned(angle, quarters)
}

/// Within [`FAR`].
#[inline(always)]
pub(super) fn cos(a: f64) -> f64 {
    let (angle, quarters) = reduce(a);
    turned(angle, quarters.wrapping_add(1))
}

/// An angle in [-pi, pi), within [`FAR`].
#[inline(always)]
pub(super) fn wrap(a: f64) -> f64 {
    let (turns, _) = whole(a * (0.25 * FRAC_2_PI));
    let [near, _] = less_quarters(a, 4.0 * turns);
    let near = if near >= PI { near - TAU } else { near };
    if near < -PI { near + TAU } else { near }
}

const LN_2: [f64; 2] = [6.931_471_803_691_238_164_90e-1, 1.908_214_929_270_587_700_02e-10];
const LOG2_E: f64 = std::f64::consts::LOG2_E;

/// a 2^k for whole k from -2046 to 2046, rounded once.
#[inline(always)]
fn times_power(a: f64, k: u64) -> f64 {
    const BIAS: u64 = 1023;
    let biased = k.wrapping_add(2 * BIAS);
    let half = biased >> 1;
    a * f64::from_bits(half << 52) * f64::from_bits((biased - half) << 52)
}

/// `a` within bounds; NaN stays.
#[inline(always)]
fn clamped(a: f64, low: f64, high: f64) -> f64 {
    let a = if a > high { high } else { a };
    if a < low { low } else { a }
}

#[inline(always)]
pub(super) fn exp(a: f64) -> f64 {
    const P: [f64; 5] = [
        1.666_666_666_666_660_190_37e-1,
        -2.777_777_777_701_559_338_42e-3,
        6.613_756_321_437_934_361_17e-5,
        -1.653_390_220_546_525_153_90e-6,
        4.138_136_797_057_238_460_39e-8,
    ];
    let a = clamped(a, -750.0, 710.0);
    let (n, k) = whole(a * LOG2_E);
    let (high, low) = (a - n * LN_2[0], n * LN_2[1]);
    let x = high - low;
    let z = x * x;
    let c = x - z * horner(z, P);
    times_power(1.0 - ((low - (x * c) / (2.0 - c)) - high), k)
}

#[inline(always)]
pub(super) fn expm1(a: f64) -> f64 {
    const Q: [f64; 6] = [
        1.0,
        -3.333_333_333_333_313_164_28e-2,
        1.587_301_587_254_814_601_65e-3,
        -7.936_507_578_674_879_424_73e-5,
        4.008_217_827_329_362_395_52e-6,
        -2.010_992_181_836_243_713_26e-7,
    ];
    let a = clamped(a, -40.0, 710.0);
    let (n, k) = whole(a * LOG2_E);
    let (high, low) = (a - n * LN_2[0], n * LN_2[1]);
    let x = high - low;
    let c = (high - x) - low;
    let half = 0.5 * x;
    let z = x * half;
    let r = horner(z, Q);
    let t = 3.0 - r * half;
    let e = z * ((r - t) / (6.0 - x * t));
    let e = (x * (e - c) - c) - z;
    // 2^k (1 - 2^-k + x - e); where 2^-k is beyond the digits any small number serves.
    let few = if n > 60.0 { 60 } else { k };
    let inverse = f64::from_bits(1023_u64.wrapping_sub(few) << 52);
    let value = times_power((1.0 - inverse) - (e - x), k);
    if a.abs() < 1e-300 { a } else { value }
}

/// A positive normal number as 2^k m with m from sqrt(1/2) to sqrt(2): k and m.
#[inline(always)]
fn mantissa(a: f64) -> (f64, f64) {
    const ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const LARGE: u64 = 0x4330_0000_0000_0000;
    let bits = a.to_bits().wrapping_add(ONE - ROOT);
    let k = f64::from_bits(LARGE | (bits >> 52)) - (4_503_599_627_370_496.0 + 1023.0);
    (k, f64::from_bits((bits & 0x000f_ffff_ffff_ffff).wrapping_add(ROOT)))
}

/// k ln 2 + ln(1 + f + c) for small c.
#[inline(always)]
fn ln_sum(k: f64, f: f64, c: f64) -> f64 {
    const L: [f64; 7] = [
        6.666_666_666_666_735_130e-1,
        3.999_999_999_940_941_908e-1,
        2.857_142_874_366_239_149e-1,
        2.222_219_843_214_978_396e-1,
        1.818_357_216_161_805_012e-1,
        1.531_383_769_920_937_332e-1,
        1.479_819_860_511_658_591e-1,
    ];
    let s = f / (2.0 + f);
    let z = s * s;
    let r = z * horner(z, L);
    let half = 0.5 * f * f;
    k * LN_2[0] - ((half - (s * (half + r) + (k * LN_2[1] + c))) - f)
}

#[inline(always)]
pub(super) fn ln(a: f64) -> f64 {
    const TINY: f64 = 2.225_073_858_507_201_4e-308;
    const UP: f64 = 18_014_398_509_481_984.0;
    let (scaled, less) = if a < TINY { (a * UP, 54.0) } else { (a, 0.0) };
    let (k, m) = mantissa(scaled);
    let value = ln_sum(k - less, m - 1.0, 0.0);
    let value = if a < f64::INFINITY { value } else { a };
    let value = if a == 0.0 { f64::NEG_INFINITY } else { value };
    if a < 0.0 { f64::NAN } else { value }
}

#[inline(always)]
pub(super) fn log1p(a: f64) -> f64 {
    let sum = 1.0 + a;
    let (k, m) = mantissa(sum);
    // What rounding took from 1 + a.
    let lost = if k >= 2.0 { 1.0 - (sum - a) } else { a - (sum - 1.0) };
    let near = a > -0.2928 && a < 0.4142;
    let (f, c) = if near { (a, 0.0) } else { (m - 1.0, lost / sum) };
    let value = ln_sum(k, f, c);
    let value = if a < f64::INFINITY { value } else { a };
    let value = if sum == 0.0 { f64::NEG_INFINITY } else { value };
    let value = if a.abs() < 1e-300 { a } else { value };
    if a < -1.0 { f64::NAN } else { value }
}

/// atan(c) in two parts for the centre c of each range.
const CENTRES: [[f64; 2]; 4] = [
    [4.636_476_090_008_061_165_15e-1, 2.269_877_745_296_168_709_24e-17],
    [FRAC_PI_4, 3.061_616_997_868_383_017_93e-17],
    [9.827_937_232_473_290_540_82e-1, 1.390_331_103_123_099_845_16e-17],
    [FRAC_PI_2, 6.123_233_995_736_766_035_87e-17],
];

/// The angle of (x, y), in (-pi, pi].
#[inline(always)]
pub(super) fn atan2(y: f64, x: f64) -> f64 {
    const T: [f64; 11] = [
        3.333_333_333_333_293_180_27e-1,
        -1.999_999_999_987_648_324_76e-1,
        1.428_571_427_250_346_637_11e-1,
        -1.111_111_040_546_235_578_80e-1,
        9.090_887_133_436_506_561_96e-2,
        -7.691_876_205_044_829_994_95e-2,
        6.661_073_137_387_531_206_69e-2,
        -5.833_570_133_790_573_486_45e-2,
        4.976_877_994_615_932_360_17e-2,
        -3.653_157_274_421_691_552_70e-2,
        1.628_582_011_536_578_236_23e-2,
    ];
    let [a, b] = proportional(y.abs(), x.abs());
    // tan(angle - atan c) = (a - c b) / (b + c a), with one division whichever the centre.
    let range = |c: f64, [high, low]: [f64; 2]| (a - c * b, b + c * a, high, low);
    let chosen = (a, b, 0.0, 0.0);
    let chosen = if a < 0.4375 * b { chosen } else { range(0.5, CENTRES[0]) };
    let chosen = if a < 0.6875 * b { chosen } else { range(1.0, CENTRES[1]) };
    let chosen = if a < 1.1875 * b { chosen } else { range(1.5, CENTRES[2]) };
    let chosen = if a < 2.4375 * b { chosen } else { (-b, a, CENTRES[3][0], CENTRES[3][1]) };
    let (numerator, denominator, high, low) = chosen;
    let t = numerator / denominator;
    let z = t * t;
    let angle = high - ((t * (z * horner(z, T)) - low) - t);
    let angle = if a + b == 0.0 { 0.0 } else { angle };
    let angle = if x.is_sign_negative() { PI - (angle - 2.0 * CENTRES[3][1]) } else { angle };
    angle.copysign(y)
}

/// Two sizes, made so that sums of them neither overflow nor lose digits; equal where both are infinite.
#[inline(always)]
fn proportional(a: f64, b: f64) -> [f64; 2] {
    const LARGE: f64 = 1e300;
    const SMALL: f64 = 1e-290;
    let largest = if a > b { a } else { b };
    let factor = if largest > LARGE { 2f64.powi(-60) } else { 1.0 };
    let factor = if largest < SMALL { 2f64.powi(60) } else { factor };
    let both = a == f64::INFINITY && b == f64::INFINITY;
    if both { [1.0, 1.0] } else { [a * factor, b * factor] }
}
