//! From [`Log`] to CSV.

use std::io::{self, Write};

use super::decimal::Decimal;
use super::{DataSpec, Log, Trajectory};

impl Log {
    /// Writes the log as CSV: trajectory, time, measurements, inputs and truth, under the names `spec` gives them.
    ///
    /// Where a column says which sensor a row is of, each has a row of its own; truth stands in the last of one time.
    ///
    /// Numbers are the shortest that read back to the same bits, missing values are empty cells. Where `spec` names no
    /// time but the log has other times than 0, 1, 2, ..., they go to a column `t`, several trajectories to a column
    /// `trajectory`; truth of a state without a column goes to `STATE_true`.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_csv(&self, spec: &DataSpec, out: impl Write) -> io::Result<()> {
        let trajectory = spec.trajectory.as_deref().or((self.trajectories.len() > 1).then_some("trajectory"));
        let time = spec.time.as_deref().or((!self.has_unit_steps() || spec.sensor.is_some()).then_some("t"));
        let layout = Layout::of(spec);
        let mut csv = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(out);
        let truth = self.truth.iter().map(|state| truth_column(spec, state));
        let header = trajectory.into_iter().chain(time).chain(spec.sensor.as_deref()).map(str::to_owned);
        let columns = layout.columns.iter().map(|column| (*column).to_owned());
        csv.write_record(header.chain(columns).chain(self.inputs.iter().cloned()).chain(truth))?;
        for t in &self.trajectories {
            for k in 0..t.len() {
                let id = trajectory.map(|_| t.id.clone());
                let at = time.map(|_| cell(in_unit_of_cells(t.time[k], spec)));
                let before: Vec<String> = id.into_iter().chain(at).collect();
                let parts = layout.parts(t.z.row(k));
                for (i, part) in parts.iter().enumerate() {
                    let inputs = t.u.row(k).iter().map(|value| cell(*value));
                    let truth =
                        t.truth.row(k).iter().map(|value| cell(if i + 1 < parts.len() { f64::NAN } else { *value }));
                    csv.write_record(before.iter().cloned().chain(part.iter().cloned()).chain(inputs).chain(truth))?;
                }
            }
        }
        csv.flush()
    }

    fn has_unit_steps(&self) -> bool {
        let is_unit =
            |t: &Trajectory| t.time.iter().enumerate().all(|(k, time)| time.to_bits() == (k as f64).to_bits());
        self.trajectories.iter().all(is_unit)
    }
}

/// A time as the numbers of its column count it: seconds may be written in fractions of one.
fn in_unit_of_cells(time: f64, spec: &DataSpec) -> f64 {
    match spec.time_unit.unwrap_or_default().decimals() {
        0 => time,
        decimals => Decimal::shortest(time).map_or(time, |time| time.shifted(decimals).to_f64()),
    }
}

fn truth_column(spec: &DataSpec, state: &str) -> String {
    let named = spec.truth.iter().find(|(s, _)| s == state);
    named.map_or_else(|| format!("{state}_true"), |(_, column)| column.clone())
}

/// How a row's measurements stand in the file.
struct Layout<'a> {
    spec: &'a DataSpec,
    /// Columns of measurements, each once.
    columns: Vec<&'a str>,
    /// The column of each measurement.
    of: Vec<usize>,
}

impl<'a> Layout<'a> {
    fn of(spec: &'a DataSpec) -> Self {
        let (mut columns, mut of): (Vec<&str>, Vec<usize>) = (Vec::new(), Vec::new());
        for column in spec.columns() {
            let known = columns.iter().position(|known| *known == column);
            of.push(known.unwrap_or(columns.len()));
            if known.is_none() {
                columns.push(column);
            }
        }
        Self { spec, columns, of }
    }

    /// The cells of label and measurements, a list a row: one for each sensor with a label that measured something, and at
    /// least one, which has all that needs no label.
    fn parts(&self, z: &[f64]) -> Vec<Vec<String>> {
        let sensors = || self.spec.sensors.iter().zip(self.spec.sensor_ranges());
        let mut parts: Vec<(&str, Vec<usize>)> = Vec::new();
        for (sensor, range) in sensors() {
            if let Some(when) = sensor.when.as_deref().filter(|_| z[range.clone()].iter().any(|z| !z.is_nan())) {
                parts.push((when, range.collect()));
            }
        }
        if parts.is_empty() {
            parts.push(("", Vec::new()));
        }
        if self.spec.sensors.is_empty() {
            parts[0].1.extend(0..z.len());
        }
        parts[0].1.extend(sensors().filter(|(sensor, _)| sensor.when.is_none()).flat_map(|(_, range)| range));
        let row = |(label, own): (&str, Vec<usize>)| {
            let mut cells = vec![String::new(); self.columns.len()];
            own.into_iter().for_each(|i| cells[self.of[i]] = cell(z[i]));
            self.spec.sensor.iter().map(|_| label.to_owned()).chain(cells).collect()
        };
        parts.into_iter().map(row).collect()
    }
}

fn cell(value: f64) -> String {
    if value.is_nan() { String::new() } else { value.to_string() }
}
