//! Flow, filtered level and its band.

use kfgpu::chart::{Axis, Colour, Marker, Panel, Stroke};
use kfgpu::data::Log;
use kfgpu::reference::Run;

/// The posterior level of every year with plus and minus three of its standard deviations.
pub(super) fn panel(log: &Log, run: &Run) -> Panel {
    let (flow, steps) = (&log.trajectories[0], &run.trajectories[0]);
    let band = steps.iter().map(|s| {
        let (level, deviation) = (s.posterior.x[0], s.posterior.p[(0, 0)].sqrt());
        (s.time, [level - 3.0 * deviation, level + 3.0 * deviation])
    });
    Panel::new(Axis::new("year"), Axis::new("flow").unit("1e8 m³ a year"))
        .title("Flow and tuned level")
        .band("3-sigma band of the level", Colour::Black, band)
        .points("measured flow", (Marker::Dot, Colour::Grey), flow.time.iter().copied().zip(flow.z.column(0)))
        .line("level, filtered", Stroke::new(Colour::Black), steps.iter().map(|s| (s.time, s.posterior.x[0])))
}
