//! Built-in models against the textbook's matrices, and Q against the integral it stands for.

use nalgebra::DMatrix;

use super::{ALL, BuiltIn, Keys, Motion, Noise};
use crate::model::error::Fault;
use crate::model::{Expr, Symbol};

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

/// Rate; F13, F23, Q11, Q12, Q13, Q22, Q23, Q33.
const SINGER: [(f64, [f64; 8]); 10] = [
    (
        1e-12,
        [
            0.49999999999983336,
            0.9999999999995,
            9.999999999994444e-14,
            2.4999999999983334e-13,
            3.33333333333e-13,
            6.666666666661667e-13,
            9.99999999999e-13,
            1.999999999998e-12,
        ],
    ),
    (
        1e-05,
        [
            0.4999983333375,
            0.9999950000166666,
            9.999944444642858e-07,
            2.499983333402778e-06,
            3.333300000183333e-06,
            6.6666166668999996e-06,
            9.999900000583332e-06,
            1.999980000133333e-05,
        ],
    ),
    (
        0.01,
        [
            0.49833749168053576,
            0.9950166250831947,
            0.0009944642302896324,
            0.0024834025561444803,
            0.003300182613367077,
            0.0066168991691207485,
            0.009900580841919507,
            0.0198013266932447,
        ],
    ),
    (
        0.3,
        [
            0.45353578535242073,
            0.8639392643942738,
            0.02549371455705285,
            0.06170841257857111,
            0.0744159055215872,
            0.16068051814272258,
            0.22391731576863566,
            0.45118836390597356,
        ],
    ),
    (
        0.75,
        [
            0.39531831598402617,
            0.7035112630119804,
            0.05063168514694653,
            0.11720742821433476,
            0.12145779687119664,
            0.29570853478334047,
            0.3711960728885339,
            0.7768698398515702,
        ],
    ),
    (
        0.999,
        [
            0.36798310283623253,
            0.6323848802666037,
            0.05978218318833644,
            0.1352761524090083,
            0.12889291807093559,
            0.3360555688826584,
            0.39951072615301686,
            0.8643937753458103,
        ],
    ),
    (
        1.001,
        [
            0.36777582618050636,
            0.6318563979933132,
            0.05984501538470424,
            0.13539431738107677,
            0.12891863594052944,
            0.3363091446759286,
            0.3996417501927692,
            0.8649351168396509,
        ],
    ),
    (
        3.0,
        [
            0.22775411870754045,
            0.3167376438773787,
            0.07901328922727119,
            0.15561581576474526,
            0.07764431529068333,
            0.3551855023660877,
            0.3009682051469795,
            0.9975212478233336,
        ],
    ),
    (
        20.0,
        [
            0.047500000005152886,
            0.04999999989694232,
            0.028589583332302757,
            0.04512500000979048,
            0.002499999793884638,
            0.09250000002061154,
            0.049999999793884635,
            1.0,
        ],
    ),
    (500.0, [0.001996, 0.002, 0.0013253493493333333, 0.001992008, 4e-06, 0.003988, 0.002, 1.0]),
];

/// F and Q of a singer model for a step of 1 at rate u, q = 1: what mpmath says with 60 digits of the integrals of the
/// responses' products.
#[test]
fn singer_has_all_digits_at_any_rate() {
    let motion = motion("singer", Noise::Continuous, 1, &["q", "alpha"]);
    for (u, expected) in SINGER {
        let value = |formula: &Expr, x: [f64; 3]| {
            formula.evaluate(&|symbol| match symbol {
                Symbol::State(i) => x[i],
                Symbol::Parameter(i) => [1.0, u][i],
                Symbol::Dt => 1.0,
                Symbol::Input(_) => f64::NAN,
            })
        };
        let found = [
            value(&motion.f[0], [0.0, 0.0, 1.0]),
            value(&motion.f[1], [0.0, 0.0, 1.0]),
            value(&motion.q[0], [0.0; 3]),
            value(&motion.q[1], [0.0; 3]),
            value(&motion.q[2], [0.0; 3]),
            value(&motion.q[4], [0.0; 3]),
            value(&motion.q[5], [0.0; 3]),
            value(&motion.q[8], [0.0; 3]),
        ];
        for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
            let error = (found / expected - 1.0).abs();
            assert!(error < 5e-14, "u = {u}, entry {i}: {found:e}, expected {expected:e}, off by {error:e}");
        }
    }
}

#[test]
fn singer_is_the_exact_discretisation() {
    let alpha = STRENGTHS[1];
    let a = DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -alpha]);
    let w = DMatrix::from_diagonal(&vec![0.0, 0.0, 2.0 * alpha * STRENGTHS[0]].into());
    let (f, q) = van_loan(&a, &w);
    let (ours_f, ours_q) = matrices("singer", Noise::Continuous, 1);
    assert!((f - ours_f).amax() < 1e-13 && (q - ours_q).amax() < 1e-13, "alpha dt = 1.47");
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
