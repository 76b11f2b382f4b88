//! A program as whoever looks at one row of it needs it: cut to the rows up to there, and what its registers say of the state.

use super::carry::Entry;
use super::covariance::Symmetric;
use super::program::{Program, Span, Step};

impl Program {
    /// The same for the first `rows` rows of trajectory `t` alone, or as many as that has.
    ///
    /// # Panics
    /// If there is no such trajectory.
    #[must_use]
    pub fn cut(&self, t: usize, rows: usize) -> Self {
        let span = &self.spans[t];
        let rows = span.rows.start..span.rows.end.min(span.rows.start.saturating_add(rows));
        let mut after = span.before.clone();
        rows.clone().for_each(|row| after[self.kind(row)] += 1);
        let step = |(kind, step): (usize, &Step)| {
            let own = span.before[kind]..after[kind];
            let record = step.record[own.start * step.columns..own.end * step.columns].to_vec();
            Step { record: record.into(), rows: own.len(), ..step.clone() }
        };
        let kinds = self.kinds.get(rows.clone()).map_or_else(Vec::new, <[u8]>::to_vec);
        let before = vec![0; self.steps.len()];
        Self {
            steps: self.steps.iter().enumerate().map(step).collect(),
            kinds,
            spans: vec![Span { rows: 0..rows.len(), scalars: span.scalars.clone(), before }],
            ..self.clone()
        }
    }

    /// The prior of a row from what the registers hold before it, in the problem's own units: n states, then the upper
    /// triangle of P row by row, multiplied out where factors are carried. In the deviation form `nominal` holds the n
    /// states of the nominal at that row; else it is empty.
    #[must_use]
    pub fn prior(&self, registers: &[f64], nominal: &[f64]) -> Vec<f64> {
        let units = &self.units.states;
        let value = |register: usize| registers[register];
        let nominal = nominal.iter().copied().chain(std::iter::repeat(0.0));
        let x = self.mean(value).into_iter().zip(units).zip(nominal);
        let x = x.map(|((x, unit), nominal)| nominal + x * 2.0_f64.powi(*unit));
        let places = Symmetric::places(units.len()).zip(self.spread(value));
        x.chain(places.map(|((i, j), p)| p * 2.0_f64.powi(units[i]) * 2.0_f64.powi(units[j]))).collect()
    }

    /// The carried states with their standard deviations before a row, as its registers hold them.
    #[must_use]
    pub fn spreads(&self, registers: &[f64]) -> Vec<(usize, f64)> {
        let n = self.units.states.len();
        let of_gaussian = |entries: &[Entry]| {
            let places = Symmetric::places(n).zip(self.covariance(entries, |register| registers[register]));
            let variances = places.filter(|((i, j), _)| i == j).map(|(_, p)| p.max(0.0));
            let spread = |(entry, variance): (&Entry, f64)| match entry {
                Entry::Constant(_) => None,
                Entry::Carried(register) => Some((*register, variance.sqrt())),
            };
            entries.iter().zip(variances).filter_map(spread).collect::<Vec<_>>()
        };
        self.gaussians().flat_map(of_gaussian).collect()
    }
}
