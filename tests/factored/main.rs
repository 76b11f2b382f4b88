//! The two forms of the covariance: equal in f64, and what single precision makes of each under a diffuse P0.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod case;
mod cost;
mod diffuse;
mod equal;
mod rule;
mod shapes;
