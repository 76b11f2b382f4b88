//! What a study says of itself, and the one driver that runs any.

use rand::TryRng as _;
use rayon::prelude::*;

use super::{Figure, Options, Progress, PublishedStudy, ReproduceError, Reproduction, Required, Table, Target};
use crate::evaluate::Device;
use crate::random::{Purpose, Stream};

/// A published study, with what all its data sets share: problems, networks, settings.
pub(super) trait Protocol: Sized + Sync {
    /// How much is run, and with which constants.
    type Plan: Clone + Sync + 'static;
    /// Everything found on one data set. A study of several scenes or settings numbers them through, and keeps here which
    /// one this was.
    type DataSet: Send;
    /// What is measured beside the data sets.
    type Beside;

    /// The study as published.
    const FULL: Self::Plan;
    /// Fewer repetitions.
    const QUICK: Self::Plan;
    /// What is made of the results.
    const TELL: Tell<Self>;

    fn new() -> Result<Self, ReproduceError>;

    /// Number of data sets.
    fn count(plan: &Self::Plan) -> u64;

    /// Draws data set `index`, and searches and scores on it; on one thread, since data sets run side by side.
    fn data_set(&self, plan: &Self::Plan, seed: u64, index: u64) -> Result<Self::DataSet, ReproduceError>;

    fn beside(&self, plan: &Self::Plan, seed: u64) -> Result<Self::Beside, ReproduceError>;

    /// Where costs were computed.
    fn device(&self, seed: u64) -> Result<Device, ReproduceError>;

    /// The pictures, and the numbers behind them.
    fn pictures(&self, results: &Results<Self>) -> Result<(Vec<Figure>, Vec<Table>), ReproduceError>;
}

/// What is made of a study's results, part by part of a [`Reproduction`].
pub(super) struct Tell<P: Protocol> {
    pub(super) summary: fn(&Results<P>) -> String,
    /// What a smaller plan than the full one leaves out.
    pub(super) left_out: fn(&P::Plan) -> String,
    pub(super) targets: fn(&Results<P>) -> Vec<Target>,
    pub(super) table: fn(&Results<P>) -> Table,
    pub(super) tables: fn(&Results<P>) -> Vec<Table>,
    pub(super) findings: fn(&Results<P>) -> Vec<String>,
    pub(super) readings: &'static [&'static str],
    pub(super) data: fn(&Results<P>) -> Vec<Table>,
}

/// All that targets, tables and pictures are made from.
pub(super) struct Results<P: Protocol> {
    pub(super) plan: P::Plan,
    pub(super) seed: u64,
    pub(super) data_sets: Vec<P::DataSet>,
    pub(super) beside: P::Beside,
    device: Device,
}

/// Runs the study of a row; what a row of the list of studies names.
pub(super) fn run<P: Protocol>(
    row: &PublishedStudy,
    options: &Options,
    progress: &dyn Progress,
) -> Result<Reproduction, ReproduceError> {
    let study = P::new()?;
    let plan = if options.quick { P::QUICK } else { P::FULL };
    let results = Results::compute(&study, plan, options.seed, progress)?;
    let mut report = results.report(row);
    let (figures, tables) = study.pictures(&results)?;
    report.figures = figures;
    report.data.extend(tables);
    Ok(report)
}

impl<P: Protocol> Results<P> {
    pub(super) fn compute(
        study: &P,
        plan: P::Plan,
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<Self, ReproduceError> {
        let count = P::count(&plan);
        progress.begin(usize::try_from(count).unwrap_or(usize::MAX));
        let one = |index| {
            let found = study.data_set(&plan, seed, index);
            progress.advance();
            found
        };
        let data_sets = (0..count).into_par_iter().map(one).collect::<Result<_, _>>()?;
        let beside = study.beside(&plan, seed)?;
        Ok(Self { seed, data_sets, beside, device: study.device(seed)?, plan })
    }

    /// Without pictures and time.
    pub(super) fn report(&self, row: &PublishedStudy) -> Reproduction {
        let tell = P::TELL;
        Reproduction {
            name: row.name,
            summary: (tell.summary)(self),
            paper: row.paper,
            reduced: (!self.is_full()).then(|| (tell.left_out)(&self.plan)),
            seed: self.seed,
            targets: (tell.targets)(self),
            table: (tell.table)(self),
            tables: (tell.tables)(self),
            findings: (tell.findings)(self),
            readings: tell.readings.iter().map(|reading| (*reading).to_owned()).collect(),
            data: (tell.data)(self),
            figures: Vec::new(),
            device: self.device.clone(),
            wall_s: 0.0,
        }
    }

    /// Whether it has as many data sets as the study as published; a smaller one asks for less.
    pub(super) fn is_full(&self) -> bool {
        P::count(&self.plan) >= P::count(&P::FULL)
    }

    /// One number over all data sets.
    pub(super) fn each(&self, of: impl Fn(&P::DataSet) -> f64) -> Vec<f64> {
        self.data_sets.iter().map(of).collect()
    }

    /// The ratio of two numbers over all data sets.
    pub(super) fn ratios(&self, of: impl Fn(&P::DataSet) -> f64, to: impl Fn(&P::DataSet) -> f64) -> Vec<f64> {
        self.each(|set| of(set) / to(set))
    }

    /// How many data sets must agree: so many of the full study, all but one of a smaller one.
    pub(super) fn agreeing(&self, of_full: u64) -> Required {
        let all = self.data_sets.len() as f64;
        Required::AtLeast(if self.is_full() { of_full as f64 } else { all - 1.0 })
    }
}

/// A seed for one search, so that no two data sets or studies of different seeds share a draw.
pub(super) fn seed_of(study: u64, data_set: u64, run: u64) -> u64 {
    let Ok(seed) = Stream::new(study, Purpose::Workload, data_set, run).try_next_u64();
    seed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_differ_by_study_data_set_and_run() {
        let seeds = [seed_of(1, 0, 0), seed_of(2, 0, 0), seed_of(1, 1, 0), seed_of(1, 0, 1)];
        assert!((0..4).all(|i| (0..i).all(|j| seeds[i] != seeds[j])), "{seeds:?}");
    }
}
