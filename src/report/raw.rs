//! The error of the measurements themselves: what a filter has to beat.

use crate::data::Log;
use crate::model::{ExprKind, Problem, Symbol};
use crate::objective::{Kind, Objective};

/// RMSE of the raw measurements of an objective's states, over the rows that the objective scores from row `from` of each
/// trajectory on; `None` unless the objective is `rmse` and each of its states is measured directly (a component of h is
/// that state alone).
///
/// A row counts when all those measurements and their truth are there.
///
/// # Panics
/// If `from` has fewer entries than the log has trajectories.
#[must_use]
pub fn raw_rmse(problem: &Problem, log: &Log, from: &[usize], objective: &Objective) -> Option<f64> {
    if objective.kind != Kind::Rmse || objective.states.is_empty() {
        return None;
    }
    // (measurement column, truth column) of each state.
    let columns: Vec<(usize, usize)> =
        objective.states.iter().map(|&state| direct(problem, log, state)).collect::<Option<_>>()?;
    let angles = &problem.model.angles;
    let mut sum = 0.0;
    let mut rows = 0_u32;
    for (index, trajectory) in log.trajectories.iter().enumerate() {
        for k in objective.skip.max(from[index])..trajectory.len() {
            let (z, truth) = (trajectory.z.row(k), trajectory.truth.row(k));
            let squared: f64 =
                columns.iter().map(|&(i, j)| angles.between_measurements(i, z[i] - truth[j]).powi(2)).sum();
            if !squared.is_nan() {
                sum += squared;
                rows += 1;
            }
        }
    }
    (rows > 0).then(|| (sum / f64::from(rows)).sqrt())
}

fn direct(problem: &Problem, log: &Log, state: usize) -> Option<(usize, usize)> {
    let measured = problem.model.h.iter().position(|h| h.kind == ExprKind::Symbol(Symbol::State(state)))?;
    let truth = log.truth.iter().position(|name| *name == problem.model.states[state])?;
    Some((measured, truth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Problem;

    const TEXT: &str = r#"
[data]
file = "log.csv"
measurements = ["za", "zb"]
truth = { a = "ta", b = "tb" }
[model]
state = ["a", "b"]
f = ["a", "b"]
h = ["a", "2*b"]
Q = ["q", "q"]
R = ["q", "q"]
x0 = [0, 0]
P0 = [1, 1]
[parameters]
q = { min = 1, max = 2 }
[tune]
objectives = [{ name = "rmse", states = ["a"] }]
"#;

    fn raw(states: &str, kind: &str, skip: usize) -> Option<f64> {
        let objective = format!("{{ name = \"{kind}\", states = [{states}], skip = {skip} }}");
        let text = TEXT.replace("{ name = \"rmse\", states = [\"a\"] }", &objective);
        let problem = Problem::parse(&text, "p.toml").unwrap();
        let csv = "za,zb,ta,tb\n9,0,1,0\n4,0,1,0\n,0,5,0\n1,0,,0\n-1,0,3,0\n";
        let log = Log::read(&problem.data, csv.as_bytes(), "log.csv").unwrap();
        raw_rmse(&problem, &log, &[0], &problem.tune.objectives[0])
    }

    #[test]
    fn rows_with_measurement_and_truth_count() {
        // Row 0 is skipped, row 2 has no measurement, row 3 no truth: errors 3 and -4 stay.
        let expected = ((9.0_f64 + 16.0) / 2.0).sqrt();
        assert!((raw("\"a\"", "rmse", 1).unwrap() - expected).abs() < 1e-15, "{:?}", raw("\"a\"", "rmse", 1));
    }

    #[test]
    fn only_states_measured_directly_have_a_raw_error() {
        assert_eq!(raw("\"b\"", "rmse", 0), None, "b is measured as 2 b");
        assert_eq!(raw("\"a\", \"b\"", "rmse", 0), None, "one of them is");
        assert_eq!(raw("\"a\"", "distance", 0), None, "another objective");
    }
}
