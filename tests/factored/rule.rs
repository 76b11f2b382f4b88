//! Which form is chosen, and that it is said.

use crate::case::Case;
use kfgpu::evaluate::Precision;
use kfgpu::filter::Form;

/// A position and a speed; only `h` is measured.
fn case(h: &str, p0: &str, r: &str, parameters: &str) -> Case {
    let text = format!(
        "[data]\ntime = \"t\"\nmeasurements = [\"m\"]\n[model]\nstate = [\"p\", \"v\"]\nf = [\"p + v*dt\", \"v\"]\n\
         h = [\"{h}\"]\nQ = {{ v = 0.1 }}\nR = [\"{r}\"]\nx0 = [0, 0]\nP0 = [1, \"{p0}\"]\n[parameters]\n{parameters}\n\
         [tune]\nalgorithm = \"pso\"\nobjectives = [\"nll\"]\n[simulate]\nsteps = 10\n"
    );
    Case::simulated("rule", &text)
}

#[track_caller]
fn chosen(h: &str, p0: &str, r: &str, parameters: &str) -> Form {
    case(h, p0, r, parameters).program(Precision::F32, None).form()
}

#[test]
fn the_largest_initial_variance_over_the_smallest_noise_decides() {
    let r = "r = { min = 0.5, max = 2, start = 1 }";
    assert_eq!(chosen("p", "500", "r", r), Form::Full, "P0/R = 1e3 at the lower bound of r");
    assert_eq!(chosen("p", "501", "r", r), Form::Factored, "above it");
    assert_eq!(chosen("10*p", "5.01", "r", r), Form::Factored, "H^2 brings P0 to the unit of the measurement");
    assert_eq!(chosen("p", "500", "1/(1 + r)", r), Form::Factored, "R that falls with its parameter");
    assert_eq!(chosen("p", "501", "r", &r.replace("0.5", "0")), Form::Factored, "R may be 0");
    let s = "s = { min = 1, max = 32, start = 2 }";
    assert_eq!(chosen("p", "s^2", "1", s), Form::Factored, "P0 = 1024 at its upper bound");
    assert_eq!(chosen("p", "s^2", "1.1", s), Form::Full, "931 at its upper bound");
    assert_eq!(chosen("p", "s^2", "1", "s = { init = [1, 32] }"), Form::Factored, "the first population's range");
}

/// Not by P0 alone: by what an update really takes away.
#[test]
fn double_precision_carries_factors_where_an_update_takes_six_digits() {
    let r = "r = { min = 0.5, max = 2, start = 1 }";
    let chosen = |h, p0| case(h, p0, "r", r).program(Precision::F64, None).form();
    assert_eq!(chosen("p", "1e5"), Form::Full, "P0/R = 2e5");
    assert_eq!(chosen("p", "1e8"), Form::Factored);
    assert_eq!(chosen("v", "1e8"), Form::Full, "what a sensor sees alone is multiplied, and no other state is diffuse");
}

#[test]
fn the_form_is_said() {
    let case = case("p", "1e5", "r", "r = { min = 0.5, max = 2, start = 1 }");
    let listing = case.program(Precision::F32, None).to_string();
    assert!(listing.contains("\n# carries x and factors P = U D U'\n"), "{listing}");
    for name in ["D.p = ", "U.p.v = ", "D.v = "] {
        assert!(listing.contains(name), "{name} is carried: {listing}");
    }
    let listing = case.program(Precision::F64, None).to_string();
    assert!(listing.contains("\n# carries x and covariance P\n"), "{listing}");
}
