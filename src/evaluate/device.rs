//! Where costs were computed, for reports and checkpoints.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Precision;

/// Where costs were computed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Device {
    /// What computed.
    pub backend: Backend,
    /// On which processor or adapter.
    pub adapter: Adapter,
    /// In which number format.
    pub precision: Precision,
}

/// What computes costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// Lanes on the processor.
    Cpu,
    /// A kernel on an adapter.
    Gpu,
    /// A function in place of a filter.
    Mock,
}

/// A processor or an adapter. In JSON it is one sentence, which reads back as the name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// An adapter's name, by which it is found again; of a processor its instruction set and threads.
    pub name: String,
    /// An adapter's kind, interface and driver; else nothing.
    pub driver: String,
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Mock => "mock",
        })
    }
}

impl<T: Into<String>> From<T> for Adapter {
    fn from(name: T) -> Self {
        Self { name: name.into(), driver: String::new() }
    }
}

impl fmt::Display for Adapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        if self.driver.is_empty() { Ok(()) } else { write!(f, " ({})", self.driver) }
    }
}

impl Serialize for Adapter {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            return serializer.collect_str(self);
        }
        (&self.name, &self.driver).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Adapter {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            return String::deserialize(deserializer).map(Self::from);
        }
        <(String, String)>::deserialize(deserializer).map(|(name, driver)| Self { name, driver })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_says_a_sentence_and_a_checkpoint_keeps_the_parts() {
        let adapter = Adapter { name: "Arc (DG2)".to_owned(), driver: "discrete, vulkan, Mesa 25".to_owned() };
        let device = Device { backend: Backend::Gpu, adapter, precision: Precision::F32 };
        let json = serde_json::to_value(&device).unwrap();
        let said = "Arc (DG2) (discrete, vulkan, Mesa 25)";
        assert_eq!(json, serde_json::json!({ "backend": "gpu", "adapter": said, "precision": "f32" }));
        let read: Device = serde_json::from_value(json).unwrap();
        assert_eq!((read.adapter, read.precision), (said.into(), Precision::F32));
        let bytes = postcard::to_stdvec(&device).unwrap();
        assert_eq!(postcard::from_bytes(&bytes), Ok(device));
    }
}
