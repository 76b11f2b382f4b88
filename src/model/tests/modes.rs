//! The tables `[[mode]]` and the chain between the modes.

use crate::data::DataSpec;
use crate::model::{FilterKind, Problem, Symbol};

const TWO: &str = r#"[data]
file = "log.csv"
measurements = ["z"]
inputs = ["u"]

[model]
state = ["p", "v"]
h = ["p"]
Q = { v = "q" }
R = ["r"]
x0 = [0, 0]
P0 = [100, 10]

[filter]
kind = "imm"
stay = 0.9

[[mode]]
name = "free"
f = ["p + v*dt", "v"]

[[mode]]
name = "held"
f = ["p + v*dt", "v - k*v^2*dt"]
Q = { v = "2*q" }

[parameters]
q = { min = 0.01, max = 10, start = 1 }
r = { min = 0.1, max = 100, start = 5 }
k = { min = 0, max = 1, start = 0.1 }
"#;

fn parse(replace: &[(&str, &str)]) -> Result<Problem, String> {
    let text = replace.iter().fold(TWO.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "`{from}` stands once");
        text.replace(from, to)
    });
    Problem::parse(&text, "m.toml").map_err(|error| error.to_string().lines().next().unwrap_or_default().to_owned())
}

#[test]
fn modes_have_what_they_change_and_the_rest_of_the_model() {
    let problem = parse(&[]).unwrap();
    let DataSpec { file, .. } = &problem.data;
    assert_eq!(file.as_deref(), Some("log.csv"));
    let [free, held] = &problem.modes[..] else { panic!("two modes") };
    assert_eq!((free.name.as_str(), free.filter.name()), ("free", "kalman"), "affine f and h");
    assert_eq!((held.name.as_str(), held.filter.name()), ("held", "extended"), "a curved f");
    assert_eq!((&free.model.h, &free.model.r, &free.model.p0), (&held.model.h, &held.model.r, &held.model.p0));
    assert_ne!(free.model.q, held.model.q);
    assert_eq!(problem.model.f, free.model.f, "what the model lacks is that of the first mode");
    let FilterKind::Imm(imm) = &problem.filter else { panic!("imm") };
    let values: Vec<f64> = imm.transition.iter().map(|p| p.evaluate(&|_| f64::NAN)).collect();
    values.iter().zip([0.9, 0.1, 0.1, 0.9]).for_each(|(found, expected)| assert!((found - expected).abs() < 1e-15));
    assert!(imm.start.iter().all(|p| (p.evaluate(&|_| f64::NAN) - 0.5).abs() < 1e-15), "equal");
    assert_eq!(problem.models().count(), 2);
    assert!(problem.of_mode(held).modes.is_empty());
}

#[test]
fn a_sojourn_depends_on_the_interval() {
    let problem = parse(&[("stay = 0.9", "sojourn = [\"20*k\", 4]")]).unwrap();
    let FilterKind::Imm(imm) = &problem.filter else { panic!("imm") };
    let at = |dt: f64| -> Vec<f64> {
        let value = |symbol| match symbol {
            Symbol::Parameter(_) => 0.1,
            _ => dt,
        };
        imm.transition.iter().map(|p| p.evaluate(&value)).collect()
    };
    let expected = [(-0.25_f64).exp(), -(-0.25_f64).exp_m1(), -(-0.125_f64).exp_m1(), (-0.125_f64).exp()];
    at(0.5).iter().zip(expected).for_each(|(found, expected)| assert!((found - expected).abs() < 1e-15, "{found}"));
}

/// A mode of two states of three, under names of its own: the third stays where it is.
#[test]
fn a_mode_of_fewer_states_holds_the_others() {
    let problem = parse(&[
        ("state = [\"p\", \"v\"]", "state = [\"p\", \"v\", \"a\"]\nf = [\"p + v*dt\", \"v + a*dt\", \"a\"]"),
        ("x0 = [0, 0]", "x0 = [0, 0, 0]"),
        ("P0 = [100, 10]", "P0 = [100, 10, 1]"),
        ("f = [\"p + v*dt\", \"v\"]", "f = [\"p + v*dt + a*dt^2/2\", \"v + a*dt\", \"a\"]"),
        (
            "f = [\"p + v*dt\", \"v - k*v^2*dt\"]\nQ = { v = \"2*q\" }",
            "state = [\"s\", \"w\"]\nmap = [\"v\", \"p\"]\nf = [\"s\", \"w + s*dt\"]\nh = [\"w\"]\nQ = [[\"q\", 0.5], [0.5, 4]]",
        ),
    ])
    .unwrap();
    let held = &problem.modes[1].model;
    let x = [3.0, 5.0, 7.0];
    let value = |symbol| match symbol {
        Symbol::State(i) => x[i],
        Symbol::Parameter(_) => 2.0,
        _ => 0.5,
    };
    let of = |formulas: &[crate::model::Expr]| formulas.iter().map(|f| f.evaluate(&value)).collect::<Vec<_>>();
    assert_eq!(of(&held.f), [3.0 + 5.0 * 0.5, 5.0, 7.0]);
    assert_eq!(of(&held.h), [3.0]);
    assert_eq!(of(&held.q), [4.0, 0.5, 0.0, 0.5, 2.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn what_cannot_be_is_said() {
    let name = ("name = \"held\"", "name = \"free\"");
    let f = "f = [\"p + v*dt\", \"v - k*v^2*dt\"]";
    for (replace, expected) in [
        (("stay = 0.9", "stay = 1.5"), "16:8: `filter.stay` is 1.5: expected a number from 0 to 1 at the start values"),
        (("stay = 0.9", "stay = [0.9, 0.8, 0.7]"), "16:8: `filter.stay`: expected 2 formulas, one per mode, found 3"),
        (
            ("stay = 0.9", "sojourn = -1"),
            "16:11: `filter.sojourn` is -1: expected a number above 0 at the start values",
        ),
        (
            ("stay = 0.9", ""),
            "14:1: `filter`: it lacks the chain between the modes: give `transition` (a matrix), `stay` (probabilities) or \
             `sojourn` (seconds)",
        ),
        (
            ("stay = 0.9", "stay = 0.9\nsojourn = 3"),
            "16:8: `filter.stay`: `transition`, `stay` and `sojourn` all give the chain between the modes: keep one",
        ),
        (
            ("stay = 0.9", "transition = [[0.9, 0.2], [0.1, 0.8]]"),
            "16:14: `filter.transition`: columns sum to one, not rows: transpose",
        ),
        (
            ("stay = 0.9", "transition = [[0.9, 0.1], [0.5, 0.25]]"),
            "16:14: `filter.transition`: row 2 sums to 0.75, expected 1: a row holds the probabilities of all modes after one",
        ),
        (
            ("stay = 0.9", "transition = [[0.9, 0.1], [\"k\", \"k\"]]"),
            "16:14: `filter.transition`: the sum of a row is 0.2 at the start values, and must be 1",
        ),
        (
            ("stay = 0.9", "transition = [0.9, 0.1]"),
            "16:14: `filter.transition`: expected 2 rows of 2 probabilities, one per mode, found 1",
        ),
        (
            ("stay = 0.9", "stay = 0.9\nstart = [0.5, 0.6]"),
            "17:9: `filter.start`: their sum is 1.1 at the start values, and must be 1",
        ),
        (name, "23:8: the name `free` is already another mode's: choose another"),
        (
            (f, "filter = \"fuzzy\"\nf = [\"p\", \"v\"]"),
            "24:10: `mode[2].filter` is \"fuzzy\": expected one of kalman, extended, iterated, unscented, cubature",
        ),
        (
            (f, "filter = \"kalman\"\nf = [\"p\", \"v^2\"]"),
            "25:12: `held`: the kalman filter needs f and h to be linear in the states: leave `filter` out, or set it to \
             extended, iterated, unscented or cubature",
        ),
        (
            (f, "filter = \"unscented\"\nalpha = 0\nf = [\"p\", \"v^2\"]"),
            "25:9: `mode[2].alpha` is 0: expected a number above 0 at the start values",
        ),
        (
            (f, "map = [\"p\", \"w\"]\nstate = [\"p\", \"s\"]\nf = [\"p\", \"s\"]"),
            "24:7: `mode[2].map` names the state of [model] `w`, which does not exist (known: `p`, `v`)",
        ),
        (
            (f, "allowed = \"v\"\nf = [\"p\", \"v\"]"),
            "24:12: the state `v` cannot stand in mode[2].allowed, which may use inputs and parameters",
        ),
        (
            ("Q = { v = \"2*q\" }", "Q = [1, -1]"),
            "25:5: `mode[2].Q` is not positive semidefinite at the start values: the variance of `v` is -1, expected 0 or more",
        ),
        (
            ("Q = { v = \"2*q\" }", "x0 = [1, 1]"),
            "25:1: unknown key `x0` in [mode[2]] (known: `name`, `filter`, `map`, `allowed`,",
        ),
    ] {
        let found = parse(&[replace]).unwrap_err();
        assert!(found.contains(expected), "{found}\n  expected\n{expected}");
    }
    let one = TWO.split("[[mode]]\nname = \"held\"").next().unwrap().to_owned() + "[parameters]\nq = 1\nr = 1\n";
    let error = Problem::parse(&one, "m.toml").unwrap_err().to_string();
    assert!(error.contains("\"imm\" needs two tables [[mode]] or more, one per model"), "{error}");
    let error = parse(&[("kind = \"imm\"\nstay = 0.9", "kind = \"extended\"")]).unwrap_err();
    assert!(error.contains("modes are what a filter of kind \"imm\" switches between"), "{error}");
}
