//! After the search: the f64 oracle chooses the winner and certifies the search; a local search polishes it.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::archive::Scored;
use super::{Coordinates, Oracle, StudyError};
use crate::evaluate::Evaluator;
use crate::optimize::nelder_mead::{NelderMead, Options};
use crate::optimize::{Optimizer, Space};

/// Costs of search and oracle side by side, over the finalists.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// The winner before polish, by the oracle.
    pub objectives_f64: Vec<f64>,
    /// The same candidate as the search scored it.
    pub objectives_search: Vec<f64>,
    /// Largest |search - oracle| / max(|search|, |oracle|) over all finalists and objectives.
    pub largest_relative_gap: f64,
    /// Whether no two finalists change order between search and oracle. Costs that the oracle sets less than 1e-5 apart
    /// (relative), the accuracy promised of single precision, count as equal.
    pub order_held: bool,
    /// Finalists, at most [`super::FINALISTS`] and the user's start.
    pub finalists: usize,
    /// Finalists that the oracle could not score.
    pub refused: usize,
}

/// What the local search did.
#[derive(Debug, Clone, PartialEq)]
pub struct Polish {
    /// The winner's objectives before, by the oracle.
    pub before: Vec<f64>,
    /// And after; the same when nothing better was found.
    pub after: Vec<f64>,
    /// Evaluations, not counted among the search's.
    pub evaluations: usize,
}

/// Finalists closer than this to each other, relative, may change places.
const ORDER_TOLERANCE: f64 = 1e-5;

/// The first edges of the polishing simplex, as a share of `init`, lie in this range.
const EDGE_SHARE: [f64; 2] = [1e-4, 1e-2];

/// The oracle's finite costs of a candidate, if it has them.
pub(super) fn ask_oracle(oracle: &Oracle, candidate: &[f64]) -> Option<Vec<f64>> {
    oracle(candidate).filter(|costs| !costs.is_empty() && costs.iter().all(|c| c.is_finite()))
}

/// Re-scores the finalists (best first by the search): the winner by the oracle's first objective, with its oracle
/// costs, and the certificate; `None` if the oracle can score none.
pub(super) fn certify(finalists: &[Scored], oracle: &Oracle<'_>) -> Option<(Scored, Certificate)> {
    let scores: Vec<Option<Vec<f64>>> = finalists.par_iter().map(|f| ask_oracle(oracle, &f.candidate)).collect();
    let pairs: Vec<(&Scored, &Vec<f64>)> =
        finalists.iter().zip(&scores).filter_map(|(f, s)| Some((f, s.as_ref()?))).collect();
    let (search, exact) = pairs.iter().min_by(|a, b| a.1[0].total_cmp(&b.1[0]))?;
    let gaps = pairs.iter().flat_map(|(f, s)| f.costs.iter().zip(*s).map(|(a, b)| relative_gap(*a, *b)));
    let certificate = Certificate {
        objectives_f64: (*exact).clone(),
        objectives_search: search.costs.clone(),
        largest_relative_gap: gaps.fold(0.0, f64::max),
        order_held: pairs.len() == finalists.len() && order_held(&pairs),
        finalists: finalists.len(),
        refused: finalists.len() - pairs.len(),
    };
    Some((Scored { candidate: search.candidate.clone(), costs: (*exact).clone() }, certificate))
}

fn relative_gap(a: f64, b: f64) -> f64 {
    let scale = a.abs().max(b.abs());
    if scale > 0.0 { (a - b).abs() / scale } else { 0.0 }
}

fn order_held(pairs: &[(&Scored, &Vec<f64>)]) -> bool {
    pairs.iter().all(|(a, exact_a)| {
        pairs.iter().all(|(b, exact_b)| {
            let swapped = a.costs[0] < b.costs[0] && exact_a[0] > exact_b[0];
            !swapped || relative_gap(exact_a[0], exact_b[0]) < ORDER_TOLERANCE
        })
    })
}

/// Nelder-Mead from the winner, over at most 300 evaluations. Its best candidate replaces the winner only if the oracle
/// finds it better.
pub(super) fn polish(
    winner: &mut Scored,
    coordinates: &Coordinates,
    finalists: &[Scored],
    evaluator: &mut dyn Evaluator,
    oracle: &Oracle<'_>,
    interrupt: &AtomicBool,
) -> Result<Polish, StudyError> {
    let space = coordinates.space();
    let start = coordinates.position(&winner.candidate);
    let edges = edges(&space, &start, finalists.iter().map(|f| coordinates.position(&f.candidate)));
    // In two coordinates 300 evaluations converge even at four an iteration, with a quarter of the calls. In three they
    // no longer do: measured on the ellipsoid from 2e-2, 3e-11 at four an iteration against 7e-21 one at a time.
    let options = Options { speculative: space.dimension() <= 2, ..Options::default() };
    let mut search = NelderMead::new(&space, &start, &edges, options)?;
    let mut best = super::Archive::new(1);
    while !interrupt.load(Ordering::Relaxed) {
        let Some(positions) = search.ask() else { break };
        let candidates = coordinates.candidates(&positions);
        let costs = super::evaluate(evaluator, &candidates)?;
        best.add(&candidates, &costs);
        search.tell(&positions, &costs);
    }
    let before = winner.costs.clone();
    if let Some(found) = best.best() {
        let exact = ask_oracle(oracle, &found.candidate);
        if let Some(costs) = exact.filter(|costs| costs[0] < before[0]) {
            *winner = Scored { candidate: found.candidate.clone(), costs };
        }
    }
    Ok(Polish { before, after: winner.costs.clone(), evaluations: search.evaluations() })
}

/// As far as the finalists lie from the winner, within limits: a converged search needs a small simplex.
fn edges(space: &Space, start: &[f64], finalists: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let mut reach = vec![0.0_f64; start.len()];
    for position in finalists {
        for ((reach, x), start) in reach.iter_mut().zip(&position).zip(start) {
            *reach = reach.max((x - start).abs());
        }
    }
    let limited = |((reach, [low, high]), x): ((f64, &[f64; 2]), &f64)| {
        let width = if high > low { high - low } else { x.abs().max(1.0) };
        reach.max(EDGE_SHARE[0] * width).min(EDGE_SHARE[1] * width)
    };
    reach.into_iter().zip(&space.init).zip(start).map(limited).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finalists(costs: &[f64]) -> Vec<Scored> {
        costs.iter().enumerate().map(|(i, c)| Scored { candidate: vec![i as f64], costs: vec![*c] }).collect()
    }

    fn certificate(search: &[f64], exact: &'static [f64]) -> (Scored, Certificate) {
        let oracle = move |x: &[f64]| Some(vec![exact[x[0] as usize]]);
        certify(&finalists(search), &oracle).expect("scored")
    }

    #[test]
    fn the_oracle_chooses_and_the_gap_is_the_largest() {
        let (winner, certificate) = certificate(&[1.0, 1.5, 2.0], &[1.25, 1.0, 2.0]);
        assert_eq!((winner.candidate, winner.costs), (vec![1.0], vec![1.0]));
        assert_eq!((certificate.objectives_f64, certificate.objectives_search), (vec![1.0], vec![1.5]));
        assert!((certificate.largest_relative_gap - 1.0 / 3.0).abs() < 1e-15 && !certificate.order_held);
    }

    #[test]
    fn order_within_single_precision_is_held() {
        assert!(certificate(&[1.0, 1.000_001, 3.0], &[1.000_002, 1.000_001, 3.0]).1.order_held);
        assert!(!certificate(&[1.0, 1.000_001, 3.0], &[1.001, 1.000_001, 3.0]).1.order_held);
    }

    #[test]
    fn what_the_oracle_cannot_score_never_wins() {
        let oracle = |x: &[f64]| if x[0] < 1.0 { Some(vec![f64::NAN]) } else { Some(vec![x[0]]) };
        let (winner, certificate) = certify(&finalists(&[1.0, 2.0, 3.0]), &oracle).expect("two are scored");
        assert_eq!(winner.candidate, [1.0]);
        assert_eq!((certificate.refused, certificate.finalists, certificate.order_held), (1, 3, false));
        assert_eq!(certify(&finalists(&[1.0, 2.0]), &|_| None), None);
        assert_eq!(certify(&[], &|_| Some(vec![1.0])), None);
    }

    #[test]
    fn the_simplex_fits_the_finalists() {
        let space = Space::boxed(&[[0.0, 100.0], [0.0, 100.0], [0.0, 100.0]]);
        let found = edges(&space, &[50.0; 3], [vec![50.0, 49.5, 90.0]].into_iter());
        assert_eq!(found, [0.01, 0.5, 1.0]);
    }
}
