//! Covariance matrices: a scalar, a diagonal, a table by name, a full matrix, or a factor.

use toml::de::DeValue;

use super::names::check_name;
use super::node::Node;
use super::parameters::Factor;
use crate::model::error::{Cause, Fault, nearest};
use crate::model::formula::{FormulaPlace, Names, Scope};
use crate::model::{Binary, Expr, ExprKind, Symbol};

/// Two literal entries that differ by less than this share are one number printed twice.
const ROUNDING: f64 = 1e-9;

/// What a covariance is of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes<'a> {
    /// State or measurement names, one per row.
    pub(super) labels: &'a [String],
    /// "state" or "measurement".
    pub(super) what: &'static str,
    /// Whether a variance may be left out, and is then 0 (Q only).
    pub(super) may_be_zero: bool,
}

/// `{ factor = "M", form = "square" }`, if that is what the value is.
pub(super) fn factor(node: &Node<'_>, matrix: &'static str, size: usize) -> Result<Option<Factor>, Fault> {
    let DeValue::Table(table) = node.value else { return Ok(None) };
    if !table.contains_key("factor") {
        return Ok(None);
    }
    let fields = node.table("a factor", &["factor", "form"])?;
    let name_node = fields.need("factor", "the name of its template in [parameters]")?;
    let name = name_node.name()?;
    check_name(&name, name_node.span)?;
    let form = fields.need("form", "\"square\" or \"lower\"")?;
    let lower = match form.string()? {
        "square" => false,
        "lower" => true,
        other => return Err(form.bad_value(format!("\"{other}\""), "\"square\" or \"lower\"")),
    };
    Ok(Some(Factor { matrix, name, lower, size, span: name_node.span }))
}

/// Reads a covariance as n x n row-major formulas, symmetric.
pub(super) fn read(node: &Node<'_>, axes: Axes<'_>, names: &Names, place: FormulaPlace) -> Result<Vec<Expr>, Fault> {
    let scope = Scope { names, place, key: &node.key };
    let n = axes.labels.len();
    if let Some(factor) = factor(node, "", n)? {
        return product(&factor, names);
    }
    match node.value {
        DeValue::Table(_) => by_name(node, axes, scope),
        DeValue::Array(entries) if entries.iter().any(|e| e.get_ref().is_array()) => full(node, n, scope),
        DeValue::Array(_) => {
            let entries = node.list("a list")?;
            if entries.len() != n {
                let expected = format!("{n}, one per {} ({})", axes.what, axes.labels.join(", "));
                return Err(node.wrong_count(entries.len(), expected));
            }
            diagonal(entries.iter().map(|e| e.formula(scope)).collect::<Result<_, _>>()?)
        }
        DeValue::String(_) | DeValue::Integer(_) | DeValue::Float(_) if n == 1 => Ok(vec![node.formula(scope)?]),
        _ => Err(node.wrong_type(&format!(
            "a list of {n} variances, a list of {n} lists, a table by {}, or a factor",
            axes.what
        ))),
    }
}

fn diagonal(variances: Vec<Expr>) -> Result<Vec<Expr>, Fault> {
    let n = variances.len();
    let mut matrix = vec![Expr::number(0.0); n * n];
    for (i, variance) in variances.into_iter().enumerate() {
        matrix[i * n + i] = variance;
    }
    Ok(matrix)
}

fn by_name(node: &Node<'_>, axes: Axes<'_>, scope: Scope<'_>) -> Result<Vec<Expr>, Fault> {
    let fields = node.table("a table", &[])?;
    let labels = axes.labels;
    for (name, span, _) in &fields.entries {
        if !labels.iter().any(|l| l == name) {
            let nearest = nearest(name, labels.iter().map(String::as_str));
            let (key, name) = (node.key.clone(), crate::words::shorten(name));
            return Err(Fault::new(
                *span,
                Cause::NoSuch { key, what: axes.what, name, nearest, known: labels.to_vec() },
            ));
        }
    }
    let missing: Vec<&str> = labels.iter().map(String::as_str).filter(|l| fields.get(l).is_none()).collect();
    if !axes.may_be_zero && !missing.is_empty() {
        let names = missing.iter().map(|l| format!("`{l}`")).collect::<Vec<_>>().join(", ");
        return Err(node.fault(Cause::NoVariance { key: node.key.clone(), names }));
    }
    let variance = |label: &String| fields.get(label).map_or(Ok(Expr::number(0.0)), |n| n.formula(scope));
    diagonal(labels.iter().map(variance).collect::<Result<_, _>>()?)
}

/// n rows of n entries, or of 1, 2, ..., n entries: the lower triangle.
fn full(node: &Node<'_>, n: usize, scope: Scope<'_>) -> Result<Vec<Expr>, Fault> {
    let rows = node.list("a list of lists")?;
    if rows.len() != n {
        return Err(node.wrong_count(rows.len(), format!("{n} rows")));
    }
    let rows: Vec<Vec<Node<'_>>> =
        rows.iter().map(|row| row.list("a list, as the other rows are")).collect::<Result<_, _>>()?;
    let triangular = rows.iter().enumerate().all(|(i, row)| row.len() == i + 1);
    let mut matrix = vec![Expr::number(0.0); n * n];
    for (i, row) in rows.iter().enumerate() {
        if row.len() != n && !triangular {
            let row_node = &node.list("a list of lists")?[i];
            return Err(row_node.wrong_count(row.len(), format!("{n}, one per column")));
        }
        for (j, entry) in row.iter().enumerate() {
            matrix[i * n + j] = entry.formula(scope)?;
        }
    }
    for row in 0..n {
        for column in 0..row {
            let (lower, upper) = (&matrix[row * n + column], &matrix[column * n + row]);
            let Some(entry) = agree(lower, upper) else {
                let (key, row, column, span) = (node.key.clone(), row + 1, column + 1, lower.span);
                return Err(Fault::new(span, Cause::NotSymmetric { key, row, column }));
            };
            (matrix[row * n + column], matrix[column * n + row]) = (entry.clone(), entry);
        }
    }
    Ok(matrix)
}

/// The entry that both triangles mean: the same formula, the one that is not 0, or the mean of two printed numbers.
fn agree(lower: &Expr, upper: &Expr) -> Option<Expr> {
    if lower.same(upper) || upper.is_zero() {
        return Some(lower.clone());
    }
    if lower.is_zero() {
        return Some(upper.clone());
    }
    let constant = |e: &Expr| (!e.mentions(|_| true)).then(|| e.evaluate(&|_| f64::NAN));
    let (a, b) = (constant(lower)?, constant(upper)?);
    let mean = Expr { kind: ExprKind::Number(0.5 * (a + b)), span: lower.span };
    ((a - b).abs() <= ROUNDING * a.abs().max(b.abs())).then_some(mean)
}

/// M M' with the elements of M as parameters.
fn product(factor: &Factor, names: &Names) -> Result<Vec<Expr>, Fault> {
    let n = factor.size;
    let element = |row: usize, column: usize| {
        let name = factor.element(row, column);
        let index = names.parameters.iter().position(|p| *p == name);
        index
            .map(|i| Expr::symbol(Symbol::Parameter(i)))
            .ok_or_else(|| Fault::invalid(factor.span, &factor.name, format!("the factor has no element `{name}`")))
    };
    let mut matrix = vec![Expr::number(0.0); n * n];
    for row in 0..n {
        for column in 0..=row {
            let inner = if factor.lower { column + 1 } else { n };
            let mut sum = Expr::binary(Binary::Multiply, element(row, 0)?, element(column, 0)?);
            for k in 1..inner {
                let term = Expr::binary(Binary::Multiply, element(row, k)?, element(column, k)?);
                sum = Expr::binary(Binary::Add, sum, term);
            }
            (matrix[row * n + column], matrix[column * n + row]) = (sum.clone(), sum);
        }
    }
    Ok(matrix)
}
