//! The loop on the mock evaluator.

mod resume;
mod splitting;

use super::*;
use crate::evaluate::mock::{Landscape, Mock};
use crate::model::{Parameter, Pick, Scale, Search as Range, Value};
use crate::objective::{Kind, Objective};

fn tune(algorithm: &str, population: usize, generations: usize) -> TuneSpec {
    TuneSpec {
        algorithm: algorithm.to_owned(),
        objectives: vec![Objective::new(Kind::Nll)],
        constraints: Vec::new(),
        pick: Pick::Knee,
        population,
        generations,
        seed: 3,
        evaluations: None,
        wall_time: None,
        stall: None,
        target: None,
        include_start: true,
        polish: false,
    }
}

fn parameters(start: Option<f64>) -> Parameters {
    let range = Range { min: -5.0, max: 5.0, scale: Scale::Linear, init: [-5.0, 5.0], start };
    let named = |name: &str| Parameter { name: name.to_owned(), unit: None, value: Value::Searched(range.clone()) };
    Parameters { all: vec![named("a"), named("b")] }
}

fn sphere(x: &[f64]) -> Option<Vec<f64>> {
    Some(vec![Landscape::Sphere.value(x)])
}

/// Raises the flag when generation `at` is finished, and counts what it sees.
struct Interrupt<'a> {
    flag: &'a AtomicBool,
    at: usize,
    seen: Vec<(usize, Option<f64>)>,
}

impl Observer for Interrupt<'_> {
    fn generation(&mut self, row: &Generation, best: Option<&Scored>) {
        assert_eq!(row.best, best.map(|b| b.costs[0]), "the row and the leader agree");
        self.seen.push((row.generation, row.best));
        self.flag.fetch_or(row.generation == self.at, Ordering::Relaxed);
    }
}

fn study_of(parameters: &Parameters, tune: &TuneSpec, mock: &mut Mock) -> Result<Outcome, StudyError> {
    run(
        &Study { parameters, tune },
        mock,
        Judge { oracle: &sphere, amplification: None, polisher: None },
        &mut [],
        &AtomicBool::new(false),
    )
}

fn study(tune: &TuneSpec) -> Outcome {
    study_of(&parameters(None), tune, &mut Mock::new(Landscape::Sphere)).expect("an outcome")
}

fn winner(outcome: &Outcome) -> &Winner {
    outcome.winner.as_ref().expect("a winner")
}

#[test]
fn a_whole_study() {
    let mut mock = Mock::new(Landscape::Sphere);
    let outcome = study_of(&parameters(Some(4.0)), &tune("pso", 20, 50), &mut mock).expect("an outcome");
    assert_eq!((outcome.algorithm, outcome.generations, outcome.evaluations), ("pso", 51, 1020));
    assert_eq!((outcome.stop, outcome.failed, mock.candidates), (StopReason::Generations, 0, 1020));
    assert_eq!(outcome.baseline.candidate, [4.0, 4.0]);
    assert_eq!(outcome.baseline.objectives, sphere(&[4.0, 4.0]));
    let found = winner(&outcome);
    assert!(found.objectives[0] < 1e-5, "6.2e-7 measured, {:?} found", found.objectives);
    assert_eq!(found.objectives, sphere(&found.candidate).expect("a cost"));
    assert_eq!((found.certificate.finalists, found.certificate.largest_relative_gap), (17, 0.0), "16 and the start");
    assert!(found.certificate.order_held && found.polish.is_none());
    assert_eq!(outcome.history.len(), 51);
    assert!(outcome.history.windows(2).all(|w| w[1].best <= w[0].best && w[1].seconds >= w[0].seconds));
    assert!(outcome.evaluate_s <= outcome.wall_s && outcome.wall_s > 0.0);
}

#[test]
fn threads_and_chunks_change_no_bit() {
    for algorithm in ["pso", "pio", "pio+", "random"] {
        let with = |threads, chunk| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mut mock = Mock::new(Landscape::Rastrigin).chunked(chunk);
            let spec = TuneSpec { polish: true, ..tune(algorithm, 33, 20) };
            let outcome = pool.install(|| study_of(&parameters(Some(2.0)), &spec, &mut mock)).expect("an outcome");
            let history: Vec<_> = outcome.history.iter().map(|r| (r.best, r.median, r.spread, r.failed)).collect();
            (outcome.winner, history)
        };
        assert_eq!(with(1, 1000), with(4, 5), "{algorithm}");
    }
}

#[test]
fn an_interrupt_keeps_the_best() {
    let flag = AtomicBool::new(false);
    let mut watcher = Interrupt { flag: &flag, at: 7, seen: Vec::new() };
    let spec = TuneSpec { polish: true, ..tune("pso", 20, 1000) };
    let (parameters, mut mock) = (parameters(None), Mock::new(Landscape::Sphere));
    let judge = Judge { oracle: &sphere, amplification: None, polisher: None };
    let outcome = run(&Study { parameters: &parameters, tune: &spec }, &mut mock, judge, &mut [&mut watcher], &flag);
    let outcome = outcome.expect("an outcome");
    assert_eq!((outcome.stop, outcome.stop.name(), outcome.generations), (StopReason::Interrupted, "interrupted", 8));
    assert_eq!(watcher.seen.len(), 8);
    assert_eq!(Some(winner(&outcome).objectives[0]), watcher.seen[7].1, "the best so far");
    assert_eq!((winner(&outcome).polish.clone(), mock.candidates), (None, 160), "no polish after an interrupt");
}

#[test]
fn an_interrupt_before_the_first_generation_leaves_no_winner() {
    let (parameters, spec, mut mock) = (parameters(None), tune("pso", 20, 10), Mock::new(Landscape::Sphere));
    let judge = Judge { oracle: &sphere, amplification: None, polisher: None };
    let study = Study { parameters: &parameters, tune: &spec };
    let outcome = run(&study, &mut mock, judge, &mut [], &AtomicBool::new(true)).expect("an outcome");
    assert_eq!((outcome.stop, outcome.winner, mock.calls), (StopReason::Interrupted, None, 0));
}

#[test]
fn every_limit_stops() {
    let base = tune("pso", 20, 400);
    let evaluations = study(&TuneSpec { evaluations: Some(119), ..base.clone() });
    assert_eq!((evaluations.stop, evaluations.evaluations), (StopReason::Evaluations, 100), "a sixth would not fit");
    let exact = study(&TuneSpec { evaluations: Some(120), ..base.clone() });
    assert_eq!((exact.stop, exact.evaluations), (StopReason::Evaluations, 120));
    let target = study(&TuneSpec { target: Some(1e-3), ..base.clone() });
    let (last, before) = (&target.history[target.generations - 1], &target.history[target.generations - 2]);
    assert!(target.stop == StopReason::Target && last.best <= Some(1e-3) && before.best > Some(1e-3));
    let wall_time = study(&TuneSpec { wall_time: Some(0.0), ..base.clone() });
    assert_eq!((wall_time.stop, wall_time.generations), (StopReason::WallTime, 1), "generation 0 always runs");
    let flat = Mock::new(Landscape::Sphere).failing(|_| true);
    let stalled = TuneSpec { stall: Some(5), ..base };
    let stall = study_of(&parameters(None), &stalled, &mut { flat }).expect("an outcome");
    assert_eq!((stall.stop, stall.generations), (StopReason::Stall, 5));
    let names = [StopReason::Evaluations, StopReason::Target, StopReason::WallTime, StopReason::Stall].map(|s| {
        assert_eq!(serde_json::to_value(s).expect("JSON"), s.name(), "{s:?}");
        s.name()
    });
    assert_eq!(names, ["evaluations", "target", "wall_time", "stall"]);
}

#[test]
fn a_study_in_which_everything_fails_has_no_winner() {
    let mut mock = Mock::new(Landscape::Sphere).failing(|_| true);
    let spec = TuneSpec { polish: true, ..tune("pio", 10, 20) };
    let outcome = study_of(&parameters(Some(1.0)), &spec, &mut mock).expect("an outcome");
    assert_eq!((outcome.winner, outcome.stop), (None, StopReason::Generations));
    assert_eq!(outcome.failed, outcome.evaluations);
    assert!(outcome.history.iter().all(|row| row.best.is_none()));
}

/// The search sees costs that are off; the start is the true optimum and wins by the oracle.
#[test]
fn the_winner_is_never_worse_than_the_baseline() {
    let optimum = [Landscape::optimum(0), Landscape::optimum(1)];
    let oracle = |x: &[f64]| Some(vec![(x[0] - 4.5).abs()]);
    let (parameters, spec, mut mock) = (parameters(Some(4.5)), tune("pso", 20, 30), Mock::new(Landscape::Sphere));
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let study = Study { parameters: &parameters, tune: &spec };
    let outcome = run(&study, &mut mock, judge, &mut [], &AtomicBool::new(false)).expect("an outcome");
    assert_eq!((winner(&outcome).candidate.as_slice(), winner(&outcome).objectives[0]), (&[4.5, 4.5][..], 0.0));
    assert!(!winner(&outcome).certificate.order_held, "the search preferred the neighbourhood of {optimum:?}");
    let left_out = TuneSpec { include_start: false, ..spec };
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let study = Study { parameters: &parameters, tune: &left_out };
    let outcome = run(&study, &mut mock, judge, &mut [], &AtomicBool::new(false)).expect("an outcome");
    assert!(winner(&outcome).objectives[0] > 0.1, "without the start it cannot know");
}

#[test]
fn polish_improves_and_is_counted_apart() {
    let spec = TuneSpec { polish: true, ..tune("random", 20, 10) };
    let mut mock = Mock::new(Landscape::Sphere);
    let outcome = study_of(&parameters(None), &spec, &mut mock).expect("an outcome");
    let polish = winner(&outcome).polish.as_ref().expect("a polish");
    assert_eq!(outcome.evaluations, 220);
    assert_eq!(mock.candidates, 220 + polish.evaluations as u64);
    assert!(polish.before[0] > 1e-3 && polish.after[0] < 1e-9, "{polish:?}");
    assert_eq!((polish.converged, polish.ended), (Some(true), Ended::Done));
    assert!(polish.gradient_norm.is_some_and(|norm| norm < 2e-3), "{polish:?}");
    assert_eq!(polish.after, winner(&outcome).objectives);
    assert_eq!(polish.before, winner(&outcome).certificate.objectives_f64);
}

/// The time is over, or an interrupt comes, when the search has ended: polish does not begin, and says so.
#[test]
fn polish_keeps_to_the_time_and_to_an_interrupt() {
    let spec = TuneSpec { polish: true, wall_time: Some(0.0), ..tune("random", 20, 10) };
    let outcome = study(&spec);
    let polish = winner(&outcome).polish.as_ref().expect("a polish");
    assert_eq!((polish.ended, polish.evaluations, polish.converged), (Ended::WallTime, 0, Some(false)));
    let flag = AtomicBool::new(false);
    // The oracle scores the baseline first; after that the finalists, when the search is over.
    let asked = std::sync::atomic::AtomicUsize::new(0);
    let oracle = |x: &[f64]| {
        flag.store(asked.fetch_add(1, Ordering::Relaxed) > 0, Ordering::Relaxed);
        sphere(x)
    };
    let spec = TuneSpec { wall_time: None, ..spec };
    let (parameters, mut mock) = (parameters(Some(4.0)), Mock::new(Landscape::Sphere));
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let outcome = run(&Study { parameters: &parameters, tune: &spec }, &mut mock, judge, &mut [], &flag);
    let outcome = outcome.expect("an outcome");
    let polish = winner(&outcome).polish.as_ref().expect("a polish");
    assert_eq!(
        (outcome.stop, polish.ended, polish.converged),
        (StopReason::Interrupted, Ended::Interrupted, Some(false))
    );
    assert_eq!(mock.candidates, outcome.evaluations, "nothing was scored after it");
}

/// A cost that knows nothing of b leaves b where the user put it, and says so; a is found all the same.
#[test]
fn what_the_cost_does_not_depend_on_stays_at_its_start() {
    struct Half;
    impl Evaluator for Half {
        fn objectives(&self) -> usize {
            1
        }
        fn evaluate(&mut self, population: &Population) -> Evaluation {
            let costs = population.rows().map(|x| 40.0 + (x[0] - 1.0).powi(2)).collect::<Vec<f64>>();
            let status = vec![crate::evaluate::Status::OK; costs.len()];
            Evaluation::new(1, costs, status)
        }
        fn device(&self) -> crate::evaluate::Device {
            Mock::new(Landscape::Sphere).device()
        }
    }
    let oracle = |x: &[f64]| Some(vec![40.0 + (x[0] - 1.0).powi(2)]);
    for algorithm in ["pso", "random"] {
        let spec = TuneSpec { polish: true, ..tune(algorithm, 20, 10) };
        let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
        let parameters = parameters(Some(3.25));
        let study = Study { parameters: &parameters, tune: &spec };
        let outcome = run(&study, &mut Half, judge, &mut [], &AtomicBool::new(false)).expect("an outcome");
        let found = winner(&outcome);
        assert!((found.candidate[0] - 1.0).abs() < 2e-3 && found.candidate[1].total_cmp(&3.25).is_eq(), "{found:?}");
        let polish = found.polish.as_ref().expect("a polish");
        assert_eq!((polish.left_at_start.as_slice(), polish.converged), (&[1][..], Some(true)));
        assert_eq!(polish.after, found.objectives);
    }
}

/// The polisher pulls towards its own optimum; the oracle disagrees and the winner stays.
#[test]
fn polish_never_makes_it_worse_by_the_oracle() {
    let spec = TuneSpec { polish: true, ..tune("pso", 20, 40) };
    let oracle = |x: &[f64]| Some(vec![1.0 - 1e-3 * Landscape::Sphere.value(x)]);
    let (parameters, mut mock, mut polisher) =
        (parameters(None), Mock::new(Landscape::Sphere), Mock::new(Landscape::Sphere));
    let judge = Judge { oracle: &oracle, amplification: None, polisher: Some(&mut polisher) };
    let study = Study { parameters: &parameters, tune: &spec };
    let outcome = run(&study, &mut mock, judge, &mut [], &AtomicBool::new(false)).expect("an outcome");
    let polish = winner(&outcome).polish.as_ref().expect("a polish");
    assert_eq!(polish.before, polish.after);
    assert_eq!(polisher.candidates, polish.evaluations as u64, "polish runs on the evaluator given for it");
    assert_eq!(mock.candidates, outcome.evaluations);
}

#[test]
fn wrong_use_says_what_to_do() {
    let message = |parameters: &Parameters, tune: &TuneSpec| {
        study_of(parameters, tune, &mut Mock::new(Landscape::Sphere)).expect_err("an error").to_string()
    };
    let fixed = Parameters { all: Vec::new() };
    assert!(message(&fixed, &tune("pso", 9, 9)).starts_with("no parameter is searched: give at least one a range"));
    let small = TuneSpec { evaluations: Some(8), ..tune("pso", 9, 9) };
    assert!(message(&parameters(None), &small).starts_with("8 evaluations do not hold one generation of 9: raise"));
    assert!(message(&parameters(None), &tune("ps0", 9, 9)).contains("did you mean \"pso\"?"));
}
