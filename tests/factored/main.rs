//! The two forms of the covariance: equal in f64, and what single precision makes of each under a diffuse P0.

mod case;
mod cost;
mod diffuse;
mod equal;
mod rule;
mod shapes;
