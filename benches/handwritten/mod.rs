//! The ceiling: what an expert gets by writing each filter out by hand. Symmetric, sparse, straight-line, a block of
//! candidates at once as structure of arrays, so that the compiler vectorises the loop over candidates; compiled for
//! every instruction set. Constant velocity is split into one 2-state filter per axis. States are absolute and sums of
//! 32 steps are in the number format itself, so f32 shows speed, not the accuracy that kfgpu promises.

mod axis;
mod real;
mod rocket;

use axis::Axis;
pub(crate) use real::Real;
use rocket::Rocket;
use std::array::from_fn;

/// What one candidate sums over the log (and over its axes).
#[derive(Clone, Copy, Default)]
pub(crate) struct Sums {
    /// Sum of squared joint innovations.
    pub(crate) squares: f64,
    /// Sum of NIS.
    pub(crate) nis: f64,
    /// Sum of ln det S.
    pub(crate) log_det: f64,
}

impl Sums {
    fn plus(self, other: Self) -> Self {
        Self { squares: self.squares + other.squares, nis: self.nis + other.nis, log_det: self.log_det + other.log_det }
    }

    /// Log-likelihood \[nats\], mean squared innovation, sum of NIS / rows.
    #[allow(dead_code, reason = "the benchmarks time the sums; the golden tests compare the scores")]
    pub(crate) fn score(self, rows: usize, measurements: usize) -> [f64; 3] {
        let components = (rows * measurements) as f64;
        let log_likelihood = -0.5 * (components * std::f64::consts::TAU.ln() + self.log_det + self.nis);
        [log_likelihood, self.squares / components, self.nis / rows as f64]
    }
}

/// Steps between f64 sums.
const CHUNK: usize = 32;
/// Steps between renormalisations of the product of S, whose factors may be as large as 1e9.
const SPLIT: usize = 4;

/// The sums of the running chunk.
struct Running<T, const W: usize> {
    squares: [T; W],
    nis: [T; W],
    /// Product of S since the last renormalisation, and the exponents taken out of it.
    det: [T; W],
    exponent: [T; W],
}

impl<T: Real, const W: usize> Running<T, W> {
    #[inline(always)]
    fn new() -> Self {
        let zero = [T::of(0.0); W];
        Self { squares: zero, nis: zero, det: [T::of(1.0); W], exponent: zero }
    }

    #[inline(always)]
    fn split(&mut self) {
        for i in 0..W {
            let (mantissa, exponent) = self.det[i].split();
            self.det[i] = mantissa;
            self.exponent[i] = self.exponent[i] + exponent;
        }
    }

    /// Moves the chunk's sums to f64.
    #[inline(always)]
    fn flush(&mut self, sums: &mut [Sums; W]) {
        for (i, sums) in sums.iter_mut().enumerate() {
            sums.squares += self.squares[i].into();
            sums.nis += self.nis[i].into();
            sums.log_det += self.exponent[i].into() * std::f64::consts::LN_2;
        }
        let zero = [T::of(0.0); W];
        (self.squares, self.nis, self.exponent) = (zero, zero, zero);
    }
}

/// A hand-written filter over a block: `step` filters one measurement of every candidate.
trait Block<T, const W: usize> {
    fn step(&mut self, z: T, running: &mut Running<T, W>);
}

#[inline(always)]
fn run<T: Real, const W: usize>(z: &[T], mut filter: impl Block<T, W>) -> [Sums; W] {
    let mut sums = [Sums::default(); W];
    let mut running = Running::new();
    for chunk in z.chunks(CHUNK) {
        for group in chunk.chunks(SPLIT) {
            group.iter().for_each(|&z| filter.step(z, &mut running));
            running.split();
        }
        running.flush(&mut sums);
    }
    sums.iter_mut().zip(running.det).for_each(|(sums, det)| sums.log_det += det.into().ln());
    sums
}

#[multiversion::multiversion(targets = "simd")]
fn rocket<T: Real, const W: usize>(z: &[T], q: f64, r: [T; W]) -> [Sums; W] {
    run(z, Rocket::new(q, r))
}

#[multiversion::multiversion(targets = "simd")]
fn axis<T: Real, const W: usize>(z: &[T], dt: f64, q: [T; W], r: [T; W]) -> [Sums; W] {
    run(z, Axis::new(dt, q, r))
}

/// Which filter was written out.
#[derive(Clone, Copy)]
pub(crate) enum Filter {
    /// Workload A.
    Rocket,
    /// Workloads B and C.
    ConstantVelocity {
        /// Step.
        dt: f64,
    },
}

/// Sums of every candidate, blocks of `W` at a time; `z` and `candidates` are columns, the m variances r before the q.
pub(crate) fn score<T: Real, const W: usize>(filter: Filter, z: &[Vec<T>], candidates: &[Vec<T>]) -> Vec<Sums> {
    let n = candidates[0].len();
    let mut all = Vec::with_capacity(n);
    for start in (0..n).step_by(W) {
        // The last block is filled up with its last candidate.
        let lanes = |column: usize| from_fn::<T, W, _>(|i| candidates[column][(start + i).min(n - 1)]);
        let sums = match filter {
            Filter::Rocket => rocket(&z[0], 0.1, lanes(0)),
            Filter::ConstantVelocity { dt } => {
                let axes = (0..z.len()).map(|i| axis(&z[i], dt, lanes(z.len() + i), lanes(i)));
                axes.fold([Sums::default(); W], |total, axis| from_fn(|i| total[i].plus(axis[i])))
            }
        };
        all.extend_from_slice(&sums[..W.min(n - start)]);
    }
    all
}

/// The columns of rows, rounded to T.
pub(crate) fn columns<'a, T: Real>(rows: impl Iterator<Item = &'a [f64]>) -> Vec<Vec<T>> {
    let mut columns: Vec<Vec<T>> = Vec::new();
    for row in rows {
        columns.resize_with(row.len(), Vec::new);
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(T::of(*value)));
    }
    columns
}
