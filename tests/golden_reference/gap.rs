//! What a long gap costs, in the oracle and in f64 lanes, against the same filter in 60-digit arithmetic.

use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population};
use kfgpu::model::Problem;
use kfgpu::reference;

use super::support::{log, trajectory};

/// (Gap in s, q, r, nll). mpmath at 60 digits, the covariance recursion written out for three states and one measurement:
/// t_k = (8 k + 3 k mod 5) / 1000, and the gap added from k = 30 on; z_k = ((7 k) mod 11 - 5) / 400 + k^2 / 20000.
const GAPS: [(f64, f64, f64, f64); 14] = [
    (5.0, 200.0, 9e-6, -50.808_834_159_646_11),
    (5.0, 100.0, 1e-6, 1_474.769_352_052_076),
    (5.0, 0.1, 0.01, -70.366_634_065_706_32),
    (60.0, 200.0, 9e-6, -39.783_560_566_207_5),
    (60.0, 100.0, 1e-6, 1_485.667_513_195_977_5),
    (60.0, 0.1, 0.01, -62.310_721_465_516_77),
    (600.0, 200.0, 9e-6, -29.433_375_577_094_41),
    (600.0, 100.0, 1e-6, 1_496.009_989_639_423_6),
    (600.0, 0.1, 0.01, -53.938_014_746_503_95),
    (3600.0, 200.0, 9e-6, -21.371_507_909_385_09),
    (3600.0, 100.0, 1e-6, 1_504.071_163_321_115_6),
    (3600.0, 0.1, 0.01, -46.878_197_837_098_9),
    (100_000.0, 200.0, 9e-6, -6.412_646_611_334_523),
    (100_000.0, 0.1, 0.01, -32.489_696_155_721_43),
];

const TRACKER: &str = "[data]\nfile = \"none.csv\"\nmeasurements = [\"z0\"]\n[model]\nkind = \"constant-acceleration\"\n\
                       axes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0, 0, 0]\nP0 = [0.01, 1, 10]\n[parameters]\n\
                       q = { min = 1e-4, max = 1e5, scale = \"log\", start = 0.1 }\n\
                       r = { min = 1e-10, max = 1, scale = \"log\", start = 0.01 }\n";

#[test]
fn nll_after_a_gap() {
    let problem = Problem::parse(TRACKER, "tracker.toml").unwrap_or_else(|error| panic!("{error}"));
    for (gap, q, r, expected) in GAPS {
        let rows: Vec<(f64, [f64; 1])> = (0..60_u32)
            .map(|k| {
                let time = f64::from(8 * k + 3 * k % 5) / 1000.0 + if k >= 30 { gap } else { 0.0 };
                (time, [f64::from((7 * k) % 11) / 400.0 - 0.0125 + f64::from(k * k) / 20_000.0])
            })
            .collect();
        let rows: Vec<(f64, &[f64])> = rows.iter().map(|(time, z)| (*time, &z[..])).collect();
        let log = log(vec![trajectory(&rows)]);
        let oracle = reference::costs(&problem, &log, &[q, r]).unwrap_or_else(|error| panic!("{error}"))[0];
        let mut lanes =
            CpuEvaluator::new(&problem, &log, CpuOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let lanes = lanes.evaluate(&Population::from_rows(2, vec![q, r])).costs(0)[0];
        let error = |found: f64| (found - expected).abs() / expected.abs();
        println!("{gap} s, q = {q}, r = {r}: oracle {:.1e}, lanes {:.1e}", error(oracle), error(lanes));
        assert!(
            error(oracle) < if gap > 3600.0 { 1e-10 } else { 1e-12 },
            "{gap} s, q = {q}, r = {r}: the oracle says {oracle}, not {expected}"
        );
        assert!(error(lanes) < 1e-10, "{gap} s, q = {q}, r = {r}: f64 lanes say {lanes}, not {expected}");
    }
}
