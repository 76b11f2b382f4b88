//! The covariance that a filter carries, in either of its forms, behind one set of operations.
#![expect(non_snake_case, reason = "Kalman notation: F, H, Q, R, P, S, K")]

mod factored;
mod root;
mod scalar;
mod symmetric;

pub(in crate::filter) use root::Root;
pub(in crate::filter) use scalar::{Gain, Scalar};
pub(in crate::filter) use symmetric::Symmetric;

use super::form::Form;
use crate::tape::{Graph, Id};
use factored::Factored;

/// P, or its factors. Either has n (n + 1) / 2 entries, in the storage order of [`Symmetric`].
#[derive(Debug, Clone)]
pub(in crate::filter) enum Covariance {
    Full(Symmetric),
    Factored(Factored),
    /// P = L D L': the factors U D U' of the states in reverse order.
    Lower(Factored),
}

impl Covariance {
    /// P in the given form.
    pub(in crate::filter) fn new(g: &mut Graph, form: Form, P: Symmetric) -> Self {
        match form {
            Form::Full => Self::Full(P),
            Form::Factored => Self::Factored(Factored::of(g, &P)),
            Form::Lower => Self::Lower(Factored::of(g, &P.reversed())),
        }
    }

    /// From [`Self::entries`].
    pub(in crate::filter) fn from_entries(g: &mut Graph, form: Form, n: usize, entries: &[Id]) -> Self {
        let zero = g.constant(0.0);
        let mut entries = entries.iter().copied();
        let upper = Symmetric::from_fn(n, |_, _| entries.next().unwrap_or(zero));
        match form {
            Form::Full => Self::Full(upper),
            Form::Factored => Self::Factored(Factored::from_entries(g, &upper)),
            Form::Lower => Self::Lower(Factored::from_entries(g, &upper.reversed())),
        }
    }

    /// What is carried.
    pub(in crate::filter) fn entries(&self) -> Vec<Id> {
        match self {
            Self::Full(P) => P.upper().to_vec(),
            Self::Factored(factors) => factors.entries(),
            Self::Lower(factors) => factors.upper().reversed().upper().to_vec(),
        }
    }

    /// Names of the entries: `P.d.v`, or `U.d.v` above the diagonal (`L.v.d` for what is below it) and `D.d` on it.
    pub(in crate::filter) fn names(form: Form, states: &[String]) -> Vec<String> {
        let name = |(i, j): (usize, usize)| match form {
            Form::Full => format!("P.{}.{}", states[i], states[j]),
            Form::Factored | Form::Lower if i == j => format!("D.{}", states[i]),
            Form::Factored => format!("U.{}.{}", states[i], states[j]),
            Form::Lower => format!("L.{}.{}", states[j], states[i]),
        };
        Symmetric::places(states.len()).map(name).collect()
    }

    /// The time update F P F' + Q, in the form of P.
    pub(in crate::filter) fn propagate(&self, g: &mut Graph, F: &[Vec<Id>], Q: &Self) -> Self {
        match self {
            Self::Full(P) => {
                let Q = Q.matrix(g);
                Self::Full(P.propagate(g, F, &Q))
            }
            Self::Factored(factors) => {
                let Q = Q.factors(g);
                Self::Factored(factors.propagate(g, F, &Q))
            }
            Self::Lower(factors) => {
                let F: Vec<Vec<Id>> = F.iter().rev().map(|row| reversed(row)).collect();
                let Q = Q.matrix(g).reversed();
                let Q = Factored::of(g, &Q);
                Self::Lower(factors.propagate(g, &F, &Q))
            }
        }
    }

    /// The sum of the squares of columns and Q, in the form of P.
    pub(in crate::filter) fn gathered(&self, g: &mut Graph, columns: &[Vec<Id>], Q: &Self) -> Self {
        let Q = Q.matrix(g);
        match self {
            Self::Full(_) => Self::Full(Symmetric::from_fn(self.n(), |i, j| {
                let squares = g.dot(columns.iter().map(|column| (column[i], column[j])));
                g.add(squares, Q.at(i, j))
            })),
            Self::Factored(_) => Self::Factored(Factored::gathered(g, columns.to_vec(), &Q)),
            Self::Lower(_) => {
                let columns = columns.iter().map(|column| reversed(column)).collect();
                Self::Lower(Factored::gathered(g, columns, &Q.reversed()))
            }
        }
    }

    /// L with P = L L', lower triangular.
    pub(in crate::filter) fn root(&self, g: &mut Graph) -> Root {
        match self {
            Self::Lower(factors) => Root::of_factors(g, factors),
            _ => {
                let P = self.matrix(g);
                Root::of(g, &P)
            }
        }
    }

    /// Number of states.
    pub(in crate::filter) fn n(&self) -> usize {
        match self {
            Self::Full(P) => P.n(),
            Self::Factored(factors) | Self::Lower(factors) => factors.n(),
        }
    }

    /// P, whatever the form.
    pub(in crate::filter) fn matrix(&self, g: &mut Graph) -> Symmetric {
        match self {
            Self::Full(P) => P.clone(),
            Self::Factored(factors) => factors.product(g),
            Self::Lower(factors) => factors.product(g).reversed(),
        }
    }

    /// The factors U D U'.
    fn factors(&self, g: &mut Graph) -> Factored {
        match self {
            Self::Full(P) => Factored::of(g, P),
            Self::Factored(factors) => factors.clone(),
            Self::Lower(_) => {
                let P = self.matrix(g);
                Factored::of(g, &P)
            }
        }
    }

    /// (1 - d) of itself and d of v v', 0 <= d <= 1. Factors stay factors: nothing is taken away.
    pub(in crate::filter) fn fade(&mut self, g: &mut Graph, d: Id, v: &[Id]) {
        let one = g.constant(1.0);
        let kept = g.sub(one, d);
        match self {
            Self::Full(P) => {
                let part: Vec<Id> = v.iter().map(|v| g.mul(d, *v)).collect();
                *P = Symmetric::from_fn(v.len(), |i, j| g.dot([(kept, P.at(i, j)), (part[i], v[j])]));
            }
            Self::Factored(factors) => factors.fade(g, kept, v.to_vec(), d),
            Self::Lower(factors) => factors.fade(g, kept, reversed(v), d),
        }
    }

    /// Its share of `weight` in an update that makes `updated` of it by scalar measurements with these gains, K and S:
    /// P - weight K S K' summed over them. Factors stay factors: nothing is taken away.
    pub(in crate::filter) fn partly(&self, g: &mut Graph, updated: &Self, weight: Id, gains: &[Gain]) -> Self {
        let one = g.constant(1.0);
        let left = g.sub(one, weight);
        match (self, updated) {
            (Self::Full(prior), Self::Full(updated)) => Self::Full(Symmetric::from_fn(prior.n(), |i, j| {
                let (before, after) = (prior.at(i, j), updated.at(i, j));
                if before == after { after } else { g.dot([(left, before), (weight, after)]) }
            })),
            _ => gains.iter().fold(updated.clone(), |mut updated, gain| {
                let part = g.mul(left, gain.S);
                updated.widen(g, part, &gain.K);
                updated
            }),
        }
    }

    /// With `weight` v v' added, weight >= 0.
    pub(in crate::filter) fn widen(&mut self, g: &mut Graph, weight: Id, v: &[Id]) {
        match self {
            Self::Full(P) => {
                let part: Vec<Id> = v.iter().map(|v| g.mul(weight, *v)).collect();
                *P = Symmetric::from_fn(v.len(), |i, j| {
                    let part = g.mul(part[i], v[j]);
                    g.add(P.at(i, j), part)
                });
            }
            Self::Factored(factors) => factors.add(g, v.to_vec(), weight),
            Self::Lower(factors) => factors.add(g, reversed(v), weight),
        }
    }

    /// Itself where `accepted` is positive, else `other`, which has the same form.
    pub(in crate::filter) fn or(&self, g: &mut Graph, accepted: Id, other: &Self, form: Form) -> Self {
        let pairs: Vec<(Id, Id)> = self.entries().into_iter().zip(other.entries()).collect();
        let entries: Vec<Id> = pairs.into_iter().map(|(own, other)| g.select(accepted, own, other)).collect();
        Self::from_entries(g, form, self.n(), &entries)
    }

    /// H P H' + R for one row of H.
    pub(in crate::filter) fn variance(&self, g: &mut Graph, H: &[Id], R: Id) -> Id {
        match self {
            Self::Full(P) => P.variance(g, H, R),
            Self::Factored(factors) => factors.variance(g, H, R),
            Self::Lower(factors) => factors.variance(g, &reversed(H), R),
        }
    }

    /// H P H' + R.
    pub(in crate::filter) fn seen_through(&self, g: &mut Graph, H: &[Vec<Id>], R: &Symmetric) -> Symmetric {
        let P = self.matrix(g);
        let PH: Vec<Vec<Id>> = H.iter().map(|row| P.times(g, row)).collect();
        Symmetric::from_fn(H.len(), |i, j| {
            let seen = g.dot(H[i].iter().copied().zip(PH[j].iter().copied()));
            g.add(seen, R.at(i, j))
        })
    }

    /// The update by one scalar measurement.
    pub(in crate::filter) fn update(&mut self, g: &mut Graph, scalar: &Scalar<'_>) -> Gain {
        match self {
            Self::Full(P) => P.update(g, scalar),
            Self::Factored(factors) => factors.update(g, scalar),
            Self::Lower(factors) => {
                let gain = factors.update(g, &Scalar { H: &reversed(scalar.H), ..*scalar });
                Gain { K: reversed(&gain.K), ..gain }
            }
        }
    }

    /// e' P^-1 e, and the pivots it divides by: all positive where P is positive definite.
    pub(in crate::filter) fn normalised_square(&self, g: &mut Graph, e: &[Id]) -> (Id, Vec<Id>) {
        match self {
            Self::Full(P) => P.normalised_square(g, e),
            Self::Factored(factors) => factors.normalised_square(g, e),
            Self::Lower(factors) => factors.normalised_square(g, &reversed(e)),
        }
    }
}

fn reversed(values: &[Id]) -> Vec<Id> {
    values.iter().rev().copied().collect()
}

/// The recursion on P itself. Only the upper triangle exists, and that alone keeps it symmetric.
impl Symmetric {
    fn propagate(&self, g: &mut Graph, F: &[Vec<Id>], Q: &Self) -> Self {
        let n = self.n();
        let FP: Vec<Vec<Id>> =
            (0..n).map(|i| (0..n).map(|j| g.dot((0..n).map(|k| (F[i][k], self.at(k, j))))).collect()).collect();
        Self::from_fn(n, |i, j| {
            let propagated = g.dot((0..n).map(|k| (F[j][k], FP[i][k])));
            g.add(propagated, Q.at(i, j))
        })
    }

    /// P H'.
    fn times(&self, g: &mut Graph, H: &[Id]) -> Vec<Id> {
        let n = self.n();
        (0..n).map(|a| g.dot((0..n).map(|b| (H[b], self.at(a, b))))).collect()
    }

    fn variance(&self, g: &mut Graph, H: &[Id], R: Id) -> Id {
        let PH = self.times(g, H);
        let variance = g.dot(H.iter().copied().zip(PH));
        g.add(variance, R)
    }

    fn update(&mut self, g: &mut Graph, scalar: &Scalar<'_>) -> Gain {
        let PH = self.times(g, scalar.H);
        let S = self.variance(g, scalar.H, scalar.D);
        let S = scalar.gated(g, S);
        let inverse = g.div(scalar.gate, S);
        let K: Vec<Id> = PH.iter().map(|ph| g.mul(*ph, inverse)).collect();
        let seen = scalar.only_state(g);
        let shrink = seen.map(|_| {
            let one = g.constant(1.0);
            let ratio = g.mul(scalar.D, inverse);
            g.select(scalar.gate, ratio, one)
        });
        let prior = self.clone();
        *self = Self::from_fn(prior.n(), |i, j| match (seen, shrink) {
            // Where H sees one state j alone, P_ij - K_i H_j P_jj = P_ij D / S: no cancellation under a diffuse prior.
            (Some(s), Some(shrink)) if i == s || j == s => g.mul(prior.at(i, j), shrink),
            _ => {
                let part = g.mul(K[i], PH[j]);
                g.sub(prior.at(i, j), part)
            }
        });
        Gain { K, S, inverse }
    }

    /// By P = L D L'.
    fn normalised_square(&self, g: &mut Graph, e: &[Id]) -> (Id, Vec<Id>) {
        let (l, d) = self.ldl(g);
        let mut sum = g.constant(0.0);
        let mut solved: Vec<Id> = Vec::with_capacity(e.len());
        for (i, e) in e.iter().enumerate() {
            let mut y = *e;
            for j in 0..i {
                let part = g.mul(l[i][j], solved[j]);
                y = g.sub(y, part);
            }
            solved.push(y);
            let square = g.mul(y, y);
            let term = g.div(square, d[i]);
            sum = g.add(sum, term);
        }
        (sum, d)
    }
}
