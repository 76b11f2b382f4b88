//! What each objective sums up in a step of the traced filter, and its cost from the sums. One file a family; the semantics of
//! each stand in `docs/semantics.md`.

mod chi_square;
mod distribution;
mod innovation;
mod likelihood;
mod mismatch;
mod prediction;
mod scoring;
mod sums;
#[cfg(test)]
mod tests;
mod truth;
mod whiteness;

pub(crate) use scoring::Scoring;
pub(crate) use sums::{Pools, Traced};

use crate::filter::Memo;
use crate::model::Model;
use crate::objective::{Kind, Objective};

impl Objective {
    /// What the objective remembers from row to row.
    pub(crate) fn memory(&self, model: &Model) -> Vec<Memo> {
        match self.kind {
            Kind::Whiteness => whiteness::memory(self, model.measurements.len()).collect(),
            Kind::Prediction => prediction::memory(self, model.states.len()).collect(),
            _ => Vec::new(),
        }
    }

    /// Adds what the objective needs to a filter that is being traced.
    pub(crate) fn trace(&self, scoring: &mut Scoring<'_, '_>) -> Traced {
        match self.kind {
            Kind::Nll => likelihood::trace(self, scoring),
            Kind::MseInnovation => innovation::trace_mse(self, scoring),
            Kind::Mismatch => mismatch::trace(self, scoring),
            Kind::Nis | Kind::NisMean => innovation::trace_nis(self, scoring),
            Kind::NisDistribution => distribution::trace(self, scoring),
            Kind::Whiteness => whiteness::trace(self, scoring),
            Kind::Prediction => prediction::trace(self, scoring),
            Kind::Rejected => innovation::trace_rejected(self, scoring),
            Kind::Nees | Kind::NeesMean => truth::trace_nees(self, scoring),
            Kind::Rmse => truth::trace_rmse(self, scoring),
            Kind::Distance => truth::trace_distance(self, scoring),
        }
    }

    /// What cannot be pooled is worked out for trajectory `t` from its sums, and then summed over trajectories.
    pub(crate) fn of_trajectory(&self, pools: &Pools<'_>, t: usize) -> f64 {
        match self.kind {
            Kind::Mismatch => mismatch::of_trajectory(pools, t),
            _ => 0.0,
        }
    }

    /// The cost, from the pooled sums of a run.
    pub(crate) fn finish(&self, pools: &Pools<'_>) -> f64 {
        match self.kind {
            Kind::Nll => likelihood::finish(pools),
            Kind::MseInnovation => innovation::finish_mse(pools),
            Kind::Mismatch => mismatch::finish(pools),
            Kind::Nis => innovation::finish_nis(pools),
            Kind::NisMean => innovation::finish_nis_mean(pools),
            Kind::NisDistribution => distribution::finish(pools),
            Kind::Whiteness => whiteness::finish(self, pools),
            Kind::Prediction => prediction::finish(self, pools),
            Kind::Rejected => innovation::finish_rejected(pools),
            Kind::Nees => truth::finish_nees(pools),
            Kind::NeesMean => truth::finish_nees_mean(pools),
            Kind::Rmse => truth::finish_rmse(pools),
            Kind::Distance => truth::finish_distance(pools),
        }
    }
}
