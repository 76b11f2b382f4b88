//! Values by name, in order, written as a JSON object.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap as _, Serializer};

/// (name, value) pairs in the order they were given; names are distinct.
///
/// ```
/// let named = kfgpu::report::Named::new(["r", "q"], [2.0, 0.5]);
/// assert_eq!(serde_json::to_string(&named)?, r#"{"r":2.0,"q":0.5}"#);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named<T>(Vec<(String, T)>);

impl<T> Named<T> {
    /// Names and values side by side; the longer list is cut.
    pub fn new<N: Into<String>>(names: impl IntoIterator<Item = N>, values: impl IntoIterator<Item = T>) -> Self {
        Self(names.into_iter().map(Into::into).zip(values).collect())
    }

    /// The value of `name`.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.iter().find(|(n, _)| n == name).map(|(_, value)| value)
    }

    /// The pairs in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&str, &T)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value))
    }
}

impl<N: Into<String>, T> FromIterator<(N, T)> for Named<T> {
    fn from_iter<I: IntoIterator<Item = (N, T)>>(pairs: I) -> Self {
        Self(pairs.into_iter().map(|(name, value)| (name.into(), value)).collect())
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Pairs(PhantomData))
    }
}

/// Takes in a map in its order.
struct Pairs<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Pairs<T> {
    type Value = Named<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of values by name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Named<T>, A::Error> {
        let mut pairs = Vec::new();
        while let Some(pair) = map.next_entry()? {
            pairs.push(pair);
        }
        Ok(Named(pairs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_is_kept_in_json() {
        let named = Named::new(["r", "q"], [2.0, 1.5]);
        assert_eq!(serde_json::to_string(&named).unwrap(), r#"{"r":2.0,"q":1.5}"#);
        assert_eq!(named.get("q"), Some(&1.5));
        assert_eq!(named.get("x"), None);
        let read: Named<Option<f64>> = serde_json::from_str(r#"{"r":2.0,"a":null}"#).unwrap();
        assert_eq!(read, Named::new(["r", "a"], [Some(2.0), None]));
    }
}
