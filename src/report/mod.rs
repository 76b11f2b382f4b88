//! Reports: what a study or a filter run found, for people (text), programs (JSON) and tables (CSV).

mod bound;
mod consistency;
mod matrices;
mod named;
mod number;
mod raw;
mod rmse;
mod run_csv;
mod table;
mod text;
mod tuning;
mod warnings;

pub use bound::Bound;
pub use consistency::{
    Consistency, Evidence, Finding, FlatDirection, Nees, NisDistribution, Uncertainty, Verdict, Whiteness,
};
pub use matrices::{Gain, Matrices, Matrix};
pub use named::Named;
pub use number::{count, exact, seconds, short, significant};
pub use raw::raw_rmse;
pub use rmse::StateErrors;
pub use run_csv::{Columns, Covariance, RunTable};
pub use table::TextTable;
pub use tuning::{Certificate, Effort, LogFacts, Nothing, Polish, Scored, Tuning};
pub use warnings::Warning;
