//! `kfgpu evaluate`: costs of given candidates, so that any outside optimiser can drive a filter.

use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use clap::Args;
use serde::Serialize;

use super::candidates::{Batch, Candidates};
use super::console::Console;
use super::evaluator::Chosen;
use super::options::Compute;
use super::{Ending, files, load};
use crate::evaluate::{Device, Evaluation, Evaluator, Status};
use crate::model::{Parameter, Parameters, Search};
use crate::objective::Objective;
use crate::report::{Named, exact};

/// Score given candidates: CSV in, CSV of costs out, in the same order.
///
/// The input's header names the searched parameters, in any order; values are in their own units. The answer has one
/// column per objective, `violation` if the problem has constraints (0 = feasible), and `status`: 0 = usable, 1 = Q, R
/// or P0 is no covariance or that of the innovations was not positive, 2 = a cost was not finite for another reason, 8 =
/// the line is no candidate. A candidate that failed costs 1.7976931348623157e308, the worst finite number. One outside
/// the bounds of its parameters is scored like any other, and the first is said on stderr.
///
/// With `-` candidates are answered as they arrive, line by line, as long as the input lasts: one process serves a
/// whole search. A line that is no candidate (NaN, an empty cell, a cell too few) is answered as failed, with status 8,
/// and the first ten are said on stderr; in a file such a line ends the command with exit code 2.
#[derive(Debug, Args)]
pub(super) struct Evaluate {
    /// Problem file (TOML).
    problem: PathBuf,

    /// Candidates (CSV with a header); `-` reads standard input and answers line by line.
    candidates: PathBuf,

    /// Log to score on in place of the problem file's (default: the file's `data.file`).
    #[arg(long, value_name = "FILE")]
    data: Option<String>,

    #[command(flatten)]
    compute: Compute,

    /// Print one JSON object with objectives, status and device at the end of the input (default: CSV as it goes), for
    /// programs.
    #[arg(long)]
    json: bool,
}

/// All costs, by objective.
#[derive(Debug, Serialize)]
struct Costs {
    objectives: Named<Vec<f64>>,
    /// How far each is from satisfying the constraints, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    violation: Option<Vec<f64>>,
    status: Vec<u32>,
    device: Device,
}

impl Evaluate {
    pub(super) fn run(&self, console: Console) -> anyhow::Result<Ending> {
        let from_stdin = self.candidates == Path::new("-");
        let loaded = load::load(Some(&self.problem), self.data.as_deref(), console)?;
        let taken = from_stdin && loaded.origin == load::Origin::Stdin;
        ensure!(!taken, "standard input cannot be both the log and the candidates (give one of them as a file)");
        let (problem, log) = (&loaded.problem, &loaded.log);
        ensure!(
            problem.parameters.dimension() > 0,
            "{}: no parameter is searched, so there is nothing to evaluate (give one of [parameters] min and max)",
            problem.source
        );
        let mut evaluator = Chosen::new(problem, log, &self.compute, self.count()?, console)?;
        let candidates =
            Candidates::open(self.input(from_stdin)?, &self.source(from_stdin), &problem.parameters.names())?;
        let mut answers = Answers {
            candidates,
            evaluator: &mut evaluator,
            parameters: &problem.parameters,
            objectives: problem.tune.objectives.iter().map(Objective::name).collect(),
            constrained: !problem.tune.constraints.is_empty(),
            lives_on: from_stdin,
            doubts: Doubts::new(console),
        };
        if self.json {
            files::print_json(&answers.collect()?)?;
        } else {
            answers.print()?;
        }
        Ok(Ending::Done)
    }

    fn input(&self, from_stdin: bool) -> anyhow::Result<Box<dyn Read>> {
        if from_stdin {
            return Ok(Box::new(io::stdin()));
        }
        let file =
            File::open(&self.candidates).with_context(|| format!("cannot read {}", self.candidates.display()))?;
        Ok(Box::new(file))
    }

    /// About how many candidates there are: lines of a file; of a pipe, which comes a line at a time, none is known.
    fn count(&self) -> anyhow::Result<f64> {
        if !self.candidates.is_file() {
            return Ok(0.0);
        }
        let mut file = BufReader::with_capacity(1 << 20, self.input(false)?);
        let mut lines = 0.0;
        loop {
            let read = file.fill_buf().with_context(|| format!("cannot read {}", self.candidates.display()))?;
            if read.is_empty() {
                return Ok(lines);
            }
            let (length, ends) = (read.len(), read.iter().filter(|byte| **byte == b'\n').count());
            lines += ends as f64;
            file.consume(length);
        }
    }

    fn source(&self, from_stdin: bool) -> String {
        if from_stdin { "<stdin>".to_owned() } else { self.candidates.display().to_string() }
    }
}

/// Answers lines in their order.
struct Answers<'a, R> {
    candidates: Candidates<R>,
    evaluator: &'a mut dyn Evaluator,
    parameters: &'a Parameters,
    objectives: Vec<&'static str>,
    constrained: bool,
    /// Whether a line that is no candidate is answered too, because whoever asks has no other answer.
    lives_on: bool,
    doubts: Doubts,
}

/// The answer to one line.
struct Answer<'a> {
    costs: &'a [f64],
    violation: f64,
    status: Status,
}

impl<R: Read> Answers<'_, R> {
    /// Gives the answers to whatever has arrived to `take`; false at the end of the input.
    fn next(&mut self, take: &mut impl FnMut(Answer<'_>) -> anyhow::Result<()>) -> anyhow::Result<bool> {
        let Some(Batch { candidates, lines }) = self.candidates.next_batch()? else { return Ok(false) };
        let evaluation =
            if candidates.is_empty() { Evaluation::default() } else { self.evaluator.evaluate(&candidates) };
        let failed = vec![Evaluation::FAILED; self.objectives.len()];
        let mut next = 0;
        for (line, read) in lines {
            let at = || self.candidates.position(line);
            if let Err(problem) = read {
                ensure!(self.lives_on, "{}: {problem}", at());
                self.doubts.no_candidate(&at(), &problem);
                take(Answer { costs: &failed, violation: Evaluation::FAILED, status: Status::UNREADABLE })?;
                continue;
            }
            self.doubts.outside(self.parameters, candidates.row(next), at);
            // As the cost of a failed candidate, an infinite violation is the worst finite number.
            let violation = evaluation.violation(next).min(Evaluation::FAILED);
            take(Answer { costs: evaluation.costs(next), violation, status: evaluation.status(next) })?;
            next += 1;
        }
        Ok(true)
    }

    /// As CSV; each answer is flushed, because whoever asked may be waiting for it.
    fn print(&mut self) -> anyhow::Result<()> {
        let mut out = io::BufWriter::new(io::stdout().lock());
        let constrained = self.constrained;
        writeln!(out, "{},{}status", self.objectives.join(","), if constrained { "violation," } else { "" })?;
        out.flush()?;
        let mut more = true;
        while more {
            let written = self.next(&mut |answer| Ok(answer.write(constrained, &mut out)?));
            // What was answered before an error is not lost.
            out.flush()?;
            more = written?;
        }
        Ok(())
    }

    fn collect(&mut self) -> anyhow::Result<Costs> {
        let mut costs = vec![Vec::new(); self.objectives.len()];
        let (mut violation, mut status) = (self.constrained.then(Vec::new), Vec::new());
        let mut take = |answer: Answer<'_>| {
            costs.iter_mut().zip(answer.costs).for_each(|(column, cost)| column.push(*cost));
            violation.iter_mut().for_each(|column| column.push(answer.violation));
            status.push(answer.status.bits());
            Ok(())
        };
        while self.next(&mut take)? {}
        let objectives = Named::new(self.objectives.iter().copied(), costs);
        Ok(Costs { objectives, violation, status, device: self.evaluator.device() })
    }
}

impl Answer<'_> {
    fn write(&self, constrained: bool, out: &mut impl Write) -> io::Result<()> {
        for cost in self.costs {
            write!(out, "{},", exact(*cost))?;
        }
        if constrained {
            write!(out, "{},", exact(self.violation))?;
        }
        writeln!(out, "{}", self.status.bits())
    }
}

/// What is said of candidates on stderr: a few times, because nobody may be reading it.
struct Doubts {
    console: Console,
    told: usize,
    has_told_outside: bool,
}

impl Doubts {
    /// So many lines are told one by one.
    const TOLD: usize = 10;

    const fn new(console: Console) -> Self {
        Self { console, told: 0, has_told_outside: false }
    }

    fn no_candidate(&mut self, at: &str, problem: &str) {
        self.told += 1;
        if self.told <= Self::TOLD {
            let rest = if self.told == Self::TOLD { "; more such lines are not told" } else { "" };
            self.console.warn(format_args!("{at}: {problem} (answered as failed, with status 8{rest})"));
        }
    }

    fn outside(&mut self, parameters: &Parameters, candidate: &[f64], at: impl Fn() -> String) {
        if self.has_told_outside {
            return;
        }
        let mut searched = parameters.searched().zip(candidate);
        let is_outside =
            |((_, search), value): &((&Parameter, &Search), &f64)| !(search.min..=search.max).contains(*value);
        if let Some(((parameter, search), value)) = searched.find(is_outside) {
            self.has_told_outside = true;
            self.console.warn(format_args!(
                "{}: {} = {} lies outside its bounds {} to {} (candidates out of bounds are scored like any other; said \
                 once)",
                at(),
                parameter.name,
                exact(*value),
                exact(search.min),
                exact(search.max)
            ));
        }
    }
}
