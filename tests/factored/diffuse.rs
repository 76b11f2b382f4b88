//! Single precision under a diffuse P0, against the f64 reference, in both forms.
//!
//! The reference itself is off by 3e-9 of a total nll at P0/R = 1e8 and by 1.3e-5 at 1e12 (`golden_reference/diffuse.rs`).

use crate::case::Case;
use kfgpu::evaluate::{Evaluation, Precision};
use kfgpu::filter::Form;
use kfgpu::objective::Kind;
use kfgpu::reference;

/// Variance of every initial state; R is around 1.
const RATIOS: [f64; 4] = [1e4, 1e6, 1e8, 1e12];

/// A built-in model over a log of 100 intervals, whose truth starts where P0 = 100 puts it.
fn diffuse(name: &str, kind: &str, axes: usize, depth: usize, strengths: &str, ratio: f64, simulate: &str) -> Case {
    let names = &["x", "y", "z"][..axes];
    let list = |of: &str| vec![format!("\"{of}\""); axes].join(", ");
    let numbers = |v: f64| vec![format!("{v:e}"); axes * depth].join(", ");
    let prefixes = match kind {
        "local-linear-trend" => ["", "slope_", ""],
        _ => ["", "v", "a"],
    };
    let states = prefixes[..depth].iter().flat_map(|p| names.iter().map(move |a| format!("{p}{a}")));
    let truth: Vec<String> = states.map(|s| format!("{s} = \"{s}\"")).collect();
    let starts: Vec<String> = (0..axes * depth).map(|i| format!("{}", 10.0 - 3.5 * i as f64)).collect();
    let text = format!(
        "[data]\ntime = \"t\"\nmeasurements = {names:?}\ntruth = {{ {} }}\n[model]\nkind = \"{kind}\"\n\
         axes = {names:?}\n{strengths}\nR = [{}]\nx0 = [{}]\nP0 = [{}]\n[parameters]\n\
         q = {{ min = 1e-2, max = 1, scale = \"log\", start = 0.1 }}\n\
         r = {{ min = 0.5, max = 2, scale = \"log\", start = 1 }}\n[tune]\nalgorithm = \"pso\"\n\
         objectives = [\"nll\", \"mse_innovation\", \"mismatch\", \"rmse\"]\n\
         [simulate]\nsteps = 100\ndt = 0.37\nseed = 11\nx0 = [{}]\n{simulate}\n",
        truth.join(", "),
        list("r"),
        numbers(0.0),
        numbers(ratio),
        starts.join(", "),
    );
    Case::simulated(name, &text)
}

fn cases(ratio: f64) -> Vec<Case> {
    let q = "noise = \"continuous\"\nq = \"q\"";
    let piecewise = "noise = \"piecewise\"\nq = \"q\"";
    let trend = "noise = \"continuous\"\nq_level = \"q\"\nq_slope = \"q\"";
    let gaps = "missing = 0.3\nskip_first = true";
    vec![
        diffuse("CV 1-D", "constant-velocity", 1, 2, q, ratio, ""),
        diffuse("CV 1-D, rank-1 Q, gaps", "constant-velocity", 1, 2, piecewise, ratio, gaps).irregular(),
        diffuse("CV 3-D", "constant-velocity", 3, 2, q, ratio, ""),
        diffuse("CV 3-D, gaps", "constant-velocity", 3, 2, q, ratio, gaps),
        diffuse("CA 1-D", "constant-acceleration", 1, 3, q, ratio, ""),
        diffuse("CA 1-D, rank-1 Q, gaps", "constant-acceleration", 1, 3, piecewise, ratio, gaps).irregular(),
        diffuse("local linear trend", "local-linear-trend", 1, 2, trend, ratio, ""),
    ]
}

/// Errors over the candidates, each in units of the promise of semantics.md; infinite where a candidate failed.
struct Errors {
    /// Largest absolute error of the total nll.
    nll: f64,
    /// Largest error of any cost over what is promised for it.
    promise: f64,
}

fn errors(case: &Case, found: &Evaluation) -> Errors {
    let rows = case.log.rows() as f64;
    let mut errors = Errors { nll: 0.0, promise: 0.0 };
    for (i, candidate) in case.population.rows().enumerate() {
        let expected = reference::costs(&case.problem, &case.log, candidate).unwrap();
        if !found.status(i).is_ok() {
            return Errors { nll: f64::INFINITY, promise: f64::INFINITY };
        }
        for ((objective, cost), expected) in case.problem.tune.objectives.iter().zip(found.costs(i)).zip(expected) {
            let error = (cost - expected).abs();
            let allowed = match objective.kind {
                Kind::Nll => 1e-5 * rows * (expected / rows).abs().max(1.0),
                Kind::Mismatch => 1e-3,
                _ => 1e-5 * expected,
            };
            if objective.kind == Kind::Nll {
                errors.nll = errors.nll.max(error);
            }
            errors.promise = errors.promise.max(error / allowed);
        }
    }
    errors
}

#[test]
fn single_precision_under_a_diffuse_start() {
    println!("{:30} {:>7}  nll: {:>9} {:>9}  of the promise: {:>9} {:>9}", "", "P0/R", "P", "U D U'", "P", "U D U'");
    for ratio in RATIOS {
        for case in cases(ratio) {
            let full = errors(&case, &case.evaluate(Precision::F32, Form::Full));
            let factored = errors(&case, &case.evaluate(Precision::F32, Form::Factored));
            println!(
                "{:30} {ratio:7.0e}       {:9.1e} {:9.1e}                  {:9.1e} {:9.1e}",
                case.name, full.nll, factored.nll, full.promise, factored.promise
            );
        }
    }
}
