//! Families of filters, as the problem file knows them: one file each, and one line each in the list below.
//!
//! What a family does on the graph stands in the file of its name under `filter/`, in textbook form under `reference/`.
//! Whoever else wants to know something about a filter asks its [`Facts`].

mod cubature;
mod extended;
mod fuzzy;
mod imm;
mod iterated;
mod kalman;
mod robust;
mod sage_husa;
mod sage_husa_r;
mod setting;
mod unscented;

pub use cubature::Cubature;
pub use extended::Extended;
pub use fuzzy::Fuzzy;
pub use imm::Imm;
pub use iterated::Iterated;
pub use kalman::Kalman;
pub use robust::{Outliers, Robust};
pub use sage_husa::SageHusa;
pub use sage_husa_r::SageHusaR;
pub use setting::{Range, Setting};
pub use unscented::Unscented;

use super::Expr;
use super::error::Fault;

/// What a filter changes on the way, so that the model's is only where it starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Adapts {
    /// Neither Q nor R.
    Nothing,
    /// One Q for every step.
    ProcessNoise,
    /// R, component by component, which must be diagonal.
    MeasurementNoise,
}

/// What a filter takes f and h for, where they are not affine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// It does not take such, or leaves it to other filters.
    None,
    /// Their tangents at the estimate.
    Tangent,
    /// The same, of h again where the update leads.
    TangentAgain,
    /// Their values at points around the estimate.
    Points,
}

/// What others have to know about a filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts<'a> {
    /// Whether results depend on the order of the states: points are drawn along the columns of a triangular root of P.
    pub ordered: bool,
    /// What it adapts.
    pub adapts: Adapts,
    /// The share of the model's R down to which it may adapt it, where there is one.
    pub noise_floor: Option<Setting<'a>>,
}

/// The keys of `[filter]`, as a family asks for its own.
pub(super) trait Settings {
    /// Number of states, n.
    fn states(&self) -> usize;
    /// A formula of parameters.
    fn formula(&self, key: &'static str, default: f64) -> Result<Expr, Fault>;
    /// A formula of parameters for each measurement, in their order; `None` where the key is not there.
    fn formula_of_each(&self, key: &'static str) -> Result<Option<Vec<Expr>>, Fault>;
    /// A whole number from `least` to `largest`.
    fn count(&self, key: &'static str, default: usize, least: u32, largest: u32) -> Result<usize, Fault>;
    /// Number of modes; 0 for a filter of one model.
    fn modes(&self) -> usize;
    /// Formulas of parameters by rows, where the key is there: one by itself is a row of one, a list is one row.
    fn rows(&self, key: &'static str) -> Result<Option<Vec<Vec<Expr>>>, Fault>;
    /// That what stands under a key cannot be used; of the table where the key is not there.
    fn refuse(&self, key: &'static str, problem: String) -> Fault;
}

/// What the file of a family says.
pub(super) trait Described: Sized {
    /// What `[filter] kind` calls it.
    const NAME: &'static str;
    /// Its own keys in `[filter]`.
    const KEYS: &'static [&'static str];
    /// Whether f and h have to be affine in the states.
    const LINEAR: bool = true;
    /// What it takes them for.
    const VIEW: View = View::None;

    /// Reads its settings.
    fn read(settings: &dyn Settings) -> Result<Self, Fault>;

    /// Its settings that are formulas, in the order in which they are evaluated.
    fn settings(&self) -> Vec<Setting<'_>>;

    /// Its settings that are numbers and shape the filter.
    fn sizes(&self) -> Vec<usize> {
        vec![]
    }

    /// What others have to know.
    fn facts(&self) -> Facts<'_>;
}

macro_rules! families {
    ($($(#[$doc:meta])* $family:ident,)*) => {
        /// Filter kinds. All but the last carry one gaussian. The first are linear Kalman filters (affine f and h), of which the
        /// adaptive ones change Q or R on the way, from what the innovations of the log say, and start every trajectory anew
        /// from the model's. The others take any f and h, and differ in how a gaussian goes through them.
        ///
        /// Settings are formulas of parameters, so they can be searched as anything else.
        #[derive(Debug, Clone, PartialEq)]
        pub enum FilterKind {
            $($(#[$doc])* $family($family),)*
        }

        impl FilterKind {
            /// The names that `[filter] kind` takes; the first is what a problem without one has.
            pub const NAMES: &'static [&'static str] = &[$($family::NAME),*];

            /// Its name in problem files and reports.
            #[must_use]
            pub const fn name(&self) -> &'static str {
                match self {
                    $(Self::$family(_) => $family::NAME,)*
                }
            }

            /// The names of those that take any f and h of one model.
            pub(super) fn nonlinear() -> impl Iterator<Item = &'static str> {
                let all = [$(($family::NAME, $family::LINEAR)),*].into_iter();
                all.filter(|(name, linear)| !linear && *name != Imm::NAME).map(|(name, _)| name)
            }

            /// Whether f and h have to be affine in the states.
            #[must_use]
            pub const fn is_linear(&self) -> bool {
                match self {
                    $(Self::$family(_) => $family::LINEAR,)*
                }
            }

            /// What it takes f and h for, where they are not affine.
            #[must_use]
            pub const fn view(&self) -> View {
                match self {
                    $(Self::$family(_) => $family::VIEW,)*
                }
            }

            /// The name of the first that takes them for this.
            pub(crate) fn viewing(view: View) -> Option<&'static str> {
                [$(($family::NAME, $family::VIEW)),*].into_iter().find(|(_, of)| *of == view).map(|(name, _)| name)
            }

            /// Its settings that are formulas.
            #[must_use]
            pub fn settings(&self) -> Vec<Setting<'_>> {
                match self {
                    $(Self::$family(family) => family.settings(),)*
                }
            }

            /// Its settings that are numbers and shape the filter.
            #[must_use]
            pub fn sizes(&self) -> Vec<usize> {
                match self {
                    $(Self::$family(family) => family.sizes(),)*
                }
            }

            /// What others have to know about it.
            #[must_use]
            pub fn facts(&self) -> Facts<'_> {
                match self {
                    $(Self::$family(family) => family.facts(),)*
                }
            }

            /// The keys in `[filter]` of the kind with a name.
            pub(super) fn keys(name: &str) -> &'static [&'static str] {
                match name {
                    $($family::NAME => $family::KEYS,)*
                    _ => &[],
                }
            }

            /// The kind with a name; the linear Kalman filter for one that does not exist.
            pub(super) fn read(name: &str, settings: &dyn Settings) -> Result<Self, Fault> {
                Ok(match name {
                    $($family::NAME => Self::$family($family::read(settings)?),)*
                    _ => Self::default(),
                })
            }
        }
    };
}

families! {
    /// The linear Kalman filter.
    Kalman,
    /// Sage-Husa, process noise.
    SageHusa,
    /// Sage-Husa, measurement noise.
    SageHusaR,
    /// Fuzzy adaptation of R.
    Fuzzy,
    /// f and h by their Jacobians at the mean.
    Extended,
    /// The same, with h linearised again at the updated mean.
    Iterated,
    /// f and h at sigma points.
    Unscented,
    /// The same, by the cubature rule of degree three.
    Cubature,
    /// Several of them side by side, each with a model of its own, weighed by what is measured.
    Imm,
}

impl Default for FilterKind {
    fn default() -> Self {
        Self::Kalman(Kalman)
    }
}
