//! Filters for any f and h are the linear Kalman filter where f and h are affine.

use std::path::Path;

use kfgpu::data::Log;
use kfgpu::model::Problem;
use kfgpu::reference::{Estimate, run, smooth};
use kfgpu::simulate::simulate;

const KINDS: [&str; 5] = [
    "kind = \"extended\"",
    "kind = \"iterated\"",
    "kind = \"unscented\"",
    "kind = \"unscented\"\nalpha = 0.5\nbeta = 2\nkappa = 0",
    "kind = \"cubature\"",
];

/// Largest difference, of states in standard deviations, of covariances in their products.
fn apart(found: &Estimate, expected: &Estimate) -> f64 {
    let n = found.x.len();
    let sd: Vec<f64> = expected.p.diagonal().iter().map(|p| p.sqrt()).collect();
    let share = |difference: f64, unit: f64| if unit > 0.0 { difference.abs() / unit } else { difference.abs() };
    let x = (0..n).map(|i| share(found.x[i] - expected.x[i], sd[i].max(1e-3 * expected.x[i].abs())));
    let p = (0..n * n).map(|k| share(found.p[k] - expected.p[k], sd[k / n] * sd[k % n]));
    x.chain(p).fold(0.0, f64::max)
}

#[test]
fn every_kind_is_the_kalman_filter_on_the_shipped_linear_problems() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut compared = 0;
    for entry in std::fs::read_dir(&folder).expect("the folder is there") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        let Some(text) = name.ends_with(".toml").then(|| std::fs::read_to_string(&path).expect("text")) else {
            continue;
        };
        if text.contains("[filter]") {
            continue;
        }
        let linear = Problem::parse(&text, &name).expect("the example is valid");
        let log = match linear.data.file {
            Some(_) => Log::open(&linear.data, &folder).expect("its log is valid"),
            None => simulate(&linear, None).expect("its log can be drawn"),
        };
        let candidate = linear.parameters.baseline();
        let expected = run(&linear, &log, &candidate).expect("runs");
        let smoothed = smooth(&linear, &log, &candidate).expect("smooths");
        for kind in KINDS {
            let problem = Problem::parse(&format!("{text}\n[filter]\n{kind}\n"), &name).expect("the problem parses");
            let found = run(&problem, &log, &candidate).expect("runs");
            let mut worst = [0.0f64; 3];
            for (a, b) in found.trajectories.iter().flatten().zip(expected.trajectories.iter().flatten()) {
                worst[0] = worst[0].max(apart(&a.posterior, &b.posterior)).max(apart(&a.prior, &b.prior));
                assert_eq!(a.update.is_some(), b.update.is_some(), "{name}, {kind}, row {}", a.row);
                if let (Some(a), Some(b)) = (&a.update, &b.update) {
                    worst[1] = worst[1].max((a.nll - b.nll).abs() / b.nll.abs().max(1.0));
                }
            }
            let all = smooth(&problem, &log, &candidate).expect("smooths");
            for (a, b) in all.iter().flatten().zip(smoothed.iter().flatten()) {
                worst[2] = worst[2].max(apart(&a.estimate, &b.estimate));
            }
            println!("{name}, {kind:?}: states {:.1e}, nll {:.1e}, smoothed {:.1e}", worst[0], worst[1], worst[2]);
            assert!(worst.iter().all(|worst| *worst < 1e-10), "{name}, {kind}: {worst:?}");
            compared += 1;
        }
    }
    assert!(compared >= 40, "{compared} compared");
}
