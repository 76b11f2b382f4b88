//! What cannot be traced is refused, for those too who use the library and check nothing beforehand.

use super::columns::Columns;
use super::form::{Carrying, Form};
use super::rounds::trace_rows;
use super::rows::Rows;
use super::step::Request;
use super::{TraceError, Units, scattered};
use crate::data::Log;
use crate::evaluate::{BuildError, CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use crate::model::Problem;
use crate::reference;
use crate::simulate::simulate;
use std::path::Path;

const REGULAR: &str = "t,z,u\n0,1,0\n1,2,0\n2,2,0\n";
const IRREGULAR: &str = "t,z,u\n0,1,0\n1,2,0\n3,2,0\n";
const ONE_ROW: &str = "t,z,u\n0,1,0\n";

/// A local level; `more` ends its `[model]`.
fn problem(q: &str, more: &str) -> Problem {
    let text = format!(
        "[data]\nfile = \"log.csv\"\ntime = \"t\"\nmeasurements = [\"z\"]\n[model]\nstate = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\n\
         Q = [[\"{q}\"]]\nR = [\"r\"]\nx0 = [0]\nP0 = [4]\n{more}\n[parameters]\nr = {{ min = 0.1, max = 9, start = 1 }}\n"
    );
    Problem::parse(&text, "problem.toml").unwrap()
}

fn log(problem: &Problem, text: &str) -> Log {
    Log::read(&problem.data, text.as_bytes(), "log.csv").unwrap()
}

fn refusal(problem: &Problem, log: &Log, precision: Precision) -> Option<TraceError> {
    match CpuEvaluator::new(problem, log, CpuOptions { precision, ..CpuOptions::default() }) {
        Ok(_) => None,
        Err(BuildError::Trace(error)) => Some(error),
    }
}

#[test]
fn a_step_before_the_first_row_needs_an_interval() {
    let predict = problem("0.1", "first = \"predict\"");
    for text in [IRREGULAR, ONE_ROW] {
        let log = log(&predict, text);
        for precision in [Precision::F64, Precision::F32] {
            assert_eq!(
                refusal(&predict, &log, precision),
                Some(TraceError::NoFirstInterval),
                "{precision} on {text:?}"
            );
        }
        let failure = reference::costs(&predict, &log, &[1.0]).unwrap_err();
        assert_eq!(failure.what, reference::Cause::NoFirstInterval, "the reference on {text:?}");
        let given = problem("0.1", "first = \"predict\"\nfirst_dt = 1");
        assert_eq!(refusal(&given, &log, Precision::F64), None, "first_dt on {text:?}");
    }
    assert_eq!(refusal(&predict, &log(&predict, REGULAR), Precision::F64), None, "a regular log");
}

#[test]
fn the_log_has_the_columns_of_the_problem() {
    let problem = problem("0.1", "");
    let mut other = problem.data.clone();
    other.inputs = vec!["u".to_owned()];
    let log = Log::read(&other, REGULAR.as_bytes(), "log.csv").unwrap();
    let expected = TraceError::WrongColumns { found: [1, 1], expected: [1, 0] };
    assert_eq!(refusal(&problem, &log, Precision::F64), Some(expected));
}

/// Formulas may be so long, and so many, that a step has more numbers than operations can name.
#[test]
fn a_step_of_too_many_numbers_is_refused() {
    let n = 18_u32;
    let names = |format: &dyn Fn(u32) -> String| (0..n).map(format).collect::<Vec<_>>().join(", ");
    let entry = |i: u32, j: u32| {
        let (low, high) = (i.min(j), i.max(j));
        let terms = (0..400).map(|k| format!("r^{}", 2 + (low * n + high) * 400 + k)).collect::<Vec<_>>().join("+");
        if i == j { format!("\"{terms}+1e9\"") } else { format!("\"({terms})*1e-300\"") }
    };
    let text = format!(
        "[data]\nfile = \"log.csv\"\ntime = \"t\"\nmeasurements = [\"z\"]\n[model]\nstate = [{}]\nf = [{}]\nh = [\"x0\"]\nQ = [{}]\n\
         R = [1]\nx0 = [{}]\nP0 = [{}]\n[parameters]\nr = {{ min = 0.1, max = 0.9, start = 0.5 }}\n",
        names(&|i| format!("\"x{i}\"")),
        names(&|i| format!("\"x{i}\"")),
        names(&|i| format!("[{}]", names(&|j| entry(i, j)))),
        names(&|_| "0".to_owned()),
        names(&|_| "1".to_owned()),
    );
    let problem = Problem::parse(&text, "long.toml").unwrap();
    let found = refusal(&problem, &log(&problem, REGULAR), Precision::F64);
    assert!(matches!(found, Some(TraceError::TooLarge(_))), "{found:?}");
}

#[test]
fn shipped_problems_are_traced() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let problems: Vec<_> = files.filter(|path| path.extension().is_some_and(|kind| kind == "toml")).collect();
    assert!(problems.len() >= 10, "{problems:?}");
    for path in problems {
        let problem = Problem::open(&path).unwrap();
        let log = match problem.data.file {
            Some(_) => Log::open(&problem.data, &folder).unwrap(),
            None => simulate(&problem, None).unwrap(),
        };
        for precision in [Precision::F32, Precision::F64] {
            assert_eq!(refusal(&problem, &log, precision), None, "{} in {precision}", path.display());
        }
    }
}

/// Costs of the baseline and 7 other candidates, in f64.
fn costs(problem: &Problem, log: &Log, carrying: Carrying) -> Vec<f64> {
    let (rows, mut columns) = (Rows::new(problem, log), Columns::default());
    let units = Units::own(problem.model.states.len(), problem.model.measurements.len());
    let objectives = &problem.tune.objectives;
    let request = Request { objectives, nominal: None, carrying, units: &units, watch: None };
    let program = trace_rows(problem, &rows, &mut columns, &request).unwrap();
    let mut candidates = vec![problem.parameters.baseline()];
    candidates.extend(scattered(&problem.parameters, 7));
    let population = Population::from_rows(problem.parameters.dimension(), candidates.concat());
    let found = CpuEvaluator::of_program(program, None).evaluate(&population);
    (0..population.len()).flat_map(|i| found.costs(i).to_vec()).collect()
}

/// On linear models all filters of one gaussian are one, also where none is told that f and h are affine.
#[test]
fn rules_for_any_formula_are_exact_for_affine_ones() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["nile", "rocket", "robot", "uav_gps_cv", "tum_fr2_desk", "refuelling"] {
        let text = std::fs::read_to_string(folder.join(format!("examples/{name}.toml"))).unwrap();
        let problem = Problem::parse(&text, name).unwrap();
        let log = match problem.data.file {
            Some(_) => Log::open(&problem.data, &folder.join("examples")).unwrap(),
            None => simulate(&problem, None).unwrap(),
        };
        let plain = Carrying { form: Form::Full, anchored: false, affine: true };
        let expected = costs(&problem, &log, plain);
        for kind in ["extended", "iterated", "unscented", "cubature"] {
            let mut problem = problem.clone();
            let text = format!("{text}\n[filter]\nkind = \"{kind}\"\n");
            problem.filter = Problem::parse(&text, name).unwrap().filter;
            for (form, affine) in
                [(Form::Full, true), (Form::Full, false), (Form::Factored, false), (Form::Lower, false)]
            {
                let found = costs(&problem, &log, Carrying { form, affine, ..plain });
                for (found, expected) in found.iter().zip(&expected) {
                    let error = (found - expected).abs() / expected.abs().max(1.0);
                    assert!(
                        error <= 1e-10,
                        "{name}, {kind}, {form}, affine {affine}: {found} against {expected}: {error:e}"
                    );
                }
            }
        }
    }
}
