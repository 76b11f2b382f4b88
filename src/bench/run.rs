//! The measurement: one evaluator, one population, repeated.

use std::num::NonZero;
use std::time::{Duration, Instant};

use super::process::{cpu_time, peak_memory_mib};
use super::workload::truncate;
use super::{Report, Workload, candidates};
use crate::data::{Log, LogError, Trajectory};
use crate::evaluate::{BuildError, CpuEvaluator, CpuOptions, Device, Evaluation, Evaluator, Precision};
use crate::model::{Problem, ProblemError};
use crate::objective::{Kind, Objective};

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
    /// Candidates, at least 1; default 1024.
    pub candidates: usize,
    /// Use only the first rows of each trajectory; default all.
    pub rows: Option<usize>,
    /// Number format; default f64.
    pub precision: Precision,
    /// Threads; default 1.
    pub threads: usize,
    /// Timed evaluations; default 5.
    pub repetitions: usize,
    /// No further evaluation starts once this much time is spent on timed ones; default 30 s.
    pub budget: Duration,
}

impl Options {
    /// The defaults.
    #[must_use]
    pub const fn new(subject: Subject) -> Self {
        Self {
            subject,
            candidates: 1024,
            rows: None,
            precision: Precision::F64,
            threads: 1,
            repetitions: 5,
            budget: Duration::from_secs(30),
        }
    }
}

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The problem is not one.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The log is not one.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The filter cannot be traced.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Without a searched parameter there is no candidate.
    #[error("{0}: no parameter is searched, expected at least one (give one a range: r = {{ min = 0.1, max = 10 }})")]
    NothingSearched(String),
    /// An option that must be positive is 0.
    #[error("bench: {0} is 0, expected at least 1")]
    Zero(&'static str),
}

/// Times the evaluation of `options.candidates` candidates after one untimed run.
///
/// # Errors
/// [`BenchError`]: the options ask for nothing, or the problem cannot run on its log.
pub fn run(options: &Options) -> Result<Report, BenchError> {
    refuse_zeros(options)?;
    let (problem, log) = prepare(options)?;
    let population = candidates(&problem.parameters, options.candidates);
    if population.is_empty() {
        return Err(BenchError::NothingSearched(problem.source));
    }
    let cpu = CpuOptions { precision: options.precision, threads: NonZero::new(options.threads) };
    let start = Instant::now();
    let mut evaluator = CpuEvaluator::new(&problem, &log, cpu)?;
    let compile = start.elapsed();
    let evaluation = evaluator.evaluate(&population);
    let first_call = start.elapsed();
    let scores = Scores { evaluation, components_per_row: components(&log) / log.rows() as f64 };
    let times = Times::measure(options, || drop(std::hint::black_box(evaluator.evaluate(&population))));
    let device = evaluator.device();
    Ok(Measured { options, source: problem.source, rows: log.rows(), compile, first_call, times, scores, device }
        .report())
}

fn refuse_zeros(options: &Options) -> Result<(), BenchError> {
    let counts = [
        ("n", options.candidates),
        ("t", options.rows.unwrap_or(1)),
        ("threads", options.threads),
        ("repetitions", options.repetitions),
    ];
    counts.iter().find(|(_, count)| *count == 0).map_or(Ok(()), |(name, _)| Err(BenchError::Zero(name)))
}

/// The problem with the three objectives of every report, and its log.
fn prepare(options: &Options) -> Result<(Problem, Log), BenchError> {
    let (mut problem, mut log) = match &options.subject {
        Subject::Workload(workload) => {
            let problem = workload.problem()?;
            let log = workload.log(&problem)?;
            (problem, log)
        }
        Subject::Problem(pair) => (**pair).clone(),
    };
    problem.tune.objectives = OBJECTIVES.map(Objective::new).to_vec();
    if let Some(rows) = options.rows {
        truncate(&mut log, rows);
    }
    Ok((problem, log))
}

/// Number of present measurement components.
fn components(log: &Log) -> f64 {
    let present =
        |t: &Trajectory| (0..t.len()).map(|k| t.z.row(k).iter().filter(|z| !z.is_nan()).count()).sum::<usize>();
    log.trajectories.iter().map(present).sum::<usize>() as f64
}

/// Timed evaluations, in seconds.
struct Times {
    wall: Vec<f64>,
    cpu: Vec<f64>,
}

impl Times {
    fn measure(options: &Options, mut evaluate: impl FnMut()) -> Self {
        let (mut wall, mut cpu) = (Vec::new(), Vec::new());
        let begin = Instant::now();
        while wall.len() < options.repetitions && (wall.is_empty() || begin.elapsed() < options.budget) {
            let (start, start_cpu) = (Instant::now(), cpu_time());
            evaluate();
            wall.push(start.elapsed().as_secs_f64());
            let spent = start_cpu.zip(cpu_time()).map(|(start, end)| end.saturating_sub(start));
            cpu.extend(spent.map(|spent| spent.as_secs_f64()));
        }
        Self { wall, cpu }
    }
}

/// The middle value, or the mean of the two middle ones; `None` of nothing.
fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let upper = sorted.get(sorted.len() / 2)?;
    let lower = sorted.get((sorted.len() - 1) / 2)?;
    Some(0.5 * (lower + upper))
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
    source: String,
    rows: usize,
    compile: Duration,
    first_call: Duration,
    times: Times,
    scores: Scores,
    device: Device,
}

impl Measured<'_> {
    fn report(&self) -> Report {
        let Self { options, rows, times, scores, .. } = self;
        let steps = options.candidates as f64 * *rows as f64;
        let median_s = median(&times.wall).unwrap_or(f64::NAN);
        let cpu_s = median(&times.cpu);
        let first_call_s = self.first_call.as_secs_f64();
        let first = scores.first();
        let workload = match options.subject {
            Subject::Workload(workload) => workload.to_string(),
            Subject::Problem(_) => self.source.clone(),
        };
        Report {
            peer: "kfgpu",
            workload,
            dtype: options.precision.to_string(),
            candidates: options.candidates,
            rows: *rows,
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
            threads: options.threads,
            maxrss_mb: peak_memory_mib(),
            device: self.device.backend.clone(),
            isa: self.device.adapter.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;

    #[test]
    fn the_median_is_the_middle_or_between_the_middle_two() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0), "odd");
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5), "even");
        assert_eq!(median(&[]), None, "empty");
    }

    fn small(precision: Precision) -> Options {
        let mut options = Options::new(Subject::Workload(Workload::B));
        (options.candidates, options.rows, options.repetitions, options.precision) = (3, Some(40), 2, precision);
        options
    }

    #[test]
    fn the_report_says_what_the_reference_computes() {
        let report = run(&small(Precision::F64)).unwrap();
        assert_eq!((report.candidates, report.rows, report.reps, report.failed), (3, 40, 2, 0), "sizes");
        let (problem, log) = prepare(&small(Precision::F64)).unwrap();
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
    fn rates_are_steps_over_times() {
        let report = run(&small(Precision::F32)).unwrap();
        let steps = 120.0;
        assert!((report.steps_per_s * report.median_s / steps - 1.0).abs() < 1e-12, "{report:?}");
        assert!((report.steps_per_s_incl_compile * report.first_call_s / steps - 1.0).abs() < 1e-12, "{report:?}");
        assert!(report.min_s <= report.median_s && report.compile_s < report.first_call_s, "{report:?}");
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
        let (mut problem, log) = prepare(&small(Precision::F64)).unwrap();
        for parameter in &mut problem.parameters.all {
            parameter.value = crate::model::Value::Fixed(1.0);
        }
        let fixed = Options::new(Subject::Problem(Box::new((problem, log))));
        assert!(matches!(run(&fixed), Err(BenchError::NothingSearched(_))), "no searched parameter");
    }
}
