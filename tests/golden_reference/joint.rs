//! A model and its log as one Gaussian, which needs no filter: every state and measurement is an affine map of
//! independent noises, so that means and covariances of all of them together come from one matrix.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::model::First;
use nalgebra::{DMatrix, DVector};

use super::support::{Linear, log};

/// SplitMix64, enough for test cases.
pub(crate) struct Draws(pub(crate) u64);

impl Draws {
    /// Uniform in -1..1.
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let top = u32::try_from((z ^ (z >> 31)) >> 32).expect("32 bits");
        f64::from(top) / 2f64.powi(31) - 1.0
    }

    pub(crate) fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.number())
    }

    pub(crate) fn covariance(&mut self, size: usize) -> DMatrix<f64> {
        let m = self.matrix(size, size);
        &m * m.transpose() + DMatrix::identity(size, size) * 0.1
    }
}

/// A random model with inputs, irregular dt, correlated Q and R.
pub(crate) fn model(draws: &mut Draws, n: usize, m: usize, inputs: usize) -> Linear {
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
pub(crate) fn draw_log(draws: &mut Draws, model: &Linear, rows: usize) -> Log {
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

/// mean + map w, with w independent unit normal noises.
pub(crate) struct Affine {
    pub(crate) mean: DVector<f64>,
    pub(crate) map: DMatrix<f64>,
}

/// All states of a trajectory, and all present measurements that update it, stacked.
pub(crate) struct Joint {
    /// Row of each state; with a start from a measurement the first is that measurement's.
    pub(crate) rows: Vec<usize>,
    pub(crate) states: Vec<Affine>,
    /// z - its mean, and its map.
    pub(crate) measured: Affine,
}

impl Joint {
    pub(crate) fn of(model: &Linear, trajectory: &Trajectory) -> Self {
        let (m, n) = model.h.shape();
        let noises = n * (trajectory.len() + 1) + m * trajectory.len();
        let r = root(&model.r);
        let from_measurement = model.start.is_none();
        let first = if from_measurement { (0..trajectory.len()).find(|k| trajectory.is_complete(*k)) } else { Some(0) };
        let first = first.expect("some row is complete");
        let mut state = Affine { mean: first_mean(model, trajectory, first), map: DMatrix::zeros(n, noises) };
        state.map.columns_mut(0, n).copy_from(&root(&model.p0));
        if let First::Predict { dt } = model.first {
            let u = DVector::zeros(model.b.ncols());
            state = step(model, &state, dt.expect("given"), &u, n * trajectory.len());
        }
        let (mut rows, mut states, mut values, mut maps) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for k in first..trajectory.len() {
            let u = DVector::from_column_slice(trajectory.u.row(k));
            let expected = &model.h * &state.mean + &model.d * &u + &model.offset;
            let mut map = &model.h * &state.map;
            map.columns_mut(n * (trajectory.len() + 1) + m * k, m).copy_from(&r);
            let taken = !(from_measurement && k == first);
            for (i, z) in trajectory.z.row(k).iter().enumerate().filter(|(_, z)| taken && !z.is_nan()) {
                values.push(z - expected[i]);
                maps.push(map.row(i).into_owned());
            }
            let next = trajectory.dt(k).map(|dt| step(model, &state, dt, &u, n * (k + 1)));
            rows.push(k);
            states.push(state);
            let Some(next) = next else { break };
            state = next;
        }
        let map = if maps.is_empty() { DMatrix::zeros(0, noises) } else { DMatrix::from_rows(&maps) };
        Self { rows, states, measured: Affine { mean: DVector::from_vec(values), map } }
    }

    /// Mean and covariance of state number `i` given all measurements.
    pub(crate) fn conditional(&self, i: usize) -> (DVector<f64>, DMatrix<f64>) {
        let (Affine { mean, map }, z) = (&self.states[i], &self.measured);
        if z.mean.is_empty() {
            return (mean.clone(), map * map.transpose());
        }
        let lu = (&z.map * z.map.transpose()).lu();
        let cross = map * z.map.transpose();
        let gain = lu.solve(&cross.transpose()).expect("a covariance is invertible").transpose();
        (mean + &gain * &z.mean, map * map.transpose() - gain * cross.transpose())
    }
}

fn first_mean(model: &Linear, trajectory: &Trajectory, row: usize) -> DVector<f64> {
    model.start.clone().unwrap_or_else(|| {
        let z = DVector::from_column_slice(trajectory.z.row(row));
        let u = DVector::from_column_slice(trajectory.u.row(row));
        let pinv = model.h.clone().pseudo_inverse(1e-12).expect("a positive cutoff");
        pinv * (z - &model.d * u - &model.offset)
    })
}

/// One transition; its noise takes the columns from `column` on.
fn step(model: &Linear, Affine { mean, map }: &Affine, dt: f64, u: &DVector<f64>, column: usize) -> Affine {
    let drift = model.drift.clone().expect("the random models have one");
    let f = &model.f + dt * drift;
    let mut next = Affine { mean: &f * mean + &model.b * u, map: f * map };
    next.map.columns_mut(column, model.q.nrows()).copy_from(&(dt.sqrt() * root(&model.q)));
    next
}

/// A with P = A A', also where P is singular.
fn root(p: &DMatrix<f64>) -> DMatrix<f64> {
    let parts = p.clone().symmetric_eigen();
    let roots = parts.eigenvalues.map(|value| value.max(0.0).sqrt());
    parts.eigenvectors * DMatrix::from_diagonal(&roots)
}
