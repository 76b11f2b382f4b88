//! Sage-Husa, measurement noise, for each component by itself: R_k = (1 - d_k) R_(k-1) + d_k (nu^2 - H P H') with
//! d_k = (1 - b) / (1 - b^(k+1)) over its own updates, kept at or above a share of the model's R.
#![expect(non_snake_case, reason = "Kalman notation: H, P, R")]

use super::{Adaptation, Noise, Seen, diagonal, fade};
use crate::filter::form::Form;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::model::Model;
use crate::tape::{Binary, Graph, Id};

/// Carries the weights 1 / d_k of the components, then their variances.
pub(in crate::filter) struct SageHusaR;

impl Adaptation for SageHusaR {
    fn names(&self, _: Form, model: &Model) -> Vec<String> {
        let of = |what: &'static str| model.measurements.iter().map(move |z| format!("{what}.{z}"));
        of("weight").chain(of("R")).collect()
    }

    fn start(&self, g: &mut Graph, _: Form, noise: Noise) -> Vec<Id> {
        [vec![g.constant(1.0); noise.R.n()], noise.R.diagonal()].concat()
    }

    fn adopt(&self, g: &mut Graph, _: Form, memory: &[Id], noise: &mut Noise) {
        noise.R = diagonal(g, &memory[memory.len() / 2..]);
    }

    fn adapt(&self, t: &mut Tracer<'_>, _: Form, row: &Row, mut memory: Vec<Id>, seen: &Seen<'_>) -> Vec<Id> {
        let (forgetting, floor) = (row.model.settings[0], row.model.settings[1]);
        let model = Noise::of(t, &row.model).R;
        let (g, measurement) = (&mut t.g, seen.measurement);
        let (weights, R) = memory.split_at_mut(model.n());
        let (zero, one) = (g.constant(0.0), g.constant(1.0));
        for (i, (weight, R)) in weights.iter_mut().zip(R).enumerate() {
            let least = g.mul(floor, model.at(i, i));
            let present = measurement.present[i];
            let (next, d) = fade(g, *weight, forgetting, present);
            *weight = next;
            let predicted = seen.prior.variance(g, &measurement.H[i], zero);
            let square = g.mul(measurement.nu[i], measurement.nu[i]);
            let sample = g.sub(square, predicted);
            let (kept, part) = (g.sub(one, d), g.mul(d, sample));
            let mixed = g.mul(kept, *R);
            let mixed = g.add(mixed, part);
            let mixed = g.binary(Binary::Max, mixed, least);
            *R = g.select(present, mixed, *R);
        }
        memory
    }
}
