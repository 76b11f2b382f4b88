//! The command line: one file a verb. Results go to stdout, everything said to a person to stderr.

mod aside;
mod bench;
mod candidates;
mod check;
mod checkpoint;
mod compare;
mod console;
#[cfg(feature = "gpu")]
mod devices;
mod earlier;
mod evaluate;
mod evaluator;
mod files;
mod filter;
mod folder;
mod held_out;
mod init;
mod interrupt;
mod load;
mod lock;
mod memory;
mod options;
mod output;
mod overrides;
mod paths;
mod pictures;
mod progress;
mod reproduce;
mod results;
mod run_files;
#[cfg(feature = "gpu")]
mod shader;
mod simulate;
#[cfg(feature = "gpu")]
mod stderr;
mod tape;
mod tune;

use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use console::Console;

/// Tunes Kalman filters: searches a filter's noise parameters on a log of measurements, and says whether the
/// tuned filter can be trusted.
#[derive(Debug, Parser)]
#[command(name = "kfgpu", version, propagate_version = true, max_term_width = 100, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,

    /// Say nothing on stderr but errors (default: summaries, warnings and, on a terminal, a progress bar), for scripts
    /// that read only stdout.
    #[arg(long, short, global = true, display_order = 900)]
    quiet: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 ran, but the result is not usable; 2 wrong use or input; 130, 143, 129 \
                          stopped by Ctrl-C, SIGTERM or SIGHUP, with the best so far written.\n\nFiles that exist: \
                          nothing is overwritten unless --force says so. What an earlier run of the same kind left is \
                          kept under a number (out.1, run.csv.1) and anything else is refused.";

#[derive(Debug, Subcommand)]
enum Verb {
    // Boxed, because it has many more flags than the others.
    Tune(Box<tune::Tune>),
    Filter(filter::Filter),
    Check(check::Check),
    Init(init::Init),
    Tape(tape::Tape),
    Simulate(simulate::Simulate),
    Evaluate(evaluate::Evaluate),
    Compare(compare::Compare),
    Bench(bench::Bench),
    Reproduce(reproduce::Reproduce),
    #[cfg(feature = "gpu")]
    Devices(devices::Devices),
    #[cfg(feature = "gpu")]
    Shader(shader::Shader),
}

/// How a verb ended, when not by an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ending {
    Done,
    NotUsable,
    /// By a signal, with this exit code.
    Interrupted(u8),
}

impl From<Ending> for ExitCode {
    fn from(ending: Ending) -> Self {
        Self::from(match ending {
            Ending::Done => 0,
            Ending::NotUsable => 1,
            Ending::Interrupted(code) => code,
        })
    }
}

/// Runs the command with the process's arguments. Exit codes: 0 done, 1 ran but the result is not usable, 2 wrong use
/// or input, 130, 143 or 129 interrupted by SIGINT, SIGTERM or SIGHUP. A reader that closes our output early (`| head`) is no error.
#[must_use]
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => {
            let text = usage.render().to_string();
            // Nobody is left to tell when even this cannot be printed.
            let _ = match console::cut(&text) {
                short if short != text => write!(io::stderr().lock(), "{short}"),
                _ => usage.print(),
            };
            return if usage.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    match cli.verb.run(Console::new(cli.quiet)) {
        Ok(ending) => ending.into(),
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            console::error(&error);
            ExitCode::from(2)
        }
    }
}

impl Verb {
    fn run(&self, console: Console) -> anyhow::Result<Ending> {
        match self {
            Self::Tune(verb) => verb.run(console),
            Self::Filter(verb) => verb.run(console),
            Self::Check(verb) => verb.run(console),
            Self::Init(verb) => verb.run(console),
            Self::Tape(verb) => verb.run(console),
            Self::Simulate(verb) => verb.run(console),
            Self::Evaluate(verb) => verb.run(console),
            Self::Compare(verb) => verb.run(console),
            Self::Bench(verb) => verb.run(console),
            Self::Reproduce(verb) => verb.run(console),
            #[cfg(feature = "gpu")]
            Self::Devices(verb) => verb.run(console),
            #[cfg(feature = "gpu")]
            Self::Shader(verb) => verb.run(console),
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| cause.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == ErrorKind::BrokenPipe))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_argument_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_flag_says_what_it_does_and_its_default() {
        for verb in Cli::command().get_subcommands() {
            for flag in verb.get_arguments().filter(|a| !a.is_positional()) {
                let help =
                    flag.get_long_help().or_else(|| flag.get_help()).map(ToString::to_string).unwrap_or_default();
                let says_default = help.contains("default") || !flag.get_default_values().is_empty();
                assert!(says_default, "{} --{}: {help:?}", verb.get_name(), flag.get_id());
            }
        }
    }

    #[test]
    fn a_broken_pipe_is_found_under_its_context() {
        let pipe = anyhow::Error::from(io::Error::from(ErrorKind::BrokenPipe)).context("cannot write");
        assert!(is_broken_pipe(&pipe), "{pipe:#}");
        let full = anyhow::Error::from(io::Error::from(ErrorKind::StorageFull));
        assert!(!is_broken_pipe(&full), "{full:#}");
    }
}
