//! The running front, and its certification.

mod studies;

use proptest::prelude::*;

use super::*;
use crate::evaluate::Status;
use crate::model::Pick;
use crate::objective::{Constraint, Kind, Objective, Relation};
use crate::optimize::pareto::dominates;
use crate::random::{Purpose, Stream};
use crate::study::finish::Bounds;

fn evaluation(costs: &[Vec<f64>], violation: Vec<f64>) -> (Population, Evaluation) {
    let k = costs[0].len();
    let candidates: Vec<f64> = (0..costs.len()).map(|i| i as f64).collect();
    let evaluation = Evaluation::new(k, costs.concat(), vec![Status::OK; costs.len()]).with_violation(violation);
    (Population::from_rows(1, candidates), evaluation)
}

fn front_of(costs: &[Vec<f64>], capacity: usize) -> Front {
    let (candidates, evaluation) = evaluation(costs, vec![0.0; costs.len()]);
    let mut front = Front::new(costs[0].len(), capacity);
    front.add(&candidates, &evaluation);
    front
}

/// By the definition: nothing else is at least as good everywhere and better somewhere; of equals the first.
fn by_definition(costs: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let first = |i: usize| costs.iter().position(|c| *c == costs[i]) == Some(i);
    let alone = |i: usize| !costs.iter().any(|other| dominates(other, &costs[i]));
    let mut found: Vec<Vec<f64>> =
        (0..costs.len()).filter(|i| first(*i) && alone(*i)).map(|i| costs[i].clone()).collect();
    found.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    found
}

proptest! {
    /// Small whole numbers, so that ties in one objective, in several and in all are common.
    #[test]
    fn it_is_the_non_dominated_set(k in 2..=4usize, values in prop::collection::vec(0..6u8, 4..400), parts in 1..4usize) {
        let costs: Vec<Vec<f64>> = values.chunks_exact(k).map(|row| row.iter().map(|v| f64::from(*v)).collect()).collect();
        let mut front = Front::new(k, 1000);
        for part in costs.chunks(costs.len().div_ceil(parts)) {
            let (candidates, evaluation) = evaluation(part, vec![0.0; part.len()]);
            front.add(&candidates, &evaluation);
        }
        let mut found = front.points();
        found.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        prop_assert_eq!(found, by_definition(&costs));
    }
}

#[test]
fn failed_and_infeasible_candidates_stay_out() {
    let costs = vec![vec![0.0, 0.0], vec![1.0, 2.0], vec![2.0, 1.0], vec![3.0, 0.5]];
    let (candidates, mut evaluation) = evaluation(&costs, vec![0.1, 0.0, 0.0, f64::NAN]);
    let mut front = Front::new(2, 10);
    front.add(&candidates, &evaluation);
    assert_eq!(front.points(), [[1.0, 2.0], [2.0, 1.0]]);
    evaluation = Evaluation::new(2, vec![0.5, 0.5, 9.0, 9.0], vec![Status::NOT_POSITIVE, Status::OK]);
    front.add(&Population::from_rows(1, vec![7.0, 8.0]), &evaluation);
    assert_eq!(front.points(), [[1.0, 2.0], [2.0, 1.0]], "a failed candidate costs the worst number");
}

#[test]
fn a_full_front_keeps_its_ends_and_its_spread() {
    let mut stream = Stream::new(5, Purpose::Population, 0, 0);
    let costs: Vec<Vec<f64>> = (0..5000).map(|_| stream.uniform()).map(|u| vec![u, 1.0 - u.sqrt()]).collect();
    let front = front_of(&costs, 40);
    let mut x: Vec<f64> = front.points().iter().map(|p| p[0]).collect();
    x.sort_by(f64::total_cmp);
    assert_eq!(x.len(), 40);
    let all = costs.iter().map(|c| c[0]);
    let ends = [all.clone().fold(f64::INFINITY, f64::min), all.fold(0.0, f64::max)];
    assert!(x[0].total_cmp(&ends[0]).is_eq() && x[39].total_cmp(&ends[1]).is_eq(), "both ends are there");
    let widest = x.windows(2).map(|w| (w[1] - w[0]) + (w[1].sqrt() - w[0].sqrt())).fold(0.0, f64::max);
    assert!(widest < 3.0 * 2.0 / 39.0, "an even spread has gaps of {}, the widest is {widest}", 2.0 / 39.0);
}

#[test]
fn the_reference_point_is_fixed_by_the_first_members() {
    let mut front = Front::new(2, 10);
    let mut add = |costs: Vec<Vec<f64>>, violation: Vec<f64>| {
        let (candidates, evaluation) = evaluation(&costs, violation);
        front.add(&candidates, &evaluation);
        (front.reference().to_vec(), front.hypervolume())
    };
    assert_eq!(add(vec![vec![1.0, 1.0]], vec![1.0]).0, Vec::<f64>::new(), "nothing feasible yet");
    let (reference, volume) = add(vec![vec![1.0, 20.0], vec![2.0, 10.0], vec![3.0, 50.0]], vec![0.0; 3]);
    assert_eq!(reference, [2.1, 21.0], "1 to 2 and 10 to 20, and a tenth");
    assert!((volume - (0.1 * 11.0 + 1.0 * 1.0)).abs() < 1e-12, "{volume}");
    let (reference, volume) = add(vec![vec![0.5, 5.0], vec![0.1, 100.0]], vec![0.0; 2]);
    assert_eq!(reference, [2.1, 21.0]);
    assert!((volume - 1.6 * 16.0).abs() < 1e-12, "beyond the reference point nothing counts: {volume}");
    assert_eq!(front_of(&[vec![-4.0, 0.0]], 10).reference(), [-3.6, 0.1], "one member has no range");
}

fn scored(costs: &[[f64; 2]]) -> Vec<Scored> {
    let member =
        |(i, costs): (usize, &[f64; 2])| Scored { candidate: vec![i as f64], costs: costs.to_vec(), violation: 0.0 };
    costs.iter().enumerate().map(member).collect()
}

const TWO: Bounds<'_> = Bounds { objectives: 2, kinds: &[], constraints: &[], rows: 1 };

#[test]
fn the_oracle_filters_the_front_again() {
    let search = scored(&[[0.0, 3.0], [1.0, 2.0], [2.0, 1.0], [3.0, 0.0]]);
    let exact = [[0.0, 3.0], [2.5, 2.0], [2.0, 1.0], [3.0, 0.0]];
    let oracle = |x: &[f64]| Some(exact[x[0] as usize].to_vec());
    let found = certify(&search, (&oracle, None), TWO, &Pick::Best(1)).expect("a front");
    let members: Vec<f64> = found.members.iter().map(|m| m.candidate[0]).collect();
    assert_eq!(members, [0.0, 2.0, 3.0], "member 1 is dominated by member 2");
    assert_eq!((found.certificate.dropped, found.certificate.order_held, found.certificate.finalists), (1, false, 4));
    assert!((found.certificate.largest_relative_gap - 0.6).abs() < 1e-15);
    assert_eq!((found.landmarks.recommended, found.certificate.objectives_f64.clone()), (2, vec![3.0, 0.0]));
}

#[test]
fn a_dominance_within_single_precision_is_no_overturn() {
    let search = scored(&[[1.0, 2.0], [1.000_001, 1.999_999]]);
    let with = |second: [f64; 2]| {
        let oracle = move |x: &[f64]| Some(if x[0] < 1.0 { vec![1.0, 2.0] } else { second.to_vec() });
        certify(&search, (&oracle, None), TWO, &Pick::Knee).expect("a front")
    };
    let close = with([1.000_001, 2.0]);
    assert_eq!((close.members.len(), close.certificate.dropped, close.certificate.order_held), (1, 1, true));
    assert!(!with([1.001, 2.0]).certificate.order_held);
}

#[test]
fn members_must_meet_the_constraints_by_the_oracle() {
    let constraints = [Constraint { measure: Objective::new(Kind::NisMean), relation: Relation::AtMost, limit: 1.2 }];
    let bounds = Bounds { constraints: &constraints, ..TWO };
    let search = scored(&[[0.0, 3.0], [1.0, 2.0], [2.0, 1.0]]);
    let with = |nis: [f64; 3]| {
        let search = &search;
        let oracle = move |x: &[f64]| {
            let i = x[0] as usize;
            Some(vec![search[i].costs[0], search[i].costs[1], nis[i]])
        };
        certify(search, (&oracle, None), bounds, &Pick::Knee)
    };
    let found = with([1.0, 1.3, 1.1]).expect("two are feasible");
    assert_eq!(found.members.iter().map(|m| m.constraints[0]).collect::<Vec<_>>(), [1.0, 1.1]);
    assert!(!found.certificate.order_held, "the search held all for feasible");
    assert!(with([2.0; 3]).is_none(), "none is feasible");
}

#[test]
fn equal_members_are_one() {
    let search = scored(&[[1.0, 2.0], [1.000_001, 1.999_999]]);
    let found = certify(&search, (&|_| Some(vec![1.0, 2.0]), None), TWO, &Pick::Knee).expect("a front");
    assert_eq!(found.members.iter().map(|m| m.candidate[0]).collect::<Vec<_>>(), [0.0]);
}
