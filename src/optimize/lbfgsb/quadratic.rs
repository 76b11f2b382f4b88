//! The model of the cost: a quadratic with the compact limited-memory BFGS matrix, minimised in a box.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};

/// Pairs kept: R. H. Byrd et al. (1995) recommend 3 to 20.
const PAIRS: usize = 10;
/// A pair needs a curvature of this share of |s| |y|.
const CURVED: f64 = 1e-10;

/// The last moves s and the changes y of the gradient along them, in search coordinates.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    pairs: VecDeque<(Vec<f64>, Vec<f64>)>,
}

impl Memory {
    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Keeps a pair if the gradient grew along the move: else no positive definite matrix has it.
    pub(super) fn add(&mut self, s: Vec<f64>, y: Vec<f64>) {
        let size = dot(&s, &s).sqrt() * dot(&y, &y).sqrt();
        if dot(&s, &y) > CURVED * size {
            self.pairs.push_back((s, y));
            if self.pairs.len() > PAIRS {
                self.pairs.pop_front();
            }
        }
    }

    /// The model in coordinates multiplied by `scale`: equation 3.2 of Byrd et al. (1995), B = theta I - W M W' with
    /// W = [Y, theta S].
    pub(super) fn quadratic(&self, scale: &[f64]) -> Quadratic {
        let (n, k) = (scale.len(), self.pairs.len());
        let plain = || Quadratic { theta: 1.0, w: DMatrix::zeros(n, 0), m: DMatrix::zeros(0, 0) };
        let Some(last) = k.checked_sub(1) else { return plain() };
        let s = DMatrix::from_fn(n, k, |i, j| self.pairs[j].0[i] * scale[i]);
        let y = DMatrix::from_fn(n, k, |i, j| self.pairs[j].1[i] / scale[i]);
        let theta = y.column(last).norm_squared() / s.column(last).dot(&y.column(last));
        let (sy, ss) = (s.tr_mul(&y), s.tr_mul(&s));
        let inverse = DMatrix::from_fn(2 * k, 2 * k, |i, j| match (i < k, j < k) {
            (true, true) => {
                if i == j {
                    -sy[(i, i)]
                } else {
                    0.0
                }
            }
            (false, true) => {
                if i - k > j {
                    sy[(i - k, j)]
                } else {
                    0.0
                }
            }
            (true, false) => {
                if j - k > i {
                    sy[(j - k, i)]
                } else {
                    0.0
                }
            }
            (false, false) => theta * ss[(i - k, j - k)],
        });
        let w = DMatrix::from_fn(n, 2 * k, |i, j| if j < k { y[(i, j)] } else { theta * s[(i, j - k)] });
        match inverse.try_inverse() {
            Some(m) if theta.is_finite() && m.iter().all(|x| x.is_finite()) => Quadratic { theta, w, m },
            _ => plain(),
        }
    }
}

/// g' z + z' B z / 2 for B = theta I - W M W'.
#[derive(Debug, Clone)]
pub(super) struct Quadratic {
    theta: f64,
    /// One row a coordinate.
    w: DMatrix<f64>,
    m: DMatrix<f64>,
}

impl Quadratic {
    /// A step within `room` (per coordinate, from <= 0 to >= 0), and how much it lowers the model: the minimum over the
    /// coordinates that are free at the generalised Cauchy point.
    pub(super) fn minimise(&self, gradient: &[f64], room: &[[f64; 2]]) -> (Vec<f64>, f64) {
        let cauchy = self.cauchy(gradient, room);
        let step = self.subspace(gradient, room, cauchy);
        let gain = -self.value(gradient, &step);
        (step, gain)
    }

    fn value(&self, gradient: &[f64], z: &[f64]) -> f64 {
        let wz = self.w.tr_mul(&DVector::from_column_slice(z));
        dot(gradient, z) + 0.5 * (self.theta * dot(z, z) - wz.dot(&(&self.m * &wz)))
    }

    fn row(&self, i: usize) -> DVector<f64> {
        self.w.row(i).transpose()
    }

    /// The first minimum of the model along the projected steepest descent: algorithm CP of Byrd et al. (1995).
    fn cauchy(&self, gradient: &[f64], room: &[[f64; 2]]) -> Vec<f64> {
        let end = |(g, [low, high]): (&f64, &[f64; 2])| match g {
            g if *g < 0.0 => high / -g,
            g if *g > 0.0 => -low / g,
            _ => f64::INFINITY,
        };
        let ends: Vec<f64> = gradient.iter().zip(room).map(end).collect();
        let mut d: Vec<f64> = gradient.iter().zip(&ends).map(|(g, end)| if *end > 0.0 { -g } else { 0.0 }).collect();
        let mut order: Vec<usize> = (0..d.len()).filter(|i| ends[*i] > 0.0 && ends[*i].is_finite()).collect();
        order.sort_by(|a, b| ends[*a].total_cmp(&ends[*b]));
        let mut p = self.w.tr_mul(&DVector::from_column_slice(&d));
        let mut c = DVector::zeros(p.len());
        let mut slope = -dot(&d, &d);
        let mut bend = -self.theta * slope - p.dot(&(&self.m * &p));
        let (mut z, mut t) = (vec![0.0; d.len()], 0.0);
        for b in order {
            if slope >= 0.0 || -slope < bend * (ends[b] - t) {
                break;
            }
            let (dt, g, w) = (ends[b] - t, gradient[b], self.row(b));
            t = ends[b];
            z[b] = if g < 0.0 { room[b][1] } else { room[b][0] };
            c += &p * dt;
            let (mc, mp, mw) = (&self.m * &c, &self.m * &p, &self.m * &w);
            slope += dt * bend + g * g + self.theta * g * z[b] - g * w.dot(&mc);
            bend -= self.theta * g * g + 2.0 * g * w.dot(&mp) + g * g * w.dot(&mw);
            p += w * g;
            d[b] = 0.0;
        }
        t += if slope < 0.0 && bend > 0.0 { -slope / bend } else { 0.0 };
        for ((z, d), [low, high]) in z.iter_mut().zip(&d).zip(room).filter(|((_, d), _)| **d != 0.0) {
            *z = (t * d).clamp(*low, *high);
        }
        z
    }

    /// From the Cauchy point on, the minimum over the coordinates that are free there (the direct primal method of Byrd et
    /// al., section 5.1), projected on the box; cut short instead where the projection would not go downhill
    /// (J. L. Morales, J. Nocedal, ACM Trans. Math. Softw. 38 (2011), doi 10.1145/2049662.2049669).
    fn subspace(&self, gradient: &[f64], room: &[[f64; 2]], cauchy: Vec<f64>) -> Vec<f64> {
        let free: Vec<usize> =
            (0..cauchy.len()).filter(|i| room[*i][0] < cauchy[*i] && cauchy[*i] < room[*i][1]).collect();
        if free.is_empty() {
            return cauchy;
        }
        let bent = &self.w * (&self.m * self.w.tr_mul(&DVector::from_column_slice(&cauchy)));
        let w = self.w.select_rows(&free);
        let rest =
            DVector::from_iterator(free.len(), free.iter().map(|&i| gradient[i] + self.theta * cauchy[i] - bent[i]));
        let mut newton = -&rest / self.theta;
        if w.ncols() > 0 {
            let inner = DMatrix::identity(w.ncols(), w.ncols()) - &self.m * w.tr_mul(&w) / self.theta;
            let corrected = inner.lu().solve(&(&self.m * w.tr_mul(&rest)));
            let Some(v) = corrected.filter(|v| v.iter().all(|x| x.is_finite())) else { return cauchy };
            newton -= w * v / (self.theta * self.theta);
        }
        let mut projected = cauchy.clone();
        free.iter().zip(&newton).for_each(|(&i, d)| projected[i] = (cauchy[i] + d).clamp(room[i][0], room[i][1]));
        if dot(gradient, &projected) < 0.0 && self.value(gradient, &projected) <= self.value(gradient, &cauchy) {
            return projected;
        }
        let fits = |(&i, d): (&usize, &f64)| {
            let limit = if *d > 0.0 { room[i][1] } else { room[i][0] };
            if *d == 0.0 { 1.0 } else { (limit - cauchy[i]) / d }
        };
        let share = free.iter().zip(&newton).map(fits).fold(1.0, f64::min);
        let mut short = cauchy;
        free.iter().zip(&newton).for_each(|(&i, d)| short[i] = (short[i] + share * d).clamp(room[i][0], room[i][1]));
        short
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
