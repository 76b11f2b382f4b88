//! `kfgpu tune`: the main job.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use anyhow::anyhow;
use clap::Args;

use super::checkpoint::{Keeper, Resumed};
use super::console::{self, Console};
use super::evaluator::Chosen;
use super::files;
use super::folder::OutFolder;
use super::held_out::{self, Trust};
use super::interrupt::Interrupt;
use super::load::{self, Loaded};
use super::options::Compute;
use super::output::{Asked, Output};
use super::overrides::{self, Override};
use super::progress::Progress;
use super::{Ending, memory, pictures, results};
use crate::data::Log;
use crate::evaluate::Evaluator;
use crate::model::{Problem, TuneSpec};
use crate::reference;
use crate::report::{Effort, LogFacts, Nothing, Tuning, mean_nis, unmet};
use crate::study::{self, Judge, Observer, Outcome, StopReason, Study};

/// Search the parameters of a filter on a log, and report how much better the best found is.
///
/// With no file, tunes a built-in example (the level of the Nile, 1871-1970) on data that ships with the program.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Tune {
    /// Problem file (TOML; `kfgpu init LOG.csv` writes one).
    problem: Option<PathBuf>,

    /// Log to tune on in place of the problem file's; `-` reads it from standard input (default: the file's
    /// `data.file`), to use one problem file on many logs.
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    /// Constraint on the winner, such as '0.8 <= nis_mean <= 1.2' or 'rmse <= 5'; may be given several times (default:
    /// the file's `tune.constraints`, which these replace).
    #[arg(long = "constraint", value_name = "BOUND")]
    constraints: Vec<String>,

    /// Member of the front to recommend, with several objectives: `knee`, the name of an objective for the best in it, or
    /// weights such as nll=0.7,rmse=0.3 (default: the file's `tune.pick`, or knee).
    #[arg(long, value_name = "PICK")]
    pick: Option<String>,

    /// Optimiser: pso, pso-inertia, pio, pio-printed, pio+ for one objective, nsga2, nsga2-study, moma, moma-annealed for a
    /// front, random for both (default: the file's `tune.algorithm`), to compare searches.
    #[arg(long, value_name = "NAME")]
    algorithm: Option<String>,

    /// Objectives to minimise, separated by commas, such as `nll` or `nll,nis` (default: the file's `tune.objectives`);
    /// options of an objective stay as the file has them.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    objectives: Vec<String>,

    #[command(flatten)]
    search: Search,

    #[command(flatten)]
    trust: Trust,

    #[command(flatten)]
    compute: Compute,

    /// Folder for result.json, report.md, tuned.toml (a problem file ready to run), history.csv, checkpoint.kfgpu and
    /// figures/ (pictures of the search and of the tuned filter as SVG) (default: none is written); it is made if need be,
    /// and tried before the search starts so that no result is lost.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// File to resume from, written after every generation (default: checkpoint.kfgpu in the folder of --out, or in
    /// place of the one resumed from).
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,

    /// Go on with the search of this checkpoint, or of the folder of --out that it is in, to the same bits as if it had
    /// not been interrupted (default: start anew). It knows its problem and log; flags that only stop a search, or say
    /// where it is computed, may be others.
    #[arg(long, value_name = "FILE|DIR")]
    resume: Option<PathBuf>,

    /// Replace what is in the folder of --out, and the file of --checkpoint, whatever it is (default: an earlier run of the
    /// same problem or log is kept in a folder DIR.1, DIR.2, ...; a run of another study, files that are no run's and a
    /// checkpoint that is not resumed are refused).
    #[arg(long)]
    force: bool,

    /// Print the result as one JSON object on stdout (default: a short report), for programs.
    #[arg(long)]
    json: bool,
}

/// How far the search goes.
#[derive(Debug, Args)]
struct Search {
    /// Candidates a generation (default: the file's `tune.population`); more find better optima of many parameters.
    #[arg(long, value_name = "N")]
    population: Option<i64>,

    /// Generations after the initial one (default: the file's `tune.generations`).
    #[arg(long, value_name = "N")]
    generations: Option<i64>,

    /// Seed of every random draw (default: the file's `tune.seed`); the same seed gives the same bits on any number of
    /// threads.
    #[arg(long, value_name = "N")]
    seed: Option<i64>,

    /// Stop after this many evaluations, one candidate on the whole log each (default: the file's
    /// `tune.stop.evaluations`, or no limit).
    #[arg(long, value_name = "N")]
    evaluations: Option<i64>,

    /// Stop after this long, in seconds, polish included (default: the file's `tune.stop.wall_time`, or no limit); two such
    /// runs may differ.
    #[arg(long, value_name = "SECONDS")]
    wall_time: Option<f64>,

    /// Stop after this many generations without a gain (default: the file's `tune.stop.stall`, or never).
    #[arg(long, value_name = "GENERATIONS")]
    stall: Option<i64>,

    /// Stop when the first objective is at or below this, in its own unit (default: the file's `tune.stop.target`, or none).
    #[arg(long, value_name = "COST")]
    target: Option<f64>,

    /// Leave out the local searches in f64 that end a study (default: as the file's `tune.polish`, true), to see what the optimiser itself found.
    #[arg(long)]
    no_polish: bool,

    /// Leave the file's start values out of generation 0 (default: as the file's `tune.include_start`, true), to see
    /// what is found without them; the winner may then be worse than the baseline.
    #[arg(long)]
    no_start: bool,
}

impl Tune {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let interrupt = Interrupt::listen()?;
        let resumed = self.resume.as_deref().map(Resumed::open).transpose()?;
        let Loaded { problem, log, origin, warnings } = self.load(resumed.as_ref(), console)?;
        memory::ensure_population_fits(&problem)?;
        let facts = LogFacts::of(&log);
        let split = self.trust.split(&problem, log)?;
        resumed.as_ref().map(|resumed| resumed.check(&problem, &split.train)).transpose()?;
        let doubts = held_out::doubts(&problem, &split, &origin);
        doubts.iter().for_each(|doubt| console.warn(doubt));
        let asked = Asked { out: self.out.as_deref(), checkpoint: self.checkpoint.as_deref(), force: self.force };
        let mut output = Output::prepare(asked, resumed.as_ref(), &problem, &split.train, &origin)?;
        let stop = interrupt.flag();
        let (outcome, evaluator) = self.study(&problem, &split.train, resumed.as_ref(), &mut output, &stop, console)?;
        let (folder, stopped) = (output.folder(), Ending::Interrupted(interrupt.exit_code()));

        let device = evaluator.device();
        let warnings = [warnings, doubts, evaluator.notices.said()].concat();
        let said = warnings.len();
        let effort = Effort::of(&problem, facts, &outcome, device, warnings);
        let Some(winner) = &outcome.winner else {
            let not_usable = self.report_nothing(effort, &outcome, folder)?;
            return Ok(if outcome.stop == StopReason::Interrupted { stopped } else { not_usable });
        };
        let tuning = Tuning::of(effort, &problem, &split, (&outcome, winner))?;
        let scorer = || evaluator.in_f64(self.compute.cpu());
        let write = |folder: &OutFolder| {
            let logs = pictures::Logs { train: &split.train, held_out: held_out::judged(&split, &tuning) };
            let pictures = pictures::Study { logs, outcome: &outcome, winner, scorer: &scorer };
            results::write(folder, &problem, &origin, &tuning, &pictures)
        };
        // What was found is said even where the disk is full.
        let written = folder.map(write).transpose();
        self.show(&tuning, &tuning.effort.warnings[said..], console)?;
        written?;
        let feasible = unmet(&tuning.constraints).map(|sentence| console::error(&anyhow!(sentence))).is_none();
        Ok(match outcome.stop {
            StopReason::Interrupted => stopped,
            _ if feasible => Ending::Done,
            _ => Ending::NotUsable,
        })
    }

    /// The result on stdout, and what has not been said of it yet.
    fn show(&self, tuning: &Tuning, unsaid: &[String], console: Console) -> anyhow::Result<()> {
        if self.json {
            files::print_json(tuning)?;
        } else {
            files::print(&tuning.to_string())?;
        }
        unsaid.iter().for_each(|warning| console.warn(warning));
        Ok(())
    }

    /// The problem with its flags, and its log; those of the checkpoint where no others are given.
    fn load(&self, resumed: Option<&Resumed>, console: Console) -> anyhow::Result<Loaded> {
        let path = self.problem.as_deref();
        let of_checkpoint = resumed.filter(|_| path.is_none());
        let problem = of_checkpoint.map_or_else(|| load::problem(path), Resumed::problem)?;
        self.trust.check(&problem, self.data.as_deref())?;
        let overrides = self.overrides(&problem);
        let problem = overrides::apply(problem, &overrides)?;
        let data = self.data.as_deref();
        match of_checkpoint {
            Some(resumed) => resumed.log(problem, data, console),
            None => load::log_of(problem, path, data, console),
        }
    }

    /// Searches until it ends or is asked to stop.
    fn study(
        &self,
        problem: &Problem,
        log: &Log,
        resumed: Option<&Resumed>,
        output: &mut Output,
        stop: &AtomicBool,
        console: Console,
    ) -> anyhow::Result<(Outcome, Chosen)> {
        let compute = resumed.map_or_else(|| Ok(self.compute.clone()), |resumed| resumed.compute(&self.compute))?;
        let mut evaluator = Chosen::new(problem, log, &compute, candidates(&problem.tune), console)?;
        let wants_another = problem.tune.polish && !evaluator.can_polish();
        let mut polisher = wants_another.then(|| evaluator.in_f64(compute.cpu()));
        let oracle = |candidate: &[f64]| reference::scores(problem, log, candidate).ok();
        let amplification =
            |candidate: &[f64]| reference::amplification(problem, log, candidate).unwrap_or(f64::INFINITY);
        let judge = Judge {
            oracle: &oracle,
            amplification: (!problem.filter.is_linear()).then_some(&amplification),
            polisher: polisher.as_mut().map(|p| p as &mut dyn Evaluator),
        };
        let mut progress = Progress::new(console, &problem.tune)?;
        let mut keeper = output.begin(problem, console)?.map(|file| Keeper::new(file, evaluator.notices.clone()));
        let mut observers: Vec<&mut dyn Observer> = vec![&mut progress];
        observers.extend(keeper.as_mut().map(|keeper| keeper as &mut dyn Observer));
        let study = Study::of(problem);
        let mut outcome = match resumed.map(Resumed::snapshot) {
            Some(from) => {
                evaluator.say_if_moved(&from.device);
                study::resume(&study, from, &mut evaluator, judge, &mut observers, stop)?
            }
            None => study::run(&study, &mut evaluator, judge, &mut observers, stop)?,
        };
        outcome.prefer_consistent(&problem.tune.pick, |candidate| mean_nis(problem, log, candidate));
        Ok((outcome, evaluator))
    }

    /// Says that every candidate failed, in the same places as a result.
    fn report_nothing(&self, effort: Effort, outcome: &Outcome, folder: Option<&OutFolder>) -> anyhow::Result<Ending> {
        let nothing = Nothing::of(effort);
        let why = why_nothing(outcome);
        if let Some(folder) = folder {
            results::write_nothing(folder, &nothing, &outcome.history, &why)?;
        }
        if self.json {
            files::print_json(&nothing)?;
        } else {
            files::print(&nothing.effort.to_string())?;
        }
        console::error(&anyhow!("no usable candidate: {why}"));
        Ok(Ending::NotUsable)
    }

    fn overrides(&self, problem: &Problem) -> Vec<Override> {
        let Search { population, generations, seed, evaluations, wall_time, stall, target, no_polish, no_start } =
            &self.search;
        let text = |flag, path, value: &Option<String>| value.as_ref().map(|v| Override::new(flag, path, v.as_str()));
        let integer = |flag, path, value: Option<i64>| value.map(|v| Override::new(flag, path, v));
        let number = |flag, path, value: Option<f64>| value.map(|v| Override::new(flag, path, v));
        let objectives = || Override::objectives(problem, &self.objectives);
        [
            text("--algorithm", &["tune", "algorithm"], &self.algorithm),
            (!self.objectives.is_empty()).then(objectives),
            (!self.constraints.is_empty()).then(|| Override::constraints(&self.constraints)),
            self.pick.as_deref().map(Override::pick),
            integer("--population", &["tune", "population"], *population),
            integer("--generations", &["tune", "generations"], *generations),
            integer("--seed", &["tune", "seed"], *seed),
            integer("--evaluations", &["tune", "stop", "evaluations"], *evaluations),
            number("--wall-time", &["tune", "stop", "wall_time"], *wall_time),
            integer("--stall", &["tune", "stop", "stall"], *stall),
            number("--target", &["tune", "stop", "target"], *target),
            no_polish.then(|| Override::switch("--no-polish", &["tune", "polish"], false)),
            no_start.then(|| Override::switch("--no-start", &["tune", "include_start"], false)),
        ]
        .into_iter()
        .flatten()
        .chain(self.trust.overrides(problem))
        .collect()
    }
}

/// Candidates of a whole study, if nothing ends it early.
fn candidates(tune: &TuneSpec) -> f64 {
    let all = tune.population as f64 * (tune.generations as f64 + 1.0);
    tune.evaluations.map_or(all, |allowed| all.min(allowed as f64))
}

/// Why a study has no winner.
fn why_nothing(Outcome { evaluations, failed, .. }: &Outcome) -> String {
    if *evaluations == 0 {
        "the search was stopped before its first generation was done".to_owned()
    } else if failed == evaluations {
        format!(
            "all {evaluations} evaluations failed (check with `kfgpu filter` that the start values run, and narrow the \
             bounds)"
        )
    } else {
        format!(
            "the f64 reference could run none of the best candidates, {failed} of {evaluations} evaluations failed (give \
             --precision f64 or narrow the bounds)"
        )
    }
}
