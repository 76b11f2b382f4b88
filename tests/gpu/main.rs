//! The kernel on an adapter, against the reference and the CPU lanes; what happens when the adapter is lost.
//!
//! `KFGPU_TEST_GPU` says what to do where there is no adapter: `auto` (default) skips and says so, `require` fails, `off`
//! skips whatever there is. A software adapter such as Mesa's llvmpipe is right for these tests.

#![cfg(feature = "gpu")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "the table of errors is a result")]
#![allow(clippy::cast_possible_truncation, reason = "f32 is what kernels compute in")]
#![allow(clippy::float_cmp, reason = "the same bits are promised")]

#[path = "../functions/budget.rs"]
mod budget;
#[path = "../parity/case.rs"]
#[allow(dead_code, reason = "shared with the parity of the CPU")]
mod case;
#[path = "../parity/cases/mod.rs"]
mod cases;
mod constraints;
#[path = "../units/family.rs"]
#[allow(dead_code, reason = "shared with the lanes")]
mod family;
mod faults;
mod functions;
mod grid;
#[path = "../parity/logs.rs"]
#[allow(dead_code, reason = "shared with the parity of the CPU")]
mod logs;
mod parity;
mod parts;
#[path = "../parity/promise.rs"]
#[allow(dead_code, reason = "shared with the parity of the CPU")]
mod promise;
#[path = "../functions/table.rs"]
#[allow(dead_code, reason = "shared with the lanes")]
mod table;
mod trajectories;
mod units;

use case::Case;
use kfgpu::evaluate::gpu::{GpuEvaluator, GpuOptions, adapters};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Precision};
use std::io::Write as _;
use std::sync::OnceLock;

/// The adapter to test on: the first, which is real hardware where there is any. `None` skips the test.
fn adapter() -> Option<String> {
    static NAME: OnceLock<Option<String>> = OnceLock::new();
    let policy = policy();
    assert!(["auto", "require", "off"].contains(&policy.as_str()), "KFGPU_TEST_GPU is {policy}: auto, require or off");
    let find = || if policy == "off" { None } else { adapters().into_iter().next().map(|a| a.name) };
    let name = NAME.get_or_init(find).clone();
    assert!(name.is_some() || policy != "require", "KFGPU_TEST_GPU=require and there is no adapter");
    if name.is_none() {
        // Not by eprintln, which the test harness would keep to itself.
        let _ = writeln!(std::io::stderr(), "SKIPPED, no GPU adapter to test on (KFGPU_TEST_GPU={policy})");
    }
    name
}

/// The same, if it has f64; `require` fails without.
fn adapter_with_f64() -> Option<String> {
    let name = adapter()?;
    let has_f64 = adapters().iter().any(|adapter| adapter.name == name && adapter.f64);
    assert!(has_f64 || policy() != "require", "KFGPU_TEST_GPU=require and `{name}` has no f64");
    if !has_f64 {
        let _ = writeln!(std::io::stderr(), "SKIPPED in f64, which `{name}` has not");
    }
    has_f64.then_some(name)
}

fn policy() -> String {
    std::env::var("KFGPU_TEST_GPU").unwrap_or_else(|_| "auto".to_owned())
}

fn options(adapter: &str, precision: Precision) -> GpuOptions {
    GpuOptions { precision, adapter: Some(adapter.to_owned()), ..GpuOptions::default() }
}

fn gpu(case: &Case, options: &GpuOptions) -> GpuEvaluator {
    GpuEvaluator::new(&case.problem, &case.log, options).unwrap_or_else(|error| panic!("{}: {error}", case.name))
}

fn cpu(case: &Case, precision: Precision) -> CpuEvaluator {
    let options = CpuOptions { precision, threads: None };
    CpuEvaluator::new(&case.problem, &case.log, options).unwrap_or_else(|error| panic!("{}: {error}", case.name))
}

/// Every bit of an evaluation.
fn bits(evaluation: &Evaluation) -> Vec<(Vec<u64>, u32)> {
    let of = |i| (evaluation.costs(i).iter().map(|c| c.to_bits()).collect(), evaluation.status(i).bits());
    (0..evaluation.len()).map(of).collect()
}
