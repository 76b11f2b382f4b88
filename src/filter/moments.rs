//! What the carried entries of a program say of the state: of one gaussian, or of a mixture of several.

use super::carry::Entry;
use super::covariance::Symmetric;
use super::form::Form;
use super::program::Program;

impl Program {
    /// The entries of x and P of each gaussian.
    pub(super) fn gaussians(&self) -> impl Iterator<Item = &[Entry]> {
        let n = self.units.states.len();
        self.entries.chunks(n + n * (n + 1) / 2).take(self.modes.max(1))
    }

    /// How much each gaussian counts; what is carried before a row are probabilities, up to rounding.
    fn weights(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let n = self.units.states.len();
        let probabilities = self.entries.iter().skip(self.modes * (n + n * (n + 1) / 2)).take(self.modes);
        let weights: Vec<f64> = probabilities.map(|entry| entry.value(&value)).collect();
        let all: f64 = weights.iter().sum();
        weights.into_iter().map(|weight| weight / all).collect()
    }

    /// The mean before a row in the units of the steps, from what its registers hold.
    pub(super) fn mean(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let n = self.units.states.len();
        let mean = |entries: &[Entry]| entries[..n].iter().map(|entry| entry.value(&value)).collect::<Vec<f64>>();
        let mut means = self.gaussians().map(mean);
        let mut sum = means.next().unwrap_or_default();
        let first = sum.clone();
        for (weight, mean) in self.weights(&value).into_iter().skip(1).zip(means) {
            sum.iter_mut().zip(mean.iter().zip(&first)).for_each(|(sum, (x, first))| *sum += weight * (x - first));
        }
        sum
    }

    /// The upper triangle of the covariance before a row in the units of the steps.
    pub(super) fn spread(&self, value: impl Fn(usize) -> f64) -> Vec<f64> {
        let n = self.units.states.len();
        let mut gaussians = self.gaussians();
        if self.modes == 0 {
            return gaussians.next().map(|entries| self.covariance(entries, &value)).unwrap_or_default();
        }
        let (mean, mut sum) = (self.mean(&value), vec![0.0; n * (n + 1) / 2]);
        for (weight, entries) in self.weights(&value).into_iter().zip(gaussians) {
            let d: Vec<f64> = entries[..n].iter().zip(&mean).map(|(entry, mean)| entry.value(&value) - mean).collect();
            let own = Symmetric::places(n).zip(self.covariance(entries, &value));
            sum.iter_mut().zip(own).for_each(|(sum, ((i, j), p))| *sum += weight * (p + d[i] * d[j]));
        }
        sum
    }

    /// The upper triangle of P of one gaussian.
    pub(super) fn covariance(&self, entries: &[Entry], value: impl Fn(usize) -> f64) -> Vec<f64> {
        let n = self.units.states.len();
        let mut carried = vec![0.0; n * n];
        let entries = Symmetric::places(n).zip(&entries[n..]);
        entries.for_each(|((i, j), entry)| carried[i * n + j] = entry.value(&value));
        // U has ones on its diagonal, where D stands in what is carried.
        let u = |i: usize, k: usize| if i == k { 1.0 } else { carried[i * n + k] };
        let p = |(i, j): (usize, usize)| match self.carrying.form {
            Form::Full => carried[i * n + j],
            Form::Factored => (j..n).map(|k| u(i, k) * carried[k * n + k] * u(j, k)).sum(),
            Form::Lower => (0..=i).map(|k| u(k, i) * carried[k * n + k] * u(k, j)).sum(),
        };
        Symmetric::places(n).map(p).collect()
    }
}
