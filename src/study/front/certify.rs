//! The whole front by the f64 oracle.

use rayon::prelude::*;

use super::{FrontMember, Landmarks};
use crate::model::Pick;
use crate::optimize::pareto::dominates;
use crate::study::finish::{self, Bounds, Certificate, ORDER_TOLERANCE, Verdict};
use crate::study::{Amplification, Oracle, Scored};

/// A front by the oracle.
pub(in crate::study) struct Certified {
    /// Best first objective first.
    pub(in crate::study) members: Vec<FrontMember>,
    pub(in crate::study) landmarks: Landmarks,
    /// Of the recommended member.
    pub(in crate::study) certificate: Certificate,
}

/// Scores all members again, in parallel, and keeps those that are feasible and not dominated by the oracle's values;
/// `None` where nothing is left.
pub(in crate::study) fn certify(
    front: &[Scored],
    (oracle, amplification): (&Oracle<'_>, Option<&Amplification<'_>>),
    bounds: Bounds<'_>,
    pick: &Pick,
) -> Option<Certified> {
    let verdicts: Vec<Option<Verdict>> = front.par_iter().map(|m| bounds.ask(oracle, &m.candidate)).collect();
    let pairs: Vec<(&Scored, &Verdict)> =
        front.iter().zip(&verdicts).filter_map(|(m, v)| Some((m, v.as_ref()?))).collect();
    let mut kept: Vec<(&Scored, &Verdict)> = Vec::with_capacity(pairs.len());
    for (i, pair) in pairs.iter().enumerate() {
        let covered = |(j, (_, other)): (usize, &(&Scored, &Verdict))| {
            let equal = j < i && other.objectives == pair.1.objectives;
            other.violation <= 0.0 && (equal || dominates(&other.objectives, &pair.1.objectives))
        };
        if pair.1.violation <= 0.0 && !pairs.iter().enumerate().any(covered) {
            kept.push(*pair);
        }
    }
    kept.sort_by(|a, b| a.1.objectives[0].total_cmp(&b.1.objectives[0]));
    let objectives: Vec<Vec<f64>> = kept.iter().map(|(_, verdict)| verdict.objectives.clone()).collect();
    let landmarks = Landmarks::of(&objectives, pick)?;
    let (search, exact) = kept[landmarks.recommended];
    let (steady, amplification) = finish::steady(&pairs, search, amplification);
    let certificate = Certificate {
        dropped: pairs.len() - kept.len(),
        order_held: pairs.len() == front.len() && order_held(&steady, bounds),
        ..Certificate::over((front.len(), &pairs), (&steady, amplification), (search, exact), bounds)
    };
    let members = kept.into_iter().map(|(m, v)| member(m, v)).collect();
    Some(Certified { members, landmarks, certificate })
}

fn member(search: &Scored, exact: &Verdict) -> FrontMember {
    FrontMember {
        candidate: search.candidate.clone(),
        costs_search: search.costs.clone(),
        objectives: exact.objectives.clone(),
        constraints: exact.constraints.clone(),
        nis: None,
    }
}

/// Whether the oracle leaves every member where the search put it: none turns out infeasible or dominated by another, by
/// more than what counts as equal.
fn order_held(pairs: &[(&Scored, &Verdict)], bounds: Bounds<'_>) -> bool {
    let infeasible =
        |(search, exact): &(&Scored, &Verdict)| search.violation <= 0.0 && exact.violation > ORDER_TOLERANCE;
    let overturned = |(a, exact_a): &(&Scored, &Verdict), (b, exact_b): &(&Scored, &Verdict)| {
        dominates(&exact_a.objectives, &exact_b.objectives)
            && !dominates(&a.costs, &b.costs)
            && exact_a
                .objectives
                .iter()
                .zip(&exact_b.objectives)
                .enumerate()
                .any(|(j, (a, b))| bounds.apart(j, *a, *b) >= 1.0)
    };
    !pairs.iter().any(infeasible) && !pairs.iter().any(|a| pairs.iter().any(|b| overturned(a, b)))
}
