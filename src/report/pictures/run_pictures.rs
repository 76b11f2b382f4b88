//! The pictures of one filter run.

use super::extent::{hides_the_rest, lowest_usual, of_course, without_outliers};
use super::plan::MOST;
use super::run_record::RunRecord;
use super::track::{MeasurementSeries, StateSeries, Track};
use crate::chart::{Axis, Colour, Dash, Envelope, Figure, Marker, Panel, Stroke};
use crate::data::{Log, Origin, SplitBy};
use crate::model::{Mode, Problem};
use crate::report::{Whiteness, count, significant};

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
        let mut panel = Panel::new(time_axis(self.problem, self.log), axis);
        panel = panel.band("3-sigma band", Colour::Blue, series.band.band());
        if let Some(measurement) = measurement {
            panel = panel.points(&measured_label(&measurement.measured), MEASURED, measurement.measured.points());
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
        Panel::new(time_axis(self.problem, self.log), axis)
            .band("3-sigma band", Colour::Blue, series.predicted_band.band())
            .points(&measured_label(&series.measured), MEASURED, series.measured.points())
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
            let share = significant(series.within.per_cent(), 3);
            let panel =
                Panel::new(time_axis(self.problem, self.log), of_course(axis, errors.into_iter(), &series.deviation))
                    .title(format!("{share} % of {} within 3 standard deviations", self.rows_of(series.within.rows)));
            let band = "± 3 standard deviations";
            let panel = match &series.error_fan {
                Some(fan) => edges(fan.draw(panel, true), band, &series.deviation),
                None => panel.band(band, Colour::Blue, series.deviation.band()).line(
                    "estimate minus truth",
                    ESTIMATE,
                    series.error.line(),
                ),
            };
            panel.horizontal("", Stroke::new(Colour::Grey).width(1.0), 0.0)
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
        // One picture has one kind of axis.
        let normalised = track.measurements.iter().any(hides_the_rest);
        let panels = self.log.measurements.iter().zip(&track.measurements);
        let panels = panels.map(|(name, series)| self.innovation(name, series, normalised));
        figure.panels(panels.map(|panel| self.with_boundary(panel)))
    }

    /// Innovations of one measurement; divided by sqrt(S) where `normalised`.
    fn innovation(&self, name: &str, series: &MeasurementSeries, normalised: bool) -> Panel {
        let (values, fan) = match normalised {
            true => (&series.normalised, &series.normalised_fan),
            false => (&series.innovation, &series.fan),
        };
        let share = significant(series.within.per_cent(), 3);
        let title =
            format!("{share} % of {} within 2 sqrt(S), of a right filter 95 %", self.rows_of(series.within.rows));
        let points = values.points().map(|point| point.1);
        let axis = Axis::new(format!("innovation of {name}{}", if normalised { " / √S" } else { "" }));
        let axis = if normalised { axis.including(-2.5).including(2.5) } else { of_course(axis, points, &series.band) };
        let mut panel = Panel::new(time_axis(self.problem, self.log), axis).title(title);
        if !normalised && fan.is_none() {
            panel = panel.band("± 2 sqrt(S)", Colour::Blue, series.band.band());
        }
        panel = match fan {
            Some(fan) => fan.draw(panel, true),
            None => panel.points("innovation", (Marker::Dot, Colour::Black), values.points()),
        };
        panel = match (normalised, fan) {
            (true, _) => panel.horizontal("± 2", LIMIT, 2.0).horizontal("", LIMIT, -2.0),
            (false, Some(_)) => edges(panel, "± 2 sqrt(S)", &series.band),
            (false, None) => panel,
        };
        panel.horizontal("", Stroke::new(Colour::Grey).width(1.0), 0.0)
    }

    /// The course over the plane, where two states are a place; `None` where none are.
    #[must_use]
    pub fn plan(&self) -> Option<Figure> {
        let plan = self.track()?.plan.as_ref()?;
        Some(plan.draw(self.figure("track from above"), self.problem, [TRUTH, SMOOTHED]))
    }

    /// The probability of each mode over time; `None` for a filter of one model.
    #[must_use]
    pub fn modes(&self) -> Option<Figure> {
        let track = self.track().filter(|track| !track.modes.is_empty())?;
        let panel = |(mode, series): (&Mode, &Envelope)| {
            let axis = Axis::new(format!("p of {}", mode.name)).including(0.0).including(1.0);
            let panel = Panel::new(time_axis(self.problem, self.log), axis);
            self.with_boundary(panel.line("probability", ESTIMATE, series.line()))
        };
        let figure = self.figure("probabilities of the modes");
        Some(figure.panels(self.problem.modes.iter().zip(&track.modes).take(MOST).map(panel)))
    }

    /// NIS over time with the band that holds 95 % of it if the filter is right.
    #[must_use]
    pub fn nis(&self) -> Figure {
        let nis = self.nis;
        let mean = significant(nis.sum / nis.components.max(1) as f64, 3);
        let inside = 100.0 * nis.inside as f64 / nis.rows.max(1) as f64;
        let figure = self.figure("NIS").size(760.0, 260.0);
        let axis = Axis::new("NIS").log();
        let Some(track) = self.track().filter(|_| nis.rows > 0) else { return figure.panel(self.empty("NIS")) };
        // The lowest NIS of a long log tell nothing, but would take most of the height; where most are below the band
        // they are what there is to see.
        let low = track.nis_band.band().map(|(_, [low, _])| low).fold(f64::INFINITY, f64::min) / 30.0;
        let low = low.min(match &track.nis_fan {
            Some(fan) => lowest_usual(fan.values()),
            None => lowest_usual(track.nis.line().map(|(_, nis)| nis)) / 2.0,
        });
        let high = track.nis_band.band().map(|(_, [_, high])| high).fold(f64::NEG_INFINITY, f64::max);
        let high = track.nis.line().map(|(_, nis)| nis).filter(|nis| nis.is_finite()).fold(high, f64::max) * 1.5;
        let axis = if 0.0 < low && low < high && high < 1e300 { axis.range(low, high) } else { axis };
        let panel = Panel::new(time_axis(self.problem, self.log), axis)
            .title(format!("mean {mean} a component; {inside:.1} % of {} in the band", self.rows_of(nis.rows)));
        let panel = match &track.nis_fan {
            Some(fan) => edges(fan.draw(panel, false), "95 % band", &track.nis_band),
            None => panel.band("95 % band", Colour::Blue, track.nis_band.band()).points(
                "NIS",
                (Marker::Dot, Colour::Black),
                track.nis.points(),
            ),
        };
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

    /// "1 200 held-out rows", for a title.
    fn rows_of(&self, rows: usize) -> String {
        let held_out = if self.held_out_by().is_some() { "held-out " } else { "" };
        format!("{} {held_out}{}", count(rows as u64), if rows == 1 { "row" } else { "rows" })
    }

    /// Which rows count, for a title.
    fn rows(&self) -> &'static str {
        if self.held_out_by().is_some() { " of the held-out rows" } else { "" }
    }

    fn empty(&self, y: &str) -> Panel {
        Panel::new(time_axis(self.problem, self.log), Axis::new(y))
    }
}

/// The edges of a band as lines, for where areas stand for something else.
fn edges(panel: Panel, label: &str, band: &Envelope) -> Panel {
    // References run on through gaps in time.
    let rows = || band.band().filter(|(time, _)| !time.is_nan());
    let [low, high] = [0, 1].map(|i| rows().map(move |(time, edges)| (time, edges[i])));
    panel.line(label, LIMIT, high).line("", LIMIT, low)
}

/// "measured", or what of it a picture can hold.
fn measured_label(series: &Envelope) -> String {
    match series.every() {
        1 => "measured".to_owned(),
        every => format!("measured, the extremes of every {} rows", count(every as u64)),
    }
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

/// Epochs in seconds, from 2001 to 2128. A smaller number, such as a year, is what its column says.
const EPOCHS: std::ops::Range<f64> = 1e9..5e9;

/// Time: a column named after it is in seconds, and one such as `year` or `k` counts what its name says. What has a date is
/// shown with it.
fn time_axis(problem: &Problem, log: &Log) -> Axis {
    let axis = match (problem.data.time.as_deref(), problem.data.time_unit) {
        (Some(column), Some(unit)) if column != unit.counted() => Axis::new(column).unit(unit.counted()),
        (time, _) => named_axis(time),
    };
    match (zero_of(log), log.times.unit.seconds()) {
        (Some(zero), Some(unit)) => axis.instants(zero, unit),
        _ => axis,
    }
}

/// Seconds from 1970 to time 0 of a log; `None` where its times are no dates.
fn zero_of(log: &Log) -> Option<f64> {
    let epoch = |number: f64, zero: f64| {
        let seconds = number * 10.0_f64.powi(-log.times.unit.decimals());
        EPOCHS.contains(&seconds).then_some(zero)
    };
    match &log.times.origin {
        Origin::Instant(first) => Some(first.as_duration().as_secs_f64()),
        Origin::Number(first) => {
            let number = first.parse().ok()?;
            epoch(number, number * 10.0_f64.powi(-log.times.unit.decimals()))
        }
        Origin::Zero => epoch(*log.trajectories.first()?.time.first()?, 0.0),
        Origin::TimeOfDay(_) => None,
    }
}

/// The axis of a time column without a unit of its own.
fn named_axis(column: Option<&str>) -> Axis {
    match column {
        None => Axis::new("row"),
        Some("t" | "time" | "T" | "Time") => Axis::new("time").unit("s"),
        Some(column) if column.to_lowercase().starts_with("time") => Axis::new(column).unit("s"),
        Some(column) => Axis::new(column),
    }
}
