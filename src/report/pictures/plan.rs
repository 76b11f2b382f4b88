//! A track from above: one state of a place against the other.

use crate::chart::{Axis, Colour, Figure, Marker, Panel, Stroke, broken};
use crate::data::{Log, Trajectory};
use crate::model::{ExprKind, Problem, Symbol};
use crate::reference::{Estimate, Step};

/// Most states, and most measurements, that are drawn.
pub(super) const MOST: usize = 6;

/// Rows that are drawn of a longer track, evenly chosen.
const ROWS: usize = 20_000;
/// Names that two states of a place have where the model is written as formulas: to the right, and up.
const NAMES: [[&str; 2]; 7] =
    [["x", "y"], ["e", "n"], ["east", "north"], ["lon", "lat"], ["px", "py"], ["pos_x", "pos_y"], ["x1", "x2"]];
/// Names of a northward axis, which points up whichever comes first.
const NORTH: [&str; 4] = ["n", "north", "lat", "latitude"];

/// Two states that are a place on a plane, with the measurements and the columns of truth that are these states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Axes {
    /// To the right, and up.
    pub(super) states: [usize; 2],
    measured: Option<[usize; 2]>,
    truth: Option<[usize; 2]>,
}

impl Axes {
    /// The first two axes of a built-in model that moves in a plane or in space; of formulas the states that are named
    /// as places are. `None` if there are no such two.
    pub(super) fn of(problem: &Problem, log: &Log) -> Option<Self> {
        let states = &problem.model.states;
        // States before the positions, and components of an axis.
        let (before, order) = match problem.model.kind {
            Some("constant-velocity") => (0, 2),
            Some("constant-acceleration" | "singer") => (0, 3),
            Some("coordinated-turn") => (states.len() % 2, 2),
            Some("unicycle") => (1, 1),
            _ => (0, 0),
        };
        let named = |name: &str| states.iter().position(|state| state.eq_ignore_ascii_case(name));
        let mut found = match order {
            0 => NAMES.iter().find_map(|[x, y]| Some([named(x)?, named(y)?]))?,
            order => (states.len() >= 2 * order).then_some([before, before + 1])?,
        };
        if NORTH.iter().any(|north| states[found[0]].eq_ignore_ascii_case(north)) {
            found.reverse();
        }
        let measured = |state: usize| {
            problem.model.h.iter().position(|h| h.kind == ExprKind::Symbol(Symbol::State(state))).filter(|i| *i < MOST)
        };
        let truth = |state: usize| log.truth.iter().position(|name| *name == states[state]);
        let both = |of: &dyn Fn(usize) -> Option<usize>| Some([of(found[0])?, of(found[1])?]);
        Some(Self { states: found, measured: both(&measured), truth: both(&truth) })
    }
}

/// The course of one trajectory on the plane.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    axes: Axes,
    every: usize,
    times: Vec<f64>,
    estimate: Vec<(f64, f64)>,
    measured: Vec<(f64, f64)>,
    truth: Vec<(f64, f64)>,
    smoothed: Vec<(f64, f64)>,
}

impl Plan {
    /// For a trajectory of `length` rows.
    pub(super) fn new(axes: Axes, length: usize) -> Self {
        let none = Vec::new;
        let every = length.div_ceil(ROWS).max(1);
        Self { axes, every, times: Vec::new(), estimate: none(), measured: none(), truth: none(), smoothed: none() }
    }

    pub(super) fn add(&mut self, trajectory: &Trajectory, step: &Step) {
        if !step.row.is_multiple_of(self.every) {
            return;
        }
        let pair = |values: &[f64], [i, j]: [usize; 2]| (values[i], values[j]);
        self.times.push(step.time);
        self.estimate.push(pair(step.posterior.x.as_slice(), self.axes.states));
        self.measured.extend(self.axes.measured.map(|at| pair(trajectory.z.row(step.row), at)));
        self.truth.extend(self.axes.truth.map(|at| pair(trajectory.truth.row(step.row), at)));
    }

    pub(super) fn add_smoothed(&mut self, row: usize, estimate: &Estimate) {
        if row.is_multiple_of(self.every) {
            let [i, j] = self.axes.states;
            self.smoothed.push((estimate.x[i], estimate.x[j]));
        }
    }

    /// Points with a gap between rows that are far apart in time.
    fn course(&self, points: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> {
        let rows: Vec<(f64, (f64, f64))> = self.times.iter().copied().zip(points.iter().copied()).collect();
        broken(&rows, |row| row.0, |row| std::iter::once(row.1), (f64::NAN, f64::NAN))
    }

    /// The track with its measurements, truth and smoothed course where they are there, in one scale for both axes.
    pub(super) fn draw(&self, figure: Figure, problem: &Problem, [truth, smoothed]: [Stroke; 2]) -> Figure {
        let [x, y] = self.axes.states.map(|state| Axis::new(&problem.model.states[state]));
        let mut panel = Panel::new(x, y).equal();
        let has_any = |points: &[(f64, f64)]| points.iter().any(|(x, y)| x.is_finite() && y.is_finite());
        if has_any(&self.measured) {
            panel = panel.points("measured", (Marker::Dot, Colour::Grey), self.measured.iter().copied());
        }
        if has_any(&self.truth) {
            panel = panel.line("truth", truth, self.course(&self.truth));
        }
        if has_any(&self.smoothed) {
            panel = panel.line("smoothed", smoothed, self.course(&self.smoothed));
        }
        panel = panel.line("estimate", Stroke::new(Colour::Black), self.course(&self.estimate));
        let start = self.estimate.iter().find(|(x, y)| x.is_finite() && y.is_finite());
        figure.size(760.0, 460.0).panel(panel.points("first row", (Marker::Disc, Colour::Blue), start.copied()))
    }
}
