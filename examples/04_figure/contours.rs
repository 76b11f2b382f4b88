//! The cost around the optimum, as closed curves.
//!
//! A curve is drawn by bisection: in every direction from the optimum, the distance at which the cost has risen by a given
//! amount. All directions are one population.

use std::f64::consts::TAU;

use kfgpu::evaluate::{CpuEvaluator, Evaluator, Population};
use kfgpu::study::Outcome;
use plotters::prelude::*;

use super::{Area, Failure, font, grey};

/// Rise of the nll, half the chi-square quantile of two degrees of freedom; the share it stands for; a shade.
const REGIONS: [(f64, &str, u8); 3] = [(5.915, "99.7 %", 225), (3.09, "95 %", 195), (1.148, "68 %", 160)];
const DIRECTIONS: usize = 180;
/// Farthest point looked at, in decades along (sigma2_eps, sigma2_eta).
const REACH: [f64; 2] = [0.6, 2.8];

/// The curve around `centre` on which the cost is `level`.
fn curve(evaluator: &mut CpuEvaluator, centre: &[f64], level: f64) -> Vec<(f64, f64)> {
    let mut brackets = [[0.0, 1.0]; DIRECTIONS];
    let at = |direction: usize, share: f64| {
        let (sin, cos) = (TAU * direction as f64 / DIRECTIONS as f64).sin_cos();
        [(cos * REACH[0], centre[0]), (sin * REACH[1], centre[1])].map(|(decades, c)| c * 10f64.powf(share * decades))
    };
    for _ in 0..30 {
        let middles: Vec<f64> = brackets.iter().map(|[low, high]| f64::midpoint(*low, *high)).collect();
        let rows = middles.iter().enumerate().flat_map(|(i, middle)| at(i, *middle)).collect();
        let costs = evaluator.evaluate(&Population::from_rows(2, rows));
        for (i, middle) in middles.iter().enumerate() {
            brackets[i][usize::from(costs.costs(i)[0] > level)] = *middle;
        }
    }
    brackets.iter().enumerate().map(|(i, [low, _])| at(i, *low).into()).collect()
}

/// Regions of the two variances that the log does not tell apart, with the start and the tuned values.
pub(super) fn draw(area: &Area<'_>, evaluator: &mut CpuEvaluator, outcome: &Outcome) -> Result<(), Failure> {
    let winner = outcome.winner.as_ref().ok_or("every candidate failed")?;
    let mut chart = ChartBuilder::on(area)
        .caption("What the log says of the variances", font(19))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(62)
        .build_cartesian_2d((5e3..3.6e4).log_scale(), (2e1..2e4).log_scale())?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("sigma2_eps: measurement noise [(1e8 m³)²]")
        .y_desc("sigma2_eta: level, a year [(1e8 m³)²]")
        .label_style(font(14))
        .axis_desc_style(font(15))
        .x_label_formatter(&|v| format!("{v:.0}"))
        .y_label_formatter(&|v| format!("{v:.0}"))
        .draw()?;
    for (rise, share, shade) in REGIONS {
        let region = curve(evaluator, &winner.candidate, winner.objectives[0] + rise);
        let fill = grey(shade).filled();
        chart
            .draw_series([Polygon::new(region, fill)])?
            .label(format!("{share} region"))
            .legend(move |(x, y)| Rectangle::new([(x, y - 6), (x + 22, y + 6)], fill));
    }
    let point = |candidate: &[f64]| (candidate[0], candidate[1]);
    chart
        .draw_series([Cross::new(point(&outcome.baseline.candidate), 6, BLACK.stroke_width(2))])?
        .label("start")
        .legend(|(x, y)| Cross::new((x + 11, y), 5, BLACK.stroke_width(2)));
    chart
        .draw_series([Circle::new(point(&winner.candidate), 4, BLACK.filled())])?
        .label("tuned")
        .legend(|(x, y)| Circle::new((x + 11, y), 4, BLACK.filled()));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .label_font(font(14))
        .background_style(WHITE)
        .border_style(grey(150))
        .draw()?;
    Ok(())
}
