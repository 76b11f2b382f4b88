//! Weights and densities of robust updates, by their definitions.

use std::f64::consts::{PI, SQRT_2, TAU};

use crate::model::{Angles, Robust};
use crate::reference::estimate::{Update, count};

/// What a kind of robust update takes an innovation for.
pub(super) enum Density {
    Mixture(Outliers),
    StudentT { dof: f64 },
    Huber { k: f64, components: usize },
    Correntropy { k: f64, outliers: Outliers },
    Gate { gate: f64, outliers: Outliers },
}

/// (1 - eps) N(nu; 0, S) + eps / V.
pub(super) struct Outliers {
    eps: f64,
    /// One length a measurement.
    volume: Vec<f64>,
}

impl Density {
    /// From the values of the settings, in their order.
    pub(super) fn new(robust: &Robust, values: &[f64], angles: &Angles, ranges: &[f64]) -> Self {
        let outliers = |values: &[f64]| {
            let known = |(i, range): (usize, &f64)| if angles.measurement(i) { TAU } else { *range };
            let given = robust.outliers().is_some_and(|outliers| outliers.volume.is_some());
            let volume = if given { values[1..].to_vec() } else { ranges.iter().enumerate().map(known).collect() };
            Outliers { eps: values[0], volume }
        };
        match robust {
            Robust::Mixture(_) => Self::Mixture(outliers(values)),
            Robust::StudentT { .. } => Self::StudentT { dof: values[0] },
            Robust::Huber { .. } => Self::Huber { k: values[0], components: ranges.len() },
            Robust::Correntropy { .. } => Self::Correntropy { k: values[0], outliers: outliers(&values[1..]) },
            Robust::Gate { .. } => Self::Gate { gate: values[0], outliers: outliers(&values[1..]) },
        }
    }

    /// The threshold of a kind that weighs components one by one, where there are more than two.
    pub(super) fn threshold_of_each(&self) -> Option<f64> {
        match self {
            Self::Huber { k, components } if *components > 2 => Some(*k),
            _ => None,
        }
    }

    /// What a row counts, and what the spread of the two means that it may have counts.
    pub(super) fn weight(&self, update: &Update) -> (f64, f64) {
        let (nis, m) = (update.nis, count(update.present.len()));
        let weight = match self {
            Self::Mixture(outliers) => {
                let (inlier, outlier) = outliers.logarithms(update);
                // b and 1 - b, each without the cancellation of the other.
                let (b, rest) = (1.0 / (1.0 + (outlier - inlier).exp()), 1.0 / (1.0 + (inlier - outlier).exp()));
                return (b, b * rest);
            }
            Self::StudentT { dof } => ((dof + m) / (dof + nis)).min(1.0),
            Self::Huber { k, .. } => huber_weight(*k, nis),
            Self::Correntropy { k, .. } => (-nis / (2.0 * k * k)).exp(),
            Self::Gate { gate, .. } => f64::from(u8::from(nis < *gate)),
        };
        (weight, 0.0)
    }

    /// Minus the logarithm of the density of the present components \[nats\].
    pub(super) fn nll(&self, update: &Update) -> f64 {
        let m = count(update.present.len());
        let log_det = 2.0 * update.nll - m * TAU.ln() - update.nis;
        match self {
            Self::Mixture(outliers) | Self::Correntropy { outliers, .. } | Self::Gate { outliers, .. } => {
                let (inlier, outlier) = outliers.logarithms(update);
                let (low, high) = (inlier.min(outlier), inlier.max(outlier));
                -high - (low - high).exp().ln_1p()
            }
            Self::StudentT { dof } => {
                let gammas = libm::lgamma(0.5 * dof) - libm::lgamma(0.5 * (dof + m));
                let scale = 0.5 * (m * ((dof - 2.0) * PI).ln() + log_det);
                gammas + scale + 0.5 * (dof + m) * (update.nis / (dof - 2.0)).ln_1p()
            }
            Self::Huber { k, .. } => {
                rho(*k, update.nis.sqrt()) + 0.5 * log_det + integral(*k, update.present.len()).ln()
            }
        }
    }

    /// The same of one component d standard deviations off, by the kind that weighs them one by one.
    pub(super) fn nll_of(&self, d: f64, variance: f64) -> f64 {
        match self {
            Self::Huber { k, .. } => rho(*k, d) + 0.5 * variance.ln() + integral(*k, 1).ln(),
            _ => f64::NAN,
        }
    }
}

impl Outliers {
    /// ln (1 - eps) N(nu; 0, S) and ln eps / V, V over the present components.
    fn logarithms(&self, update: &Update) -> (f64, f64) {
        let volume: f64 = update.present.iter().map(|i| self.volume[*i].ln()).sum();
        ((-self.eps).ln_1p() - update.nll, self.eps.ln() - volume)
    }
}

/// min(1, k / d).
pub(super) fn huber_weight(k: f64, nis: f64) -> f64 {
    let d = nis.sqrt();
    if d > k { k / d } else { 1.0 }
}

/// d^2 / 2 up to k, k d - k^2 / 2 beyond.
fn rho(k: f64, d: f64) -> f64 {
    if d > k { k * (d - 0.5 * k) } else { 0.5 * d * d }
}

/// Of exp(-rho) over one or two dimensions.
fn integral(k: f64, m: usize) -> f64 {
    let bell = (-0.5 * k * k).exp();
    if m == 2 { TAU * (1.0 + bell / (k * k)) } else { TAU.sqrt() * libm::erf(k / SQRT_2) + 2.0 / k * bell }
}
