//! What must hold of every filter run, whatever the numbers: symmetry, equivariance, invariance.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::random::{Purpose, Stream};
use kfgpu::reference;
use nalgebra::DMatrix;
use proptest::prelude::*;

/// x' = a x + b y + 0.3, y' = c y; both measured in two mixtures; R correlated by `rho`.
#[derive(Debug, Clone)]
struct Plant {
    a: f64,
    b: f64,
    c: f64,
    q: [f64; 2],
    r: [f64; 2],
    rho: f64,
    p0: f64,
    /// What every length is multiplied by.
    scale: f64,
    seed: u64,
    missing: f64,
}

fn plants() -> impl Strategy<Value = Plant> {
    let dynamics = (-0.99..0.99f64, -0.5..0.5f64, 0.2..1.0f64);
    let noise = ([0.001..5.0f64, 0.0..5.0f64], [0.05..5.0f64, 0.05..5.0f64], -0.8..0.8f64, 0.1..100.0f64);
    (dynamics, noise, any::<u64>(), 0.0..0.5f64).prop_map(|((a, b, c), (q, r, rho, p0), seed, missing)| Plant {
        a,
        b,
        c,
        q,
        r,
        rho,
        p0,
        scale: 1.0,
        seed,
        missing,
    })
}

const STATES: [&str; 2] = ["x", "y"];

impl Plant {
    fn text(&self, states: [&str; 2], r: &str) -> String {
        let Self { a, b, c, q, p0, scale, .. } = self;
        let s2 = scale * scale;
        let f = [format!("{a}*x + {b}*y + {}", 0.3 * scale), format!("{c}*y")];
        let q = [q[0] * s2, q[1] * s2];
        let p0 = [p0 * s2, 0.5 * p0 * s2];
        let x0 = [1.0 * scale, -0.5 * scale];
        let order = states.map(|s| usize::from(s == "y"));
        let pick = |values: [f64; 2]| order.map(|i| values[i]);
        let f = order.map(|i| f[i].clone());
        format!(
            "[data]\nfile = \"none.csv\"\nmeasurements = [\"z1\", \"z2\"]\ntruth = {{ x = \"tx\", y = \"ty\" }}\n[model]\n\
             state = {states:?}\nf = {f:?}\nh = [\"x + 0.5*y\", \"y - 0.2*x\"]\nQ = {:?}\nR = {r}\nx0 = {:?}\nP0 = {:?}\n\
             [parameters]\nr1 = {{ min = 1e-9, max = 1e9, start = 1 }}\nr2 = {{ min = 1e-9, max = 1e9, start = 1 }}\n\
             rho = {{ min = -1, max = 1, start = 0 }}\n[tune]\n\
             objectives = [\"nll\", \"mse_innovation\", \"mismatch\", \"nis\", \"nees\", \"rmse\", \"distance\"]\n",
            pick(q),
            pick(x0),
            pick(p0),
        )
    }

    fn problem(&self) -> Problem {
        self.with(STATES, CORRELATED)
    }

    fn with(&self, states: [&str; 2], r: &str) -> Problem {
        let text = self.text(states, r);
        Problem::parse(&text, "plant.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    fn candidate(&self) -> [f64; 3] {
        let s2 = self.scale * self.scale;
        [self.r[0] * s2, self.r[1] * s2, self.rho]
    }

    /// `rows` of uniform numbers with gaps: what a filter makes of a log does not need the log to come from its model.
    fn trajectory(&self, rows: usize) -> Trajectory {
        let mut stream = Stream::new(self.seed, Purpose::Workload, 0, 0);
        let mut draw = |size: f64| self.scale * size * (2.0 * stream.uniform() - 1.0);
        let (mut z, mut u, mut truth) = (Table::new(2), Table::new(0), Table::new(2));
        for _ in 0..rows {
            let missing = |gap: f64, value: f64| if gap.abs() < self.missing * self.scale { f64::NAN } else { value };
            let row = [0, 1].map(|_| missing(draw(1.0), draw(5.0)));
            z.push(&row);
            u.push(&[]);
            truth.push(&[draw(3.0), draw(3.0)]);
        }
        let time = (0u32..).take(rows).map(f64::from).collect();
        Trajectory { id: String::new(), line: vec![2; rows], time, z, u, truth }
    }
}

const CORRELATED: &str = "[[\"r1\", \"rho*sqrt(r1*r2)\"], [\"rho*sqrt(r1*r2)\", \"r2\"]]";
const DIAGONAL: &str = "[\"r1\", \"r2\"]";

fn log(trajectories: Vec<Trajectory>) -> Log {
    let names = |prefix: &str| (1..3).map(|i| format!("{prefix}{i}")).collect();
    Log {
        source: "<drawn>".to_owned(),
        measurements: names("z"),
        inputs: vec![],
        truth: STATES.map(str::to_owned).into(),
        trajectories,
        ..Log::default()
    }
}

/// Costs by the reference and by the f64 lanes, which must agree.
fn costs(problem: &Problem, log: &Log, candidate: &[f64]) -> Vec<f64> {
    let expected = reference::costs(problem, log, candidate).unwrap_or_else(|error| panic!("{error}"));
    let mut lanes = CpuEvaluator::new(problem, log, CpuOptions::default()).unwrap();
    let evaluation = lanes.evaluate(&Population::from_rows(candidate.len(), candidate.to_vec()));
    if expected.iter().all(|c| c.is_finite()) {
        for (lane, expected) in evaluation.costs(0).iter().zip(&expected) {
            assert!(close(*lane, *expected, 1e-9), "lanes {lane}, reference {expected}");
        }
    }
    expected
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs().max(1.0)
}

fn present(log: &Log) -> usize {
    let rows = log.trajectories.iter().flat_map(|t| (0..t.len()).map(|k| t.z.row(k)));
    rows.map(|z| z.iter().filter(|z| !z.is_nan()).count()).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn covariances_stay_symmetric_and_semidefinite(plant in plants()) {
        let run = reference::run(&plant.problem(), &log(vec![plant.trajectory(60)]), &plant.candidate()).unwrap();
        let psd = |p: &DMatrix<f64>| *p == p.transpose() && p.symmetric_eigenvalues().min() >= -1e-13 * p.amax();
        for step in &run.trajectories[0] {
            prop_assert!(psd(&step.prior.p) && psd(&step.posterior.p), "row {}", step.row);
            if let Some(update) = &step.update {
                prop_assert!(update.nll.is_finite() && update.nis >= 0.0, "row {}", step.row);
                prop_assert!(step.posterior.p.trace() <= step.prior.p.trace() * (1.0 + 1e-12), "a measurement informs");
            }
        }
    }

    #[test]
    fn permuted_candidates_have_permuted_costs(plant in plants(), order in Just((0..40usize).collect::<Vec<_>>()).prop_shuffle()) {
        let (problem, log) = (plant.problem(), log(vec![plant.trajectory(30)]));
        let mut lanes = CpuEvaluator::new(&problem, &log, CpuOptions::default()).unwrap();
        let [r1, r2, rho] = plant.candidate();
        let candidate = |i: usize| [r1 * (1.0 + i as f64), r2 / (1.0 + i as f64), rho];
        let rows = |order: &[usize]| Population::from_rows(3, order.iter().flat_map(|i| candidate(*i)).collect());
        let sorted = lanes.evaluate(&rows(&(0..40).collect::<Vec<_>>()));
        let shuffled = lanes.evaluate(&rows(&order));
        for (at, i) in order.iter().enumerate() {
            prop_assert_eq!(shuffled.costs(at), sorted.costs(*i), "candidate {}", i);
        }
    }

    /// All lengths times s: nll gains ln s a present component, squares s^2, what has no unit stays.
    #[test]
    fn costs_follow_units(plant in plants(), s in prop::sample::select(vec![1e-3, 0.5, 3.0, 1e4])) {
        let (small, large) = (plant.clone(), Plant { scale: s, ..plant });
        let (log_small, log_large) = (log(vec![small.trajectory(40)]), log(vec![large.trajectory(40)]));
        let a = costs(&small.problem(), &log_small, &small.candidate());
        let b = costs(&large.problem(), &log_large, &large.candidate());
        prop_assert_eq!(present(&log_small), present(&log_large), "the same gaps");
        let expected = [a[0] + present(&log_small) as f64 * s.ln(), a[1] * s * s, a[2], a[3], a[4], a[5] * s, a[6] * s];
        for (found, expected) in b.iter().zip(expected) {
            prop_assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1e-9) || close(*found, expected, 1e-9)
                || (found.is_nan() && expected.is_nan()), "{} against {}", found, expected);
        }
    }

    #[test]
    fn nothing_depends_on_when_a_log_begins(plant in plants(), start in -1e6..1e6f64) {
        let problem = plant.problem();
        let here = plant.trajectory(40);
        let there = Trajectory { time: here.time.iter().map(|t| t + start.round()).collect(), ..here.clone() };
        let (here, there) = (log(vec![here]), log(vec![there]));
        prop_assert_eq!(costs(&problem, &here, &plant.candidate()), costs(&problem, &there, &plant.candidate()));
    }

    #[test]
    fn two_equal_trajectories_count_twice(plant in plants()) {
        let problem = plant.problem();
        let once = plant.trajectory(40);
        let a = costs(&problem, &log(vec![once.clone()]), &plant.candidate());
        let b = costs(&problem, &log(vec![once.clone(), once]), &plant.candidate());
        let expected = [2.0 * a[0], a[1], a[2], a[3], a[4], a[5], 2.0 * a[6]];
        for (found, expected) in b.iter().zip(expected) {
            prop_assert!(close(*found, expected, 1e-12) || expected.is_nan(), "{} against {}", found, expected);
        }
    }

    #[test]
    fn a_component_that_is_always_missing_might_as_well_not_be_there(plant in plants()) {
        let mut both = plant.trajectory(40);
        let mut alone = Table::new(1);
        let mut masked = Table::new(2);
        for k in 0..both.len() {
            masked.push(&[both.z.row(k)[0], f64::NAN]);
            alone.push(&both.z.row(k)[..1]);
        }
        both.z = masked;
        let single = Trajectory { z: alone, ..both.clone() };
        let text = plant.text(STATES, "[\"r1\"]").replace(", \"z2\"]", "]").replace(", \"y - 0.2*x\"]", "]");
        let problem = Problem::parse(&text, "single.toml").unwrap();
        let single = Log { measurements: vec!["z1".to_owned()], ..log(vec![single]) };
        let a = costs(&plant.problem(), &log(vec![both]), &plant.candidate());
        let b = costs(&problem, &single, &plant.candidate());
        for (a, b) in a.iter().zip(&b) {
            prop_assert!(close(*a, *b, 1e-11) || (a.is_nan() && b.is_nan()), "{} against {}", a, b);
        }
    }

    #[test]
    fn the_order_of_states_does_not_matter(plant in plants()) {
        let log = log(vec![plant.trajectory(40)]);
        let a = costs(&plant.problem(), &log, &plant.candidate());
        let b = costs(&plant.with(["y", "x"], CORRELATED), &log, &plant.candidate());
        for (a, b) in a.iter().zip(&b) {
            prop_assert!(close(*a, *b, 1e-9), "{} against {}", a, b);
        }
    }

    /// The path of a correlated R, its off-diagonal searched and 0, against one scalar at a time.
    #[test]
    fn a_correlation_of_zero_is_no_correlation(plant in plants()) {
        let plant = Plant { rho: 0.0, ..plant };
        let log = log(vec![plant.trajectory(40)]);
        let lanes = |r| {
            let mut lanes = CpuEvaluator::new(&plant.with(STATES, r), &log, CpuOptions::default()).unwrap();
            lanes.evaluate(&Population::from_rows(3, plant.candidate().into())).costs(0).to_vec()
        };
        for (a, b) in lanes(CORRELATED).iter().zip(lanes(DIAGONAL)) {
            prop_assert!(close(*a, b, 1e-10), "{} against {}", a, b);
        }
    }

    /// Rows that an objective skips are filtered all the same: sums over the head and over the tail make the whole.
    #[test]
    fn skipped_rows_are_filtered_but_do_not_score(plant in plants(), skip in 0..40usize) {
        let mut problem = plant.problem();
        let whole = log(vec![plant.trajectory(40)]);
        let head = log(vec![plant.trajectory(skip)]);
        let nll = |skip| vec![Objective { skip, ..Objective::new(Kind::Nll) }];
        problem.tune.objectives = nll(0);
        let all = costs(&problem, &whole, &plant.candidate())[0];
        let first = costs(&problem, &head, &plant.candidate())[0];
        problem.tune.objectives = nll(skip);
        let rest = costs(&problem, &whole, &plant.candidate())[0];
        prop_assert!(close(first + rest, all, 1e-11), "{} + {} against {}", first, rest, all);
    }
}
