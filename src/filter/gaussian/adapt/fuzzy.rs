//! Fuzzy adaptation of each component's R by its degree of mismatch DoM = mean of the last squared innovations over S, less 1:
//! R <- R (1 + gain clip(DoM / width)). The rules behind it stand at [`factor`].
#![expect(non_snake_case, reason = "Kalman notation: R, S")]

use super::{Adaptation, Noise, Seen, diagonal};
use crate::filter::columns::Key;
use crate::filter::form::Form;
use crate::filter::row::Row;
use crate::filter::rows::Place;
use crate::filter::tracer::Tracer;
use crate::model::Model;
use crate::tape::{Binary, Graph, Id};

/// Carries the variances, then the last squared innovations of each component, latest first.
pub(in crate::filter) struct Fuzzy {
    /// Number of squared innovations; R rests until a component has that many.
    pub(in crate::filter) window: usize,
}

impl Adaptation for Fuzzy {
    fn names(&self, _: Form, model: &Model) -> Vec<String> {
        let variances = model.measurements.iter().map(|z| format!("R.{z}"));
        let squares = |z: &String| (1..=self.window).map(|age| format!("square{age}.{z}")).collect::<Vec<_>>();
        variances.chain(model.measurements.iter().flat_map(squares)).collect()
    }

    fn opaque(&self, model: &Model) -> usize {
        self.window * model.measurements.len()
    }

    fn start(&self, g: &mut Graph, _: Form, noise: Noise) -> Vec<Id> {
        [noise.R.diagonal(), vec![g.constant(0.0); self.window * noise.R.n()]].concat()
    }

    fn adopt(&self, g: &mut Graph, _: Form, memory: &[Id], noise: &mut Noise) {
        noise.R = diagonal(g, &memory[..noise.R.n()]);
    }

    fn adapt(&self, t: &mut Tracer<'_>, _: Form, row: &Row, mut memory: Vec<Id>, seen: &Seen<'_>) -> Vec<Id> {
        let rule = Rule { gain: row.model.settings[0], width: row.model.settings[1] };
        let (R, squares) = memory.split_at_mut(row.present.len());
        for (i, (R, squares)) in R.iter_mut().zip(squares.chunks_mut(self.window)).enumerate() {
            let acts = full(t, i, self.window);
            let nu = seen.measurement.nu[i];
            let square = t.g.mul(nu, nu);
            push(&mut t.g, squares, square, row.present[i]);
            let factor = factor(&mut t.g, squares, seen.update.S_diagonal[i], &rule);
            let changed = t.g.mul(*R, factor);
            *R = t.g.select(acts, changed, *R);
        }
        memory
    }
}

/// The largest relative change, and the mismatch at which it is reached.
struct Rule {
    gain: Id,
    width: Id,
}

/// 1 where component `i` is measured for at least the `window`-th time of its trajectory.
fn full(t: &mut Tracer<'_>, i: usize, window: usize) -> Id {
    let rows = t.rows;
    t.columns.node(&mut t.g, Key::Full(i), || {
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

/// A shift register: where `present`, every value moves on by one place and the last is lost.
fn push(g: &mut Graph, register: &mut [Id], value: Id, present: Id) {
    let mut incoming = value;
    for place in register {
        let old = *place;
        *place = g.select(present, incoming, old);
        incoming = old;
    }
}

/// 1 + gain clip(DoM / width), DoM = mean / S - 1: the weighted mean of the singletons -gain, 0 and +gain, because the
/// memberships clip(-DoM / width), max(0, 1 - |DoM| / width) and clip(DoM / width) sum to 1.
fn factor(g: &mut Graph, squares: &[Id], S: Id, rule: &Rule) -> Id {
    let (one, minus) = (g.constant(1.0), g.constant(-1.0));
    #[expect(clippy::cast_precision_loss, reason = "a window is a small number")]
    let share = g.constant(1.0 / squares.len() as f64);
    let sum = squares[1..].iter().fold(squares[0], |sum, square| g.add(sum, *square));
    let mean = g.mul(sum, share);
    let ratio = g.div(mean, S);
    let mismatch = g.sub(ratio, one);
    let scaled = g.div(mismatch, rule.width);
    let above = g.binary(Binary::Max, scaled, minus);
    let clipped = g.binary(Binary::Min, above, one);
    let change = g.mul(rule.gain, clipped);
    g.add(one, change)
}
