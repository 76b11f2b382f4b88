//! Rows at one time: the step between them must change nothing, so that neither their order nor their number matters.

use super::{Expr, FilterKind, Model, Parameters, Problem, Start, Symbol};
use crate::data::{Log, Trajectory};

/// How far a state may move in no time, as a share of itself or of 1: rounding.
const ROUNDING: f64 = 1e-9;

/// Path of the offending key and what is wrong, where two rows of the log have one time and f, Q or the filter change
/// something between them.
pub(super) fn check(problem: &Problem, log: &Log) -> Result<(), (Vec<String>, String)> {
    let still = |t: &Trajectory| (0..t.len()).find(|k| t.dt(*k).is_some_and(|dt| dt <= 0.0));
    let Some((trajectory, k)) = log.trajectories.iter().find_map(|t| Some((t, still(t)?))) else { return Ok(()) };
    let line = |k: usize| trajectory.line.get(k).copied().unwrap_or_default();
    let rows = format!("lines {} and {} of {}, which have one time", line(k), line(k + 1), log.source);
    let path = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect();
    if problem.filter.facts().adapts == super::Adapts::ProcessNoise {
        let name = problem.filter.name();
        let what = format!(
            "the {name} filter adapts one Q that serves every step, also that between {rows}: merge the rows of one time, or \
             take another filter"
        );
        return Err((path(&["filter", "kind"]), what));
    }
    if let FilterKind::Imm(imm) = &problem.filter
        && imm.transition.iter().all(|p| !p.mentions(|symbol| symbol == Symbol::Dt))
    {
        let what = format!(
            "the chain between the modes goes on in every row, also between {rows}: give mean times in `sojourn`, or merge \
             the rows of one time"
        );
        return Err((path(&["filter"]), what));
    }
    problem.models().try_for_each(|model| check_model(problem, model, (trajectory, k), &rows))
}

/// The same of one model.
fn check_model(
    problem: &Problem,
    model: &Model,
    (trajectory, k): (&Trajectory, usize),
    rows: &str,
) -> Result<(), (Vec<String>, String)> {
    let path = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect();
    let built_in = model.kind.is_some();
    if let Some(i) = moved(model, &problem.parameters, trajectory.u.row(k)) {
        let what = format!(
            "f of `{}` is not `{0}` at dt = 0, as between {rows}: write dt into it, or merge the rows of one time",
            model.states[i]
        );
        return Err((path(if built_in { &["model", "kind"] } else { &["model", "f"] }), what));
    }
    if is_noisy(model, &problem.parameters) {
        let remedy = if built_in { "use noise = \"continuous\"" } else { "write dt into it" };
        let what = format!("Q is not 0 at dt = 0, as between {rows}: {remedy}, or merge the rows of one time");
        return Err((path(&["model", if built_in { "noise" } else { "Q" }]), what));
    }
    Ok(())
}

/// The first state that f changes at dt = 0, or has no value for, at none of some points.
fn moved(model: &Model, parameters: &Parameters, inputs: &[f64]) -> Option<usize> {
    let (mut moved, mut known) = (vec![false; model.f.len()], vec![false; model.f.len()]);
    for values in values(parameters) {
        for point in points(model, &values) {
            let value = |symbol| match symbol {
                Symbol::State(i) => point[i],
                Symbol::Parameter(i) => values[i],
                // Whatever the last row lacks.
                Symbol::Input(i) => inputs.get(i).copied().filter(|u| !u.is_nan()).unwrap_or(0.0),
                Symbol::Dt => 0.0,
            };
            for (i, f) in model.f.iter().enumerate() {
                let mut difference = f.evaluate(&value) - point[i];
                if model.angles.state(i) {
                    difference = difference.sin().abs() + (1.0 - difference.cos());
                }
                known[i] |= difference.is_finite();
                moved[i] |= difference.is_finite() && difference.abs() > ROUNDING * (1.0 + point[i].abs());
            }
        }
    }
    moved.iter().zip(known).position(|(moved, known)| *moved || !known)
}

/// Whether Q at dt = 0 is anything but 0.
fn is_noisy(model: &Model, parameters: &Parameters) -> bool {
    values(parameters).iter().any(|values| {
        let entry = |q: &Expr, dt: f64| {
            q.evaluate(&|symbol| match symbol {
                Symbol::Parameter(i) => values[i],
                Symbol::Dt => dt,
                Symbol::State(_) | Symbol::Input(_) => f64::NAN,
            })
        };
        // A sum that cancels leaves rounding.
        let is_zero = |q: &Expr| entry(q, 0.0).abs() <= 1e-12 * entry(q, 1.0).abs() || entry(q, 0.0).abs() <= 0.0;
        !model.q.iter().all(is_zero)
    })
}

/// All parameters at the start values, and at either end of the ranges of the first population.
fn values(parameters: &Parameters) -> Vec<Vec<f64>> {
    let end = |end: usize| parameters.searched().map(|(_, search)| search.init[end]).collect();
    let candidates: [Vec<f64>; 3] = [parameters.baseline(), end(0), end(1)];
    candidates.iter().map(|candidate| parameters.resolve(candidate)).collect()
}

/// States all over the place, small and beside the start.
fn points(model: &Model, values: &[f64]) -> Vec<Vec<f64>> {
    let n = model.states.len();
    let small = |i: usize| 0.25 + (0.618_033_988_75 * (i as f64 + 1.0)).fract();
    let constant = |symbol| match symbol {
        Symbol::Parameter(i) => values[i],
        _ => f64::NAN,
    };
    let mut points = vec![(0..n).map(small).collect::<Vec<f64>>(), (0..n).map(|i| -0.5 * small(n - i)).collect()];
    if let Start::Values(x0) = &model.x0 {
        points.push(x0.iter().enumerate().map(|(i, x)| x.evaluate(&constant) + 1e-3 * small(i)).collect());
    }
    points
}
