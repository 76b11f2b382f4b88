//! The report a person reads.

use std::fmt;

use super::{Bound, Gain, Named, Scored, TextTable, Tuning, count, seconds, significant};

/// Digits of parameters and objectives.
const DIGITS: usize = 8;

impl fmt::Display for Tuning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.heading())?;
        writeln!(f, "{}\n", self.effort())?;
        writeln!(f, "{}", self.parameter_table())?;
        writeln!(f, "{}", self.objective_table())?;
        let gain = match self.matrices.gain {
            Gain::Steady => "steady gain",
            Gain::Last => "gain of the last complete measurement",
        };
        writeln!(f, "Tuned filter (dt = {} s; K: {gain}):\n{}", significant(self.matrices.dt, 6), self.matrices)?;
        writeln!(f, "{}", self.consistency)?;
        writeln!(f, "{}", self.certificate_line())?;
        if let Some(line) = self.polish_line() {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

impl Tuning {
    fn heading(&self) -> String {
        let log = &self.log;
        let trajectories = if log.trajectories == 1 { String::new() } else { format!(" in {} trajectories", log.trajectories) };
        format!("{}: {}, {} rows{trajectories}", self.problem, log.source, log.rows)
    }

    fn effort(&self) -> String {
        let device = &self.device;
        format!(
            "{}, seed {}: {} evaluations in {} generations and {} on the {} ({}, {}); stopped: {}",
            self.algorithm,
            self.seed,
            count(self.evaluations),
            count(self.generations as u64),
            seconds(self.wall_s),
            device.backend,
            device.adapter,
            device.precision,
            self.stop.replace('_', " "),
        )
    }

    fn parameter_table(&self) -> TextTable {
        let mut table = TextTable::new(["parameter", "unit", "baseline", "tuned", "note"]);
        for (name, tuned) in self.parameters.iter() {
            let note = match self.at_bound.get(name) {
                None => "",
                Some(Bound::Lower) => "at its lower bound",
                Some(Bound::Upper) => "at its upper bound",
            };
            let unit = self.units.get(name).cloned().flatten().unwrap_or_default();
            let baseline = self.baseline.parameters.get(name).map_or_else(String::new, |v| significant(*v, DIGITS));
            table.push([name.to_owned(), unit, baseline, significant(*tuned, DIGITS), note.to_owned()]);
        }
        table
    }

    fn objective_table(&self) -> TextTable {
        let mut table = TextTable::new(["objective, in-sample, f64", "baseline", "tuned", "raw measurements"]);
        for (name, tuned) in self.objectives.iter() {
            let baseline = self.baseline.objective(name);
            let raw = self.raw_measurements.get(name).map_or_else(String::new, |v| significant(*v, DIGITS));
            let cell = |value: Option<f64>| value.map_or_else(|| "failed".to_owned(), |v| significant(v, DIGITS));
            table.push([name.to_owned(), cell(baseline), significant(*tuned, DIGITS), raw]);
            if name == "nll" {
                let rows = self.log.measured_rows.max(1) as f64;
                let per_row = [cell(baseline.map(|v| v / rows)), significant(tuned / rows, DIGITS)];
                let [baseline, tuned] = per_row;
                table.push(["nll per measured row".to_owned(), baseline, tuned, String::new()]);
            }
        }
        table
    }

    fn certificate_line(&self) -> String {
        let certificate = &self.certificate;
        let order = if certificate.order_held { "kept their order" } else { "changed their order" };
        format!(
            "Certificate: the f64 reference differs from the search by at most {} (relative), and the {} best candidates \
             {order}.",
            significant(certificate.largest_relative_gap, 2),
            certificate.candidates,
        )
    }

    fn polish_line(&self) -> Option<String> {
        let polish = self.polish.as_ref()?;
        let (name, _) = self.objectives.iter().next()?;
        Some(format!(
            "Polish: {} f64 evaluations took {name} from {} to {}.",
            count(polish.evaluations),
            significant(polish.before, DIGITS + 2),
            significant(polish.after, DIGITS + 2),
        ))
    }
}

impl Scored {
    fn objective(&self, name: &str) -> Option<f64> {
        self.objectives.as_ref().and_then(|objectives: &Named<f64>| objectives.get(name).copied())
    }
}
