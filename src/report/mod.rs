//! Reports on studies and filter runs.

mod consistency;

pub use consistency::{Consistency, Finding, Nees, Verdict, Whiteness};
