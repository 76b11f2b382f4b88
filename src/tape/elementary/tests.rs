//! Loops over lanes run with the widest vectors of this machine; the functions called here one by one are compiled for the
//! baseline.

use super::{double, single};

type Double = (&'static str, fn(&mut [f64]), fn(f64) -> f64, [f64; 2]);
type Single = (&'static str, fn(&mut [f32]), fn(f32) -> f32, [f32; 2]);

const COUNT: usize = 4001;

#[test]
fn every_instruction_set_has_the_same_bits() {
    let doubles: [Double; 7] = [
        ("sin", double::lanes::sin, double::sin, [-1e5, 1e5]),
        ("cos", double::lanes::cos, double::cos, [-30.0, 30.0]),
        ("wrap", double::lanes::wrap, double::wrap, [-1e5, 1e5]),
        ("exp", double::lanes::exp, double::exp, [-760.0, 720.0]),
        ("expm1", double::lanes::expm1, double::expm1, [-50.0, 720.0]),
        ("ln", double::lanes::ln, double::ln, [-1.0, 50.0]),
        ("log1p", double::lanes::log1p, double::log1p, [-1.5, 3.0]),
    ];
    for (name, lanes, one, [low, high]) in doubles {
        let a: Vec<f64> = (0..COUNT).map(|i| low + (high - low) * i as f64 / COUNT as f64).collect();
        let mut found = a.clone();
        lanes(&mut found);
        for (a, found) in a.iter().zip(found) {
            let alone = one(*a);
            assert!(
                found.to_bits() == alone.to_bits() || found.is_nan() && alone.is_nan(),
                "{name}({a}): {found}, {alone}"
            );
        }
    }
    let singles: [Single; 7] = [
        ("sin", single::lanes::sin, single::sin, [-1e5, 1e5]),
        ("cos", single::lanes::cos, single::cos, [-30.0, 30.0]),
        ("wrap", single::lanes::wrap, single::wrap, [-1e5, 1e5]),
        ("exp", single::lanes::exp, single::exp, [-110.0, 95.0]),
        ("expm1", single::lanes::expm1, single::expm1, [-50.0, 95.0]),
        ("ln", single::lanes::ln, single::ln, [-1.0, 50.0]),
        ("log1p", single::lanes::log1p, single::log1p, [-1.5, 3.0]),
    ];
    for (name, lanes, one, [low, high]) in singles {
        let a: Vec<f32> = (0..COUNT).map(|i| low + (high - low) * i as f32 / COUNT as f32).collect();
        let mut found = a.clone();
        lanes(&mut found);
        for (a, found) in a.iter().zip(found) {
            let alone = one(*a);
            assert!(
                found.to_bits() == alone.to_bits() || found.is_nan() && alone.is_nan(),
                "{name}({a}): {found}, {alone}"
            );
        }
    }
}

#[test]
fn functions_of_two_have_the_same_bits_too() {
    let angle = |i: usize| ((i * 37 % COUNT) as f64 - 2000.0, (i * 91 % COUNT) as f64 - 2000.0);
    let (y, x): (Vec<f64>, Vec<f64>) = (0..COUNT).map(angle).unzip();
    let mut found = y.clone();
    double::lanes::atan2(&mut found, &x);
    for (k, found) in found.iter().enumerate() {
        assert_eq!(found.to_bits(), double::atan2(y[k], x[k]).to_bits(), "atan2({}, {})", y[k], x[k]);
    }
    let [y, x] = [y, x].map(|values| values.iter().map(|v| *v as f32 / 300.0).collect::<Vec<f32>>());
    let (mut angles, mut powers) = (y.clone(), y.clone());
    single::lanes::atan2(&mut angles, &x);
    single::lanes::power(&mut powers, &x);
    for k in 0..COUNT {
        assert_eq!(angles[k].to_bits(), single::atan2(y[k], x[k]).to_bits(), "atan2({}, {})", y[k], x[k]);
        let alone = single::power(y[k], x[k]);
        let same = powers[k].to_bits() == alone.to_bits() || powers[k].is_nan() && alone.is_nan();
        assert!(same, "{} ^ {}: {}, {alone}", y[k], x[k], powers[k]);
    }
}

/// Zeros, infinities and NaN as IEEE 754 recommends.
#[test]
fn values_at_the_edges() {
    const INFINITY: f64 = f64::INFINITY;
    let one = |f: fn(f64) -> f64, a: f64| f(a);
    let edges = [
        (one(double::exp, -INFINITY), 0.0),
        (one(double::exp, INFINITY), INFINITY),
        (one(double::exp, 0.0), 1.0),
        (one(double::expm1, -INFINITY), -1.0),
        (one(double::ln, 0.0), -INFINITY),
        (one(double::ln, INFINITY), INFINITY),
        (one(double::ln, 1.0), 0.0),
        (one(double::log1p, -1.0), -INFINITY),
        (double::atan2(0.0, 0.0), 0.0),
        (double::atan2(0.0, -1.0), std::f64::consts::PI),
        (double::atan2(INFINITY, INFINITY), std::f64::consts::FRAC_PI_4),
        (double::atan2(-INFINITY, 1.0), -std::f64::consts::FRAC_PI_2),
        (double::wrap(std::f64::consts::PI), -std::f64::consts::PI),
    ];
    for (k, (found, expected)) in edges.into_iter().enumerate() {
        assert_eq!(found.to_bits(), expected.to_bits(), "edge {k}: {found}, not {expected}");
    }
    for missing in [
        double::ln(-1.0),
        double::log1p(-2.0),
        double::sin(f64::NAN),
        double::exp(f64::NAN),
        double::atan2(0.0, f64::NAN),
    ] {
        assert!(missing.is_nan(), "{missing} is not NaN");
    }
    assert!(single::ln(-1.0).is_nan() && single::power(-2.0, 0.5).is_nan(), "f32");
    assert!(
        (single::power(-2.0, 3.0) + 8.0).abs() < 1e-6 && (single::power(0.0, 0.0) - 1.0).abs() < 1e-6,
        "f32 powers"
    );
}
