//! Tests of log reading and writing: good input, every kind of bad input, arbitrary input.

mod errors;
mod properties;
mod reading;
mod sensors;
mod summary;

use super::{Log, LogError};
use crate::data::DataSpec;

/// `[data]` with measurements and perhaps a time column.
fn spec(time: Option<&str>, measurements: &[&str]) -> DataSpec {
    DataSpec {
        file: Some("log.csv".to_owned()),
        time: time.map(str::to_owned),
        measurements: measurements.iter().map(|&m| m.to_owned()).collect(),
        ..DataSpec::default()
    }
}

fn read(spec: &DataSpec, text: impl AsRef<[u8]>) -> Result<Log, LogError> {
    Log::read(spec, text.as_ref(), "log.csv")
}

/// NaN as `None`, so that tables compare.
fn known(values: impl IntoIterator<Item = f64>) -> Vec<Option<f64>> {
    values.into_iter().map(|v| (!v.is_nan()).then_some(v)).collect()
}
