//! The world may be turned and states listed in another order.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::model::Problem;
use kfgpu::reference;
use proptest::prelude::*;
use std::f64::consts::TAU;

const STATES: [&str; 4] = ["x", "y", "vx", "vy"];

/// Range and bearing of a target at constant velocity, its states in an order, its start turned by an angle.
fn problem(filter: &str, order: [usize; 4], turned: f64) -> Problem {
    let start = [800.0, -300.0, -9.0, 4.0];
    let (sin, cos) = turned.sin_cos();
    let x0 = [
        cos * start[0] - sin * start[1],
        sin * start[0] + cos * start[1],
        cos * start[2] - sin * start[3],
        sin * start[2] + cos * start[3],
    ];
    let f = ["x + vx*dt", "y + vy*dt", "vx", "vy"];
    let variance = |i: usize| if i < 2 { "400" } else { "q" };
    let noise = ["q/3", "q/3", "q", "q"];
    let list = |of: &dyn Fn(usize) -> String| order.map(of).join(", ");
    let text = format!(
        "[data]\nfile = \"none.csv\"\nmeasurements = [\"range\", \"bearing\"]\n[model]\nstate = [{}]\nf = [{}]\n\
         h = [\"sqrt(x^2 + y^2)\", \"atan2(y, x)\"]\nangle = [\"bearing\"]\nQ = {{ {} }}\nR = [25, \"rb\"]\nx0 = [{}]\n\
         P0 = [{}]\n[filter]\n{filter}\n[parameters]\nq = {{ min = 0.1, max = 10, start = 1 }}\n\
         rb = {{ min = 1e-5, max = 1e-2, start = 1e-4 }}\n[tune]\nobjectives = [\"nll\"]\n",
        list(&|i| format!("\"{}\"", STATES[i])),
        list(&|i| format!("\"{}\"", f[i])),
        list(&|i| format!("{} = \"{}\"", STATES[i], noise[i])),
        list(&|i| format!("{:e}", x0[i])),
        list(&|i| format!("\"{}\"", variance(i))),
    );
    Problem::parse(&text, "turned.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Forty rows that pass the sensor, every bearing turned by an angle into [-pi, pi).
fn log(errors: &[f64], turned: f64) -> Log {
    let (mut z, mut empty, mut truth) = (Table::new(2), Table::new(0), Table::new(0));
    for (k, error) in errors.chunks(2).enumerate() {
        let (x, y) = (800.0 - 40.0 * k as f64, -300.0 + 15.0 * k as f64);
        let bearing = y.atan2(x) + 0.01 * error[1] + turned;
        let bearing = bearing - TAU * (bearing / TAU + 0.5).floor();
        z.push(&[x.hypot(y) + 5.0 * error[0], bearing]);
        empty.push(&[]);
        truth.push(&[]);
    }
    let time: Vec<f64> = (0u32..).take(errors.len() / 2).map(f64::from).collect();
    let line = (2..).take(time.len()).collect();
    let trajectory = Trajectory { id: String::new(), line, time, z, u: empty, truth };
    Log {
        source: "turned.csv".to_owned(),
        measurements: vec!["range".to_owned(), "bearing".to_owned()],
        trajectories: vec![trajectory],
        ..Log::default()
    }
}

fn nll(problem: &Problem, log: &Log, precision: Precision) -> f64 {
    let mut lanes = CpuEvaluator::new(problem, log, CpuOptions { precision, threads: None }).unwrap();
    lanes.evaluate(&Population::from_rows(2, vec![1.5, 2e-4])).costs(0)[0]
}

const NATURAL: [usize; 4] = [0, 1, 2, 3];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// A turn of everything by any angle moves the track over the seam at +-pi, and changes no likelihood.
    #[test]
    fn turning_the_world_changes_no_likelihood(
        turned in -9.0..9.0f64,
        errors in prop::collection::vec(-1.5..1.5f64, 80),
        filter in prop::sample::select(vec!["extended", "iterated"]),
    ) {
        let filter = format!("kind = \"{filter}\"");
        let (before, after) = (problem(&filter, NATURAL, 0.0), problem(&filter, NATURAL, turned));
        let (still, moved) = (log(&errors, 0.0), log(&errors, turned));
        let expected = nll(&before, &still, Precision::F64);
        let found = nll(&after, &moved, Precision::F64);
        prop_assert!((found - expected).abs() <= 1e-8 * expected.abs().max(1.0), "{found} against {expected}");
        let judged = reference::costs(&after, &moved, &[1.5, 2e-4]).unwrap()[0];
        prop_assert!((found - judged).abs() <= 1e-9 * expected.abs().max(1.0), "{found}, the reference says {judged}");
        let single = nll(&after, &moved, Precision::F32);
        prop_assert!((single - expected).abs() <= 4e-4 * (expected / 40.0).abs().max(1.0), "{single} in f32 against {expected}");
    }

    /// The extended filter does not depend on the order of its states. (Sigma points do: they are drawn along the columns of a
    /// triangular root.)
    #[test]
    fn the_extended_filter_has_no_order_of_states(
        errors in prop::collection::vec(-1.5..1.5f64, 80),
        order in Just(NATURAL).prop_shuffle(),
    ) {
        let log = log(&errors, 0.0);
        let expected = nll(&problem("kind = \"extended\"", NATURAL, 0.0), &log, Precision::F64);
        let found = nll(&problem("kind = \"extended\"", order, 0.0), &log, Precision::F64);
        prop_assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{found} against {expected}");
    }
}
