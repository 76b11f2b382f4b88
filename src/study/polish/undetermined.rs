//! Parameters that the rows do not determine stay at their start.

use super::{Place, Polish, Polished};
use crate::evaluate::{Evaluation, Population, Precision};
use crate::study::StudyError;

/// Nearer to its start than this share of a unit, a parameter at its optimum may cost the same within the resolution: there
/// only the same bits show that the cost does not depend on it.
const NEAR: f64 = 0.05;
/// Nearer still, they show nothing.
const AT_START: f64 = 1e-6;

/// Puts back to its start every parameter on which the cost does not depend: where it stands the same, within the
/// resolution of f64, with that parameter at its start; then all such together, or one after the other as far as the cost
/// stays.
pub(super) fn put_back(winner: Polished<'_>, place: &mut Place<'_>, polish: &mut Polish) -> Result<(), StudyError> {
    let Some(start) = place.coordinates.start().map(<[f64]>::to_vec) else { return Ok(()) };
    let Polished { candidate, verdict } = winner;
    let [from, to] = [&start, candidate].map(|point| place.coordinates.position(point));
    let units = place.coordinates.units(candidate);
    let by = |d: &usize| (to[*d] - from[*d]).abs() / units[*d];
    let moved: Vec<usize> = (0..start.len()).filter(|d| by(d) > AT_START).collect();
    if moved.is_empty() {
        return Ok(());
    }
    let mut batch = Population::new(start.len());
    batch.push(candidate);
    moved.iter().for_each(|d| batch.push(&put(candidate, &start, &[*d])));
    let costs = crate::study::evaluate(place.evaluator, &batch)?;
    polish.evaluations += batch.len();
    let same_bits = |i: usize| costs.costs(0)[0].to_bits() == costs.costs(i)[0].to_bits();
    let is_flat = |(d, i): &(&usize, usize)| place.same(&costs, 0, *i) && (by(d) > NEAR || same_bits(*i));
    let flat: Vec<usize> = moved.iter().zip(1..).filter(is_flat).map(|(d, _)| *d).collect();
    let Some(chosen) = jointly(candidate, &start, &flat, place, polish)? else { return Ok(()) };
    let restored = put(candidate, &start, &chosen);
    let Some(exact) = place.bounds.ask(place.oracle, &restored) else { return Ok(()) };
    let (old, new) = (verdict.objectives[0], exact.objectives[0]);
    if exact.violation <= verdict.violation && (new - old).abs() <= place.resolution(old) {
        *candidate = restored;
        *verdict = exact;
        polish.after.clone_from(&verdict.objectives);
        polish.left_at_start = chosen;
    }
    Ok(())
}

/// A candidate with some of its parameters at their start.
fn put(candidate: &[f64], start: &[f64], which: &[usize]) -> Vec<f64> {
    let mut moved = candidate.to_vec();
    which.iter().for_each(|d| moved[*d] = start[*d]);
    moved
}

/// Of the parameters that can be put back alone, those that can be together; `None` where there is none.
fn jointly(
    candidate: &[f64],
    start: &[f64],
    flat: &[usize],
    place: &mut Place<'_>,
    polish: &mut Polish,
) -> Result<Option<Vec<usize>>, StudyError> {
    let mut try_all = |which: &[usize]| -> Result<bool, StudyError> {
        let mut batch = Population::new(candidate.len());
        batch.push(candidate);
        batch.push(&put(candidate, start, which));
        let costs = crate::study::evaluate(place.evaluator, &batch)?;
        polish.evaluations += batch.len();
        Ok(place.same(&costs, 0, 1))
    };
    if flat.len() <= 1 || try_all(flat)? {
        return Ok((!flat.is_empty()).then(|| flat.to_vec()));
    }
    let mut kept = Vec::new();
    for d in flat {
        let with: Vec<usize> = kept.iter().chain([d]).copied().collect();
        if try_all(&with)? {
            kept = with;
        }
    }
    Ok((!kept.is_empty()).then_some(kept))
}

impl Place<'_> {
    /// Whether two candidates of a batch cost the same and violate as little.
    fn same(&self, costs: &Evaluation, a: usize, b: usize) -> bool {
        let (x, y) = (costs.costs(a)[0], costs.costs(b)[0]);
        costs.status(b).is_ok() && costs.violation(b) <= costs.violation(a) && (x - y).abs() <= self.resolution(x)
    }

    fn resolution(&self, cost: f64) -> f64 {
        self.kind(0).resolution(Precision::F64, cost, self.rows())
    }
}
