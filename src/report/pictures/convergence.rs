//! The course of a search.

use super::run_pictures::titled;
use crate::chart::{Axis, Colour, Dash, Figure, Marker, Panel, Stroke};
use crate::model::Problem;
use crate::study::Generation;

const BEST: Stroke = Stroke::new(Colour::Black).width(2.0);
const MEDIAN: Stroke = Stroke::dashed(Colour::Red, Dash::Dashed).width(1.6);

/// Best and median cost of the first objective, and the spread of the population, over the generations.
#[must_use]
pub fn convergence(problem: &Problem, history: &[Generation]) -> Figure {
    let objective = problem.tune.objectives.first().map_or("cost", |objective| objective.name());
    let series = |value: fn(&Generation) -> Option<f64>| {
        let points = history.iter().map(move |row| (row.generation as f64, value(row).unwrap_or(f64::NAN)));
        points.collect::<Vec<_>>()
    };
    let (best, median, spread) = (series(|g| g.best), series(|g| g.median), series(|g| g.spread));
    let costs = best.iter().chain(&median).map(|point| point.1);
    let axis = cost_axis(objective).log_if(is_wide(costs));
    let course = Panel::new(generations(), axis)
        .line("median of the generation", MEDIAN, median.iter().copied())
        .steps("best so far", BEST, best.iter().copied());
    Figure::new(titled(problem, "convergence"))
        .size(760.0, 200.0)
        .panel(course)
        .panel(approach(objective, [&best, &median, &spread]))
}

/// How far best and median are above the best of all, and how far the population has spread. What has arrived is a gap
/// on the log axis.
fn approach(objective: &str, [best, median, spread]: [&[(f64, f64)]; 3]) -> Panel {
    let last = best.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let above = |points: &[(f64, f64)]| points.iter().map(|(g, cost)| (*g, cost - last)).collect::<Vec<_>>();
    let (best, median, spread) = (above(best), above(median), spread.to_vec());
    let all = best.iter().chain(&median).chain(&spread).map(|point| point.1).filter(|v| *v > 0.0);
    let axis = cost_axis(&format!("{objective} − final best")).log_if(is_wide(all));
    Panel::new(generations(), axis)
        .line("interquartile range", Stroke::dashed(Colour::Blue, Dash::DashDot).width(1.6), spread)
        .line("median of the generation", MEDIAN, median)
        .steps("best so far", BEST, best)
}

/// Hypervolume of the front over the generations, as (generation, volume).
#[must_use]
pub fn hypervolume(problem: &Problem, history: impl IntoIterator<Item = (usize, f64)>) -> Figure {
    let points: Vec<(f64, f64)> = history.into_iter().map(|(generation, volume)| (generation as f64, volume)).collect();
    let panel = Panel::new(generations(), Axis::new("hypervolume"));
    let panel =
        if points.len() <= 60 { panel.points("", (Marker::Dot, Colour::Black), points.iter().copied()) } else { panel };
    let panel = panel.steps("hypervolume of the front so far", Stroke::new(Colour::Black), points);
    Figure::new(titled(problem, "hypervolume")).panel(panel)
}

fn generations() -> Axis {
    Axis::new("generation").whole()
}

/// An axis for an objective.
pub(super) fn cost_axis(objective: &str) -> Axis {
    let axis = Axis::new(objective);
    if objective.starts_with("nll") { axis.unit("nats") } else { axis }
}

/// Whether positive values differ so much that they need a log axis.
pub(super) fn is_wide(values: impl Iterator<Item = f64>) -> bool {
    let usable = values.filter(|v| v.abs() < 1e300);
    let [low, high] = usable.fold([f64::INFINITY, 0.0f64], |[low, high], v| [low.min(v), high.max(v)]);
    low > 0.0 && low.is_finite() && high > 30.0 * low
}
