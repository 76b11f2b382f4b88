//! Pictures of a Pareto front.

use super::convergence::{cost_axis, is_wide};
use crate::chart::{Axis, Colour, Dash, Figure, Marker, Panel, Stroke};
use crate::model::{Parameters, Scale};

const MEMBER: (Marker, Colour) = (Marker::Circle, Colour::Black);
const KNEE: (Marker, Colour) = (Marker::Diamond, Colour::Red);
const RECOMMENDED: (Marker, Colour) = (Marker::Ring, Colour::Grey);
const BASELINE: (Marker, Colour) = (Marker::Cross, Colour::Black);
const ENDS: [(Marker, Colour); 4] = [
    (Marker::Triangle, Colour::Blue),
    (Marker::Square, Colour::Blue),
    (Marker::Triangle, Colour::Amber),
    (Marker::Square, Colour::Amber),
];
/// Where the baseline would take more than this many times the room of the front, it is named and not drawn.
const FAR: f64 = 6.0;

/// A front as its pictures need it.
#[derive(Debug, Clone, Copy)]
pub struct FrontPicture<'a> {
    /// Title of the picture.
    pub title: &'a str,
    /// Names of the objectives.
    pub objectives: &'a [&'a str],
    /// Objectives of each member.
    pub members: &'a [&'a [f64]],
    /// Index of the knee.
    pub knee: Option<usize>,
    /// Index of the member that is recommended.
    pub recommended: Option<usize>,
    /// Objectives of the user's own candidate.
    pub baseline: Option<&'a [f64]>,
}

impl FrontPicture<'_> {
    /// Objective against objective, one panel a pair, with the ends, the knee and the baseline marked. Members that lack
    /// an objective are left out of its panels.
    #[must_use]
    pub fn scatter(&self) -> Figure {
        let n = self.objectives.len();
        let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))).collect();
        let (columns, size) = match pairs.len() {
            0 | 1 => (1, (620.0, 400.0)),
            2..=4 => (2, (860.0, 260.0)),
            _ => (3, (1080.0, 240.0)),
        };
        let figure = Figure::new(self.title).columns(columns).size(size.0, size.1);
        if pairs.is_empty() {
            return figure.panel(Panel::new(cost_axis(self.objectives.first().unwrap_or(&"cost")), Axis::new("")));
        }
        figure.panels(pairs.into_iter().map(|(i, j)| self.pair(i, j)))
    }

    fn pair(&self, i: usize, j: usize) -> Panel {
        let at = |costs: &[f64]| Some((*costs.get(i)?, *costs.get(j)?));
        let points: Vec<(f64, f64)> = self.members.iter().filter_map(|member| at(member)).collect();
        let baseline = self.baseline.and_then(at);
        let is_near = baseline
            .is_some_and(|(x, y)| !is_far(points.iter().map(|p| p.0), x) && !is_far(points.iter().map(|p| p.1), y));
        let shown = points.iter().copied().chain(baseline.filter(|_| is_near));
        let shown: Vec<(f64, f64)> = shown.collect();
        let axis = |k: usize, values: Vec<f64>| cost_axis(self.objectives[k]).log_if(is_wide(values.into_iter()));
        let x = axis(i, shown.iter().map(|p| p.0).collect());
        let y = axis(j, shown.iter().map(|p| p.1).collect());
        let mut panel = Panel::new(x, y).points("front", MEMBER, points);
        let member = |i: Option<usize>| i.and_then(|i| at(self.members.get(i)?));
        if self.recommended.is_some() {
            panel = panel.points("recommended", RECOMMENDED, member(self.recommended));
        }
        for (k, mark) in ENDS.iter().enumerate().take(self.objectives.len()) {
            let end = self.end(k).and_then(|end| at(self.members[end]));
            panel = panel.points(&format!("best {}", self.objectives[k]), *mark, end);
        }
        if self.knee.is_some() {
            panel = panel.points("knee", KNEE, member(self.knee));
        }
        match baseline {
            Some(_) if is_near => panel.points("baseline", BASELINE, baseline),
            Some((x, y)) => {
                let digits = |v| crate::number::significant(v, 4);
                panel.points(&format!("baseline, far outside at ({}, {})", digits(x), digits(y)), BASELINE, [])
            }
            None => panel,
        }
    }

    /// The member with the smallest objective `k`.
    fn end(&self, k: usize) -> Option<usize> {
        let costs = self.members.iter().enumerate().filter_map(|(i, member)| Some((i, *member.get(k)?)));
        costs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    }

    /// The candidates behind the front: one line a member across all parameters, each as its share of the searched
    /// range, and on across the objectives, each as its share of the front's. The ends, the knee and the baseline stand
    /// out.
    #[must_use]
    pub fn parallel(&self, parameters: &Parameters, candidates: &[&[f64]], baseline: &[f64]) -> Figure {
        let spans = self.spans(parameters, candidates, baseline);
        let line = |candidate: &[f64], costs: Option<&[f64]>| {
            let values = candidate.iter().chain(costs.unwrap_or_default()).zip(&spans).enumerate();
            values.map(|(i, (value, span))| (i as f64, span.share(*value))).collect::<Vec<_>>()
        };
        let member = |i: usize| Some(line(candidates.get(i)?, self.members.get(i).copied()));
        let gap = [(f64::NAN, f64::NAN)];
        let members = (0..candidates.len()).filter_map(member).flat_map(|line| line.into_iter().chain(gap));
        let labels = parameters.names().into_iter().chain(self.objectives.iter().copied()).map(str::to_owned);
        let share = Axis::new("share of the range").range(-0.03, 1.03);
        let mut panel = Panel::new(
            Axis::new("parameters (of the searched range), objectives (of the front)").labels(labels),
            share,
        )
        .line("front", Stroke::new(Colour::Grey).width(0.9), members);
        for k in 0..self.objectives.len() {
            let end = self.end(k).and_then(member);
            let dash = if k % 2 == 0 { Dash::Solid } else { Dash::DashDot };
            let colour = if k < 2 { Colour::Blue } else { Colour::Amber };
            let stroke = Stroke::dashed(colour, dash).width(2.0);
            panel = panel.line(&format!("best {}", self.objectives[k]), stroke, end.unwrap_or_default());
        }
        if let Some(knee) = self.knee.and_then(member) {
            panel = panel.line("knee", Stroke::new(Colour::Red).width(2.2), knee);
        }
        // A baseline far from the front would leave the picture; its objectives stand in the front's own.
        let baseline = line(baseline, self.baseline)
            .into_iter()
            .map(|(i, share)| (i, if (-0.03..=1.03).contains(&share) { share } else { f64::NAN }));
        let panel = panel.line("baseline", Stroke::dashed(Colour::Black, Dash::Dashed).width(1.6), baseline);
        Figure::new(self.title).size(760.0, 280.0).panel(panel)
    }

    /// What each axis of [`Self::parallel`] spans.
    fn spans(&self, parameters: &Parameters, candidates: &[&[f64]], baseline: &[f64]) -> Vec<Span> {
        let everyone = candidates.iter().copied().chain([baseline]);
        let searched = parameters.searched().enumerate().map(|(i, (_, search))| {
            Span::of(search.scale, [search.min, search.max], everyone.clone().filter_map(|c| c.get(i).copied()))
        });
        let costs = (0..self.objectives.len()).map(|k| {
            let values: Vec<f64> = self.members.iter().filter_map(|member| member.get(k).copied()).collect();
            let scale = if is_wide(values.iter().copied()) { Scale::Log } else { Scale::Linear };
            Span::of(scale, [f64::NEG_INFINITY, f64::INFINITY], values.into_iter())
        });
        searched.chain(costs).collect()
    }
}

/// Whether showing `value` too would shrink the values to a small part of the axis.
fn is_far(values: impl Iterator<Item = f64>, value: f64) -> bool {
    let values: Vec<f64> = values.collect();
    let log = is_wide(values.iter().copied().chain([value]));
    let place = |v: f64| if log { v.log10() } else { v };
    let [low, high] = values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(place(*v)), high.max(place(*v))]);
    let room = high - low;
    let beyond = (low - place(value)).max(place(value) - high);
    // NaN is far from everything; a front of one member has no room to compare with.
    !value.is_finite() || (room > 0.0 && beyond > FAR * room)
}

/// The range of one parameter across which candidates are placed.
struct Span {
    scale: Scale,
    low: f64,
    high: f64,
}

impl Span {
    /// The bounds, or what the values span where there are none.
    fn of(scale: Scale, [min, max]: [f64; 2], values: impl Iterator<Item = f64>) -> Self {
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        let [low, high] = [if min.is_finite() { min } else { low }, if max.is_finite() { max } else { high }];
        Self { scale, low, high }
    }

    fn share(&self, value: f64) -> f64 {
        let place = |v: f64| if self.scale == Scale::Log { v.ln() } else { v };
        let width = place(self.high) - place(self.low);
        if width > 0.0 { (place(value) - place(self.low)) / width } else { 0.5 }
    }
}
