//! Values from independent programs, copied from `golden_kf.json` with the program that made each.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::model::First;
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::{run, steady_gain};
use nalgebra::{DMatrix, DVector};

use super::support::{Linear, close, cost, log, matrix, scalars, vector};

/// Annual flow of the Nile at Aswan 1871-1970 [1e8 m^3]; Durbin and Koopman, public domain.
const NILE: [f64; 100] = [
    1120.0, 1160.0, 963.0, 1210.0, 1160.0, 1160.0, 813.0, 1230.0, 1370.0, 1140.0, 995.0, 935.0, 1110.0, 994.0, 1020.0,
    960.0, 1180.0, 799.0, 958.0, 1140.0, 1100.0, 1210.0, 1150.0, 1250.0, 1260.0, 1220.0, 1030.0, 1100.0, 774.0, 840.0,
    874.0, 694.0, 940.0, 833.0, 701.0, 916.0, 692.0, 1020.0, 1050.0, 969.0, 831.0, 726.0, 456.0, 824.0, 702.0, 1120.0,
    1100.0, 832.0, 764.0, 821.0, 768.0, 845.0, 864.0, 862.0, 698.0, 845.0, 744.0, 796.0, 1040.0, 759.0, 781.0, 865.0,
    845.0, 944.0, 984.0, 897.0, 822.0, 1010.0, 771.0, 676.0, 649.0, 846.0, 812.0, 742.0, 801.0, 1040.0, 860.0, 874.0,
    848.0, 890.0, 744.0, 749.0, 838.0, 1050.0, 918.0, 986.0, 797.0, 923.0, 975.0, 815.0, 1020.0, 906.0, 901.0, 1170.0,
    912.0, 746.0, 919.0, 718.0, 714.0, 740.0,
];

/// statsmodels 0.15.0: `UnobservedComponents(nile, "llevel")`, initialised at a1 = 0, P1 = 1e7, `.loglike`.
#[test]
fn nile_log_likelihood() {
    let problem = Linear::level(1469.1, 15099.0, 1e7).problem();
    close(cost(&problem, &log(vec![scalars(&NILE)]), Objective::new(Kind::Nll)), 641.585_578_459_4, 2e-10);
}

/// pykalman's robot data set (BSD-3): transition, and measurement with its offset.
const ROBOT_F: [[f64; 5]; 5] = [
    [0.904, -0.0342, -0.0095, 0.0318, 0.0485],
    [-0.0201, 0.9356, -0.0014, 0.0428, 0.0054],
    [-0.0931, -0.0525, 0.922, 0.0215, 0.1242],
    [-0.0245, -0.035, 0.0249, 1.0414, -0.0451],
    [-0.0775, -0.0462, -0.0194, 0.0386, 1.0371],
];
const ROBOT_H: [[f64; 5]; 2] =
    [[0.0859, -0.7423, 2.3505, 0.7481, 0.8886], [-1.4916, -1.0616, -0.6156, -0.1924, -0.7648]];
const ROBOT_OFFSET: [f64; 2] = [-2.1384, -0.8396];
/// Covariances after 50 EM steps, as shipped.
const ROBOT_Q: [[f64; 5]; 5] = [
    [5.547526296804944, -3.1547161065974128, -1.3089244262101078, -0.3141855744262965, 0.48590208439223953],
    [-3.154716106597407, 6.4760523318318395, 2.1353115678826, 0.050584236568464745, -0.5199543487820819],
    [-1.3089244262101065, 2.1353115678826033, 1.7948237210383353, -0.47934180744487526, -0.10150393127664929],
    [-0.31418557442630124, 0.05058423656847057, -0.4793418074448787, 5.554649540496965, -0.22780558722656316],
    [0.4859020843922388, -0.5199543487820805, -0.1015039312766473, -0.22780558722656896, 1.0883739352023791],
];
const ROBOT_R: [[f64; 2]; 2] = [[22.959994574496474, -9.552003090181442], [-9.552003090181433, 12.618484394448245]];

/// A log, and one reference state a row.
type Referenced = (Log, Vec<DVector<f64>>);

/// Columns by position: t, z0, z1, b0..b4, truth x 5, filtered states x 5.
fn robot() -> Referenced {
    let text = include_str!("../../examples/data/robot.csv");
    let mut trajectory = Trajectory {
        id: String::new(),
        time: Vec::new(),
        z: Table::new(2),
        u: Table::new(5),
        truth: Table::new(5),
        line: Vec::new(),
    };
    let mut filtered = Vec::new();
    for (line, text) in (1..).zip(text.lines()).skip(1) {
        let cells: Vec<f64> = text.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        trajectory.time.push(cells[0]);
        trajectory.z.push(&cells[1..3]);
        trajectory.u.push(&cells[3..8]);
        trajectory.truth.push(&cells[8..13]);
        filtered.push(DVector::from_column_slice(&cells[13..18]));
        trajectory.line.push(line);
    }
    (log(vec![trajectory]), filtered)
}

fn robot_model(q: DMatrix<f64>, r: DMatrix<f64>) -> Linear {
    Linear {
        f: matrix(ROBOT_F),
        b: DMatrix::identity(5, 5),
        q,
        h: matrix(ROBOT_H),
        d: DMatrix::zeros(2, 0),
        offset: DVector::from_column_slice(&ROBOT_OFFSET),
        r,
        start: Some(DVector::zeros(5)),
        p0: DMatrix::identity(5, 5),
        first: First::Update,
        drift: None,
    }
}

/// pykalman 0.11.2, `KalmanFilter(...).loglikelihood(z)`; the CSV has 10 digits, hence the tolerance.
#[test]
fn robot_log_likelihood() {
    let (log, _) = robot();
    let initial = robot_model(DMatrix::identity(5, 5) * 10.0, DMatrix::identity(2, 2) * 10.0).problem();
    close(cost(&initial, &log, Objective::new(Kind::Nll)), 3_373.013_527_43, 2e-7);
    let learned = robot_model(matrix(ROBOT_Q), matrix(ROBOT_R)).problem();
    close(cost(&learned, &log, Objective::new(Kind::Nll)), 3_189.452_517_86, 2e-7);
}

/// The states that ship with the data (MATLAB), which belong to the covariances after EM.
#[test]
fn robot_states() {
    let (log, filtered) = robot();
    let run = run(&robot_model(matrix(ROBOT_Q), matrix(ROBOT_R)).problem(), &log, &[]).expect("runs");
    let steps = run.trajectories[0].iter().zip(&filtered);
    let worst = steps.map(|(step, x)| (&step.posterior.x - x).amax()).fold(0.0, f64::max);
    assert!(worst < 1e-7, "largest difference from the shipped states is {worst:e}");
}

/// MATLAB's `kalman` documentation plant: w enters through B with variance 2.3, R = 1.
fn matlab_plant() -> Linear {
    let b = vector([-0.3832, 0.5919, 0.5191]);
    Linear {
        f: matrix([[1.1269, -0.4940, 0.1129], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        b: DMatrix::zeros(3, 0),
        q: &b * b.transpose() * 2.3,
        h: matrix([[1.0, 0.0, 0.0]]),
        d: DMatrix::zeros(1, 0),
        start: Some(DVector::zeros(3)),
        p0: DMatrix::identity(3, 3),
        ..Linear::level(0.0, 1.0, 1.0)
    }
}

/// scipy `linalg.solve_discrete_are(A.T, C.T, 2.3 * B @ B.T, 1)`; the documentation prints the gain 0.5345, 0.0101, -0.4776.
#[test]
fn matlab_steady_gain() {
    let problem = matlab_plant().problem();
    let steady = steady_gain(&problem, &[], 1.0).expect("the plant settles");
    let k = vector([0.534_537_544_168_050_3, 0.010_133_193_284_811_852, -0.477_567_888_177_984_2]);
    let p_prior = matrix([
        [1.148_400_988_029_504, 0.021_770_162_464_983_717, -1.026_007_322_812_744_9],
        [0.021_770_162_464_983_717, 1.340_332_447_168_049_8, 0.716_820_360_284_810_2],
        [-1.026_007_322_812_744_9, 0.716_820_360_284_810_2, 1.959_880_908_903_946],
    ]);
    let p_posterior = matrix([
        [0.534_537_544_168_050_4, 0.010_133_193_284_811_852, -0.477_567_888_177_984_23],
        [0.010_133_193_284_811_852, 1.340_111_845_903_950_3, 0.727_217_090_798_504_2],
        [-0.477_567_888_177_984_1, 0.727_217_090_798_504_2, 1.469_892_758_493_116],
    ]);
    assert!((&steady.k - k).amax() < 1e-12, "gain {}", steady.k);
    assert!((&steady.p_prior - &p_prior).amax() < 1e-12, "prior {}", steady.p_prior);
    assert!((&steady.p_posterior - p_posterior).amax() < 1e-12, "posterior {}", steady.p_posterior);

    let run = run(&problem, &log(vec![scalars(&[0.0; 200])]), &[]).expect("runs");
    let last = &run.trajectories[0][199].prior.p;
    assert!((last - p_prior).amax() < 1e-12, "the recursion itself settles there too, found {last}");
}

/// Local level: P = (q + sqrt(q^2 + 4 q r)) / 2 before the measurement solves the scalar Riccati equation.
#[test]
fn scalar_steady_gain() {
    for (q, r) in [(1.0, 1.0), (1469.1, 15099.0), (1e-6, 1e3), (1e6, 1e-3)] {
        let p = 0.5 * (q + f64::sqrt(q * q + 4.0 * q * r));
        let steady = steady_gain(&Linear::level(q, r, 1.0).problem(), &[], 1.0).expect("settles");
        close(steady.p_prior[(0, 0)] / p, 1.0, 1e-11);
        close(steady.k[(0, 0)] / (p / (p + r)), 1.0, 1e-11);
        close(steady.p_posterior[(0, 0)] / (p * r / (p + r)), 1.0, 1e-11);
    }
}

#[test]
fn no_steady_state_is_none() {
    let none = |model: Linear| steady_gain(&model.problem(), &[], 1.0).is_none();
    let growing = Linear { f: matrix([[2.0]]), ..Linear::level(1.0, 1.0, 1.0) };
    assert!(none(Linear { h: matrix([[0.0]]), ..growing.clone() }), "an unstable state that is not measured");
    assert!(none(Linear { q: matrix([[0.0]]), ..growing }), "an unstable state without process noise");
    assert!(none(Linear::level(0.0, 1.0, 1.0)), "a constant: the gain falls as 1 / k for ever");
    assert!(none(Linear::level(1.0, 0.0, 1.0)), "a singular R");
}
