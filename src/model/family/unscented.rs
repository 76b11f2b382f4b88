//! The unscented Kalman filter.

use super::{Adapts, Described, Facts, Range, Setting, Settings, View};
use crate::model::error::Fault;
use crate::model::{Binary, Expr};

/// f and h are taken at x and at x +- sqrt(n + lambda) L_j, with P = L L', L lower triangular, lambda = alpha^2 (n + kappa) - n
/// (Julier and Uhlmann 2004, doi 10.1109/JPROC.2003.823141; the scaled form by Julier 2002).
#[derive(Debug, Clone, PartialEq)]
pub struct Unscented {
    /// Spread of the points, above 0.
    pub alpha: Expr,
    /// Weight of the centre in the covariance: 2 for a gaussian.
    pub beta: Expr,
    /// The other spread; n + kappa is above 0.
    pub kappa: Expr,
    /// n + kappa.
    spread: Expr,
    /// beta + alpha^2 kappa / n: with both not negative every covariance is a sum of squares, whatever f and h are.
    margin: Expr,
}

impl Unscented {
    fn new(states: usize, alpha: Expr, beta: Expr, kappa: Expr) -> Self {
        let n = || Expr::number(u32::try_from(states).unwrap_or(u32::MAX).into());
        let spread = Expr::binary(Binary::Add, n(), kappa.clone());
        let square = Expr::binary(Binary::Multiply, alpha.clone(), alpha.clone());
        let share = Expr::binary(Binary::Divide, Expr::binary(Binary::Multiply, square, kappa.clone()), n());
        let margin = Expr::binary(Binary::Add, beta.clone(), share);
        Self { alpha, beta, kappa, spread, margin }
    }
}

impl Described for Unscented {
    const NAME: &'static str = "unscented";
    const KEYS: &'static [&'static str] = &["alpha", "beta", "kappa"];
    const LINEAR: bool = false;
    const VIEW: View = View::Points;

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        let n = settings.states();
        let kappa = f64::from(u8::try_from(3_usize.saturating_sub(n)).unwrap_or(0));
        let [alpha, beta, kappa] =
            [settings.formula("alpha", 1.0)?, settings.formula("beta", 2.0)?, settings.formula("kappa", kappa)?];
        Ok(Self::new(n, alpha, beta, kappa))
    }

    /// The three, then what they must fulfil.
    fn settings(&self) -> Vec<Setting<'_>> {
        vec![
            Setting::new("alpha", &self.alpha, Range::Positive),
            Setting::new("beta", &self.beta, Range::Any),
            Setting::new("kappa", &self.kappa, Range::Any),
            Setting::condition("kappa", "n + kappa", &self.spread, Range::Positive),
            Setting::condition("beta", "beta + alpha^2 kappa / n", &self.margin, Range::NotNegative),
        ]
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: true, adapts: Adapts::Nothing, noise_floor: None }
    }
}
