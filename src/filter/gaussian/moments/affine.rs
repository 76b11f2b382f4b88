//! Affine formulas: the moments are exact, whatever P.

use super::{Map, MomentRule, Moments};
use crate::filter::columns::Key;
use crate::filter::covariance::Covariance;
use crate::filter::difference;
use crate::filter::error::TraceError;
use crate::filter::nodes::MapNodes;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::filter::units::scaled;
use crate::tape::{Id, Moved};

/// y = J x + c.
#[derive(Debug, Clone, Copy)]
pub(in crate::filter) struct Affine;

impl MomentRule for Affine {
    fn through(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        map: Map,
        x: &[Id],
        _: &Covariance,
    ) -> Result<Moments, TraceError> {
        let formulas = map.of(&row.model);
        let offset = match &row.nominal {
            Some(nominal) => around(t, formulas, map.of(nominal), map),
            None => absolute(t, formulas),
        };
        let units = map.units(t.units);
        let jacobian = t.units.map(&mut t.g, &formulas.jacobian, units);
        let linear = jacobian.iter().map(|row| t.g.dot(row.iter().copied().zip(x.iter().copied()))).collect();
        let (fixed, moved) = (scaled(&mut t.g, &offset.fixed, units), scaled(&mut t.g, &offset.moved, units));
        Ok(Moments { fixed, moved, linear, jacobian, excess: None, columns: None, positive: vec![] })
    }
}

/// The offset of a map, see [`Moments`].
struct Offset {
    fixed: Vec<Id>,
    moved: Vec<Id>,
}

fn absolute(t: &mut Tracer<'_>, map: &MapNodes) -> Offset {
    Offset { fixed: map.offset.clone(), moved: vec![t.g.constant(0.0); map.offset.len()] }
}

/// f_theta0(x_nom) is the same for every candidate and is taken in f64, once; what theta changes of it is a difference, which
/// vanishes where theta does not stand in the formula.
fn around(t: &mut Tracer<'_>, theta: &MapNodes, at: &MapNodes, map: Map) -> Offset {
    let Some(nominal) = t.nominal else { return absolute(t, theta) };
    let n = t.problem.model.states.len();
    let x: Vec<Id> = (0..n).map(|i| t.columns.node(&mut t.g, Key::Nominal(i), || nominal.at(i))).collect();
    let mut fixed = Vec::with_capacity(at.offset.len());
    for (i, (row, offset)) in at.jacobian.iter().zip(&at.offset).enumerate() {
        let linear = t.g.dot(row.iter().copied().zip(x.iter().copied()));
        let mut value = t.g.add(linear, *offset);
        if map == Map::Transition {
            let next = t.columns.node(&mut t.g, Key::NextNominal(i), || nominal.next(i, t.rows));
            value = t.g.sub(value, next);
        }
        fixed.push(value);
    }
    let still: Vec<Moved> = x.iter().map(|x| Moved::still(&mut t.g, *x)).collect();
    let moved = difference::around(t, &theta.values, &still, &nominal.candidate).roots;
    Offset { fixed, moved: moved.into_iter().map(|moved| moved.delta).collect() }
}
