//! The binary, through every verb and exit code.
#![expect(clippy::float_cmp, reason = "the same bits are promised")]

mod bad_input;
mod command;
mod evaluate;
mod filter;
mod tune;
