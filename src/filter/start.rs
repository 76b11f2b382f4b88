//! What a trajectory starts from: the numbers behind [`Leaf::Start`](crate::tape::Leaf::Start).

use super::error::TraceError;
use super::nodes::{MapNodes, ModelNodes};
use super::tracer::Tracer;
use crate::model::Start;
use crate::tape::{Calculator, Id};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// What [`Leaf::Start`](crate::tape::Leaf::Start) stands for in each trajectory, whose rows of the record are given: the n states taken from the first
/// measurement (where x0 asks for it), then the n states of the nominal at the first row (where there is one), then the
/// interval after that row.
pub(super) fn starts(tracer: &mut Tracer<'_>, spans: &[Range<usize>]) -> Result<Vec<Vec<f64>>, TraceError> {
    let n = tracer.problem.model.states.len();
    let measured = tracer.problem.model.x0 == Start::Measurement;
    let mut start = measured.then(|| MeasuredStart::new(tracer)).transpose()?;
    let intervals = tracer.rows.first_intervals();
    let values = |(t, (span, interval)): (usize, (&Range<usize>, f64))| {
        let mut values = start.as_mut().map_or_else(|| vec![f64::NAN; n], |start| start.of(tracer, t, span.start));
        if let Some(nominal) = tracer.nominal {
            values.extend(nominal.states[span.start * n..].iter().take(n));
            values.resize(2 * n, f64::NAN);
        }
        values.push(interval);
        values
    };
    Ok(spans.iter().zip(intervals).enumerate().map(values).collect())
}

/// H and h(0) of the baseline, to be taken at any row.
struct MeasuredStart(Calculator);

impl MeasuredStart {
    fn new(t: &mut Tracer<'_>) -> Result<Self, TraceError> {
        let MapNodes { jacobian, offset, .. } = ModelNodes::new(t, Some(&t.problem.parameters.baseline()))?.h;
        let ids: Vec<Id> = jacobian.into_iter().flatten().chain(offset).collect();
        Ok(Self(Calculator::new(&t.g, &ids)))
    }

    /// x = pinv(H) (z - h(0)) at the first used row of a trajectory; unmeasured directions are 0.
    fn of(&mut self, t: &Tracer<'_>, trajectory: usize, row: usize) -> Vec<f64> {
        let (n, m) = (t.problem.model.states.len(), t.problem.model.measurements.len());
        let (first, trajectory) = (t.rows.first[trajectory], &t.rows.log.trajectories[trajectory]);
        let Some(z) = (first < trajectory.len()).then(|| trajectory.z.row(first)) else {
            return vec![f64::NAN; n];
        };
        let values: Vec<f64> = self.0.evaluate(|leaf| t.at(leaf, row)).collect();
        let h = DMatrix::from_row_slice(m, n, &values[..m * n]);
        let residual = DVector::from_iterator(m, z.iter().zip(&values[m * n..]).map(|(z, offset)| z - offset));
        least_norm(h, residual).as_slice().to_vec()
    }
}

/// pinv(H) y. Where no row of H depends on others, y = H x holds exactly, whatever the unit of a row: each is divided by its
/// own norm, so that sensors of very different units are all seen.
fn least_norm(mut h: DMatrix<f64>, mut y: DVector<f64>) -> DVector<f64> {
    /// Singular values of a measurement matrix are far from the rounding error that this share of its norm stands for.
    const ROUNDING: f64 = 1e-12;
    let mut unit = h.clone();
    unit.row_iter_mut().filter(|row| row.norm() > 0.0).for_each(|mut row| row.unscale_mut(row.norm()));
    if unit.rank(ROUNDING * unit.norm()) == h.nrows() {
        y.iter_mut().zip(h.row_iter()).for_each(|(y, row)| *y /= row.norm());
        h = unit;
    }
    let rounding = ROUNDING * h.norm();
    let (n, m) = (h.ncols(), h.nrows());
    h.pseudo_inverse(rounding).unwrap_or_else(|_| DMatrix::zeros(n, m)) * y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Log, Table, Trajectory};
    use crate::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
    use crate::model::Problem;
    use crate::reference;

    fn log(trajectories: &[&[[f64; 2]]]) -> Log {
        let trajectory = |rows: &&[[f64; 2]]| {
            let (mut z, mut u, mut truth) = (Table::new(1), Table::new(1), Table::new(0));
            for row in *rows {
                z.push(&row[..1]);
                u.push(&row[1..]);
                truth.push(&[]);
            }
            let time = (0u32..).take(rows.len()).map(f64::from).collect();
            Trajectory { id: String::new(), line: vec![2; rows.len()], time, z, u, truth }
        };
        Log {
            source: "start.csv".to_owned(),
            measurements: vec!["z".to_owned()],
            inputs: vec!["u".to_owned()],
            truth: vec![],
            trajectories: trajectories.iter().map(trajectory).collect(),
            ..Log::default()
        }
    }

    fn problem(h: &str, r: &str) -> Problem {
        let text = format!(
            "[data]\nfile = \"none.csv\"\nmeasurements = [\"z\"]\ninputs = [\"u\"]\n[model]\nstate = [\"x\"]\nf = [\"x\"]\n\
             h = [\"{h}\"]\nQ = [0.1]\nR = [\"{r}\"]\nx0 = \"measurement\"\nP0 = [4]\n[parameters]\n\
             r = {{ min = 0.1, max = 9, start = 1 }}\n"
        );
        Problem::parse(&text, "start.toml").unwrap()
    }

    #[test]
    fn a_start_sees_sensors_of_very_different_units() {
        let h = DMatrix::from_row_slice(2, 3, &[1e3, 0.0, 0.0, 0.0, 2e-13, 0.0]);
        let x = least_norm(h, DVector::from_column_slice(&[5e3, 6e-13]));
        assert!((x - DVector::from_column_slice(&[5.0, 3.0, 0.0])).norm() < 1e-14);
        // Two sensors of one state: least squares of what they say, in their units, as pinv(H) is defined.
        let x = least_norm(DMatrix::from_row_slice(2, 1, &[1.0, 2.0]), DVector::from_column_slice(&[1.0, 4.0]));
        assert!((x[0] - 1.8).abs() < 1e-15, "{x}");
    }

    fn assert_equal(problem: &Problem, log: &Log) {
        let mut lanes = CpuEvaluator::new(problem, log, CpuOptions::default()).unwrap();
        let found = lanes.evaluate(&Population::from_rows(1, vec![2.0])).costs(0)[0];
        let expected = reference::costs(problem, log, &[2.0]).unwrap()[0];
        assert!((found - expected).abs() <= 1e-10 * expected.abs(), "found {found}, the reference says {expected}");
    }

    #[test]
    fn a_last_trajectory_without_a_measurement_to_start_from_has_no_rows() {
        let measured = [[f64::NAN, 0.5], [3.0, 0.25], [2.0, 0.0]];
        let never = [[f64::NAN, 0.5], [f64::NAN, 0.25]];
        assert_equal(&problem("x + u", "r"), &log(&[&measured, &never]));
    }

    #[test]
    fn a_start_from_a_measurement_does_not_depend_on_units() {
        let rows = [[3e-14, 0.0], [2e-14, 0.0], [4e-14, 0.0]];
        assert_equal(&problem("x * 1e-14", "r * 1e-28"), &log(&[&rows]));
    }
}
