//! The problem file as a whole.

mod errors;
mod examples;
mod log;
mod tuned;
