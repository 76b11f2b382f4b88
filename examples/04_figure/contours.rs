//! The cost around the optimum, as regions of the two variances.

use kfgpu::chart::{Axis, Colour, Grid, Marker, Panel};
use kfgpu::evaluate::{CpuEvaluator, Evaluator, Population};
use kfgpu::study::{Outcome, Winner};

/// Rise of the nll, half the chi-square quantile of two degrees of freedom; the share it stands for; a grey.
const REGIONS: [(f64, &str, u8); 3] = [(5.915, "99.7 %", 225), (3.09, "95 %", 195), (1.148, "68 %", 160)];
/// What is shown of (sigma2_eps, sigma2_eta).
const SHOWN: [[f64; 2]; 2] = [[5e3, 3.6e4], [2e1, 2e4]];
/// Values along each.
const VALUES: usize = 121;

/// Regions of the two variances that the log does not tell apart, with the start and the tuned values.
pub(super) fn panel(evaluator: &mut CpuEvaluator, outcome: &Outcome, winner: &Winner) -> Panel {
    let costs = grid(evaluator);
    let axis = |name: &str, [low, high]: [f64; 2]| Axis::new(name).unit("(1e8 m³)²").log().range(low, high);
    let mut panel = Panel::new(axis("sigma2_eps: measurement", SHOWN[0]), axis("sigma2_eta: level, a year", SHOWN[1]))
        .title("What the log says of the variances");
    for (rise, share, grey) in REGIONS {
        panel = panel.region(&format!("{share} region"), grey, costs.region(winner.objectives[0] + rise));
    }
    let point = |candidate: &[f64]| [(candidate[0], candidate[1])];
    panel.points("start", (Marker::Cross, Colour::Black), point(&outcome.baseline.candidate)).points(
        "tuned",
        (Marker::Disc, Colour::Black),
        point(&winner.candidate),
    )
}

/// The cost of every pair of values, evenly spaced in their logarithms, as one population.
fn grid(evaluator: &mut CpuEvaluator) -> Grid {
    let [x, y] = SHOWN.map(|[low, high]| {
        let share = |i: usize| i as f64 / (VALUES - 1) as f64;
        (0..VALUES).map(|i| low * (high / low).powf(share(i))).collect::<Vec<_>>()
    });
    let rows = y.iter().flat_map(|y| x.iter().flat_map(|x| [*x, *y])).collect();
    let costs = evaluator.evaluate(&Population::from_rows(2, rows));
    let values = (0..costs.len()).map(|i| costs.costs(i)[0]).collect();
    Grid::new(x, y, values)
}
