//! The WGSL of the tape on whatever adapter there is, against the reference and the CPU lanes.

#[path = "../parity/cases.rs"]
#[expect(dead_code, reason = "shared")]
mod cases;

use cases::cases;
use kfgpu::evaluate::gpu::{GpuEvaluator, GpuOptions, adapters};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Precision};
use kfgpu::reference;

#[test]
fn parity() {
    println!("{:#?}", adapters());
    for precision in [Precision::F32, Precision::F64] {
        for case in cases() {
            let options = GpuOptions { precision, adapter: Some(adapters()[0].name.clone()), ..GpuOptions::default() };
            let t = std::time::Instant::now();
            let mut gpu = match GpuEvaluator::new(&case.problem, &case.log, &options) {
                Ok(gpu) => gpu,
                Err(e) => {
                    println!("{} {precision}: {e}", case.name);
                    continue;
                }
            };
            let build = t.elapsed();
            let t = std::time::Instant::now();
            let on_gpu = gpu.evaluate(&case.population);
            let first = t.elapsed();
            let t = std::time::Instant::now();
            let _ = gpu.evaluate(&case.population);
            let second = t.elapsed();
            let options = CpuOptions { precision, threads: None };
            let mut cpu = CpuEvaluator::new(&case.problem, &case.log, options).unwrap();
            let on_cpu = cpu.evaluate(&case.population);
            let (mut worst_gpu, mut worst_cpu) = (0.0f64, 0.0f64);
            for (i, candidate) in case.population.rows().enumerate() {
                let expected = reference::costs(&case.problem, &case.log, candidate).unwrap();
                for (j, e) in expected.iter().enumerate() {
                    worst_gpu = worst_gpu.max((on_gpu.costs(i)[j] - e).abs() / e.abs().max(1.0));
                    worst_cpu = worst_cpu.max((on_cpu.costs(i)[j] - e).abs() / e.abs().max(1.0));
                }
            }
            println!("{} {precision}: gpu {worst_gpu:.1e}, cpu {worst_cpu:.1e}; build {build:?}, first {first:?}, second {second:?} {:?}", case.name, gpu.failure());
        }
    }
}
