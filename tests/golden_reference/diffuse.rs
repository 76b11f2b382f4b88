//! What a diffuse P0 costs the oracle itself, against the same filter in 100-digit decimal arithmetic.

use kfgpu::objective::{Kind, Objective};
use nalgebra::{DMatrix, DVector};

use super::support::{Linear, close, cost, log, matrix, scalars};

/// Rows of the log.
const ROWS: u32 = 60;

/// (P0, nll, error allowed). Python 3 `decimal` at 100 digits, the covariance recursion written out for two states with
/// F = [1 1; 0 1], H = [1 0], Q = 0.01 [1/4 1/2; 1/2 1], R = 1, x0 = 0, P0 = diag(p, p) and
/// z_k = 5 k + ((7 k) mod 11 - 5) / 4. Measured: at most 6e-14.
const DIFFUSE: [(f64, f64, f64); 4] = [
    (1e0, 101.057_938_584_555_8, 1e-12),
    (1e4, 97.684_226_764_314_4, 1e-12),
    (1e8, 106.893_255_095_982_73, 1e-12),
    (1e12, 116.103_595_336_754_24, 1e-12),
];

fn measurement(k: u32) -> f64 {
    5.0 * f64::from(k) + (f64::from((7 * k) % 11) - 5.0) / 4.0
}

#[test]
fn nll_of_a_diffuse_start() {
    let z: Vec<f64> = (0..ROWS).map(measurement).collect();
    let log = log(vec![scalars(&z)]);
    for (p0, expected, tolerance) in DIFFUSE {
        let model = Linear {
            f: matrix([[1.0, 1.0], [0.0, 1.0]]),
            b: DMatrix::zeros(2, 0),
            q: matrix([[0.0025, 0.005], [0.005, 0.01]]),
            h: matrix([[1.0, 0.0]]),
            start: Some(DVector::zeros(2)),
            p0: DMatrix::identity(2, 2) * p0,
            ..Linear::level(0.0, 1.0, 1.0)
        };
        let found = cost(&model.problem(), &log, Objective::new(Kind::Nll));
        println!("P0/R = {p0:.0e}: error of nll {:.1e}", found - expected);
        close(found, expected, tolerance);
    }
}
