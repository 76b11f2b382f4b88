//! The cost around the winner: levels over two parameters, or a slice along each.

use super::contour::Grid;
use super::convergence::{cost_axis, is_wide};
use super::run_pictures::titled;
use super::{Axis, Colour, Dash, Figure, Marker, Panel, Stroke};
use crate::evaluate::{Evaluator, Population};
use crate::model::{Parameter, Problem, Scale, Search};
use crate::report::significant;

const WINNER: (Marker, Colour) = (Marker::Disc, Colour::Black);
const BASELINE: (Marker, Colour) = (Marker::Cross, Colour::Red);
/// Most parameters that get a slice.
const MOST: usize = 12;
/// Shares of the grid's values at or below the levels drawn, and the greys of the areas between them.
const LEVELS: [(f64, u8); 6] = [(0.6, 205), (0.35, 218), (0.18, 229), (0.08, 239), (0.025, 247), (0.006, 255)];
/// The grey above all levels.
const ABOVE: u8 = 190;

/// The first objective around the winner, from at most about `evaluations` candidates: with two searched parameters its
/// levels, otherwise slices that change one parameter and leave the others at the winner's values. What is shown holds
/// the baseline.
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
    let title = titled(problem, &format!("{objective} around the tuned parameters"));
    if let [x, y] = &ranges[..] {
        let side = (evaluations as f64).sqrt().clamp(8.0, 64.0) as usize;
        let rows = y.values(side).into_iter().flat_map(|y| x.values(side).into_iter().flat_map(move |x| [x, y]));
        let costs = costs(evaluator, Population::from_rows(2, rows.collect()));
        let panel = contours([x, y], &Grid::new(x.values(side), y.values(side), costs), objective);
        return Figure::new(title).size(680.0, 420.0).panel(marked(panel, winner, baseline));
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
        let costs = costs(evaluator, Population::from_rows(winner.len(), rows.collect()));
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

    fn axis(&self) -> Axis {
        let axis = Axis::new(&self.name).log_if(self.log);
        match &self.unit {
            Some(unit) => axis.unit(unit),
            None => axis,
        }
    }

    fn slice(&self, objective: &str, points: Vec<(f64, f64)>) -> Panel {
        let wide = is_wide(points.iter().map(|p| p.1));
        Panel::new(self.axis(), cost_axis(objective).log_if(wide))
            .line("cost, other parameters as tuned", Stroke::new(Colour::Black), points)
            .vertical("tuned", Stroke::new(Colour::Blue), self.winner)
            .vertical("baseline", Stroke::dashed(Colour::Red, Dash::Dashed).width(1.6), self.baseline)
    }
}

/// Grey areas, lighter towards the best, with lines between them.
fn contours([x, y]: [&Range; 2], grid: &Grid, objective: &str) -> Panel {
    let mut sorted: Vec<f64> = grid.values().iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied();
    let levels: Vec<(f64, u8)> = LEVELS.iter().filter_map(|(share, grey)| Some((at(*share)?, *grey))).collect();
    let texts = distinct(&levels);
    let [left, right, low, high] = [x.low, x.high, y.low, y.high];
    let all = vec![vec![(left, low), (right, low), (right, high), (left, high)]];
    let unit = if objective == "nll" { " nats" } else { "" };
    let mut panel = Panel::new(x.axis().range(left, right), y.axis().range(low, high));
    let least = texts.first().map_or_else(String::new, |text| format!("above {text}{unit}"));
    panel = panel.region(&least, ABOVE, all);
    for ((level, grey), text) in levels.iter().zip(texts) {
        panel = panel.region(&format!("≤ {text}{unit}"), *grey, grid.region(*level));
    }
    for (level, _) in &levels {
        panel = panel.line("", Stroke::new(Colour::Grey).width(0.8), grid.line(*level));
    }
    panel
}

/// Levels as text with as many digits as tell them apart.
fn distinct(levels: &[(f64, u8)]) -> Vec<String> {
    let texts = |digits| levels.iter().map(|(level, _)| significant(*level, digits)).collect::<Vec<_>>();
    let differ = |texts: &Vec<String>| texts.windows(2).all(|pair| pair[0] != pair[1]);
    (4..10).map(texts).find(differ).unwrap_or_else(|| texts(10))
}

fn marked(panel: Panel, winner: &[f64], baseline: &[f64]) -> Panel {
    panel.points("baseline", BASELINE, [(baseline[0], baseline[1])]).points("tuned", WINNER, [(winner[0], winner[1])])
}
