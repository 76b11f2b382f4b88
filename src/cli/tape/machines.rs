//! The machines that a row is run on.

use super::Tape;
use crate::cli::console::Console;
use crate::evaluate::Precision;
use crate::evaluate::probe::{Probe, Seen};

/// A row on a machine.
pub(super) struct Machine {
    /// Head of its column.
    pub(super) name: String,
    pub(super) seen: Seen,
}

/// The row by the program of one precision: on the lanes, and on an adapter where there is one.
pub(super) struct Machines {
    pub(super) probe: Probe,
    pub(super) lanes: Machine,
    pub(super) adapter: Option<Machine>,
}

impl Machines {
    pub(super) fn new(probe: Probe) -> Self {
        let name = format!("{} lanes", probe.program().precision());
        let seen = probe.on_lanes();
        Self { probe, lanes: Machine { name, seen }, adapter: None }
    }

    /// In order.
    pub(super) fn all(&self) -> impl Iterator<Item = &Machine> {
        std::iter::once(&self.lanes).chain(&self.adapter)
    }

    /// The same tape in f64, where that is another run.
    pub(super) fn in_f64(&self) -> Option<Machine> {
        let is_single = self.probe.program().precision() == Precision::F32;
        is_single.then(|| Machine { name: "in f64".to_owned(), seen: self.probe.in_f64() })
    }
}

impl Tape {
    /// Adds the adapter that was named or is there; says why where there is none.
    #[cfg(feature = "gpu")]
    pub(super) fn add_adapter(&self, machines: &mut Machines, console: Console) -> anyhow::Result<()> {
        use crate::cli::stderr;
        use crate::evaluate::gpu;
        let Machines { probe, lanes, adapter } = machines;
        if probe.candidate().is_empty() {
            console.note("no column for a GPU: it runs candidates, and the problem has no searched parameters");
            return Ok(());
        }
        match stderr::without_desktop(|| gpu::probe(probe, &lanes.seen, self.adapter.as_deref())) {
            Ok((info, seen)) => {
                console.note(format_args!("adapter: {}, in {}", info.name, probe.program().precision()));
                *adapter = Some(Machine { name: "adapter".to_owned(), seen });
            }
            Err(error) if self.adapter.is_some() => return Err(error.into()),
            Err(error) => console.note(format_args!("no column for a GPU: {error}")),
        }
        Ok(())
    }

    /// Says that there is none.
    #[cfg(not(feature = "gpu"))]
    pub(super) fn add_adapter(&self, _machines: &mut Machines, console: Console) -> anyhow::Result<()> {
        anyhow::ensure!(self.adapter.is_none(), crate::cli::evaluator::BUILT_WITHOUT);
        console.note("no column for a GPU: this kfgpu was built without its GPU evaluator");
        Ok(())
    }
}
