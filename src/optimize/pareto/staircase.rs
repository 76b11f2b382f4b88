//! The lower left edge of a growing set of points in the plane.

use std::cmp::Ordering;
use std::collections::BTreeMap;

/// A cost that is never NaN, as a key.
#[derive(Debug, Clone, Copy)]
struct Cost(f64);

impl PartialEq for Cost {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cost {}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cost {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Of points of one front, without their first cost, those that are not right of and above a later one: second cost to
/// third, one rising while the other falls.
#[derive(Debug, Default)]
pub(super) struct Staircase {
    steps: BTreeMap<Cost, f64>,
}

impl Staircase {
    /// Whether a stored point is nowhere above `[x, y]`: of those not right of it, the nearest is the lowest.
    pub(super) fn dominates(&self, x: f64, y: f64) -> bool {
        self.steps.range(..=Cost(x)).next_back().is_some_and(|(_, lowest)| *lowest <= y)
    }

    /// Adds a point that no stored one dominates.
    pub(super) fn insert(&mut self, x: f64, y: f64) {
        while let Some((right, _)) = self.steps.range(Cost(x)..).next().filter(|(_, above)| **above >= y) {
            let right = *right;
            self.steps.remove(&right);
        }
        self.steps.insert(Cost(x), y);
    }
}
