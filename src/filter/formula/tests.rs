//! Formulas on the graph against the tree: values, and derivatives by the graph, by dual numbers and by central differences.

use super::{Scope, trace};
use crate::model::{Expr, ExprKind, FormulaPlace, FormulaScope, Function, Names, Symbol, parse};
use crate::random::{Purpose, Stream};
use crate::reference;
use crate::tape::{Calculator, Graph, Id, Leaf, Moved, Node};
use std::collections::HashMap;
use std::path::Path;

const LEAVES: [Leaf; 2] = [Leaf::Variable(0), Leaf::Variable(1)];

fn graph() -> (Graph, [Id; 2]) {
    let mut g = Graph::default();
    let states = LEAVES.map(|leaf| g.leaf(leaf));
    (g, states)
}

fn parsed(text: &str) -> Expr {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let names = Names { states: vec!["x".to_owned(), "y".to_owned()], folder, ..Names::default() };
    let scope = FormulaScope { names: &names, place: FormulaPlace::Transition, key: "f" };
    parse(text, scope).unwrap_or_else(|fault| panic!("{text}: {}", fault.cause))
}

/// A formula of x and y, on the graph with its derivatives.
struct Traced {
    expr: Expr,
    calculator: Calculator,
}

impl Traced {
    fn of(expr: Expr) -> Self {
        let (mut g, states) = graph();
        let dt = g.constant(0.5);
        let value = trace(&mut g, &expr, Scope { states: &states, parameters: &[], inputs: &[], dt });
        let slopes = LEAVES.map(|leaf| g.differentiate(value, leaf));
        let calculator = Calculator::new(&g, &[value, slopes[0], slopes[1]]);
        Self { expr, calculator }
    }

    fn parsed(text: &str) -> Self {
        Self::of(parsed(text))
    }

    /// Value and derivatives on the graph.
    fn on_graph(&mut self, at: [f64; 2]) -> [f64; 3] {
        let values: Vec<f64> = self.calculator.evaluate(|leaf| if leaf == LEAVES[0] { at[0] } else { at[1] }).collect();
        [values[0], values[1], values[2]]
    }

    /// The same on the tree.
    fn on_tree(&self, at: [f64; 2]) -> [f64; 3] {
        let scope = reference::Scope { states: &at, dt: 0.5, ..reference::Scope::default() };
        let slopes = reference::gradient(&self.expr, &scope);
        [reference::evaluate(&self.expr, &scope), slopes[0], slopes[1]]
    }

    /// The central difference in one of the two, and how far that of half the step is from it: far where the formula has a kink
    /// or a jump within a step.
    fn by_steps(&self, at: [f64; 2], j: usize) -> (f64, f64) {
        let step = 1e-4 * at[j].abs().max(1e-2);
        let value = |by: f64| {
            let mut at = at;
            at[j] += by;
            reference::evaluate(&self.expr, &reference::Scope { states: &at, dt: 0.5, ..reference::Scope::default() })
        };
        let slope = |step: f64| (value(step) - value(-step)) / (2.0 * step);
        let (whole, half) = (slope(step), slope(0.5 * step));
        // Richardson's extrapolation.
        ((4.0 * half - whole) / 3.0, (half - whole).abs())
    }

    /// Checks a point, where it is one of the formula's domain and not at a kink; whether it was.
    fn check(&mut self, name: &str, at: [f64; 2]) -> bool {
        let (graph, tree) = (self.on_graph(at), self.on_tree(at));
        if !graph.iter().all(|v| v.is_finite()) {
            return false;
        }
        let size = tree[0].abs().max(1.0);
        assert!((graph[0] - tree[0]).abs() <= 1e-13 * size, "{name} at {at:?}: {} and {}", graph[0], tree[0]);
        let mut smooth = true;
        for j in 0..2 {
            let (on_graph, on_tree) = (graph[1 + j], tree[1 + j]);
            // Small slopes of large values lose digits in whatever is computed by cancelling terms.
            let slope = on_tree.abs().max(1e-3 * size);
            assert!(
                (on_graph - on_tree).abs() <= 1e-12 * slope,
                "{name} at {at:?}: slope {j} {on_graph} and {on_tree}"
            );
            let (stepped, apart) = self.by_steps(at, j);
            if apart <= 1e-5 * slope {
                assert!(
                    (stepped - on_tree).abs() <= 1e-6 * slope.max(1e-3 * size),
                    "{name} at {at:?}: {stepped}, {on_tree}"
                );
            } else {
                smooth = false;
            }
        }
        smooth
    }

    /// Random points, of several sizes; how many of them were checked.
    fn check_at_random_points(&mut self, name: &str) -> usize {
        let mut stream = Stream::new(17, Purpose::Workload, 0, 0);
        let mut draw = |size: f64| size * (2.0 * stream.uniform() - 1.0);
        (0..400)
            .filter(|k| self.check(name, [0.9, 3.0, 20.0, 0.02].map(|size| [draw(size), draw(size)])[k % 4]))
            .count()
    }
}

#[test]
fn derivatives_of_every_function_are_those_of_dual_numbers_and_of_differences() {
    let symbols = [Symbol::State(0), Symbol::State(1)].map(Expr::symbol);
    for (name, function) in Function::ALL {
        let arguments = symbols[..function.arity()].to_vec();
        let expr = Expr { kind: ExprKind::Call(function, arguments), span: Default::default() };
        let checked = Traced::of(expr).check_at_random_points(name);
        assert!(checked >= 60, "{name}: {checked} points of 400 in its domain");
    }
}

/// One comparison as a condition is one select, on the difference of its sides.
#[test]
fn a_condition_is_one_select() {
    for (text, selects) in [
        ("if(x < y, x, 2)", 1),
        ("if(x >= y, x, 2)", 1),
        ("if(x == y, x, 2)", 1),
        ("if(not x > y, x, 2)", 2),
        ("if(x < y and x > 0, x, 2)", 2),
        ("if(x < y or x > 0, x, 2)", 2),
        ("(x != y)*3", 1),
        ("if(x, 1, 1)", 0),
    ] {
        let (mut g, states) = graph();
        let dt = g.constant(0.5);
        let expr = parsed(text);
        let value = trace(&mut g, &expr, Scope { states: &states, parameters: &[], inputs: &[], dt });
        let found = g.reachable(&[value], |_| true).into_iter();
        let found = found.filter(|id| matches!(g.node(*id), Node::Select { .. })).count();
        assert_eq!(found, selects, "{text}");
    }
}

/// What the branch that is not taken has does not matter: for values, derivatives and differences across the border.
#[test]
fn the_branch_that_is_not_taken_may_be_no_number() {
    for text in [
        "if(x > 0, sqrt(x), 0)",
        "if(x <= 0, 0, sqrt(x))",
        "if(x > 0, ln(x)/x, x)",
        "if(x != 0, sin(x)/x, 1) + if(abs(x) > 3, 1/(abs(x) - 3), 0)",
        "if(x > 0 and y > 0, sqrt(x*y), 1)",
    ] {
        let mut traced = Traced::parsed(text);
        let (mut g, states) = graph();
        let dt = g.constant(0.5);
        let value = trace(&mut g, &traced.expr, Scope { states: &states, parameters: &[], inputs: &[], dt });
        let places = [-2.0, -0.5, 0.0, 0.25, 3.0, 4.0];
        for (at, base) in places.iter().flat_map(|x| places.map(|y| ([*x, 1.0], [y, 1.0]))) {
            let (graph, tree) = (traced.on_graph(at), traced.on_tree(at));
            assert!(graph.iter().chain(&tree).all(|v| v.is_finite()), "{text} at {at:?}: {graph:?} {tree:?}");
            assert!(graph.iter().zip(&tree).all(|(a, b)| (a - b).abs() < 1e-12), "{text}: {graph:?} {tree:?}");
            let mut moved = HashMap::new();
            for (leaf, (at, base)) in LEAVES.iter().zip(at.iter().zip(base)) {
                let (base, delta) = (g.constant(base), g.constant(at - base));
                moved.insert(*leaf, Moved::by(&mut g, base, delta));
            }
            let delta = g.difference(&[value], &moved, &mut |_, _| false).roots[0].delta;
            let expected = graph[0] - traced.on_graph(base)[0];
            let found = g.value(delta).unwrap();
            assert!((found - expected).abs() < 1e-12, "{text} from {base:?} to {at:?}: {found}, expected {expected}");
        }
    }
}

/// On the graph a curve is a sum of pieces; at its points, too, it has the slope that the tree has.
#[test]
fn curves_have_their_values_and_slopes_at_their_points_and_beyond() {
    let mut traced = Traced::parsed("table('ocv.csv', x)");
    let points = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 1.0];
    let between = (-30..60).map(|k| f64::from(k) / 29.0);
    for x in points.into_iter().chain(between) {
        let (graph, tree) = (traced.on_graph([x, 0.0]), traced.on_tree([x, 0.0]));
        for (graph, tree) in graph.iter().zip(tree) {
            assert!(
                (graph - tree).abs() <= 1e-12 * tree.abs().max(1.0),
                "{x}: {graph} on the graph, {tree} on the tree"
            );
        }
    }
}

/// How far a curve moves keeps its digits, however little its place does: in f32 a difference of values has four.
#[test]
fn differences_of_curves_keep_their_digits() {
    let traced = Traced::parsed("table('ocv.csv', x)");
    let (mut g, [x, _]) = graph();
    let dt = g.constant(0.5);
    let value = trace(&mut g, &traced.expr, Scope { states: &[x, x], parameters: &[], inputs: &[], dt });
    let (base, delta) = (g.leaf(Leaf::Column(0)), g.leaf(Leaf::Carried(0)));
    let moved = HashMap::from([(LEAVES[0], Moved::by(&mut g, base, delta))]);
    let moved = g.difference(&[value], &moved, &mut |_, _| true).roots[0];
    let mut calculator = Calculator::new(&g, &[moved.base, moved.delta]);
    for (from, by) in
        [(0.02, 1e-9), (0.3, -1e-12), (0.5, 1e-10), (0.2, -1e-10), (1.2, 1e-9), (-0.1, 1e-9), (0.3, 0.4), (-0.5, 2.0)]
    {
        let found: Vec<f64> = calculator.evaluate(|leaf| if leaf == Leaf::Column(0) { from } else { by }).collect();
        let [at, slope, _] = traced.on_tree([from, 0.0]);
        assert!((found[0] - at).abs() < 1e-14 * at.abs().max(1.0) * 10.0, "{from}: {} and {at}", found[0]);
        let expected = if by.abs() < 1e-8 { slope * by } else { traced.on_tree([from + by, 0.0])[0] - at };
        assert!(
            (found[1] - expected).abs() <= 1e-6 * expected.abs(),
            "{from} by {by}: {}, expected {expected}",
            found[1]
        );
    }
}

#[test]
fn derivatives_of_formulas_are_those_of_dual_numbers_and_of_differences() {
    for text in [
        "x^2 + y^3",
        "x^-2 * y",
        "abs(x)^y",
        "abs(x)^1.5 / (1 + y^2)",
        "2^x - exp(y/3)",
        "x + sinc(y*dt)*dt*cos(x)",
        "sqrt(x^2 + y^2) * atan2(y, x)",
        "max(x, 0)^2 + min(y, x*y)",
        "tanh(x*y) - erf(x - y) * ln(1 + y^2)",
        "-(x*exp(-y^2)) / (2 + sin(x))",
        "wrap(x + y) * floor(y)",
        "if(x > y, x^2, sin(y)) * (x <= 0.1)",
        "if(x > 0, sqrt(x)*y, 0) + if(y <= 0, 0, ln(y))",
        "if(x > 0 and y > 0 or x < -1 and not y >= 0.5, x*y, x - y)",
        "y * table('ocv.csv', 0.5 + x/3)",
        "table('ocv.csv', x^2) / table('ocv.csv', 0.1*y)",
        "if(floor(x) == 0, x, if(floor(y) != 1, y, x*y))",
        "asin(0.9*sin(x)) + acos(x/30) + lgamma(abs(y))",
    ] {
        let checked = Traced::parsed(text).check_at_random_points(text);
        assert!(checked >= 60, "{text}: {checked} points of 400 in its domain");
    }
}
