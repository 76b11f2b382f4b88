//! The f64 oracle: a textbook filter on dense matrices that reads the formula trees itself.
//!
//! It runs `kfgpu filter`, certifies winners and judges every faster path, so it shares no arithmetic with the tape:
//! formulas are evaluated as they stand, F and H come from unit vectors, the update is joint, and P
//! is carried by its square root, through Householder reflections, so that it is right where it certifies. `docs/semantics.md` is its specification.

mod adapt;
mod amplification;
mod estimate;
mod evaluate;
mod failure;
mod families;
mod filter;
mod imm;
mod kalman;
mod matrices;
mod mixture;
mod observation;
mod points;
mod prediction;
mod robust;
mod run;
mod score;
mod sigma;
mod smoother;
mod square_root;
mod steady;
mod step;
mod transition;
mod uniformity;
mod whiteness;

pub use amplification::amplification;
pub use estimate::{Estimate, Update};
pub use evaluate::{Scope, evaluate, gradient};
pub use failure::{Cause, Failure};
pub use matrices::Matrices;
pub(crate) use matrices::{Affine, Formulas};
pub(crate) use prediction::Predictor;
pub use run::{costs, costs_held_out, run, scores, scores_held_out, visit};
pub use score::score;
pub use smoother::{Smoothed, smooth};
pub use steady::{Steady, steady_gain};
pub use step::{Run, Step};
pub(crate) use uniformity::smooth_components;
pub(crate) use whiteness::standardised;
