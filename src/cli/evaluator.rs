//! The evaluator of every verb that scores candidates: which device, which precision, and what is said about it.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::ensure;

use super::console::Console;
use super::options::{Compute, DeviceChoice, PrecisionChoice};
use crate::data::Log;
use crate::evaluate::{Backend, CpuEvaluator, CpuOptions, Device, Evaluation, Evaluator, Population, Precision};
use crate::filter::{Program, trace};
use crate::model::Problem;
use crate::number::short;
use crate::reference;

#[cfg(feature = "gpu")]
mod on_gpu;
#[cfg(feature = "gpu")]
pub(super) use on_gpu::has_adapter;

/// Candidate-rows x operations of a step from which `auto` looks for a GPU. The lanes do about 2e9 to 4e9 a second and
/// core, so this is a few seconds of two cores; finding, opening and compiling for a GPU takes about half a second.
pub(super) const GPU_PAYS: f64 = 2e10;

/// What is said where the program has no GPU evaluator.
#[cfg(not(feature = "gpu"))]
pub(super) const BUILT_WITHOUT: &str =
    "this kfgpu was built without its GPU evaluator: use --device cpu, or build it with the feature `gpu`";

/// Sentences for the user that a report repeats. Some come in the middle of a study.
#[derive(Debug, Clone)]
pub(super) struct Notices {
    console: Console,
    said: Arc<Mutex<Vec<String>>>,
}

impl Notices {
    fn new(console: Console) -> Self {
        Self { console, said: Arc::default() }
    }

    /// Prints a warning and keeps it.
    pub(super) fn warn(&self, sentence: &str) {
        self.console.warn(sentence);
        self.said.lock().unwrap_or_else(PoisonError::into_inner).push(sentence.to_owned());
    }

    /// All warnings so far.
    pub(super) fn said(&self) -> Vec<String> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// An evaluator on the device that was asked for, or on the one that suits.
pub(super) struct Chosen {
    evaluator: Box<dyn Evaluator>,
    /// What the same problem is in f64: traced once for all that need it.
    double: Program,
    pub(super) notices: Notices,
}

impl Chosen {
    /// For about `candidates` candidates in all.
    pub(super) fn new(
        problem: &Problem,
        log: &Log,
        compute: &Compute,
        candidates: f64,
        console: Console,
    ) -> anyhow::Result<Self> {
        let notices = Notices::new(console);
        let asked = compute.adapter.is_some() || compute.device == DeviceChoice::Gpu;
        ensure!(
            !(asked && compute.device == DeviceChoice::Cpu),
            "--adapter names a GPU and --device cpu asks for none (leave one of them out)"
        );
        let double = trace(problem, log, &problem.tune.scorers(), None)?.constrained(&problem.tune.constraints);
        if !asked && (compute.device == DeviceChoice::Cpu || work(&double, candidates) < GPU_PAYS) {
            let evaluator = Box::new(CpuEvaluator::with_double(problem, log, &double, compute.cpu())?);
            return Ok(Self { evaluator, double, notices });
        }
        if let Some(sentence) =
            (!asked && compute.precision == PrecisionChoice::Auto).then(|| amplified(problem, log)).flatten()
        {
            notices.warn(&sentence);
            let evaluator = Box::new(CpuEvaluator::with_double(problem, log, &double, compute.cpu())?);
            return Ok(Self { evaluator, double, notices });
        }
        #[cfg(feature = "gpu")]
        let found = on_gpu::build(problem, log, &double, compute, asked, &notices)?;
        #[cfg(not(feature = "gpu"))]
        let found = {
            ensure!(!asked, BUILT_WITHOUT);
            None
        };
        let evaluator = match found {
            Some(evaluator) => evaluator,
            None => Box::new(CpuEvaluator::with_double(problem, log, &double, compute.cpu())?),
        };
        Ok(Self { evaluator, double, notices })
    }

    /// An evaluator on the CPU in f64, which has nothing left to trace.
    pub(super) fn in_f64(&self, options: CpuOptions) -> CpuEvaluator {
        CpuEvaluator::of_program(self.double.clone(), options.threads)
    }

    /// Says where the costs of a resumed search come from, if that is another kind of device than before.
    pub(super) fn say_if_moved(&self, before: &Device) {
        let now = self.evaluator.device();
        if now.backend != before.backend {
            let name =
                |device: &Device| format!("the {} ({})", device.backend.to_string().to_uppercase(), device.adapter);
            let (ran, runs, format) = (name(before), name(&now), now.precision);
            self.notices.warn(&format!("the search ran on {ran}: going on in {format} on {runs}"));
        }
    }

    /// Whether polish, a search in f64 of a few candidates at a time, can use it too.
    pub(super) fn can_polish(&self) -> bool {
        let Device { backend, precision, .. } = self.evaluator.device();
        (backend, precision) == (Backend::Cpu, Precision::F64)
    }
}

impl Evaluator for Chosen {
    fn objectives(&self) -> usize {
        self.evaluator.objectives()
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        self.evaluator.evaluate(population)
    }

    fn device(&self) -> Device {
        self.evaluator.device()
    }

    fn rows(&self) -> usize {
        self.evaluator.rows()
    }
}

/// Why `auto` stays with the CPU in f64: the start's filter amplifies the last digits of the log, which single precision lacks.
fn amplified(problem: &Problem, log: &Log) -> Option<String> {
    if problem.filter.is_linear() {
        return None;
    }
    let amplification = reference::amplification(problem, log, &problem.parameters.baseline()).ok()?;
    (amplification >= 1.0).then(|| {
        format!(
            "the {} filter loses the track at the start values (amplification {}, where single precision needs one below 1): \
             computing on the CPU in f64 (choose with --device and --precision)",
            problem.filter.name(),
            short(amplification, 2)
        )
    })
}

/// No adapter is here.
#[cfg(not(feature = "gpu"))]
pub(super) const fn has_adapter(_name: &str) -> bool {
    false
}

/// Operations of so many candidates' runs over the log.
#[expect(clippy::cast_precision_loss, reason = "an estimate")]
fn work(program: &Program, candidates: f64) -> f64 {
    candidates * program.operations() as f64
}
