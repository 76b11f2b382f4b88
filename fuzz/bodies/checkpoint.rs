//! Checkpoints: what reads must be written back the same, and its search must go on or be refused.

use std::sync::atomic::AtomicBool;

use kfgpu::evaluate::mock::{Landscape, Mock, MultiObjective};
use kfgpu::model::Problem;
use kfgpu::study::{self, Checkpoint, Generation, Identity, Judge, Observer, Scored, Snapshot, Source, Study};

/// Any bytes as a checkpoint, as they are and under a checksum that holds.
pub(crate) fn checkpoint(bytes: &[u8]) {
    assert!(Checkpoint::read(bytes).is_err() || bytes.starts_with(b"kfgpu"), "only a checkpoint is one");
    let Ok(checkpoint) = Checkpoint::read(&Checkpoint::seal(bytes)) else { return };
    let written = checkpoint.to_bytes().expect("what was read can be written");
    // By its bytes, since NaN is not equal to itself.
    let again = Checkpoint::read(&written).and_then(|again| again.to_bytes());
    assert_eq!(again.as_ref(), Ok(&written), "written and read back");
    let Some(objectives) = objectives(&checkpoint.snapshot.algorithm) else { return };
    let problem = problem(&checkpoint.snapshot.algorithm);
    let from = Some(&checkpoint.snapshot);
    search(&problem, objectives, from, &mut []);
}

/// Bodies of real checkpoints: one an algorithm, after its second generation.
pub(crate) fn bodies() -> impl Iterator<Item = (&'static str, Vec<u8>)> {
    kfgpu::optimize::ALGORITHMS.iter().map(|row| {
        let problem = problem(row.name);
        let mut second = Second(None);
        search(&problem, row.maximum_objectives.min(2), None, &mut [&mut second]);
        let log = kfgpu::simulate::simulate(&problem, None).expect("a log");
        let snapshot = second.0.expect("two generations");
        let checkpoint = Checkpoint::new(Identity::of(&problem, &log), Source::default(), snapshot);
        let file = checkpoint.to_bytes().expect("a file");
        // The header that `seal` puts before a body.
        (row.name, file[Checkpoint::seal(&[]).len()..].to_vec())
    })
}

struct Second(Option<Snapshot>);

impl Observer for Second {
    fn generation(&mut self, _: &Generation, _: Option<&Scored>) {}

    fn keeps_states(&self) -> bool {
        true
    }

    fn state(&mut self, make: &dyn Fn() -> Snapshot, _ended: bool) {
        let snapshot = make();
        if snapshot.history.len() == 2 {
            self.0 = Some(snapshot);
        }
    }
}

/// As many as the algorithm is tried with; `None` for a name that no algorithm has.
fn objectives(algorithm: &str) -> Option<usize> {
    kfgpu::optimize::algorithm(algorithm).ok().map(|row| row.maximum_objectives.min(2))
}

fn problem(algorithm: &str) -> Problem {
    let objectives = if objectives(algorithm) == Some(1) { "[\"nll\"]" } else { "[\"nll\", \"nis\"]" };
    let text = format!(
        "[data]\nmeasurements = [\"z\"]\n[model]\nstate = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\nQ = [\"q\"]\n\
         R = [\"r\"]\nx0 = [0]\nP0 = [10]\n[parameters]\nq = {{ min = 0.1, max = 0.9, start = 0.5 }}\n\
         r = {{ min = 0.1, max = 0.9, start = 0.5 }}\n[tune]\nalgorithm = \"{algorithm}\"\n\
         objectives = {objectives}\npopulation = 6\ngenerations = 4\npolish = false\n[simulate]\nsteps = 3\nseed = 1\n"
    );
    Problem::parse(&text, "fuzz.toml").expect("a problem")
}

fn search(problem: &Problem, objectives: usize, from: Option<&Snapshot>, observers: &mut [&mut dyn Observer]) {
    let mut mock = if objectives == 1 { Mock::new(Landscape::Sphere) } else { Mock::new(MultiObjective::Zdt1) };
    let costs = vec![1.0; objectives];
    let oracle = |_: &[f64]| Some(costs.clone());
    let judge = Judge { oracle: &oracle, amplification: None, polisher: None };
    let (study, go_on) = (Study::of(problem), AtomicBool::new(false));
    let _ = match from {
        Some(from) => study::resume(&study, from, &mut mock, judge, observers, &go_on),
        None => study::run(&study, &mut mock, judge, observers, &go_on),
    };
}
