//! What sensors see of the states.
#![expect(non_snake_case, reason = "Kalman notation: H")]

use super::Survey;

/// What the baseline's H sees of the states: the norm of each of its rows in each used row of the log, or of one row for all
/// where H is constant.
pub(super) struct Sight {
    norms: Vec<f64>,
    /// The largest of each component.
    largest: Vec<f64>,
}

impl Sight {
    /// Share of a component's largest norm below which it sees nothing: as good as a missing measurement.
    const BLIND: f64 = 1e-3;

    pub(super) fn new(survey: &Survey<'_>) -> Self {
        let H = &survey.baseline().h.jacobian;
        let (m, n) = (H.len(), survey.t.problem.model.states.len());
        let mut entries = Vec::new();
        survey.t.over_rows(&H.concat(), |value| entries.push(value));
        let norms: Vec<f64> = entries.chunks(n).map(|row| row.iter().map(|h| h * h).sum::<f64>().sqrt()).collect();
        let mut largest = vec![0.0_f64; m];
        norms.chunks(m).for_each(|row| largest.iter_mut().zip(row).for_each(|(most, norm)| *most = most.max(*norm)));
        Self { norms, largest }
    }

    /// Whether component `i` sees something in a used row.
    pub(super) fn sees(&self, i: usize, row: usize) -> bool {
        let norm = self.norms.get(row * self.largest.len() + i);
        norm.is_none_or(|norm| *norm > Self::BLIND * self.largest[i])
    }
}
