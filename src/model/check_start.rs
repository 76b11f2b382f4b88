//! Formulas at the start: whether f, h and their derivatives are numbers there; and angles that the log shows.

use super::error::{Cause, Fault};
use super::{Binary, Duals, Expr, ExprKind, Formula, Function, Problem, ProblemError, Start, Symbol};
use crate::data::{Log, Trajectory};
use std::f64::consts::{PI, TAU};

impl Problem {
    /// f, h and their derivatives at x0, with the start values, the inputs and the interval of the first row.
    pub(super) fn check_formulas_at_start(&self, log: &Log) -> Result<(), ProblemError> {
        let Start::Values(x0) = &self.model.x0 else { return Ok(()) };
        let Some(first) = log.trajectories.iter().find(|t| !t.is_empty()) else { return Ok(()) };
        if self.filter.is_linear() {
            return Ok(());
        }
        let parameters = self.parameters.resolve(&self.parameters.baseline());
        let dt = (0..first.len()).filter_map(|k| first.dt(k)).find(|dt| *dt > 0.0).unwrap_or(1.0);
        let at = |states: &[f64], symbol| match symbol {
            Symbol::State(i) => states[i],
            Symbol::Parameter(i) => parameters[i],
            Symbol::Input(i) => Some(first.u.row(0)[i]).filter(|u| !u.is_nan()).unwrap_or(0.0),
            Symbol::Dt => dt,
        };
        let x: Vec<f64> = x0.iter().map(|x| x.evaluate(&|symbol| at(&[], symbol))).collect();
        for (key, formulas) in self.models().flat_map(|model| [("f", &model.f), ("h", &model.h)]) {
            for (i, formula) in formulas.iter().enumerate() {
                let (value, gradient) =
                    Formula::of(formula).gradient(|symbol| at(&x, symbol), x.len(), &mut Duals::default());
                let what = if !value.is_finite() {
                    "no finite value"
                } else if gradient.iter().any(|slope| !slope.is_finite()) {
                    "no finite derivative"
                } else {
                    continue;
                };
                let of_sensor = (key == "h").then(|| self.sensor_of(i)).flatten();
                let key = of_sensor.map_or_else(
                    || format!("model.{key}[{}]", i + 1),
                    |(sensor, own)| format!("sensor[{}].h[{}]", sensor + 1, own + 1),
                );
                let at = self.described(formula, &x);
                let cause = Cause::NotSmooth { key, what, at };
                return Err(Fault::new(formula.span, cause).locate(&self.source, &self.text));
            }
        }
        Ok(())
    }

    /// The sensor that has measurement `i`, and the number of it among its own; none where one row measures all.
    fn sensor_of(&self, i: usize) -> Option<(usize, usize)> {
        let ranges = self.data.sensor_ranges();
        let number = ranges.iter().position(|range| range.contains(&i))?;
        Some((number, i - ranges[number].start))
    }

    /// "x = 0, y = 0": the states of a formula.
    fn described(&self, formula: &Expr, x: &[f64]) -> String {
        let used = (0..x.len()).filter(|i| formula.mentions(|symbol| symbol == Symbol::State(*i)));
        used.map(|i| format!("{} = {}", self.model.states[i], x[i])).collect::<Vec<_>>().join(", ")
    }

    /// A measurement whose formula is an angle and whose log goes round must be named as one; one in degrees is warned of.
    pub(super) fn check_angles(&self, log: &Log, warnings: &mut Vec<String>) -> Result<(), ProblemError> {
        let all = self.models().flat_map(|model| model.h.iter().zip(&model.measurements).enumerate());
        for (i, (h, name)) in all {
            if self.model.angles.measurement(i) {
                let far = values(log, i).find(|(.., z)| z.abs() > 1.5 * TAU);
                warnings.extend(far.map(|(trajectory, k, z)| {
                    let line = trajectory.line.get(k).copied().unwrap_or(0);
                    format!(
                        "the angle `{name}` is {z} at {}:{line}, more than a turn of 2 pi: angles are in radians (1 degree \
                         is pi / 180)",
                        log.source
                    )
                }));
                continue;
            }
            let jump = log.trajectories.iter().find_map(|t| jump(t, i).map(|(k, by)| (t, k, by)));
            let Some((trajectory, k, by)) = jump.filter(|_| is_angle(h)) else { continue };
            let line = trajectory.line.get(k).copied().unwrap_or(0);
            let (column, table, path) = match self.sensor_of(i) {
                None => (name, "[model]".to_owned(), ["model", "h", ""].map(str::to_owned)),
                Some((number, own)) => {
                    let sensor = &self.data.sensors[number];
                    let path = ["sensor".to_owned(), number.to_string(), "h".to_owned()];
                    (&sensor.columns[own], format!("the [[sensor]] `{}`", sensor.name), path)
                }
            };
            let problem = format!(
                "`{name}` jumps by {by} at {}:{line}, more than half a turn, and its formula is an angle: add angle = \
                 [\"{column}\"] to {table}, so that innovations are wrapped to [-pi, pi)",
                log.source
            );
            return Err(self.fault(&path.each_ref().map(String::as_str), Cause::Log { problem }));
        }
        Ok(())
    }
}

/// Every present value of a measurement, with its trajectory and row.
fn values(log: &Log, i: usize) -> impl Iterator<Item = (&Trajectory, usize, f64)> {
    let all = log.trajectories.iter().flat_map(move |t| (0..t.len()).map(move |k| (t, k, t.z.row(k)[i])));
    all.filter(|(.., z)| !z.is_nan())
}

/// The first row at which a measurement is more than half a turn away from the one before it, and by how much.
fn jump(trajectory: &Trajectory, i: usize) -> Option<(usize, f64)> {
    let present = || (0..trajectory.len()).filter(|k| !trajectory.z.row(*k)[i].is_nan());
    let pairs = present().zip(present().skip(1));
    let by = |(before, k): (usize, usize)| (k, trajectory.z.row(k)[i] - trajectory.z.row(before)[i]);
    pairs.map(by).find(|(_, by)| by.abs() > PI)
}

/// Whether a formula is an arc tangent, by itself or with something added to it.
fn is_angle(formula: &Expr) -> bool {
    match &formula.kind {
        ExprKind::Call(Function::Atan2 | Function::Wrap, _) => true,
        ExprKind::Negate(a) => is_angle(a),
        ExprKind::Binary(Binary::Add | Binary::Subtract, a, b) => is_angle(a) || is_angle(b),
        _ => false,
    }
}
