//! Predictions over several rows: the means of earlier rows' priors, carried along by f alone.

use super::error::TraceError;
use super::family::Family;
use super::memory::{Memo, Recall};
use super::row::Row;
use super::tracer::Tracer;
use crate::tape::Id;

/// What was predicted of this row's measurements some rows ago.
#[derive(Debug, Default)]
pub(super) struct Leads(Vec<(usize, Vec<Id>)>);

impl Leads {
    /// Traces the errors z - h(x) of each distance of `horizons` beyond 1, which is the innovation, and moves all predictions on to
    /// the next row.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    pub(super) fn trace(
        t: &mut Tracer<'_>,
        family: &dyn Family,
        row: &Row,
        prior: &[Id],
        recall: &mut Recall<'_>,
        horizons: impl IntoIterator<Item = usize>,
    ) -> Result<Self, TraceError> {
        let mut horizons: Vec<usize> = horizons.into_iter().filter(|ahead| *ahead > 1).collect();
        horizons.sort_unstable();
        horizons.dedup();
        let Some(most) = horizons.last() else { return Ok(Self::default()) };
        let n = t.problem.model.states.len();
        let mut state = prior[..n].to_vec();
        let mut errors = Vec::with_capacity(horizons.len());
        for rows in 1..*most {
            let next = family.advance(t, row, &state)?;
            let lead = |state: usize| Memo::Lead { state, rows };
            state = (0..n).filter_map(|i| recall.get(lead(i))).collect();
            next.into_iter().enumerate().for_each(|(i, next)| recall.set(lead(i), next));
            if horizons.contains(&(rows + 1)) {
                errors.push((rows + 1, family.residual(t, row, &state)?));
            }
        }
        Ok(Self(errors))
    }

    /// The errors of predictions made so many rows ago.
    pub(super) fn error(&self, ahead: usize) -> Option<&[Id]> {
        self.0.iter().find(|(rows, _)| *rows == ahead).map(|(_, error)| error.as_slice())
    }
}
