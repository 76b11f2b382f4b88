//! A case of the parity suite: a problem, its log, its candidates, and what the reference says of them.

use crate::logs::{Shape, draw};
use kfgpu::data::Log;
use kfgpu::evaluate::Population;
use kfgpu::model::{Parameters, Problem, Scale};
use kfgpu::random::{Purpose, Stream};
use kfgpu::reference::{self, Cause};

/// What single precision owes to a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Single {
    /// The promise of semantics.md.
    Promised,
    /// Its error is measured and held to its record; the promise is beyond seven digits.
    Measured,
    /// The deviation form cannot express it, which must be said.
    Refused,
}

/// What f64 owes to a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Double {
    /// 1e-10, relative to max(1, |cost|).
    Promised,
    /// As recorded.
    Measured,
}

/// A problem with its log and candidates.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) problem: Problem,
    pub(crate) log: Log,
    pub(crate) population: Population,
    pub(crate) single: Single,
    pub(crate) double: Double,
}

/// Costs of every candidate by the reference, or why there are none.
pub(crate) type Costs = Vec<Result<Vec<f64>, Refusal>>;

/// Why the reference has no costs for a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refusal {
    /// A covariance is none: every device says so by [`Status::NOT_POSITIVE`](kfgpu::evaluate::Status::NOT_POSITIVE).
    NotPositive,
    /// It met a number that is not finite, or a cost is none. Overflow comes earlier in f32.
    NotFinite,
    /// It has lost the track and amplifies the last digits of the log, so that nobody has its costs.
    Amplified,
}

/// Every objective, with default options.
pub(crate) const ALL: &str = r#"["nll", "mse_innovation", "mismatch", "nis", "nees", "rmse", "distance"]"#;

/// Every objective, with its options.
pub(crate) const OPTIONS: &str = r#"[{ name = "nll", skip = 3 }, { name = "mse_innovation", skip = 2 },
    { name = "mismatch", window = 20, ct = "last", skip = 1 }, { name = "nis", skip = 5 }, { name = "nees", skip = 4 },
    { name = "rmse", skip = 3 }, { name = "distance", skip = 1 }]"#;

/// Every objective that needs no truth.
pub(crate) const INNOVATIONS: &str = r#"["nll", "mse_innovation", { name = "mismatch", window = 30 }, "nis"]"#;

/// The parts of a problem file that differ from case to case.
#[derive(Clone, Copy)]
pub(crate) struct Text<'a> {
    pub(crate) measurements: &'a [&'a str],
    pub(crate) inputs: &'a [&'a str],
    /// States with truth.
    pub(crate) truth: &'a [&'a str],
    pub(crate) model: &'a str,
    /// The table `[filter]`; empty for the linear Kalman filter.
    pub(crate) filter: &'a str,
    pub(crate) parameters: &'a str,
    pub(crate) objectives: &'a str,
}

impl Text<'_> {
    /// Two searched variances `q` and `r`, no inputs.
    pub(crate) const BASIC: Text<'static> = Text {
        measurements: &["z"],
        inputs: &[],
        truth: &[],
        model: "",
        filter: "",
        parameters: "q = { min = 0.01, max = 10, scale = \"log\", start = 0.3 }\n\
                     r = { min = 0.5, max = 20, scale = \"log\", start = 2 }",
        objectives: INNOVATIONS,
    };

    pub(crate) fn problem(&self) -> Problem {
        let truth: Vec<String> = self.truth.iter().map(|s| format!("{s} = \"true_{s}\"")).collect();
        let inputs = if self.inputs.is_empty() { String::new() } else { format!("inputs = {:?}\n", self.inputs) };
        let text = format!(
            "[data]\nfile = \"drawn.csv\"\nmeasurements = {:?}\n{inputs}truth = {{ {} }}\n[model]\n{}\n[filter]\n{}\n[parameters]\n{}\n[tune]\nobjectives = {}\n",
            self.measurements,
            truth.join(", "),
            self.model,
            self.filter,
            self.parameters,
            self.objectives,
        );
        Problem::parse(&text, "case.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
    }
}

impl Case {
    /// A case of `candidates` drawn over the search ranges.
    pub(crate) fn new(name: impl Into<String>, text: &Text<'_>, shape: Shape, candidates: u64) -> Self {
        let (name, problem) = (name.into(), text.problem());
        let log = draw(&problem, shape, 11);
        Self::of(name, problem, log, candidates)
    }

    pub(crate) fn of(name: String, problem: Problem, log: Log, candidates: u64) -> Self {
        problem.check_log(&log).unwrap_or_else(|error| panic!("{name}: {error}"));
        let population = population(&problem.parameters, candidates);
        Self { name, problem, log, population, single: Single::Promised, double: Double::Promised }
    }

    pub(crate) fn single(self, single: Single) -> Self {
        Self { single, ..self }
    }

    pub(crate) fn double(self, double: Double) -> Self {
        Self { double, ..self }
    }

    pub(crate) fn reference(&self) -> Costs {
        let amplified = |candidate| {
            let amplification = || reference::amplification(&self.problem, &self.log, candidate);
            !self.problem.filter.is_linear() && amplification().is_ok_and(|amplification| amplification >= 1.0)
        };
        let costs = |candidate| match reference::costs(&self.problem, &self.log, candidate) {
            Ok(_) if amplified(candidate) => Err(Refusal::Amplified),
            Ok(costs) if costs.iter().all(|cost| cost.is_finite()) => Ok(costs),
            Ok(_) => Err(Refusal::NotFinite),
            Err(failure) => Err(match failure.what {
                Cause::NotCovariance { .. } | Cause::NotPositive | Cause::Setting { .. } => Refusal::NotPositive,
                _ => Refusal::NotFinite,
            }),
        };
        self.population.rows().map(costs).collect()
    }
}

/// Candidates spread over the ranges that the first population is drawn from.
fn population(parameters: &Parameters, candidates: u64) -> Population {
    let mut population = Population::new(parameters.dimension());
    for i in 0..candidates {
        let mut stream = Stream::new(1, Purpose::Workload, 0, i);
        let candidate: Vec<f64> = parameters
            .searched()
            .map(|(_, s)| {
                let (u, [low, high]) = (stream.uniform(), s.init);
                match s.scale {
                    Scale::Linear => low + u * (high - low),
                    Scale::Log => (low.ln() + u * (high.ln() - low.ln())).exp(),
                }
            })
            .collect();
        population.push(&candidate);
    }
    population
}
