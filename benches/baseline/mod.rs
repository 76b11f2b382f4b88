//! The baseline every ratio is taken against: a textbook Kalman filter on nalgebra's static matrices, f64, one
//! candidate at a time. It is what a careful engineer would write in an afternoon: dimensions known at compile time,
//! nothing allocated in the time loop, scalar updates because R is diagonal. It shares no code with kfgpu. A joint
//! update with a closed-form inverse of S, and compiling it for wider instruction sets, were measured too: neither is
//! faster on all three workloads, and no difference exceeds a fifth.

use kfgpu::bench::Workload;
use nalgebra::{SMatrix, SVector};

/// The baseline of each workload.
#[expect(clippy::large_enum_variant, reason = "one is made a workload")]
pub(crate) enum Baseline {
    A(Linear<3, 1>),
    B(Linear<6, 3>),
    C(Linear<4, 2>),
}

impl Baseline {
    /// The filter of `workload` over the rows `z`.
    pub(crate) fn new(workload: Workload, z: &[Vec<f64>]) -> Self {
        match workload {
            Workload::A => Self::A(rocket(z)),
            Workload::B => Self::B(constant_velocity(4.0, z)),
            Workload::C => Self::C(constant_velocity(0.1, z)),
        }
    }

    /// Log-likelihood \[nats\], mean squared innovation per component and sum of NIS / rows of one candidate.
    pub(crate) fn score(&self, candidate: &[f64]) -> [f64; 3] {
        self.run(candidate, |score, _| score)
    }

    /// The last posterior state of one candidate.
    #[allow(dead_code, reason = "the benchmarks time the scores; the golden tests also compare the state")]
    pub(crate) fn last_state(&self, candidate: &[f64]) -> Vec<f64> {
        self.run(candidate, |_, x| x.to_vec())
    }

    fn run<T>(&self, c: &[f64], keep: impl Fn([f64; 3], &[f64]) -> T) -> T {
        match self {
            Self::A(filter) => {
                let (score, x) = filter.run(&[0.0, 0.0, 0.1].into(), &[c[0]].into());
                keep(score, x.as_slice())
            }
            Self::B(filter) => {
                let (score, x) = filter.run(&[0.0, 0.0, 0.0, c[3], c[4], c[5]].into(), &[c[0], c[1], c[2]].into());
                keep(score, x.as_slice())
            }
            Self::C(filter) => {
                let (score, x) = filter.run(&[0.0, 0.0, c[2], c[3]].into(), &[c[0], c[1]].into());
                keep(score, x.as_slice())
            }
        }
    }
}

/// x' = F x + w, z = H x + v with diagonal Q and R; x0 and P0 hold one step before the first row.
pub(crate) struct Linear<const N: usize, const M: usize> {
    f: SMatrix<f64, N, N>,
    h: SMatrix<f64, M, N>,
    p0: SVector<f64, N>,
    z: Vec<SVector<f64, M>>,
}

/// The rocket of workload A.
fn rocket(z: &[Vec<f64>]) -> Linear<3, 1> {
    Linear {
        f: SMatrix::<f64, 3, 3>::new(1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0),
        h: SMatrix::<f64, 1, 3>::new(1.0, 0.0, 0.0),
        p0: SVector::repeat(100.0),
        z: rows(z),
    }
}

/// The constant-velocity filters of workloads B and C: M positions, then M velocities (N = 2 M), steps of `dt`.
fn constant_velocity<const N: usize, const M: usize>(dt: f64, z: &[Vec<f64>]) -> Linear<N, M> {
    let mut f = SMatrix::<f64, N, N>::identity();
    (0..M).for_each(|i| f[(i, M + i)] = dt);
    let p0 = SVector::from_fn(|i, _| if i < M { 1e4 } else { 1e3 });
    Linear { f, h: SMatrix::identity(), p0, z: rows(z) }
}

fn rows<const M: usize>(z: &[Vec<f64>]) -> Vec<SVector<f64, M>> {
    z.iter().map(|row| SVector::from_column_slice(row)).collect()
}

impl<const N: usize, const M: usize> Linear<N, M> {
    /// Filters the whole log with the diagonals `q` and `r`: the scores and the last posterior state.
    fn run(&self, q: &SVector<f64, N>, r: &SVector<f64, M>) -> ([f64; 3], SVector<f64, N>) {
        let mut x = SVector::<f64, N>::zeros();
        let mut p = SMatrix::<f64, N, N>::from_diagonal(&self.p0);
        let (mut squares, mut nis, mut log_det) = (0.0, 0.0, 0.0);
        let f_transposed = self.f.transpose();
        for z in &self.z {
            x = self.f * x;
            p = self.f * p * f_transposed;
            (0..N).for_each(|i| p[(i, i)] += q[i]);
            squares += (z - self.h * x).norm_squared();
            let mut det = 1.0;
            for i in 0..M {
                let h = self.h.row(i);
                let ph = p * h.transpose();
                let s = (h * ph)[0] + r[i];
                let innovation = z[i] - (h * x)[0];
                let scaled = innovation / s;
                x += ph * scaled;
                p -= ph * (ph / s).transpose();
                nis += innovation * scaled;
                det *= s;
            }
            log_det += det.ln();
        }
        let rows = self.z.len() as f64;
        let components = rows * M as f64;
        let log_likelihood = -0.5 * (components * std::f64::consts::TAU.ln() + log_det + nis);
        ([log_likelihood, squares / components, nis / rows], x)
    }
}
