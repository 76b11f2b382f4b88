//! `values.csv`, and errors against it.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// A value with its arguments and derivatives; what a function has not is NaN.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) high: f64,
    pub(crate) low: f64,
    pub(crate) slopes: [f64; 2],
}

impl Row {
    /// Whether f32 has the arguments.
    pub(crate) fn is_single(&self) -> bool {
        [self.a, self.b].iter().all(|v| v.is_nan() || f64::from(*v as f32).to_bits() == v.to_bits())
    }

    pub(crate) const fn value(&self) -> f64 {
        self.high
    }
}

/// Rows by function.
pub(crate) fn rows() -> BTreeMap<String, Vec<Row>> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/functions/values.csv");
    let mut rows: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    for record in csv::Reader::from_path(path).unwrap().records() {
        let record = record.unwrap();
        let number = |i: usize| record[i].parse().unwrap_or(f64::NAN);
        let row = Row { a: number(1), b: number(2), high: number(3), low: number(4), slopes: [number(5), number(6)] };
        rows.entry(record[0].to_owned()).or_default().push(row);
    }
    rows
}

/// Worst errors over rows: in units in the last place of the format (where the value is not 0), and over max(1, |value|).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Errors {
    pub(crate) ulp: f64,
    pub(crate) absolute: f64,
}

/// `epsilon` is the unit in the last place of 1.
pub(crate) fn errors(rows: &[Row], found: &[f64], epsilon: f64) -> Errors {
    let mut worst = Errors { ulp: 0.0, absolute: 0.0 };
    for (row, found) in rows.iter().zip(found) {
        let error = ((found - row.high) - row.low).abs();
        let error = if error.is_nan() { f64::INFINITY } else { error };
        let unit = epsilon * row.high.abs().log2().floor().exp2();
        let ulp = if error > 0.0 && unit > 0.0 { error / unit } else { 0.0 };
        worst = Errors { ulp: worst.ulp.max(ulp), absolute: worst.absolute.max(error / row.high.abs().max(1.0)) };
    }
    worst
}
