//! 1. A heater warms a room towards the weather outside; a cheap thermometer watches. The model is typed as formulas.
//! 2. Logs are drawn from a known truth, so that the tuned parameters can be compared with it.
//! 3. One log is one draw: twenty of them show how far the tuned values scatter, and that they scatter around the truth.
//!
//! `cargo run --release --example 02_own_model`

#![expect(clippy::print_stdout, reason = "a story is read on the terminal")]

use kfgpu::evaluate::{CpuEvaluator, CpuOptions};
use kfgpu::model::Problem;
use kfgpu::reference;
use kfgpu::simulate::simulate;
use kfgpu::study::{self, Judge, Study};
use std::error::Error;
use std::sync::atomic::AtomicBool;

/// Room temperature T [K above outside], warmed at an unknown constant rate p [K/s], losing heat with time constant tau.
const ROOM: &str = r#"
[data]
measurements = ["reading"]
truth = { T = "T", p = "p" }

[model]
state = ["T", "p"]
f = ["T*exp(-dt/tau) + p*dt", "p"]
h = ["T"]
Q = { T = "q*dt" }
R = ["r"]
x0 = [0, 0]
P0 = [25, 1e-4]

[parameters]
tau = { min = 300, max = 10000, scale = "log", start = 600, unit = "s" }
q = { min = 1e-6, max = 1e-2, scale = "log", start = 1e-3, unit = "K^2/s" }
r = { min = 1e-3, max = 10, scale = "log", start = 1, unit = "K^2" }

[tune]
population = 32
generations = 20

[simulate]
steps = 600
dt = 20
x0 = [2, 0.008]
parameters = { tau = 1800, q = 1e-4, r = 0.09 }
missing = 0.1
"#;

/// Logs drawn.
const LOGS: u64 = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let problem = Problem::parse(ROOM, "room.toml")?;
    let mut tuned: Vec<Vec<f64>> = Vec::new();
    for seed in 0..LOGS {
        let log = simulate(&problem, Some(seed))?;
        let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default())?;
        let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
        let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
        let outcome = study::run(&Study::of(&problem), &mut evaluator, judge, &mut [], &AtomicBool::new(false))?;
        tuned.push(outcome.winner.ok_or("every candidate failed")?.candidate);
    }

    let truth = problem.simulate.as_ref().map_or(&[][..], |s| &s.parameters);
    println!("{LOGS} logs: median of the tuned values and the band that holds 90 % of them, beside the truth");
    for (i, (name, value)) in truth.iter().enumerate() {
        let mut values: Vec<f64> = tuned.iter().map(|candidate| candidate[i]).collect();
        values.sort_by(f64::total_cmp);
        let (low, median, high) = (values[1], f64::midpoint(values[9], values[10]), values[18]);
        let inside = if (low..=high).contains(value) { "inside" } else { "OUTSIDE" };
        println!("{name:>4}: {median:.3e}  [{low:.3e}, {high:.3e}]  truth {value:.3e} {inside}");
    }
    Ok(())
}
