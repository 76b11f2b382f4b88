//! What constraints bound is computed by the kernel as by the lanes.

use crate::{adapter, options};
use kfgpu::evaluate::gpu::GpuEvaluator;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::model::Problem;
use kfgpu::simulate::simulate;
use std::path::Path;

#[test]
fn violations_are_those_of_the_lanes() {
    let Some(adapter) = adapter() else { return };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/rocket.toml");
    let constraints =
        "constraints = [\"nis_mean <= 1.1\", \"nees_mean >= 2\", { name = \"rmse\", skip = 9, max = 4 }]\n";
    let text = std::fs::read_to_string(path).unwrap().replace("[tune]\n", &format!("[tune]\n{constraints}"));
    let problem = Problem::parse(&text, "rocket.toml").unwrap();
    let log = simulate(&problem, None).unwrap();
    let population = Population::from_rows(1, (0..100).map(|i| 0.1 * 1.06_f64.powi(i)).collect());
    let mut on_gpu = GpuEvaluator::new(&problem, &log, &options(&adapter, Precision::F32)).unwrap();
    let found = on_gpu.evaluate(&population);
    assert_eq!(on_gpu.failure(), None, "the GPU itself computed this");
    let single = CpuOptions { precision: Precision::F32, ..CpuOptions::default() };
    let lanes = CpuEvaluator::new(&problem, &log, single).unwrap().evaluate(&population);
    assert_eq!((found.objectives(), lanes.objectives()), (1, 1), "constraints are no objectives");
    let off = |i| (found.violation(i) - lanes.violation(i)).abs() / lanes.violation(i).max(1.0);
    let worst = (0..population.len()).map(off).fold(0.0, f64::max);
    println!("violations differ by at most {worst:.1e}");
    assert!(worst < 1e-5, "{worst:e}");
    assert!((0..population.len()).any(|i| lanes.violation(i) > 0.5), "some of them violate");
    // A lost device hands the constraints over, too.
    on_gpu.lose_device();
    let after = on_gpu.evaluate(&population);
    assert!((0..population.len()).all(|i| after.violation(i) == lanes.violation(i)), "by the same lanes");
}
