//! Studies of robust filters on a log of which 6 % are outliers: a robot that UWB ranges place, metres off by multipath.

use super::tune;
use kfgpu::data::Log;
use kfgpu::evaluate::CpuOptions;
use kfgpu::model::Problem;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{run, score};
use std::path::Path;

const KINDS: [(&str, &str); 5] = [
    ("mixture", "eps = \"eps\""),
    ("student-t", "dof = \"dof\""),
    ("huber", ""),
    ("correntropy", "k = \"3*k\""),
    ("gate", "gate = \"gate\""),
];

/// The log with a filter; with `robust` empty the plain one.
fn problem(robust: &str, keys: &str) -> (Problem, Log) {
    let robust = if robust.is_empty() { String::new() } else { format!("robust = \"{robust}\"\n{keys}") };
    let text = format!(
        r#"[data]
file = "uwb.csv"
time = "t"
measurements = ["uwb"]
truth = {{ p = "true_p" }}
[model]
state = ["p", "v"]
f = ["p + v*dt", "v"]
h = ["p"]
Q = [["q*dt^3/3", "q*dt^2/2"], ["q*dt^2/2", "q*dt"]]
R = ["r"]
x0 = [0, 0]
P0 = [1, 1]
[filter]
{robust}
[parameters]
q = {{ min = 1e-6, max = 100, scale = "log", start = 0.01 }}
r = {{ min = 1e-6, max = 100, scale = "log", start = 0.0064 }}
eps = {{ min = 1e-4, max = 0.5, scale = "log", start = 0.05 }}
dof = {{ min = 2.05, max = 30, start = 4 }}
k = {{ min = 0.2, max = 3, start = 1 }}
gate = {{ min = 0.1, max = 30, start = 9 }}
[tune]
population = 64
generations = 30
"#
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/outliers");
    let problem = Problem::parse(&text, "uwb.toml").unwrap_or_else(|error| panic!("{error}"));
    let log = Log::open(&problem.data, &folder).expect("a log");
    (problem, log)
}

/// Share rejected and rmse of the tuned filter.
fn tuned(case: &(Problem, Log), seed: u64) -> (f64, f64) {
    let spec = kfgpu::model::TuneSpec { seed, ..case.0.tune.clone() };
    let outcome = tune(case, &spec, CpuOptions::default());
    let candidate = outcome.winner.expect("a winner").candidate;
    let run = run(&case.0, &case.1, &candidate).expect("runs");
    let found = score(&case.0, &case.1, &run, &[Kind::Rejected, Kind::Rmse].map(Objective::new));
    (found[0], found[1])
}

/// Scored without the rows that they reject, searches reject nearly all; by a density over all rows they do not.
#[test]
fn a_search_does_not_reject_nearly_everything() {
    for (kind, keys) in KINDS {
        let case = problem(kind, keys);
        for seed in 0..2 {
            let (rejected, rmse) = tuned(&case, seed);
            assert!((0.01..0.3).contains(&rejected), "{kind}, seed {seed}: {rejected} rejected");
            // A gate with the true values has .0398, the plain filter .30.
            assert!(rmse < 0.08, "{kind}, seed {seed}: rmse {rmse}");
        }
    }
    let (rejected, rmse) = tuned(&problem("", ""), 0);
    assert!(rejected == 0.0 && rmse > 0.25, "plain: rmse {rmse}");
}
