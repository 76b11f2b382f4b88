//! What the study must reach. The numbers were set from an independent program before this one ran.

use super::super::protocol::Protocol as _;
use super::super::statistics::{count, mean, median};
use super::super::{Required, Target};
use super::{Bench, DataSet, Results, SWEEP};

/// Standard deviation of J at R = I over tracks.
const UNTUNED_SPREAD: f64 = 6.04;

/// What the median PIO/PSO must be at r = 0.2, 0.1, 0.05 and below: in the full study, and in a smaller one.
///
/// The latter are the 99 % intervals of a median over ten data sets, by resampling the 180 of seeds 1 to 6, where these
/// are wider. (Over thirty data sets the standard error is 0.037 at r = 0.2, 0.017 at 0.1 and 0.004 at 0.05; so of
/// seeds taken at random about one in fifteen would miss the upper limit at 0.1.)
const MEDIANS: [(f64, Required, Required); 4] = [
    (0.2, Required::Within(1.08, 1.35), Required::Within(1.08, 1.46)),
    (0.1, Required::Within(1.02, 1.10), Required::Within(1.02, 1.18)),
    (0.05, Required::AtMost(1.02), Required::AtMost(1.04)),
    (0.0, Required::AtMost(1.003), Required::AtMost(1.003)),
];

/// Largest J within half a per cent of the independent optimum.
const NEAR: f64 = 1.005;

impl Results {
    pub(super) fn targets(&self) -> Vec<Target> {
        let mut targets = self.exact_targets();
        targets.push(self.order_target());
        targets.extend(self.sweep_targets());
        targets.extend(self.optimum_targets());
        let held_out = median(&self.ratios(|set| set.held_out.pso, |set| set.held_out.untuned));
        targets.push(Target::new("held-out KF-PSO/KF, median over data sets", Required::Above(0.80), held_out));
        targets
    }

    fn exact_targets(&self) -> Vec<Target> {
        let error = |tracks: u64| 4.0 * UNTUNED_SPREAD / (tracks as f64).sqrt();
        let wider = error(self.plan.untuned) - error(Bench::FULL.untuned);
        let untuned = Required::Within(71.34 - 0.8, 71.34 + 0.8).widened(wider.max(0.0));
        let evaluations = |of: fn(&DataSet) -> u64| {
            let all = self.each(|set| of(set) as f64);
            if all.windows(2).all(|pair| pair[0].total_cmp(&pair[1]).is_eq()) { mean(&all) } else { f64::NAN }
        };
        vec![
            Target::new(
                format!("mean J at R = I over {} tracks", self.beside.untuned.len()),
                untuned,
                mean(&self.beside.untuned),
            ),
            Target::new(
                format!("largest relative gap of J to the eigenvector oracle over {} M", self.plan.matrices),
                Required::AtMost(1e-10),
                self.beside.oracle_gap,
            ),
            Target::new("evaluations of PIO", Required::Exactly(20_440), evaluations(|set| set.pio.evaluations)),
            Target::new("evaluations of PIO+", Required::Exactly(30_200), evaluations(|set| set.plus.evaluations)),
            Target::new("evaluations of PSO", Required::Exactly(30_200), evaluations(|set| set.pso.evaluations)),
        ]
    }

    fn order_target(&self) -> Target {
        let ordered = |set: &DataSet| f64::from(u8::from(set.pso.j < set.pio.j && set.pio.j < set.untuned));
        let name = format!("data sets of {} with PSO < PIO < KF", self.data_sets.len());
        Target::new(name, self.agreeing(29), self.each(ordered).iter().sum())
    }

    fn sweep_targets(&self) -> Vec<Target> {
        let required = |r: f64| {
            let row = MEDIANS.iter().find(|(from, ..)| r >= *from).unwrap_or(&MEDIANS[MEDIANS.len() - 1]);
            if self.is_full() { row.1 } else { row.2 }
        };
        let published = (0.2, median(&self.ratios(|set| set.pio.j, |set| set.pso.j)));
        let swept =
            SWEEP.iter().enumerate().map(|(i, r)| (*r, median(&self.ratios(|set| set.sweep[i].j, |set| set.pso.j))));
        std::iter::once(published)
            .chain(swept)
            .map(|(r, measured)| Target::new(format!("median PIO/PSO at r = {r}"), required(r), measured))
            .collect()
    }

    fn optimum_targets(&self) -> Vec<Target> {
        let near = |of: fn(&DataSet) -> f64| count(&self.ratios(of, |set| set.optimum), |ratio| ratio <= NEAR);
        let name = |who: &str| {
            format!("data sets of {} where {who} is within 0.5 % of the independent optimum", self.data_sets.len())
        };
        vec![
            Target::new(name("PSO"), self.agreeing(28), near(|set| set.pso.j)),
            Target::new(name("PIO+"), self.agreeing(28), near(|set| set.plus.j)),
        ]
    }
}
