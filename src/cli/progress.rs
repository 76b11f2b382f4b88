//! The progress bar of a study: best cost, evaluations a second, time left.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::console::Console;
use crate::model::TuneSpec;
use crate::number::significant;
use crate::objective::Objective;
use crate::study::{Generation, Observer, Scored};

/// A bar over generations, or nothing where nobody watches.
#[derive(Debug)]
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    /// Name of the first cost.
    objective: &'static str,
}

impl Progress {
    pub(super) fn new(console: Console, tune: &TuneSpec) -> anyhow::Result<Self> {
        let bar = console.shows_progress().then(|| draw(tune.generations)).transpose()?;
        let objective = tune.objectives.first().map_or("cost", Objective::name);
        Ok(Self { bar, objective })
    }
}

impl Observer for Progress {
    fn generation(&mut self, row: &Generation, _best: Option<&Scored>) {
        let Some(bar) = &self.bar else { return };
        let rate = row.evaluations as f64 / row.seconds.max(1e-9);
        let best = row.best.map_or_else(|| "none usable yet".to_owned(), |cost| significant(cost, 7));
        let front = row.front.map_or_else(String::new, |members| format!(", front of {members}"));
        bar.set_message(format!("best {} {best}{front}, {} evaluations/s", self.objective, significant(rate, 3)));
        bar.set_position(row.generation as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn draw(generations: usize) -> anyhow::Result<ProgressBar> {
    let style = ProgressStyle::with_template("{bar:16} {pos}/{len} {eta} left  {wide_msg}")?;
    let bar = ProgressBar::with_draw_target(Some(generations as u64), ProgressDrawTarget::stderr());
    bar.set_style(style);
    Ok(bar)
}
