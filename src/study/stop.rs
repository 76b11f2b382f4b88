//! When a search stops.

use std::sync::atomic::{AtomicBool, Ordering};

use super::Record;
use crate::model::TuneSpec;

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// The optimiser came to its own end.
    Generations,
    /// Another generation would not fit in the evaluations allowed.
    Evaluations,
    /// The time allowed is over.
    WallTime,
    /// No relative gain of 1e-9, with several objectives in hypervolume, for the number of generations allowed.
    Stall,
    /// The target is reached.
    Target,
    /// Interrupted from outside; what was found so far is kept.
    Interrupted,
}

impl StopReason {
    /// Its name in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Generations => "generations",
            Self::Evaluations => "evaluations",
            Self::WallTime => "wall_time",
            Self::Stall => "stall",
            Self::Target => "target",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Share of the time allowed that the search may take where polish follows: a search stopped there is worth less than the
/// polish that the rest of the time holds.
const SEARCH_SHARE: f64 = 0.75;

/// Why no further generation may start, if so. Looked at between generations only, so a stop never cuts one short; only
/// an interrupt may keep generation 0 from starting.
pub(super) fn reason(tune: &TuneSpec, record: &Record, interrupt: &AtomicBool) -> Option<StopReason> {
    let best = record.archive.best().filter(|best| best.violation <= 0.0).map(|best| best.costs[0]);
    let share = if tune.polish { SEARCH_SHARE } else { 1.0 };
    let reached = |target: f64| best.is_some_and(|best| best <= target);
    if interrupt.load(Ordering::Relaxed) {
        Some(StopReason::Interrupted)
    } else if tune.target.is_some_and(reached) {
        Some(StopReason::Target)
    } else if record.generations() == 0 {
        None
    } else if tune.stall.is_some_and(|limit| record.stalled >= limit) {
        Some(StopReason::Stall)
    } else if tune.wall_time.is_some_and(|limit| record.seconds() >= share * limit) {
        Some(StopReason::WallTime)
    } else {
        None
    }
}
