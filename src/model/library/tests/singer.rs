//! Singer's F and Q against integrals in 60 digits, and against Van Loan's.

use nalgebra::DMatrix;

use super::{STRENGTHS, matrices, motion, van_loan};
use crate::model::library::Noise;
use crate::model::{Expr, Symbol};

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
