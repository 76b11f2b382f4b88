//! A GPU that fails: the CPU goes on in the same precision with the same tape, and it is said once.

use crate::case::{Case, Text};
use crate::logs::Shape;
use crate::{adapter, bits, cpu, gpu, options};
use kfgpu::evaluate::gpu::{AdapterError, GpuError, GpuEvaluator};
use kfgpu::evaluate::{Backend, Evaluation, Evaluator, Population, Precision};
use kfgpu::reference;
use kfgpu::study::{self, Generation, Judge, Observer, Outcome, Scored, Snapshot, Study};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

fn case() -> Case {
    let text = Text {
        model: "kind = \"constant-velocity\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0, 0]\nP0 = [10, 10]",
        ..Text::BASIC
    };
    Case::new("faults", &text, Shape::regular(&[80, 50]), 130)
}

/// Collects what is said.
fn listen(evaluator: &mut GpuEvaluator) -> Arc<Mutex<Vec<String>>> {
    let said = Arc::new(Mutex::new(Vec::new()));
    let listener = Arc::clone(&said);
    evaluator.on_failure(move |sentence| listener.lock().unwrap().push(sentence.to_owned()));
    said
}

#[test]
fn after_a_loss_costs_are_those_of_the_cpu_in_the_same_precision() {
    let Some(adapter) = adapter() else { return };
    let case = case();
    for (precision, evaluations_before) in [(Precision::F32, 0), (Precision::F32, 2), (Precision::F64, 1)] {
        let mut evaluator = gpu(&case, &options(&adapter, precision));
        let said = listen(&mut evaluator);
        for _ in 0..evaluations_before {
            evaluator.evaluate(&case.population);
        }
        assert_eq!((evaluator.failure(), evaluator.device().backend), (None, Backend::Gpu), "before the loss");
        evaluator.lose_device();
        let expected = bits(&cpu(&case, precision).evaluate(&case.population));
        for _ in 0..2 {
            assert_eq!(
                bits(&evaluator.evaluate(&case.population)),
                expected,
                "{precision}, {evaluations_before} before"
            );
        }
        let said = said.lock().unwrap();
        assert_eq!(said.len(), 1, "said once: {said:?}");
        assert!(said[0].contains(&adapter) && said[0].ends_with(&format!("CPU in {precision}")), "{}", said[0]);
        let device = evaluator.device();
        assert_eq!(device.backend, Backend::Cpu, "the report says where the search ended");
        assert!(device.adapter.name.contains(&adapter), "and what failed: {}", device.adapter);
        assert_eq!(device.precision, precision, "in the precision it began with");
    }
}

/// Loses the GPU before the evaluation of a generation; or computes on the GPU before it and on the CPU from it on.
struct Lossy {
    evaluator: GpuEvaluator,
    cpu: Option<kfgpu::evaluate::CpuEvaluator>,
    generation: usize,
    lost: usize,
    seen: Vec<Evaluation>,
}

impl Evaluator for Lossy {
    fn objectives(&self) -> usize {
        self.evaluator.objectives()
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        let after = self.generation >= self.lost;
        if self.generation == self.lost && self.cpu.is_none() {
            self.evaluator.lose_device();
        }
        self.generation += 1;
        let evaluation = match &mut self.cpu {
            Some(cpu) if after => cpu.evaluate(population),
            _ => self.evaluator.evaluate(population),
        };
        self.seen.push(evaluation.clone());
        evaluation
    }

    fn device(&self) -> kfgpu::evaluate::Device {
        self.evaluator.device()
    }
}

#[test]
fn a_study_that_loses_its_gpu_ends_as_one_that_goes_on_with_the_cpu() {
    let Some(adapter) = adapter() else { return };
    let mut case = case();
    case.problem.tune.population = 20;
    case.problem.tune.generations = 6;
    case.problem.tune.polish = false;
    case.problem.tune.objectives.truncate(1);
    let run = |with_cpu: bool| {
        let evaluator = gpu(&case, &options(&adapter, Precision::F32));
        let cpu = with_cpu.then(|| cpu(&case, Precision::F32));
        let mut lossy = Lossy { evaluator, cpu, generation: 0, lost: 3, seen: vec![] };
        let oracle = |candidate: &[f64]| reference::costs(&case.problem, &case.log, candidate).ok();
        let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
        let study = Study::of(&case.problem);
        let outcome = study::run(&study, &mut lossy, judge, &mut [], &AtomicBool::new(false)).unwrap();
        (outcome.winner, lossy)
    };
    let ((winner, lossy), (expected, switched)) = (run(false), run(true));
    assert_eq!(lossy.seen.len(), 7, "every generation is evaluated");
    assert!(lossy.evaluator.failure().is_some() && switched.evaluator.failure().is_none(), "only one was lost");
    assert!(winner.is_some(), "and there is a winner");
    assert_eq!(winner, expected, "winner and certificate");
    let all = |lossy: &Lossy| lossy.seen.iter().flat_map(bits).collect::<Vec<_>>();
    assert_eq!(all(&lossy), all(&switched), "costs of every generation");
}

/// Keeps the state after every generation.
#[derive(Default)]
struct Keeper(Vec<Snapshot>);

impl Observer for Keeper {
    fn generation(&mut self, _row: &Generation, _best: Option<&Scored>) {}

    fn keeps_states(&self) -> bool {
        true
    }

    fn state(&mut self, make: &dyn Fn() -> Snapshot, ended: bool) {
        self.0.extend((!ended).then(make));
    }
}

/// What does not depend on the clock.
fn without_times(mut outcome: Outcome) -> Outcome {
    outcome.history.iter_mut().for_each(|row| row.seconds = 0.0);
    Outcome { evaluate_s: 0.0, wall_s: 0.0, ..outcome }
}

#[test]
fn a_loss_ends_as_the_checkpoint_before_it_resumed_on_the_cpu() {
    let Some(adapter) = adapter() else { return };
    let mut case = case();
    case.problem.tune.population = 20;
    case.problem.tune.generations = 6;
    case.problem.tune.polish = true;
    case.problem.tune.objectives.truncate(1);
    let oracle = |candidate: &[f64]| reference::costs(&case.problem, &case.log, candidate).ok();
    let (study, flag) = (Study::of(&case.problem), AtomicBool::new(false));
    for lost in 1..7 {
        let evaluator = gpu(&case, &options(&adapter, Precision::F32));
        let mut lossy = Lossy { evaluator, cpu: None, generation: 0, lost, seen: vec![] };
        let (mut polisher, mut keeper) = (cpu(&case, Precision::F64), Keeper::default());
        let judge = Judge { oracle: &oracle, amplification: None, polisher: Some(&mut polisher) };
        let outcome = study::run(&study, &mut lossy, judge, &mut [&mut keeper], &flag).unwrap();
        let at = |generation: usize| &keeper.0[generation].device;
        assert_eq!((at(lost - 1).backend, at(lost).backend), (Backend::Gpu, Backend::Cpu), "lost at {lost}");
        assert_eq!((at(0).precision, at(6).precision), (Precision::F32, Precision::F32), "lost at {lost}");

        let (mut resumed, mut polisher) = (cpu(&case, Precision::F32), cpu(&case, Precision::F64));
        let judge = Judge { oracle: &oracle, amplification: None, polisher: Some(&mut polisher) };
        let again = study::resume(&study, &keeper.0[lost - 1], &mut resumed, judge, &mut [], &flag).unwrap();
        assert_eq!(without_times(again), without_times(outcome), "lost at {lost}");
    }
}

#[test]
fn an_adapter_that_is_not_there_is_answered_with_those_that_are() {
    let Some(adapter) = adapter() else { return };
    let case = case();
    let error = GpuEvaluator::new(&case.problem, &case.log, &options("no such card", Precision::F32)).err();
    let Some(GpuError::Adapter(error @ AdapterError::Unknown { .. })) = error else {
        panic!("{error:?}");
    };
    assert!(error.to_string().contains("no such card") && error.to_string().contains(&adapter), "{error}");
}
