//! The MOMA study: R of a rocket's filter searched by NSGA-II and by a memetic form of it, against three filters that
//! are not tuned.
//!
//! H. Huo, Z. Cai, M. Liu, M. Gong, "The parameter optimization of Kalman filter based on multi-objective memetic
//! algorithm", GECCO 2014, doi 10.1145/2576768.2598242.

mod brute_force;
mod ends;
mod figures;
mod findings;
mod paths;
mod scenario;
mod search;
mod tables;
mod targets;

use super::protocol::{self, Protocol, Tell, seed_of};
use super::{Figure, PublishedStudy, ReproduceError, Table};
use crate::data::Log;
use crate::evaluate::{CpuEvaluator, Device, Population};
use crate::model::Problem;
use crate::optimize::nsga2::{self, Merge};
use paths::Path;
use scenario::{Filter, Scores};
use search::{Found, Method};

/// The row of the registry.
pub(super) const STUDY: PublishedStudy = PublishedStudy {
    name: "moma",
    about: "measurement noise of a rocket's filter by a multi-objective memetic algorithm, against adaptive filters",
    paper: "Huo, Cai, Liu, Gong: The Parameter Optimization of Kalman Filter Based on Multi-Objective Memetic \
            Algorithm, GECCO 2014, doi 10.1145/2576768.2598242",
    run: protocol::run::<Bench>,
};

/// A set of genetic operators that both methods use.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Profile {
    name: &'static str,
    genetic: nsga2::Rules,
}

/// Hardly any mutation, which gives the paper's contrast.
const PAPER_LIKE: Profile =
    Profile { name: "paper-like", genetic: nsga2::Rules { mutation_probability: Some(0.01), ..nsga2::STUDY } };

/// Mutation of every candidate, p_m = 1/m with one variable.
const STANDARD: Profile = Profile { name: "standard", genetic: nsga2::STUDY };

/// Algorithm 3, line 8 as printed: the chosen parents compete with the offspring, so elites are lost.
const PRINTED: Profile =
    Profile { name: "paper-like, P+O", genetic: nsga2::Rules { merge: Merge::Parents, ..PAPER_LIKE.genetic } };

/// How much is run, and with which operators.
#[derive(Debug, Clone, Copy)]
struct Plan {
    data_sets: u64,
    /// Runs a data set.
    runs: u64,
    /// Random fronts that ranks and crowding distances are checked on.
    fronts: u64,
    /// Paper-like, standard, printed.
    profiles: [Profile; 3],
}

/// A run with the RMSE of its answer.
#[derive(Debug, Clone)]
struct Run {
    found: Found,
    rmse: f64,
}

/// The runs of one profile on one data set.
#[derive(Debug, Clone)]
struct Tuned {
    nsga: Vec<Run>,
    moma: Vec<Run>,
}

/// Everything found on one data set.
#[derive(Debug, Clone)]
struct DataSet {
    index: u64,
    /// R0 of each run.
    starts: Vec<f64>,
    /// RMSE of each run with R = R0.
    regular: Vec<f64>,
    sage_husa: Vec<f64>,
    fuzzy: Vec<f64>,
    /// In the order of the plan's profiles.
    tuned: Vec<Tuned>,
    /// R and RMSE of least f1, and of least f2.
    ends: [(f64, f64); 2],
    /// Errors along the track with R of least f1, and with R = 43.
    paths: [Path; 2],
}

/// R0 of the untuned filter whose convergence Fig. 3 is about.
const LARGE: f64 = 43.0;

type Results = protocol::Results<Bench>;

fn summary(results: &Results) -> String {
    let Plan { data_sets, runs, .. } = results.plan;
    format!(
        "R of a three-state Kalman filter of a rocket tuned by NSGA-II and MOMA over (f1, f2), {} evaluations a run, on \
         {data_sets} data sets of {runs} runs each; the paper has one data set. RMSE is measured against the truth, which \
         no search sees.",
        search::BUDGET
    )
}

fn left_out(plan: &Plan) -> String {
    let Plan { data_sets, fronts, .. } = Bench::FULL;
    format!(
        "{} data sets in place of {data_sets}, {} random fronts in place of {fronts}; limits on means are wider by twice \
         what the smaller sample adds to their standard error, counts ask for all but one, and what six data sets cannot \
         show is printed, not gated.",
        plan.data_sets, plan.fronts
    )
}

/// RMSE of some runs.
fn rmse(runs: &[Run]) -> Vec<f64> {
    runs.iter().map(|run| run.rmse).collect()
}

/// The problems of the study.
struct Bench {
    both: Problem,
    regular: Problem,
    sage_husa: Problem,
    fuzzy: Problem,
}

impl Protocol for Bench {
    type Plan = Plan;
    type DataSet = DataSet;
    /// Random fronts on which ranks and crowding distances are those of their definitions.
    type Beside = u64;

    const FULL: Plan = Plan { data_sets: 20, runs: 30, fronts: 1000, profiles: [PAPER_LIKE, STANDARD, PRINTED] };
    const QUICK: Plan = Plan { data_sets: 6, fronts: 200, ..Self::FULL };
    const TELL: Tell<Self> = Tell {
        summary,
        left_out,
        targets: Results::targets,
        table: Results::summary_table,
        tables: Results::tables,
        findings: Results::findings,
        readings: findings::READINGS,
        data: Results::data,
    };

    fn new() -> Result<Self, ReproduceError> {
        Ok(Self {
            both: scenario::problem(Filter::Regular, Scores::Both)?,
            regular: scenario::problem(Filter::Regular, Scores::Rmse)?,
            sage_husa: scenario::problem(Filter::SageHusa, Scores::Rmse)?,
            fuzzy: scenario::problem(Filter::Fuzzy, Scores::Rmse)?,
        })
    }

    fn count(plan: &Plan) -> u64 {
        plan.data_sets
    }

    fn data_set(&self, plan: &Plan, seed: u64, index: u64) -> Result<DataSet, ReproduceError> {
        let log = scenario::log(&self.both, seed, index)?;
        let starts = scenario::starts(seed, index, plan.runs);
        let mut evaluator = super::evaluator(&self.both, &log)?;
        let mut regular = super::evaluator(&self.regular, &log)?;
        let nothing = || ReproduceError::Nothing { what: "the grid over R".to_owned(), data_set: index };
        let [f1, f2] = ends::ends(&mut evaluator).ok_or_else(nothing)?;
        let at_ends = rmse_of(&mut regular, &[f1, f2]);
        let mut tuned = Vec::with_capacity(plan.profiles.len());
        for (number, profile) in (0_u64..).zip(&plan.profiles) {
            let mut runs = |method, which: u64| -> Vec<Run> {
                let seed_of_run = |run| seed_of(seed, index, (number * 2 + which) * plan.runs + run);
                let search = |run| search::run(&self.both, &mut evaluator, method, profile.genetic, seed_of_run(run));
                let found: Vec<Found> = (0..plan.runs).map(search).collect();
                let answers: Vec<f64> = found.iter().map(|f| f.r).collect();
                let rmse = rmse_of(&mut regular, &answers);
                found.into_iter().zip(rmse).map(|(found, rmse)| Run { found, rmse }).collect()
            };
            tuned.push(Tuned { nsga: runs(Method::Genetic, 0), moma: runs(Method::Memetic, 1) });
        }
        Ok(DataSet {
            index,
            regular: rmse_of(&mut regular, &starts),
            sage_husa: rmse_of(&mut super::evaluator(&self.sage_husa, &log)?, &starts),
            fuzzy: rmse_of(&mut super::evaluator(&self.fuzzy, &log)?, &starts),
            starts,
            tuned,
            ends: [(f1, at_ends[0]), (f2, at_ends[1])],
            paths: [self.path(&log, f1, index)?, self.path(&log, LARGE, index)?],
        })
    }

    fn beside(&self, plan: &Plan, seed: u64) -> Result<u64, ReproduceError> {
        Ok(brute_force::agreements(seed, plan.fronts))
    }

    fn device(&self, seed: u64) -> Result<Device, ReproduceError> {
        super::device(&self.both, &scenario::log(&self.both, seed, 0)?)
    }

    fn pictures(&self, results: &Results) -> Result<(Vec<Figure>, Vec<Table>), ReproduceError> {
        let Some(shown) = results.shown(self)? else { return Ok(Default::default()) };
        Ok((shown.figures()?, shown.tables()))
    }
}

impl Bench {
    fn path(&self, log: &Log, r: f64, index: u64) -> Result<Path, ReproduceError> {
        Path::of(&self.regular, log, r).map_err(|failure| ReproduceError::Filter {
            what: format!("the filter with R = {r}"),
            data_set: index,
            failure,
        })
    }
}

/// RMSE of some R.
fn rmse_of(evaluator: &mut CpuEvaluator, r: &[f64]) -> Vec<f64> {
    super::scores(evaluator, &Population::from_rows(1, r.to_vec()))
}

#[cfg(test)]
mod tests;
