//! The gate: a row of NIS below its threshold updates, any other is left out.

use super::Seen;
use crate::model::Robust;
use crate::tape::{Graph, Id};

/// Whether a kind counts the rows that it has rejected last.
pub(super) const fn counts(robust: &Robust) -> bool {
    matches!(robust, Robust::Gate { limit, .. } if *limit > 0)
}

/// 1 where a row updates, else 0. `memory` holds the number of measured rows rejected since the last one that updated: after
/// `limit` of them the next one updates whatever its NIS, for then the filter is lost more likely than all of them are wrong.
pub(super) fn accepted(g: &mut Graph, seen: &Seen, limit: usize, memory: &mut [Id]) -> Id {
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let below = g.sub(seen.settings[0], seen.nis);
    let inside = g.select(below, one, zero);
    let Some(rejected) = memory.first_mut() else { return inside };
    #[expect(clippy::cast_precision_loss, reason = "a limit is a small number")]
    let limit = g.constant(limit as f64);
    let patience = g.sub(limit, *rejected);
    let accepted = g.select(patience, inside, one);
    let more = g.add(*rejected, one);
    let counted = g.select(accepted, zero, more);
    *rejected = g.select(seen.any, counted, *rejected);
    accepted
}
