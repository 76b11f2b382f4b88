//! The course of a search.

use super::run_pictures::titled;
use super::{Axis, Colour, Dash, Figure, Marker, Panel, Stroke};
use crate::model::Problem;
use crate::study::Generation;

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
        .line("median of the generation", Stroke::dashed(Colour::Red, Dash::Dashed).width(1.6), median)
        .steps("best so far", Stroke::new(Colour::Black).width(2.0), best);
    // A spread of zero, as after convergence, has no place on a log axis.
    let spread: Vec<_> = spread.into_iter().map(|(g, s)| (g, if s > 0.0 { s } else { f64::NAN })).collect();
    let spread = Panel::new(generations(), Axis::new("spread").log_if(is_wide(spread.iter().map(|p| p.1)))).line(
        "interquartile range of the generation's costs",
        Stroke::new(Colour::Blue),
        spread,
    );
    Figure::new(titled(problem, "convergence")).size(760.0, 200.0).panel(course).panel(spread)
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
    if objective == "nll" { axis.unit("nats") } else { axis }
}

/// Whether positive values differ so much that they need a log axis.
pub(super) fn is_wide(values: impl Iterator<Item = f64>) -> bool {
    let usable = values.filter(|v| v.abs() < 1e300);
    let [low, high] = usable.fold([f64::INFINITY, 0.0f64], |[low, high], v| [low.min(v), high.max(v)]);
    low > 0.0 && low.is_finite() && high > 30.0 * low
}
