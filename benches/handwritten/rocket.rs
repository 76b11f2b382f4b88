//! Workload A by hand.

use super::{Block, Real, Running};

/// n = 3, m = 1: position, speed, acceleration with unit steps; Q = diag(0, 0, q).
pub(super) struct Rocket<T, const W: usize> {
    q: T,
    r: [T; W],
    x: [[T; W]; 3],
    /// Upper triangle by rows.
    p: [[T; W]; 6],
}

impl<T: Real, const W: usize> Rocket<T, W> {
    #[inline(always)]
    pub(super) fn new(q: f64, r: [T; W]) -> Self {
        let (zero, start) = ([T::of(0.0); W], [T::of(100.0); W]);
        Self { q: T::of(q), r, x: [zero; 3], p: [start, zero, zero, start, zero, start] }
    }
}

impl<T: Real, const W: usize> Block<T, W> for Rocket<T, W> {
    #[inline(always)]
    fn step(&mut self, z: T, running: &mut Running<T, W>) {
        let half = T::of(0.5);
        for i in 0..W {
            let [x0, x1, x2] = self.x.each_ref().map(|x| x[i]);
            let [p00, p01, p02, p11, p12, p22] = self.p.each_ref().map(|p| p[i]);
            let (x0, x1) = (x0 + x1 + half * x2, x1 + x2);
            let (a01, a02, a12) = (p01 + p11 + half * p12, p02 + p12 + half * p22, p12 + p22);
            let p00 = p00 + p01 + half * p02 + a01 + half * a02;
            let (p01, p02, p11, p12, p22) = (a01 + a02, a02, p11 + p12 + a12, a12, p22 + self.q);
            let innovation = z - x0;
            let s = p00 + self.r[i];
            let inverse = T::of(1.0) / s;
            let scaled = innovation * inverse;
            running.squares[i] = running.squares[i] + innovation * innovation;
            running.nis[i] = running.nis[i] + innovation * scaled;
            running.det[i] = running.det[i] * s;
            let (k0, k1, k2) = (p00 * inverse, p01 * inverse, p02 * inverse);
            self.x[0][i] = x0 + p00 * scaled;
            self.x[1][i] = x1 + p01 * scaled;
            self.x[2][i] = x2 + p02 * scaled;
            self.p[0][i] = p00 - k0 * p00;
            self.p[1][i] = p01 - k0 * p01;
            self.p[2][i] = p02 - k0 * p02;
            self.p[3][i] = p11 - k1 * p01;
            self.p[4][i] = p12 - k1 * p02;
            self.p[5][i] = p22 - k2 * p02;
        }
    }
}
