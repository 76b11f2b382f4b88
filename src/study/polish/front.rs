//! A front: its ends, each by its own objective, and its knee.

use super::lockstep::{Goal, Run};
use super::{Place, Polish};
use crate::evaluate::Population;
use crate::model::Pick;
use crate::study::{Front, Landmarks, StudyError};

/// Adds to `front` what local searches find from its ends, each objective alone, and from its knee, where the sum of the
/// objectives over the front's ranges is least.
pub(in crate::study) fn polish(front: &mut Front, place: &mut Place<'_>) -> Result<Option<Polish>, StudyError> {
    let members = front.members();
    let costs: Vec<Vec<f64>> = members.iter().map(|member| member.costs.clone()).collect();
    let Some(landmarks) = Landmarks::of(&costs, &Pick::Knee) else { return Ok(None) };
    let before: Vec<f64> = landmarks.ends.iter().enumerate().map(|(j, end)| costs[*end][j]).collect();
    let range = |(j, best): (usize, &f64)| {
        let worst = costs.iter().map(|c| c[j]).fold(*best, f64::max);
        [*best, if worst > *best { worst - best } else { 1.0 }]
    };
    let ranges: Vec<[f64; 2]> = before.iter().enumerate().map(range).collect();
    let others: Vec<Vec<f64>> = Vec::new();
    let mut runs = Vec::new();
    let all_smooth = (0..before.len()).all(|j| place.kind(j).is_smooth());
    let ends =
        landmarks.ends.iter().enumerate().map(|(j, end)| {
            (Goal::One(j), *end, place.kind(j).is_smooth(), place.kind(j).nat(before[j], place.rows()))
        });
    // Of the scaled sum a ten-thousandth of the front's range stands for a nat.
    let knee = (Goal::Scaled(ranges), landmarks.knee, all_smooth, 1e-4);
    for (goal, member, smooth, nat) in ends.chain([knee]) {
        let start = place.coordinates.position(&members[member].candidate);
        runs.push(if smooth {
            Run::new(place.quasi_newton(&start, nat)?, goal)
        } else {
            Run::new(place.simplex(&start, &others)?, goal)
        });
    }
    let (evaluations, ended) = place.lockstep(&mut runs, |_| false)?;
    let mut found = Population::new(place.coordinates.dimension());
    runs.iter().filter_map(|run| run.seen.best()).for_each(|best| found.push(&best.candidate));
    let mut after = before.clone();
    let mut gained = 0;
    if !found.is_empty() {
        let costs = crate::study::evaluate(place.evaluator, &found)?;
        front.add(&found, &costs);
        let now = front.members();
        gained = found.rows().filter(|row| now.iter().any(|member| member.candidate == *row)).count();
        for member in &now {
            after.iter_mut().zip(&member.costs).for_each(|(after, cost)| *after = after.min(*cost));
        }
    }
    Ok(Some(Polish {
        before,
        after,
        evaluations: evaluations + found.len(),
        starts: runs.len(),
        ended,
        converged: None,
        gradient_norm: None,
        left_at_start: Vec::new(),
        members: gained,
    }))
}
