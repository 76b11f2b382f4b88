//! From [`Log`] to CSV.

use std::io::{self, Write};

use super::decimal::Decimal;
use super::{DataSpec, Log, Trajectory};

impl Log {
    /// Writes the log as CSV: trajectory, time, measurements, inputs and truth, under the names `spec` gives them.
    ///
    /// Numbers are the shortest that read back to the same bits, missing values are empty cells. Where `spec` names no
    /// time but the log has other times than 0, 1, 2, ..., they go to a column `t`, several trajectories to a column
    /// `trajectory`; truth of a state without a column goes to `STATE_true`.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_csv(&self, spec: &DataSpec, out: impl Write) -> io::Result<()> {
        let trajectory = spec.trajectory.as_deref().or((self.trajectories.len() > 1).then_some("trajectory"));
        let time = spec.time.as_deref().or((!self.has_unit_steps()).then_some("t"));
        let mut csv = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(out);
        let truth = self.truth.iter().map(|state| truth_column(spec, state));
        let header = trajectory.into_iter().chain(time).map(str::to_owned);
        csv.write_record(header.chain(self.measurements.iter().chain(&self.inputs).cloned()).chain(truth))?;
        for t in &self.trajectories {
            for k in 0..t.len() {
                let id = trajectory.map(|_| t.id.clone());
                let at = time.map(|_| cell(in_unit_of_cells(t.time[k], spec)));
                csv.write_record(id.into_iter().chain(at).chain(values(t, k)))?;
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

fn values(t: &Trajectory, k: usize) -> impl Iterator<Item = String> {
    t.z.row(k).iter().chain(t.u.row(k)).chain(t.truth.row(k)).map(|&value| cell(value))
}

fn cell(value: f64) -> String {
    if value.is_nan() { String::new() } else { value.to_string() }
}
