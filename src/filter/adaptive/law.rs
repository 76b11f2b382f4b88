//! What decides how Q or R adapts: the settings, and what the log alone says.
#![expect(non_snake_case, reason = "Kalman notation: R")]

use crate::filter::columns::{Key, Place};
use crate::filter::formula::{self, Scope};
use crate::filter::symmetric::Symmetric;
use crate::filter::tracer::Tracer;
use crate::model::{FilterKind, Range};
use crate::tape::{Graph, Id};

/// The law of adaptation, as nodes of one row.
pub(in crate::filter) struct Law {
    pub(super) kind: Kind,
    /// Positive while the settings are in their ranges.
    pub(in crate::filter) in_range: Vec<Id>,
}

pub(super) enum Kind {
    None,
    ProcessNoise {
        forgetting: Id,
        /// 1 where anything is measured.
        measured: Id,
    },
    MeasurementNoise {
        forgetting: Id,
        /// Least variance of each component.
        least: Vec<Id>,
    },
    Fuzzy {
        window: usize,
        gain: Id,
        width: Id,
        /// For each component 1 where it is measured and its buffer is full.
        acts: Vec<Id>,
    },
}

impl Tracer<'_> {
    /// The law that the problem's filter kind asks for; `R` is the model's.
    pub(in crate::filter) fn law(&mut self, R: &Symmetric) -> Law {
        let parameters = formula::parameters(&mut self.g, &self.problem.parameters, None);
        let nan = self.g.constant(f64::NAN);
        let scope = Scope { states: &[], parameters: &parameters, inputs: &[], dt: nan };
        let (mut values, mut in_range) = (Vec::new(), Vec::new());
        for setting in self.problem.filter.settings() {
            let value = formula::trace(&mut self.g, setting.formula, scope);
            if self.g.value(value).is_none() {
                in_range.push(within(&mut self.g, setting.range, value));
            }
            values.push(value);
        }
        let kind = match (&self.problem.filter, values.as_slice()) {
            (FilterKind::SageHusa { .. }, [forgetting]) => {
                let measured = self.column(Key::Measured, |place| f64::from(u8::from(place.components() > 0)));
                Kind::ProcessNoise { forgetting: *forgetting, measured }
            }
            (FilterKind::SageHusaR { .. }, [forgetting, floor]) => {
                let least = (0..R.n()).map(|i| self.g.mul(*floor, R.at(i, i))).collect();
                Kind::MeasurementNoise { forgetting: *forgetting, least }
            }
            (FilterKind::Fuzzy { window, .. }, [gain, width]) => {
                let acts = (0..R.n()).map(|i| self.full(i, *window)).collect();
                Kind::Fuzzy { window: *window, gain: *gain, width: *width, acts }
            }
            _ => Kind::None,
        };
        Law { kind, in_range }
    }

    /// 1 where component `i` is measured for at least the `window`-th time of its trajectory.
    fn full(&mut self, i: usize, window: usize) -> Id {
        let rows = self.rows;
        self.columns.node(&mut self.g, Key::Full(i), || {
            let (mut trajectory, mut filled) = (0, 0);
            let mut acts = |place: Place<'_>| {
                if place.index != trajectory {
                    (trajectory, filled) = (place.index, 0);
                }
                filled += usize::from(place.present(i));
                f64::from(u8::from(place.present(i) && filled >= window))
            };
            rows.places().map(&mut acts).collect()
        })
    }
}

/// Positive where `value` is in its range.
fn within(g: &mut Graph, range: Range, value: Id) -> Id {
    let (one, no) = (g.constant(1.0), g.constant(-1.0));
    match range {
        Range::Positive => value,
        Range::Share => {
            let above = g.sub(value, one);
            g.select(above, no, value)
        }
        Range::BelowOne => {
            let (below, rest) = (g.neg(value), g.sub(one, value));
            g.select(below, no, rest)
        }
    }
}
