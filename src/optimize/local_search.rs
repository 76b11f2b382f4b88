//! The one interface of local searches, which polish what a population has found.

use super::Optimizer;

/// A search for the nearest optimum from one start, a batch of candidates at a time: [`Optimizer::ask`] gives the next
/// batch, `None` at its end, and [`Optimizer::tell`] takes the costs. It minimises one number; a cost of
/// [`crate::population::Evaluation::INFEASIBLE`] or more is a wall.
///
/// Several run in lockstep: their batches are scored as one.
pub trait LocalSearch: Optimizer {
    /// The best point that it has moved to, in search coordinates, and its cost; `None` while none was usable.
    fn best(&self) -> Option<(&[f64], f64)>;

    /// How it stands.
    fn standing(&self) -> Standing;

    /// Predicted distance from [`Self::best`] to the optimum, in standard errors: sqrt(2 x the gain in nats that its model
    /// of the cost predicts), which is the norm of the projected gradient in the metric of the Hessian. `None` for a
    /// method without gradients.
    fn gradient_norm(&self) -> Option<f64>;
}

/// How a local search stands, or ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Standing {
    /// On its way, or out of evaluations.
    Unfinished,
    /// The gradient, projected on the bounds, is small, and no probe farther off is better.
    Converged,
    /// A simplex has shrunk to a point. It has no gradient to be judged by.
    Collapsed,
    /// No step lowers the cost although the gradient is not small: there is a kink or a wall.
    Stuck,
}
