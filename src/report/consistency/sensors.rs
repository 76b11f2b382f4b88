//! NIS sensor by sensor, where a problem has several.

use serde::Serialize;

use super::band::Band;
use super::rows::{Sum, number};
use crate::data::DataSpec;
use crate::number::short;
use crate::reference::Update;
use std::fmt;
use std::ops::Range;

/// The NIS of one sensor's innovations, by their own block of S. It informs and does not decide: the tests look at all rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorNis {
    /// The sensor.
    pub name: String,
    /// Rows that it updated the filter in.
    pub rows: usize,
    /// Sum of nu' S^-1 nu / number of components; NaN (JSON `null`) without any.
    pub nis_mean: f64,
    /// Lower end of its two-sided 95 % chi-square band.
    pub nis_low: f64,
    /// Upper end.
    pub nis_high: f64,
}

/// What sensors have measured so far.
#[derive(Debug, Clone)]
pub(super) struct Sensors(Vec<(String, Range<usize>, Sum, usize)>);

impl Sensors {
    pub(super) fn of(data: &DataSpec) -> Self {
        let ranges = data.sensor_ranges();
        let sensor = |(sensor, range): (&crate::data::SensorSpec, _)| (sensor.name.clone(), range, Sum::default(), 0);
        Self(data.sensors.iter().zip(ranges).map(sensor).collect())
    }

    pub(super) fn add(&mut self, update: &Update) {
        for (_, range, sum, rows) in &mut self.0 {
            let own: Vec<usize> = (0..update.present.len()).filter(|i| range.contains(&update.present[*i])).collect();
            if own.is_empty() {
                continue;
            }
            let nu = update.nu.select_rows(&own);
            let block = update.s.select_rows(&own).select_columns(&own);
            let nis = block.cholesky().map_or(f64::NAN, |factor| nu.dot(&factor.solve(&nu)));
            *sum = Sum { total: sum.total + nis, count: sum.count + own.len() };
            *rows += 1;
        }
    }

    pub(super) fn judge(&self) -> Vec<SensorNis> {
        let judge = |(name, _, sum, rows): &(String, _, Sum, usize)| {
            let band = Band::of(sum.total, number(sum.count));
            SensorNis { name: name.clone(), rows: *rows, nis_mean: band.mean, nis_low: band.low, nis_high: band.high }
        };
        self.0.iter().map(judge).collect()
    }
}

impl fmt::Display for SensorNis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, rows, nis_mean, nis_low, nis_high } = self;
        if *rows == 0 {
            return write!(f, "{name}: no row");
        }
        let (nis, unit) = (short(*nis_mean, 4), if *rows == 1 { "row" } else { "rows" });
        write!(f, "{name}: {rows} {unit}, NIS {nis} (95 % band {nis_low:.3}..{nis_high:.3})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::SensorSpec;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn every_sensor_has_its_own_nis() {
        let sensor = |name: &str, columns: &[&str]| SensorSpec {
            name: name.to_owned(),
            columns: columns.iter().map(|c| (*c).to_owned()).collect(),
            when: None,
        };
        let data = DataSpec { sensors: vec![sensor("a", &["x", "y"]), sensor("b", &["z"])], ..DataSpec::default() };
        let mut sensors = Sensors::of(&data);
        let update = |present: &[usize], nu: &[f64], s: &[f64]| Update {
            present: present.to_vec(),
            nu: DVector::from_column_slice(nu),
            s: DMatrix::from_row_slice(nu.len(), nu.len(), s),
            k: DMatrix::zeros(1, nu.len()),
            nis: f64::NAN,
            nll: f64::NAN,
            rejected: 0.0,
        };
        sensors.add(&update(&[1, 2], &[2.0, 3.0], &[4.0, 1.0, 1.0, 9.0]));
        sensors.add(&update(&[0, 1], &[1.0, 1.0], &[2.0, 1.0, 1.0, 2.0]));
        let [a, b] = &sensors.judge()[..] else { panic!("two sensors") };
        assert!((a.nis_mean - (1.0 + 2.0 / 3.0) / 3.0).abs() < 1e-15, "{a:?}");
        assert!((b.nis_mean - 1.0).abs() < 1e-15 && (a.rows, b.rows) == (2, 1), "{b:?}");
        assert!(b.to_string().starts_with("b: 1 row, NIS 1 (95 % band 0.001.."), "{b}");
    }
}
