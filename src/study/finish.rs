//! After the search: the f64 oracle chooses the winner and certifies the search.

use rayon::prelude::*;

use super::archive::Scored;
use super::{Amplification, Oracle};
use crate::evaluate::{Evaluator, Precision};
use crate::model::TuneSpec;
use crate::objective::{Constraint, Kind, Objective};

/// Costs of search and oracle side by side, over the finalists.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// The winner before polish, by the oracle.
    pub objectives_f64: Vec<f64>,
    /// The same candidate as the search scored it.
    pub objectives_search: Vec<f64>,
    /// Largest |search - oracle| over all finalists and objectives, relative to [`Kind::scale`].
    pub largest_relative_gap: f64,
    /// The same in units of what is promised of single precision, [`Kind::resolution`].
    pub largest_gap: f64,
    /// Whether no two finalists change order between search and oracle. Costs that the oracle sets less apart than single
    /// precision resolves, [`Kind::resolution`], count as equal.
    pub order_held: bool,
    /// How far the winner's filter carries a small change of its log, before polish; `None` where that was not asked for. From
    /// 1 on its costs depend on the last digits of the log, and single precision promises nothing.
    pub amplification: Option<f64>,
    /// Finalists left out of gaps and order because they amplify that much.
    pub amplified: usize,
    /// Finalists, at most [`super::FINALISTS`] and the user's start.
    pub finalists: usize,
    /// Finalists that the oracle could not score.
    pub refused: usize,
    /// Finalists that the oracle finds infeasible or, of a front, dominated by another.
    pub dropped: usize,
}

/// What the oracle says of a candidate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Verdict {
    pub(super) objectives: Vec<f64>,
    /// What the constraints bound.
    pub(super) constraints: Vec<f64>,
    pub(super) violation: f64,
}

/// The objectives and the constraints behind them, over a log of so many rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds<'a> {
    pub(super) objectives: usize,
    /// What they are; `nll` where there are fewer.
    pub(super) kinds: &'a [Objective],
    pub(super) constraints: &'a [Constraint],
    pub(super) rows: usize,
}

impl<'a> Bounds<'a> {
    pub(super) fn of(tune: &'a TuneSpec, evaluator: &dyn Evaluator) -> Self {
        let (objectives, rows) = (evaluator.objectives(), evaluator.rows());
        Self { objectives, kinds: &tune.objectives, constraints: &tune.constraints, rows }
    }

    /// What an objective is.
    pub(super) fn kind(&self, objective: usize) -> Kind {
        self.kinds.get(objective).map_or(Kind::Nll, |objective| objective.kind)
    }

    /// |a - b| in units of what single precision resolves of an objective.
    pub(super) fn apart(&self, objective: usize, a: f64, b: f64) -> f64 {
        let resolution = |value| self.kind(objective).resolution(Precision::F32, value, self.rows);
        let unit = resolution(a).max(resolution(b));
        if unit > 0.0 { (a - b).abs() / unit } else { 0.0 }
    }

    /// Number of values that an oracle gives.
    pub(super) const fn scorers(&self) -> usize {
        self.objectives + self.constraints.len()
    }

    /// The oracle's verdict, if all its values are there and finite.
    pub(super) fn ask(&self, oracle: &Oracle, candidate: &[f64]) -> Option<Verdict> {
        self.judge(oracle(candidate)?)
    }

    /// The verdict on an oracle's values.
    pub(super) fn judge(&self, mut objectives: Vec<f64>) -> Option<Verdict> {
        if objectives.len() != self.scorers() || !objectives.iter().all(|value| value.is_finite()) {
            return None;
        }
        let constraints = objectives.split_off(self.objectives);
        let violation = Constraint::total_violation(self.constraints, &constraints);
        Some(Verdict { objectives, constraints, violation })
    }
}

impl Verdict {
    /// Feasible before infeasible, then by violation, then by the first objective.
    pub(super) fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.violation.total_cmp(&other.violation).then(self.objectives[0].total_cmp(&other.objectives[0]))
    }
}

/// Finalists with what the oracle says of them.
pub(super) type Pairs<'a> = [(&'a Scored, &'a Verdict)];

/// Amplification from which a promise is none: a change of the log by a share of its standard deviations changes nll a row by as
/// much.
pub(super) const AMPLIFIED: f64 = 1.0;

/// Those whose costs rounding does not decide, and the amplification of one of them.
pub(super) fn steady<'a>(
    pairs: &Pairs<'a>,
    winner: &Scored,
    amplification: Option<&Amplification<'_>>,
) -> (Vec<(&'a Scored, &'a Verdict)>, Option<f64>) {
    let Some(amplification) = amplification else { return (pairs.to_vec(), None) };
    let found: Vec<f64> = pairs.par_iter().map(|(finalist, _)| amplification(&finalist.candidate)).collect();
    let of_winner = pairs.iter().position(|(finalist, _)| std::ptr::eq(*finalist, winner)).map(|i| found[i]);
    let steady = pairs.iter().zip(&found).filter(|(_, found)| **found < AMPLIFIED);
    (steady.map(|(pair, _)| *pair).collect(), of_winner)
}

impl Certificate {
    /// Whether the winner's costs are what single precision promises: it does not amplify the last digits of the log.
    #[must_use]
    pub fn promise_holds(&self) -> bool {
        self.amplification.is_none_or(|amplification| amplification < AMPLIFIED)
    }

    /// Of so many finalists, of which the oracle scored `pairs`; gaps and order are those of the steady ones. The winner is
    /// one of the pairs.
    pub(super) fn over(
        (finalists, pairs): (usize, &Pairs<'_>),
        (steady, amplification): (&Pairs<'_>, Option<f64>),
        (search, exact): (&Scored, &Verdict),
        bounds: Bounds<'_>,
    ) -> Self {
        let costs = || steady.iter().flat_map(|(f, v)| f.costs.iter().zip(&v.objectives).enumerate());
        let relative = costs().map(|(j, (a, b))| bounds.kind(j).gap(*a, *b, bounds.rows));
        let resolved = costs().map(|(j, (a, b))| bounds.apart(j, *a, *b));
        Self {
            objectives_f64: exact.objectives.clone(),
            objectives_search: search.costs.clone(),
            largest_relative_gap: relative.fold(0.0, f64::max),
            largest_gap: resolved.fold(0.0, f64::max),
            order_held: pairs.len() == finalists && order_held(steady, bounds),
            amplification,
            amplified: pairs.len() - steady.len(),
            finalists,
            refused: finalists - pairs.len(),
            dropped: pairs.iter().filter(|(_, v)| v.violation > 0.0).count(),
        }
    }
}

/// Violations closer than this to each other may change places.
pub(super) const ORDER_TOLERANCE: f64 = 1e-5;

/// Re-scores the finalists (best first by the search): the winner, which is feasible if any is and has the best first
/// objective by the oracle, and the certificate; `None` if the oracle can score none.
pub(super) fn certify(
    finalists: &[Scored],
    (oracle, amplification): (&Oracle<'_>, Option<&Amplification<'_>>),
    bounds: Bounds<'_>,
) -> Option<(Vec<f64>, Verdict, Certificate)> {
    let verdicts: Vec<Option<Verdict>> = finalists.par_iter().map(|f| bounds.ask(oracle, &f.candidate)).collect();
    let pairs: Vec<(&Scored, &Verdict)> =
        finalists.iter().zip(&verdicts).filter_map(|(f, v)| Some((f, v.as_ref()?))).collect();
    let (search, exact) = *pairs.iter().min_by(|a, b| a.1.order(b.1))?;
    let (steady, amplification) = steady(&pairs, search, amplification);
    let certificate = Certificate::over((finalists.len(), &pairs), (&steady, amplification), (search, exact), bounds);
    Some((search.candidate.clone(), exact.clone(), certificate))
}

/// By the first objective, among finalists that the constraints treat alike.
fn order_held(pairs: &Pairs<'_>, bounds: Bounds<'_>) -> bool {
    pairs.iter().all(|(a, exact_a)| {
        pairs.iter().all(|(b, exact_b)| {
            let swapped = a.violation <= b.violation && a.costs[0] < b.costs[0] && exact_b.order(exact_a).is_lt();
            let equal = bounds.apart(0, exact_a.objectives[0], exact_b.objectives[0]) < 1.0;
            !swapped || (equal && (exact_a.violation - exact_b.violation).abs() < ORDER_TOLERANCE)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::Relation;

    const ONE: Bounds<'_> = Bounds { objectives: 1, kinds: &[], constraints: &[], rows: 1 };

    fn finalists(costs: &[f64]) -> Vec<Scored> {
        let scored = |(i, c): (usize, &f64)| Scored { candidate: vec![i as f64], costs: vec![*c], violation: 0.0 };
        costs.iter().enumerate().map(scored).collect()
    }

    fn certificate(search: &[f64], exact: &'static [f64]) -> (Vec<f64>, Verdict, Certificate) {
        let oracle = move |x: &[f64]| Some(vec![exact[x[0] as usize]]);
        certify(&finalists(search), (&oracle, None), ONE).expect("scored")
    }

    #[test]
    fn the_oracle_chooses_and_the_gap_is_the_largest() {
        let (winner, verdict, certificate) = certificate(&[1.0, 1.5, 2.0], &[1.25, 1.0, 2.0]);
        assert_eq!((winner, verdict.objectives), (vec![1.0], vec![1.0]));
        assert_eq!((certificate.objectives_f64, certificate.objectives_search), (vec![1.0], vec![1.5]));
        assert!((certificate.largest_relative_gap - 1.0 / 3.0).abs() < 1e-15 && !certificate.order_held);
    }

    #[test]
    fn order_within_single_precision_is_held() {
        assert!(certificate(&[1.0, 1.000_001, 3.0], &[1.000_002, 1.000_001, 3.0]).2.order_held);
        assert!(!certificate(&[1.0, 1.000_001, 3.0], &[1.001, 1.000_001, 3.0]).2.order_held);
    }

    /// Of a filter that has lost the track nobody has the cost: it decides no order, and the winner may be one.
    #[test]
    fn amplified_finalists_count_in_no_gap() {
        let exact: &[f64] = &[1.0, 5.0, 2.0];
        let oracle = move |x: &[f64]| Some(vec![exact[x[0] as usize]]);
        let amplification = |x: &[f64]| if x[0] > 0.5 && x[0] < 1.5 { f64::INFINITY } else { 0.25 };
        let judge = (&oracle as &Oracle<'_>, Some(&amplification as &Amplification<'_>));
        let (winner, _, certificate) = certify(&finalists(&[1.0, 1.5, 2.0]), judge, ONE).expect("scored");
        assert_eq!((winner, certificate.amplification, certificate.amplified), (vec![0.0], Some(0.25), 1));
        assert!(certificate.order_held && certificate.largest_relative_gap == 0.0, "{certificate:?}");
    }

    #[test]
    fn what_the_oracle_cannot_score_never_wins() {
        let oracle = |x: &[f64]| if x[0] < 1.0 { Some(vec![f64::NAN]) } else { Some(vec![x[0]]) };
        let (winner, _, certificate) =
            certify(&finalists(&[1.0, 2.0, 3.0]), (&oracle, None), ONE).expect("two are scored");
        assert_eq!(winner, [1.0]);
        assert_eq!((certificate.refused, certificate.finalists, certificate.order_held), (1, 3, false));
        assert_eq!(certify(&finalists(&[1.0, 2.0]), (&|_| None, None), ONE), None);
        assert_eq!(certify(&[], (&|_| Some(vec![1.0]), None), ONE), None);
    }

    /// nis_mean is 3, 1.1 and 1.3 against a limit of 1.2: the best cost violates most.
    #[test]
    fn the_winner_is_feasible_by_the_oracle_or_violates_least() {
        let measure = Objective::new(Kind::NisMean);
        let constraint = |limit| [Constraint { measure: measure.clone(), relation: Relation::AtMost, limit }];
        let oracle = |x: &[f64]| Some(vec![x[0], [3.0, 1.1, 1.3][x[0] as usize]]);
        let winner = |constraints: &[Constraint]| {
            certify(&finalists(&[1.0, 2.0, 3.0]), (&oracle, None), Bounds { constraints, ..ONE }).expect("scored")
        };
        let (candidate, verdict, certificate) = winner(&constraint(1.2));
        assert_eq!((candidate, verdict.constraints, certificate.dropped), (vec![1.0], vec![1.1], 2));
        assert!(!certificate.order_held, "the search held all three for feasible");
        let (candidate, verdict, certificate) = winner(&constraint(1.0));
        assert_eq!((candidate, certificate.dropped), (vec![1.0], 3));
        assert!((verdict.violation - 0.1).abs() < 1e-15, "{}", verdict.violation);
    }
}
