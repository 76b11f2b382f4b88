//! The report a person reads.

use std::fmt;

use super::validation::improvement_text;
use super::{Effort, Gain, Named, Scored, Tuning, Validation, constraint, count, seconds, short, significant};
use crate::evaluate::Device;
use crate::study::StopReason;
use crate::table::Table;
use crate::words::counted;

/// Digits of parameters and objectives.
const DIGITS: usize = 8;

impl fmt::Display for Tuning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.effort)?;
        writeln!(f, "{}", self.parameter_table())?;
        self.fmt_objectives(f)?;
        if !self.constraints.is_empty() {
            writeln!(f, "{}", constraint::table(&self.constraints, self.validation.as_ref()))?;
        }
        if let (Some(points), Some(summary)) = (&self.front, &self.front_summary) {
            writeln!(f, "{}", summary.text(points, self.validation.is_some()))?;
        }
        let unit = &self.effort.log.time_unit;
        let step =
            self.matrices.dt.map_or_else(|| "dt varies".to_owned(), |dt| format!("dt = {} {unit}", short(dt, 6)));
        let gain = if self.matrices.gain == Gain::Steady { "; K: steady gain" } else { "" };
        writeln!(f, "Tuned filter ({step}{gain}):\n{}", self.matrices)?;
        writeln!(f, "Consistency ({}): {}", self.consistency_on, self.consistency)?;
        writeln!(f, "{}", self.certificate_line())?;
        if let Some(line) = self.polish_line() {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { log, device, .. } = self;
        let rows = if log.rows == 1 { "row" } else { "rows" };
        write!(f, "{}: {}, {} {rows}", self.problem, log.source, count(log.rows as u64))?;
        if log.trajectories > 1 {
            write!(f, " in {} trajectories", log.trajectories)?;
        }
        let many = |number: u64, one: &str| format!("{} {one}{}", count(number), if number == 1 { "" } else { "s" });
        let (evaluations, generations) =
            (many(self.evaluations, "evaluation"), many(self.generations as u64, "generation"));
        write!(f, "\n{}, seed {}: {evaluations} in {generations}", self.algorithm, self.seed)?;
        let Device { backend, adapter, precision } = device;
        write!(f, ", {} on {backend} ({adapter}, {precision})", seconds(self.wall_s))?;
        write!(f, "\nstopped: {}", ended(self.stop))
    }
}

pub(super) const fn ended(stop: StopReason) -> &'static str {
    match stop {
        StopReason::Generations => "all generations are done",
        StopReason::Evaluations => "no more evaluations are allowed",
        StopReason::WallTime => "the time allowed is over",
        StopReason::Stall => "no gain for as many generations as allowed",
        StopReason::Target => "the target is reached",
        StopReason::Interrupted => "interrupted; this is the best so far",
    }
}

impl Tuning {
    fn parameter_table(&self) -> Table {
        let mut table = Table::of(["parameter", "unit", "baseline", "tuned", "note"]);
        for (name, tuned) in self.parameters.iter() {
            let bound = self.at_bound.get(name).map(|bound| format!("at its {bound} bound"));
            let truth = self.simulated_with.get(name).map(|truth| format!("simulated with {}", short(*truth, DIGITS)));
            let left = self.polish.as_ref().is_some_and(|polish| polish.left_at_start.iter().any(|left| left == name));
            let left = left.then(|| "undetermined, left at its start".to_owned());
            let note = [bound, left, truth].into_iter().flatten().collect::<Vec<_>>().join("; ");
            let unit = self.effort.units.get(name).cloned().flatten().unwrap_or_default();
            let baseline = self.effort.baseline.parameters.get(name).map_or_else(String::new, |v| short(*v, DIGITS));
            table.push([name.to_owned(), unit, baseline, short(*tuned, DIGITS), note]);
        }
        table
    }

    fn objective_table(&self) -> Table {
        let mut table = Table::of(["objective, in-sample, f64", "baseline", "tuned", "raw measurements"]);
        for (name, tuned) in self.objectives.iter() {
            let baseline = self.effort.baseline.objective(name);
            let raw = self.raw_measurements.get(name).map_or_else(String::new, |v| significant(*v, DIGITS));
            let cell = |value: Option<f64>| value.map_or_else(|| "failed".to_owned(), |v| significant(v, DIGITS));
            table.push([name.to_owned(), cell(baseline), significant(*tuned, DIGITS), raw]);
            if name == "nll" {
                let rows = self.measured_rows.max(1) as f64;
                let per_row = [cell(baseline.map(|v| v / rows)), significant(tuned / rows, DIGITS)];
                let [baseline, tuned] = per_row;
                table.push(["nll per measured row".to_owned(), baseline, tuned, String::new()]);
            }
        }
        table
    }

    fn fmt_objectives(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(validation) = &self.validation else { return writeln!(f, "{}", self.objective_table()) };
        writeln!(f, "Validation: {validation}.")?;
        writeln!(f, "{}", self.validation_table(validation))?;
        let gap = validation.overfit_gap.iter().map(|(name, gap)| format!("{name} {}", improvement_text(name, *gap)));
        let gap = gap.collect::<Vec<_>>().join("; ");
        writeln!(f, "{}", validation.sentence())?;
        writeln!(f, "Overfit gap (improvement on training rows less that on held-out rows): {gap}.\n")
    }

    /// Every objective on training and on held-out rows.
    fn validation_table(&self, validation: &Validation) -> Table {
        let mut table = Table::of(["objective, f64", "rows", "baseline", "tuned", "improvement", "raw measurements"]);
        let cell = |value: Option<f64>| value.map_or_else(|| "failed".to_owned(), |v| significant(v, DIGITS));
        let of = |named: &Option<Named<f64>>, name: &str| named.as_ref().and_then(|n| n.get(name).copied());
        let raw =
            |named: &Named<f64>, name: &str| named.get(name).map_or_else(String::new, |v| significant(*v, DIGITS));
        let better =
            |named: &Named<Option<f64>>, name: &str| improvement_text(name, named.get(name).copied().flatten());
        for (name, tuned) in self.objectives.iter() {
            table.push([
                name.to_owned(),
                "training".to_owned(),
                cell(self.effort.baseline.objective(name)),
                significant(*tuned, DIGITS),
                better(&validation.improvement_train, name),
                raw(&self.raw_measurements, name),
            ]);
            table.push([
                String::new(),
                "held out".to_owned(),
                cell(of(&validation.baseline, name)),
                cell(of(&validation.winner, name)),
                better(&validation.improvement_held_out, name),
                raw(&validation.raw_measurements, name),
            ]);
        }
        table
    }

    fn certificate_line(&self) -> String {
        let certificate = &self.certificate;
        let gap = significant(certificate.largest_relative_gap, 2);
        let (who, what) = match &self.front {
            None => (format!("the {} best candidates", certificate.candidates), "their order"),
            Some(_) => (format!("the {} candidates of its front", certificate.candidates), "their places"),
        };
        let kept = if certificate.order_held { "kept" } else { "changed" };
        format!(
            "Certificate: the f64 reference differs from the search by at most {gap} (relative), and {who} {kept} {what}.",
        )
    }

    fn polish_line(&self) -> Option<String> {
        let polish = self.polish.as_ref()?;
        let evaluations = count(polish.evaluations as u64);
        let moved = polish.before.iter().zip(polish.after.iter()).map(|((name, before), (_, after))| {
            format!("{name} from {} to {}", significant(*before, DIGITS + 2), significant(*after, DIGITS + 2))
        });
        let mut line = format!(
            "Polish: {evaluations} evaluations from {} took {}",
            counted(polish.starts, "start"),
            listed_words(&moved.collect::<Vec<_>>())
        );
        if self.front.is_some() {
            line += &format!(", and gave the front {}.", counted(polish.members, "member"));
            return Some(line);
        }
        let norm = self
            .gradient_norm
            .map(|norm| format!("{} standard errors from the optimum by its gradient", short(norm, 2)));
        line += &match (self.converged, norm, &polish.note) {
            (Some(true), Some(norm), _) => format!("; converged, {norm}."),
            (Some(true), None, _) => "; converged.".to_owned(),
            (_, _, Some(note)) => {
                format!("; {}: {note}.", if self.converged.is_some() { "not converged" } else { "convergence unknown" })
            }
            _ => ".".to_owned(),
        };
        Some(line)
    }
}

/// "a", "a and b", "a, b and c".
fn listed_words(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

impl Scored {
    fn objective(&self, name: &str) -> Option<f64> {
        self.objectives.as_ref().and_then(|objectives: &Named<f64>| objectives.get(name).copied())
    }
}
