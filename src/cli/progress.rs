//! The progress bar of a study: best cost, evaluations a second, time left.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::console::Console;
use crate::report::{count, significant};

/// A bar over generations, or nothing where nobody watches.
#[derive(Debug)]
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    objective: String,
    started: Instant,
}

impl Progress {
    /// `generations` after the initial one; `objective` names the first cost.
    pub(super) fn new(console: Console, generations: usize, objective: String) -> anyhow::Result<Self> {
        let bar = console.shows_progress().then(|| draw(generations)).transpose()?;
        Ok(Self { bar, objective, started: Instant::now() })
    }

    /// After a generation: the best first cost so far and the evaluations so far.
    pub(super) fn update(&self, generation: usize, evaluations: u64, best: Option<f64>) {
        let Some(bar) = &self.bar else { return };
        bar.set_position(generation as u64);
        let rate = evaluations as f64 / self.started.elapsed().as_secs_f64().max(1e-9);
        let best = best.map_or_else(|| "none usable yet".to_owned(), |cost| significant(cost, 8));
        bar.set_message(format!("best {} {best}, {} evaluations/s", self.objective, count(rate as u64)));
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
    let style = ProgressStyle::with_template("{bar:24} generation {pos}/{len}  {msg}  {eta} left")?;
    let bar = ProgressBar::with_draw_target(Some(generations as u64), ProgressDrawTarget::stderr());
    bar.set_style(style);
    Ok(bar)
}
