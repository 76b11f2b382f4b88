//! One definition, many machines: a filter is traced once into a graph, and its schedule, the tape, runs everywhere.
//!
//! [`Graph`] holds expressions (hash-consed, simplified as they are built, differentiable); [`Tape`] is a straight line of
//! operations with registers assigned by liveness; [`lanes`] runs it on the CPU over a block of candidates at once.

mod assignment;
mod calculator;
mod codes;
mod difference;
mod differentiate;
mod elementary;
mod functions;
mod graph;
pub mod lanes;
mod moved;
mod operations;
mod print;
mod rebuild;
mod scale;
mod schedule;
mod simplify;
mod size;
mod straight_line;
mod terms;
pub mod wgsl;

pub use calculator::Calculator;
pub use codes::{Binary, Unary};
pub use difference::{Centre, Differences, Sum};
pub use functions::Function;
pub use graph::{Depends, Graph, Id, Leaf, Node};
pub use moved::Moved;
pub use print::{Counts, Names};
pub use straight_line::{Argument, Code, Operation, Output, Tape, TooLarge};
