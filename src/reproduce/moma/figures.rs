//! Pictures like the paper's Figs 2 to 6, of the first data set. Its Regular is the run whose RMSE is nearest to 7.40,
//! that of the paper's run 22.

use super::super::columns::Columns;
use super::super::{Figure, ReproduceError, Table};
use super::ends::{self, Point};
use super::paths::Path;
use super::{Bench, DataSet, Results, Run, scenario};
use crate::chart::{Axis, Colour, Dash, Figure as Picture, FigureError, Marker, Panel, Stroke};
use crate::data::Trajectory;
use crate::number::significant;

/// RMSE of Regular in the paper's run 22.
const RUN_22: f64 = 7.40;

/// The paper's figures 4 to 6: number, state, name and unit.
const STATES: [(u32, &str, &str); 3] = [(4, "displacement", "m"), (5, "velocity", "m/s"), (6, "acceleration", "m/s^2")];

/// A filter along the track.
#[derive(Debug)]
struct Followed {
    label: String,
    path: Path,
}

/// What the figures show.
#[derive(Debug)]
pub(super) struct Shown<'a> {
    set: &'a DataSet,
    run: &'a Run,
    track: Trajectory,
    curve: Vec<Point>,
    ends: [Point; 2],
    moma: Followed,
    regular: Followed,
}

impl Results {
    /// The first data set with the densely scored curve of its objectives; `None` of no data set.
    pub(super) fn shown(&self, bench: &Bench) -> Result<Option<Shown<'_>>, ReproduceError> {
        let Some(set) = self.data_sets.first() else { return Ok(None) };
        let nearest = |j: &usize| (set.regular[*j] - RUN_22).abs();
        let Some(j) = (0..set.regular.len()).min_by(|a, b| nearest(a).total_cmp(&nearest(b))) else { return Ok(None) };
        let mut log = scenario::log(&bench.both, self.seed, set.index)?;
        let run = &set.tuned[0].moma[j];
        let mut evaluator = super::super::evaluator(&bench.both, &log)?;
        let curve = ends::curve(&mut evaluator, scenario::RANGE, 2000);
        let mut end = |which: usize| -> Option<Point> {
            let r = set.ends[which].0;
            ends::curve(&mut evaluator, [r, r], 2).pop()
        };
        let (Some(first), Some(second)) = (end(0), end(1)) else { return Ok(None) };
        let follow = |name: &str, r: f64, rmse: f64| -> Result<Followed, ReproduceError> {
            let label = format!("{name} (R = {}, RMSE {})", significant(r, 3), significant(rmse, 3));
            Ok(Followed { label, path: bench.path(&log, r, set.index)? })
        };
        let (moma, regular) =
            (follow("MOMA", run.found.r, run.rmse)?, follow("Regular", set.starts[j], set.regular[j])?);
        let track = log.trajectories.swap_remove(0);
        Ok(Some(Shown { set, run, track, curve, ends: [first, second], moma, regular }))
    }
}

/// A value at each k.
fn by_step(values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    values.enumerate().map(|(k, value)| (k as f64, value)).collect()
}

impl Shown<'_> {
    /// The pictures.
    pub(super) fn figures(&self) -> Result<Vec<Figure>, FigureError> {
        let mut figures = vec![self.front()?, self.error()?];
        for i in 0..STATES.len() {
            figures.push(self.state(i)?);
        }
        Ok(figures)
    }

    /// Fig. 2: the last population over the curve that R draws in the plane of the objectives.
    fn front(&self) -> Result<Figure, FigureError> {
        let front: Vec<(f64, f64)> = self.run.found.population.iter().map(|f| (f[0], f[1])).collect();
        let near = |values: [f64; 2]| {
            let (low, high) = (values[0].min(values[1]), values[0].max(values[1]));
            (low - 0.6 * (high - low), high + 1.2 * (high - low))
        };
        let (left, right) = near([self.ends[0].f[0], self.ends[1].f[0]]);
        let (_, top) = near([self.ends[0].f[1], self.ends[1].f[1]]);
        let curve = self.curve.iter().map(|p| (p.f[0], p.f[1]));
        let x = Axis::new("f1, mean squared innovation").unit("m^2").range(left.max(0.0), right);
        let y = Axis::new("f2, mismatch").range(-0.05 * top, top);
        let at = |p: &Point| [(p.f[0], p.f[1])];
        let panel = Panel::new(x, y)
            .line("all R", Stroke::new(Colour::Grey), curve)
            .points("last population", (Marker::Circle, Colour::Blue), front)
            .points(&end_label("least f1", &self.ends[0]), (Marker::Triangle, Colour::Red), at(&self.ends[0]))
            .points(&end_label("least f2", &self.ends[1]), (Marker::Diamond, Colour::Black), at(&self.ends[1]));
        let title = format!("Front of a MOMA run (data set {}, paper-like operators)", self.set.index);
        let caption = "As the paper's Fig. 2: the last population, and the curve it lies on.";
        Figure::of("fig2-front", caption, &Picture::new(title).size(760.0, 300.0).panel(panel))
    }

    /// Fig. 3: error of all three states.
    fn error(&self) -> Result<Figure, FigureError> {
        let errors = |shown: &Followed| by_step(shown.path.errors.iter().copied());
        let panel = Panel::new(Axis::new("k").whole(), Axis::new("error of (d, v, a)").log())
            .line(&self.regular.label, Stroke::dashed(Colour::Red, Dash::Dashed), errors(&self.regular))
            .line(&self.moma.label, Stroke::new(Colour::Blue), errors(&self.moma));
        let title = format!("Filter error (data set {})", self.set.index);
        let caption = "As the paper's Fig. 3: error of the filter against k.";
        Figure::of("fig3-error", caption, &Picture::new(title).size(760.0, 300.0).panel(panel))
    }

    /// Figs 4 to 6: truth and estimates of one state, above their difference.
    fn state(&self, i: usize) -> Result<Figure, FigureError> {
        let (number, name, unit) = STATES[i];
        let truth = |k: usize| self.track.truth.row(k)[i];
        let values = |shown: &Followed| by_step(shown.path.states.iter().map(|x| x[i]));
        let errors = |shown: &Followed| by_step(shown.path.states.iter().enumerate().map(|(k, x)| x[i] - truth(k)));
        let axis = |name: &str| Axis::new(name).unit(unit);
        let (regular, moma) = (Stroke::dashed(Colour::Red, Dash::Dashed), Stroke::new(Colour::Blue));
        let value = Panel::new(Axis::new("k").whole(), axis(name))
            .line("true", Stroke::new(Colour::Grey).width(3.0), by_step((0..self.track.len()).map(truth)))
            .line(&self.regular.label, regular, values(&self.regular))
            .line(&self.moma.label, moma, values(&self.moma));
        let error = Panel::new(Axis::new("k").whole(), axis("estimate - truth"))
            .line(&self.regular.label, regular, errors(&self.regular))
            .line(&self.moma.label, moma, errors(&self.moma));
        let title = format!("{}{} (data set {})", name[..1].to_uppercase(), &name[1..], self.set.index);
        let caption = format!("As the paper's Fig. {number}: {name} against k, and its error.");
        let picture = Picture::new(title).size(760.0, 200.0).panel(value).panel(error);
        Figure::of(format!("fig{number}-{name}"), caption, &picture)
    }

    /// The numbers of the figures.
    pub(super) fn tables(&self) -> Vec<Table> {
        let front = Columns::new().numbers(["f1", "f2"], 6, |f: &[f64; 2]| *f);
        let curve = Columns::new().number("R", 6, |p: &Point| p.r).numbers(["f1", "f2"], 6, |p| p.f);
        let (regular, moma) = (&self.regular.path, &self.moma.path);
        let track = Columns::new()
            .count("k", |k: &usize| *k as u64)
            .numbers(["true_d", "true_v", "true_a"], 6, |k| std::array::from_fn(|i| self.track.truth.row(*k)[i]))
            .numbers(["regular_d", "regular_v", "regular_a"], 6, |k| regular.states[*k])
            .numbers(["moma_d", "moma_v", "moma_a"], 6, |k| moma.states[*k])
            .numbers(["regular_error", "moma_error"], 6, |k| [regular.errors[*k], moma.errors[*k]]);
        vec![
            front.table("front", "Last population of the run shown", self.run.found.population.iter().copied()),
            curve.table("curve", "Objectives by R", self.curve.iter().copied()),
            track.table("tracks", "Truth and estimates of the run shown", 0..self.track.len()),
        ]
    }
}

fn end_label(name: &str, end: &Point) -> String {
    format!("{name} (R = {})", significant(end.r, 3))
}
