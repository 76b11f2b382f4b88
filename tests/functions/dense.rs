//! Many arguments against the crate `libm`, whose errors are below 1 ulp in f64: f64 lanes are within 1 ulp of it.

use kfgpu::tape::lanes::Lane;
use kfgpu::tape::{Binary, Unary};

const COUNT: u32 = 20_000;

type Case = (Unary, fn(f64) -> f64, [f64; 2], [f64; 2]);

/// Operation, oracle, range, and most ulp of the oracle in f64 and f32.
const CASES: [Case; 12] = [
    (Unary::Sin, libm::sin, [-10.0, 10.0], [1.0, 1.6]),
    (Unary::Sin, libm::sin, [-1.1e5, 1.1e5], [1.0, 1.6]),
    (Unary::Cos, libm::cos, [-10.0, 10.0], [1.0, 1.6]),
    (Unary::Cos, libm::cos, [-1.1e5, 1.1e5], [1.0, 1.6]),
    (Unary::Exp, libm::exp, [-87.0, 88.0], [1.0, 1.0]),
    (Unary::Expm1, libm::expm1, [-1.0, 1.0], [1.0, 1.6]),
    (Unary::Expm1, libm::expm1, [-40.0, 88.0], [1.0, 1.6]),
    (Unary::Ln, libm::log, [0.5, 1.5], [1.0, 0.9]),
    (Unary::Ln, libm::log, [1e-3, 1e6], [1.0, 0.9]),
    (Unary::Log1p, libm::log1p, [-0.99, 1.0], [1.0, 0.9]),
    (Unary::Log1p, libm::log1p, [0.0, 1e6], [1.0, 0.9]),
    (Unary::Sqrt, libm::sqrt, [0.0, 1e6], [0.0, 0.51]),
];

/// Worst difference from the oracle, in units in the last place of the format.
fn worst<T: Lane>(
    on_lanes: impl Fn(&mut [T]),
    oracle: impl Fn(f64) -> f64,
    [low, high]: [f64; 2],
    epsilon: f64,
) -> f64 {
    let at = |i| T::from_f64(low + (high - low) * (f64::from(i) + 0.37) / f64::from(COUNT));
    let arguments: Vec<T> = (0..COUNT).map(at).collect();
    let mut found = arguments.clone();
    on_lanes(&mut found);
    let ulp = |(a, found): (&T, &T)| {
        let exact = oracle(a.to_f64());
        (found.to_f64() - exact).abs() / (epsilon * exact.abs().log2().floor().exp2())
    };
    arguments.iter().zip(&found).map(ulp).fold(0.0, |worst, ulp| if ulp <= worst { worst } else { ulp })
}

#[test]
fn lanes_follow_libm() {
    let mut wrong = Vec::new();
    let mut check = |what: String, found: f64, limit: f64| {
        println!("{what}: {found:.2} ulp");
        if found > limit || found.is_nan() {
            wrong.push(format!("{what}: {found:.2} ulp, at most {limit}"));
        }
    };
    for (op, oracle, range, [double, single]) in CASES {
        let found = worst::<f64>(|lanes| f64::unary(op, lanes), oracle, range, f64::EPSILON);
        check(format!("{op:?} on {range:?} in f64"), found, double);
        let found = worst::<f32>(|lanes| f32::unary(op, lanes), oracle, range, f64::from(f32::EPSILON));
        check(format!("{op:?} on {range:?} in f32"), found, single);
    }
    for x in [-2.5, -0.125, 0.125, 1.0, 40.0] {
        let range = [-30.0, 30.0];
        let others = |lanes: usize| vec![x; lanes];
        let double = |lanes: &mut [f64]| f64::binary(Binary::Atan2, lanes, &others(lanes.len()));
        check(format!("atan2(y, {x}) in f64"), worst(double, |y| libm::atan2(y, x), range, f64::EPSILON), 2.0);
        let single = |lanes: &mut [f32]| f32::binary(Binary::Atan2, lanes, &vec![x as f32; lanes.len()]);
        let found = worst(single, |y| libm::atan2(y, x), range, f64::from(f32::EPSILON));
        check(format!("atan2(y, {x}) in f32"), found, 3.0);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
