//! What is looked at before a filter is traced: the model at a few candidates, over the rows of the log.

mod carrying;
mod probe;
mod sight;
mod units;

pub(in crate::filter) use carrying::choose as carrying;
pub(crate) use probe::{probed, scattered};
pub(in crate::filter) use units::choose as units;

use crate::filter::columns::Columns;
use crate::filter::error::TraceError;
use crate::filter::nodes::ModelNodes;
use crate::filter::rows::Rows;
use crate::filter::tracer::Tracer;
use crate::filter::units::Units;
use crate::model::{Parameters, Problem, Search};

/// The model at three candidates: every searched parameter at its lower bound, at its start, and at its upper bound (the range
/// of the first population where there is no bound). That covers formulas that rise or fall in all of their parameters.
pub(in crate::filter) struct Survey<'a> {
    pub(in crate::filter) t: Tracer<'a>,
    pub(in crate::filter) corners: [ModelNodes; 3],
    /// The same of each model that a filter of several switches between.
    pub(in crate::filter) modes: Vec<[ModelNodes; 3]>,
}

impl<'a> Survey<'a> {
    /// # Errors
    /// If f or h is not affine in the states.
    pub(in crate::filter) fn new(
        problem: &'a Problem,
        rows: &'a Rows<'a>,
        columns: &'a mut Columns,
        units: &'a Units,
    ) -> Result<Self, TraceError> {
        let mut t = Tracer::new(problem, rows, columns, units, None);
        let [lowest, baseline, highest] = corners(&problem.parameters);
        let model = |t: &mut Tracer<'_>, candidate: &[f64]| ModelNodes::new(t, Some(candidate));
        let all = |t: &mut Tracer<'_>| -> Result<[ModelNodes; 3], TraceError> {
            Ok([model(t, &lowest)?, model(t, &baseline)?, model(t, &highest)?])
        };
        let corners = all(&mut t)?;
        let modes = problem.modes.iter().map(|mode| t.on(&problem.of_mode(mode), all)).collect::<Result<_, _>>()?;
        Ok(Self { t, corners, modes })
    }

    /// The model of the baseline.
    pub(in crate::filter) const fn baseline(&self) -> &ModelNodes {
        &self.corners[1]
    }
}

/// Lowest, baseline, highest.
fn corners(parameters: &Parameters) -> [Vec<f64>; 3] {
    let at = |end: usize| parameters.searched().map(|(_, search)| range(search)[end]).collect();
    [at(0), parameters.baseline(), at(1)]
}

/// The ends that a candidate's parameter may have.
fn range(search: &Search) -> [f64; 2] {
    let finite = |bound: f64, init: f64| if bound.is_finite() { bound } else { init };
    [finite(search.min, search.init[0]), finite(search.max, search.init[1])]
}
