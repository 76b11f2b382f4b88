//! Pictures like the paper's Figs 5 to 8, of the data set whose gap PIO/PSO is the median.

use super::super::{Cell, Figure, ReproduceError, Table};
use super::scenario;
use super::{Bench, DataSet, Results};
use crate::data::Trajectory;
use crate::reference;
use crate::report::figures::{Axis, Colour, Dash, Figure as Picture, FigureError, Marker, Panel, Stroke};
use crate::report::significant;

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
        let svg = Picture::new(title).columns(2).size(860.0, 300.0).panel(measured).panel(truth).to_svg()?;
        Ok(Figure {
            name: format!("fig{number}-{}", label.to_lowercase()),
            caption: format!("As the paper's Fig. {number}: track of {label}, J in-sample."),
            svg,
        })
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
        let svg = Picture::new(title).size(760.0, 280.0).panel(panel).to_svg()?;
        Ok(Figure {
            name: "fig8-convergence".to_owned(),
            caption: "As the paper's Fig. 8: best J against iteration, J in-sample.".to_owned(),
            svg,
        })
    }

    /// The numbers of Figs 5 to 7.
    pub(super) fn table(&self) -> Table {
        let mut columns = ["row", "true_x", "true_y", "measured_x", "measured_y"].map(str::to_owned).to_vec();
        columns.extend(self.estimates.iter().flat_map(|e| [format!("{}_x", e.label), format!("{}_y", e.label)]));
        let mut table = Table::new("tracks", format!("Tracks of data set {}", self.set.index), &[]);
        table.columns = columns;
        for k in 0..self.track.len() {
            let fixed = self.track.truth.row(k).iter().chain(self.track.z.row(k)).copied();
            let filters = self.estimates.iter().flat_map(|e| [e.positions[k].0, e.positions[k].1]);
            let cells = fixed.chain(filters).map(|x| Cell::Number(x, 6));
            table.rows.push(std::iter::once(Cell::Count(k as u64 + 1)).chain(cells).collect());
        }
        table
    }
}
