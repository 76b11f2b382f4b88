//! Pictures like the paper's Figs 5 to 8, of the data set whose gap PIO/PSO is the median.

use super::super::columns::Columns;
use super::super::{Figure, ReproduceError, Table};
use super::scenario;
use super::{Bench, DataSet, Results};
use crate::chart::{Axis, Colour, Dash, Figure as Picture, FigureError, Marker, Panel, Stroke};
use crate::data::Trajectory;
use crate::number::significant;
use crate::reference;

/// A filter's estimates along the track of one data set.
#[derive(Debug)]
pub(super) struct Estimates {
    /// Name of the filter.
    pub(super) label: &'static str,
    /// Number of the paper's figure.
    number: u32,
    /// x and y, one a row.
    positions: Vec<(f64, f64)>,
    /// Sum of errors.
    j: f64,
}

/// What the figures show.
#[derive(Debug)]
pub(super) struct Shown<'a> {
    set: &'a DataSet,
    track: Trajectory,
    estimates: Vec<Estimates>,
}

impl Results {
    /// The data set of the median gap, with the tracks of the untuned and the two tuned filters.
    pub(super) fn shown(&self, bench: &Bench) -> Result<Option<Shown<'_>>, ReproduceError> {
        let gap = |set: &&DataSet| set.pio.j / set.pso.j;
        let mut sorted: Vec<&DataSet> = self.data_sets.iter().collect();
        sorted.sort_by(|a, b| gap(a).total_cmp(&gap(b)));
        let Some(set) = sorted.get(sorted.len() / 2).copied() else { return Ok(None) };
        let mut log = scenario::log(self.seed, set.index);
        let filters = [
            ("KF", 5, scenario::UNTUNED.as_slice(), set.untuned),
            ("KF-PIO", 6, &set.pio.factor, set.pio.j),
            ("KF-PSO", 7, &set.pso.factor, set.pso.j),
        ];
        let mut estimates = Vec::with_capacity(filters.len());
        for (label, number, factor, j) in filters {
            let run = reference::run(&bench.free, &log, factor).map_err(|failure| ReproduceError::Filter {
                what: label.to_owned(),
                data_set: set.index,
                failure,
            })?;
            let positions = run.trajectories.iter().flatten().map(|step| (step.posterior.x[0], step.posterior.x[1]));
            estimates.push(Estimates { label, number, positions: positions.collect(), j });
        }
        Ok(Some(Shown { set, track: log.trajectories.swap_remove(0), estimates }))
    }
}

impl Shown<'_> {
    /// The pictures.
    pub(super) fn figures(&self) -> Result<Vec<Figure>, FigureError> {
        let mut figures = self.estimates.iter().map(|e| self.track_figure(e)).collect::<Result<Vec<_>, _>>()?;
        figures.push(self.convergence()?);
        Ok(figures)
    }

    fn points(&self, table: fn(&Trajectory) -> &crate::data::Table) -> Vec<(f64, f64)> {
        let row = |k: usize| table(&self.track).row(k);
        (0..self.track.len()).map(|k| (row(k)[0], row(k)[1])).collect()
    }

    /// (a) measured and estimated, (b) estimated and true.
    fn track_figure(&self, estimates: &Estimates) -> Result<Figure, FigureError> {
        let Estimates { label, number, positions, j } = estimates;
        let [x, y] = self.axes(positions);
        let panel = |title: &str| Panel::new(x.clone(), y.clone()).title(title);
        let estimate = Stroke::new(Colour::Blue);
        let measured = panel("(a) measured and estimated")
            .points("measured", (Marker::Dot, Colour::Grey), self.points(|t| &t.z))
            .line("estimated", estimate, positions.iter().copied());
        let truth = panel("(b) estimated and true")
            .line("true", Stroke::dashed(Colour::Red, Dash::Dashed), self.points(|t| &t.truth))
            .line("estimated", estimate, positions.iter().copied());
        let title = format!("{label}: J = {} (data set {})", significant(*j, 4), self.set.index);
        let name = format!("fig{number}-{}", label.to_lowercase());
        let caption = format!("As the paper's Fig. {number}: track of {label}, J in-sample.");
        Figure::of(name, caption, &Picture::new(title).columns(2).size(860.0, 300.0).panel(measured).panel(truth))
    }

    /// Axes that show measurements, truth and estimates, the same in (a) and (b).
    fn axes(&self, positions: &[(f64, f64)]) -> [Axis; 2] {
        let all = [self.points(|t| &t.z), self.points(|t| &t.truth), positions.to_vec()].concat();
        let axis = |name: &str, values: Vec<f64>| {
            let [low, high] =
                values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)]);
            let room = 0.04 * (high - low);
            Axis::new(name).range(low - room, high + room)
        };
        let (x, y) = all.into_iter().unzip();
        [axis("x", x), axis("y", y)]
    }

    /// Best J against iteration.
    fn convergence(&self) -> Result<Figure, FigureError> {
        let curve = |best: &[f64]| best.iter().enumerate().map(|(h, j)| (h as f64, *j)).collect::<Vec<_>>();
        let panel = Panel::new(Axis::new("iteration").whole(), Axis::new("best J"))
            .steps("PIO, r = 0.2", Stroke::of_series(1), curve(&self.set.pio.best))
            .steps("PSO", Stroke::of_series(0), curve(&self.set.pso.best))
            .steps("PIO+", Stroke::of_series(2), curve(&self.set.plus.best))
            .horizontal("independent optimum", Stroke::dashed(Colour::Grey, Dash::Dotted), self.set.optimum);
        let title = format!("Best J of the search (data set {})", self.set.index);
        let caption = "As the paper's Fig. 8: best J against iteration, J in-sample.";
        Figure::of("fig8-convergence", caption, &Picture::new(title).size(760.0, 280.0).panel(panel))
    }

    /// The numbers of Figs 5 to 7.
    pub(super) fn table(&self) -> Table {
        let track = &self.track;
        let mut columns = Columns::new()
            .count("row", |k: &usize| *k as u64 + 1)
            .numbers(["true_x", "true_y"], 6, |k| [track.truth.row(*k)[0], track.truth.row(*k)[1]])
            .numbers(["measured_x", "measured_y"], 6, |k| [track.z.row(*k)[0], track.z.row(*k)[1]]);
        for Estimates { label, positions, .. } in &self.estimates {
            columns =
                columns
                    .number(format!("{label}_x"), 6, |k| positions[*k].0)
                    .number(format!("{label}_y"), 6, |k| positions[*k].1);
        }
        columns.table("tracks", format!("Tracks of data set {}", self.set.index), 0..track.len())
    }
}
