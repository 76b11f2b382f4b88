//! Adapters: which there are, and which one to take.

use serde::Serialize;

/// What is known of an adapter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AdapterInfo {
    /// Its name.
    pub name: String,
    /// `vulkan`, `metal`, `dx12`.
    pub backend: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: String,
    /// Driver and its version.
    pub driver: String,
    /// Whether it computes in f64.
    pub f64: bool,
    /// Whether a kernel can be timed on it.
    pub timestamps: bool,
    /// Largest storage buffer a kernel can bind \[bytes\].
    pub max_binding: u64,
    /// Largest buffer \[bytes\].
    pub max_buffer: u64,
    /// Largest uniform buffer a kernel can bind \[bytes\].
    pub max_uniform: u64,
}

impl AdapterInfo {
    /// Whether it is a program on the CPU that acts as a GPU: right for tests, never for a figure.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }
}

/// Why no adapter could be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AdapterError {
    /// There is none.
    #[error(
        "no GPU adapter (tried Vulkan, Metal and DX12): use --device cpu, or install a driver (on Debian mesa-vulkan-drivers and libvulkan1)"
    )]
    None,
    /// Only software adapters, which are not taken unasked.
    #[error(
        "no GPU adapter but the software renderer `{name}`, which is slower than the CPU: use --device cpu, or --adapter \"{name}\" to test on it"
    )]
    OnlySoftware {
        /// Its name.
        name: String,
    },
    /// None by that name.
    #[error("no adapter is called `{wanted}`: expected part of one of {known}")]
    Unknown {
        /// What was asked for.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// f64 where there is none.
    #[error("adapter `{name}` has no f64: use --precision f32, or --device cpu for f64")]
    NoF64 {
        /// Its name.
        name: String,
    },
    /// The driver refuses.
    #[error("adapter `{name}` cannot be opened: {reason} (use --device cpu)")]
    Refused {
        /// Its name.
        name: String,
        /// What the driver says.
        reason: String,
    },
}

fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle())
}

fn info(adapter: &wgpu::Adapter) -> AdapterInfo {
    let (info, limits, features) = (adapter.get_info(), adapter.limits(), adapter.features());
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "other",
    };
    AdapterInfo {
        name: info.name,
        backend: info.backend.to_string(),
        kind: kind.to_owned(),
        driver: [info.driver, info.driver_info].join(" ").trim().to_owned(),
        f64: features.contains(wgpu::Features::SHADER_F64),
        timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
        max_binding: limits.max_storage_buffer_binding_size,
        max_buffer: limits.max_buffer_size,
        max_uniform: limits.max_uniform_buffer_binding_size,
    }
}

/// Every adapter of this machine, real hardware first.
#[must_use]
pub fn adapters() -> Vec<AdapterInfo> {
    enumerate().into_iter().map(|(info, _)| info).collect()
}

fn enumerate() -> Vec<(AdapterInfo, wgpu::Adapter)> {
    let found = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::all()));
    let mut found: Vec<_> = found.into_iter().map(|adapter| (info(&adapter), adapter)).collect();
    let rank = |kind: &str| ["discrete", "integrated", "virtual", "other", "software"].iter().position(|k| *k == kind);
    found.sort_by_key(|(info, _)| rank(&info.kind));
    found
}

/// The adapter whose name contains `wanted`, or the best real one.
pub(super) fn choose(wanted: Option<&str>) -> Result<(AdapterInfo, wgpu::Adapter), AdapterError> {
    let mut found = enumerate();
    let place = match wanted {
        Some(wanted) => {
            let lower = wanted.to_lowercase();
            let named =
                |fits: &dyn Fn(&str) -> bool| found.iter().position(|(info, _)| fits(&info.name.to_lowercase()));
            // A whole name first: one adapter's may be the beginning of another's.
            let place = named(&|name| name == lower).or_else(|| named(&|name| name.contains(&lower)));
            place.ok_or_else(|| {
                let known: Vec<String> = found.iter().map(|(info, _)| format!("`{}`", info.name)).collect();
                if known.is_empty() {
                    return AdapterError::None;
                }
                AdapterError::Unknown { wanted: wanted.to_owned(), known: known.join(", ") }
            })?
        }
        None => match found.first() {
            None => return Err(AdapterError::None),
            Some((info, _)) if info.is_software() => {
                return Err(AdapterError::OnlySoftware { name: info.name.clone() });
            }
            Some(_) => 0,
        },
    };
    Ok(found.swap_remove(place))
}
