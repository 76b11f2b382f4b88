//! `kfgpu tune`: the main job.

use std::path::PathBuf;

use clap::Args;

use super::console::Console;
use super::options::Compute;
use super::{Ending, files};

/// Search the parameters of a filter on a log, and report how much better the best found is.
///
/// With no file, tunes a built-in example (the level of the Nile, 1871-1970) on data that ships with the program.
#[derive(Debug, Args)]
pub(super) struct Tune {
    /// Problem file (TOML; `kfgpu init LOG.csv` writes one).
    problem: Option<PathBuf>,

    /// Log to tune on in place of the problem file's; `-` reads it from standard input (default: the file's
    /// `data.file`), to use one problem file on many logs.
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Optimiser: pso, pso-inertia, pio, pio-printed, pio+, random (default: the file's `tune.algorithm`), to compare searches.
    #[arg(long, value_name = "NAME")]
    algorithm: Option<String>,

    /// Objectives to minimise, separated by commas, such as `nll` or `nll,nis` (default: the file's `tune.objectives`);
    /// options of an objective stay as the file has them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    objectives: Vec<String>,

    #[command(flatten)]
    search: Search,

    #[command(flatten)]
    compute: Compute,

    /// Folder for result.json, tuned.toml (a problem file ready to run) and history.csv (default: none is written); it
    /// is made if need be, and tried before the search starts so that no result is lost.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Print the result as one JSON object on stdout (default: a short report), for programs.
    #[arg(long)]
    json: bool,
}

/// How far the search goes.
#[derive(Debug, Args)]
struct Search {
    /// Candidates a generation (default: the file's `tune.population`); more find better optima of many parameters.
    #[arg(long, value_name = "N")]
    population: Option<usize>,

    /// Generations after the initial one (default: the file's `tune.generations`).
    #[arg(long, value_name = "N")]
    generations: Option<usize>,

    /// Seed of every random draw (default: the file's `tune.seed`); the same seed gives the same bits on any number of
    /// threads.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Stop after this many evaluations, one candidate on the whole log each (default: the file's
    /// `tune.stop.evaluations`, or no limit).
    #[arg(long, value_name = "N")]
    evaluations: Option<u64>,

    /// Stop after this long, in seconds (default: the file's `tune.stop.wall_time`, or no limit); two such runs may differ.
    #[arg(long, value_name = "SECONDS")]
    wall_time: Option<f64>,

    /// Stop after this many generations without a gain (default: the file's `tune.stop.stall`, or never).
    #[arg(long, value_name = "GENERATIONS")]
    stall: Option<usize>,

    /// Stop when the first objective is at or below this, in its own unit (default: the file's `tune.stop.target`, or none).
    #[arg(long, value_name = "COST", allow_negative_numbers = true)]
    target: Option<f64>,

    /// Leave out the local search in f64 that ends a study of one objective (default: as the file's `tune.polish`,
    /// true), to see what the optimiser itself found.
    #[arg(long)]
    no_polish: bool,

    /// Leave the file's start values out of generation 0 (default: as the file's `tune.include_start`, true), to see
    /// what is found without them; the winner may then be worse than the baseline.
    #[arg(long)]
    no_start: bool,
}
