//! Whole studies of several objectives and with constraints, on closed forms.

use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::super::*;
use crate::evaluate::{Backend, Device, Evaluator, Precision, Status};
use crate::model::{Parameter, Parameters, Pick, Scale, Search, TuneSpec, Value};
use crate::objective::{Constraint, Kind, Objective, Relation};
use crate::optimize::pareto::dominates;
use crate::study::{Judge, MAX_OBJECTIVES, Outcome, StopReason, Study, StudyError, run};

/// Objectives, then what is bounded, of a candidate (a, b).
type Scores = fn(&[f64]) -> Vec<f64>;

/// J. D. Schaffer's problem with a second coordinate: the front is b = 0, a in [0, 2], where sqrt f1 + sqrt f2 = 2.
const SCHAFFER: Scores = |x| vec![x[0].powi(2) + x[1].powi(2), (x[0] - 2.0).powi(2) + x[1].powi(2)];
/// Distance from (1, -1); bounded is a.
const BOUNDED: Scores = |x| vec![(x[0] - 1.0).powi(2) + (x[1] + 1.0).powi(2), x[0]];

struct Mock<'a> {
    scores: Scores,
    tune: &'a TuneSpec,
    fails: bool,
}

impl Evaluator for Mock<'_> {
    fn objectives(&self) -> usize {
        self.tune.objectives.len()
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        let k = self.objectives();
        let rows: Vec<&[f64]> = population.rows().collect();
        let scores: Vec<Vec<f64>> = rows.par_iter().map(|x| (self.scores)(x)).collect();
        let status = if self.fails { Status::NOT_POSITIVE } else { Status::OK };
        let costs = scores.iter().flat_map(|s| s[..k].to_vec()).collect();
        let violation = scores.iter().map(|s| Constraint::total_violation(&self.tune.constraints, &s[k..])).collect();
        Evaluation::new(k, costs, vec![status; rows.len()]).with_violation(violation)
    }

    fn device(&self) -> Device {
        Device { backend: Backend::Mock, adapter: "pair".into(), precision: Precision::F64 }
    }
}

fn tune(algorithm: &str, objectives: usize) -> TuneSpec {
    let kinds = Kind::ALL.iter().cycle().take(objectives);
    TuneSpec {
        algorithm: algorithm.to_owned(),
        objectives: kinds.map(|(_, kind)| Objective::new(*kind)).collect(),
        constraints: Vec::new(),
        pick: Pick::Knee,
        population: 40,
        generations: 30,
        seed: 3,
        evaluations: None,
        wall_time: None,
        stall: None,
        target: None,
        include_start: true,
        polish: true,
    }
}

fn at_least(limit: f64) -> Vec<Constraint> {
    vec![Constraint { measure: Objective::new(Kind::NisMean), relation: Relation::AtLeast, limit }]
}

fn parameters(start: Option<f64>) -> Parameters {
    let range = Search { min: -5.0, max: 5.0, scale: Scale::Linear, init: [-5.0, 5.0], start };
    let named = |name: &str| Parameter { name: name.to_owned(), unit: None, value: Value::Searched(range.clone()) };
    Parameters { all: vec![named("a"), named("b")] }
}

fn study(scores: Scores, tune: &TuneSpec, start: Option<f64>) -> Result<Outcome, StudyError> {
    let mut mock = Mock { scores, tune, fails: false };
    let oracle = |x: &[f64]| Some(scores(x));
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let study = Study { parameters: &parameters(start), tune };
    run(&study, &mut mock, judge, &mut [], &AtomicBool::new(false))
}

#[test]
fn any_optimiser_yields_a_front_and_nsga2_the_better_one() {
    let volume = |algorithm: &str| {
        let outcome = study(SCHAFFER, &tune(algorithm, 2), Some(4.0)).expect("an outcome");
        let front = &outcome.front;
        assert!(front.len() > 5 && front.len() <= FRONT_CAPACITY + 1, "{algorithm}: {} members", front.len());
        for (i, member) in front.iter().enumerate() {
            assert_eq!(member.objectives, SCHAFFER(&member.candidate), "by the oracle");
            assert!(!front.iter().any(|other| dominates(&other.objectives, &member.objectives)), "member {i}");
        }
        assert!(front.windows(2).all(|w| w[0].objectives[0] < w[1].objectives[0]), "best first objective first");
        let landmarks = outcome.landmarks.as_ref().expect("landmarks");
        assert_eq!((landmarks.ends.clone(), landmarks.recommended), (vec![0, front.len() - 1], landmarks.knee));
        let winner = outcome.winner.as_ref().expect("a winner");
        assert_eq!((&winner.objectives, winner.violation), (&front[landmarks.knee].objectives, 0.0));
        let polish = winner.polish.as_ref().expect("a polish");
        assert_eq!((polish.starts, polish.converged), (3, None), "both ends and the knee");
        // The ends are at f1 = 0 and f2 = 0; these objectives stand for smooth ones.
        assert!(polish.after.iter().all(|end| *end < 1e-6), "{polish:?}");
        assert_eq!((winner.certificate.largest_relative_gap, winner.certificate.order_held), (0.0, true));
        let better = front.iter().filter(|m| dominates(&m.objectives, &SCHAFFER(&[4.0, 4.0]))).count();
        assert!(better > 0, "{algorithm} finds what is better than the start in both objectives");
        let row = outcome.history.last().expect("a row");
        assert!(row.front.is_some() && outcome.reference_point.iter().all(|x| x.is_finite()));
        // Both searches draw the same generation 0, which fixes the reference point.
        (outcome.reference_point.clone(), row.hypervolume.expect("a volume"), winner.objectives.clone())
    };
    let ((reference, random, _), (same, nsga2, knee)) = (volume("random"), volume("nsga2"));
    assert_eq!(reference, same);
    assert!(nsga2 > random, "nsga2 {nsga2}, random {random}");
    // The front is symmetric: its knee has f1 = f2 = 1.
    assert!(knee.iter().all(|f| (f - 1.0).abs() < 0.2), "{knee:?}");
}

#[test]
fn threads_change_no_bit_of_a_front() {
    for algorithm in ["nsga2", "random"] {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let outcome = pool.install(|| study(SCHAFFER, &tune(algorithm, 2), None)).expect("an outcome");
            let volumes: Vec<_> = outcome.history.iter().map(|row| (row.front, row.hypervolume)).collect();
            (outcome.front, outcome.landmarks, volumes)
        };
        assert_eq!(with(1), with(3), "{algorithm}");
    }
}

/// (1, 0) lies on the front: the start must, whatever the search makes of it.
#[test]
fn a_start_that_nothing_dominates_stays_on_the_front() {
    let on_front: Scores = |x| SCHAFFER(&[x[0] + 1.0, x[1]]);
    let outcome = study(on_front, &tune("nsga2", 2), Some(0.0)).expect("an outcome");
    assert_eq!(outcome.baseline.objectives, Some(vec![1.0, 1.0]));
    assert!(outcome.front.iter().any(|m| m.candidate == [0.0, 0.0]), "{:?}", outcome.front);
}

#[test]
fn the_picked_member_wins() {
    let winner = |pick: Pick| {
        let spec = TuneSpec { pick, ..tune("nsga2", 2) };
        study(SCHAFFER, &spec, None).expect("an outcome").winner.expect("a winner").objectives
    };
    let [first, second] = [0, 1].map(|j| winner(Pick::Best(j))[j]);
    // Polished, of a range of 4; 1.3e-3 and 2.0e-4 without.
    assert!(first < 1e-6 && second < 1e-6, "each end is the best in its objective: {first}, {second}");
    let leaning = winner(Pick::Weights(vec![0.9, 0.1]));
    assert!(leaning[0] < 0.5 && leaning[1] > 1.5, "{leaning:?}");
}

/// The optimum (1, -1) violates a >= 3; the best that does not is (3, -1) with a cost of 4.
#[test]
fn one_objective_with_a_constraint() {
    for algorithm in ["pso", "pso-inertia", "pio", "pio+", "nsga2", "random"] {
        for (polish, tolerance) in [(true, 1e-4), (false, 0.6)] {
            let spec = TuneSpec { constraints: at_least(3.0), polish, ..tune(algorithm, 1) };
            let outcome = study(BOUNDED, &spec, Some(0.0)).expect("an outcome");
            let winner = outcome.winner.expect("a winner");
            assert_eq!((winner.violation, winner.constraints[0]), (0.0, winner.candidate[0]));
            let cost = winner.objectives[0];
            assert!((4.0..4.0 + tolerance).contains(&cost), "{algorithm}, polish {polish}: {cost}");
            assert_eq!(outcome.baseline.constraints, Some(vec![0.0]));
            let row = outcome.history.last().expect("a row");
            assert!(row.feasible > 0 && row.best >= Some(4.0), "the best is the best feasible: {row:?}");
            assert!(outcome.front.is_empty() && row.front.is_none());
        }
    }
}

#[test]
fn a_front_keeps_to_its_constraints() {
    let scores: Scores = |x| [SCHAFFER(x), vec![x[0]]].concat();
    let spec = TuneSpec { constraints: at_least(0.5), ..tune("nsga2", 2) };
    let outcome = study(scores, &spec, None).expect("an outcome");
    assert!(outcome.front.len() > 5 && outcome.front.iter().all(|m| m.constraints[0] >= 0.5 && m.candidate[0] >= 0.5));
    let end = &outcome.front[0].objectives;
    assert!(
        (end[0] - 0.25).abs() < 0.02 && end[0] >= 0.25,
        "the end is where the constraint holds with equality: {end:?}"
    );
}

#[test]
fn where_nothing_is_feasible_the_least_violation_wins() {
    for (algorithm, objectives) in [("pso", 1), ("random", 1), ("nsga2", 2), ("random", 2)] {
        let scores: Scores = if objectives == 1 { BOUNDED } else { |x| [SCHAFFER(x), vec![x[0]]].concat() };
        let spec = TuneSpec { constraints: at_least(10.0), ..tune(algorithm, objectives) };
        let outcome = study(scores, &spec, None).expect("an outcome");
        let winner = outcome.winner.expect("the least bad");
        let a = winner.candidate[0];
        assert!((winner.violation - (10.0 - a) / 10.0).abs() < 1e-12, "{}", winner.violation);
        assert!(a > 4.9, "{algorithm}, {objectives}: {a}, and 5 is the bound");
        assert!(outcome.front.is_empty() && outcome.landmarks.is_none() && outcome.reference_point.is_empty());
        assert!(outcome.history.iter().all(|row| row.best.is_none() && row.feasible == 0 && row.hypervolume.is_none()));
    }
}

#[test]
fn a_front_that_stands_still_stalls() {
    let flat: Scores = |_| vec![1.0, 2.0];
    let spec = TuneSpec { stall: Some(4), generations: 500, ..tune("nsga2", 2) };
    let outcome = study(flat, &spec, None).expect("an outcome");
    assert_eq!((outcome.stop, outcome.generations, outcome.front.len()), (StopReason::Stall, 5, 1));
    let moving = study(SCHAFFER, &TuneSpec { stall: Some(4), generations: 20, ..spec }, None).expect("an outcome");
    assert!(moving.generations > 5, "{}", moving.generations);
}

#[test]
fn a_front_where_every_candidate_fails_is_empty() {
    for algorithm in ["nsga2", "random"] {
        let spec = tune(algorithm, 2);
        let mut mock = Mock { scores: SCHAFFER, tune: &spec, fails: true };
        let oracle = |x: &[f64]| Some(SCHAFFER(x));
        let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
        let study = Study { parameters: &parameters(Some(1.0)), tune: &spec };
        let outcome = run(&study, &mut mock, judge, &mut [], &AtomicBool::new(false)).expect("an outcome");
        assert_eq!((outcome.winner, outcome.front.len(), outcome.failed), (None, 0, outcome.evaluations));
    }
}

#[test]
fn odd_and_tiny_populations_work_or_say_what_is_needed() {
    for population in [3, 5, 7, 41] {
        let outcome = study(SCHAFFER, &TuneSpec { population, ..tune("nsga2", 2) }, None).expect("an outcome");
        assert_eq!(outcome.evaluations, 31 * population as u64, "population {population}");
    }
    for population in [1, 2] {
        match study(SCHAFFER, &TuneSpec { population, ..tune("nsga2", 2) }, None) {
            Ok(outcome) => assert!(!outcome.front.is_empty(), "population {population}"),
            Err(error) => assert!(error.to_string().contains("needs a population of at least"), "{error}"),
        }
    }
}

#[test]
fn wrong_use_of_several_objectives_says_what_to_do() {
    let message = |tune: &TuneSpec, scores: Scores| study(scores, tune, None).expect_err("an error").to_string();
    let several = message(&tune("pso", 2), SCHAFFER);
    assert!(several.contains("\"pso\" minimises one objective, received 2") && several.contains("nsga2"), "{several}");
    let five: Scores = |_| vec![0.0; 5];
    let many = message(&tune("random", MAX_OBJECTIVES + 1), five);
    assert!(many.starts_with("5 objectives: a front of at most 4 is searched"), "{many}");
    let short: Scores = |_| vec![0.0];
    let mut mock =
        Mock { scores: BOUNDED, tune: &TuneSpec { constraints: at_least(1.0), ..tune("pso", 1) }, fails: false };
    let oracle = |x: &[f64]| Some(short(x));
    let study = Study { parameters: &parameters(None), tune: mock.tune };
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let error = run(&study, &mut mock, judge, &mut [], &AtomicBool::new(false)).expect_err("an error").to_string();
    assert!(error.starts_with("the oracle returned 1 values for 2 objectives and constraints"), "{error}");
}
