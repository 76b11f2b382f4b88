//! Every mistake in a problem file gets one sentence, its exact position and a caret run.

use proptest::prelude::*;

use crate::model::{Problem, ProblemError};

/// A sound problem of two states, one measurement and one input; every case below changes one piece of it.
const SOUND: &str = r#"[data]
file = "log.csv"
time = "t"
measurements = ["z"]
inputs = ["u"]
truth = { p = "p_true" }

[model]
state = ["p", "v"]
f = ["p + v*dt + 0.5*u*dt^2", "v + u*dt"]
h = ["p"]
Q = [["q*dt^3/3", "q*dt^2/2"], [0, "q*dt"]]
R = { z = "r" }
x0 = [0, 0]
P0 = [100, 10]
first = "update"

[parameters]
q = { min = 0.01, max = 10, scale = "log", start = 1 }
r = { min = 0.1, max = 100, start = 5 }

[filter]
kind = "kalman"

[tune]
algorithm = "pso"
objectives = ["nll"]
population = 20
"#;

fn error(text: &str) -> ProblemError {
    match Problem::parse(text, "p.toml") {
        Err(error) => error,
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// `old` of the sound problem replaced by `new`: the first line of the error, and the text under the carets.
fn broken(old: &str, new: &str) -> (String, String) {
    assert_eq!(SOUND.matches(old).count(), 1, "`{old}` stands once in the sound problem");
    let error = error(&SOUND.replace(old, new));
    let place = error.place.clone().expect("a place");
    let under = place.excerpt.chars().skip(place.indent).take(place.width).collect();
    (error.to_string().lines().next().unwrap().to_owned(), under)
}

/// Each case: what is replaced, by what, the text under the carets, and the whole sentence.
fn check(cases: &[(&str, &str, &str, &str)]) {
    let wrong = cases.iter().filter_map(|(old, new, under, message)| {
        let (sentence, found) = broken(old, new);
        let expected = format!("p.toml:{message}");
        (sentence != expected || found != *under)
            .then(|| format!("{new}\n  {sentence} | {found}\n  {expected} | {under}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "change, error, expected:\n{}", wrong.join("\n"));
}

#[test]
fn the_sound_problem_is_accepted() {
    Problem::parse(SOUND, "p.toml").unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn the_whole_message() {
    let text = SOUND.replace("[\"p\"]", "[\"p + w\"]");
    let expected = "\
p.toml:11:11: unknown name `w` (known: `p`, `v`, `q`, `r`, `u`, `pi`)
   |
11 | h = [\"p + w\"]
   |           ^";
    assert_eq!(error(&text).to_string(), expected);
}

#[test]
fn keys() {
    check(&[
        (
            "time =",
            "tiem =",
            "tiem",
            "3:1: unknown key `tiem` in [data]: did you mean `time`? (known: `file`, `time`, `measurements`, `inputs`, `truth`, `trajectory`)",
        ),
        (
            "[filter]",
            "[filters]",
            "filters",
            "22:2: unknown key `filters` in the problem file: did you mean `filter`? (known: `data`, `model`, `parameters`, `filter`, `tune`, `simulate`)",
        ),
        (
            "start = 5",
            "strat = 5",
            "strat",
            "20:29: unknown key `strat` in [parameters.r]: did you mean `start`? (known: `min`, `max`, `scale`, `start`, `init`, `unit`, `tie`, `value`)",
        ),
        (
            "file = \"log.csv\"",
            "",
            "[data]",
            "1:1: [data] lacks `file`: give the log's file name, relative to the problem file, or a [simulate] table",
        ),
        ("P0 = [100, 10]", "", "[model]", "8:1: [model] lacks `P0`: give the initial covariance"),
        ("time = \"t\"", "time = 3", "3", "3:8: `data.time`: expected a string, found the number 3"),
        (
            "population = 20",
            "population = \"many\"",
            "\"many\"",
            "28:14: `tune.population`: expected a whole number, found the string \"many\"",
        ),
        (
            "population = 20",
            "population = 0",
            "0",
            "28:14: `tune.population` is 0: expected a whole number from 1 to 16777216",
        ),
        (
            "population = 20",
            "population = 20\nseed = -1",
            "-1",
            "29:8: `tune.seed` is -1: expected a whole number from 0",
        ),
    ]);
    let (sentence, _) = broken("time = \"t\"", "time = \"t\"\ntime = \"t\"");
    assert!(sentence.starts_with("p.toml:4:1: not valid TOML: duplicate key"), "{sentence}");
    let (sentence, _) = broken("time = \"t\"", "time = \"t");
    assert!(sentence.starts_with("p.toml:3:"), "{sentence}");
}

#[test]
fn data() {
    check(&[
        ("[\"z\"]", "[\"z\", \"z\"]", "\"z\"", "4:22: `data.measurements[2]`: `z` is listed twice"),
        ("[\"z\"]", "[]", "[]", "4:16: `data.measurements` has 0 entries: expected a list of column names"),
        (
            "[\"u\"]",
            "[\"u 1\"]",
            "\"u 1\"",
            "5:11: `u 1` cannot be a name in formulas: use letters, digits and underscores, not starting with a digit",
        ),
        (
            "{ p = \"p_true\" }",
            "{ w = \"p_true\" }",
            "w",
            "6:11: `data.truth` names the state `w`, which does not exist (known: `p`, `v`)",
        ),
    ]);
    let many = (0..33).map(|i| format!("\"z{i}\"")).collect::<Vec<_>>().join(", ");
    let (sentence, _) = broken("[\"z\"]", &format!("[{many}]"));
    assert_eq!(sentence, "p.toml:4:16: 33 measurements: at most 32 are allowed");
    let many = (0..100_000).map(|i| format!("\"s{i}\"")).collect::<Vec<_>>().join(", ");
    let (sentence, _) = broken("[\"p\", \"v\"]", &format!("[{many}]"));
    assert_eq!(sentence, "p.toml:9:9: 100000 states: at most 64 are allowed");
}

#[test]
fn names() {
    check(&[
        (
            "[\"p\", \"v\"]",
            "[\"p\", \"dt\"]",
            "\"dt\"",
            "9:15: the name `dt` is already the interval to the next row: choose another",
        ),
        ("[\"p\", \"v\"]", "[\"p\", \"sin\"]", "\"sin\"", "9:15: the name `sin` is already a function: choose another"),
        (
            "[\"p\", \"v\"]",
            "[\"p\", \"2v\"]",
            "\"2v\"",
            "9:15: `2v` cannot be a name in formulas: use letters, digits and underscores, not starting with a digit",
        ),
        ("[\"p\", \"v\"]", "[\"p\", \"p\"]", "\"p\"", "9:15: `model.state[2]`: `p` is listed twice"),
        ("[\"u\"]", "[\"p\"]", "\"p\"", "5:11: the name `p` is already a state: choose another"),
        ("r = { min", "v = { min", "v", "20:1: the name `v` is already a state: choose another"),
        ("r = { min", "u = { min", "u", "20:1: the name `u` is already an input: choose another"),
    ]);
}

#[test]
fn formulas() {
    check(&[
        (
            "\"v + u*dt\"",
            "\"v + u*dtt\"",
            "dtt",
            "10:38: unknown name `dtt`: did you mean `dt`? (known: `p`, `v`, `q`, `r`, `u`, `dt`, `pi`)",
        ),
        ("\"v + u*dt\"", "\"v + (u*dt\"", "\"", "10:41: a formula stops short: expected `)` or an operator"),
        ("\"v + u*dt\"", "'v + u**dt'", "*", "10:38: a formula has `*` where a number, a name or `(` was expected"),
        (
            "\"v + u*dt\"",
            "\"\"\"\nv + w\"\"\"",
            "w",
            "11:5: unknown name `w` (known: `p`, `v`, `q`, `r`, `u`, `dt`, `pi`)",
        ),
        (
            "\"v + u*dt\"",
            "\"v +\\tw\"",
            "\"v +\\tw\"",
            "10:31: unknown name `w` (known: `p`, `v`, `q`, `r`, `u`, `dt`, `pi`)",
        ),
        (
            "\"v + u*dt\"",
            "\"v + u*dt*cos(p)\"",
            "cos(p)",
            "10:41: `cos(p)` is not linear in the states, and the kalman filter needs model.f[2] to be linear (sums of states times parameters, inputs and dt; other filters come later)",
        ),
        (
            "\"v + u*dt\"",
            "\"v + (p*v)\"",
            "(p*v)",
            "10:36: `(p*v)` is not linear in the states, and the kalman filter needs model.f[2] to be linear (sums of states times parameters, inputs and dt; other filters come later)",
        ),
        (
            "h = [\"p\"]",
            "h = [\"p*dt\"]",
            "dt",
            "11:9: the interval `dt` cannot stand in model.h[1], which may use states, inputs and parameters",
        ),
        (
            "\"q*dt\"",
            "\"q*v\"",
            "v",
            "12:39: the state `v` cannot stand in model.Q[2][2], which may use parameters and dt",
        ),
        (
            "x0 = [0, 0]",
            "x0 = [0, \"u\"]",
            "u",
            "14:11: the input `u` cannot stand in model.x0[2], which may use parameters",
        ),
        (
            "x0 = [0, 0]",
            "x0 = [0, true]",
            "true",
            "14:10: `model.x0[2]`: expected a number or a formula in quotes, found true",
        ),
        ("x0 = [0, 0]", "x0 = [0]", "[0]", "14:6: `model.x0` has 1 entry: expected 2, one per state (p, v)"),
        ("x0 = [0, 0]", "x0 = [0, inf]", "inf", "14:10: `model.x0[2]` is inf: expected a finite number"),
        (
            "h = [\"p\"]",
            "h = [\"p\", \"v\"]",
            "[\"p\", \"v\"]",
            "11:5: `model.h` has 2 entries: expected 1, one per measurement (z)",
        ),
    ]);
}

#[test]
fn absurd_formulas() {
    for (formula, message) in [
        (
            format!("{}v{}", "(".repeat(100_000), ")".repeat(100_000)),
            "a formula of 200001 characters: at most 10000 are allowed",
        ),
        (
            format!("{}v", "(".repeat(9_000)),
            "a formula nested more than 100 deep (parentheses, calls, signs and powers count)",
        ),
        (
            format!("v{}", "+v".repeat(4_000)),
            "a formula that chains more than 500 operations: split it with parentheses",
        ),
        ("v".repeat(1_000_000), "a formula of 1000000 characters: at most 10000 are allowed"),
    ] {
        let (sentence, _) = broken("\"v + u*dt\"", &format!("\"{formula}\""));
        assert!(sentence.ends_with(message), "{sentence}");
        assert!(sentence.starts_with("p.toml:10:"), "{sentence}");
    }
    let error = error(&SOUND.replace("v + u*dt", &"v".repeat(5_000_000)));
    assert!(error.to_string().contains("bytes, and at most 4194304 are read"), "{error}");
}

#[test]
fn covariances() {
    let positive = "make the off-diagonal entries smaller";
    check(&[
        (
            "[0, \"q*dt\"]]",
            "[\"q*dt\", \"q*dt\"]]",
            "q*dt",
            "12:34: `model.Q` is not symmetric: entry [2, 1] differs from [1, 2] (write both alike, or one of them 0)",
        ),
        ("[0, \"q*dt\"]]", "[0]]", "[0]", "12:32: `model.Q[2]` has 1 entry: expected 2, one per column"),
        (
            "{ z = \"r\" }",
            "{ y = \"r\" }",
            "y",
            "13:7: `model.R` names measurement `y`, which does not exist (known: `z`)",
        ),
        (
            "{ z = \"r\" }",
            "{ }",
            "{ }",
            "13:5: `model.R` gives no variance for `z`: name each of them, because this matrix must be positive definite",
        ),
        (
            "{ z = \"r\" }",
            "[\"r\", \"r\"]",
            "[\"r\", \"r\"]",
            "13:5: `model.R` has 2 entries: expected 1, one per measurement (z)",
        ),
        (
            "P0 = [100, 10]",
            "P0 = 100",
            "100",
            "15:6: `model.P0`: expected a list of 2 variances, a list of 2 lists, a table by state, or a factor, found the number 100",
        ),
        (
            "P0 = [100, 10]",
            "P0 = [100, 0]",
            "[100, 0]",
            "15:6: `model.P0` is not positive definite at the start values: the variance of `v` is 0, expected above 0",
        ),
        (
            "P0 = [100, 10]",
            "P0 = [[1, 2], [2, 1]]",
            "[[1, 2], [2, 1]]",
            &format!(
                "15:6: `model.P0` is not positive definite at the start values: its smallest eigenvalue is -1.000e0 ({positive})"
            ),
        ),
        (
            "{ z = \"r\" }",
            "[\"r - 6\"]",
            "[\"r - 6\"]",
            "13:5: `model.R` is not positive definite at the start values: the variance of `z` is -1, expected above 0",
        ),
        (
            "{ z = \"r\" }",
            "[\"ln(r - 6)\"]",
            "[\"ln(r - 6)\"]",
            "13:5: `model.R` is not positive definite at the start values: entry [1, 1] is NaN, not a finite number",
        ),
        (
            "[[\"q*dt^3/3\", \"q*dt^2/2\"], [0, \"q*dt\"]]",
            "[[1, 2], [2, 1]]",
            "[[1, 2], [2, 1]]",
            &format!(
                "12:5: `model.Q` is not positive semidefinite at the start values: its smallest eigenvalue is -1.000e0 ({positive})"
            ),
        ),
        (
            "{ z = \"r\" }",
            "{ factor = \"M\", form = \"round\" }",
            "\"round\"",
            "13:28: `model.R.form` is \"round\": expected \"square\" or \"lower\"",
        ),
        (
            "{ z = \"r\" }",
            "{ factor = \"M\", form = \"lower\" }",
            "\"M\"",
            "13:16: `M`: the factor `M` has no template: give `M` in [parameters], such as M = { init = [0, 1], start = 1 }",
        ),
    ]);
}

#[test]
fn first_and_start() {
    check(&[
        (
            "first = \"update\"",
            "first = \"predict\"",
            "\"predict\"",
            "16:9: `model.first`: \"predict\" needs the inputs of a step before the first row, which no log has: use \"update\"",
        ),
        (
            "first = \"update\"",
            "first = \"later\"",
            "\"later\"",
            "16:9: `model.first` is \"later\": expected \"update\" or \"predict\"",
        ),
        (
            "first = \"update\"",
            "first_dt = 1",
            "1",
            "16:12: `model.first_dt`: it belongs to first = \"predict\", the step before the first row: remove it",
        ),
        (
            "h = [\"p\"]\nQ = [[\"q*dt^3/3\", \"q*dt^2/2\"], [0, \"q*dt\"]]\nR = { z = \"r\" }\nx0 = [0, 0]",
            "h = [\"r*p\"]\nQ = [0, 0]\nR = { z = \"r\" }\nx0 = \"measurement\"",
            "\"measurement\"",
            "14:6: `model.x0`: \"measurement\" needs an h without searched parameters: give numbers",
        ),
    ]);
    let text = SOUND.replace("inputs = [\"u\"]\n", "").replace("+ 0.5*u*dt^2", "").replace("+ u*dt", "");
    let text = text.replace("x0 = [0, 0]", "x0 = \"measurement\"").replace("\"update\"", "\"predict\"");
    let first = error(&text).to_string();
    assert!(first.contains("15:9: `model.first`: \"predict\" cannot go with x0 = \"measurement\""), "{first}");
}

#[test]
fn parameters() {
    let r = "r = { min = 0.1, max = 100, start = 5 }";
    check(&[
        (
            r,
            "r = { min = 3, max = 0.3 }",
            "0.3",
            "20:22: `parameters.r.max` is 0.3: expected a number above `min`, which is 3",
        ),
        (
            r,
            "r = { min = 3, max = 3 }",
            "3",
            "20:22: `parameters.r.max` is 3: expected a number above `min`, which is 3",
        ),
        (
            r,
            "r = { min = 0, max = 3, scale = \"log\" }",
            "0",
            "20:13: `parameters.r.min` is 0: expected a number above 0, because the scale is log",
        ),
        (
            r,
            "r = { min = 1, max = 3, scale = \"cubic\" }",
            "\"cubic\"",
            "20:33: `parameters.r.scale` is \"cubic\": expected \"linear\" or \"log\"",
        ),
        (
            r,
            "r = { min = 1, max = 3, start = 4 }",
            "4",
            "20:33: `parameters.r.start` is 4: expected a number inside the bounds 1 to 3",
        ),
        (r, "r = { min = 1, max = nan }", "nan", "20:22: `parameters.r.max` is nan: expected a finite number"),
        (
            r,
            "r = { min = 1 }",
            "{ min = 1 }",
            "20:5: `parameters.r`: `min` and `max` come together: give both, or `init` alone for no bounds",
        ),
        (
            r,
            "r = { start = 1 }",
            "{ start = 1 }",
            "20:5: `parameters.r`: a searched parameter needs `min` and `max`, or `init` for one without bounds",
        ),
        (
            r,
            "r = { init = [1, 2], scale = \"log\" }",
            "{ init = [1, 2], scale = \"log\" }",
            "20:5: `parameters.r`: a log scale needs `min` and `max`, both above 0",
        ),
        (
            r,
            "r = { init = [2, 1] }",
            "[2, 1]",
            "20:14: `parameters.r.init` is [2, 1]: expected [low, high] with low below high",
        ),
        (
            r,
            "r = { min = 1, max = 3, init = [0, 2] }",
            "[0, 2]",
            "20:32: `parameters.r.init` is [0, 2]: expected an interval inside the bounds 1 to 3",
        ),
        (
            r,
            "r = { tie = \"s\" }",
            "\"s\"",
            "20:13: `parameters.r.tie` names the parameter `s`, which does not exist (known: `q`, `r`)",
        ),
        (r, "r = { tie = \"r\" }", "\"r\"", "20:13: `parameters.r.tie`: a parameter cannot be tied to itself"),
        (
            r,
            "r = { tie = \"q\", min = 1 }",
            "1",
            "20:24: `parameters.r.min`: it cannot stand beside `tie`: remove one of them",
        ),
        (
            r,
            "r = { tie = \"s\" }\ns = { tie = \"q\" }",
            "{ tie = \"s\" }",
            "20:5: `r`: it is tied to a parameter that is tied itself: tie both to the same one",
        ),
        (
            r,
            "r = \"5\"",
            "\"5\"",
            "20:5: `parameters.r`: expected a number, or a table such as { min = 0.1, max = 45, scale = \"log\", start = 10 }, found the string \"5\"",
        ),
        (
            r,
            "r = { min = -1e308, max = 1e308 }",
            "{ min = -1e308, max = 1e308 }",
            "20:5: `parameters.r`: the bounds are too far apart",
        ),
    ]);
    let many: String = (0..1100).map(|i| format!("k{i} = 1\n")).collect();
    let (sentence, _) = broken(r, &format!("{r}\n{many}"));
    assert_eq!(sentence, "p.toml:18:1: 1102 parameters: at most 1024 are allowed");
}

#[test]
fn tuning() {
    check(&[
        (
            "\"kalman\"",
            "\"extended\"",
            "\"extended\"",
            "23:8: `filter.kind` names the filter `extended`, which does not exist (known: `kalman`)",
        ),
        (
            "\"pso\"",
            "\"psoo\"",
            "\"psoo\"",
            "26:13: `tune.algorithm` names the algorithm `psoo`, which does not exist: did you mean `pso`? (known: `pso`, `pso-inertia`, `pio`, `pio-printed`, `pio+`, `random`)",
        ),
        (
            "[\"nll\"]",
            "[\"nil\"]",
            "\"nil\"",
            "27:15: `tune.objectives[1]` names the objective `nil`, which does not exist: did you mean `nis`? (known: `nll`, `mse_innovation`, `mismatch`, `nis`, `nees`, `rmse`, `distance`)",
        ),
        (
            "[\"nll\"]",
            "[]",
            "[]",
            "27:14: `tune.objectives` has 0 entries: expected at least one objective, such as [\"nll\"]",
        ),
        (
            "[\"nll\"]",
            "[\"nll\", { name = \"nll\", skip = 1 }]",
            "{ name = \"nll\", skip = 1 }",
            "27:22: `tune.objectives[2]`: the objective `nll` is listed twice",
        ),
        (
            "[\"nll\"]",
            "[\"nees\"]",
            "\"nees\"",
            "27:15: `tune.objectives[1]`: the objective `nees` needs truth of all states, and `v` has none",
        ),
        (
            "[\"nll\"]",
            "[{ name = \"rmse\", states = [\"v\"] }]",
            "\"v\"",
            "27:42: `tune.objectives[1].states[1]`: the state `v` has no truth: give its column in data.truth",
        ),
        (
            "[\"nll\"]",
            "[{ name = \"nll\", window = 3 }]",
            "3",
            "27:40: `tune.objectives[1].window`: it does not apply to the objective `nll`: remove it",
        ),
        (
            "[\"nll\"]",
            "[{ name = \"mismatch\", ct = \"first\" }]",
            "\"first\"",
            "27:41: `tune.objectives[1].ct` is \"first\": expected \"mean\" or \"last\"",
        ),
        (
            "[\"nll\"]",
            "[\"nll\"]\nstop = { wall_time = 0 }",
            "0",
            "28:22: `tune.stop.wall_time` is 0: expected a number above 0",
        ),
    ]);
    let text = SOUND.replace("truth = { p = \"p_true\" }\n", "").replace("[\"nll\"]", "[\"distance\"]");
    let first = error(&text).to_string();
    assert!(
        first.starts_with("p.toml:26:15: `tune.objectives[1]`: the objective `distance` needs the true states"),
        "{first}"
    );
}

#[test]
fn built_in_models() {
    let text = |model: &str| {
        format!(
            "[data]\nfile = \"l.csv\"\nmeasurements = [\"x\", \"y\"]\n[model]\n{model}\nR = [1, 1]\nx0 = \"measurement\"\n"
        )
    };
    for (model, message) in [
        (
            "kind = \"constant-velocty\"",
            "5:8: `model.kind` names the built-in model `constant-velocty`, which does not exist: did you mean `constant-velocity`?",
        ),
        ("kind = \"random-walk\"\nf = [\"x\"]", "6:1: unknown key `f` in [model]"),
        ("kind = \"random-walk\"\nP0 = [1, 1]", "4:1: [model] lacks `q`: give the strength of its process noise"),
        (
            "kind = \"random-walk\"\nq = [1, 2, 3]\nP0 = [1, 1]",
            "6:5: `model.q` has 3 entries: expected 2, one per axis (x, y)",
        ),
        (
            "kind = \"random-walk\"\nq = 1\naxes = [\"a\"]\nP0 = [1, 1]",
            "7:8: `model.axes` has 1 entry: expected 2, one per measurement (x, y)",
        ),
        (
            "kind = \"random-walk\"\nq = 1\nnoise = \"pink\"\nP0 = [1, 1]",
            "7:9: `model.noise` is \"pink\": expected \"continuous\" or \"piecewise\"",
        ),
        (
            "kind = \"constant-velocity\"\nq = 1\naxes = [\"x\", \"vx\"]\nP0 = [1]",
            "7:8: the name `vx` is already a state: choose another",
        ),
    ] {
        let first = error(&text(model)).to_string();
        assert!(first.starts_with(&format!("p.toml:{message}")), "{first}");
    }
}

#[test]
fn simulation() {
    let text = |simulate: &str| {
        let text = SOUND.replace("inputs = [\"u\"]\n", "").replace("+ 0.5*u*dt^2", "").replace("+ u*dt", "");
        format!("{text}[simulate]\n{simulate}\n")
    };
    Problem::parse(&text("steps = 10\nQ = 0\nx0 = [1, 2]\nparameters = { r = 3 }"), "p.toml").unwrap();
    for (simulate, message) in [
        ("dt = 1", "28:1: [simulate] lacks `steps`: give the number of rows after row 0"),
        ("steps = 10\nmissing = 1", "30:11: `simulate.missing` is 1: expected a share from 0 to below 1"),
        (
            "steps = 10\nparameters = { s = 3 }",
            "30:16: `simulate.parameters` names the searched parameter `s`, which does not exist (known: `q`, `r`)",
        ),
        ("steps = 10\nx0 = [1]", "30:6: `simulate.x0` has 1 entry: expected 2, one per state (p, v)"),
        ("steps = 10\nQ = 1", "30:5: `simulate.Q`: expected a list of 2 variances"),
    ] {
        let first = error(&text(simulate)).to_string();
        assert!(first.starts_with(&format!("p.toml:{message}")), "{first}");
    }
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.toml");
    let open = || Problem::open(&path).expect_err("refused").to_string();
    assert!(open().contains("p.toml: cannot read the problem file: "), "{}", open());
    std::fs::write(&path, [0xff, 0xfe, 0, 1]).unwrap();
    assert!(
        open().ends_with("p.toml: the problem file is not UTF-8 text (is this really a problem file?)"),
        "{}",
        open()
    );
    std::fs::write(&path, vec![b'\n'; 5_000_000]).unwrap();
    assert!(open().contains("the problem file has 5000000 bytes"), "{}", open());
    std::fs::write(&path, "").unwrap();
    assert!(open().contains("p.toml:1:1: the problem file lacks `data`"), "{}", open());
}

proptest! {
    #[test]
    fn no_text_breaks_the_reader(text in any::<String>()) {
        let _ = Problem::parse(&text, "p.toml").map_err(|e| e.to_string());
    }

    #[test]
    fn no_damage_breaks_the_reader(at in 0..SOUND.len(), length in 0..40usize, junk in "[-+*/^()\\[\\]{}\"'=.,0-9a-z \n]{0,8}") {
        let end = (at + length).min(SOUND.len());
        let text = format!("{}{junk}{}", &SOUND[..at], &SOUND[end..]);
        if let Err(error) = Problem::parse(&text, "p.toml") {
            let lines = text.lines().count().max(1);
            prop_assert!(error.place.as_ref().is_some_and(|p| p.line <= lines + 1), "{error}");
        }
    }
}
