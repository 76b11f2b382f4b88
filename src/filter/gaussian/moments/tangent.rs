//! Formulas at a mean: their values there, and their tangents.

use super::Map;
use crate::filter::carried::narrow;
use crate::filter::columns::Key;
use crate::filter::difference;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units::scaled;
use crate::tape::{Centre, Id, Leaf, Moved};
use std::collections::HashMap;

/// What formulas are at a mean, in the filter's units; in the deviation form less what they are at the nominal.
pub(super) struct Tangent {
    /// The same for every candidate, see [`super::Moments::fixed`].
    pub(super) fixed: Vec<Id>,
    /// What the mean and the parameters change of it.
    pub(super) value: Vec<Id>,
    /// Rows of the Jacobian.
    pub(super) jacobian: Vec<Vec<Id>>,
    /// All of the formulas at the mean, in the problem's own units.
    pub(super) centre: Centre,
}

/// The formulas of a map at the mean `x`.
pub(super) fn tangent(t: &mut Tracer<'_>, row: &Row, map: Map, x: &[Id]) -> Tangent {
    let formulas = map.of(&row.model);
    let own: Vec<Id> = x.iter().zip(&t.units.states).map(|(x, unit)| t.g.scale(*x, *unit)).collect();
    let roots: Vec<Id> = formulas.values.iter().chain(formulas.jacobian.iter().flatten()).copied().collect();
    let (m, zero) = (formulas.values.len(), t.g.constant(0.0));
    let (fixed, value, jacobian, centre) = match t.nominal.filter(|_| row.nominal.is_some()) {
        None => {
            let by = own.iter().enumerate().map(|(j, x)| (Leaf::Variable(narrow(j)), *x)).collect::<HashMap<_, _>>();
            let (mut values, centre) = t.g.centre(&roots, &by);
            let jacobian = values.split_off(m);
            (vec![zero; m], values, jacobian, centre)
        }
        Some(nominal) => {
            let mut states = Vec::with_capacity(own.len());
            for (i, delta) in own.iter().enumerate() {
                let base = t.columns.node(&mut t.g, Key::Nominal(i), || nominal.at(i));
                states.push(Moved::by(&mut t.g, base, *delta));
            }
            let moved = difference::around(t, &roots, &states, &nominal.candidate);
            let (values, jacobian) = moved.roots.split_at(m);
            let mut fixed: Vec<Id> = values.iter().map(|moved| moved.base).collect();
            if map == Map::Transition {
                for (i, fixed) in fixed.iter_mut().enumerate() {
                    let next = t.columns.node(&mut t.g, Key::NextNominal(i), || nominal.next(i, t.rows));
                    *fixed = t.g.sub(*fixed, next);
                }
            }
            let deltas = values.iter().map(|moved| moved.delta).collect();
            (fixed, deltas, jacobian.iter().map(|moved| moved.value).collect(), moved.centre)
        }
    };
    let units = map.units(t.units);
    let rows: Vec<Vec<Id>> = jacobian.chunks(x.len()).map(<[Id]>::to_vec).collect();
    Tangent {
        fixed: scaled(&mut t.g, &fixed, units),
        value: scaled(&mut t.g, &value, units),
        jacobian: t.units.map(&mut t.g, &rows, units),
        centre,
    }
}
