//! Non-dominated sorting.

use std::cmp::Ordering;

use super::Scores;
use super::staircase::Staircase;
use super::tree::{Cuts, DominanceTree};
use rayon::prelude::*;

/// The front that each candidate belongs to: 0 = no other is better, k = only fronts below k hold better ones.
///
/// "Better" is constrained domination ([`Scores::better`]), so the infeasible follow the feasible, one front for each
/// distinct violation; failed candidates, whose violation is infinite, are the last. Equal candidates share a front.
///
/// O(N log N) for one and two objectives. For more, candidates are taken in lexicographic order, so that nothing dominates
/// an earlier one, and their front is found by bisection (ENS-BS, X. Zhang et al., IEEE Trans. Evol. Comput. 19 (2015), doi
/// 10.1109/TEVC.2014.2308305). Whether a front dominates a candidate is asked of a staircase for three objectives, O(N
/// log^2 N) in all, and of a k-d tree for more (P. Gustavsson, A. Syberfeldt, Evol. Comput. 26 (2018), doi
/// 10.1162/evco_a_00204).
#[must_use]
pub fn fronts(scores: &Scores) -> Vec<usize> {
    let (feasible, mut infeasible): (Vec<usize>, Vec<usize>) = (0..scores.len()).partition(|i| scores.feasible(*i));
    let mut rank = vec![0; scores.len()];
    let mut next = match scores.objectives() {
        0 => usize::from(!feasible.is_empty()),
        1 | 2 => sweep(scores, feasible, &mut rank),
        3 => by_staircases(scores, feasible, &mut rank),
        _ => by_trees(scores, feasible, &mut rank),
    };
    infeasible.sort_unstable_by(|i, j| scores.violation(*i).total_cmp(&scores.violation(*j)));
    for (place, i) in infeasible.iter().enumerate() {
        let worse = place > 0 && scores.violation(infeasible[place - 1]) < scores.violation(*i);
        next += usize::from(worse);
        rank[*i] = next;
    }
    rank
}

fn lexicographic(a: &[f64], b: &[f64]) -> Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// Ranks of one or two objectives; returns the number of fronts.
///
/// In lexicographic order, a later candidate is dominated by a front exactly if the last cost of its newest member is not
/// above the candidate's own, and these last costs rise from front to front.
fn sweep(scores: &Scores, members: Vec<usize>, rank: &mut [usize]) -> usize {
    let last_objective = scores.objectives() - 1;
    let mut keyed: Vec<([f64; 2], usize)> =
        members.into_iter().map(|i| ([scores.costs(i)[0], scores.costs(i)[last_objective]], i)).collect();
    keyed.par_sort_unstable_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut newest: Vec<f64> = Vec::new();
    let mut previous: Option<([f64; 2], usize)> = None;
    for (costs, i) in keyed {
        rank[i] = match previous {
            Some((before, front)) if lexicographic(&before, &costs).is_eq() => front,
            _ => newest.partition_point(|last| *last <= costs[1]),
        };
        if rank[i] == newest.len() {
            newest.push(costs[1]);
        } else {
            newest[rank[i]] = costs[1];
        }
        previous = Some((costs, rank[i]));
    }
    newest.len()
}

/// Ranks of three objectives; returns the number of fronts.
fn by_staircases(scores: &Scores, members: Vec<usize>, rank: &mut [usize]) -> usize {
    let mut fronts: Vec<Staircase> = Vec::new();
    in_order(scores, members, rank, |costs| {
        let front = fronts.partition_point(|front| front.dominates(costs[1], costs[2]));
        if front == fronts.len() {
            fronts.push(Staircase::default());
        }
        fronts[front].insert(costs[1], costs[2]);
        front
    });
    fronts.len()
}

/// Ranks of four objectives or more; returns the number of fronts.
fn by_trees(scores: &Scores, members: Vec<usize>, rank: &mut [usize]) -> usize {
    if members.is_empty() {
        return 0;
    }
    let cuts = Cuts::of(&mut members.iter().map(|i| &scores.costs(*i)[1..]).collect::<Vec<_>>());
    let mut fronts: Vec<DominanceTree<'_>> = Vec::new();
    in_order(scores, members, rank, |costs| {
        let front = fronts.partition_point(|front| front.dominates(&costs[1..], &cuts));
        if front == fronts.len() {
            fronts.push(DominanceTree::new());
        }
        fronts[front].insert(&costs[1..], &cuts);
        front
    });
    fronts.len()
}

/// Sets the rank of every member to what `place` gives for its costs, in lexicographic order; equal costs are placed once.
fn in_order<'a>(
    scores: &'a Scores,
    mut members: Vec<usize>,
    rank: &mut [usize],
    mut place: impl FnMut(&'a [f64]) -> usize,
) {
    members.par_sort_unstable_by(|i, j| lexicographic(scores.costs(*i), scores.costs(*j)));
    let mut previous: Option<usize> = None;
    for i in members {
        let costs = scores.costs(i);
        rank[i] = match previous.filter(|p| lexicographic(scores.costs(*p), costs).is_eq()) {
            Some(equal) => rank[equal],
            None => place(costs),
        };
        previous = Some(i);
    }
}
