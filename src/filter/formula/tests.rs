//! Formulas on the graph against the tree: values, and derivatives by the graph, by dual numbers and by central differences.

use super::{Scope, trace};
use crate::model::{Expr, ExprKind, FormulaPlace, FormulaScope, Function, Names, Symbol, parse};
use crate::random::{Purpose, Stream};
use crate::reference;
use crate::tape::{Calculator, Graph, Leaf};

const LEAVES: [Leaf; 2] = [Leaf::Variable(0), Leaf::Variable(1)];

/// A formula of x and y, on the graph with its derivatives.
struct Traced {
    expr: Expr,
    calculator: Calculator,
}

impl Traced {
    fn of(expr: Expr) -> Self {
        let mut g = Graph::default();
        let states = LEAVES.map(|leaf| g.leaf(leaf));
        let dt = g.constant(0.5);
        let value = trace(&mut g, &expr, Scope { states: &states, parameters: &[], inputs: &[], dt });
        let slopes = LEAVES.map(|leaf| g.differentiate(value, leaf));
        let calculator = Calculator::new(&g, &[value, slopes[0], slopes[1]]);
        Self { expr, calculator }
    }

    fn parsed(text: &str) -> Self {
        let names = Names { states: vec!["x".to_owned(), "y".to_owned()], ..Names::default() };
        let scope = FormulaScope { names: &names, place: FormulaPlace::Transition, key: "f" };
        Self::of(parse(text, scope).unwrap_or_else(|fault| panic!("{text}: {}", fault.cause)))
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
        "asin(0.9*sin(x)) + acos(x/30) + lgamma(abs(y))",
    ] {
        let checked = Traced::parsed(text).check_at_random_points(text);
        assert!(checked >= 60, "{text}: {checked} points of 400 in its domain");
    }
}
