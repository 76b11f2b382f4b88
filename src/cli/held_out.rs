//! `tune --validate` and `--realisations`: what a result is judged on.

use anyhow::{anyhow, bail};
use clap::Args;

use super::load::Origin;
use super::overrides::Override;
use crate::data::{HeldOut, Log};
use crate::model::Problem;
use crate::report::{Rows, Tuning};
use crate::study::Split;

/// What the result is judged on.
#[derive(Debug, Args)]
pub(super) struct Trust {
    /// Share of the log to hold out, above 0 and below 1: the search never sees it, and the result is scored on it
    /// (default: the file's `data.validate`, or none). Several trajectories are held out whole, of one the last rows are,
    /// and of a simulated log fresh realisations; `data.validate = { share = 0.3, by = "time" }` chooses.
    #[arg(long, value_name = "SHARE", conflicts_with = "no_validate")]
    validate: Option<f64>,

    /// Hold nothing out, whatever the file's `data.validate` says (default: as the file says), to tune on every row.
    #[arg(long)]
    no_validate: bool,

    /// Realisations of a simulated log that every candidate is scored on, pooled, so that nothing is tuned to one draw of
    /// the noise (default: the file's `simulate.trajectories`).
    #[arg(long, value_name = "R")]
    realisations: Option<i64>,
}

impl Trust {
    pub(super) fn overrides(&self, problem: &Problem) -> impl Iterator<Item = Override> {
        let by = problem.data.validate.and_then(|spec| spec.by);
        let validate = self.validate.map(|share| Override::validate(share, by));
        let none = self.no_validate.then(|| Override::switch("--no-validate", &["data", "validate"], false));
        let realisations = self.realisations.map(|r| Override::new("--realisations", &["simulate", "trajectories"], r));
        validate.into_iter().chain(none).chain(realisations)
    }

    /// Refuses realisations of a log that is not drawn.
    pub(super) fn check(&self, problem: &Problem, data: Option<&str>) -> anyhow::Result<()> {
        let file = data.or(problem.data.file.as_deref());
        if let (Some(_), Some(file)) = (self.realisations, file) {
            bail!("--realisations: the log is read from {file}, and only one drawn from [simulate] has realisations");
        }
        Ok(())
    }

    /// Parts the log; an error of `--validate` names the flag.
    pub(super) fn split(&self, problem: &Problem, log: Log) -> anyhow::Result<Split> {
        Split::of(problem, log).map_err(|error| match self.validate {
            Some(share) => anyhow!("--validate {share}: {}", error.cause),
            None => error.into(),
        })
    }
}

/// What is said of a log drawn once.
const SINGLE_REALISATION: &str = "the log is a single simulated realisation, so what is tuned fits one draw of the noise \
                                  (give --realisations 20, or `trajectories` in [simulate])";

/// What the user should know about what is tuned on, in sentences.
pub(super) fn doubts(problem: &Problem, split: &Split, origin: &Origin) -> Vec<String> {
    let single = *origin == Origin::Simulated && split.train.trajectories.len() == 1;
    single.then(|| SINGLE_REALISATION.to_owned()).into_iter().chain(split.warnings(problem)).collect()
}

/// The held-out rows, if consistency was judged on them.
pub(super) fn judged<'a>(split: &'a Split, tuning: &Tuning) -> Option<&'a HeldOut> {
    split.held_out.as_ref().filter(|_| tuning.consistency_on == Rows::HeldOut)
}
