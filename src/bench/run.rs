//! The measurement: one evaluator, one population, repeated.

use std::time::{Duration, Instant};

use super::engine::{Description, Engine};
use super::process::peak_memory_mib;
use super::times::{Times, median};
use super::workload::truncate;
use super::{BenchError, Report, Target, Workload, candidates};
use crate::data::{Log, Trajectory};
use crate::evaluate::{Evaluation, Precision};
use crate::model::Problem;
use crate::objective::{Kind, Objective};
use crate::tape::Counts;

/// What every candidate is scored by, as every peer does.
const OBJECTIVES: [Kind; 3] = [Kind::Nll, Kind::MseInnovation, Kind::NisMean];

/// What to measure.
#[derive(Debug, Clone)]
pub enum Subject {
    /// A standard workload.
    Workload(Workload),
    /// A problem and its log. The filter is scored by `nll`, `mse_innovation` and `nis`, whatever the problem minimises,
    /// so that figures of different problems compare.
    Problem(Box<(Problem, Log)>),
}

/// How to measure it.
#[derive(Debug, Clone)]
pub struct Options {
    /// What runs.
    pub subject: Subject,
    /// Where; default one thread of the processor.
    pub target: Target,
    /// Candidates, at least 1; default 1024.
    pub candidates: usize,
    /// Use only the first rows of each trajectory; default all.
    pub rows: Option<usize>,
    /// Number format; default f64.
    pub precision: Precision,
    /// Timed evaluations; default 5.
    pub repetitions: usize,
    /// No further evaluation starts once this much time is spent on timed ones; default 30 s.
    pub budget: Duration,
    /// Arithmetic limit of the target in this number format \[GFLOP/s\], to tell the share that is reached.
    pub peak_gflops: Option<f64>,
}

impl Options {
    /// The defaults.
    #[must_use]
    pub const fn new(subject: Subject) -> Self {
        Self {
            subject,
            target: Target::Cpu { threads: 1 },
            candidates: 1024,
            rows: None,
            precision: Precision::F64,
            repetitions: 5,
            budget: Duration::from_secs(30),
            peak_gflops: None,
        }
    }
}

/// Times the evaluation of `options.candidates` candidates after one untimed run.
///
/// # Errors
/// [`BenchError`]: the options ask for nothing, the problem cannot run on its log, or the adapter fails.
pub fn run(options: &Options) -> Result<Report, BenchError> {
    refuse_zeros(options)?;
    measure(options, &Prepared::new(&options.subject, options.rows)?)
}

pub(super) fn refuse_zeros(options: &Options) -> Result<(), BenchError> {
    let threads = match options.target {
        Target::Cpu { threads } => threads,
        Target::Gpu { .. } => 1,
    };
    let counts = [
        ("n", options.candidates),
        ("t", options.rows.unwrap_or(1)),
        ("threads", threads),
        ("repetitions", options.repetitions),
    ];
    counts.iter().find(|(_, count)| *count == 0).map_or(Ok(()), |(name, _)| Err(BenchError::Zero(name)))
}

/// A problem with the three objectives of every report, and its log.
pub(super) struct Prepared {
    /// Letter of the workload, or name of the problem file.
    pub(super) name: String,
    pub(super) problem: Problem,
    pub(super) log: Log,
}

impl Prepared {
    pub(super) fn new(subject: &Subject, rows: Option<usize>) -> Result<Self, BenchError> {
        let (name, mut problem, mut log) = match subject {
            Subject::Workload(workload) => {
                let problem = workload.problem()?;
                let log = workload.log(&problem)?;
                (workload.to_string(), problem, log)
            }
            Subject::Problem(pair) => (pair.0.source.clone(), pair.0.clone(), pair.1.clone()),
        };
        problem.tune.objectives = OBJECTIVES.map(Objective::new).to_vec();
        if let Some(rows) = rows {
            truncate(&mut log, rows);
        }
        if problem.parameters.dimension() == 0 {
            return Err(BenchError::NothingSearched(problem.source));
        }
        Ok(Self { name, problem, log })
    }

    /// Number of present measurement components.
    fn components(&self) -> f64 {
        let present =
            |t: &Trajectory| (0..t.len()).map(|k| t.z.row(k).iter().filter(|z| !z.is_nan()).count()).sum::<usize>();
        self.log.trajectories.iter().map(present).sum::<usize>() as f64
    }
}

/// Times one target.
pub(super) fn measure(options: &Options, prepared: &Prepared) -> Result<Report, BenchError> {
    let Prepared { problem, log, .. } = prepared;
    let population = candidates(&problem.parameters, options.candidates);
    let start = Instant::now();
    let mut engine = Engine::new(problem, log, &options.target, options.precision)?;
    let compile = start.elapsed();
    let (evaluation, _) = engine.evaluate(&population)?;
    let first_call = start.elapsed();
    let scores = Scores { evaluation, components_per_row: prepared.components() / log.rows() as f64 };
    let times = Times::measure(options.repetitions, options.budget, || {
        let (evaluation, kernel) = engine.evaluate(&population)?;
        std::hint::black_box(evaluation);
        Ok(kernel)
    })?;
    let (engine, counts) = (engine.description(), engine.program().counts());
    Ok(Measured { options, prepared, compile, first_call, times, scores, engine, counts }.report())
}

/// Costs in the order of [`OBJECTIVES`].
struct Scores {
    evaluation: Evaluation,
    /// Present measurement components / rows: what turns NIS per component into NIS per row.
    components_per_row: f64,
}

impl Scores {
    /// Costs of the usable candidates.
    fn usable(&self) -> impl Iterator<Item = &[f64]> {
        let evaluation = &self.evaluation;
        (0..evaluation.len()).filter(|i| evaluation.status(*i).is_ok()).map(|i| evaluation.costs(i))
    }

    /// Costs of candidate 0, if it is usable.
    fn first(&self) -> Option<&[f64]> {
        (!self.evaluation.is_empty() && self.evaluation.status(0).is_ok()).then(|| self.evaluation.costs(0))
    }

    fn mean(&self, objective: usize) -> Option<f64> {
        let count = self.usable().count();
        (count > 0).then(|| self.usable().map(|costs| costs[objective]).sum::<f64>() / count as f64)
    }
}

/// Everything a report is made of.
struct Measured<'a> {
    options: &'a Options,
    prepared: &'a Prepared,
    compile: Duration,
    first_call: Duration,
    times: Times,
    scores: Scores,
    engine: Description,
    counts: Counts,
}

impl Measured<'_> {
    fn report(self) -> Report {
        let Self { options, prepared, times, scores, engine, .. } = &self;
        let rows = prepared.log.rows();
        let steps = options.candidates as f64 * rows as f64;
        let median_s = median(&times.wall).unwrap_or(f64::NAN);
        let (cpu_s, kernel_s) = (median(&times.cpu), median(&times.kernel));
        let first_call_s = self.first_call.as_secs_f64();
        let first = scores.first();
        let gflops = self.counts.flops as f64 * steps / kernel_s.unwrap_or(median_s) * 1e-9;
        Report {
            peer: "kfgpu",
            workload: prepared.name.clone(),
            dtype: options.precision.to_string(),
            candidates: options.candidates,
            rows,
            median_s,
            min_s: times.wall.iter().copied().fold(f64::INFINITY, f64::min),
            cpu_s,
            reps: times.wall.len(),
            steps_per_s: steps / median_s,
            steps_per_cpu_s: cpu_s.map(|cpu_s| steps / cpu_s),
            compile_s: self.compile.as_secs_f64(),
            first_call_s,
            steps_per_s_incl_compile: steps / first_call_s,
            check: first.map(|costs| -costs[0]),
            check_mse: first.map(|costs| costs[1]),
            check_nis: first.map(|costs| costs[2] * scores.components_per_row),
            mean_ll: scores.mean(0).map(|nll| -nll),
            mean_mse: scores.mean(1),
            failed: scores.evaluation.len() - scores.usable().count(),
            cpus: std::thread::available_parallelism().map_or(1, usize::from),
            threads: match options.target {
                Target::Cpu { threads } => Some(threads),
                Target::Gpu { .. } => None,
            },
            maxrss_mb: peak_memory_mib(),
            device: engine.device.to_owned(),
            isa: engine.name.clone(),
            kernel_s,
            kernel_steps_per_s: kernel_s.map(|kernel_s| steps / kernel_s),
            kernel_build_s: engine.kernel_build.map(|time| time.as_secs_f64()),
            flops_per_step: self.counts.flops,
            gflops,
            share_of_peak: options.peak_gflops.map(|peak| gflops / peak),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;

    fn small(precision: Precision) -> Options {
        let mut options = Options::new(Subject::Workload(Workload::B));
        (options.candidates, options.rows, options.repetitions, options.precision) = (3, Some(40), 2, precision);
        options
    }

    #[test]
    fn the_report_says_what_the_reference_computes() {
        let report = run(&small(Precision::F64)).unwrap();
        assert_eq!((report.candidates, report.rows, report.reps, report.failed), (3, 40, 2, 0), "sizes");
        let Prepared { problem, log, .. } = Prepared::new(&small(Precision::F64).subject, Some(40)).unwrap();
        let population = candidates(&problem.parameters, 3);
        let all: Vec<Vec<f64>> =
            population.rows().map(|candidate| reference::costs(&problem, &log, candidate).unwrap()).collect();
        let close = |found: Option<f64>, expected: f64| (found.unwrap() / expected - 1.0).abs() < 1e-10;
        assert!(close(report.check, -all[0][0]), "log-likelihood {:?}", report.check);
        assert!(close(report.check_mse, all[0][1]), "mse {:?}", report.check_mse);
        assert!(close(report.check_nis, 3.0 * all[0][2]), "three components a row: {:?}", report.check_nis);
        assert!(close(report.mean_ll, -(all[0][0] + all[1][0] + all[2][0]) / 3.0), "mean {:?}", report.mean_ll);
        assert!(close(report.mean_mse, (all[0][1] + all[1][1] + all[2][1]) / 3.0), "mean {:?}", report.mean_mse);
    }

    #[test]
    fn rates_are_steps_over_times_and_shares_are_flops_over_the_limit() {
        let mut options = small(Precision::F32);
        options.peak_gflops = Some(50.0);
        let report = run(&options).unwrap();
        let steps = 120.0;
        assert!((report.steps_per_s * report.median_s / steps - 1.0).abs() < 1e-12, "{report:?}");
        assert!((report.steps_per_s_incl_compile * report.first_call_s / steps - 1.0).abs() < 1e-12, "{report:?}");
        assert!(report.min_s <= report.median_s && report.compile_s < report.first_call_s, "{report:?}");
        // Three filters of 2 states each; written out by hand they take 87 to 96, by how the sums are counted.
        assert!((80..120).contains(&report.flops_per_step), "{report:?}");
        let share = report.flops_per_step as f64 * report.steps_per_s / 50e9;
        assert!((report.share_of_peak.unwrap() / share - 1.0).abs() < 1e-12, "{report:?}");
    }

    #[test]
    fn json_has_every_field_of_the_common_harness() {
        let json = serde_json::to_value(run(&small(Precision::F32)).unwrap()).unwrap();
        let fields = "peer workload dtype N T median_s min_s cpu_s reps steps_per_s steps_per_cpu_s compile_s \
                      first_call_s steps_per_s_incl_compile check check_mse check_nis mean_ll mean_mse cpus maxrss_mb";
        for field in fields.split_whitespace() {
            assert!(json.get(field).is_some_and(|value| !value.is_null()), "{field} is missing from {json}");
        }
        assert_eq!((json["workload"].as_str(), json["dtype"].as_str()), (Some("B"), Some("f32")), "{json}");
    }

    #[test]
    fn nothing_to_do_is_an_error() {
        let mut options = small(Precision::F64);
        options.candidates = 0;
        assert!(matches!(run(&options), Err(BenchError::Zero("n"))), "no candidate");
        let Prepared { mut problem, log, .. } = Prepared::new(&small(Precision::F64).subject, None).unwrap();
        for parameter in &mut problem.parameters.all {
            parameter.value = crate::model::Value::Fixed(1.0);
        }
        let fixed = Options::new(Subject::Problem(Box::new((problem, log))));
        assert!(matches!(run(&fixed), Err(BenchError::NothingSearched(_))), "no searched parameter");
    }
}
