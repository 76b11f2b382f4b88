//! The listing, for people and as JSON.

use crate::cli::evaluator::GPU_PAYS;
use crate::evaluate::gpu::AdapterInfo;
use serde::Serialize;
use std::fmt;

/// What there is, and what `auto` makes of it.
#[derive(Debug, Serialize)]
pub(super) struct Listing {
    adapters: Vec<AdapterInfo>,
    auto: Auto,
}

#[derive(Debug, Serialize)]
struct Auto {
    /// The adapter for a large job; none where there is no real one.
    adapter: Option<String>,
    /// Candidate-rows x operations of a step from which a job is large.
    operations: f64,
    why: String,
}

impl Listing {
    pub(super) fn new(adapters: Vec<AdapterInfo>) -> Self {
        let real = adapters.iter().find(|a| !a.is_software()).map(|a| a.name.clone());
        let size = format!("rows x candidates x generations x operations of a step >= {GPU_PAYS:.0e}");
        let why = match &real {
            Some(name) => format!("`{name}` for a job of {size}, else the CPU"),
            None if adapters.is_empty() => "the CPU: there is no adapter".to_owned(),
            None => "the CPU: there are software renderers only, which are slower than the CPU".to_owned(),
        };
        Self { adapters, auto: Auto { adapter: real, operations: GPU_PAYS, why } }
    }

    /// The adapters by name.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.adapters.iter().map(|adapter| adapter.name.as_str())
    }
}

/// Bytes in the largest unit that keeps them whole enough to read.
fn bytes(bytes: u64) -> String {
    const GIB: u64 = 1 << 30;
    if bytes >= 1 << 50 {
        return "no limit".to_owned();
    }
    if bytes >= GIB { format!("{} GiB", bytes / GIB) } else { format!("{} MiB", bytes >> 20) }
}

impl fmt::Display for Listing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let yes = |b: bool| if b { "yes" } else { "no" };
        for a in &self.adapters {
            writeln!(f, "{}", a.name)?;
            writeln!(f, "  kind        {} ({}, {})", a.kind, a.backend, a.driver)?;
            writeln!(f, "  precision   f32{}", if a.f64 { " and f64" } else { "; no f64" })?;
            writeln!(f, "  binding     {} at most, buffer {}", bytes(a.max_binding), bytes(a.max_buffer))?;
            writeln!(f, "  uniform     {} KiB at most", a.max_uniform >> 10)?;
            writeln!(f, "  timestamps  {}", yes(a.timestamps))?;
        }
        if self.adapters.is_empty() {
            writeln!(f, "no adapter (tried Vulkan, Metal and DX12)")?;
        }
        writeln!(f, "--device auto takes {}", self.auto.why)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: &str) -> AdapterInfo {
        AdapterInfo {
            name: name.to_owned(),
            backend: "vulkan".to_owned(),
            kind: kind.to_owned(),
            driver: "1.0".to_owned(),
            f64: false,
            timestamps: true,
            max_binding: 128 << 20,
            max_buffer: u64::MAX,
            max_uniform: 65_536,
        }
    }

    #[test]
    fn auto_takes_real_hardware_only() {
        let picked = |adapters| Listing::new(adapters).auto.adapter;
        assert_eq!(picked(vec![]), None, "nothing there");
        assert_eq!(picked(vec![adapter("llvmpipe", "software")]), None, "software alone");
        let both = vec![adapter("Card", "discrete"), adapter("llvmpipe", "software")];
        assert_eq!(picked(both).as_deref(), Some("Card"), "hardware beside software");
    }

    #[test]
    fn a_listing_tells_kind_precision_and_limits() {
        let text = Listing::new(vec![adapter("llvmpipe", "software")]).to_string();
        for part in ["llvmpipe\n", "software (vulkan, 1.0)", "no f64", "128 MiB", "no limit", "takes the CPU"] {
            assert!(text.contains(part), "{part:?} in {text}");
        }
    }
}
