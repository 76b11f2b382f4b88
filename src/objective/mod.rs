//! Objectives, all minimised, and constraints on what they measure. One list; the semantics of each stand in
//! `docs/semantics.md`.

mod constraint;
mod resolution;

pub use constraint::{Constraint, Relation};

/// What a filter run is scored by.
#[derive(Debug, Clone, PartialEq)]
pub struct Objective {
    /// Which one.
    pub kind: Kind,
    /// State indices that `rmse` and `distance` compare with truth; empty for the others.
    pub states: Vec<usize>,
    /// First rows of each trajectory that do not score.
    pub skip: usize,
    /// `mismatch`: number of last measured rows of a trajectory that Ca (and Ct) average over.
    pub window: usize,
    /// `mismatch`: use Ct of the last measured row only (the paper's form).
    pub ct_last: bool,
    /// `whiteness`: lags, counted in present values of a component.
    pub lags: usize,
    /// `prediction`: how many rows ahead, each at least 1; empty for the default, see [`Self::horizons`].
    pub ahead: Vec<usize>,
}

/// The kinds of objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Negative log-likelihood, nats, summed over present measurements, with 2 pi.
    Nll,
    /// Sum of squared joint innovations / number of present components (f1).
    MseInnovation,
    /// |mean Ca / mean Ct - 1| over the last rows of a trajectory (f2).
    Mismatch,
    /// |nis_mean - 1|.
    Nis,
    /// How far the NIS is from its chi-square distribution in the whole: Neyman's smooth statistic of four components.
    NisDistribution,
    /// Sum over components and lags of the squared autocorrelations of the innovations.
    Whiteness,
    /// Mean squared error of predicting the measurement some rows ahead; the mean over several distances.
    Prediction,
    /// |nees_mean - 1|.
    Nees,
    /// Root of the mean over rows with truth of the squared error of the named states, posterior.
    Rmse,
    /// Sum over rows with truth of the Euclidean error of the named states, posterior.
    Distance,
    /// nis_mean itself: for constraints, benchmarks and reports, not an objective.
    NisMean,
    /// nees_mean itself: as [`Self::NisMean`].
    NeesMean,
    /// Mean over the rows with a measurement of what a robust filter leaves out of them, 0 to 1: for constraints and reports.
    Rejected,
}

impl Kind {
    /// Every objective with the name it has in problem files, JSON and CSV.
    pub const ALL: [(&'static str, Self); 10] = [
        ("nll", Self::Nll),
        ("mse_innovation", Self::MseInnovation),
        ("mismatch", Self::Mismatch),
        ("nis", Self::Nis),
        ("nis_distribution", Self::NisDistribution),
        ("whiteness", Self::Whiteness),
        ("prediction", Self::Prediction),
        ("nees", Self::Nees),
        ("rmse", Self::Rmse),
        ("distance", Self::Distance),
    ];

    /// What is no objective, because its best value is not its smallest, but can be bounded by a constraint.
    pub const MEANS: [(&'static str, Self); 3] =
        [("nis_mean", Self::NisMean), ("nees_mean", Self::NeesMean), ("rejected", Self::Rejected)];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().chain(&Self::MEANS).find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }

    /// Whether it needs the true states.
    #[must_use]
    pub const fn needs_truth(self) -> bool {
        matches!(self, Self::Nees | Self::NeesMean | Self::Rmse | Self::Distance)
    }
}

impl Objective {
    /// The objective with default options (no rows skipped, window 100, no states, 10 lags, 5 rows ahead).
    #[must_use]
    pub const fn new(kind: Kind) -> Self {
        Self { kind, states: Vec::new(), skip: 0, window: 100, ct_last: false, lags: 10, ahead: Vec::new() }
    }

    /// The distances, in rows, over which `prediction` predicts; none for other kinds.
    #[must_use]
    pub fn horizons(&self) -> &[usize] {
        match self.kind {
            Kind::Prediction if self.ahead.is_empty() => &[5],
            Kind::Prediction => &self.ahead,
            _ => &[],
        }
    }

    /// Its name in reports.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.kind.name()
    }
}
