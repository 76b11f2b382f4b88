//! What must hold whatever the numbers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod filters;
mod gaps;
mod optimizers;
mod turning;
