//! Single precision under a diffuse P0, against the f64 reference, in both forms.
//!
//! The reference itself is right to 1e-13 of a total nll at any ratio (`golden_reference/diffuse.rs`).

use crate::case::Case;
use kfgpu::evaluate::{Evaluation, Precision};
use kfgpu::filter::Form;
use kfgpu::objective::Kind;
use kfgpu::reference;

/// One variance of every initial state, where R is around 1.
struct Ratio {
    p0: f64,
    /// Error of a total nll that the factors may make: four times what was measured.
    nll: f64,
    /// Where the errors of P itself lie, in units of the promise.
    full: [f64; 2],
}

const RATIOS: [Ratio; 6] = [
    Ratio { p0: 1e0, nll: 1.2e-4, full: [0.0, 0.5] },
    Ratio { p0: Form::DIFFUSE, nll: 1.2e-4, full: [0.0, 1.0] },
    Ratio { p0: 1e4, nll: 1.2e-4, full: [0.1, 5.0] },
    Ratio { p0: 1e6, nll: 1.4e-4, full: [10.0, 1e3] },
    Ratio { p0: 1e8, nll: 1.2e-4, full: [100.0, f64::INFINITY] },
    Ratio { p0: 1e12, nll: 5e-4, full: [f64::INFINITY, f64::INFINITY] },
];

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

/// Factors keep the promise at every ratio with a margin; P itself keeps it up to the ratio at which factors are chosen,
/// breaks it a thousand times further on, and loses positive definiteness in the end.
#[test]
fn single_precision_under_a_diffuse_start() {
    println!("{:36} {:>5} {:>21} {:>21}", "", "P0/R", "nll by P, by U D U'", "of the promise");
    let mut broken = vec![];
    for ratio in RATIOS {
        for case in cases(ratio.p0) {
            let full = errors(&case, &case.evaluate(Precision::F32, Form::Full));
            let factored = errors(&case, &case.evaluate(Precision::F32, Form::Factored));
            let line = format!(
                "{:36} {:5.0e} {:10.1e} {:10.1e} {:10.1e} {:10.1e}",
                case.name, ratio.p0, full.nll, factored.nll, full.promise, factored.promise
            );
            println!("{line}");
            let [low, high] = ratio.full;
            if factored.nll > ratio.nll || factored.promise > 0.5 || full.promise < low || full.promise > high {
                broken.push(line);
            }
        }
    }
    assert!(broken.is_empty(), "over the budgets:\n{}", broken.join("\n"));
}
