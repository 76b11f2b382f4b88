//! The problem file as a whole.

mod examples;
