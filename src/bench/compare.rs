//! The processor against adapters on the same problem and the same candidates.

use super::crossover::{self, Crossover};
use super::run::{Prepared, measure, refuse_zeros};
use super::{Adapter, BenchError, Options, Report, Target};
use crate::precision::Precision;

/// What a comparison measures beside what [`Options`] say; their target and number format do not matter here.
#[derive(Debug, Clone)]
pub struct Suite {
    /// Thread counts of the processor.
    pub threads: Vec<usize>,
    /// Adapters, by their whole names.
    pub adapters: Vec<Adapter>,
    /// Number formats; an adapter without f64 is not asked for it.
    pub precisions: Vec<Precision>,
    /// Candidates; `None` = so many that one evaluation is about 2^24 filter-steps, 1,024 to 65,536.
    pub candidates: Option<usize>,
}

/// Something that could not be measured.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// `cpu` or the adapter's name.
    pub device: String,
    /// `f64` or `f32`.
    pub dtype: String,
    /// Why not.
    pub reason: String,
}

/// What a comparison found.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Letter of the workload, or name of the problem file.
    pub workload: String,
    /// Candidates.
    #[serde(rename = "N")]
    pub candidates: usize,
    /// Rows, over all trajectories.
    #[serde(rename = "T")]
    pub rows: usize,
    /// The processor first, each adapter's formats together.
    pub measurements: Vec<Report>,
    /// For each adapter, from how many candidates it is faster than the whole processor.
    pub crossover: Vec<Crossover>,
    /// What could not be measured.
    pub skipped: Vec<Skipped>,
}

/// Measures everything that `suite` names, one after the other.
///
/// # Errors
/// [`BenchError`]: the options ask for nothing, the problem cannot run on its log, or nothing at all could be measured
/// (the first reason).
pub fn compare(options: &Options, suite: &Suite) -> Result<Comparison, BenchError> {
    let prepared = Prepared::new(&options.subject, options.rows)?;
    let rows = prepared.log.rows();
    let mut options = options.clone();
    options.candidates = suite.candidates.unwrap_or_else(|| usual_candidates(rows));
    let mut found = Comparison {
        workload: prepared.name.clone(),
        candidates: options.candidates,
        rows,
        measurements: Vec::new(),
        crossover: Vec::new(),
        skipped: Vec::new(),
    };
    let mut first_reason = None;
    for (target, precision) in suite.runs() {
        (options.target, options.precision) = (target, precision);
        refuse_zeros(&options)?;
        match measure(&options, &prepared) {
            Ok(report) => found.measurements.push(report),
            Err(reason) if reason.is_of_one_device() => {
                found.skip(&options.target, precision, &reason);
                first_reason = first_reason.or(Some(reason));
            }
            Err(reason) => return Err(reason),
        }
    }
    if let (true, Some(reason)) = (found.measurements.is_empty(), first_reason) {
        return Err(reason);
    }
    found.cross(&options, suite, &prepared)?;
    Ok(found)
}

/// The largest power of two with at most 2^24 filter-steps an evaluation: enough to fill a GPU with a short log, and
/// seconds of one core with a long one.
fn usual_candidates(rows: usize) -> usize {
    let most = ((1 << 24) / rows.max(1)).clamp(1 << 10, 1 << 16);
    1 << most.ilog2()
}

impl Suite {
    /// Targets and number formats in the order of the report.
    fn runs(&self) -> Vec<(Target, Precision)> {
        let cpu = self.threads.iter().flat_map(|threads| {
            let target = Target::Cpu { threads: *threads };
            self.precisions.iter().map(move |precision| (target.clone(), *precision))
        });
        let gpu = self.adapters.iter().flat_map(|adapter| {
            let target = Target::Gpu { adapter: Some(adapter.name.clone()) };
            let computes = |precision: &&Precision| adapter.f64 || **precision == Precision::F32;
            self.precisions.iter().filter(computes).map(move |precision| (target.clone(), *precision))
        });
        cpu.chain(gpu).collect()
    }

    /// The format that crossovers are told in: f32, which GPUs are built for, unless only f64 was asked for.
    fn crossover_precision(&self) -> Precision {
        if self.precisions.contains(&Precision::F32) { Precision::F32 } else { Precision::F64 }
    }
}

impl Comparison {
    fn skip(&mut self, target: &Target, precision: Precision, reason: &BenchError) {
        let device = match target {
            Target::Gpu { adapter: Some(name) } => name.clone(),
            Target::Gpu { adapter: None } => "gpu".to_owned(),
            Target::Cpu { .. } => "cpu".to_owned(),
        };
        self.skipped.push(Skipped { device, dtype: precision.to_string(), reason: reason.to_string() });
    }

    /// Crossovers of the adapters that could be measured.
    fn cross(&mut self, options: &Options, suite: &Suite, prepared: &Prepared) -> Result<(), BenchError> {
        let precision = suite.crossover_precision();
        let Some(threads) = suite.threads.iter().copied().max() else { return Ok(()) };
        for adapter in &suite.adapters {
            let failed =
                |s: &Skipped| s.dtype == precision.to_string() && (s.device == adapter.name || s.device == "cpu");
            if self.skipped.iter().any(failed) || (precision == Precision::F64 && !adapter.f64) {
                continue;
            }
            match crossover::find(options, prepared, adapter, threads, precision) {
                Ok(crossover) => self.crossover.push(crossover),
                Err(reason) if reason.is_of_one_device() => {
                    self.skip(&Target::Gpu { adapter: Some(adapter.name.clone()) }, precision, &reason);
                }
                Err(reason) => return Err(reason),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{Subject, Workload};

    fn suite(adapters: Vec<Adapter>) -> Suite {
        Suite { threads: vec![2, 1], adapters, precisions: vec![Precision::F64, Precision::F32], candidates: Some(65) }
    }

    fn small() -> Options {
        let mut options = Options::new(Subject::Workload(Workload::A));
        (options.rows, options.repetitions) = (Some(20), 1);
        options
    }

    #[test]
    fn the_processor_is_measured_in_every_way_asked_for() {
        let found = compare(&small(), &suite(vec![])).unwrap();
        let ways: Vec<_> = found.measurements.iter().map(|m| (m.threads, m.dtype.as_str())).collect();
        assert_eq!(ways, [(Some(2), "f64"), (Some(2), "f32"), (Some(1), "f64"), (Some(1), "f32")]);
        assert!(found.measurements.iter().all(|m| (m.candidates, m.rows) == (65, 20)), "{found:?}");
        assert!(found.skipped.is_empty() && found.crossover.is_empty(), "{found:?}");
    }

    #[test]
    fn an_adapter_that_is_not_there_is_skipped_with_its_reason() {
        let absent = Adapter { name: "no such adapter".to_owned(), software: false, f64: false };
        let found = compare(&small(), &suite(vec![absent])).unwrap();
        assert_eq!(found.measurements.len(), 4, "the processor is measured: {found:?}");
        let [skipped] = &found.skipped[..] else { panic!("f32 alone was tried: {:?}", found.skipped) };
        assert_eq!((skipped.device.as_str(), skipped.dtype.as_str()), ("no such adapter", "f32"));
        let told = found.to_string();
        assert!(told.contains(&skipped.reason), "{told}");
    }

    #[test]
    fn nothing_measured_is_an_error() {
        let absent = Adapter { name: "no such adapter".to_owned(), software: false, f64: false };
        let only = Suite { threads: vec![], ..suite(vec![absent]) };
        let error = compare(&small(), &only).unwrap_err();
        assert!(error.is_of_one_device(), "{error}");
    }

    #[test]
    fn a_usual_population_is_seconds_of_a_core_at_most() {
        assert_eq!([100, 200, 1000, 100_000].map(usual_candidates), [65_536, 65_536, 16_384, 1_024]);
    }
}
