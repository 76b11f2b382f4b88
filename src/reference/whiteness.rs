//! `whiteness`: the autocorrelation of the innovations.

use std::collections::VecDeque;

use super::estimate::Update;

/// Sums of products of standardised innovations, row by row.
#[derive(Debug)]
pub(super) struct Whiteness {
    lags: usize,
    components: Vec<Component>,
}

#[derive(Debug, Clone, Default)]
struct Component {
    /// The latest values of the current trajectory, the last one first.
    latest: VecDeque<f64>,
    values: usize,
    power: f64,
    /// By lag.
    products: Vec<f64>,
    pairs: usize,
}

impl Whiteness {
    pub(super) const fn new(lags: usize) -> Self {
        Self { lags, components: Vec::new() }
    }

    pub(super) fn add(&mut self, update: &Update) {
        for (i, value) in standardised(update) {
            if self.components.len() <= i {
                self.components.resize(i + 1, Component { products: vec![0.0; self.lags], ..Component::default() });
            }
            let component = &mut self.components[i];
            component.values += 1;
            component.power += value * value;
            component.pairs += usize::from(!component.latest.is_empty());
            component.products.iter_mut().zip(&component.latest).for_each(|(sum, earlier)| *sum += value * earlier);
            component.latest.push_front(value);
            component.latest.truncate(self.lags);
        }
    }

    /// What comes next is of another trajectory.
    pub(super) fn close(&mut self) {
        self.components.iter_mut().for_each(|component| component.latest.clear());
    }

    /// The sum of squared autocorrelations; NaN where there is no pair.
    pub(super) fn cost(&self) -> f64 {
        let present = || self.components.iter().filter(|component| component.values > 0);
        let of = |c: &Component| c.products.iter().map(|product| (product / c.power).powi(2)).sum::<f64>();
        if present().any(|component| component.pairs > 0) { present().map(of).sum() } else { f64::NAN }
    }
}

/// nu / sqrt(S) of the present components, with their indices.
pub(crate) fn standardised(update: &Update) -> impl Iterator<Item = (usize, f64)> {
    update.present.iter().enumerate().map(|(at, i)| (*i, update.nu[at] / update.s[(at, at)].sqrt()))
}
