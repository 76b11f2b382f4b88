//! Robust updates: how much a measurement counts that the filter did not expect.

use super::{Range, Setting, Settings};
use crate::model::Expr;
use crate::model::error::Fault;

/// What a robust filter does to the update of a row, and by which density it is scored. Each is a density over all present
/// measurements that integrates to one, so that no search gains by leaving measurements out.
#[derive(Debug, Clone, PartialEq)]
pub enum Robust {
    /// A row counts with the probability that it is no outlier: b = N' / (N' + eps / V), N' = (1 - eps) N(nu; 0, S).
    Mixture(Outliers),
    /// Innovations have a Student's t distribution with covariance S: a weight of min(1, (v + m) / (v + NIS)).
    StudentT {
        /// Degrees of freedom v, above 2.
        dof: Expr,
    },
    /// Beyond `k` standard deviations an innovation counts as one at `k` (Huber 1964, doi 10.1214/aoms/1177703732).
    Huber {
        /// Threshold on the square root of NIS, above 0.
        k: Expr,
    },
    /// A weight of exp(-NIS / (2 k^2)), by the correntropy of the innovation (Chen et al. 2017, doi
    /// 10.1016/j.automatica.2016.10.004).
    Correntropy {
        /// Width of the kernel in standard deviations, above 0.
        k: Expr,
        /// By which it is scored.
        outliers: Outliers,
    },
    /// All or nothing: a row of NIS below `gate` updates.
    Gate {
        /// Threshold on NIS, above 0.
        gate: Expr,
        /// So many rejected rows in a row, and the next one updates whatever its NIS; 0 = never.
        limit: usize,
        /// By which it is scored.
        outliers: Outliers,
    },
}

/// Outliers that fall anywhere in a volume: (1 - eps) N(nu; 0, S) + eps / V.
#[derive(Debug, Clone, PartialEq)]
pub struct Outliers {
    /// Their share, above 0 and below 1.
    pub eps: Expr,
    /// For each measurement the length of the range that they fall in; V is the product over the present ones. `None` = the
    /// ranges of the training log.
    pub volume: Option<Vec<Expr>>,
}

impl Outliers {
    const KEYS: [&'static str; 2] = ["eps", "volume"];

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        Ok(Self { eps: settings.formula("eps", 0.05)?, volume: settings.formula_of_each("volume")? })
    }

    fn settings(&self) -> Vec<Setting<'_>> {
        let volume = self.volume.iter().flatten().map(|volume| Setting::new("volume", volume, Range::Positive));
        std::iter::once(Setting::new("eps", &self.eps, Range::Inside)).chain(volume).collect()
    }
}

/// Most rejected rows in a row.
const MOST: u32 = 1_000_000;

impl Robust {
    /// The names that `[filter] robust` takes.
    pub const NAMES: [&'static str; 5] = ["mixture", "student-t", "huber", "correntropy", "gate"];

    /// Its name in problem files and reports.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Mixture(_) => "mixture",
            Self::StudentT { .. } => "student-t",
            Self::Huber { .. } => "huber",
            Self::Correntropy { .. } => "correntropy",
            Self::Gate { .. } => "gate",
        }
    }

    /// Its settings that are formulas: its own, then those of [`Self::outliers`].
    #[must_use]
    pub fn settings(&self) -> Vec<Setting<'_>> {
        let own = match self {
            Self::Mixture(_) => vec![],
            Self::StudentT { dof } => vec![Setting::new("dof", dof, Range::AboveTwo)],
            Self::Huber { k } | Self::Correntropy { k, .. } => vec![Setting::new("k", k, Range::Positive)],
            Self::Gate { gate, .. } => vec![Setting::new("gate", gate, Range::Positive)],
        };
        own.into_iter().chain(self.outliers().into_iter().flat_map(Outliers::settings)).collect()
    }

    /// Its settings that are numbers and shape the filter.
    #[must_use]
    pub fn sizes(&self) -> Vec<usize> {
        if let Self::Gate { limit, .. } = self { vec![*limit] } else { vec![] }
    }

    /// The outliers that it is scored by, where it has no density of its own.
    #[must_use]
    pub const fn outliers(&self) -> Option<&Outliers> {
        match self {
            Self::Mixture(outliers) | Self::Correntropy { outliers, .. } | Self::Gate { outliers, .. } => {
                Some(outliers)
            }
            Self::StudentT { .. } | Self::Huber { .. } => None,
        }
    }

    /// The keys in `[filter]` of the kind with a name.
    pub(in crate::model) fn keys(name: &str) -> Vec<&'static str> {
        let own: &[&str] = match name {
            "student-t" => return vec!["dof"],
            "huber" => return vec!["k"],
            "correntropy" => &["k"],
            "gate" => &["gate", "limit"],
            _ => &[],
        };
        [own, &Outliers::KEYS].concat()
    }

    /// The kind with a name; the mixture for one that does not exist.
    pub(in crate::model) fn read(name: &str, settings: &dyn Settings) -> Result<Self, Fault> {
        Ok(match name {
            "student-t" => Self::StudentT { dof: settings.formula("dof", 4.0)? },
            "huber" => Self::Huber { k: settings.formula("k", 1.345)? },
            "correntropy" => Self::Correntropy { k: settings.formula("k", 3.0)?, outliers: Outliers::read(settings)? },
            "gate" => Self::Gate {
                gate: settings.formula("gate", 9.0)?,
                limit: settings.count("limit", 10, 0, MOST)?,
                outliers: Outliers::read(settings)?,
            },
            _ => Self::Mixture(Outliers::read(settings)?),
        })
    }
}
