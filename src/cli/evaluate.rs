//! `kfgpu evaluate`: costs of given candidates, so that any outside optimiser can drive a filter.

use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use clap::Args;
use serde::Serialize;

use super::candidates::Candidates;
use super::console::Console;
use super::evaluator::Chosen;
use super::options::Compute;
use super::{Ending, files, load};
use crate::evaluate::{Device, Evaluation, Evaluator};
use crate::objective::Objective;
use crate::report::{Named, exact};

/// Score given candidates: CSV in, CSV of costs out, in the same order.
///
/// The input's header names the searched parameters, in any order; values are in their own units. The answer has one
/// column per objective, `violation` if the problem has constraints (0 = feasible), and `status`: 0 = usable, 1 = Q, R
/// or P0 is no covariance or that of the innovations was not positive, 2 = a cost was not finite for another reason. A
/// candidate that failed costs 1.7976931348623157e308, the worst finite number.
///
/// With `-` candidates are answered as they arrive, line by line, as long as the input lasts: one process serves a
/// whole search.
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
        let mut candidates =
            Candidates::open(self.input(from_stdin)?, &self.source(from_stdin), &problem.parameters.names())?;
        let names = problem.tune.objectives.iter().map(Objective::name).collect::<Vec<_>>();
        let constrained = !problem.tune.constraints.is_empty();
        if self.json {
            files::print_json(&collect(&mut candidates, &mut evaluator, names, constrained)?)?;
        } else {
            answer(&mut candidates, &mut evaluator, &names, constrained)?;
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

/// Answers batch by batch; each answer is flushed, because whoever asked may be waiting for it.
fn answer(
    candidates: &mut Candidates<impl Read>,
    evaluator: &mut dyn Evaluator,
    names: &[&str],
    constrained: bool,
) -> anyhow::Result<()> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    writeln!(out, "{},{}status", names.join(","), if constrained { "violation," } else { "" })?;
    out.flush()?;
    while let Some(batch) = candidates.next_batch()? {
        let evaluation = evaluator.evaluate(&batch);
        (0..batch.len()).try_for_each(|i| write_row(&evaluation, i, constrained, &mut out))?;
        out.flush()?;
    }
    Ok(())
}

fn write_row(evaluation: &Evaluation, i: usize, constrained: bool, out: &mut impl Write) -> io::Result<()> {
    for cost in evaluation.costs(i) {
        write!(out, "{},", exact(*cost))?;
    }
    if constrained {
        write!(out, "{},", exact(finite_violation(evaluation, i)))?;
    }
    writeln!(out, "{}", evaluation.status(i).bits())
}

/// As the cost of a failed candidate, an infinite violation is the worst finite number.
fn finite_violation(evaluation: &Evaluation, i: usize) -> f64 {
    evaluation.violation(i).min(Evaluation::FAILED)
}

fn collect(
    candidates: &mut Candidates<impl Read>,
    evaluator: &mut dyn Evaluator,
    names: Vec<&str>,
    constrained: bool,
) -> anyhow::Result<Costs> {
    let mut costs = vec![Vec::new(); names.len()];
    let mut violation = constrained.then(Vec::new);
    let mut status = Vec::new();
    while let Some(batch) = candidates.next_batch()? {
        let evaluation = evaluator.evaluate(&batch);
        for i in 0..batch.len() {
            costs.iter_mut().zip(evaluation.costs(i)).for_each(|(column, cost)| column.push(*cost));
            status.push(evaluation.status(i).bits());
            violation.iter_mut().for_each(|column| column.push(finite_violation(&evaluation, i)));
        }
    }
    Ok(Costs { objectives: Named::new(names, costs), violation, status, device: evaluator.device() })
}
