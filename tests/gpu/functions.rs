//! Functions of formulas as kernels compute them, against the table of `tests/functions`.

use crate::table::{Errors, Row, errors, rows};
use crate::{adapter, budget};
use kfgpu::evaluate::gpu::Functions;
use kfgpu::model::Function;

/// Beyond this, a kernel promises nothing of a function of angles.
const FAR: f64 = 1e5;
const ANGLES: [Function; 6] =
    [Function::Sin, Function::Cos, Function::Tan, Function::Wrap, Function::Sinc, Function::Cosc];

#[test]
fn kernels_are_as_exact_as_recorded() {
    let Some(name) = adapter() else { return };
    let functions = Functions::open(Some(&name)).unwrap();
    let table = rows();
    let measure = |name: &str, function: Option<Function>| -> Errors {
        let reached = |row: &&Row| {
            row.is_single() && (row.a.abs() < FAR || !function.is_some_and(|function| ANGLES.contains(&function)))
        };
        let rows: Vec<Row> = table[name].iter().filter(reached).copied().collect();
        let operands: Vec<[f32; 2]> = rows.iter().map(|row| [row.a as f32, row.b as f32]).collect();
        let found = match function {
            Some(function) => functions.values(function, &operands).unwrap(),
            None => functions.powers(&operands).unwrap(),
        };
        errors(&rows, &found.ours.iter().map(|v| f64::from(*v)).collect::<Vec<f64>>(), f64::from(f32::EPSILON))
    };
    let all = Function::ALL.map(|(name, function)| (name, Some(function))).into_iter().chain([("power", None)]);
    let measured: Vec<_> = all.map(|(name, function)| (name.to_owned(), "wgsl", measure(name, function))).collect();
    let wrong = budget::compare(&["wgsl"], &measured);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What has no value is NaN, and what an angle beyond all reduction gives stays within bounds.
#[test]
fn functions_have_edges() {
    let Some(name) = adapter() else { return };
    let functions = Functions::open(Some(&name)).unwrap();
    let of = |function, a: f32, b: f32| functions.values(function, &[[a, b]]).unwrap().ours[0];
    assert!(of(Function::Ln, -1.0, 0.0).is_nan(), "ln of a negative number");
    assert!(of(Function::Ln, 0.0, 0.0).is_nan(), "ln 0");
    assert!(of(Function::Log1p, -2.0, 0.0).is_nan(), "log1p of a negative number");
    assert!(of(Function::Sin, 1e20, 0.0).abs() <= 1.0, "sin of an angle without digits");
    assert_eq!(of(Function::Atan2, 0.0, 0.0), 0.0, "atan2(0, 0)");
    assert_eq!(of(Function::Exp, -200.0, 0.0), 0.0, "underflow");
    let power = |a: f32, b: f32| functions.powers(&[[a, b]]).unwrap().ours[0];
    assert!((power(-2.0, 3.0) + 8.0).abs() < 1e-5 && power(-2.0, 0.5).is_nan(), "powers of a negative number");
    assert_eq!([power(0.0, 2.5), power(3.0, 0.0)], [0.0, 1.0], "0^2.5 and 3^0");
}

/// Where WGSL has the function too, the adapter is asked for it: the comparison of `devices --accuracy`.
#[test]
fn the_adapters_own_are_measured_beside() {
    let Some(name) = adapter() else { return };
    let functions = Functions::open(Some(&name)).unwrap();
    let operands: Vec<[f32; 2]> = (1..100).map(|i| [i as f32 / 100.0, 0.5]).collect();
    for (name, function) in Function::ALL {
        let found = functions.values(function, &operands).unwrap();
        let Some(own) = found.own else { continue };
        for ((ours, own), [a, b]) in found.ours.iter().zip(&own).zip(&operands) {
            assert!((ours - own).abs() < 0.01, "{name}({a}, {b}): {ours} and {own}");
        }
    }
}
