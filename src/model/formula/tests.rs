//! What formulas mean, what they refuse and where, and that no text breaks the parser.

use proptest::prelude::*;

use super::{FormulaPlace, MAX_DEPTH, MAX_NESTING, Names, Scope, parse};
use crate::model::error::{Cause, Fault};
use crate::model::{Expr, Span, Symbol};

fn names() -> Names {
    let list = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
    Names { states: list(&["x", "v"]), parameters: list(&["q", "sigma_a"]), inputs: list(&["u"]), ..Names::default() }
}

fn parse_in(text: &str, place: FormulaPlace) -> Result<Expr, Fault> {
    parse(text, Scope { names: &names(), place, key: "model.f[1]" })
}

/// The value with x = 2, v = 3, q = 5, sigma_a = 7, u = 11, dt = 0.5.
fn value(text: &str) -> f64 {
    let expr = parse_in(text, FormulaPlace::Transition).unwrap_or_else(|e| panic!("{text}: {e:?}"));
    expr.evaluate(&|symbol| match symbol {
        Symbol::State(i) => [2.0, 3.0][i],
        Symbol::Parameter(i) => [5.0, 7.0][i],
        Symbol::Input(_) => 11.0,
        Symbol::Dt => 0.5,
    })
}

/// The cause, and the part of the text that it is about.
fn refused(text: &str, place: FormulaPlace) -> (Cause, &str) {
    let fault = parse_in(text, place).expect_err(text);
    (*fault.cause, &text[fault.span.start..fault.span.end])
}

#[test]
fn precedence_and_association() {
    for (text, expected) in [
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("2 - 3 - 4", -5.0),
        ("16 / 4 / 2", 2.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("2^-1", 0.5),
        ("2 * -3", -6.0),
        ("--3", 3.0),
        ("+3 - +1", 2.0),
        ("x + v*dt", 3.5),
        ("q*dt^3/3", 5.0 * 0.125 / 3.0),
        ("sigma_a^2 + u", 60.0),
        (".5e1 + 1E-1 + 1.", 6.1),
        ("cos(pi)", -1.0),
        ("atan2(1, -1) - 3*pi/4", 0.0),
        ("min(x, v) + 10*max(x, v)", 32.0),
        ("sqrt(abs(-16)) + ln(exp(2))", 6.0),
        ("sin(0) + tan(0) + atan(0)", 0.0),
        (" x\t+\n1 ", 3.0),
        ("x < v", 1.0),
        ("x + 1 < v", 0.0),
        ("x + 1 <= v", 1.0),
        ("10*(x>v) + (v>=3)", 1.0),
        ("10*(x==2) + (x!=2)", 10.0),
        ("if(x > v, 7, -x^2)", -4.0),
        ("if(-1, 1, if(0, 2, 3))", 3.0),
        ("x < v and v < 4", 1.0),
        ("1 < 0 or 0 < 1 and not 1 < 0", 1.0),
        ("not x < v or x < v", 1.0),
        ("not not (x - 1)", 1.0),
        ("2 or 0", 1.0),
        ("if(x == 2 and not v == 2, 5, 6)", 5.0),
        ("(1 < 2) < 2", 1.0),
    ] {
        assert!((value(text) - expected).abs() < 1e-12, "{text} = {}, expected {expected}", value(text));
    }
}

#[test]
fn spans_take_in_parentheses_and_calls() {
    let text = " (x + 1)*sin(v) ";
    let expr = parse_in(text, FormulaPlace::Transition).unwrap();
    assert_eq!(&text[expr.span.start..expr.span.end], "(x + 1)*sin(v)");
    let crate::model::ExprKind::Binary(_, left, right) = &expr.kind else { panic!("a product") };
    assert_eq!(&text[left.span.start..left.span.end], "(x + 1)");
    assert_eq!(&text[right.span.start..right.span.end], "sin(v)");
}

const CHAIN: &str = "a formula compares a comparison: join two with `and`, as in `a < b and b < c`, or put one in parentheses, which is 1 or 0";

#[test]
fn syntax_errors_point_at_the_token() {
    for (text, at, message) in [
        ("x + ", "", "a formula stops short: expected a number, a name or `(`"),
        ("", "", "a formula stops short: expected a number, a name or `(`"),
        ("x * / v", "/", "a formula has `/` where a number, a name or `(` was expected"),
        ("2 x", "x", "a formula has `x` where an operator was expected"),
        ("x)", ")", "a formula has `)` where an operator was expected"),
        ("(x", "", "a formula stops short: expected `)` or an operator"),
        ("sin(x", "", "a formula stops short: expected `,`, `)` or an operator"),
        ("min(x,,v)", ",", "a formula has `,` where a number, a name or `(` was expected"),
        ("x < v < 3", "<", CHAIN),
        ("x == v != 3", "!=", CHAIN),
        ("x = v", "=", "a formula has `=` where `==` (a comparison) was expected"),
        ("!x", "!", "a formula has `!` where `!=` or `not` was expected"),
        ("x < not v", "not", "a formula has `not` where a number, a name or `(` was expected"),
        ("x and", "", "a formula stops short: expected a number, a name or `(`"),
        ("x not v", "not", "a formula has `not` where an operator was expected"),
        ("if(x, v)", "if(x, v)", "`if` takes 3 arguments, found 2"),
        ("if + 1", "if", "unknown name `if` (known: `x`, `v`, `q`, `sigma_a`, `u`, `dt`, `pi`)"),
        ("x $ v", "$", "a formula has `$` where a number, a name or an operator was expected"),
        ("x + é", "é", "a formula has `é` where a number, a name or an operator was expected"),
        ("1e999*x", "1e999", "`1e999` is not a finite number"),
        ("1.5.2", ".2", "a formula has the number 0.2 where an operator was expected"),
    ] {
        let (cause, found) = refused(text, FormulaPlace::Transition);
        assert_eq!((found, cause.to_string().as_str()), (at, message), "{text}");
    }
}

#[test]
fn names_and_arguments() {
    let (cause, at) = refused("x + sigma_b*v", FormulaPlace::Transition);
    assert_eq!(at, "sigma_b");
    assert!(
        cause.to_string().starts_with("unknown name `sigma_b`: did you mean `sigma_a`? (known: `x`, `v`"),
        "{cause}"
    );
    let (cause, at) = refused("sine(x)", FormulaPlace::Transition);
    assert_eq!(at, "sine");
    assert!(cause.to_string().starts_with("unknown function `sine`: did you mean `sin`?"), "{cause}");
    let (cause, at) = refused("1 + atan2(x)*2", FormulaPlace::Transition);
    assert_eq!((at, cause.to_string().as_str()), ("atan2(x)", "`atan2` takes 2 arguments, found 1"));
    let (cause, at) = refused("sin()", FormulaPlace::Transition);
    assert_eq!((at, cause.to_string().as_str()), ("sin()", "`sin` takes 1 argument, found 0"));
}

#[test]
fn every_kind_of_formula_has_its_symbols() {
    use FormulaPlace::{Constant, Measurement, ProcessNoise, Transition};
    let allowed = |text, place| parse_in(text, place).is_ok();
    for (text, expected) in [
        ("x", [true, true, false, false]),
        ("u", [true, true, false, false]),
        ("dt", [true, false, true, false]),
        ("q", [true, true, true, true]),
    ] {
        let found = [Transition, Measurement, ProcessNoise, Constant].map(|place| allowed(text, place));
        assert_eq!(found, expected, "{text}");
    }
    let (cause, at) = refused("q*x", Constant);
    assert_eq!(at, "x");
    assert_eq!(cause.to_string(), "the state `x` cannot stand in model.f[1], which may use parameters");
}

#[test]
fn depth_and_length_are_bounded() {
    let nested = |n: usize| format!("{}x{}", "(".repeat(n), ")".repeat(n));
    assert!(parse_in(&nested(MAX_NESTING), FormulaPlace::Transition).is_ok(), "the limit itself is allowed");
    for text in [
        nested(MAX_NESTING + 1),
        "-".repeat(9000) + "x",
        "+".repeat(9000) + "x",
        "sin(".repeat(2000),
        "x^".repeat(4000),
        "not ".repeat(2000),
        "if(1, 2, ".repeat(1000),
    ] {
        let (cause, _) = refused(&text, FormulaPlace::Transition);
        assert_eq!(cause, Cause::FormulaTooDeep { limit: MAX_NESTING });
    }
    for (text, length) in [(nested(100_000), 200_001), ("x+".repeat(500_000), 1_000_000)] {
        let (cause, _) = refused(&text, FormulaPlace::Transition);
        assert_eq!(cause, Cause::FormulaTooLong { length, limit: 10_000 });
    }
}

#[test]
fn long_chains_are_refused_before_they_are_too_deep_to_walk() {
    let chain = |n: usize, op: &str| vec!["x"; n].join(op);
    for op in [" or ", " and "] {
        assert!(parse_in(&chain(MAX_DEPTH, op), FormulaPlace::Transition).is_ok(), "{op}");
        let (cause, _) = refused(&chain(MAX_DEPTH + 1, op), FormulaPlace::Transition);
        assert_eq!(cause, Cause::FormulaChain { limit: MAX_DEPTH }, "{op}");
    }
    for op in ["+", "-", "*", "/"] {
        assert!(parse_in(&chain(MAX_DEPTH, op), FormulaPlace::Transition).is_ok(), "{op}");
        let text = chain(5000, op);
        let fault = parse_in(&text, FormulaPlace::Transition).expect_err(op);
        assert_eq!(*fault.cause, Cause::FormulaChain { limit: MAX_DEPTH });
        assert_eq!(
            fault.span,
            Span { start: 2 * MAX_DEPTH - 1, end: 2 * MAX_DEPTH },
            "at the operator that is too many"
        );
    }
}

/// The formula fully parenthesised, written from the tree.
fn print(expr: &Expr) -> String {
    use crate::model::ExprKind;
    match &expr.kind {
        ExprKind::Number(v) => format!("{v:?}"),
        ExprKind::Symbol(Symbol::State(i)) => names().states[*i].clone(),
        ExprKind::Symbol(Symbol::Parameter(i)) => names().parameters[*i].clone(),
        ExprKind::Symbol(Symbol::Input(i)) => names().inputs[*i].clone(),
        ExprKind::Symbol(Symbol::Dt) => "dt".to_owned(),
        ExprKind::Negate(a) => format!("(-{})", print(a)),
        ExprKind::Binary(op, a, b) => format!("({} {} {})", print(a), op.symbol(), print(b)),
        ExprKind::Logical(op, a, b) => format!("({} {} {})", print(a), op.symbol(), print(b)),
        ExprKind::If(_) => call("if", expr),
        ExprKind::Table(curve, a) => format!("table({curve}, {})", print(a)),
        ExprKind::Call(function, _) => call(function.name(), expr),
    }
}

fn call(name: &str, expr: &Expr) -> String {
    format!("{name}({})", expr.operands().into_iter().map(print).collect::<Vec<_>>().join(", "))
}

fn formula() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        (0.0..1e6f64).prop_map(|v| format!("{v:?}")),
        prop::sample::select(vec!["x", "v", "q", "u", "dt", "pi"]).prop_map(str::to_owned),
    ];
    leaf.prop_recursive(5, 40, 2, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone(), prop::sample::select(vec!["+", "-", "*", "/", "^"]))
                .prop_map(|(a, b, op)| format!("{a} {op} {b}")),
            inner.clone().prop_map(|a| format!("-({a})")),
            inner.clone().prop_map(|a| format!("cos({a})")),
            (inner.clone(), inner.clone(), prop::sample::select(vec!["<", "<=", "==", "!=", "and", "or"]))
                .prop_map(|(a, b, op)| format!("if(({a}) {op} ({b}), {a}, {b})")),
            inner.clone().prop_map(|a| format!("(not {a})")),
            (inner.clone(), inner).prop_map(|(a, b)| format!("min({a}, {b})")),
        ]
    })
}

proptest! {
    #[test]
    fn any_text_is_parsed_or_refused_inside_itself(text in any::<String>()) {
        if let Err(fault) = parse_in(&text, FormulaPlace::Transition) {
            prop_assert!(text.get(fault.span.start..fault.span.end).is_some(), "{:?}", fault.span);
        }
    }

    #[test]
    fn any_text_of_the_alphabet_is_parsed_or_refused(text in "[-+*/^().,0-9exvqu <>=!]{0,60}") {
        if let Err(fault) = parse_in(&text, FormulaPlace::Transition) {
            prop_assert!(text.get(fault.span.start..fault.span.end).is_some(), "{:?}", fault.span);
        }
    }

    #[test]
    fn a_printed_formula_reads_back(text in formula()) {
        let expr = parse_in(&text, FormulaPlace::Transition).map_err(|e| TestCaseError::fail(format!("{e:?}")))?;
        let again = parse_in(&print(&expr), FormulaPlace::Transition).map_err(|e| TestCaseError::fail(format!("{e:?}")))?;
        prop_assert!(expr.same(&again), "{text} became {}", print(&again));
    }

    #[test]
    fn a_printed_number_reads_back_to_the_bit(bits in any::<u64>()) {
        let number = f64::from_bits(bits & !(1 << 63));
        prop_assume!(number.is_finite());
        for text in [format!("{number}"), format!("{number:e}"), format!("{number:?}")] {
            prop_assert_eq!(value(&text).to_bits(), number.to_bits(), "{}", text);
        }
    }
}
