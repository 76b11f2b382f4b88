//! Sage-Husa, process noise: Q_k = (1 - d_k) Q_(k-1) + d_k K nu nu' K' with d_k = (1 - b) / (1 - b^(k+1)), for k = 1, 2, ...
//! updates of a trajectory.
//!
//! After A. P. Sage and G. W. Husa, Adaptive filtering with unknown prior statistics, Joint Automatic Control Conference
//! (1969), 760-769, less the terms that are taken away, so that Q stays a covariance.
#![expect(non_snake_case, reason = "Kalman notation: Q, K")]

use super::{Adaptation, Noise, Seen, fade};
use crate::filter::columns::Key;
use crate::filter::covariance::Covariance;
use crate::filter::form::Form;
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::model::Model;
use crate::tape::{Graph, Id};

/// Carries the weight 1 / d_k, then Q in the form of P.
pub(in crate::filter) struct SageHusa;

impl Adaptation for SageHusa {
    fn names(&self, form: Form, model: &Model) -> Vec<String> {
        let name = |name: String| name.strip_prefix("P.").map_or(format!("Q.{name}"), |rest| format!("Q.{rest}"));
        let entries = Covariance::names(form, &model.states).into_iter().map(name);
        std::iter::once("weight".to_owned()).chain(entries).collect()
    }

    fn start(&self, g: &mut Graph, form: Form, noise: Noise) -> Vec<Id> {
        let Q = noise.Q.matrix(g);
        let Q = Covariance::new(g, form, Q);
        [vec![g.constant(1.0)], Q.entries()].concat()
    }

    fn adopt(&self, g: &mut Graph, form: Form, memory: &[Id], noise: &mut Noise) {
        noise.Q = Covariance::from_entries(g, form, noise.Q.n(), &memory[1..]);
    }

    fn adapt(&self, t: &mut Tracer<'_>, form: Form, row: &Row, memory: Vec<Id>, seen: &Seen<'_>) -> Vec<Id> {
        let measured = t.flag(Key::Measured, |place| place.components() > 0);
        let (weight, d) = fade(&mut t.g, memory[0], row.model.settings[0], measured);
        let mut Q = Covariance::from_entries(&mut t.g, form, seen.prior.n(), &memory[1..]);
        Q.fade(&mut t.g, d, &seen.update.correction);
        [vec![weight], Q.entries()].concat()
    }
}
