//! Checks that need the log.

use crate::data::{Log, Table, Trajectory};
use crate::model::Problem;

const MODEL: &str = r#"[data]
file = "log.csv"
measurements = ["z1", "z2"]
truth = { p = "p" }
[model]
state = ["p", "v"]
f = ["p + v*dt", "v"]
h = ["p", "v"]
Q = [0, "q"]
R = [1, 1]
x0 = [0, 0]
P0 = [1, 1]
[parameters]
q = { min = 1, max = 2 }
"#;

fn problem(old: &str, new: &str) -> Problem {
    assert!(MODEL.contains(old), "{old}");
    Problem::parse(&MODEL.replace(old, new), "p.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Two measurements and truth of p, without inputs.
fn trajectory(id: &str, time: &[f64], z: &[[f64; 2]]) -> Trajectory {
    let (mut measurements, mut inputs, mut truth) = (Table::new(2), Table::new(0), Table::new(1));
    for row in z {
        measurements.push(row);
        inputs.push(&[]);
        truth.push(&[0.0]);
    }
    let line = (2..).take(time.len()).collect();
    Trajectory { id: id.to_owned(), time: time.to_vec(), z: measurements, u: inputs, truth, line }
}

fn log(trajectories: Vec<Trajectory>) -> Log {
    Log {
        source: "log.csv".to_owned(),
        measurements: vec!["z1".to_owned(), "z2".to_owned()],
        inputs: Vec::new(),
        truth: vec!["p".to_owned()],
        trajectories,
        ..Log::default()
    }
}

fn regular() -> Log {
    log(vec![trajectory("", &[0.0, 1.0, 2.0], &[[1.0, 1.0]; 3])])
}

fn irregular() -> Log {
    log(vec![trajectory("", &[0.0, 1.0, 3.0], &[[1.0, 1.0]; 3])])
}

fn refused(problem: &Problem, log: &Log) -> String {
    problem.check_log(log).expect_err("refused").to_string().lines().next().unwrap().to_owned()
}

#[test]
fn a_sound_log_has_no_warnings() {
    assert_eq!(problem("", "").check_log(&regular()).unwrap(), Vec::<String>::new());
}

#[test]
fn the_step_before_an_irregular_log_must_be_given() {
    let predict = problem("P0 =", "first = \"predict\"\nP0 =");
    assert!(predict.check_log(&regular()).is_ok(), "regular intervals say it");
    let message = refused(&predict, &irregular());
    assert!(
        message.starts_with("p.toml:12:9: first = \"predict\" needs `first_dt`")
            && message.ends_with("log.csv has irregular intervals"),
        "{message}"
    );
    let one_row = log(vec![trajectory("", &[0.0], &[[1.0, 1.0]])]);
    assert!(refused(&predict, &one_row).ends_with("log.csv has no interval"), "a single row says nothing");
    let given = problem("P0 =", "first = \"predict\"\nfirst_dt = 1\nP0 =");
    assert!(given.check_log(&irregular()).is_ok(), "given");
}

#[test]
fn a_process_noise_without_dt_is_doubtful_on_an_irregular_log() {
    let warnings = problem("", "").check_log(&irregular()).unwrap();
    assert_eq!(
        warnings,
        ["the intervals of log.csv differ, and Q has no dt in it: every step gets the same process noise"]
    );
    assert!(problem("\"q\"", "\"q*dt\"").check_log(&irregular()).unwrap().is_empty(), "it has dt");
}

#[test]
fn an_adapted_process_noise_is_doubtful_on_an_irregular_log_with_dt_or_without() {
    for q in ["q", "q*dt"] {
        let adaptive = problem("[parameters]", "[filter]\nkind = \"sage-husa\"\n[parameters]");
        let text = adaptive.text.replace("\"q\"]", &format!("\"{q}\"]"));
        let warnings = Problem::parse(&text, "p.toml").unwrap().check_log(&irregular()).unwrap();
        let expected = "the intervals of log.csv differ, and the sage-husa filter adapts one Q that serves every step, long or short";
        assert_eq!(warnings, [expected], "{q}");
    }
    let searched = "[filter]\nkind = \"sage-husa\"\nforgetting = \"b\"\n[parameters]\nb = { min = 0.9, max = 1 }";
    assert!(problem("[parameters]", searched).check_log(&regular()).unwrap().is_empty(), "b is used by the filter");
}

#[test]
fn a_process_noise_must_be_one_at_every_interval() {
    let shrinking = problem("\"q\"", "\"q*(1.5 - dt)\"");
    assert!(shrinking.check_log(&regular()).is_ok(), "positive at dt = 1");
    let message = refused(&shrinking, &irregular());
    let expected = "p.toml:9:5: `model.Q` is not positive semidefinite at the start values: the variance of `v` is ";
    assert!(message.starts_with(expected), "{message}");
}

#[test]
fn a_start_from_measurements_needs_a_complete_one() {
    let start = problem("x0 = [0, 0]", "x0 = \"measurement\"");
    assert!(start.check_log(&regular()).is_ok(), "complete");
    let gaps = [[1.0, f64::NAN], [f64::NAN, 1.0]];
    let mut second = trajectory("b", &[0.0, 1.0], &gaps);
    second.line = vec![7, 8];
    let message = refused(&start, &log(vec![trajectory("a", &[0.0], &[[1.0, 1.0]]), second]));
    assert!(message.starts_with("p.toml:11:6: x0 = \"measurement\" needs a row with all measurements"), "{message}");
    assert!(message.contains("trajectory `b` (log.csv:7) has none"), "{message}");
}

#[test]
fn truth_must_be_in_the_log() {
    let tune = problem("[parameters]", "[tune]\nobjectives = [\"rmse\"]\n[parameters]");
    assert!(tune.check_log(&regular()).is_ok(), "there is truth");
    let mut unknown = regular();
    unknown.trajectories[0].truth = Table::new(1);
    (0..3).for_each(|_| unknown.trajectories[0].truth.push(&[f64::NAN]));
    let message = refused(&tune, &unknown);
    assert!(
        message.starts_with("p.toml:14:14: the objective `rmse` needs truth of `p`, and no scored row of log.csv"),
        "{message}"
    );
    let bounded = problem("[parameters]", "[tune]\nconstraints = [\"rmse <= 5\"]\n[parameters]");
    let message = refused(&bounded, &unknown);
    assert!(message.starts_with("p.toml:14:15: the constraint on `rmse` needs truth of `p`, and no"), "{message}");
    let skipping = problem("[parameters]", "[tune]\nobjectives = [{ name = \"rmse\", skip = 3 }]\n[parameters]");
    assert!(skipping.check_log(&regular()).is_err(), "all rows are skipped");
}

#[test]
fn an_h_with_inputs_needs_them_in_the_last_row() {
    let text =
        MODEL.replace("truth =", "inputs = [\"u\"]\ntruth =").replace("[\"p\", \"v\"]\nQ", "[\"p + u\", \"v\"]\nQ");
    let problem = Problem::parse(&text, "p.toml").unwrap();
    let with = |inputs: [f64; 3]| {
        let mut log = regular();
        log.trajectories[0].u = Table::new(1);
        inputs.iter().for_each(|u| log.trajectories[0].u.push(&[*u]));
        log
    };
    assert!(problem.check_log(&with([1.0, 1.0, 1.0])).is_ok(), "all there");
    let message = refused(&problem, &with([1.0, 1.0, f64::NAN]));
    assert!(
        message.starts_with("p.toml:9:5: h uses the input `u`, which is empty in the last row of log.csv:4"),
        "{message}"
    );
}

#[test]
fn warnings_about_windows_and_unused_parameters() {
    let mismatch = problem(
        "[parameters]",
        "[tune]\nobjectives = [\"mismatch\"]\n[parameters]\nidle = { min = 1, max = 2 }\ntied = { tie = \"idle\" }",
    );
    assert_eq!(
        mismatch.check_log(&regular()).unwrap(),
        [
            "the searched parameter `idle` is used in no formula",
            "the window of `mismatch` is 100 rows, and log.csv:2 has 3 measured ones: all of them are used"
        ]
    );
}

/// Of a model that linearises.
fn curved(old: &str, new: &str) -> Problem {
    let text = MODEL.replace("[parameters]", "[filter]\nkind = \"extended\"\n[parameters]").replace(old, new);
    Problem::parse(&text, "p.toml").unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn f_and_h_need_a_value_and_a_derivative_at_the_start() {
    let found = refused(&curved("\"v\"]\nh", "\"sin(p*dt)/p\"]\nh"), &regular());
    let expected = "p.toml:7:19: `model.f[2]` has no finite value at the start (p = 0): start elsewhere, or write it so that \
                    it has one there (sinc(a) is sin(a)/a, also at a = 0)";
    assert_eq!(found, expected);
    let found = refused(&curved("h = [\"p\"", "h = [\"sqrt(p^2 + v^2)\""), &regular());
    assert!(found.contains("`model.h[1]` has no finite derivative at the start (p = 0, v = 0)"), "{found}");
    let sound = curved("\"v\"]\nh", "\"sinc(p*dt)*dt\"]\nh");
    assert!(sound.check_log(&regular()).is_ok(), "the same, written so that it is a number");
}

#[test]
fn an_angle_that_goes_round_is_named() {
    let round = log(vec![trajectory("", &[0.0, 1.0, 2.0], &[[3.1, 0.0], [f64::NAN, 0.0], [-3.1, 0.0]])]);
    let formula = "h = [\"atan2(p + 1, v)\"";
    let found = refused(&curved("h = [\"p\"", formula), &round);
    assert!(found.contains("`z1` jumps by -6.2 at log.csv:4, more than half a turn"), "{found}");
    assert!(found.contains("add angle = [\"z1\"] to [model]"), "{found}");
    let named = curved("h = [\"p\"", &format!("angle = [\"z1\"]\n{formula}"));
    assert_eq!(named.check_log(&round).unwrap(), [""; 0]);
    // A distance may jump as it likes.
    assert!(curved("h = [\"p\"", "h = [\"p^2\"").check_log(&round).is_ok());
    let degrees = log(vec![trajectory("", &[0.0, 1.0], &[[178.0, 0.0], [-178.0, 0.0]])]);
    let warnings = named.check_log(&degrees).unwrap();
    assert!(warnings[0].contains("angles are in radians"), "{warnings:?}");
}

#[test]
fn between_rows_of_one_time_a_step_must_change_nothing() {
    let together = log(vec![trajectory("", &[0.0, 1.0, 1.0, 2.0], &[[1.0, 1.0]; 4])]);
    let whole = "as between lines 3 and 4 of log.csv, which have one time";
    let sound = problem("\"q\"]", "\"q*dt\"]");
    assert_eq!(sound.check_log(&together).unwrap(), Vec::<String>::new());
    assert_eq!(
        refused(&problem("", ""), &together),
        format!("p.toml:9:5: Q is not 0 at dt = 0, {whole}: write dt into it, or merge the rows of one time")
    );
    let moving = problem("\"p + v*dt\", \"v\"", "\"p + v*dt\", \"0.9*v\"");
    assert_eq!(
        refused(&moving, &together),
        format!("p.toml:7:5: f of `v` is not `v` at dt = 0, {whole}: write dt into it, or merge the rows of one time")
    );
    assert!(refused(&problem("\"p + v*dt\"", "\"p + v/dt\""), &together).contains("f of `p` is not `p` at dt = 0"));
    for f in ["p + v*(1 - exp(-dt))", "3 + (p - 3)*exp(-dt)", "p + v*dt*sinc(0.3*dt)"] {
        let smooth = problem("\"q\"]", "\"q*dt\"]").text.replace("p + v*dt", f);
        assert!(Problem::parse(&smooth, "p.toml").unwrap().check_log(&together).is_ok(), "{f} leaves p where it is");
    }
    let turning = "state = [\"p\", \"v\"]\nangle = [\"p\"]\nf = [\"wrap(p + v*dt)\", \"v\"]";
    let turning = sound.text.replace("state = [\"p\", \"v\"]\nf = [\"p + v*dt\", \"v\"]", turning)
        + "[filter]\nkind = \"extended\"\n";
    assert!(Problem::parse(&turning, "p.toml").unwrap().check_log(&together).is_ok(), "angles are equal modulo 2 pi");
    let adaptive = Problem::parse(&(sound.text.clone() + "[filter]\nkind = \"sage-husa\"\n"), "p.toml").unwrap();
    let sentence = refused(&adaptive, &together);
    assert!(
        sentence.starts_with("p.toml:16:8: the sage-husa filter adapts one Q that serves every step"),
        "{sentence}"
    );
    let motion = sound.text.replace(
        "state = [\"p\", \"v\"]\nf = [\"p + v*dt\", \"v\"]\nh = [\"p\", \"v\"]\nQ = [0, \"q*dt\"]",
        "kind = \"local-level\"\naxes = [\"p\", \"v\"]\nq = \"q\"\nnoise = \"piecewise\"",
    );
    let motion = Problem::parse(&motion, "p.toml").unwrap();
    assert_eq!(
        refused(&motion, &together),
        format!("p.toml:9:9: Q is not 0 at dt = 0, {whole}: use noise = \"continuous\", or merge the rows of one time")
    );
}
