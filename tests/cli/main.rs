//! The binary, through every verb and exit code.
#![expect(clippy::float_cmp, reason = "the same bits are promised")]
#![expect(clippy::unwrap_used, reason = "a helper that fails fails its test")]
#![expect(clippy::missing_assert_message, reason = "the values compared say it")]

mod adaptive;
mod bad_input;
mod bench;
mod check;
mod checkpoint;
mod command;
mod compare;
mod evaluate;
mod examples;
mod figures;
mod filter;
mod front;
mod gpu;
mod init;
mod long_input;
mod memory;
mod nonlinear;
mod output;
mod reproduce;
#[cfg(unix)]
mod signals;
mod tables;
mod tape;
mod tune;
mod validation;
