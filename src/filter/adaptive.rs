//! Filters that adapt Q or R on the way, traced: what they carry beside x and P, and what an update does to it.
//!
//! Adaptation sees innovations and covariances only, never a coordinate, so the deviation form changes nothing here.
//! Everything that the log alone decides (which rows count, whether a buffer is full) is a column.
#![expect(non_snake_case, reason = "Kalman notation: H, P, Q, R")]

mod law;

use super::covariance::Covariance;
use super::form::Form;
use super::formula::{self, Scope};
use super::kalman::{Recursion, Update};
use super::symmetric::Symmetric;
use super::tracer::{Tracer, narrow};
use crate::model::{FilterKind, Model};
use crate::tape::{Binary, Graph, Id, Leaf};
use law::Kind;
pub(super) use law::Law;

/// What is carried for the [`Law`]. A `weight` is 1 / d_k = 1 + b + ... + b^k = 1 + b / d_(k-1), from 1 at k = 0.
pub(super) enum Memory {
    None,
    ProcessNoise {
        weight: Id,
        Q: Covariance,
    },
    MeasurementNoise {
        weights: Vec<Id>,
        R: Vec<Id>,
    },
    Fuzzy {
        R: Vec<Id>,
        /// The last squared innovations of each component, latest first.
        squares: Vec<Vec<Id>>,
    },
}

impl Tracer<'_> {
    /// What a trajectory starts with.
    pub(super) fn start_memory(&mut self, form: Form) -> Memory {
        let model = &self.problem.model;
        let m = model.measurements.len();
        let parameters = formula::parameters(&mut self.g, &self.problem.parameters, None);
        let (zero, one) = (self.g.constant(0.0), self.g.constant(1.0));
        let dt = self.first_interval();
        let scope = Scope { states: &[], parameters: &parameters, inputs: &[], dt };
        let variances = |tracer: &mut Self| {
            let R = tracer.covariance(&model.r, scope, &tracer.units.measurements);
            (0..m).map(|i| R.at(i, i)).collect()
        };
        match &self.problem.filter {
            FilterKind::Kalman => Memory::None,
            FilterKind::SageHusa { .. } => {
                let Q = self.covariance(&model.q, scope, &self.units.states);
                Memory::ProcessNoise { weight: one, Q: Covariance::new(&mut self.g, form, Q) }
            }
            FilterKind::SageHusaR { .. } => Memory::MeasurementNoise { weights: vec![one; m], R: variances(self) },
            FilterKind::Fuzzy { window, .. } => {
                Memory::Fuzzy { R: variances(self), squares: vec![vec![zero; *window]; m] }
            }
        }
    }

    /// The interval after the first used row, which the first Q is for: one number where all trajectories agree.
    fn first_interval(&mut self) -> Id {
        let mut intervals = self.rows.first_intervals().into_iter();
        let first = intervals.next().unwrap_or(1.0);
        if intervals.all(|dt| dt.to_bits() == first.to_bits()) {
            return self.g.constant(first);
        }
        let n = self.problem.model.states.len();
        let place = if self.nominal.is_some() { 2 * n } else { n };
        self.g.leaf(Leaf::Start(narrow(place)))
    }
}

impl Memory {
    /// Its entries, in the order of [`Self::names`].
    pub(super) fn entries(&self) -> Vec<Id> {
        match self {
            Self::None => vec![],
            Self::ProcessNoise { weight, Q } => [vec![*weight], Q.entries()].concat(),
            Self::MeasurementNoise { weights, R } => [&weights[..], R].concat(),
            Self::Fuzzy { R, squares } => R.iter().chain(squares.iter().flatten()).copied().collect(),
        }
    }

    /// From its entries.
    pub(super) fn from_entries(
        g: &mut Graph,
        (form, kind): (Form, &FilterKind),
        model: &Model,
        entries: &[Id],
    ) -> Self {
        let (n, m) = (model.states.len(), model.measurements.len());
        match kind {
            FilterKind::Kalman => Self::None,
            FilterKind::SageHusa { .. } => {
                Self::ProcessNoise { weight: entries[0], Q: Covariance::from_entries(g, form, n, &entries[1..]) }
            }
            FilterKind::SageHusaR { .. } => {
                Self::MeasurementNoise { weights: entries[..m].to_vec(), R: entries[m..].to_vec() }
            }
            FilterKind::Fuzzy { window, .. } => Self::Fuzzy {
                R: entries[..m].to_vec(),
                squares: entries[m..].chunks(*window).map(<[Id]>::to_vec).collect(),
            },
        }
    }

    /// What carried registers of it are called: `weight`, `Q.d.v` (or `Q.U.d.v`, `Q.D.d`), `R.range`, `square1.range`, ...
    pub(super) fn names(form: Form, kind: &FilterKind, model: &Model) -> Vec<String> {
        let of = |what: &str| model.measurements.iter().map(move |z| format!("{what}.{z}")).collect::<Vec<_>>();
        match kind {
            FilterKind::Kalman => vec![],
            FilterKind::SageHusa { .. } => {
                let name =
                    |name: String| name.strip_prefix("P.").map_or(format!("Q.{name}"), |rest| format!("Q.{rest}"));
                let entries = Covariance::names(form, &model.states).into_iter().map(name);
                std::iter::once("weight".to_owned()).chain(entries).collect()
            }
            FilterKind::SageHusaR { .. } => [of("weight"), of("R")].concat(),
            FilterKind::Fuzzy { window, .. } => {
                let squares = |z: &String| (1..=*window).map(|age| format!("square{age}.{z}")).collect::<Vec<_>>();
                of("R").into_iter().chain(model.measurements.iter().flat_map(squares)).collect()
            }
        }
    }

    /// Entries at the end that are neither constant nor equal to others, so that nothing is to be found out about them.
    pub(super) const fn buffered(kind: &FilterKind, m: usize) -> usize {
        match kind {
            FilterKind::Fuzzy { window, .. } => *window * m,
            _ => 0,
        }
    }

    /// Puts the adapted Q or R in the place of the model's.
    pub(super) fn adopt(&self, g: &mut Graph, recursion: &mut Recursion) {
        match self {
            Self::None => {}
            Self::ProcessNoise { Q, .. } => recursion.Q = Q.clone(),
            Self::MeasurementNoise { R, .. } | Self::Fuzzy { R, .. } => {
                let zero = g.constant(0.0);
                recursion.R = Symmetric::from_fn(R.len(), |i, j| if i == j { R[i] } else { zero });
            }
        }
    }

    /// After an update from the prior covariance `P`.
    pub(super) fn adapt(
        self,
        g: &mut Graph,
        law: &Law,
        recursion: &Recursion,
        (P, update): (&Covariance, &Update),
    ) -> Self {
        match (self, &law.kind) {
            (Self::ProcessNoise { weight, mut Q }, Kind::ProcessNoise { forgetting, measured }) => {
                let (weight, d) = fade(g, weight, *forgetting, *measured);
                Q.fade(g, d, &update.correction);
                Self::ProcessNoise { weight, Q }
            }
            (Self::MeasurementNoise { mut weights, mut R }, Kind::MeasurementNoise { forgetting, least }) => {
                for (i, R) in R.iter_mut().enumerate() {
                    let (weight, d) = fade(g, weights[i], *forgetting, recursion.present[i]);
                    weights[i] = weight;
                    let zero = g.constant(0.0);
                    let predicted = P.variance(g, &recursion.H[i], zero);
                    let square = g.mul(update.nu[i], update.nu[i]);
                    let sample = g.sub(square, predicted);
                    let (kept, part) = (remainder(g, d), g.mul(d, sample));
                    let mixed = g.mul(kept, *R);
                    let mixed = g.add(mixed, part);
                    let mixed = g.binary(Binary::Max, mixed, least[i]);
                    *R = g.select(recursion.present[i], mixed, *R);
                }
                Self::MeasurementNoise { weights, R }
            }
            (Self::Fuzzy { mut R, mut squares }, Kind::Fuzzy { window, gain, width, acts }) => {
                for (i, (R, squares)) in R.iter_mut().zip(&mut squares).enumerate() {
                    let square = g.mul(update.nu[i], update.nu[i]);
                    push(g, squares, square, recursion.present[i]);
                    let S = update.S_diagonal[i];
                    let factor = fuzzy_factor(g, squares, (S, *window), (*gain, *width));
                    let changed = g.mul(*R, factor);
                    *R = g.select(acts[i], changed, *R);
                }
                Self::Fuzzy { R, squares }
            }
            (memory, _) => memory,
        }
    }
}

/// The next weight, and d = 1 / weight; where nothing is measured the weight stays and d is 0.
fn fade(g: &mut Graph, weight: Id, forgetting: Id, measured: Id) -> (Id, Id) {
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let faded = g.mul(forgetting, weight);
    let next = g.add(faded, one);
    let d = g.div(one, next);
    (g.select(measured, next, weight), g.select(measured, d, zero))
}

fn remainder(g: &mut Graph, d: Id) -> Id {
    let one = g.constant(1.0);
    g.sub(one, d)
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
fn fuzzy_factor(g: &mut Graph, squares: &[Id], (S, window): (Id, usize), (gain, width): (Id, Id)) -> Id {
    let (one, minus) = (g.constant(1.0), g.constant(-1.0));
    #[expect(clippy::cast_precision_loss, reason = "a window is a small number")]
    let share = g.constant(1.0 / window as f64);
    let sum = squares[1..].iter().fold(squares[0], |sum, square| g.add(sum, *square));
    let mean = g.mul(sum, share);
    let ratio = g.div(mean, S);
    let mismatch = g.sub(ratio, one);
    let scaled = g.div(mismatch, width);
    let above = g.binary(Binary::Max, scaled, minus);
    let clipped = g.binary(Binary::Min, above, one);
    let change = g.mul(gain, clipped);
    g.add(one, change)
}
