//! Fronts and crowding against brute force, and against values of another program.

use super::*;
use crate::random::{Purpose, Stream};

/// Points with many equal costs, some infeasible: from 1 to 60 of them on a lattice.
fn random_scores(case: u64, objectives: usize) -> Scores {
    let mut stream = Stream::new(5, Purpose::Workload, case, objectives as u64);
    let mut whole = |below: f64| (stream.uniform() * below).floor();
    let (count, lattice) = (1.0 + whole(60.0), 2.0 + whole(30.0));
    let infeasible = whole(2.0) > 0.0;
    let mut scores = Scores::new(objectives);
    for _ in 0..count as usize {
        let costs: Vec<f64> = (0..objectives).map(|_| whole(lattice) - 3.0).collect();
        let violation = if infeasible { (whole(6.0) - 3.0).max(0.0) } else { 0.0 };
        scores.push(&costs, if violation > 1.0 { f64::INFINITY } else { violation });
    }
    scores
}

/// Peels one front after the other, comparing all pairs.
pub(in crate::optimize) fn peeled(scores: &Scores) -> Vec<usize> {
    let mut rank = vec![usize::MAX; scores.len()];
    let mut front = 0;
    while rank.contains(&usize::MAX) {
        let left: Vec<usize> = (0..scores.len()).filter(|i| rank[*i] == usize::MAX).collect();
        let best = left.iter().filter(|i| !left.iter().any(|j| scores.better(*j, **i)));
        let best: Vec<usize> = best.copied().collect();
        best.iter().for_each(|i| rank[*i] = front);
        front += 1;
    }
    rank
}

/// Neighbours of a candidate by looking at every other of its front, with no sorting.
pub(in crate::optimize) fn crowding_by_neighbours(scores: &Scores, ranks: &[usize], i: usize) -> f64 {
    let front: Vec<usize> = (0..ranks.len()).filter(|j| ranks[*j] == ranks[i]).collect();
    let mut sum = 0.0;
    for m in 0..scores.objectives() {
        let cost = |j: usize| scores.costs(j)[m];
        let before = |a: usize, b: usize| cost(a).total_cmp(&cost(b)).then(a.cmp(&b)).is_lt();
        let previous = front.iter().copied().filter(|j| before(*j, i)).reduce(|a, b| if before(a, b) { b } else { a });
        let next = front.iter().copied().filter(|j| before(i, *j)).reduce(|a, b| if before(a, b) { a } else { b });
        let (Some(previous), Some(next)) = (previous, next) else { return f64::INFINITY };
        let costs = || front.iter().map(|j| cost(*j));
        let range = costs().fold(f64::MIN, f64::max) - costs().fold(f64::MAX, f64::min);
        sum += if range > 0.0 { (cost(next) - cost(previous)) / range } else { 0.0 };
    }
    sum
}

#[test]
fn a_thousand_random_fronts_equal_brute_force() {
    let (mut deepest, mut equal) = (0, 0);
    for (case, objectives) in (0..1000).map(|case| (case, 1 + case as usize % 4)) {
        let scores = random_scores(case, objectives);
        let ranks = fronts(&scores);
        assert_eq!(ranks, peeled(&scores), "case {case}: {scores:?}");
        let distance = crowding(&scores, &ranks);
        for (i, found) in distance.into_iter().enumerate() {
            let expected = crowding_by_neighbours(&scores, &ranks, i);
            let same = found.is_infinite() && expected.is_infinite() || (found - expected).abs() < 1e-14;
            assert!(same, "case {case}, candidate {i}: {found} against {expected}");
            equal += usize::from((0..i).any(|j| scores.costs(j) == scores.costs(i)));
        }
        deepest = ranks.into_iter().fold(deepest, usize::max);
    }
    assert!(deepest > 20 && equal > 2000, "the cases are deep ({deepest}) and hold duplicates ({equal})");
}

/// Fronts of hundreds of members, so that trees split; no duplicates.
#[test]
fn large_fronts_equal_brute_force() {
    for objectives in [2, 3, 4] {
        let mut stream = Stream::new(8, Purpose::Workload, 0, objectives as u64);
        let mut scores = Scores::new(objectives);
        for _ in 0..1200 {
            let costs: Vec<f64> = (0..objectives).map(|_| stream.uniform()).collect();
            scores.push(&costs, 0.0);
        }
        assert_eq!(fronts(&scores), peeled(&scores), "{objectives} objectives");
    }
}

#[test]
fn the_fixed_set_of_another_program() {
    #[derive(serde::Deserialize)]
    #[expect(non_snake_case, reason = "the key of the file")]
    struct Fixed {
        F: Vec<[f64; 2]>,
        rank: Vec<usize>,
        crowding: Vec<Option<f64>>,
    }
    #[derive(serde::Deserialize)]
    struct Golden {
        nds: Fixed,
    }
    let text = include_str!("../../../tests/golden/golden_moo.json");
    let fixed = serde_json::from_str::<Golden>(text).expect("the golden file").nds;
    let mut scores = Scores::new(2);
    fixed.F.iter().for_each(|costs| scores.push(costs, 0.0));
    let ranking = Ranking::of(&scores);
    assert_eq!(ranking.rank, fixed.rank);
    for (i, (ours, theirs)) in ranking.crowding.iter().zip(&fixed.crowding).enumerate() {
        // pymoo divides the sum by the number of objectives and writes null for infinite.
        match theirs {
            Some(theirs) => assert!((ours - 2.0 * theirs).abs() < 1e-13, "candidate {i}: {ours} against 2 x {theirs}"),
            None => assert!(ours.is_infinite(), "candidate {i}: {ours}"),
        }
    }
}

/// The rule for copies of an extreme: only the first at the low end and the last at the high end.
#[test]
fn of_equal_extremes_one_is_infinite() {
    let mut scores = Scores::new(2);
    for costs in [[1.0, 2.0], [1.0, 2.0], [1.0, 2.0], [2.0, 1.0], [2.0, 1.0]] {
        scores.push(&costs, 0.0);
    }
    // By the first objective the order is 0 1 2 3 4, by the second 3 4 0 1 2.
    assert_eq!(crowding(&scores, &fronts(&scores)), [f64::INFINITY, 0.0, f64::INFINITY, f64::INFINITY, f64::INFINITY]);
    let mut equal = Scores::new(2);
    (0..4).for_each(|_| equal.push(&[7.0, 7.0], f64::INFINITY));
    assert_eq!(crowding(&equal, &fronts(&equal)), [f64::INFINITY, 0.0, 0.0, f64::INFINITY]);
}

#[test]
fn the_order_of_extreme_numbers() {
    let mut scores = Scores::new(2);
    for costs in [[0.0, 1.0], [-0.0, 1.0], [f64::NAN, 0.0], [-f64::MAX, f64::MAX], [f64::MAX, -f64::MAX]] {
        scores.push(&costs, 0.0);
    }
    assert_eq!(fronts(&scores), [0, 0, 1, 0, 0], "-0 is 0; NaN is the worst cost");
    let distance = crowding(&scores, &fronts(&scores));
    assert!(distance.iter().all(|d| !d.is_nan()), "{distance:?}");
    assert_eq!(Ranking::of(&Scores::new(3)).order(), [0_usize; 0]);
    assert_eq!(fronts(&Scores::new(4)), [0_usize; 0]);
}

/// Ranking only as many fronts as are kept changes nothing of what is kept.
#[test]
fn the_best_are_the_head_of_the_whole_order() {
    for (case, objectives) in (0..200).map(|case| (case, 1 + case as usize % 4)) {
        let scores = random_scores(case, objectives);
        let whole = Ranking::of(&scores);
        let order = whole.order();
        for keep in [0, 1, scores.len() / 2, scores.len()] {
            let (kept, ranking) = Ranking::best(&scores, keep);
            assert_eq!(kept, order[..keep], "case {case}, {keep} of {}", scores.len());
            let expected: Vec<usize> = kept.iter().map(|i| whole.rank[*i]).collect();
            assert_eq!(ranking.rank, expected, "case {case}");
            let expected: Vec<f64> = kept.iter().map(|i| whole.crowding[*i]).collect();
            assert_eq!(ranking.crowding, expected, "case {case}");
        }
    }
}

#[test]
fn feasible_before_infeasible() {
    let mut scores = Scores::new(2);
    for (costs, violation) in [([1.0, 1.0], 0.5), ([9.0, 9.0], 0.0), ([5.0, 5.0], 0.5), ([0.0, 0.0], 0.75)] {
        scores.push(&costs, violation);
    }
    scores.push(&[Evaluation::FAILED; 2], f64::INFINITY);
    assert_eq!(fronts(&scores), [1, 0, 1, 2, 3]);
    assert!(scores.better(1, 3) && scores.better(0, 3) && !scores.better(0, 2) && !scores.better(3, 1));
}
