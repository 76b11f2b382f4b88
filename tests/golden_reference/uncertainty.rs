//! Standard errors against the likelihood of dense algebra, whose derivatives are known in closed form.

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions};
use kfgpu::model::Problem;
use kfgpu::reference;
use kfgpu::report::Uncertainty;
use kfgpu::simulate::simulate;
use kfgpu::study::{self, Judge, Study};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The Nile's problem file, with replacements in its text, and its log.
fn nile(replacements: &[(&str, &str)]) -> (Problem, Log) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut text = std::fs::read_to_string(folder.join("nile.toml")).expect("the example is there");
    for (old, new) in replacements {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    let problem = Problem::parse(&text, "nile.toml").expect("the problem is valid");
    let log = Log::open(&problem.data, &folder).expect("its log is valid");
    (problem, log)
}

/// Gradient and Hessian of nll in (ln sigma2_eps, ln sigma2_eta): the covariance of all flows is
/// V = P0 + sigma2_eps I + sigma2_eta min(i, j), so dV/d sigma2 are constant matrices D, and
/// d nll = tr(V^-1 D) / 2 - y' V^-1 D V^-1 y / 2.
fn dense(log: &Log, [eps, eta]: [f64; 2]) -> (Vector2<f64>, Matrix2<f64>) {
    let y: Vec<f64> = log.trajectories[0].z.column(0).collect();
    let t = y.len();
    let walk = DMatrix::from_fn(t, t, |i, j| f64::from(u8::try_from(i.min(j)).expect("100 rows")));
    let d = [DMatrix::identity(t, t) * eps, walk * eta];
    let v = DMatrix::from_element(t, t, 1e7) + &d[0] + &d[1];
    let inverse = v.try_inverse().expect("a covariance");
    let w = &inverse * DVector::from_vec(y);
    let parts = [0, 1].map(|a| (&inverse * &d[a], &d[a] * &w));
    // D times sigma2 above makes these derivatives by logarithms; their own second derivative adds the gradient.
    let gradient = Vector2::from_fn(|a, _| 0.5 * parts[a].0.trace() - 0.5 * w.dot(&parts[a].1));
    let hessian = Matrix2::from_fn(|a, b| {
        let curved = -0.5 * (&parts[a].0 * &parts[b].0).trace() + parts[a].1.dot(&(&inverse * &parts[b].1));
        curved + if a == b { gradient[a] } else { 0.0 }
    });
    (gradient, hessian)
}

/// The optimum by Newton's method on dense algebra.
fn optimum(log: &Log) -> [f64; 2] {
    let mut at = [15_099.7, 1_468.5];
    for _ in 0..4 {
        let (gradient, hessian) = dense(log, at);
        let step = hessian.try_inverse().expect("a minimum") * gradient;
        at = [at[0] * (-step[0]).exp(), at[1] * (-step[1]).exp()];
    }
    at
}

fn error(uncertainty: &Uncertainty, name: &str) -> f64 {
    *uncertainty.standard_errors.as_ref().expect("computed").get(name).expect("searched")
}

#[test]
fn the_nile_has_the_errors_of_dense_algebra() {
    let (problem, log) = nile(&[]);
    let at = optimum(&log);
    let found = Uncertainty::of(&problem, &log, &at);
    let covariance = dense(&log, at).1.try_inverse().expect("a minimum");
    for (i, name) in ["sigma2_eps", "sigma2_eta"].into_iter().enumerate() {
        let expected = at[i] * covariance[(i, i)].sqrt();
        let relative = (error(&found, name) / expected - 1.0).abs();
        println!("{name} = {:.3}: standard error {expected:.3}, off by {relative:.1e} (relative)", at[i]);
        assert!(relative < 2e-5, "{name}: {} instead of {expected}", error(&found, name));
        let [low, high] = *found.intervals_95.as_ref().and_then(|all| all.get(name)).expect("computed");
        assert!((low * high / at[i].powi(2) - 1.0).abs() < 1e-12, "symmetric in the logarithm: {low} {high}");
        assert!(((high / low).ln() / (2.0 * 1.96 * expected / at[i]) - 1.0).abs() < 2e-5, "{low} {high}");
    }
    assert_eq!(found.flat_directions.as_deref(), Some(&[][..]), "both are determined");
    assert!(found.distance_to_optimum.is_some_and(|d| d < 1e-4), "{found:?}");
    // The same in linear coordinates, where the Hessian is another one but the optimum's errors are the same.
    let linear = [("scale = \"log\", ", "")];
    let (problem, log) = nile(&linear);
    let found = Uncertainty::of(&problem, &log, &at);
    let (gradient, hessian) = dense(&log, at);
    let curved = Matrix2::from_fn(|a, b| (hessian[(a, b)] - if a == b { gradient[a] } else { 0.0 }) / (at[a] * at[b]));
    let expected = curved.try_inverse().expect("a minimum")[(1, 1)].sqrt();
    // nll is less of a parabola there: 2.3e-5 was measured.
    assert!((error(&found, "sigma2_eta") / expected - 1.0).abs() < 5e-5, "{found:?}");
}

#[test]
fn parameters_that_trade_off_are_named() {
    let (two, log) = nile(&[]);
    let at = optimum(&log);
    let (problem, _) = nile(&[
        ("Q = [\"sigma2_eta\"]", "Q = [\"sigma2_eta*gain\"]"),
        ("[tune]", "gain = { min = 1e-3, max = 1e3, scale = \"log\", start = 1 }\n[tune]"),
    ]);
    let found = Uncertainty::of(&problem, &log, &[at[0], at[1] / 2.0, 2.0]);
    let flat = found.flat_directions.as_ref().expect("computed");
    assert_eq!(flat.len(), 1, "{found:?}");
    assert_eq!(
        flat[0].statement, "sigma2_eta and gain trade off: log sigma2_eta - log gain is not determined by this log",
        "the product alone stands in the model"
    );
    assert!(error(&found, "gain").is_nan() && error(&found, "sigma2_eta").is_nan(), "{found:?}");
    let expected = error(&Uncertainty::of(&two, &log, &at), "sigma2_eps");
    assert!((error(&found, "sigma2_eps") / expected - 1.0).abs() < 1e-4, "{found:?}");
    let text = found.to_string();
    assert!(
        text.contains("standard errors (of the rows tuned on): sigma2_eps ") && text.contains("trade off"),
        "{text}"
    );
    let json = serde_json::to_value(&found).expect("plain data");
    assert!(json["standard_errors"]["gain"].is_null() && json["standard_errors"]["sigma2_eps"].is_number(), "{json}");
}

#[test]
fn a_parameter_at_its_bound_is_held_there() {
    let (problem, log) = nile(&[(
        "min = 100, max = 1e6, scale = \"log\", start = 10000",
        "min = 17000, max = 1e6, scale = \"log\", start = 20000",
    )]);
    // With sigma2_eps at its bound, Newton in the other alone.
    let mut eta = 500.0;
    for _ in 0..40 {
        let (gradient, hessian) = dense(&log, [17_000.0, eta]);
        eta *= (-gradient[1] / hessian[(1, 1)].abs()).clamp(-1.0, 1.0).exp();
    }
    let found = Uncertainty::of(&problem, &log, &[17_000.0, eta]);
    let expected = eta / dense(&log, [17_000.0, eta]).1[(1, 1)].sqrt();
    assert!((error(&found, "sigma2_eta") / expected - 1.0).abs() < 2e-5, "{found:?} instead of {expected}");
    assert!(error(&found, "sigma2_eps").is_nan(), "{found:?}");
    assert_eq!(found.standard_errors_note.as_deref(), Some("sigma2_eps held at the bound"));
    let both = Uncertainty::of(&problem, &log, &[17_000.0, 1.0]);
    assert_eq!(both.standard_errors_note.as_deref(), Some("every parameter is at a bound"));
}

#[test]
fn away_from_the_optimum_of_nll_there_are_none() {
    let (problem, log) = nile(&[]);
    let [eps, eta] = optimum(&log);
    for (candidate, reason) in [([eps * 1.5, eta], "standard errors away"), ([eps, eta * 200.0], "tune for nll")] {
        let found = Uncertainty::of(&problem, &log, &candidate);
        assert_eq!(found.standard_errors, None, "{candidate:?}");
        assert!(found.standard_errors_note.as_ref().is_some_and(|note| note.contains(reason)), "{found:?}");
        assert!(serde_json::to_value(&found).expect("plain data")["standard_errors"].is_null(), "{found:?}");
    }
    // A distance that Newton's step predicts: 0.2 standard errors along one axis, from a Hessian that hardly changes.
    let hessian = dense(&log, [eps, eta]).1;
    let near = Uncertainty::of(&problem, &log, &[eps * (0.2 / hessian[(0, 0)].sqrt()).exp(), eta]);
    assert!(near.distance_to_optimum.is_some_and(|d| (d - 0.2).abs() < 0.02), "{near:?}");
}

/// On 120,000 rows of a local level the standard errors are those of the expected information: the differences are an
/// MA(1) with spectral density f(w) = q + 2 r (1 - cos w), and information by Whittle's integral, N / 4 pi times that of
/// d ln f d ln f (P. Whittle, Ark. Mat. 2 (1953), doi 10.1007/BF02590998). Both agree to 1 / sqrt(N).
#[test]
fn a_long_log_has_standard_errors() {
    const ROWS: f64 = 120_000.0;
    let text = "[data]\nmeasurements = [\"y\"]\n[model]\nkind = \"local-level\"\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\nP0 = [1e4]\n\
        [parameters]\nq = { min = 1e-3, max = 1e2, scale = \"log\", start = 1 }\n\
        r = { min = 1e-3, max = 1e2, scale = \"log\", start = 1 }\n[tune]\npopulation = 16\ngenerations = 2\n\
        [simulate]\nsteps = 120000\nparameters = { q = 0.3, r = 4 }\nseed = 5\n";
    let problem = Problem::parse(text, "long.toml").expect("a problem");
    let log = simulate(&problem, None).expect("a log");
    let mut lanes = CpuEvaluator::new(&problem, &log, CpuOptions::default()).expect("traced");
    let oracle = |candidate: &[f64]| reference::costs(&problem, &log, candidate).ok();
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let outcome = study::run(&Study::of(&problem), &mut lanes, judge, &mut [], &AtomicBool::new(false));
    let winner = outcome.expect("an outcome").winner.expect("a winner");
    let found = Uncertainty::of(&problem, &log, &winner.candidate);
    let (q, r) = (winner.candidate[0], winner.candidate[1]);
    let slopes = |w: f64| {
        let f = q + 2.0 * r * (1.0 - w.cos());
        Vector2::new(q / f, 1.0 - q / f)
    };
    let points = 20_000;
    let information = (0..points).map(|i| std::f64::consts::PI * (f64::from(i) + 0.5) / f64::from(points)).map(slopes);
    let information: Matrix2<f64> =
        information.map(|s| s * s.transpose()).sum::<Matrix2<f64>>() * (0.5 * ROWS / f64::from(points));
    let covariance = information.try_inverse().expect("information");
    for (i, name) in ["q", "r"].into_iter().enumerate() {
        let expected = winner.candidate[i] * covariance[(i, i)].sqrt();
        let relative = (error(&found, name) / expected - 1.0).abs();
        println!(
            "{name} = {:.5}: standard error {expected:.3e}, off by {relative:.1e} (relative)",
            winner.candidate[i]
        );
        assert!(relative < 0.02, "{name}: {} instead of {expected}", error(&found, name));
    }
    assert_eq!(found.flat_directions.as_deref(), Some(&[][..]), "both are determined");
    assert!(found.distance_to_optimum.is_some_and(|distance| distance < 0.015), "{found:?}");
}
