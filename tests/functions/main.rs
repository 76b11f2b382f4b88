//! Functions of formulas on lanes and on the graph against 100-digit values (`values.csv`, written by `values.py`): errors in
//! units in the last place and absolutely, held by `budget.csv`; derivatives.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the table of errors is a result")]
#![allow(clippy::cast_possible_truncation, reason = "f32 is one of the formats")]

mod budget;
mod dense;
mod table;

use kfgpu::model::Function;
use kfgpu::tape::lanes::{Lane, Register, run_apart};
use kfgpu::tape::{Calculator, Graph, Id, Leaf, Output, Tape};
use table::{Row, rows};

const LEAVES: [Leaf; 2] = [Leaf::Variable(0), Leaf::Variable(1)];
const LANES: usize = 16;

/// A function of two leaves, and its derivatives in them.
fn graph(name: &str) -> (Graph, [Id; 2], Vec<Id>) {
    let mut g = Graph::default();
    let leaves = LEAVES.map(|leaf| g.leaf(leaf));
    let value = match Function::ALL.iter().find(|(known, _)| *known == name) {
        Some((_, function)) => g.call(*function, &leaves[..function.arity()]),
        None => g.pow(leaves[0], leaves[1]),
    };
    let slopes = LEAVES.map(|leaf| g.differentiate(value, leaf));
    (g, leaves, vec![value, slopes[0], slopes[1]])
}

/// Value and derivatives of every row in f64, from the graph.
fn calculated(name: &str, rows: &[Row]) -> Vec<Vec<f64>> {
    let (g, _, outputs) = graph(name);
    let mut calculator = Calculator::new(&g, &outputs);
    rows.iter().map(|row| calculator.evaluate(|leaf| if leaf == LEAVES[0] { row.a } else { row.b }).collect()).collect()
}

/// Values of every row on lanes.
fn on_lanes<T: Lane>(name: &str, rows: &[Row]) -> Vec<f64> {
    let (g, leaves, outputs) = graph(name);
    let tape = Tape::new(&g, &leaves, &[Output { id: outputs[0], register: 2 }]).unwrap();
    let scalars: Vec<T> = Calculator::new(&g, &tape.scalars).evaluate(|_| f64::NAN).map(T::from_f64).collect();
    let block = |rows: &[Row]| {
        let mut registers = vec![Register::<T, LANES, 1>::splat(T::ONE); tape.registers.max(3)];
        for (lane, row) in rows.iter().enumerate() {
            registers[0].lanes_mut()[lane] = T::from_f64(row.a);
            registers[1].lanes_mut()[lane] = T::from_f64(row.b);
        }
        run_apart(&tape.operations, &mut registers, &scalars);
        registers[2].lanes()[..rows.len()].iter().map(|value| value.to_f64()).collect::<Vec<f64>>()
    };
    rows.chunks(LANES).flat_map(block).collect()
}

fn in_single(rows: &[Row]) -> Vec<Row> {
    rows.iter().filter(|row| row.is_single()).copied().collect()
}

#[test]
fn every_function_has_values() {
    let rows = rows();
    for (name, function) in Function::ALL {
        assert!(rows.get(name).is_some_and(|rows| rows.len() >= 10), "{name} has no values in values.csv");
        assert!(rows[name].iter().all(|row| row.b.is_nan() == (function.arity() == 1)), "{name}: wrong operands");
    }
}

#[test]
fn lanes_are_as_exact_as_recorded() {
    let mut measured = Vec::new();
    for (name, rows) in rows() {
        let single = in_single(&rows);
        measured.push((name.clone(), "f64", table::errors(&rows, &on_lanes::<f64>(&name, &rows), f64::EPSILON)));
        let found = on_lanes::<f32>(&name, &single);
        measured.push((name, "f32", table::errors(&single, &found, f64::from(f32::EPSILON))));
    }
    let wrong = budget::compare(&["f64", "f32"], &measured);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Constants are folded and prologues computed with the bits of the lanes.
#[test]
fn graph_and_lanes_have_the_same_bits() {
    for (name, rows) in rows() {
        let lanes = on_lanes::<f64>(&name, &rows);
        for ((row, lane), value) in rows.iter().zip(lanes).zip(calculated(&name, &rows)) {
            assert_eq!(lane.to_bits(), value[0].to_bits(), "{name}({}, {}): {lane} and {}", row.a, row.b, value[0]);
        }
    }
}

#[test]
fn derivatives_are_exact_to_1e_12() {
    let mut wrong = Vec::new();
    for (name, rows) in rows() {
        for (row, found) in rows.iter().zip(calculated(&name, &rows)) {
            for (found, exact) in found[1..].iter().zip(row.slopes) {
                let within = (found - exact).abs() <= 1e-12 * exact.abs().max(1e-3);
                if exact.is_finite() && !within {
                    wrong.push(format!("{name}({}, {}): {found:e}, exactly {exact:e}", row.a, row.b));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What the reference judges by is computed by other means.
#[test]
fn the_reference_has_the_same_values() {
    use kfgpu::model::{Expr, ExprKind};
    let rows = rows();
    for (name, function) in Function::ALL {
        for row in &rows[name] {
            let arguments = [row.a, row.b][..function.arity()].iter().map(|v| Expr::number(*v)).collect();
            let expr = Expr { kind: ExprKind::Call(function, arguments), span: Default::default() };
            let (found, exact) = (expr.evaluate(&|_| f64::NAN), row.value());
            assert!((found - exact).abs() <= 1e-14 * exact.abs().max(1.0), "{name}({}): {found}, {exact}", row.a);
        }
    }
}
