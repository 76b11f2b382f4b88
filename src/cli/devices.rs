//! `kfgpu devices`: the adapters of this machine.

mod accuracy;
mod listing;

use clap::Args;

use super::console::Console;
use super::{Ending, files, stderr};

/// List the GPUs of this machine with their limits, and which one `--device auto` would take.
#[derive(Debug, Args)]
pub(super) struct Devices {
    /// Print one JSON object on stdout (default: a list), for programs.
    #[arg(long)]
    json: bool,
    /// Measure the functions of formulas on each GPU, in f32: kfgpu's own, which filters use, and the adapter's (default: list alone).
    #[arg(long)]
    accuracy: bool,
}

impl Devices {
    pub(super) fn run(&self, _console: Console) -> anyhow::Result<Ending> {
        let listing = listing::Listing::new(stderr::without_desktop(crate::evaluate::gpu::adapters));
        if self.accuracy {
            let measured: Vec<accuracy::Accuracy> = listing
                .names()
                .map(|name| stderr::without_desktop(|| accuracy::Accuracy::measure(name)))
                .collect::<Result<_, _>>()?;
            if self.json {
                files::print_json(&measured)?;
            } else {
                files::print(&accuracy::text(&measured))?;
            }
            return Ok(Ending::Done);
        }
        if self.json {
            files::print_json(&listing)?;
        } else {
            files::print(&listing.to_string())?;
        }
        Ok(Ending::Done)
    }
}
