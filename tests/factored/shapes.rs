//! Every shape of problem that the two forms of the covariance must agree on.

use crate::case::Case;

const OBJECTIVES: &str = r#"objectives = ["nll", "mse_innovation", "mismatch", "nis", "nees", "rmse"]"#;
const Q: &str = "q = { min = 1e-3, max = 10, scale = \"log\", start = 0.1 }";
const R: &str = "r = { min = 0.1, max = 10, scale = \"log\", start = 1 }";

const CV: &str = r#"
measurements = ["x"]
truth = { x = "x", vx = "vx" }
[model]
kind = "constant-velocity"
noise = "continuous"
q = "q"
R = ["r"]
x0 = [0, 1]
P0 = [20, 5]"#;

const CV_3D: &str = r#"
measurements = ["x", "y", "z"]
truth = { x = "x", y = "y", z = "z", vx = "vx", vy = "vy", vz = "vz" }
[model]
kind = "constant-velocity"
axes = ["x", "y", "z"]
noise = "piecewise"
q = "q"
R = ["r", "r", "2*r"]
x0 = [0, 0, 0, 1, 1, 1]
P0 = [20, 20, 20, 5, 5, 5]"#;

const CA: &str = r#"
measurements = ["x"]
truth = { x = "x", vx = "vx", ax = "ax" }
[model]
kind = "constant-acceleration"
noise = "piecewise"
q = "q"
R = ["r"]
x0 = [0, 1, 0.1]
P0 = [20, 5, 1]"#;

const TREND: &str = r#"
measurements = ["x"]
truth = { x = "x", slope_x = "slope_x" }
[model]
kind = "local-linear-trend"
noise = "piecewise"
q_level = "q"
q_slope = 0.01
R = ["r"]
x0 = [0, 1]
P0 = [20, 5]"#;

const CORRELATED: &str = r#"
measurements = ["x", "s"]
truth = { p = "p", v = "v" }
[model]
state = ["p", "v"]
f = ["p + v*dt", "v"]
h = ["p + 0.2*v", "p - v"]
Q = { v = "q*dt" }
R = [["r + 0.5", "0.6*r"], ["0.6*r", "r"]]
x0 = [0, 1]
P0 = [[20, 3], [3, 5]]"#;

const NO_NOISE: &str = r#"
measurements = ["x"]
truth = { p = "p", v = "v" }
[model]
state = ["p", "v"]
f = ["p + v*dt", "v"]
h = ["p"]
Q = [[0, 0], [0, 0]]
R = ["r"]
x0 = [0, 1]
P0 = ["q", 5]"#;

const TURNING: &str = r#"
measurements = ["x"]
truth = { a = "a", b = "b", c = "c" }
[model]
state = ["a", "b", "c"]
f = ["0.8*a - 0.6*b", "0.6*a + 0.8*b", "phi*c"]
h = ["a + c"]
Q = [["q", "q/2", 0], ["q/2", "q", 0], [0, 0, 0]]
R = ["r"]
x0 = [3, 0, 1]
P0 = [4, 4, 1]"#;

const KNOWN: &str = r#"
measurements = ["x"]
truth = { bias = "bias", level = "level" }
[model]
state = ["bias", "level"]
f = ["bias", "level"]
h = ["level + bias"]
Q = { level = "q" }
R = ["r*r"]
x0 = [0.5, 0]
P0 = [["m*m", "0*m"], ["0*m", "0*0 + 2*2"]]"#;

fn case(name: &str, model: &str, more: &str, simulate: &str) -> Case {
    let text = format!(
        "[data]\ntime = \"t\"{model}\n[parameters]\n{Q}\n{R}\n{more}\n[tune]\nalgorithm = \"pso\"\n{OBJECTIVES}\n\
         [simulate]\nsteps = 80\ndt = 0.5\nseed = 5\n{simulate}\n"
    );
    Case::simulated(name, &text)
}

/// A bias of variance m^2 that no noise moves, on a level seen with variance r^2: both may be 0, as products.
pub(crate) fn known() -> Case {
    case("a state without noise that may be known", KNOWN, "m = { min = 0, max = 1, start = 0.5 }", "missing = 0.1")
}

pub(crate) fn shapes() -> Vec<Case> {
    let piecewise = CV.replace("continuous", "piecewise");
    let predict = format!("{CV}\nfirst = \"predict\"");
    let measured = CV.replace("x0 = [0, 1]", "x0 = \"measurement\"");
    vec![
        case("CV 1-D", CV, "", ""),
        case("CV 1-D", CV, "", "").irregular(),
        case("CV 1-D, rank-1 Q, gaps", &piecewise, "", "missing = 0.4"),
        case("CV 1-D, rank-1 Q, gaps", &piecewise, "", "missing = 0.4").irregular(),
        case("CV 1-D, first = predict", &predict, "", ""),
        case("CV 1-D, x0 measured", &measured, "", "x0 = [1, 2]\nmissing = 0.2"),
        case("CV 1-D, pooled, gaps", CV, "", "trajectories = 3\nmissing = 0.2"),
        case("CV 3-D, rank-1 Q, gaps", CV_3D, "", "missing = 0.2"),
        case("CA 1-D, rank-1 Q", CA, "", ""),
        case("CA 1-D, rank-1 Q, gaps", CA, "", "missing = 0.3").irregular(),
        case("local linear trend", TREND, "", ""),
        case("correlated R, gaps", CORRELATED, "", "missing = 0.3"),
        case("correlated R, gaps", CORRELATED, "", "missing = 0.3").irregular(),
        case("no process noise", NO_NOISE, "", ""),
        case("dense F, a decaying state", TURNING, "phi = { min = 0.3, max = 0.9, start = 0.5 }", ""),
        known(),
        Case::example("robot"),
        Case::example("uav_gps_cv"),
        Case::example("matlab_plant"),
    ]
}
