//! Random walk of a position: the local level under the name that tracking uses.

use super::{BuiltIn, local_level};

/// State: the position of each axis.
pub(super) const MODEL: BuiltIn = BuiltIn { name: "random-walk", ..local_level::MODEL };
