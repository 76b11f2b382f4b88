//! What the functions of formulas are worth on an adapter.

use crate::evaluate::gpu::{Functions, GpuError};
use crate::model::{Expr, ExprKind, Function, Span};
use crate::table::Table;
use serde::Serialize;

/// Arguments of a function.
const COUNT: u32 = 4096;

/// Worst errors of the functions on an adapter.
#[derive(Debug, Serialize)]
pub(super) struct Accuracy {
    adapter: String,
    functions: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    function: &'static str,
    /// Of the first operand; the second is 0.7.
    from: f32,
    to: f32,
    kfgpu: Errors,
    /// None where WGSL has no such function.
    adapter: Option<Errors>,
}

/// Over all arguments, against f64.
#[derive(Debug, Clone, Copy, Serialize)]
struct Errors {
    /// In units in the last place of f32.
    ulp: f64,
    /// Over max(1, |value|).
    absolute: f64,
}

/// Where a function is measured: where filters use it, and angles also where their reduction is strained.
const fn ranges(function: Function) -> &'static [[f32; 2]] {
    match function {
        Function::Sqrt | Function::Ln | Function::Log10 | Function::Lgamma => &[[1e-3, 1e3]],
        Function::Log1p => &[[-0.9, 100.0]],
        Function::Exp | Function::Expm1 => &[[-1.0, 1.0], [-80.0, 80.0]],
        Function::Asin | Function::Acos => &[[-1.0, 1.0]],
        Function::Sin | Function::Cos => &[[-8.0, 8.0], [-8e3, 8e3]],
        Function::Tan => &[[-1.5, 1.5]],
        _ => &[[-8.0, 8.0]],
    }
}

impl Accuracy {
    pub(super) fn measure(adapter: &str) -> Result<Self, GpuError> {
        let functions = Functions::open(Some(adapter))?;
        let rows = Function::ALL
            .iter()
            .flat_map(|(name, function)| ranges(*function).iter().map(|range| (*name, *function, *range)))
            .map(|(name, function, range)| row(&functions, name, function, range))
            .collect::<Result<_, _>>()?;
        Ok(Self { adapter: functions.adapter().name.clone(), functions: rows })
    }
}

fn row(functions: &Functions, name: &'static str, function: Function, [from, to]: [f32; 2]) -> Result<Row, GpuError> {
    #[expect(clippy::cast_possible_truncation, reason = "arguments are numbers of f32")]
    let at = |i: u32| (f64::from(from) + f64::from(to - from) * (f64::from(i) + 0.5) / f64::from(COUNT)) as f32;
    let operands: Vec<[f32; 2]> = (0..COUNT).map(|i| [at(i), 0.7]).collect();
    let exact: Vec<f64> = operands.iter().map(|operands| value(function, *operands)).collect();
    let found = functions.values(function, &operands)?;
    let adapter = found.own.map(|own| Errors::of(&own, &exact));
    Ok(Row { function: name, from, to, kfgpu: Errors::of(&found.ours, &exact), adapter })
}

/// In f64, as the reference evaluates it.
fn value(function: Function, operands: [f32; 2]) -> f64 {
    let arguments = operands[..function.arity()].iter().map(|v| Expr::number(f64::from(*v))).collect();
    Expr { kind: ExprKind::Call(function, arguments), span: Span::default() }.evaluate(&|_| f64::NAN)
}

impl Errors {
    fn of(found: &[f32], exact: &[f64]) -> Self {
        let none = Self { ulp: 0.0, absolute: 0.0 };
        found.iter().zip(exact).fold(none, |worst, (found, exact)| {
            let error = (f64::from(*found) - exact).abs();
            let error = if error.is_nan() { f64::INFINITY } else { error };
            let unit = f64::from(f32::EPSILON) * exact.abs().log2().floor().exp2();
            let ulp = if error > 0.0 && unit > 0.0 { error / unit } else { 0.0 };
            Self { ulp: worst.ulp.max(ulp), absolute: worst.absolute.max(error / exact.abs().max(1.0)) }
        })
    }

    /// Both, in the same few digits.
    fn cells(self) -> [String; 2] {
        [format!("{:.1}", self.ulp), format!("{:.0e}", self.absolute)]
    }
}

/// A table for each adapter.
pub(super) fn text(measured: &[Accuracy]) -> String {
    if measured.is_empty() {
        return "no adapter (tried Vulkan, Metal and DX12)\n".to_owned();
    }
    let table = |accuracy: &Accuracy| {
        let mut table = Table::of(["function", "from", "to", "ulp", "absolute", "its own: ulp", "absolute"]);
        for row in &accuracy.functions {
            let [ulp, absolute] = row.kfgpu.cells();
            let [own_ulp, own_absolute] = row.adapter.map(Errors::cells).unwrap_or_default();
            let [from, to] = [row.from, row.to].map(|end| end.to_string());
            table.push([row.function.to_owned(), from, to, ulp, absolute, own_ulp, own_absolute]);
        }
        format!(
            "{}: worst errors in f32, in units in the last place and over max(1, |value|)\n{table}",
            accuracy.adapter
        )
    };
    measured.iter().map(table).collect::<Vec<_>>().join("\n")
}
