//! What can only be checked with the log at hand.

use super::error::{Cause, Fault};
use super::read::locate;
use super::{First, Problem, ProblemError, Start, Symbol, definite, standstill};
use crate::data::{Log, Origin, TimeUnit, Trajectory};
use crate::objective::Kind;

impl Problem {
    /// Checks the problem against its log; returns warnings, one sentence each.
    ///
    /// # Errors
    /// If the log cannot serve this problem: no interval for `first = "predict"`, no measurement to start from, inputs or
    /// truth missing, or a process noise that is none at the log's intervals.
    pub fn check_log(&self, log: &Log) -> Result<Vec<String>, ProblemError> {
        let mut warnings = self.unused();
        warnings.extend(self.epoch_without_unit(log));
        self.check_intervals(log, &mut warnings)?;
        self.check_start(log)?;
        self.check_inputs(log)?;
        self.check_formulas_at_start(log)?;
        self.check_angles(log, &mut warnings)?;
        self.check_objectives(log, &mut warnings)?;
        Ok(warnings)
    }

    /// An error with the place of the value at `path` of the problem file.
    pub(crate) fn fault(&self, path: &[impl AsRef<str>], cause: impl Into<Box<Cause>>) -> ProblemError {
        Fault::new(locate(&self.text, path), cause).locate(&self.source, &self.text)
    }

    fn log_fault(&self, path: &[impl AsRef<str>], problem: String) -> ProblemError {
        self.fault(path, Cause::Log { problem })
    }

    /// Searched parameters that no formula uses.
    fn unused(&self) -> Vec<String> {
        let x0 = match &self.model.x0 {
            Start::Values(values) => &values[..],
            Start::Measurement => &[],
        };
        let mut used = vec![false; self.parameters.all.len()];
        let modes: Vec<Self> = self.modes.iter().map(|mode| self.of_mode(mode)).collect();
        let settings: Vec<_> = [self].into_iter().chain(&modes).flat_map(Self::settings).collect();
        let settings = settings.iter().map(|setting| setting.formula);
        let formulas = self.models().flat_map(|model| [&model.f[..], &model.h, &model.q, &model.r, &model.p0]);
        let formulas = formulas.chain([x0]).flatten().chain(self.modes.iter().filter_map(|mode| mode.allowed.as_ref()));
        for formula in formulas.chain(settings) {
            formula.symbols(&mut |symbol| {
                if let Symbol::Parameter(i) = symbol {
                    used[i] = true;
                }
            });
        }
        for (i, parameter) in self.parameters.all.iter().enumerate() {
            if let (true, super::Value::Tied(to)) = (used[i], &parameter.value) {
                used[*to] = true;
            }
        }
        let unused = self.parameters.all.iter().zip(used).filter(|(p, used)| !used && p.is_searched());
        unused.map(|(p, _)| format!("the searched parameter `{}` is used in no formula", p.name)).collect()
    }

    /// A warning where numbers of the time column have the size of epochs in fractions of a second.
    fn epoch_without_unit(&self, log: &Log) -> Option<String> {
        let column = self.data.time.as_ref().filter(|_| self.data.time_unit.is_none())?;
        let first = match &log.times.origin {
            Origin::Zero => *log.trajectories.first()?.time.first()?,
            Origin::Number(first) => first.parse().ok()?,
            Origin::Instant(_) | Origin::TimeOfDay(_) => return None,
        };
        let unit = TimeUnit::of_epoch(first).filter(|unit| unit.decimals() > 0)?;
        Some(format!(
            "the times of {} in column `{column}`, such as {first}, look like an epoch in {unit} and are taken as \
             seconds: give time_unit = \"{unit}\" in [data]",
            log.source,
            unit = unit.name()
        ))
    }

    fn check_intervals(&self, log: &Log, warnings: &mut Vec<String>) -> Result<(), ProblemError> {
        standstill::check(self, log).map_err(|(path, problem)| self.log_fault(&path, problem))?;
        let intervals = || log.trajectories.iter().flat_map(|t| (0..t.len()).filter_map(|k| t.dt(k)));
        let irregular = log.regular_dt().is_none() && intervals().next().is_some();
        let adapted = self.filter.facts().adapts == super::Adapts::ProcessNoise;
        if self.model.first == (First::Predict { dt: None }) && log.regular_dt().is_none() {
            let what = if irregular { "has irregular intervals" } else { "has no interval" };
            let problem = format!(
                "first = \"predict\" needs `first_dt`, the step before the first row, because {} {what}",
                log.source
            );
            return Err(self.log_fault(&["model", "first"], problem));
        }
        let without_dt = |model: &super::Model| !model.q.iter().any(|q| q.mentions(|s| s == Symbol::Dt));
        let noisy = |model: &super::Model| !model.q.iter().all(super::Expr::is_zero);
        if self.models().any(|model| !without_dt(model)) {
            let (low, high) =
                intervals().filter(|dt| *dt > 0.0).fold((f64::INFINITY, 0.0_f64), |(l, h), dt| (l.min(dt), h.max(dt)));
            for dt in [low, high].into_iter().filter(|dt| dt.is_finite() && *dt > 0.0) {
                definite::check_process_noise(self, dt).map_err(|(path, cause)| self.fault(&path, cause))?;
            }
        }
        if irregular && !adapted && self.models().any(|model| without_dt(model) && noisy(model)) {
            warnings.push(format!(
                "the intervals of {} differ, and Q has no dt in it: every step gets the same process noise",
                log.source
            ));
        }
        if irregular && adapted {
            warnings.push(format!(
                "the intervals of {} differ, and the {} filter adapts one Q that serves every step, long or short",
                log.source,
                self.filter.name()
            ));
        }
        Ok(())
    }

    /// x0 = "measurement" needs a complete measurement, and the inputs that h uses there.
    fn check_start(&self, log: &Log) -> Result<(), ProblemError> {
        if self.model.x0 != Start::Measurement {
            return Ok(());
        }
        let incomplete = |t: &&Trajectory| !(0..t.len()).any(|k| t.is_complete(k));
        let Some(trajectory) = log.trajectories.iter().find(incomplete) else { return Ok(()) };
        let problem = format!(
            "x0 = \"measurement\" needs a row with all measurements in every trajectory, and {} has none: give x0 as numbers",
            describe(log, trajectory, 0)
        );
        Err(self.log_fault(&["model", "x0"], problem))
    }

    /// An h with inputs needs them wherever something is measured, in the last row too.
    fn check_inputs(&self, log: &Log) -> Result<(), ProblemError> {
        let mut used = vec![false; self.model.inputs.len()];
        let allowed = self.modes.iter().filter_map(|mode| mode.allowed.as_ref());
        for h in self.models().flat_map(|model| &model.h).chain(allowed) {
            h.symbols(&mut |symbol| {
                if let Symbol::Input(i) = symbol {
                    used[i] = true;
                }
            });
        }
        for trajectory in log.trajectories.iter().filter(|t| !t.is_empty()) {
            let last = trajectory.len() - 1;
            let measured = trajectory.z.row(last).iter().any(|z| !z.is_nan());
            let missing = used.iter().zip(trajectory.u.row(last)).position(|(used, u)| *used && u.is_nan());
            if let (true, Some(input)) = (measured, missing) {
                let problem = format!(
                    "{} uses the input `{}`, which is empty in the last row of {}, where something is measured",
                    if self.modes.is_empty() { "h" } else { "h or `allowed`" },
                    self.model.inputs[input],
                    describe(log, trajectory, last)
                );
                return Err(self.log_fault(&["model", "h"], problem));
            }
        }
        Ok(())
    }

    fn check_objectives(&self, log: &Log, warnings: &mut Vec<String>) -> Result<(), ProblemError> {
        let objectives = self.tune.objectives.len();
        for (i, objective) in self.tune.scorers().iter().enumerate() {
            let (what, key) =
                if i < objectives { ("objective", "objectives") } else { ("constraint on", "constraints") };
            let name = objective.name();
            if objective.kind == Kind::Mismatch {
                warnings.extend(log.trajectories.iter().filter_map(|t| short_window(log, t, objective.window)));
            }
            if let Some(ahead) =
                objective.horizons().iter().find(|ahead| !self.is_predicted(log, objective.skip, **ahead))
            {
                let problem = format!(
                    "the {what} `{name}` looks {ahead} rows ahead, and no scored measurement of {} has so many rows before it: \
                     give a smaller `ahead`",
                    log.source
                );
                return Err(self.log_fault(&["tune", key], problem));
            }
            let needed: Vec<&String> = match objective.kind {
                Kind::Nees | Kind::NeesMean => self.model.states.iter().collect(),
                _ => objective.states.iter().map(|i| &self.model.states[*i]).collect(),
            };
            if needed.is_empty() {
                continue;
            }
            let columns: Option<Vec<usize>> =
                needed.iter().map(|state| log.truth.iter().position(|s| s == *state)).collect();
            let known = |t: &Trajectory| {
                let Some(columns) = &columns else { return false };
                (objective.skip..t.len()).any(|k| columns.iter().all(|c| !t.truth.row(k)[*c].is_nan()))
            };
            if !log.trajectories.iter().any(known) {
                let names = needed.iter().map(|s| format!("`{s}`")).collect::<Vec<_>>().join(", ");
                let problem =
                    format!("the {what} `{name}` needs truth of {names}, and no scored row of {} has it", log.source);
                return Err(self.log_fault(&["tune", key], problem));
            }
        }
        Ok(())
    }
}

impl Problem {
    /// Whether some measurement that scores can be predicted from so many rows ahead: from x0 as the estimate of the row before
    /// the first, or of the row that it is taken from.
    fn is_predicted(&self, log: &Log, skip: usize, ahead: usize) -> bool {
        log.trajectories.iter().any(|t| {
            let first = match self.model.x0 {
                Start::Measurement => (0..t.len()).find(|k| t.is_complete(*k)).map(|k| k + ahead),
                Start::Values(_) => Some(ahead - 1),
            };
            let measured = |k: usize| t.z.row(k).iter().any(|z| !z.is_nan());
            first.is_some_and(|first| (first.max(skip)..t.len()).any(measured))
        })
    }
}

/// A warning where the last rows that `mismatch` averages over are more than there are.
fn short_window(log: &Log, trajectory: &Trajectory, window: usize) -> Option<String> {
    let measured = (0..trajectory.len()).filter(|k| trajectory.z.row(*k).iter().any(|z| !z.is_nan())).count();
    (measured < window).then(|| {
        format!(
            "the window of `mismatch` is {window} rows, and {} has {measured} measured ones: all of them are used",
            describe(log, trajectory, 0)
        )
    })
}

/// "log.csv:2" or "trajectory `7` (log.csv:118)".
fn describe(log: &Log, trajectory: &Trajectory, row: usize) -> String {
    let line = trajectory.line.get(row).map_or_else(String::new, |line| format!(":{line}"));
    match trajectory.id.as_str() {
        "" => format!("{}{line}", log.source),
        id => format!("trajectory `{id}` ({}{line})", log.source),
    }
}
