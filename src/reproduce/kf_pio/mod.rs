//! The KF-PIO study: R of a planar filter searched by pigeons and by particles, scored against the truth.
//!
//! The receiver of an aerial refuelling tracks a tanker whose moves it knows and whose position it measures. J is the
//! distance between estimate and truth summed over the track, and R = M M' is searched.

mod figures;
mod findings;
mod optimum;
mod oracle;
mod scenario;
mod search;
mod tables;
mod targets;

use rayon::prelude::*;

use super::protocol::{self, Protocol, Tell, seed_of};
use super::{Figure, PublishedStudy, ReproduceError, Table};
use crate::data::Log;
use crate::evaluate::{CpuEvaluator, Device, Population};
use crate::model::Problem;
use crate::optimize::{pio, pso};
use crate::random::{Purpose, Stream};
use oracle::{Noise, Spectrum};
use scenario::Bounds;
use search::{Ground, Method, Run};

/// The row of the registry.
pub(super) const STUDY: PublishedStudy = PublishedStudy {
    name: "kf-pio",
    about: "measurement noise of a tracking filter by pigeon-inspired optimisation, against particle swarms",
    paper: "Zhao, Deng, Wei, Hu, Duan, Luo: A Kalman Filtering Algorithm Based on Pigeon-inspired Optimization for \
            Target Tracking in Autonomous Aerial Refueling",
    run: protocol::run::<Bench>,
};

/// How much is run, and with which pigeons.
#[derive(Debug, Clone)]
struct Plan {
    /// Data sets that are tuned on.
    data_sets: u64,
    /// Data sets that the untuned filter alone is scored on.
    untuned: u64,
    /// Random M that tape, reference and oracle are compared on.
    matrices: u64,
    /// Local searches a data set.
    local_searches: u64,
    /// Fresh realisations a data set.
    fresh: u64,
    /// The published pigeons.
    pio: pio::Rules,
    /// The swarm they are compared with.
    pso: pso::Rules,
}

/// Values of r beside the published 0.2.
const SWEEP: [f64; 5] = [0.1, 0.05, 0.02, 0.01, 0.0];

/// Boxes that searches are clipped to, beside the free search.
const BOXES: [Bounds; 2] = [Bounds::Box(-50.0, 50.0), Bounds::Box(0.0, 3.162_277_660_168_379_5)];

/// rho of the fixed R = rho I that held-out scores are compared with.
const FIXED: f64 = 50.0;

/// Everything found on one data set.
#[derive(Debug, Clone)]
struct DataSet {
    index: u64,
    /// J at R = I.
    untuned: f64,
    pio: Run,
    printed: Run,
    plus: Run,
    pso: Run,
    /// Pigeons with the r of [`SWEEP`].
    sweep: Vec<Run>,
    /// Pigeons and particles in the boxes of [`BOXES`].
    boxed: Vec<(Run, Run)>,
    /// Least J of independent local searches.
    optimum: f64,
    /// J over fresh realisations.
    held_out: HeldOut,
}

/// Sums of J over fresh realisations of the track.
#[derive(Debug, Clone, Copy)]
struct HeldOut {
    untuned: f64,
    pio: f64,
    pso: f64,
    /// R = [`FIXED`] I.
    fixed: f64,
}

impl DataSet {
    fn methods(&self) -> [(&'static str, &Run); 4] {
        [("KF-PIO", &self.pio), ("KF-PIO printed", &self.printed), ("KF-PIO+", &self.plus), ("KF-PSO", &self.pso)]
    }
}

/// What is measured beside the data sets.
struct Beside {
    /// J of the untuned filter, one a track.
    untuned: Vec<f64>,
    /// Largest relative difference of J over random M: tape and reference against the oracle.
    oracle_gap: f64,
}

type Results = protocol::Results<Bench>;

fn summary(_: &Results) -> String {
    "R = M M' of a planar Kalman filter tuned on one noisy track, scored by J = the sum of |estimate - truth| over its 50 \
     rows. Every J of a tuned filter is in-sample unless called held-out."
        .to_owned()
}

fn left_out(plan: &Plan) -> String {
    let Plan { data_sets, untuned, matrices, .. } = Bench::FULL;
    format!(
        "{} data sets in place of {data_sets}, {} untuned tracks in place of {untuned}, {} random M in place of \
         {matrices}; intervals are as wide as the smaller sample needs, and counts ask for all but one.",
        plan.data_sets, plan.untuned, plan.matrices
    )
}

/// The problems of the study: the same filter in different boxes.
struct Bench {
    free: Problem,
    boxed: Vec<Problem>,
}

impl Protocol for Bench {
    type Plan = Plan;
    type DataSet = DataSet;
    type Beside = Beside;

    const FULL: Plan = Plan {
        data_sets: 30,
        untuned: 1000,
        matrices: 1000,
        local_searches: 20,
        fresh: 40,
        pio: pio::PUBLISHED,
        pso: pso::CONSTRICTION,
    };
    const QUICK: Plan = Plan { data_sets: 10, untuned: 250, matrices: 200, ..Self::FULL };
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
        let boxed = BOXES.iter().map(|bounds| scenario::problem(*bounds)).collect::<Result<_, _>>()?;
        Ok(Self { free: scenario::problem(Bounds::Free)?, boxed })
    }

    fn count(plan: &Plan) -> u64 {
        plan.data_sets
    }

    fn data_set(&self, plan: &Plan, seed: u64, index: u64) -> Result<DataSet, ReproduceError> {
        let log = scenario::log(seed, index);
        let mut evaluator = self.evaluator(&log)?;
        let untuned = untuned(&mut evaluator);
        let mut ground = Ground { data_set: index, log: &log, evaluator: &mut evaluator };
        // The same seed for all: every method starts from the same population.
        let search_seed = seed_of(seed, index, 0);
        let mut search = |problem: &Problem, method| search::run(&mut ground, problem, method, search_seed);
        let swarm = Method::Pso(plan.pso);
        let pio = search(&self.free, Method::Pio(plan.pio))?;
        let printed = search(&self.free, Method::Pio(pio::PRINTED))?;
        let plus = search(&self.free, Method::Pio(pio::PLUS))?;
        let pso = search(&self.free, swarm)?;
        let with_r = |r| Method::Pio(pio::Rules { r, ..plan.pio });
        let sweep = SWEEP.iter().map(|r| search(&self.free, with_r(*r))).collect::<Result<_, _>>()?;
        let both = |problem| Ok((search(problem, Method::Pio(plan.pio))?, search(problem, swarm)?));
        let boxed = self.boxed.iter().map(both).collect::<Result<_, ReproduceError>>()?;
        let noise = Noise::of(&log.trajectories[0]);
        let optimum = optimum::search(&noise, plan.local_searches, seed_of(seed, index, 1))?;
        let held_out = self.held_out(&scenario::fresh(seed, index, plan.fresh), &pio, &pso)?;
        Ok(DataSet { index, untuned, pio, printed, plus, pso, sweep, boxed, optimum, held_out })
    }

    fn beside(&self, plan: &Plan, seed: u64) -> Result<Beside, ReproduceError> {
        let untuned = |index| Ok(untuned(&mut self.evaluator(&scenario::log(seed, index))?));
        let untuned = (0..plan.untuned).into_par_iter().map(untuned).collect::<Result<_, ReproduceError>>()?;
        Ok(Beside { untuned, oracle_gap: self.oracle_gap(plan, seed)? })
    }

    fn device(&self, seed: u64) -> Result<Device, ReproduceError> {
        super::device(&self.free, &scenario::log(seed, 0))
    }

    fn pictures(&self, results: &Results) -> Result<(Vec<Figure>, Vec<Table>), ReproduceError> {
        let Some(shown) = results.shown(self)? else { return Ok(Default::default()) };
        Ok((shown.figures()?, vec![shown.table()]))
    }
}

impl Bench {
    fn evaluator(&self, log: &Log) -> Result<CpuEvaluator, ReproduceError> {
        super::evaluator(&self.free, log)
    }

    fn held_out(&self, fresh: &Log, pio: &Run, pso: &Run) -> Result<HeldOut, ReproduceError> {
        let fixed = scenario::UNTUNED.map(|m| m * FIXED.sqrt());
        let scores = j_of(&mut self.evaluator(fresh)?, &[&scenario::UNTUNED, &pio.factor, &pso.factor, &fixed]);
        Ok(HeldOut { untuned: scores[0], pio: scores[1], pso: scores[2], fixed: scores[3] })
    }

    /// The tape and the reference against the oracle, half the M from the start box, half from [-50, 50].
    fn oracle_gap(&self, plan: &Plan, seed: u64) -> Result<f64, ReproduceError> {
        let log = scenario::log(seed, 0);
        let noise = Noise::of(&log.trajectories[0]);
        let factors: Vec<[f64; 4]> = (0..plan.matrices).map(|index| random_factor(seed, index)).collect();
        let rows: Vec<&[f64]> = factors.iter().map(<[f64; 4]>::as_slice).collect();
        let tape = j_of(&mut self.evaluator(&log)?, &rows);
        let gap = |(m, tape): (&&[f64], &f64)| {
            let exact = noise.score(&Spectrum::of_factor(m));
            let reference = crate::reference::costs(&self.free, &log, m).map_or(f64::NAN, |costs| costs[0]);
            let gaps = [tape / exact - 1.0, reference / exact - 1.0].map(f64::abs);
            if gaps.iter().any(|g| g.is_nan()) { f64::INFINITY } else { gaps[0].max(gaps[1]) }
        };
        Ok(rows.par_iter().zip(&tape).map(gap).reduce(|| 0.0, f64::max))
    }
}

/// J of some M.
fn j_of(evaluator: &mut CpuEvaluator, factors: &[&[f64]]) -> Vec<f64> {
    super::scores(evaluator, &Population::from_rows(4, factors.concat()))
}

/// J at R = I.
fn untuned(evaluator: &mut CpuEvaluator) -> f64 {
    j_of(evaluator, &[&scenario::UNTUNED])[0]
}

fn random_factor(seed: u64, index: u64) -> [f64; 4] {
    let mut stream = Stream::new(seed, Purpose::Workload, u64::MAX, index);
    let [low, high] = if index.is_multiple_of(2) { [0.0, 10.0_f64.sqrt()] } else { [-50.0, 50.0] };
    std::array::from_fn(|_| low + stream.uniform() * (high - low))
}

#[cfg(test)]
mod tests;
