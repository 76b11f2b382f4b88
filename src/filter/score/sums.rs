//! What objectives see of the sums of a filter when it has run.

/// What becomes of the total in a slot of the program: `factor * total + offset`, exactly 1 and 0 where the filter computes
/// in the problem's own units; times a candidate's own value, where there is a `power`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sum {
    pub(super) slot: usize,
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) power: Option<Mean>,
}

/// A value that depends on the candidate alone: the total in a slot over the number of rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mean {
    pub(super) slot: usize,
    pub(super) rows: f64,
}

/// The sums of one objective, and over how much they run.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Traced {
    /// In the objective's own order.
    pub(crate) sums: Vec<Sum>,
    /// The objective's count (components, rows), one a trajectory.
    pub(crate) counts: Vec<f64>,
}

impl Traced {
    /// The same with its sums in the slots `of` those that were asked for.
    pub(in crate::filter) fn in_slots(&self, of: &[usize]) -> Self {
        let mean = |mean: Mean| Mean { slot: of[mean.slot], ..mean };
        let sum = |sum: &Sum| Sum { slot: of[sum.slot], power: sum.power.map(mean), ..*sum };
        let sums = self.sums.iter().map(sum).collect();
        Self { sums, counts: self.counts.clone() }
    }
}

/// The totals of a run that one objective reads: of one trajectory, or pooled over all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pools<'a> {
    /// One a slot of the program.
    pub(in crate::filter) totals: &'a [f64],
    /// What [`Objective::of_trajectory`](crate::objective::Objective::of_trajectory) gave, summed over the trajectories.
    pub(in crate::filter) folded: f64,
    pub(in crate::filter) traced: &'a Traced,
}

impl Pools<'_> {
    /// The objective's sum `j`, in the problem's own units.
    pub(crate) fn total(&self, j: usize) -> f64 {
        let Sum { slot, factor, offset, power } = self.traced.sums[j];
        let total = factor * self.totals[slot] + offset;
        power.map_or(total, |Mean { slot, rows }| total * (self.totals[slot] / rows))
    }

    /// Number of sums.
    pub(crate) fn len(&self) -> usize {
        self.traced.sums.len()
    }

    /// What was worked out for each trajectory, summed over them.
    pub(crate) const fn folded(&self) -> f64 {
        self.folded
    }

    /// The objective's count in each trajectory.
    pub(crate) fn counts(&self) -> &[f64] {
        &self.traced.counts
    }

    /// The count, pooled.
    pub(crate) fn count(&self) -> f64 {
        self.traced.counts.iter().sum()
    }
}
