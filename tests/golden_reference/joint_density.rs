//! The filter's log-likelihood is the joint Gaussian log-density of all measurements, which needs no filter:
//! every state and measurement is an affine map of independent noises, so the mean and covariance of the stacked
//! measurements come from one block matrix, and the density from an LU factorisation of it.

use std::f64::consts::TAU;

use kfgpu::data::{Log, Split, Table, Trajectory};
use kfgpu::model::{First, SplitBy, ValidateSpec};
use kfgpu::objective::{Kind, Objective};
use kfgpu::reference::costs_held_out;
use nalgebra::{DMatrix, DVector};

use super::support::{Linear, cost, log};

/// SplitMix64, enough for test cases.
struct Draws(u64);

impl Draws {
    /// Uniform in -1..1.
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let top = u32::try_from((z ^ (z >> 31)) >> 32).expect("32 bits");
        f64::from(top) / 2f64.powi(31) - 1.0
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.number())
    }

    fn covariance(&mut self, size: usize) -> DMatrix<f64> {
        let m = self.matrix(size, size);
        &m * m.transpose() + DMatrix::identity(size, size) * 0.1
    }
}

/// A random model with inputs, irregular dt, correlated Q and R.
fn model(draws: &mut Draws, n: usize, m: usize, inputs: usize) -> Linear {
    Linear {
        f: draws.matrix(n, n) + DMatrix::identity(n, n),
        b: draws.matrix(n, inputs),
        q: draws.covariance(n),
        h: draws.matrix(m, n),
        d: draws.matrix(m, inputs),
        offset: draws.matrix(m, 1).column(0).into_owned(),
        r: draws.covariance(m),
        start: Some(draws.matrix(n, 1).column(0).into_owned()),
        p0: draws.covariance(n),
        first: First::Update,
        drift: Some(draws.matrix(n, n)),
    }
}

/// A random log of `rows` rows, about a third of the components missing.
fn draw_log(draws: &mut Draws, model: &Linear, rows: usize) -> Log {
    let (m, inputs) = (model.h.nrows(), model.b.ncols());
    let mut trajectory = Trajectory {
        id: String::new(),
        time: Vec::new(),
        z: Table::new(m),
        u: Table::new(inputs),
        truth: Table::new(0),
        line: Vec::new(),
    };
    let mut time = 0.0;
    for line in (2..).take(rows) {
        let z: Vec<f64> = (0..m).map(|_| if draws.number() < -0.3 { f64::NAN } else { 3.0 * draws.number() }).collect();
        let u: Vec<f64> = (0..inputs).map(|_| draws.number()).collect();
        trajectory.z.push(&z);
        trajectory.u.push(&u);
        trajectory.truth.push(&[]);
        trajectory.time.push(time);
        trajectory.line.push(line);
        time += 1.0 + 0.9 * draws.number();
    }
    log(vec![trajectory])
}

/// -ln N(z; mean, A A') of the present measurements, with one column of A per unit normal noise.
fn joint_nll(model: &Linear, log: &Log) -> f64 {
    let trajectory = &log.trajectories[0];
    let (m, n) = model.h.shape();
    let noises = n * trajectory.len() + m * trajectory.len();
    let lower = |p: &DMatrix<f64>| p.clone().cholesky().expect("a covariance").unpack();
    let (q, r) = (lower(&model.q), lower(&model.r));
    let drift = model.drift.clone().expect("the random models have one");

    let mut mean = model.start.clone().expect("the random models have one");
    let mut map = DMatrix::zeros(n, noises);
    map.columns_mut(0, n).copy_from(&lower(&model.p0));
    let (mut values, mut rows) = (Vec::new(), Vec::new());
    for k in 0..trajectory.len() {
        let u = DVector::from_column_slice(trajectory.u.row(k));
        let expected = &model.h * &mean + &model.d * &u + &model.offset;
        let mut measured = &model.h * &map;
        measured.columns_mut(n * trajectory.len() + m * k, m).copy_from(&r);
        for (i, z) in trajectory.z.row(k).iter().enumerate().filter(|(_, z)| !z.is_nan()) {
            values.push(z - expected[i]);
            rows.push(measured.row(i).into_owned());
        }
        if let Some(dt) = trajectory.dt(k) {
            let f = &model.f + dt * &drift;
            mean = &f * mean + &model.b * u;
            map = f * map;
            map.columns_mut(n * (k + 1), n).copy_from(&(dt.sqrt() * &q));
        }
    }
    if rows.is_empty() {
        return 0.0;
    }
    let (error, a) = (DVector::from_vec(values), DMatrix::from_rows(&rows));
    let lu = (&a * a.transpose()).lu();
    let quadratic = error.dot(&lu.solve(&error).expect("a covariance is invertible"));
    let components = u32::try_from(rows.len()).expect("a short log");
    0.5 * (f64::from(components) * TAU.ln() + lu.determinant().ln() + quadratic)
}

#[test]
fn nll_is_the_joint_log_density() {
    let mut worst = 0.0f64;
    for case in 0..300 {
        let mut draws = Draws(case);
        let pick = |case: u64, of: u64| usize::try_from(case % of).expect("small");
        let (n, m, inputs, rows) =
            (1 + pick(case, 3), 1 + pick(case / 3, 2), pick(case / 6, 3), 1 + pick(case / 18, 5));
        let model = model(&mut draws, n, m, inputs);
        let log = draw_log(&mut draws, &model, rows);
        let expected = joint_nll(&model, &log);
        let found = cost(&model.problem(), &log, Objective::new(Kind::Nll));
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error < 1e-9, "case {case}, n={n} m={m} T={rows}: filter {found}, joint density {expected}");
        worst = worst.max(error);
    }
    println!("largest relative error of nll over 300 random logs: {worst:.1e}");
}

/// -ln p(future | past) is the difference of two joint densities, of which the filter knows nothing.
#[test]
fn held_out_nll_is_that_of_the_future_given_the_past() {
    let mut worst = 0.0f64;
    let mut scored = 0;
    for case in 0..100 {
        let mut draws = Draws(1000 + case);
        let model = model(&mut draws, 2, 2, 1);
        let log = draw_log(&mut draws, &model, 7);
        let mut problem = model.problem();
        problem.data.file = Some("log.csv".into());
        problem.data.validate = Some(ValidateSpec { share: 0.4, by: Some(SplitBy::Time) });
        // Draws without a measurement in one of the parts are refused.
        let Ok(Split { train, held_out: Some(held_out) }) = Split::of(&problem, log.clone()) else { continue };
        assert_eq!((train.rows(), held_out.rows()), (4, 3), "0.4 of 7 rows is 2.8");
        let expected = joint_nll(&model, &log) - joint_nll(&model, &train);
        let found = costs_held_out(&problem, &held_out, &[]).expect("the run succeeds")[0];
        let error = (found - expected).abs() / expected.abs().max(1.0);
        assert!(error < 1e-9, "case {case}: filter {found}, conditional density {expected}");
        (worst, scored) = (worst.max(error), scored + 1);
    }
    assert!(scored > 80, "{scored} of 100 logs can be parted");
    println!("largest relative error of the held-out nll over {scored} random logs: {worst:.1e}");
}
