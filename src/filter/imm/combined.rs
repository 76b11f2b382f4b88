//! What all modes together say of a row: the moments of their mixture.
#![expect(non_snake_case, reason = "Kalman notation: P, H, R, S")]

use super::State;
use super::mixing::{apart, mixture};
use crate::filter::covariance::{Covariance, Symmetric};
use crate::filter::evidence::{Evidence, Likelihood, Seen};
use crate::filter::row::Row;
use crate::filter::tracer::Tracer;
use crate::tape::{Graph, Id, Unary};

/// The evidence of the mixture: the modes weigh as they were predicted in what is held against the measurement, and as they are
/// then in the posterior. The likelihood is that of the first mode, in whose place [`super::weighing`] puts that of all.
pub(super) fn evidence(
    t: &mut Tracer<'_>,
    row: &Row,
    (priors, seen): (&[State], &[Evidence]),
    before: &[Id],
    (posteriors, after): (&[State], &[Id]),
) -> Evidence {
    let innovations = innovations(t, seen);
    let S: Vec<Symmetric> = priors.iter().zip(seen).map(|(prior, own)| spread(&mut t.g, prior, &own.seen)).collect();
    let joint: Vec<State> = innovations.into_iter().zip(S).map(|(x, P)| State { x, P }).collect();
    let from_first: Vec<Vec<Id>> =
        joint.iter().map(|own| own.x.iter().zip(&joint[0].x).map(|(x, first)| t.g.sub(*x, *first)).collect()).collect();
    let State { x: mut innovation, P: S } = mixture(&mut t.g, before, &joint, &from_first);
    for (i, nu) in innovation.iter_mut().enumerate() {
        if t.problem.model.angles.measurement(i) {
            *nu = t.g.unary(Unary::Wrap, *nu);
        }
    }
    let nis = normalised(&mut t.g, &innovation, &S, &row.present);
    let from_first = apart(t, posteriors);
    let State { x, P } = mixture(&mut t.g, after, posteriors, &from_first);
    let others = seen[1..].iter().flat_map(|own| own.likelihood.factors.iter().map(|factor| factor.value));
    let positive = others.chain(seen.iter().flat_map(|own| own.positive.iter().copied())).collect();
    Evidence {
        spread: S.diagonal(),
        innovation,
        likelihood: Likelihood {
            exponent: seen[0].likelihood.exponent,
            factors: seen[0].likelihood.factors.clone(),
            powers: vec![],
        },
        nis: Some(nis),
        rejected: None,
        alone: vec![vec![]; x.len()],
        state: x,
        covariance: Covariance::Full(P),
        seen: seen[0].seen.clone(),
        positive,
    }
}

/// The innovations of all modes, angles on the branch of the first mode's.
fn innovations(t: &mut Tracer<'_>, seen: &[Evidence]) -> Vec<Vec<Id>> {
    let of = |own: &Evidence| {
        let pairs = own.innovation.iter().zip(&seen[0].innovation).enumerate();
        pairs
            .map(|(i, (nu, first))| {
                if nu == first || !t.problem.model.angles.measurement(i) {
                    return *nu;
                }
                let d = t.g.sub(*nu, *first);
                let d = t.g.unary(Unary::Wrap, d);
                t.g.add(*first, d)
            })
            .collect()
    };
    seen.iter().map(of).collect()
}

/// S = H P H' + R of a mode.
fn spread(g: &mut Graph, prior: &State, Seen { H, R }: &Seen) -> Symmetric {
    let P = Covariance::Full(prior.P.clone());
    P.seen_through(g, H, R)
}

/// nu' S^-1 nu over the components that are there.
fn normalised(g: &mut Graph, nu: &[Id], S: &Symmetric, present: &[Id]) -> Id {
    let (zero, one) = (g.constant(0.0), g.constant(1.0));
    let nu: Vec<Id> = nu.iter().zip(present).map(|(nu, present)| g.select(*present, *nu, zero)).collect();
    let masked = Symmetric::from_fn(nu.len(), |i, j| {
        let (missing, both) = (if i == j { one } else { zero }, g.mul(present[i], present[j]));
        g.select(both, S.at(i, j), missing)
    });
    Covariance::Full(masked).normalised_square(g, &nu).0
}
