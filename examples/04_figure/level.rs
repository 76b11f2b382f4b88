//! Flow, filtered level and its band.

use kfgpu::data::Log;
use kfgpu::reference::Run;
use plotters::prelude::*;

use super::{Area, Failure, font, grey};

/// The posterior level of every year with plus and minus three of its standard deviations.
pub(super) fn draw(area: &Area<'_>, log: &Log, run: &Run) -> Result<(), Failure> {
    let (flow, steps) = (&log.trajectories[0], &run.trajectories[0]);
    let mut chart = ChartBuilder::on(area)
        .caption("The Nile at Aswan: flow and tuned level", font(19))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(62)
        .build_cartesian_2d(1869.0..1972.0, 400.0..1650.0)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("year")
        .y_desc("flow [1e8 m³ a year]")
        .label_style(font(14))
        .axis_desc_style(font(15))
        .x_labels(6)
        .y_labels(6)
        .x_label_formatter(&|year| format!("{year:.0}"))
        .y_label_formatter(&|flow| format!("{flow:.0}"))
        .draw()?;

    let edge =
        |sign: f64| steps.iter().map(move |s| (s.time, s.posterior.x[0] + sign * 3.0 * s.posterior.p[(0, 0)].sqrt()));
    let lower: Vec<(f64, f64)> = edge(-1.0).collect();
    let outline: Vec<(f64, f64)> = edge(1.0).chain(lower.into_iter().rev()).collect();
    let shade = grey(215).filled();
    chart
        .draw_series([Polygon::new(outline, shade)])?
        .label("3-sigma band of the level")
        .legend(move |(x, y)| Rectangle::new([(x, y - 6), (x + 22, y + 6)], shade));
    let dot = |at| Circle::new(at, 2, grey(90).filled());
    chart
        .draw_series((0..flow.len()).map(|k| dot((flow.time[k], flow.z.row(k)[0]))))?
        .label("measured flow")
        .legend(|(x, y)| Circle::new((x + 11, y), 2, grey(90).filled()));
    let line = BLACK.stroke_width(2);
    chart
        .draw_series(LineSeries::new(steps.iter().map(|s| (s.time, s.posterior.x[0])), line))?
        .label("level, filtered")
        .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], line));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .label_font(font(14))
        .background_style(WHITE)
        .border_style(grey(150))
        .draw()?;
    Ok(())
}
