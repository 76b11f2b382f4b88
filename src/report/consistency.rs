use crate::{data::Log, model::Problem, reference::Run};
use std::fmt;
#[derive(Debug, Clone, serde::Serialize)]
pub struct Consistency { pub nis_mean: f64 }
impl Consistency { pub fn of(_p: &Problem, _l: &Log, _c: &[f64], r: &Run) -> Self { Self { nis_mean: r.nis_mean() } } }
impl fmt::Display for Consistency { fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result { write!(f, "NIS {}", self.nis_mean) } }
