//! Pictures of searches and filter runs, drawn by [`crate::chart`].

mod convergence;
mod extent;
mod fan;
mod front;
mod histogram;
mod landscape;
mod plan;
mod run_pictures;
mod run_record;
#[cfg(test)]
mod tests;
mod track;

pub use convergence::{convergence, hypervolume};
pub use front::FrontPicture;
pub use landscape::landscape;
pub use run_pictures::titled;
pub use run_record::RunRecord;
