//! What the oracle makes of a search: the front or the finalists, the winner and its certificate.

use std::sync::atomic::{AtomicBool, Ordering};

use super::finish::{self, Bounds};
use super::polish::{self, Place, Polished};
use super::record::Record;
use super::{Baseline, Coordinates, FrontMember, Judge, Landmarks, Oracle, Polish, Scored, StudyError, Winner, front};
use crate::evaluate::Evaluator;
use crate::model::TuneSpec;

/// The user's own candidate by the oracle, which must give as many values as there are objectives and constraints.
pub(super) fn baseline(candidate: Vec<f64>, oracle: &Oracle<'_>, bounds: Bounds<'_>) -> Result<Baseline, StudyError> {
    let values = oracle(&candidate);
    if let Some(values) = values.as_ref().filter(|values| values.len() != bounds.scorers()) {
        return Err(StudyError::Oracle { expected: bounds.scorers(), received: values.len() });
    }
    let verdict = values.and_then(|values| bounds.judge(values));
    let (objectives, constraints) = verdict.map(|v| (v.objectives, v.constraints)).unzip();
    Ok(Baseline { candidate, objectives, constraints })
}

/// What the oracle made of a search.
pub(super) struct Decision {
    pub(super) winner: Option<Winner>,
    pub(super) front: Vec<FrontMember>,
    pub(super) landmarks: Option<Landmarks>,
}

/// The winner of the front or, where that is empty or there is one objective, of the finalists; certified. The user's
/// start is always among them if the search could score it, so that no winner is worse than the baseline.
pub(super) fn decide(
    tune: &TuneSpec,
    coordinates: &Coordinates,
    record: &Record,
    evaluator: &mut dyn Evaluator,
    judge: Judge<'_>,
    interrupt: &AtomicBool,
) -> Result<Decision, StudyError> {
    let with_start = |mut found: Vec<Scored>| {
        let start = record.start.iter().filter(|start| !found.iter().any(|f| f.candidate == start.candidate));
        let start: Vec<Scored> = start.cloned().collect();
        found.extend(start);
        found
    };
    let bounds = Bounds::of(tune, evaluator);
    let Judge { oracle, amplification, polisher } = judge;
    let local: &mut dyn Evaluator = match polisher {
        Some(polisher) => polisher,
        None => evaluator,
    };
    let polishes = tune.polish && !interrupt.load(Ordering::Relaxed);
    let mut place = Place { tune, coordinates, record, evaluator: local, oracle, bounds, interrupt };
    if let Some(front) = &record.front {
        let mut front = front.clone();
        let polish = if polishes { polish::polish_front(&mut front, &mut place)? } else { None };
        if let Some(certified) =
            front::certify(&with_start(front.members()), (oracle, amplification), bounds, &tune.pick)
        {
            return Ok(Decision::of(certified, polish));
        }
    }
    let finalists = with_start(record.archive.members().to_vec());
    let Some((mut candidate, mut verdict, certificate)) = finish::certify(&finalists, (oracle, amplification), bounds)
    else {
        return Ok(Decision { winner: None, front: Vec::new(), landmarks: None });
    };
    let polish = if polishes && bounds.objectives == 1 {
        let best = Polished { candidate: &mut candidate, verdict: &mut verdict };
        Some(polish::polish_winner(best, &finalists, &mut place)?)
    } else {
        None
    };
    let finish::Verdict { objectives, constraints, violation } = verdict;
    let winner = Winner { candidate, objectives, constraints, violation, certificate, polish };
    Ok(Decision { winner: Some(winner), front: Vec::new(), landmarks: None })
}

impl Decision {
    /// The recommended member of a front wins.
    fn of(certified: front::Certified, polish: Option<Polish>) -> Self {
        let front::Certified { members, landmarks, certificate } = certified;
        let winner = members.get(landmarks.recommended).map(|member| Winner {
            candidate: member.candidate.clone(),
            objectives: member.objectives.clone(),
            constraints: member.constraints.clone(),
            violation: 0.0,
            certificate,
            polish,
        });
        Self { winner, front: members, landmarks: Some(landmarks) }
    }
}
