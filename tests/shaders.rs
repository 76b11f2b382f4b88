//! naga, the compiler that every GPU backend starts from, accepts the kernel of every case, with no GPU.

#![cfg(feature = "gpu")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "how many were checked is a result")]

#[path = "parity/case.rs"]
#[allow(dead_code, reason = "shared with the parity of the CPU")]
mod case;
#[path = "parity/cases/mod.rs"]
mod cases;
#[path = "parity/logs.rs"]
#[allow(dead_code, reason = "shared with the parity of the CPU")]
mod logs;

use case::{Case, Single, Text};
use kfgpu::evaluate::gpu::{GpuError, assemble};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Precision};
use kfgpu::tape::wgsl::WgslError;
use logs::{Interval, Shape};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use rayon::prelude::*;

fn validate(source: &str) -> Result<ModuleInfo, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::FLOAT64);
    validator.validate(&module).map_err(|error| error.emit_to_string(source))
}

fn source(case: &Case, precision: Precision) -> Result<String, GpuError> {
    let options = CpuOptions { precision, threads: None };
    let evaluator = CpuEvaluator::new(&case.problem, &case.log, options)?;
    assemble(evaluator.program())
}

/// A step with an exponential of what varies from row to row and from candidate to candidate.
fn decay() -> Case {
    let text = Text {
        model: "state = [\"x\"]\nf = [\"x*exp(-r*dt)\"]\nh = [\"x\"]\nQ = [\"q\"]\nR = [1]\nx0 = [0]\nP0 = [10]",
        ..Text::BASIC
    };
    Case::new("decay", &text, Shape::regular(&[20]).every(Interval::Irregular(1.0)), 3)
}

/// Validates the kernels of all cases; how many, and which have none in this precision.
fn check(precision: Precision) -> (usize, Vec<(String, GpuError)>) {
    let cases = cases::all();
    let one = |case: &Case| match source(case, precision) {
        Ok(source) => {
            validate(&source).unwrap_or_else(|error| panic!("{} {precision}:\n{error}", case.name));
            None
        }
        Err(error) => Some((case.name.clone(), error)),
    };
    let without: Vec<_> = cases.par_iter().filter_map(one).collect();
    println!("{} kernels in {precision}, {} refused", cases.len() - without.len(), without.len());
    (cases.len(), without)
}

#[test]
fn every_kernel_in_f32_is_valid() {
    let (_, without) = check(Precision::F32);
    let refused = cases::all().iter().filter(|case| case.single == Single::Refused).count();
    assert_eq!(without.len(), refused, "only what single precision cannot hold: {without:?}");
}

#[test]
fn every_kernel_in_f64_is_valid_and_a_function_that_wgsl_lacks_is_named() {
    let (cases, without) = check(Precision::F64);
    // Filters of any formula, several models and densities call functions in every row.
    let other: Vec<_> =
        without.iter().filter(|(_, error)| !matches!(error, GpuError::Wgsl(WgslError::NotInF64 { .. }))).collect();
    assert!(cases - without.len() > 100 && other.is_empty(), "{cases} cases, without a kernel: {other:?}");
    let error = source(&decay(), Precision::F64).err();
    let expected = WgslError::NotInF64 { function: "exp".to_owned() };
    assert_eq!(error, Some(GpuError::Wgsl(expected)), "the host cannot take exp(-rate * dt) where both vary");
}

#[test]
fn a_broken_kernel_is_found() {
    let case = &cases::all()[0];
    let source = source(case, Precision::F32).unwrap();
    validate(&source).unwrap();
    for broken in [source.replace("let v0 =", "let v0 = 1u +"), source.replacen("v1", "unknown", 1)] {
        assert!(broken != source && validate(&broken).is_err(), "a broken kernel passes");
    }
}

#[test]
fn the_kernel_of_a_shipped_problem_has_its_whole_step() {
    for name in ["rocket", "uav_gps_cv"] {
        let case = cases::all().into_iter().find(|case| case.name == name).unwrap();
        let options = CpuOptions { precision: Precision::F32, threads: None };
        let evaluator = CpuEvaluator::new(&case.problem, &case.log, options).unwrap();
        let program = evaluator.program();
        let source = assemble(program).unwrap();
        validate(&source).unwrap();
        // One `let` an operation, and no mark of the skeleton is left.
        let lets = source.lines().filter(|line| line.trim_start().starts_with("let ")).count();
        let operations: usize = program.steps().iter().map(|step| step.tape().operations.len()).sum();
        assert!(lets >= operations, "{name}: {lets} of {operations}");
        assert!(!source.lines().any(|line| line.trim_start().starts_with("//#")), "{name}: {source}");
    }
}
