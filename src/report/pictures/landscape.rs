//! The cost around the winner: levels over two parameters, or a slice along each.

mod zoom;

use super::convergence::{cost_axis, is_wide};
use super::run_pictures::titled;
use crate::chart::{Axis, Colour, Dash, Figure, Grid, Marker, Panel, Stroke};
use crate::evaluate::{Evaluator, Population};
use crate::model::{Parameter, Problem, Scale, Search};
use crate::number::{short, significant};

const WINNER: (Marker, Colour) = (Marker::Disc, Colour::Black);
const BASELINE: (Marker, Colour) = (Marker::Cross, Colour::Red);
/// Most parameters that get a slice.
const MOST: usize = 12;
/// Shares of the grid's values at or below the levels drawn, and the greys of the areas between them.
const LEVELS: [(f64, u8); 6] = [(0.6, 205), (0.35, 218), (0.18, 229), (0.08, 239), (0.025, 247), (0.006, 255)];
/// The grey above all levels.
const ABOVE: u8 = 190;
/// How far above the tuned parameters `nll` is shown \[nats\]: wide enough for what the log can tell apart (2 nats are
/// two standard errors of one parameter), and not so wide that an optimum looks flat.
const RISE: f64 = 20.0;
/// Levels of `nll` above the tuned parameters \[nats\], with the greys of [`LEVELS`].
const NATS: [f64; 6] = [40.0, 20.0, 10.0, 5.0, 2.0, 0.5];

/// The first objective around the winner, from at most about `evaluations` candidates: with two searched parameters its
/// levels, otherwise slices that change one parameter and leave the others at the winner's values. What is shown holds
/// the baseline; of `nll`, only where that is within some tens of nats.
#[must_use]
pub fn landscape(
    problem: &Problem,
    winner: &[f64],
    baseline: &[f64],
    evaluations: usize,
    evaluator: &mut dyn Evaluator,
) -> Figure {
    let searched: Vec<_> = problem.parameters.searched().collect();
    let ranges: Vec<Range> = searched
        .iter()
        .zip(winner.iter().zip(baseline))
        .map(|((parameter, search), (winner, baseline))| Range::around(parameter, search, [*winner, *baseline]))
        .collect();
    let objective = problem.tune.objectives.first().map_or("cost", |objective| objective.name());
    let zoomed = objective == "nll";
    let ranges = if zoomed { zoom::narrowed(ranges, winner, baseline, evaluator) } else { ranges };
    let level = if zoomed { costs(evaluator, Population::from_rows(winner.len(), winner.to_vec()))[0] } else { 0.0 };
    let mut above = |rows: Vec<f64>| -> Vec<f64> {
        let found = costs(evaluator, Population::from_rows(winner.len(), rows));
        found.into_iter().map(|cost| cost - level).collect()
    };
    let title = titled(problem, &format!("{objective} around the tuned parameters"));
    if let [x, y] = &ranges[..] {
        let side = (evaluations as f64).sqrt().clamp(8.0, 64.0) as usize;
        let rows = y.values(side).into_iter().flat_map(|y| x.values(side).into_iter().flat_map(move |x| [x, y]));
        let grid = Grid::new(x.values(side), y.values(side), above(rows.collect()));
        let levels = if zoomed { nats() } else { shares(&grid) };
        return Figure::new(title).size(680.0, 420.0).panel(marked(contours([x, y], &grid, &levels), [x, y]));
    }
    let shown = ranges.len().min(MOST);
    let each = (evaluations / shown.max(1)).clamp(9, 81);
    let mut slice = |i: usize| {
        let values = ranges[i].values(each);
        let rows = values.iter().flat_map(|value| {
            let mut row = winner.to_vec();
            row[i] = *value;
            row
        });
        let costs = above(rows.collect());
        ranges[i].slice(objective, values.into_iter().zip(costs).collect())
    };
    let columns = if shown > 1 { 2 } else { 1 };
    Figure::new(title).columns(columns).size(760.0, 180.0).panels((0..shown).map(&mut slice))
}

/// First objectives; NaN where a candidate failed.
fn costs(evaluator: &mut dyn Evaluator, population: Population) -> Vec<f64> {
    let found = evaluator.evaluate(&population);
    (0..found.len()).map(|i| if found.status(i).is_ok() { found.costs(i)[0] } else { f64::NAN }).collect()
}

/// What is shown of one parameter.
struct Range {
    name: String,
    unit: Option<String>,
    log: bool,
    low: f64,
    high: f64,
    winner: f64,
    baseline: f64,
}

impl Range {
    /// Both values with room around them, within the bounds.
    fn around(parameter: &Parameter, search: &Search, [winner, baseline]: [f64; 2]) -> Self {
        let log = search.scale == Scale::Log && winner > 0.0 && baseline > 0.0;
        let place = |v: f64| if log { v.log10() } else { v };
        let [a, b] = [place(winner.min(baseline)), place(winner.max(baseline))];
        let least = if log { 0.5 } else { 0.1 * (search.init[1] - search.init[0]).abs().max(1e-3 * winner.abs()) };
        let room = (0.35 * (b - a)).max(if least > 0.0 { least } else { 1.0 });
        let value = |v: f64| if log { 10f64.powf(v) } else { v };
        let (low, high) = (value(a - room).max(search.min), value(b + room).min(search.max));
        let (name, unit) = (parameter.name.clone(), parameter.unit.clone());
        Self { name, unit, log, low, high, winner, baseline }
    }

    /// So many values from end to end, evenly spaced on the parameter's scale, and within the bounds to the last bit.
    fn values(&self, count: usize) -> Vec<f64> {
        let share = |i: usize| i as f64 / (count.max(2) - 1) as f64;
        let between = |share: f64| {
            let value = if self.log {
                self.low * (self.high / self.low).powf(share)
            } else {
                self.low + share * (self.high - self.low)
            };
            value.max(self.low).min(self.high)
        };
        (0..count).map(|i| between(share(i))).collect()
    }

    /// A value as its place on the parameter's scale.
    fn place(&self, value: f64) -> f64 {
        if self.log { value.log10() } else { value }
    }

    /// The value at a place, within the range.
    fn at(&self, place: f64) -> f64 {
        (if self.log { 10f64.powf(place) } else { place }).max(self.low).min(self.high)
    }

    fn axis(&self) -> Axis {
        let axis = Axis::new(&self.name).log_if(self.log);
        match &self.unit {
            Some(unit) => axis.unit(unit),
            None => axis,
        }
    }

    fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn slice(&self, objective: &str, points: Vec<(f64, f64)>) -> Panel {
        let axis = if objective == "nll" { rise(&points) } else { cost_axis(objective) };
        let wide = objective != "nll" && is_wide(points.iter().map(|p| p.1));
        let outside = format!("the baseline is at {}, outside", short(self.baseline, 4));
        // Where it lies outside, the axis must not follow it.
        let (low, high) = (self.low, self.high);
        Panel::new(self.axis().range(low, high), axis.log_if(wide))
            .title(if self.holds(self.baseline) { "" } else { &outside })
            .line("cost, other parameters as tuned", Stroke::new(Colour::Black), points)
            .vertical("tuned", Stroke::new(Colour::Blue), self.winner)
            .vertical("baseline", Stroke::dashed(Colour::Red, Dash::Dashed).width(1.6), self.baseline)
    }
}

/// An axis for `nll` above that of the tuned parameters, up to what tells of its width; down to what lies below, where the
/// search has stopped short.
fn rise(points: &[(f64, f64)]) -> Axis {
    let axis = Axis::new("nll − tuned").unit("nats");
    let costs = points.iter().map(|p| p.1).filter(|cost| cost.abs() < 1e300);
    let [low, high] = costs.fold([0.0_f64; 2], |[low, high], cost| [low.min(cost), high.max(cost)]);
    let high = high.min(1.5 * RISE);
    let room = 0.05 * (high - low);
    if room > 0.0 { axis.range(low - room, high + room) } else { axis }
}

/// A level of the cost: its value, its grey, and how the legend names what is below it and above.
struct Level {
    value: f64,
    grey: u8,
    below: String,
    above: String,
}

/// Of `nll`: so many nats above the tuned parameters.
fn nats() -> Vec<Level> {
    let level = |(nats, (_, grey)): (f64, (f64, u8))| Level {
        value: nats,
        grey,
        below: format!("≤ {nats}"),
        above: format!("more than {nats} nats above tuned"),
    };
    NATS.into_iter().zip(LEVELS).map(level).collect()
}

/// Of any other cost: such that a share of the picture is below each.
fn shares(grid: &Grid) -> Vec<Level> {
    let mut sorted: Vec<f64> = grid.values().iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied();
    let levels: Vec<(f64, u8)> = LEVELS.iter().filter_map(|(share, grey)| Some((at(*share)?, *grey))).collect();
    let texts = distinct(&levels);
    let level = |((value, grey), text): ((f64, u8), String)| Level {
        value,
        grey,
        below: format!("≤ {text}"),
        above: format!("above {text}"),
    };
    levels.into_iter().zip(texts).map(level).collect()
}

/// Grey areas, lighter towards the best, with lines between them.
fn contours([x, y]: [&Range; 2], grid: &Grid, levels: &[Level]) -> Panel {
    let [left, right, low, high] = [x.low, x.high, y.low, y.high];
    let all = vec![vec![(left, low), (right, low), (right, high), (left, high)]];
    let mut panel = Panel::new(x.axis().range(left, right), y.axis().range(low, high));
    let least = levels.first().map_or("", |level| level.above.as_str());
    panel = panel.region(least, ABOVE, all);
    for level in levels {
        panel = panel.region(&level.below, level.grey, grid.region(level.value));
    }
    for level in levels {
        panel = panel.line("", Stroke::new(Colour::Grey).width(0.8), grid.line(level.value));
    }
    panel
}

/// Levels as text with as many digits as tell them apart.
fn distinct(levels: &[(f64, u8)]) -> Vec<String> {
    let texts = |digits| levels.iter().map(|(level, _)| significant(*level, digits)).collect::<Vec<_>>();
    let differ = |texts: &Vec<String>| texts.windows(2).all(|pair| pair[0] != pair[1]);
    (4..10).map(texts).find(differ).unwrap_or_else(|| texts(10))
}

fn marked(panel: Panel, [x, y]: [&Range; 2]) -> Panel {
    let panel = match x.holds(x.baseline) && y.holds(y.baseline) {
        true => panel.points("baseline", BASELINE, [(x.baseline, y.baseline)]),
        false => {
            let at = format!("baseline, outside at ({}, {})", short(x.baseline, 4), short(y.baseline, 4));
            panel.points(&at, BASELINE, [])
        }
    };
    panel.points("tuned", WINNER, [(x.winner, y.winner)])
}
