//! A row of the log, as nodes.

use super::error::TraceError;
use super::nodes::ModelNodes;
use super::tracer::Tracer;
use crate::tape::Id;

/// What a step reads besides what is carried.
pub(super) struct Row {
    /// The model of any candidate.
    pub(super) model: ModelNodes,
    /// The model of the nominal's candidate, where there is a nominal.
    pub(super) nominal: Option<ModelNodes>,
    /// Measurements in the problem's own units, 0 where missing.
    pub(super) z: Vec<Id>,
    /// 1 where a component updates the filter, 0 where it is missing.
    pub(super) present: Vec<Id>,
}

impl Row {
    /// # Errors
    /// If f or h is not affine in the states.
    pub(super) fn new(t: &mut Tracer<'_>) -> Result<Self, TraceError> {
        let model = ModelNodes::new(t, None)?;
        let nominal = t.nominal.map(|nominal| ModelNodes::new(t, Some(&nominal.candidate))).transpose()?;
        let (z, present) = (t.measurements(), t.present());
        Ok(Self { model, nominal, z, present })
    }
}
