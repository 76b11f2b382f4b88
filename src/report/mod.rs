//! Reports: what a study or a filter run found, for people (text), programs (JSON) and tables (CSV).

mod bound;
mod consistency;
mod constraint;
#[cfg(feature = "figures")]
pub mod figures;
mod front;
mod matrices;
mod named;
mod number;
mod raw;
mod run_csv;
mod table;
mod text;
mod tuning;
mod validation;
mod warnings;

pub use bound::Bound;
pub use consistency::{Consistency, Evidence, Finding, Nees, Verdict, Whiteness};
pub use constraint::{ConstraintCheck, constraint_checks, unmet};
pub use front::{FrontPoint, FrontSummary, front, write_front};
pub use matrices::{Gain, Matrices, Matrix};
pub use named::Named;
pub use number::{count, exact, seconds, short, significant};
pub use raw::raw_rmse;
pub use run_csv::{Covariance, RunTable};
pub use table::TextTable;
pub use tuning::{Certificate, Effort, LogFacts, Nothing, Polish, Scored, Tuning};
pub use validation::{Part, Rows, Validation};
pub use warnings::Warning;
