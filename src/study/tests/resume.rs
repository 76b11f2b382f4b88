//! Searches that are taken up again, and generations in several parts.

use super::*;
use crate::evaluate::Evaluation;
use crate::optimize::{ALGORITHMS, RestoreError};

/// Keeps every state, and whether it was the last.
#[derive(Default)]
struct Keeper(Vec<(Snapshot, bool)>);

impl Observer for Keeper {
    fn generation(&mut self, _row: &Generation, _best: Option<&Scored>) {}

    fn keeps_states(&self) -> bool {
        true
    }

    fn state(&mut self, make: &dyn Fn() -> Snapshot, ended: bool) {
        self.0.push((make(), ended));
    }
}

/// What does not depend on the clock.
fn bits(mut outcome: Outcome) -> Outcome {
    outcome.history.iter_mut().for_each(|row| row.seconds = 0.0);
    Outcome { evaluate_s: 0.0, wall_s: 0.0, ..outcome }
}

fn judge<'a>() -> Judge<'a> {
    Judge { oracle: &sphere, amplification: None, polisher: None }
}

/// A whole study with every state, of candidates that fail in a corner.
fn kept(tune: &TuneSpec) -> (Outcome, Vec<(Snapshot, bool)>) {
    let (parameters, mut keeper) = (parameters(Some(4.0)), Keeper::default());
    let study = Study { parameters: &parameters, tune };
    let outcome = run(&study, &mut mock(), judge(), &mut [&mut keeper], &AtomicBool::new(false));
    (bits(outcome.expect("an outcome")), keeper.0)
}

fn mock() -> Mock {
    Mock::new(Landscape::Rastrigin).failing(|x| x[0] + x[1] > 7.0)
}

fn resumed(tune: &TuneSpec, from: &Snapshot, threads: usize) -> Result<Outcome, StudyError> {
    let parameters = parameters(Some(4.0));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let study = Study { parameters: &parameters, tune };
    let mut evaluator = mock().chunked(5);
    pool.install(|| resume(&study, from, &mut evaluator, judge(), &mut [], &AtomicBool::new(false))).map(bits)
}

#[test]
fn from_every_generation_on_every_bit_is_the_same() {
    for (row, polish) in ALGORITHMS.iter().flat_map(|row| [(row, false), (row, true)]) {
        let tune = TuneSpec { polish, ..tune(row.name, 13, 12) };
        let (whole, states) = kept(&tune);
        assert_eq!(states.len(), 14, "{}: 13 generations and the end", row.name);
        for (g, (state, ended)) in states.iter().enumerate() {
            assert_eq!((state.history.len(), *ended), ((g + 1).min(13), g == 13), "{}", row.name);
            let again = resumed(&tune, state, 1 + g % 3).expect(row.name);
            assert_eq!(again, whole, "{} from generation {g}, polish {polish}", row.name);
        }
    }
}

/// Limits are no part of a search: one that ended early by any of them goes on.
#[test]
fn a_search_that_a_limit_ended_goes_on_without_it() {
    for name in ["pso", "pso-inertia", "pio", "pio+", "random"] {
        let whole = tune(name, 13, 20);
        let limits = [
            TuneSpec { evaluations: Some(100), ..whole.clone() },
            TuneSpec { stall: Some(2), ..whole.clone() },
            TuneSpec { target: Some(40.0), ..whole.clone() },
            TuneSpec { wall_time: Some(0.0), ..whole.clone() },
        ];
        for limited in limits {
            let (early, states) = kept(&limited);
            assert_ne!(early.stop, StopReason::Generations, "{name}");
            let (last, ended) = states.last().expect("a state");
            assert!(*ended && last.history.len() == early.generations, "{name}: {:?}", early.stop);
            assert_eq!(resumed(&limited, last, 2).expect(name), early, "{name}: ended is ended");
            assert_eq!(resumed(&whole, last, 2).expect(name), kept(&whole).0, "{name} after {:?}", early.stop);
        }
    }
}

#[test]
fn time_spent_before_counts() {
    let tune = TuneSpec { wall_time: Some(100.0), ..tune("pso", 20, 400) };
    let mut state = kept(&TuneSpec { generations: 3, ..tune.clone() }).1.swap_remove(1).0;
    state.wall_s = 101.0;
    let outcome = resumed(&tune, &state, 1).expect("an outcome");
    assert_eq!((outcome.stop, outcome.generations), (StopReason::WallTime, 2));
}

#[test]
fn a_state_of_another_search_is_refused() {
    type Change<'a> = &'a dyn Fn(&mut Snapshot);
    let spec = tune("pso", 13, 12);
    let state = kept(&spec).1.swap_remove(3).0;
    let refused = |change: Change<'_>| {
        let mut broken = state.clone();
        change(&mut broken);
        resumed(&spec, &broken, 1).expect_err("an error").to_string()
    };
    let cases: [(&str, Change<'_>); 9] = [
        ("its algorithm is another", &|s| s.algorithm = "pio".to_owned()),
        ("numbers of parameters and objectives", &|s| s.archive[0].costs.clear()),
        ("numbers of parameters and objectives", &|s| {
            s.start = Some(Scored { candidate: vec![], costs: vec![1.0], violation: 0.0 })
        }),
        ("its best candidates cannot be", &|s| s.archive[1].costs[0] = f64::NAN),
        ("its history has gaps", &|s| s.history.clear()),
        ("its history has gaps", &|s| s.history[1].generation = 7),
        ("its counts cannot be", &|s| s.history[0].failed = usize::MAX),
        ("its times are no times", &|s| s.wall_s = f64::NAN),
        ("algorithm \"pso\" cannot take up this state", &|s| s.optimizer.truncate(9)),
    ];
    for (expected, change) in cases {
        let message = refused(change);
        assert!(message.contains(expected), "{expected:?} in {message:?}");
    }
    let wider = resumed(&TuneSpec { population: 14, ..spec }, &state, 1).expect_err("an error").to_string();
    assert!(wider.starts_with("algorithm \"pso\" cannot take up this state: "), "{wider}");
}

/// Asks for each generation of another optimiser in parts.
struct InParts {
    whole: Box<dyn Optimizer>,
    part: usize,
    population: Population,
    told: Vec<f64>,
}

impl Optimizer for InParts {
    fn name(&self) -> &'static str {
        self.whole.name()
    }

    fn ask(&mut self) -> Option<Population> {
        if self.told.is_empty() {
            self.population = self.whole.ask()?;
        }
        let rest = self.population.rows().skip(self.told.len()).take(self.part).flatten();
        Some(Population::from_rows(2, rest.copied().collect()))
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        self.told.extend((0..population.len()).map(|i| costs.costs(i)[0]));
        if self.told.len() == self.population.len() {
            let told = std::mem::take(&mut self.told);
            let status = vec![crate::evaluate::Status::OK; told.len()];
            self.whole.tell(&self.population, &Evaluation::new(1, told, status));
        }
    }

    fn generation_finished(&self) -> bool {
        self.told.is_empty()
    }

    fn save(&self) -> Option<Vec<u8>> {
        assert!(self.generation_finished(), "states are asked for between generations");
        self.whole.save()
    }

    fn restore(&mut self, saved: &[u8]) -> Result<(), RestoreError> {
        self.whole.restore(saved)
    }
}

fn in_parts(tune: &TuneSpec, from: Option<&Snapshot>) -> (Outcome, Vec<(Snapshot, bool)>) {
    let (parameters, mut keeper, mut mock) = (parameters(Some(4.0)), Keeper::default(), mock());
    let study = Study { parameters: &parameters, tune };
    let whole = study.optimizer(1).expect("an optimiser");
    let mut optimizer = InParts { whole, part: 8, population: Population::new(2), told: Vec::new() };
    let task = Task { study: &study, optimizer: &mut optimizer, from };
    let outcome = run_task(task, &mut mock, judge(), &mut [&mut keeper], &AtomicBool::new(false));
    (bits(outcome.expect("an outcome")), keeper.0)
}

#[test]
fn parts_of_a_generation_are_one_row_of_the_history() {
    let spec = tune("pio+", 20, 9);
    assert_eq!(in_parts(&spec, None).0, kept(&spec).0, "8, 8 and 4 are 20");
    // 100 evaluations are five generations, 116 hold two parts more.
    let limited = TuneSpec { evaluations: Some(119), ..spec.clone() };
    let (outcome, states) = in_parts(&limited, None);
    assert_eq!((outcome.stop, outcome.evaluations, outcome.generations), (StopReason::Evaluations, 116, 6));
    let evaluations: Vec<u64> = outcome.history.iter().map(|row| row.evaluations).collect();
    assert_eq!(evaluations, [20, 40, 60, 80, 100, 116]);
    let failed: u64 = outcome.history.iter().map(|row| row.failed as u64).sum();
    assert_eq!(failed, outcome.failed);
    let (last, ended) = states.last().expect("a state");
    assert_eq!((last.history.len(), *ended), (5, false), "half a generation is nothing to resume from");
    assert_eq!(in_parts(&limited, Some(last)).0, outcome, "the same end again");
    assert_eq!(in_parts(&spec, Some(last)).0, kept(&spec).0, "and on without the limit");
}
