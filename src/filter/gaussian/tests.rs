//! What a moment rule adds to the noise counts as noise.

use super::adapt::NoAdaptation;
use super::moments::{Affine, Map, MomentRule, Moments};
use super::*;
use crate::data::Log;
use crate::filter::columns::Columns;
use crate::filter::form::Form;
use crate::filter::rows::Rows;
use crate::filter::units::Units;
use crate::model::Problem;
use crate::tape::Calculator;

/// The affine rule with so much more noise of f and of h.
struct Wider(f64, f64);

impl MomentRule for Wider {
    fn through(
        &self,
        t: &mut Tracer<'_>,
        row: &Row,
        map: Map,
        x: &[Id],
        P: &Covariance,
    ) -> Result<Moments, TraceError> {
        let more = t.g.constant(if map == Map::Transition { self.0 } else { self.1 });
        let excess = Some(Symmetric::from_fn(1, |_, _| more));
        Ok(Moments { excess, ..Affine.through(t, row, map, x, P)? })
    }
}

/// Entries after a row and S, of a prior of mean 1 and variance 2, with Q, R and what a rule adds to them.
fn step(q: f64, r: f64, rule: Wider, form: Form) -> Vec<f64> {
    let text = format!(
        "[data]\nfile = \"log.csv\"\ntime = \"t\"\nmeasurements = [\"z\"]\n[model]\nstate = [\"x\"]\nf = [\"0.9*x\"]\nh = [\"2*x\"]\n\
         Q = [{q}]\nR = [{r}]\nx0 = [0]\nP0 = [4]\n"
    );
    let problem = Problem::parse(&text, "problem.toml").unwrap();
    let log = Log::read(&problem.data, "t,z\n0,3\n1,4\n".as_bytes(), "log.csv").unwrap();
    let (rows, units, mut columns) = (Rows::new(&problem, &log), Units::own(1, 1), Columns::default());
    let mut t = Tracer::new(&problem, &rows, &mut columns, &units, None);
    let filter = Gaussian::new(Carrying { form, anchored: false, affine: true }, rule, NoAdaptation);
    let row = Row::new(&mut t).unwrap();
    let prior = [1.0, 2.0].map(|value| t.g.constant(value));
    let (evidence, posterior) = filter.update(&mut t, &row, &prior).unwrap();
    let next = filter.predict(&mut t, &row, &posterior).unwrap().prior;
    Calculator::new(&t.g, &[next, evidence.spread].concat()).evaluate(|leaf| t.at(leaf, 0)).collect()
}

#[test]
fn excess_of_a_moment_rule_is_noise() {
    for form in [Form::Full, Form::Factored] {
        let (wider, typed) = (step(0.1, 0.5, Wider(0.3, 0.25), form), step(0.4, 0.75, Wider(0.0, 0.0), form));
        assert!(wider.iter().zip(&typed).all(|(a, b)| (a - b).abs() < 1e-14), "{form:?}: {wider:?}, {typed:?}");
        // S = H P H' + R, K = P H' / S, and the prediction by 0.9.
        let (s, k) = (4.0 * 2.0 + 0.75, 4.0 / 8.75);
        let by_hand = [0.9 * (1.0 + k * (3.0 - 2.0)), 0.81 * (2.0 - k * 4.0) + 0.4, s];
        assert!(wider.iter().zip(&by_hand).all(|(a, b)| (a - b).abs() < 1e-14), "{form:?}: {wider:?}, {by_hand:?}");
    }
}
