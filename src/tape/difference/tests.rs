#![expect(clippy::cast_possible_truncation, reason = "f32 is what is measured")]

use super::super::calculator::Calculator;
use super::super::codes::Unary;
use super::super::functions::Function;
use super::super::lanes::{Register, run_apart};
use super::super::straight_line::{Output, Tape};
use super::*;
use proptest::prelude::*;

const LANES: usize = 64;
fn never(_: &Graph, _: Sum) -> bool {
    false
}

/// Uniform numbers in [0, 1): splitmix64.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / 2f64.powi(64)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Of either sign, 1e-7 to 1 of `size`, evenly on a logarithmic scale.
    fn delta(&mut self, size: f64) -> f64 {
        let sign = if self.next() < 0.5 { -1.0 } else { 1.0 };
        sign * size.abs() * 10f64.powf(self.between(-7.0, 0.0))
    }
}

/// A formula of up to two leaves that move: the bases are columns (in f64, rounded once), the deltas carried (in f32).
struct Differenced {
    graph: Graph,
    plain: Id,
    moved: Moved,
}

const LEAVES: [Leaf; 2] = [Leaf::Variable(0), Leaf::Variable(1)];

impl Differenced {
    fn of(build: impl Fn(&mut Graph, [Id; 2]) -> Id) -> Self {
        let mut g = Graph::default();
        let leaves = LEAVES.map(|leaf| g.leaf(leaf));
        let plain = build(&mut g, leaves);
        let moves = [0, 1].map(|i| {
            let (base, delta) = (g.leaf(Leaf::Column(i)), g.leaf(Leaf::Carried(i)));
            (Leaf::Variable(i), Moved::by(&mut g, base, delta))
        });
        let moved = g.difference(&[plain], &HashMap::from(moves), &mut never).roots[0];
        Self { graph: g, plain, moved }
    }

    /// The formula in f64.
    fn plain(&self) -> impl FnMut([f64; 2]) -> f64 + use<> {
        let mut calculator = Calculator::new(&self.graph, &[self.plain]);
        move |[a, b]| calculator.evaluate(|leaf| if leaf == LEAVES[0] { a } else { b }).next().unwrap()
    }

    /// The delta on the lanes of f32, for one base and many deltas.
    fn single(&mut self) -> impl FnMut([f64; 2], &[[f32; LANES]; 2]) -> Vec<f32> + use<> {
        let inputs = [0, 1].map(|i| self.graph.leaf(Leaf::Carried(i)));
        let tape = Tape::new(&self.graph, &inputs, &[Output { id: self.moved.delta, register: 2 }]).unwrap();
        let mut calculator = Calculator::new(&self.graph, &tape.scalars);
        move |bases, deltas| {
            let leaf = |leaf| match leaf {
                Leaf::Column(i) => bases[i as usize],
                _ => f64::NAN,
            };
            let scalars: Vec<f32> = calculator.evaluate(leaf).map(|value| value as f32).collect();
            let mut registers = vec![Register::<f32, LANES, 1>::splat(0.0); tape.registers.max(3)];
            for (register, values) in registers.iter_mut().zip(deltas) {
                register.lanes_mut().copy_from_slice(values);
            }
            run_apart(&tape.operations, &mut registers, &scalars);
            registers[2].lanes().to_vec()
        }
    }
}

/// Relative errors of the delta in f32 (median, 99.9 %) over bases and deltas drawn in ranges.
fn errors(case: &Case, plainly: bool) -> (f64, f64) {
    let mut differenced = Differenced::of(case.build);
    let (mut single, mut plain) = (differenced.single(), differenced.plain());
    let mut draws = Draws(7);
    let mut errors = Vec::new();
    for _ in 0..100 {
        let bases = case.ranges.map(|[low, high]| draws.between(low, high));
        let deltas =
            [0, 1].map(|i| [(); LANES].map(|()| if i < case.moving { draws.delta(bases[i]) as f32 } else { 0.0 }));
        let found = single(bases, &deltas);
        for lane in 0..LANES {
            let ends = [0, 1].map(|i| bases[i] + f64::from(deltas[i][lane]));
            let inside = (0..2).all(|i| (case.ranges[i][0]..=case.ranges[i][1]).contains(&ends[i]));
            let exact = plain(ends) - plain(bases);
            if !inside || exact.abs() < 1e-9 {
                continue;
            }
            let mut of = |values: [f64; 2]| plain(values.map(|v| f64::from(v as f32))) as f32;
            let found = if plainly { of(ends) - of(bases) } else { found[lane] };
            errors.push((f64::from(found) - exact).abs() / exact.abs());
        }
    }
    errors.sort_by(f64::total_cmp);
    assert!(errors.len() > 2000, "{}: {} draws", case.name, errors.len());
    (errors[errors.len() / 2], errors[errors.len() * 999 / 1000])
}

struct Case {
    name: &'static str,
    build: fn(&mut Graph, [Id; 2]) -> Id,
    ranges: [[f64; 2]; 2],
    /// How many of the two leaves move.
    moving: usize,
    /// Of the median and of 99.9 %, about twice what was measured.
    limits: [f64; 2],
}

const CASES: [Case; 30] = {
    const fn case(
        name: &'static str,
        build: fn(&mut Graph, [Id; 2]) -> Id,
        ranges: [[f64; 2]; 2],
        moving: usize,
        limits: [f64; 2],
    ) -> Case {
        Case { name, build, ranges, moving, limits }
    }
    const ANY: [f64; 2] = [-4.0, 4.0];
    const ABOVE: [f64; 2] = [0.1, 4.0];
    const NONE: [f64; 2] = [1.0, 2.0];
    use Binary::{Atan2, Divide, Max, Min, Multiply, Power};
    use Unary::{Abs, Cos, Exp, Expm1, Ln, Log1p, Positive, Sin, Sqrt};
    [
        case("a b", |g, [a, b]| g.simplified_pair(Multiply, a, b), [ANY, ANY], 2, [1e-7, 1e-5]),
        case("a b, b still", |g, [a, b]| g.mul(a, b), [ANY, ANY], 1, [1e-7, 2e-7]),
        case("a a", |g, [a, _]| g.mul(a, a), [ANY, NONE], 1, [1e-7, 1e-5]),
        case("a / b", |g, [a, b]| g.simplified_pair(Divide, a, b), [ANY, ABOVE], 2, [1e-7, 1e-5]),
        case("a / b, b still", |g, [a, b]| g.div(a, b), [ANY, ABOVE], 1, [1e-7, 2e-7]),
        case("sqrt", |g, [a, _]| g.unary(Sqrt, a), [ABOVE, NONE], 1, [1e-7, 3e-7]),
        case("exp", |g, [a, _]| g.unary(Exp, a), [ANY, NONE], 1, [1e-7, 4e-7]),
        case("expm1", |g, [a, _]| g.unary(Expm1, a), [ANY, NONE], 1, [1e-7, 4e-7]),
        case("ln", |g, [a, _]| g.unary(Ln, a), [ABOVE, NONE], 1, [1e-7, 1e-6]),
        case("log1p", |g, [a, _]| g.unary(Log1p, a), [ABOVE, NONE], 1, [1e-7, 1e-6]),
        case("sin", |g, [a, _]| g.unary(Sin, a), [ANY, NONE], 1, [1e-7, 6e-6]),
        case("cos", |g, [a, _]| g.unary(Cos, a), [ANY, NONE], 1, [1e-7, 6e-6]),
        case("tan", |g, [a, _]| g.call(Function::Tan, &[a]), [[-1.4, 1.4], NONE], 1, [1e-7, 1e-6]),
        case("atan", |g, [a, _]| g.call(Function::Atan, &[a]), [ANY, NONE], 1, [1e-7, 6e-7]),
        case("atan2", |g, [a, b]| g.binary(Atan2, a, b), [ANY, ABOVE], 2, [1e-7, 2e-5]),
        case("asin", |g, [a, _]| g.call(Function::Asin, &[a]), [[-0.95, 0.95], NONE], 1, [1e-7, 6e-7]),
        case("acos", |g, [a, _]| g.call(Function::Acos, &[a]), [[-0.95, 0.95], NONE], 1, [1e-7, 6e-7]),
        case("tanh", |g, [a, _]| g.call(Function::Tanh, &[a]), [[-2.0, 2.0], NONE], 1, [1e-7, 5e-7]),
        case("log10", |g, [a, _]| g.call(Function::Log10, &[a]), [ABOVE, NONE], 1, [1e-7, 4e-7]),
        case("sinc", |g, [a, _]| g.call(Function::Sinc, &[a]), [ANY, NONE], 1, [1e-7, 1e-6]),
        case("cosc", |g, [a, _]| g.call(Function::Cosc, &[a]), [ANY, NONE], 1, [2e-7, 2e-5]),
        case("wrap", |g, [a, _]| g.call(Function::Wrap, &[a]), [[4.0, 12.0], NONE], 1, [1e-7, 1e-6]),
        case("erf", |g, [a, _]| g.call(Function::Erf, &[a]), [[-2.5, 2.5], NONE], 1, [2e-7, 4e-6]),
        case("lgamma", |g, [a, _]| g.call(Function::Lgamma, &[a]), [[0.1, 20.0], NONE], 1, [2e-7, 1e-3]),
        case("abs", |g, [a, _]| g.unary(Abs, a), [ANY, NONE], 1, [1e-7, 1e-6]),
        case("positive", |g, [a, _]| g.unary(Positive, a), [ANY, NONE], 1, [1e-7, 1e-6]),
        case("min", |g, [a, b]| g.binary(Min, a, b), [ANY, ANY], 2, [1e-7, 1e-6]),
        case("max", |g, [a, b]| g.binary(Max, a, b), [ANY, ANY], 2, [1e-7, 1e-6]),
        case("a ^ b", |g, [a, b]| g.binary(Power, a, b), [ABOVE, ANY], 2, [1e-7, 4e-5]),
        case(
            "a ^ 7",
            |g, [a, _]| {
                let seven = g.constant(7.0);
                g.binary(Power, a, seven)
            },
            [ANY, NONE],
            1,
            [2e-7, 1e-5],
        ),
    ]
};

/// Every rule in f32 against differences in f64; what plain f32 differences lose shows that the measure sees it.
#[test]
fn deltas_keep_their_digits_in_single_precision() {
    let mut wrong = Vec::new();
    for case in &CASES {
        let (median, most) = errors(case, false);
        let (plain, _) = errors(case, true);
        let [median_limit, limit] = case.limits;
        println!("{}: {median:.1e} {most:.1e}, plainly {plain:.1e}", case.name);
        if !(median < median_limit && most < limit) {
            wrong.push(format!("{}: {median:.1e} (limit {median_limit:.1e}), {most:.1e} ({limit:.1e})", case.name));
        }
        assert!(plain > 20.0 * median, "{}: a plain difference has {plain:.1e}, this {median:.1e}", case.name);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_move_from_zero_is_substitution() {
    let mut g = Graph::default();
    let [x, v] = LEAVES.map(|leaf| g.leaf(leaf));
    let formula = |g: &mut Graph, x: Id, v: Id| {
        let (sin, product) = (g.unary(Unary::Sin, x), g.mul(x, v));
        let sum = g.add(sin, product);
        let root = g.unary(Unary::Sqrt, v);
        let chosen = g.select(x, root, sum);
        g.binary(Binary::Atan2, chosen, x)
    };
    let before = formula(&mut g, x, v);
    let (zero, new) = (g.constant(0.0), g.leaf(Leaf::Carried(3)));
    let moves = HashMap::from([(LEAVES[0], Moved::by(&mut g, zero, new))]);
    let found = g.difference(&[before], &moves, &mut never).roots[0];
    assert_eq!(found.value, formula(&mut g, new, v), "the same node");
}

#[test]
fn what_does_not_move_stays_the_node_it_is() {
    let mut g = Graph::default();
    let [x, v] = LEAVES.map(|leaf| g.leaf(leaf));
    let still = g.unary(Unary::Exp, v);
    let root = g.mul(x, still);
    let (base, delta) = (g.leaf(Leaf::Column(0)), g.leaf(Leaf::Carried(0)));
    let moves = HashMap::from([(LEAVES[0], Moved::by(&mut g, base, delta))]);
    let found = g.difference(&[still, root], &moves, &mut never).roots;
    assert_eq!(found[0], Moved::still(&mut g, still));
    assert_eq!(found[1].delta, g.mul(delta, still), "alpha b where b is still");
}

/// Sums that cancel take base + delta, the others the sum of their operands' values.
#[test]
fn the_caller_says_which_sums_cancel() {
    let mut g = Graph::default();
    let [x, c] = [g.leaf(LEAVES[0]), g.leaf(Leaf::Column(9))];
    let root = g.sub(x, c);
    let (base, delta) = (g.leaf(Leaf::Column(0)), g.leaf(Leaf::Carried(0)));
    let of_x = Moved::by(&mut g, base, delta);
    let moves = HashMap::from([(LEAVES[0], of_x)]);
    let own = g.sub(base, c);
    let mut asked = Vec::new();
    let found = g.difference(&[root], &moves, &mut |_, sum| {
        asked.push(sum);
        true
    });
    assert_eq!(asked, [Sum { operands: [base, c], base: own }]);
    assert_eq!(found.roots[0].value, g.add(own, delta), "base + delta");
    let found = g.difference(&[root], &moves, &mut never).roots;
    assert_eq!(found[0].value, g.sub(of_x.value, c), "value - c");
}

proptest! {
    /// Random formulas: base + delta is the value, whichever sums are called cancelling.
    #[test]
    fn random_formulas_end_where_they_should(
        ops in prop::collection::vec((0u8..14, any::<u8>(), any::<u8>()), 1..25),
        values in prop::array::uniform4(0.2f64..1.5),
        cancels in any::<u32>(),
    ) {
        let mut g = Graph::default();
        let mut built: Vec<Id> = LEAVES.map(|leaf| g.leaf(leaf)).to_vec();
        built.extend([g.leaf(Leaf::Column(5)), g.constant(0.5)]);
        for (op, a, b) in ops {
            let (a, b) = (built[a as usize % built.len()], built[b as usize % built.len()]);
            let id = match op {
                0 => g.add(a, b),
                1 => g.sub(a, b),
                2 => g.mul(a, b),
                3 => { let one = g.constant(1.0); let square = g.mul(b, b); let b = g.add(one, square); g.div(a, b) }
                4 => g.neg(a),
                5 => g.select(a, b, a),
                6 => g.unary(Unary::Abs, a),
                7 => g.unary(Unary::Positive, a),
                8 => g.binary(Binary::Min, a, b),
                9 => g.binary(Binary::Max, a, b),
                10 => g.call(Function::Atan, &[a]),
                11 => g.unary(Unary::Sin, a),
                12 => { let a = g.unary(Unary::Sin, a); g.unary(Unary::Exp, a) }
                _ => { let a = g.unary(Unary::Abs, a); let one = g.constant(1.0); let a = g.add(one, a); g.unary(Unary::Ln, a) }
            };
            built.push(id);
        }
        let moves = [0u32, 1].map(|i| {
            let (base, delta) = (g.leaf(Leaf::Column(i)), g.leaf(Leaf::Carried(i)));
            (Leaf::Variable(i), Moved::by(&mut g, base, delta))
        });
        let mut asked = 0u32;
        let found = g.difference(&built, &HashMap::from(moves), &mut |_, _| { asked += 1; cancels >> (asked % 32) & 1 == 1 }).roots;
        let leaf = |leaf| match leaf {
            Leaf::Variable(i) => values[i as usize] + values[2 + i as usize] - 0.8,
            Leaf::Column(5) => 0.3,
            Leaf::Column(i) => values[i as usize],
            Leaf::Carried(i) => values[2 + i as usize] - 0.8,
            _ => f64::NAN,
        };
        let of = |ids: Vec<Id>| -> Vec<f64> { Calculator::new(&g, &ids).evaluate(leaf).collect() };
        let [bases, deltas, ends] = [|m: &Moved| m.base, |m: &Moved| m.delta, |m: &Moved| m.value]
            .map(|part: fn(&Moved) -> Id| of(found.iter().map(part).collect()));
        let plain = of(built.clone());
        for k in (0..built.len()).filter(|k| plain[*k].abs() < 1e6) {
            let near = |found: f64| (found - plain[k]).abs() <= 1e-9 * plain[k].abs().max(bases[k].abs()).max(1.0);
            prop_assert!(near(ends[k]), "value {} against {}", ends[k], plain[k]);
            prop_assert!(near(bases[k] + deltas[k]), "{} + {} against {}", bases[k], deltas[k], plain[k]);
        }
    }
}

/// From the place that a first move ends at formulas move again, whichever way that place was found.
#[test]
fn a_centre_is_a_place_to_move_from() {
    let mut g = Graph::default();
    let [x, y] = LEAVES.map(|leaf| g.leaf(leaf));
    let c = g.leaf(Leaf::Column(9));
    let far = g.sub(x, c);
    let angle = g.binary(Binary::Atan2, y, far);
    let square = g.mul(far, far);
    let formulas = [angle, square];
    let starts = [0u32, 1].map(|i| (g.leaf(Leaf::Column(i)), g.leaf(Leaf::Carried(i))));
    let moves = [0usize, 1].map(|i| (LEAVES[i], Moved::by(&mut g, starts[i].0, starts[i].1)));
    let deltas = HashMap::from([0u32, 1].map(|i| (LEAVES[i as usize], g.leaf(Leaf::Carried(2 + i)))));
    let first = g.difference(&formulas, &HashMap::from(moves), &mut |_, _| true);
    let places = HashMap::from(moves.map(|(leaf, moved)| (leaf, moved.value)));
    let (_, plain) = g.centre(&formulas, &places);
    let moved = [&first.centre, &plain].map(|centre| g.difference_from(&formulas, centre, &deltas));
    let further = [0u32, 1].map(|i| {
        let (start, more) = (starts[i as usize], g.leaf(Leaf::Carried(2 + i)));
        let delta = g.add(start.1, more);
        (LEAVES[i as usize], Moved::by(&mut g, start.0, delta))
    });
    let ends = g.difference(&formulas, &HashMap::from(further), &mut never);
    let leaf = |leaf| match leaf {
        Leaf::Column(9) => 0.25,
        Leaf::Column(i) => [1.5, 0.75][i as usize],
        Leaf::Carried(i) => [0.125, -0.5, 1e-3, 2e-3][i as usize],
        _ => f64::NAN,
    };
    let value = |id: Id| Calculator::new(&g, &[id]).evaluate(leaf).next().unwrap();
    for k in 0..formulas.len() {
        let expected = value(ends.roots[k].value) - value(first.roots[k].value);
        for found in &moved {
            assert!((value(found[k]) - expected).abs() < 1e-15, "formula {k}: {} against {expected}", value(found[k]));
        }
    }
}

/// What moves nothing is taken where its leaves are, not where they are free.
#[test]
fn a_still_part_stands_at_the_base() {
    let mut g = Graph::default();
    let [x, y] = LEAVES.map(|leaf| g.leaf(leaf));
    let (q, sum) = (g.leaf(Leaf::Parameter(0)), g.add(x, y));
    let root = g.mul(q, sum);
    let [a, b] = [0, 1].map(|i| g.leaf(Leaf::Column(i)));
    let (base, delta) = (g.constant(2.0), g.leaf(Leaf::Carried(0)));
    let moves = HashMap::from([
        (LEAVES[0], Moved::still(&mut g, a)),
        (LEAVES[1], Moved::still(&mut g, b)),
        (Leaf::Parameter(0), Moved { base, delta, value: q }),
    ]);
    let found = g.difference(&[root], &moves, &mut never).roots[0];
    let sum = g.add(a, b);
    assert_eq!(found.delta, g.mul(delta, sum), "no free variable is left");
}
