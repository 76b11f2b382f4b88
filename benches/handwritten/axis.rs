//! One axis of workloads B and C by hand.

use super::{Block, Real, Running};

/// n = 2, m = 1: one axis of a constant-velocity filter; Q = diag(0, q).
pub(super) struct Axis<T, const W: usize> {
    dt: T,
    q: [T; W],
    r: [T; W],
    x: [[T; W]; 2],
    p: [[T; W]; 3],
}

impl<T: Real, const W: usize> Axis<T, W> {
    #[inline(always)]
    pub(super) fn new(dt: f64, q: [T; W], r: [T; W]) -> Self {
        let zero = [T::of(0.0); W];
        Self { dt: T::of(dt), q, r, x: [zero; 2], p: [[T::of(1e4); W], zero, [T::of(1e3); W]] }
    }
}

impl<T: Real, const W: usize> Block<T, W> for Axis<T, W> {
    #[inline(always)]
    fn step(&mut self, z: T, running: &mut Running<T, W>) {
        for i in 0..W {
            let [x, v] = self.x.each_ref().map(|x| x[i]);
            let [p00, p01, p11] = self.p.each_ref().map(|p| p[i]);
            let x = x + self.dt * v;
            let a = p01 + self.dt * p11;
            let (p00, p01, p11) = (p00 + self.dt * (p01 + a), a, p11 + self.q[i]);
            let innovation = z - x;
            let s = p00 + self.r[i];
            let inverse = T::of(1.0) / s;
            let scaled = innovation * inverse;
            running.squares[i] = running.squares[i] + innovation * innovation;
            running.nis[i] = running.nis[i] + innovation * scaled;
            running.det[i] = running.det[i] * s;
            let (k0, k1) = (p00 * inverse, p01 * inverse);
            self.x[0][i] = x + p00 * scaled;
            self.x[1][i] = v + p01 * scaled;
            self.p[0][i] = p00 - k0 * p00;
            self.p[1][i] = p01 - k0 * p01;
            self.p[2][i] = p11 - k1 * p01;
        }
    }
}
