//! The problem file as a whole.

mod errors;
mod examples;
mod lets;
mod library;

mod log;
mod modes;
mod tables;
mod tuned;
