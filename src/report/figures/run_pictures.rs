//! The pictures of one filter run.

use super::envelope::Envelope;
use super::run_record::{MOST, MeasurementSeries, RunRecord, StateSeries, Track};
use super::{Axis, Colour, Dash, Figure, Marker, Panel, Stroke};
use crate::model::{Problem, SplitBy};
use crate::report::{Whiteness, significant};

const MEASURED: (Marker, Colour) = (Marker::Dot, Colour::Grey);
const ESTIMATE: Stroke = Stroke::new(Colour::Black);
const TRUTH: Stroke = Stroke::dashed(Colour::Red, Dash::Dashed).width(1.6);
const SMOOTHED: Stroke = Stroke::dashed(Colour::Blue, Dash::DashDot).width(1.8);
/// Where held-out rows begin.
const BOUNDARY: Stroke = Stroke::dashed(Colour::Black, Dash::Dotted).width(1.8);
const LIMIT: Stroke = Stroke::dashed(Colour::Red, Dash::Dashed);

impl RunRecord<'_> {
    /// States over time with their 3-sigma bands, with measurements, truth and smoothed estimates where there are any.
    /// A measurement that is no state by itself has a panel of its own, beside what the filter expected.
    #[must_use]
    pub fn estimates(&self) -> Figure {
        let states = &self.problem.model.states;
        let shown = states.len().min(MOST);
        let left_out =
            if shown < states.len() { format!(", first {shown} of {} states", states.len()) } else { String::new() };
        let figure = self.figure(&format!("estimates{left_out}"));
        let Some(track) = self.track() else { return figure.panel(self.empty("state")) };
        let alone = (0..track.measurements.len()).filter(|i| !self.measured_as.contains(&Some(*i)));
        let alone = alone.take(MOST - shown.min(MOST - 2)).map(|i| self.measurement(&track.measurements[i], i));
        let states = (0..shown).map(|state| self.state(track, state));
        figure.panels(states.chain(alone).map(|panel| self.with_boundary(panel)))
    }

    fn state(&self, track: &Track, state: usize) -> Panel {
        let series = &track.states[state];
        let measurement = self.measured_as[state].and_then(|i| track.measurements.get(i));
        let measured = measurement.map(|measurement| measurement.measured.points());
        let others = measured.into_iter().flatten().chain(series.truth.line()).chain(series.estimate.line());
        let name = &self.problem.model.states[state];
        let axis = of_course(Axis::new(name), others.map(|point| point.1), &series.band);
        let mut panel = Panel::new(time_axis(self.problem), axis);
        panel = panel.band("3-sigma band", Colour::Blue, series.band.band());
        if let Some(measurement) = measurement {
            panel = panel.points("measured", MEASURED, measurement.measured.points());
        }
        if series.truth.has_values() {
            panel = panel.line("truth", TRUTH, series.truth.line());
        }
        if series.smoothed.has_values() {
            panel = panel.line("smoothed", SMOOTHED, series.smoothed.line());
        }
        panel.line("estimate", ESTIMATE, series.estimate.line())
    }

    fn measurement(&self, series: &MeasurementSeries, i: usize) -> Panel {
        let others = series.measured.points().chain(series.predicted.line()).map(|point| point.1);
        let axis = of_course(Axis::new(&self.log.measurements[i]), others, &series.predicted_band);
        Panel::new(time_axis(self.problem), axis)
            .band("3-sigma band", Colour::Blue, series.predicted_band.band())
            .points("measured", MEASURED, series.measured.points())
            .line("predicted", ESTIMATE, series.predicted.line())
    }

    /// Estimates minus truth of the states that have it, within three standard deviations; `None` without truth.
    #[must_use]
    pub fn errors(&self) -> Option<Figure> {
        let track = self.track()?;
        let with_truth: Vec<_> =
            track.states.iter().enumerate().filter(|(_, series)| series.error.has_values()).collect();
        let panel = |(i, series): (usize, &StateSeries)| {
            let errors = without_outliers(series.error.line().map(|point| point.1).collect());
            let axis = Axis::new(format!("error of {}", self.problem.model.states[i]));
            Panel::new(time_axis(self.problem), of_course(axis, errors.into_iter(), &series.deviation))
                .band("± 3 standard deviations", Colour::Blue, series.deviation.band())
                .horizontal("", Stroke::new(Colour::Grey).width(1.0), 0.0)
                .line("estimate minus truth", ESTIMATE, series.error.line())
        };
        let figure = (!with_truth.is_empty()).then(|| self.figure("estimation errors"));
        figure.map(|figure| figure.panels(with_truth.into_iter().map(panel).map(|panel| self.with_boundary(panel))))
    }

    /// Innovations with plus and minus two of their standard deviations, within which 95 % lie if the filter is right.
    #[must_use]
    pub fn innovations(&self) -> Figure {
        let shown = self.log.measurements.len().min(MOST);
        let all = self.log.measurements.len();
        let left_out = if shown < all { format!(", first {shown} of {all} measurements") } else { String::new() };
        let figure = self.figure(&format!("innovations{left_out}"));
        let Some(track) = self.track() else { return figure.panel(self.empty("innovation")) };
        let panel = |(name, series): (&String, &MeasurementSeries)| {
            let values = series.innovation.points().map(|point| point.1);
            let axis = of_course(Axis::new(format!("innovation of {name}")), values, &series.band);
            Panel::new(time_axis(self.problem), axis)
                .band("± 2 sqrt(S)", Colour::Blue, series.band.band())
                .points("innovation", (Marker::Dot, Colour::Black), series.innovation.points())
                .horizontal("", Stroke::new(Colour::Grey).width(1.0), 0.0)
        };
        let panels = self.log.measurements.iter().zip(&track.measurements).map(panel);
        figure.panels(panels.map(|panel| self.with_boundary(panel)))
    }

    /// NIS over time with the band that holds 95 % of it if the filter is right.
    #[must_use]
    pub fn nis(&self) -> Figure {
        let nis = self.nis;
        let mean = significant(nis.sum / nis.components.max(1) as f64, 3);
        let inside = 100.0 * nis.inside as f64 / nis.rows.max(1) as f64;
        let rows = if nis.rows == 1 { "row" } else { "rows" };
        let figure = self.figure("NIS").size(760.0, 260.0);
        let axis = Axis::new("NIS").log();
        let Some(track) = self.track().filter(|_| nis.rows > 0) else { return figure.panel(self.empty("NIS")) };
        // The lowest NIS of a long log tell nothing, but would take most of the height; where most are below the band
        // they are what there is to see.
        let low = track.nis_band.band().map(|(_, [low, _])| low).fold(f64::INFINITY, f64::min) / 30.0;
        let low = low.min(lowest_usual(track.nis.line().map(|(_, nis)| nis)) / 2.0);
        let high = track.nis_band.band().map(|(_, [_, high])| high).fold(f64::NEG_INFINITY, f64::max);
        let high = track.nis.line().map(|(_, nis)| nis).filter(|nis| nis.is_finite()).fold(high, f64::max) * 1.5;
        let axis = if 0.0 < low && low < high && high < 1e300 { axis.range(low, high) } else { axis };
        let held_out = if self.held_out_by().is_some() { "held-out " } else { "" };
        let panel = Panel::new(time_axis(self.problem), axis)
            .title(format!("mean {mean} a component; {inside:.1} % of {} {held_out}{rows} in the band", nis.rows))
            .band("95 % band", Colour::Blue, track.nis_band.band())
            .points("NIS", (Marker::Dot, Colour::Black), track.nis.points());
        figure.panel(self.with_boundary(panel))
    }

    /// Autocorrelations of the normalised innovations with the band that holds 95 % of them if they are white.
    #[must_use]
    pub fn autocorrelation(&self, whiteness: &[Whiteness]) -> Figure {
        let panel = |w: &Whiteness| {
            let bars = w.autocorrelation.iter().enumerate().map(|(i, r)| {
                let lag = i as f64 + 1.0;
                ([lag - 0.3, lag + 0.3], *r)
            });
            let p_value =
                if w.p_value < 1e-4 { "< 1e-4".to_owned() } else { format!("= {}", significant(w.p_value, 2)) };
            let title = match w.autocorrelation.len() {
                0 => format!("{}: too few values", w.measurement),
                _ => format!("{}: Ljung-Box p {p_value}", w.measurement),
            };
            let end = w.autocorrelation.len() as f64 + 1.0;
            let lag = Axis::new("lag").unit("measured rows").whole().range(0.0, end);
            Panel::new(lag, Axis::new("autocorrelation"))
                .title(title)
                .bars("autocorrelation", Colour::Blue, bars)
                .horizontal("95 % band", LIMIT, w.band)
                .horizontal("", LIMIT, -w.band)
                .horizontal("", Stroke::new(Colour::Black).width(1.0), 0.0)
        };
        let columns = if whiteness.len() > 1 { 2 } else { 1 };
        let what = format!("autocorrelation of the innovations{}", self.rows());
        let figure = Figure::new(titled(self.problem, &what)).columns(columns);
        if whiteness.is_empty() {
            return figure.panel(Panel::new(Axis::new("lag"), Axis::new("autocorrelation")));
        }
        figure.panels(whiteness.iter().take(MOST).map(panel))
    }

    /// Histograms of the normalised innovations of all trajectories over N(0, 1).
    #[must_use]
    pub fn histogram(&self) -> Figure {
        let names = self.log.measurements.iter().zip(&self.histograms).take(MOST);
        let columns = if self.histograms.len() > 1 { 2 } else { 1 };
        Figure::new(titled(self.problem, &format!("normalised innovations{}", self.rows())))
            .columns(columns)
            .panels(names.map(|(name, histogram)| histogram.panel(name)))
    }

    /// A figure whose title says which of several trajectories it shows.
    fn figure(&self, what: &str) -> Figure {
        let all = self.log.trajectories.len();
        let which = self.track().filter(|_| all > 1).map(|track| {
            let id = &self.log.trajectories[track.trajectory].id;
            let number = (track.trajectory + 1).to_string();
            let name = if id.is_empty() { &number } else { id };
            let (held_out, held_out_rows) = match self.held_out_by() {
                None => ("", ""),
                Some(SplitBy::Trajectory) => ("held-out ", ""),
                Some(SplitBy::Time) => ("", " in held-out rows"),
            };
            format!(" ({held_out}trajectory {name}: largest mean NIS{held_out_rows} of {all})")
        });
        let height = if self.log.measurements.len().max(self.problem.model.states.len()) > 2 { 150.0 } else { 220.0 };
        Figure::new(titled(self.problem, &format!("{what}{}", which.unwrap_or_default()))).size(760.0, height)
    }

    /// A panel over time, with the place where held-out rows begin over all else.
    fn with_boundary(&self, panel: Panel) -> Panel {
        match self.boundary() {
            Some(time) => panel.vertical("held-out rows begin", BOUNDARY, time),
            None => panel,
        }
    }

    /// Which rows count, for a title.
    fn rows(&self) -> &'static str {
        if self.held_out_by().is_some() { " of the held-out rows" } else { "" }
    }

    fn empty(&self, y: &str) -> Panel {
        Panel::new(time_axis(self.problem), Axis::new(y))
    }
}

/// An axis that shows all values, and of their band what is near: a wide P0 would leave little room for the rest.
fn of_course(axis: Axis, values: impl Iterator<Item = f64>, band: &Envelope) -> Axis {
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        let usable = values.filter(|v| v.abs() < 1e300);
        usable.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let [low, high] = ends(&mut values.into_iter());
    // Where the band settles: its width is below three times the median one in all but the first rows.
    let mut widths: Vec<f64> = band.band().map(|(_, [low, high])| high - low).filter(|w| w.is_finite()).collect();
    widths.sort_by(f64::total_cmp);
    let settled = 3.0 * widths.get(widths.len() / 2).copied().unwrap_or(f64::INFINITY);
    let near = band.band().map(|(_, edges)| edges).filter(|[low, high]| high - low <= settled);
    let [band_low, band_high] = ends(&mut near.flatten());
    let (low, high) = (low.min(band_low), high.max(band_high));
    let room = 0.05 * (high - low);
    // Constant values, or none, are left to the axis.
    if room > 1e-9 * low.abs().max(high.abs()) && room < 1e299 { axis.range(low - room, high + room) } else { axis }
}

/// The value that one in twenty of the positive ones is below; infinite if there is none.
fn lowest_usual(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|v| (1e-300..1e300).contains(v)).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 20).copied().unwrap_or(f64::INFINITY)
}

/// Errors but for the few far beyond all others, as those of a wrong x0 are in the first rows.
fn without_outliers(mut errors: Vec<f64>) -> Vec<f64> {
    errors.retain(|error| error.abs() < 1e300);
    errors.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let usual = errors.get(errors.len() * 95 / 100).map_or(0.0, |error| error.abs());
    errors.retain(|error| error.abs() <= 5.0 * usual);
    errors
}

/// `nile: innovations`, after the problem file's name.
#[must_use]
pub fn titled(problem: &Problem, what: &str) -> String {
    let name = std::path::Path::new(&problem.source).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    match name.filter(|name| !name.is_empty()) {
        Some(name) => format!("{name}: {what}"),
        None => what.to_owned(),
    }
}

/// Time: a column named after it is in seconds, and one such as `year` or `k` counts what its name says.
fn time_axis(problem: &Problem) -> Axis {
    match (problem.data.time.as_deref(), problem.data.time_unit) {
        (Some(column), Some(unit)) if column != unit.counted() => return Axis::new(column).unit(unit.counted()),
        _ => {}
    }
    match problem.data.time.as_deref() {
        None => Axis::new("row"),
        Some("t" | "time" | "T" | "Time") => Axis::new("time").unit("s"),
        Some(column) if column.to_lowercase().starts_with("time") => Axis::new(column).unit("s"),
        Some(column) => Axis::new(column),
    }
}
