//! Matrices against the reference, which evaluates the model by itself, and against the cases that misled.

use proptest::prelude::*;

use super::*;
use crate::data::Log;
use crate::model::Binary;
use crate::reference::{Scope, evaluate};

const REGRESSION: &str = r#"
[data]
file = "log.csv"
time = "week"
measurements = ["Y"]
inputs = ["X1", "X2"]
[model]
state = ["level", "b1", "b2"]
f = ["level", "b1", "b2"]
h = ["level + b1*X1 + b2*X2"]
Q = ["q", "q", "q"]
R = ["r"]
x0 = [0, 0, 0]
P0 = [1e4, 1e4, 1e4]
[parameters]
r = { min = 1e-6, max = 100, scale = "log", start = 1 }
q = { min = 1e-9, max = 100, scale = "log", start = 0.1 }
[tune]
objectives = ["nll"]
"#;

fn matrices(text: &str, csv: &str) -> Matrices {
    let problem = Problem::parse(text, "p.toml").unwrap();
    let log = Log::read(&problem.data, csv.as_bytes(), "log.csv").unwrap();
    Matrices::of(&problem, &log, &problem.parameters.baseline())
}

#[test]
fn a_matrix_reads_as_numpy_and_json() {
    let matrix = Matrix::from(&DMatrix::from_row_slice(2, 2, &[1.0, 0.25, 0.0, -1.0 / 3.0]));
    let text = format!("{matrix:4}");
    assert_eq!(text, "[[          1,        0.25],\n     [          0, -0.33333333]]");
    let read: Vec<Vec<f64>> = serde_json::from_str(&text).unwrap();
    assert!((read[1][1] + 1.0 / 3.0).abs() < 1e-8, "pasted text reads back: {text}");
    assert_eq!(serde_json::to_string(&matrix).unwrap(), "[[1.0,0.25],[0.0,-0.3333333333333333]]");
}

/// Regressors make H another in every row, so there is no one gain either.
#[test]
fn what_inputs_change_is_a_formula() {
    let found = matrices(REGRESSION, "week,Y,X1,X2\n1,1,2,3\n2,1,2,4\n3,1,5,4\n");
    assert_eq!(
        found.to_string(),
        "F = [[1, 0, 0],\n     [0, 1, 0],\n     [0, 0, 1]]\nH = [[ 1, X1, X2]]\n\
         Q = [[0.1,   0,   0],\n     [  0, 0.1,   0],\n     [  0,   0, 0.1]]\nR = [[1]]\n\
         K changes from row to row, as H does.\n"
    );
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json["H"], serde_json::json!([[1.0, "X1", "X2"]]));
    assert_eq!((&json["varies"], &json["gain"]), (&serde_json::json!(["H"]), &"varies".into()));
    assert!(json["K"].is_null() && json["f0"].is_null() && json["dt"] == 1.0, "{json}");
}

/// A parameter stands with its value; a measurement without any state in it is all offset.
#[test]
fn parameters_are_filled_in_and_offsets_shown() {
    let scaled = REGRESSION.replace("level + b1*X1 + b2*X2", "level*r*X1/4 - 2 - X2");
    let csv = "week,Y,X1,X2\n1,1,2,3\n2,1,2,4\n3,1,5,4\n";
    let found = matrices(&scaled.replace("start = 1 }", "start = 2 }"), csv);
    assert_eq!(found.H.as_ref().unwrap().to_string(), "[[0.5*X1,      0,      0]]");
    assert_eq!(found.h0.unwrap().to_string(), "[[-2 - X2]]");
    let found = matrices(&REGRESSION.replace("level + b1*X1 + b2*X2", "q*X1"), csv);
    assert_eq!((found.H.as_ref().unwrap().to_string().as_str(), found.gain), ("[[0, 0, 0]]", Gain::Unsettled));
    assert_eq!(found.h0.as_ref().map(ToString::to_string).as_deref(), Some("[[0.1*X1]]"));
    assert_eq!(found.varies, ["h0"]);
}

#[test]
fn what_irregular_steps_change_is_a_formula_of_dt() {
    let text = r#"
[data]
file = "log.csv"
time = "t"
measurements = ["z"]
[model]
kind = "constant-velocity"
axes = ["x"]
noise = "continuous"
q = "q"
R = ["r"]
x0 = [0, 0]
P0 = [1, 1]
[parameters]
r = { min = 1e-6, max = 100, start = 2 }
q = { min = 1e-9, max = 100, start = 0.3 }
[tune]
objectives = ["nll"]
"#;
    let found = matrices(text, "t,z\n0,1\n1,1\n3,2\n");
    assert_eq!((found.dt, &found.varies[..]), (None, &["F", "Q"][..]));
    assert_eq!(found.F.as_ref().unwrap().to_string(), "[[ 1, dt],\n [ 0,  1]]");
    assert_eq!(found.Q.to_string(), "[[ 0.1*dt^3, 0.15*dt^2],\n [0.15*dt^2,    0.3*dt]]");
    assert!(found.to_string().ends_with("K changes from row to row, as F and Q do.\n"), "{found}");
    let regular = matrices(text, "t,z\n0,1\n2,1\n4,2\n");
    assert_eq!((regular.dt, regular.gain, regular.varies.len()), (Some(2.0), Gain::Steady, 0));
    assert_eq!(regular.Q.to_string(), "[[0.8, 0.6],\n [0.6, 0.6]]");
}

/// What is not affine is a formula of the states; there is no one gain, and the rest is as ever.
#[test]
fn what_is_not_affine_is_a_formula() {
    let text = REGRESSION
        .replace("level + b1*X1 + b2*X2", "q*level^2 + exp(b1*X1)*2*3")
        .replace("[tune]", "[filter]\nkind = \"extended\"\n[tune]");
    let found = matrices(&text, "week,Y,X1,X2\n1,1,2,3\n2,1,2,4\n3,1,5,4\n");
    assert_eq!(
        found.to_string(),
        "F = [[1, 0, 0],\n     [0, 1, 0],\n     [0, 0, 1]]\nh = [[0.1*level^2 + 6*exp(b1*X1)]]\n\
         Q = [[0.1,   0,   0],\n     [  0, 0.1,   0],\n     [  0,   0, 0.1]]\nR = [[1]]\n\
         K changes from row to row, as h does.\n"
    );
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!((&json["h"], &json["gain"]), (&serde_json::json!([["0.1*level^2 + 6*exp(b1*X1)"]]), &"varies".into()));
    assert!(json.get("H").is_none() && json.get("f").is_none(), "{json}");
    let problem = Problem::parse(&text, "p.toml").unwrap();
    assert_eq!(reference::steady_gain(&problem, &problem.parameters.baseline(), 1.0), None);
}

/// A filter for any f and h on an affine model has its matrices and its gain.
#[test]
fn an_affine_model_has_matrices_whatever_its_filter() {
    let linear = REGRESSION.replace("level + b1*X1 + b2*X2", "level + b1 + 2*b2");
    let csv = "week,Y,X1,X2\n1,1,2,3\n2,1,2,4\n3,1,5,4\n";
    let cubature = linear.replace("[tune]", "[filter]\nkind = \"cubature\"\n[tune]");
    assert_eq!(matrices(&linear, csv), matrices(&cubature, csv));
}

#[test]
fn large_matrices_are_printed_by_what_they_hold() {
    let states: Vec<String> = (1..=8).map(|i| format!("\"s{i}\"")).collect();
    let quoted = |of: &dyn Fn(usize) -> String| (1..=8).map(of).collect::<Vec<_>>().join(", ");
    let text = REGRESSION
        .replace("\"level\", \"b1\", \"b2\"]\nf", &format!("{}]\nf", states.join(", ")))
        .replace("f = [\"level\", \"b1\", \"b2\"]", &format!("f = [{}]", quoted(&|i| format!("\"s{}\"", i % 8 + 1))))
        .replace("level + b1*X1 + b2*X2", "s1")
        .replace("Q = [\"q\", \"q\", \"q\"]", &format!("Q = [\"q\", {}]", ["0"; 7].join(", ")))
        .replace("[0, 0, 0]", &format!("[{}]", quoted(&|_| "0".to_owned())))
        .replace("[1e4, 1e4, 1e4]", &format!("[{}]", quoted(&|_| "1".to_owned())));
    let found = matrices(&text, "week,Y,X1,X2\n1,1,2,3\n2,1,2,4\n3,1,5,4\n").to_string();
    assert!(found.contains("\nQ (8 x 8) is 0 but for\n    [s1, s1] 0.1\n"), "{found}");
    assert!(found.starts_with("F (8 x 8) is 0 but for\n    [s1, s2] 1, [s2, s3] 1,"), "{found}");
    assert!(found.lines().all(|line| line.chars().count() <= LINE_OF_TEXT), "{found}");
    assert!(!found.contains(", 0,"), "{found}");
}

const LINE_OF_TEXT: usize = 104;

/// Every example's matrices at its own interval are those that the reference finds by unit vectors.
#[test]
fn values_are_those_of_the_reference() {
    let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for name in ["nile.toml", "rocket.toml", "refuelling.toml", "robot.toml", "uav_gps_ca.toml", "matlab_plant.toml"] {
        let problem = Problem::open(&examples.join(name)).unwrap();
        let log = match problem.data.file {
            Some(_) => Log::open(&problem.data, &examples).unwrap(),
            None => crate::simulate::simulate(&problem, None).unwrap(),
        };
        let candidate = problem.parameters.baseline();
        let found = Matrices::of(&problem, &log, &candidate);
        let dt = log.regular_dt().expect("a regular example");
        let reference = reference::Matrices::of(&problem, &candidate, dt);
        let pairs = [
            (found.F.as_ref().unwrap(), reference.f),
            (found.H.as_ref().unwrap(), reference.h),
            (&found.Q, reference.q),
            (&found.R, reference.r),
        ];
        for (matrix, expected) in pairs.iter().filter(|(matrix, _)| !matrix.varies()) {
            for (i, row) in matrix.rows.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    let Entry::Value(value) = entry else { panic!("{name}: {entry}") };
                    let size = expected[(i, j)].abs();
                    assert!((value - expected[(i, j)]).abs() <= 1e-14 * size, "{name} [{i}, {j}]: {value} {expected}");
                }
            }
        }
    }
}

fn any_formula() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        (-4i8..5).prop_map(|v| Expr::number(f64::from(v) / 2.0)),
        (0..2usize).prop_map(|i| Expr::symbol(Symbol::Input(i))),
        (0..2usize).prop_map(|i| Expr::symbol(Symbol::Parameter(i))),
        Just(Expr::symbol(Symbol::Dt)),
    ];
    leaf.prop_recursive(5, 40, 2, |inner| {
        let op = prop_oneof![
            Just(Binary::Add),
            Just(Binary::Subtract),
            Just(Binary::Multiply),
            Just(Binary::Divide),
            Just(Binary::Power)
        ];
        let negate = |a: Expr| Expr { kind: crate::model::ExprKind::Negate(Box::new(a)), span: Default::default() };
        let call = |a: Expr| {
            let kind = crate::model::ExprKind::Call(crate::model::Function::Atan, vec![a]);
            Expr { kind, span: Default::default() }
        };
        let compare = |(a, b): (Expr, Expr)| Expr::logical(crate::model::Logical::Less, a, b);
        let choose = |(a, b, c): (Expr, Expr, Expr)| {
            let condition = Expr::logical(
                crate::model::Logical::Or,
                Expr::logical(crate::model::Logical::Less, a.clone(), b),
                c.clone(),
            );
            Expr { kind: crate::model::ExprKind::If(Box::new([condition, a, c])), span: Default::default() }
        };
        prop_oneof![
            (inner.clone(), inner.clone()).prop_map(compare),
            (inner.clone(), inner.clone(), inner.clone()).prop_map(choose),
            (op, inner.clone(), inner.clone()).prop_map(|(op, a, b)| Expr::binary(op, a, b)),
            inner.clone().prop_map(negate),
            inner.prop_map(call),
        ]
    })
}

proptest! {
    /// Filled in, simplified, written and read again, a formula of two states keeps its value: of a*s0 + b - c*s1/2 the
    /// derivatives are a and -c/2, and b is what is left.
    #[test]
    fn text_means_what_the_formula_does(a in any_formula(), b in any_formula(), c in any_formula()) {
        let problem = Problem::parse(REGRESSION, "p.toml").unwrap();
        let [s0, s1] = [0, 1].map(|i| Expr::symbol(Symbol::State(i)));
        let join = Expr::binary;
        let whole = join(
            Binary::Subtract,
            join(Binary::Add, join(Binary::Multiply, a.clone(), s0), b.clone()),
            join(Binary::Divide, join(Binary::Multiply, s1, c.clone()), Expr::number(2.0)),
        );
        let (parameters, inputs, dt) = ([0.7, -1.3], [1.9, 0.4], 0.25);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &inputs, dt };
        let expected = [evaluate(&a, &scope), -evaluate(&c, &scope) / 2.0, evaluate(&b, &scope)];
        let filled = formula::filled(&whole, &parameters, None);
        let found = [formula::coefficient(&filled, 0), formula::coefficient(&filled, 1), formula::offset(&filled)];
        for (expected, found) in expected.iter().zip(&found) {
            // What is no number, or lost its digits in a difference, is not compared.
            if !(1e-6..1e6).contains(&expected.abs()) {
                continue;
            }
            let text = Writer { model: &problem.model, number: &exact }.text(found);
            // min and max leave out what is no number, which formulas cannot name.
            if text.contains("NaN") || text.contains("inf") {
                continue;
            }
            let again = REGRESSION.replace("level + b1*X1 + b2*X2", "level").replace("f = [\"level\"", &format!("f = [\"{text}\""));
            let again = Problem::parse(&again, "p.toml").unwrap_or_else(|error| panic!("{text}: {error}"));
            let value = evaluate(&again.model.f[0], &scope);
            prop_assert!((value - expected).abs() <= 1e-9 * expected.abs(), "{}: {} for {}", text, value, expected);
        }
    }
}
