//! Reports: what a study or a filter run found, for people (text), programs (JSON) and tables (CSV).

mod bound;
mod compare;
mod conclude;
mod consistency;
mod constraint;
mod difference;
mod document;
mod effort;
mod front;
mod linearity;
mod matrices;
mod named;
pub mod pictures;
mod raw;
mod rmse;
mod run_csv;
mod sections;
mod tuning;
mod validation;
mod warnings;

pub use crate::number::{count, exact, seconds, short, significant};
pub use bound::Bound;
pub use compare::{CompareError, Comparison, Run, RunBaseline, RunConsistency, RunError, RunHeldOut, RunValidation};
pub use consistency::{
    Consistency, DominatingRow, Evidence, Finding, FlatDirection, JOINT_LEVEL, ModeUse, Nees, NisDistribution,
    NisOverTime, NisSpan, Place, Rejected, SensorNis, Test, TestKind, Uncertainty, Verdict, Whiteness,
};
pub use constraint::{ConstraintCheck, constraint_checks, unmet};
pub use difference::{Difference, HeldOutDifference, Standing, StartOf};
pub use document::Picture;
pub use effort::{Effort, LogFacts, Scored};
pub use front::{FrontPoint, FrontSummary, front, mean_nis, write_front};
pub use linearity::{FilterScore, Linearising, Linearity, LinearityVerdict};
pub use matrices::{Entry, Gain, Matrices, Matrix};
pub use named::Named;
pub use raw::raw_rmse;
pub use rmse::StateErrors;
pub use run_csv::{Columns, Covariance, RunTable};
pub use sections::{markdown, markdown_without_winner};
pub use tuning::{Certificate, Nothing, Polish, Tuning};
pub use validation::{Part, Rows, Validation};
pub use warnings::Warning;
