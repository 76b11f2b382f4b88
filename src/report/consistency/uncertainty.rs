//! How well a log determines the searched parameters: standard errors, and the directions that it leaves open.
//!
//! At the optimum of `nll` the inverse of its Hessian is the asymptotic covariance of the parameters (Durbin and Koopman
//! 2012, *Time Series Analysis by State Space Methods*, section 7.3.6), if the model is right. The Hessian is taken in
//! search coordinates, by differences that the f64 lanes score in batches; a parameter at its bound is held there.

use std::fmt;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Serialize;

use super::curvature::{Axis, Curvature, evaluations};
use crate::data::Log;
use crate::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
use crate::model::{Parameter, Problem, Scale, Search};
use crate::number::short;
use crate::objective::{Kind, Objective};
use crate::report::document::{Part, Section};
use crate::report::{Bound, Named};
use crate::study::Coordinates;
use crate::words::enumerated;

/// Distance to the optimum of `nll` \[standard errors\] up to which its curvature is taken to be that at the optimum.
const NEAR: f64 = 0.3;
/// Share of a parameter in a flat direction of unit length from which the parameter is left open with it.
const INVOLVED: f64 = 0.01;
/// Share below which a parameter is not named with a flat direction.
const NAMED: f64 = 0.05;
/// Most work for a Hessian, in operations of the lanes: about a minute of one core. A search of 15,616 evaluations takes
/// more than the Hessian of 120 parameters.
const WORK: f64 = 2e11;

/// How well the rows that a filter was tuned on determine its parameters. All are null (JSON) where not computed.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Uncertainty {
    /// Standard error of each searched parameter, in its own unit; NaN where the log does not determine it, or it is at
    /// its bound.
    pub standard_errors: Option<Named<f64>>,
    /// 95 % interval of each, symmetric in the search coordinate: value x exp(-+1.96 s) on a log scale.
    pub intervals_95: Option<Named<[f64; 2]>>,
    /// Directions in which `nll` changes by less than half a nat over a factor of ten (half the range on a linear
    /// scale).
    pub flat_directions: Option<Vec<FlatDirection>>,
    /// Newton's estimate of how far the optimum of `nll` is, in standard errors.
    pub distance_to_optimum: Option<f64>,
    /// Why standard errors are missing, or which parameters are held at a bound.
    pub standard_errors_note: Option<String>,
}

/// A combination of parameters that the log does not determine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlatDirection {
    /// Coefficients of the parameters, or of their logarithms where they are searched on a log scale; the largest is 1.
    pub combination: Named<f64>,
    /// In words.
    pub statement: String,
}

/// A searched parameter that is not at its bound.
struct Free<'a> {
    /// Place among the searched parameters.
    index: usize,
    parameter: &'a Parameter,
    search: &'a Search,
    /// Length in search coordinates that counts as large: a factor of ten, or half the range.
    unit: f64,
}

impl Uncertainty {
    /// Of `candidate` (searched parameters in their own units), tuned on `log`. It takes about d (d + 5) evaluations for d
    /// parameters, on all threads.
    ///
    /// # Panics
    /// If `candidate` does not have one value per searched parameter.
    #[must_use]
    pub fn of(problem: &Problem, log: &Log, candidate: &[f64]) -> Self {
        if candidate.is_empty() {
            return Self::default();
        }
        let units = Coordinates::new(&problem.parameters, false).units(candidate);
        let searched = problem.parameters.searched().zip(candidate).enumerate();
        let (free, held): (Vec<_>, Vec<_>) = searched
            .map(|(index, ((parameter, search), value))| {
                (Free { index, parameter, search, unit: units[index] }, Bound::of(search, *value))
            })
            .partition(|(_, bound)| bound.is_none());
        let free: Vec<Free> = free.into_iter().map(|(free, _)| free).collect();
        let held: Vec<&str> = held.iter().map(|(held, _)| held.parameter.name.as_str()).collect();
        let found = lanes(problem, log, free.len())
            .and_then(|mut lanes| curvature(problem, &mut lanes, candidate, &free))
            .and_then(|curvature| Shape::of(&curvature, &free));
        let mut uncertainty = match found {
            Ok(shape) => shape.report(problem, candidate, &free),
            Err(reason) => Self { standard_errors_note: Some(reason), ..Self::default() },
        };
        if uncertainty.standard_errors.is_some() && !held.is_empty() {
            let note = format!("{} held at the bound", enumerated(&held));
            uncertainty.standard_errors_note = Some(note);
        }
        uncertainty
    }
}

/// The f64 evaluator of the nll that was tuned, with its `skip`, if it was. Refuses where every parameter is held, or the
/// evaluations would take too long.
fn lanes(problem: &Problem, log: &Log, free: usize) -> Result<CpuEvaluator, String> {
    if free == 0 {
        return Err("every parameter is at a bound".to_owned());
    }
    let tuned = problem.tune.objectives.iter().find(|objective| objective.kind == Kind::Nll);
    let likelihood = [tuned.cloned().unwrap_or_else(|| Objective::new(Kind::Nll))];
    let lanes = CpuEvaluator::with_objectives(problem, log, &likelihood, CpuOptions::default());
    let lanes = lanes.map_err(|error| error.to_string())?;
    let runs = evaluations(free);
    if runs as f64 * lanes.program().operations() as f64 > WORK {
        let rows = log.rows();
        return Err(format!("they would take {runs} evaluations over {rows} rows (tune fewer parameters)"));
    }
    Ok(lanes)
}

/// Derivatives of `nll` in the search coordinates of the free parameters.
fn curvature(
    problem: &Problem,
    lanes: &mut CpuEvaluator,
    candidate: &[f64],
    free: &[Free],
) -> Result<Curvature, String> {
    let coordinates = Coordinates::new(&problem.parameters, false);
    let (space, position) = (coordinates.space(), coordinates.position(candidate));
    let steps = coordinates.steps(candidate);
    let axes: Vec<Axis> = free
        .iter()
        .map(|Free { index, unit, .. }| {
            let at = position[*index];
            let room = (at - space.lower[*index]).min(space.upper[*index] - at);
            Axis { at, first: steps[*index], longest: unit.min(room) }
        })
        .collect();
    let mut costs = |points: &[Vec<f64>]| -> Vec<Option<f64>> {
        let mut positions = Population::new(position.len());
        for point in points {
            let mut moved = position.clone();
            free.iter().zip(point).for_each(|(free, x)| moved[free.index] = *x);
            positions.push(&moved);
        }
        let scored = lanes.evaluate(&coordinates.candidates(&positions));
        (0..scored.len()).map(|i| scored.status(i).is_ok().then(|| scored.costs(i)[0])).collect()
    };
    Curvature::of(&mut costs, &axes).ok_or_else(|| "nll is not finite everywhere around these parameters".to_owned())
}

/// The eigenvalues and directions of the Hessian, in units of the parameters.
struct Shape {
    values: DVector<f64>,
    /// One column a direction.
    directions: DMatrix<f64>,
    distance: f64,
}

impl Shape {
    fn of(Curvature { gradient, hessian }: &Curvature, free: &[Free]) -> Result<Self, String> {
        let units = DVector::from_iterator(free.len(), free.iter().map(|f| f.unit));
        let scaled = DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(i, j)] * units[i] * units[j]);
        if !scaled.iter().all(|v| v.is_finite()) {
            return Err("nll changes too fast around these parameters".to_owned());
        }
        let SymmetricEigen { eigenvalues: values, eigenvectors: directions } = SymmetricEigen::new(scaled);
        let slopes = directions.tr_mul(&gradient.component_mul(&units));
        let distance =
            slopes.iter().zip(&values).map(|(slope, value)| slope * slope / value.max(1.0)).sum::<f64>().sqrt();
        if values.min() <= -1.0 {
            return Err("nll has no minimum here (tune for nll, or longer)".to_owned());
        }
        if distance > NEAR {
            let distance = short(distance, 2);
            return Err(format!(
                "the optimum of nll is {distance} standard errors away, and they hold there (tune for nll, or longer)"
            ));
        }
        Ok(Self { values, directions, distance })
    }

    fn is_flat(&self, direction: usize) -> bool {
        self.values[direction] < 1.0
    }

    fn report(&self, problem: &Problem, candidate: &[f64], free: &[Free]) -> Uncertainty {
        let mut errors = vec![f64::NAN; candidate.len()];
        let mut intervals = vec![[f64::NAN; 2]; candidate.len()];
        for (i, Free { index, search, unit, .. }) in free.iter().enumerate() {
            let (value, error) = (candidate[*index], unit * self.standard_error(i));
            let reach = 1.96 * error;
            (errors[*index], intervals[*index]) = match search.scale {
                Scale::Log => (value * error, [value * (-reach).exp(), value * reach.exp()]),
                Scale::Linear => (error, [value - reach, value + reach]),
            };
        }
        let flat = (0..free.len()).filter(|k| self.is_flat(*k)).map(|k| self.flat_direction(k, free));
        let names = problem.parameters.names();
        Uncertainty {
            standard_errors: Some(Named::new(names.iter().copied(), errors)),
            intervals_95: Some(Named::new(names, intervals)),
            flat_directions: Some(flat.collect()),
            distance_to_optimum: Some(self.distance),
            standard_errors_note: None,
        }
    }

    /// Of one parameter in its unit; NaN if a flat direction moves it.
    fn standard_error(&self, i: usize) -> f64 {
        let shares = self.directions.row(i);
        if (0..shares.len()).any(|k| self.is_flat(k) && shares[k].abs() > INVOLVED) {
            return f64::NAN;
        }
        let determined = (0..shares.len()).filter(|k| !self.is_flat(*k));
        determined.map(|k| shares[k] * shares[k] / self.values[k]).sum::<f64>().sqrt()
    }

    fn flat_direction(&self, direction: usize, free: &[Free]) -> FlatDirection {
        let shares = self.directions.column(direction);
        let named: Vec<(&Free, f64)> = free
            .iter()
            .zip(&shares)
            .filter(|(_, share)| share.abs() >= NAMED)
            .map(|(f, share)| (f, share / f.unit))
            .collect();
        let size = named.iter().map(|(_, c)| c.abs()).fold(0.0, f64::max);
        // The first of those that are as good as the largest, so that rounding does not choose the sign.
        let largest = named.iter().map(|(_, c)| *c).find(|c| c.abs() > 0.999 * size).unwrap_or(1.0);
        let terms: Vec<(&Free, f64)> = named.into_iter().map(|(f, c)| (f, c / largest)).collect();
        let statement = statement(&terms);
        FlatDirection { combination: terms.iter().map(|(f, c)| (f.parameter.name.as_str(), *c)).collect(), statement }
    }
}

fn statement(terms: &[(&Free, f64)]) -> String {
    let names: Vec<&str> = terms.iter().map(|(f, _)| f.parameter.name.as_str()).collect();
    if let [name] = names[..] {
        return format!("{name} is not determined by this log");
    }
    let mut combination = String::new();
    for (k, (f, coefficient)) in terms.iter().enumerate() {
        combination += match (k, *coefficient < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        let size = short(coefficient.abs(), 3);
        if size != "1" {
            combination += &format!("{size} ");
        }
        combination += if f.search.scale == Scale::Log { "log " } else { "" };
        combination += &f.parameter.name;
    }
    format!("{} trade off: {combination} is not determined by this log", enumerated(&names))
}

impl Uncertainty {
    /// What is said of it: labels, and what stands after them.
    pub(super) fn items(&self) -> Vec<(String, String)> {
        let mut items = Vec::new();
        if let Some(errors) = &self.standard_errors {
            let known = errors.iter().filter(|(_, error)| !error.is_nan());
            let known: Vec<String> = known.map(|(name, error)| format!("{name} {}", short(*error, 3))).collect();
            let note = self.standard_errors_note.as_ref().map_or_else(String::new, |note| format!(" ({note})"));
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            items.push(("standard errors (of the rows tuned on):".to_owned(), format!("{known}{note}")));
        } else if let Some(note) = &self.standard_errors_note {
            items.push(("standard errors:".to_owned(), format!("none, {note}")));
        }
        let flat = self.flat_directions.iter().flatten();
        items.extend(flat.map(|direction| (String::new(), direction.statement.clone())));
        items
    }
}

impl fmt::Display for Uncertainty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&Section::untitled("").with(Part::List(self.items())).text())
    }
}
