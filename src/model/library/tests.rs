//! Built-in models against the textbook's matrices, and Q against the integral it stands for.

use nalgebra::DMatrix;

use super::{ALL, Noise};
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

/// F and Q of one built-in model.
fn matrices(name: &str, noise: Noise, axes: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let model = ALL.iter().find(|m| m.name == name).unwrap();
    let strengths: Vec<Expr> = (0..model.strengths.len()).map(|i| Expr::symbol(Symbol::Parameter(i))).collect();
    let motion = model.expand(noise, &vec![strengths; axes]);
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
    for model in &ALL {
        let states = model.states(&axes);
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
    assert_eq!(ALL[3].states(&axes), ["x", "y", "vx", "vy"]);
    assert_eq!(ALL[1].states(&axes), ["x", "y", "slope_x", "slope_y"]);
}
