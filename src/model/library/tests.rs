//! Built-in models against the textbook's matrices, and Q against the integral it stands for.

use nalgebra::DMatrix;

use super::{ALL, BuiltIn, Keys, Motion, Noise};
use crate::model::error::Fault;
use crate::model::{Expr, Symbol};

mod singer;

const DT: f64 = 0.7;
const STRENGTHS: [f64; 2] = [1.3, 2.1];

fn evaluate(expr: &Expr, states: &[f64]) -> f64 {
    expr.evaluate(&|symbol| match symbol {
        Symbol::State(i) => states[i],
        Symbol::Parameter(i) => STRENGTHS[i],
        Symbol::Dt => DT,
        Symbol::Input(_) => f64::NAN,
    })
}

/// Keys of a model: those of `present` are parameters, in their order.
struct Given<'a> {
    axes: usize,
    noise: Noise,
    present: &'a [&'a str],
}

impl Keys for Given<'_> {
    fn axes(&self) -> usize {
        self.axes
    }
    fn has(&self, key: &str) -> bool {
        self.present.contains(&key)
    }
    fn noise(&self) -> Result<Noise, Fault> {
        Ok(self.noise)
    }
    fn strengths(&self, key: &'static str) -> Result<Vec<Expr>, Fault> {
        Ok(vec![self.strength(key)?; self.axes])
    }
    fn strength(&self, key: &'static str) -> Result<Expr, Fault> {
        let index = self.present.iter().position(|present| *present == key).unwrap();
        Ok(Expr::symbol(Symbol::Parameter(index)))
    }
    fn known(&self, key: &'static str, _: &'static str) -> Result<Expr, Fault> {
        self.strength(key)
    }
    fn refuse(&self, key: &'static str, problem: String) -> Fault {
        Fault::invalid(Default::default(), key, problem)
    }
}

fn model(name: &str) -> BuiltIn {
    *ALL.iter().find(|m| m.name == name).unwrap()
}

/// A model written out, with these keys.
fn motion(name: &str, noise: Noise, axes: usize, present: &[&str]) -> Motion {
    (model(name).read)(&Given { axes, noise, present }).unwrap_or_else(|fault| panic!("{name}: {}", fault.cause))
}

/// F and Q of one built-in model, linear as it is.
fn matrices(name: &str, noise: Noise, axes: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let keys = model(name).strengths;
    let present = if name == "singer" { &keys[..2] } else { keys };
    let motion = motion(name, noise, axes, present);
    let n = motion.f.len();
    let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<_>>();
    let f = DMatrix::from_fn(n, n, |i, j| evaluate(&motion.f[i], &unit(j)));
    (f, DMatrix::from_row_iterator(n, n, motion.q.iter().map(|q| evaluate(q, &unit(0)))))
}

/// Exact discretisation by Van Loan's method (doi:10.1109/TAC.1978.1101743): exp([[-A, W], [0, A']] dt).
fn van_loan(a: &DMatrix<f64>, w: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = a.nrows();
    let mut block = DMatrix::zeros(2 * n, 2 * n);
    block.view_mut((0, 0), (n, n)).copy_from(&-a);
    block.view_mut((0, n), (n, n)).copy_from(w);
    block.view_mut((n, n), (n, n)).copy_from(&a.transpose());
    let e = (block * DT).exp();
    let f = e.view((n, n), (n, n)).transpose();
    let q = &f * e.view((0, n), (n, n));
    (f, q)
}

#[test]
fn continuous_noise_is_the_exact_discretisation() {
    for (name, noise_on) in [
        ("local-level", vec![0.0_f64, 1.0]),
        ("random-walk", vec![0.0, 1.0]),
        ("constant-velocity", vec![0.0, 0.0, 1.0]),
        ("constant-acceleration", vec![0.0, 0.0, 0.0, 1.0]),
    ] {
        let n = noise_on.len() - 1;
        let a = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(j == i + 1)));
        let w = DMatrix::from_fn(n, n, |i, j| if i == n - 1 && j == n - 1 { STRENGTHS[0] } else { 0.0 });
        let (f, q) = van_loan(&a, &w);
        let (ours_f, ours_q) = matrices(name, Noise::Continuous, 1);
        assert!((f - ours_f).amax() < 1e-13, "{name}: F");
        assert!((q - ours_q).amax() < 1e-13, "{name}: Q");
    }
    let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
    let (f, q) = van_loan(&a, &DMatrix::from_diagonal(&STRENGTHS.to_vec().into()));
    let (ours_f, ours_q) = matrices("local-linear-trend", Noise::Continuous, 1);
    assert!((f - ours_f).amax() < 1e-13 && (q - ours_q).amax() < 1e-13, "local-linear-trend");
}

#[test]
fn piecewise_noise_is_the_gain_times_its_transpose() {
    for (name, gain) in
        [("constant-velocity", vec![DT * DT / 2.0, DT]), ("constant-acceleration", vec![DT * DT / 2.0, DT, 1.0])]
    {
        let g = DMatrix::from_column_slice(gain.len(), 1, &gain);
        let (_, q) = matrices(name, Noise::Piecewise, 1);
        assert!((&g * g.transpose() * STRENGTHS[0] - q).amax() < 1e-13, "{name}");
    }
    assert!((matrices("local-level", Noise::Piecewise, 1).1[(0, 0)] - STRENGTHS[0]).abs() < 1e-15, "per step");
    let (_, q) = matrices("local-linear-trend", Noise::Piecewise, 1);
    assert!((q - DMatrix::from_diagonal(&STRENGTHS.to_vec().into())).amax() < 1e-15, "per step");
}

#[test]
fn axes_do_not_mix_and_states_come_component_by_component() {
    let axes = ["x".to_owned(), "y".to_owned()];
    for model in ALL.iter().filter(|model| model.leading.is_none()) {
        let states = model.states(&axes, |_| false);
        let (depth, n) = (model.components.len(), states.len());
        assert_eq!(states[..2], axes, "{}: the positions come first", model.name);
        let (_, one) = matrices(model.name, Noise::Continuous, 1);
        let (_, two) = matrices(model.name, Noise::Continuous, 2);
        assert_eq!(n, 2 * depth);
        for i in 0..n {
            for j in 0..n {
                let expected = if i % 2 == j % 2 { one[(i / 2, j / 2)] } else { 0.0 };
                assert!((two[(i, j)] - expected).abs() < 1e-15, "{} [{i}, {j}]", model.name);
            }
        }
    }
    let states = |name: &str, key: &str| model(name).states(&axes, |has| has == key);
    assert_eq!(states("constant-velocity", ""), ["x", "y", "vx", "vy"]);
    assert_eq!(states("local-linear-trend", ""), ["x", "y", "slope_x", "slope_y"]);
    assert_eq!(states("coordinated-turn", ""), ["w", "x", "y", "vx", "vy"]);
    assert_eq!(states("coordinated-turn", "rate"), ["x", "y", "vx", "vy"]);
    assert_eq!(states("unicycle", "rate"), ["heading", "x", "y"]);
}

#[test]
fn a_turn_keeps_speed_and_goes_straight_at_rate_zero() {
    let estimated = motion("coordinated-turn", Noise::Continuous, 2, &["q", "q_rate"]);
    let known = motion("coordinated-turn", Noise::Continuous, 2, &["rate", "q"]);
    let step = |w: f64| -> Vec<f64> {
        let x = [w, 1.0, 2.0, 3.0, 4.0];
        estimated.f.iter().map(|f| evaluate(f, &x)).collect()
    };
    let straight = step(0.0);
    assert_eq!(straight, [0.0, 1.0 + 3.0 * DT, 2.0 + 4.0 * DT, 3.0, 4.0]);
    let w = STRENGTHS[0];
    let (s, c) = (w * DT).sin_cos();
    let turned = [
        w,
        1.0 + s / w * 3.0 - (1.0 - c) / w * 4.0,
        2.0 + (1.0 - c) / w * 3.0 + s / w * 4.0,
        c * 3.0 - s * 4.0,
        s * 3.0 + c * 4.0,
    ];
    for (found, expected) in step(w).iter().zip(turned) {
        assert!((found - expected).abs() < 1e-14, "{found}, not {expected}");
    }
    let fixed: Vec<f64> = known.f.iter().map(|f| evaluate(f, &[1.0, 2.0, 3.0, 4.0])).collect();
    assert_eq!(fixed, step(w)[1..], "a rate that is known turns alike");
    assert!(known.f.iter().all(Expr::is_affine) && !estimated.f.iter().all(Expr::is_affine));
    let (entries, n) = (|i: usize| evaluate(&estimated.q[i], &[]), 5);
    assert!((entries(0) - STRENGTHS[1] * DT).abs() < 1e-15 && entries(1).abs() < 1e-300, "the rate wanders by itself");
    for axis in [1, 2] {
        assert!((entries(axis * n + axis) - STRENGTHS[0] * DT.powi(3) / 3.0).abs() < 1e-15);
        assert!((entries(axis * n + axis + 2) - STRENGTHS[0] * DT * DT / 2.0).abs() < 1e-15);
        assert!((entries((axis + 2) * n + axis + 2) - STRENGTHS[0] * DT).abs() < 1e-15);
    }
}
