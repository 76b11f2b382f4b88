//! Workloads A, B and C against an independent program's numbers (`golden/workloads.json`), to one part in 1e9, for
//! everything that filters them: the f64 reference, the CPU lanes, and the programs that kfgpu is timed against.

#[path = "../benches/baseline/mod.rs"]
mod baseline;
#[path = "../benches/handwritten/mod.rs"]
mod handwritten;

use baseline::Baseline;
use handwritten::Filter;
use kfgpu::bench::{Workload, candidates};
use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference;
use std::num::NonZero;

/// One candidate's expected values.
#[derive(serde::Deserialize)]
struct Golden {
    #[serde(rename = "R")]
    r: Vec<f64>,
    #[serde(rename = "Q")]
    q: Vec<f64>,
    loglik: f64,
    mse: f64,
    nis: f64,
    x_last: Vec<f64>,
}

impl Golden {
    /// Log-likelihood, mean squared innovation, sum of NIS / T.
    const fn score(&self) -> [f64; 3] {
        [self.loglik, self.mse, self.nis]
    }
}

struct Case {
    workload: Workload,
    problem: Problem,
    log: Log,
    population: Population,
    golden: Vec<Golden>,
}

impl Case {
    fn of(workload: Workload) -> Self {
        let mut file: serde_json::Value = serde_json::from_str(include_str!("golden/workloads.json")).expect("JSON");
        let golden: Vec<Golden> = serde_json::from_value(file[workload.name()].take()).expect("golden values");
        let problem = workload.problem().expect("the problem parses");
        let log = workload.log(&problem).expect("the log reads");
        let population = candidates(&problem.parameters, golden.len());
        Self { workload, problem, log, population, golden }
    }

    fn all() -> [Self; 3] {
        Workload::ALL.map(Self::of)
    }

    fn measurements(&self) -> usize {
        self.problem.model.h.len()
    }

    fn rows(&self) -> Vec<Vec<f64>> {
        let trajectory = &self.log.trajectories[0];
        (0..trajectory.len()).map(|k| trajectory.z.row(k).to_vec()).collect()
    }

    fn each(&self) -> impl Iterator<Item = (&[f64], &Golden)> {
        self.population.rows().zip(&self.golden)
    }
}

/// Relative to the expected value, or absolute where that is below 1.
#[track_caller]
fn close(what: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(error <= tolerance, "{what}: found {found}, expected {expected}, error {error:e} > {tolerance:e}");
}

#[track_caller]
fn scores_close(case: &Case, who: &str, found: [f64; 3], golden: &Golden, tolerance: f64) {
    for ((name, found), expected) in ["log-likelihood", "mse", "nis"].iter().zip(found).zip(golden.score()) {
        close(&format!("workload {}, {who}, {name}", case.workload), found, expected, tolerance);
    }
}

#[test]
fn logs_have_the_stated_sizes() {
    let sizes = Case::all().map(|case| (case.log.rows(), case.measurements(), case.problem.model.states.len()));
    assert_eq!(sizes, [(200, 1, 3), (1000, 3, 6), (100_000, 2, 4)], "rows, m, n");
}

#[test]
fn candidates_are_those_of_the_common_harness() {
    for case in Case::all() {
        for (candidate, golden) in case.each() {
            let searched_q = golden.q.iter().filter(|_| case.workload != Workload::A).filter(|q| **q > 0.0);
            let expected: Vec<f64> = golden.r.iter().chain(searched_q).copied().collect();
            assert_eq!(candidate.len(), expected.len(), "workload {}: number of searched parameters", case.workload);
            for (found, expected) in candidate.iter().zip(&expected) {
                let error = (found / expected - 1.0).abs();
                assert!(error < 1e-13, "workload {}: {found} is not {expected}", case.workload);
            }
        }
    }
}

#[test]
fn baseline_agrees() {
    for case in Case::all() {
        let baseline = Baseline::new(case.workload, &case.rows());
        for (candidate, golden) in case.each() {
            scores_close(&case, "nalgebra", baseline.score(candidate), golden, 1e-9);
            for (found, expected) in baseline.last_state(candidate).iter().zip(&golden.x_last) {
                close(&format!("workload {}, nalgebra, x", case.workload), *found, *expected, 1e-9);
            }
        }
    }
}

/// f32 here only shows that the same filter was written: its states are absolute and its sums are f32.
#[test]
fn filters_by_hand_agree() {
    for case in Case::all() {
        let filter = match case.workload {
            Workload::A => Filter::Rocket,
            Workload::B => Filter::ConstantVelocity { dt: 4.0 },
            Workload::C => Filter::ConstantVelocity { dt: 0.1 },
        };
        let rows = case.rows();
        let z = || rows.iter().map(Vec::as_slice);
        let (z64, c64) = (handwritten::columns::<f64>(z()), handwritten::columns::<f64>(case.population.rows()));
        let (z32, c32) = (handwritten::columns::<f32>(z()), handwritten::columns::<f32>(case.population.rows()));
        // Four candidates leave a block of 16 mostly filled up.
        let double = handwritten::score::<f64, 16>(filter, &z64, &c64);
        let single = handwritten::score::<f32, 16>(filter, &z32, &c32);
        assert_eq!((double.len(), single.len()), (4, 4), "one score per candidate");
        for ((double, single), golden) in double.iter().zip(&single).zip(&case.golden) {
            let score = |sums: &handwritten::Sums| sums.score(rows.len(), case.measurements());
            scores_close(&case, "by hand f64", score(double), golden, 1e-9);
            scores_close(&case, "by hand f32", score(single), golden, 5e-5);
        }
    }
}

/// The objective `nis` forgets on which side of 1 its mean lies; the expected value tells.
#[test]
fn reference_costs_agree() {
    for case in Case::all() {
        for (candidate, golden) in case.each() {
            let costs = reference::costs(&case.problem, &case.log, candidate).unwrap();
            let m = case.measurements() as f64;
            let nis_mean = if golden.nis < m { 1.0 - costs[2] } else { 1.0 + costs[2] };
            scores_close(&case, "reference", [-costs[0], costs[1], nis_mean * m], golden, 1e-9);
        }
    }
}

#[test]
fn reference_states_agree() {
    for case in Case::all() {
        for (candidate, golden) in case.each() {
            let run = reference::run(&case.problem, &case.log, candidate).unwrap();
            let last = run.trajectories[0].last().unwrap();
            assert_eq!(last.row + 1, case.log.rows(), "the last row is filtered");
            for (found, expected) in last.posterior.x.iter().zip(&golden.x_last) {
                close(&format!("workload {}, reference, x", case.workload), *found, *expected, 1e-9);
            }
        }
    }
}

/// Costs of the lanes as log-likelihood, mean squared innovation, sum of NIS / T.
fn lanes(case: &Case, precision: Precision) -> Vec<[f64; 3]> {
    let objectives = [Kind::Nll, Kind::MseInnovation, Kind::NisMean].map(Objective::new);
    let options = CpuOptions { precision, threads: NonZero::new(1) };
    let mut evaluator =
        CpuEvaluator::with_objectives(&case.problem, &case.log, &objectives, options).expect("the workload traces");
    let evaluation = evaluator.evaluate(&case.population);
    (0..evaluation.len())
        .map(|i| {
            assert!(evaluation.status(i).is_ok(), "workload {}: candidate {i} failed", case.workload);
            let costs = evaluation.costs(i);
            [-costs[0], costs[1], costs[2] * case.measurements() as f64]
        })
        .collect()
}

#[test]
fn lanes_in_f64_agree() {
    for case in Case::all() {
        for (found, golden) in lanes(&case, Precision::F64).into_iter().zip(&case.golden) {
            scores_close(&case, "lanes f64", found, golden, 1e-9);
        }
    }
}

/// The promise of `docs/semantics.md`: nll per step to 1e-5 x max(1, |nll per step|), f1 to 1e-5 relative.
#[test]
fn lanes_in_f32_keep_the_promise() {
    for case in Case::all() {
        let rows = case.log.rows() as f64;
        for ([log_likelihood, mse, nis], golden) in lanes(&case, Precision::F32).into_iter().zip(&case.golden) {
            let name = |what: &str| format!("workload {}, lanes f32, {what}", case.workload);
            close(&name("log-likelihood per row"), log_likelihood / rows, golden.loglik / rows, 1e-5);
            assert!((mse / golden.mse - 1.0).abs() <= 1e-5, "{}: {mse}, not {}", name("mse"), golden.mse);
            close(&name("NIS"), nis, golden.nis, 1e-5);
        }
    }
}
