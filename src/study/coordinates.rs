//! Search coordinates and parameter values: the value itself, or its logarithm.

use crate::evaluate::Population;
use crate::model::{Parameters, Scale, Search};
use crate::optimize::Space;

/// The map between what optimisers move and what evaluators score.
#[derive(Debug, Clone)]
pub struct Coordinates {
    searches: Vec<Search>,
    /// The user's start as position and as value: exp(ln(x)) is not always x, and the start must be scored as given.
    start: Option<(Vec<f64>, Vec<f64>)>,
}

impl Coordinates {
    /// Of the searched parameters. Their start joins generation 0 if `include_start` and at least one is given; where
    /// one is missing the middle of `init` stands in.
    #[must_use]
    pub fn new(parameters: &Parameters, include_start: bool) -> Self {
        let searches: Vec<Search> = parameters.searched().map(|(_, search)| search.clone()).collect();
        let mut coordinates = Self { searches, start: None };
        if include_start && coordinates.searches.iter().any(|s| s.start.is_some()) {
            let value: Vec<f64> =
                coordinates.searches.iter().map(|s| s.start_or_middle().max(s.min).min(s.max)).collect();
            coordinates.start = Some((coordinates.position(&value), value));
        }
        coordinates
    }

    /// Number of search coordinates.
    #[must_use]
    pub const fn dimension(&self) -> usize {
        self.searches.len()
    }

    /// The user's start, where it joins generation 0.
    #[must_use]
    pub fn start(&self) -> Option<&[f64]> {
        self.start.as_ref().map(|(_, value)| value.as_slice())
    }

    /// The box in search coordinates, seeded with the start.
    #[must_use]
    pub fn space(&self) -> Space {
        let map = |get: fn(&Search) -> f64| self.searches.iter().map(|s| to_position(s, get(s))).collect();
        Space {
            lower: map(|s| s.min),
            upper: map(|s| s.max),
            init: self.searches.iter().map(|s| s.init.map(|x| to_position(s, x))).collect(),
            seeds: self.start.iter().map(|(position, _)| position.clone()).collect(),
        }
    }

    /// A length in each search coordinate that counts as large: a factor of ten on a log scale, half the range on a linear
    /// one (of `init` where it is unbounded), or, without a range, the size of the value there.
    #[must_use]
    pub fn units(&self, candidate: &[f64]) -> Vec<f64> {
        self.searches.iter().zip(candidate).map(|(search, value)| unit(search, *value)).collect()
    }

    /// A first step for differences in each search coordinate: one per cent of the value.
    #[must_use]
    pub fn steps(&self, candidate: &[f64]) -> Vec<f64> {
        let step = |((search, value), unit): ((&Search, &f64), f64)| match search.scale {
            Scale::Log => 0.01,
            Scale::Linear if *value == 0.0 => 1e-3 * unit,
            Scale::Linear => (0.01 * value.abs()).min(unit),
        };
        self.searches.iter().zip(candidate).zip(self.units(candidate)).map(step).collect()
    }

    /// Search coordinates of a candidate.
    #[must_use]
    pub fn position(&self, candidate: &[f64]) -> Vec<f64> {
        self.searches.iter().zip(candidate).map(|(s, value)| to_position(s, *value)).collect()
    }

    /// Candidates at these positions, never outside their bounds by rounding.
    #[must_use]
    pub fn candidates(&self, positions: &Population) -> Population {
        let mut candidates = positions.clone();
        for i in 0..candidates.len() {
            let row = candidates.row_mut(i);
            match &self.start {
                Some((position, value)) if row == position => row.copy_from_slice(value),
                _ => row.iter_mut().zip(&self.searches).for_each(|(x, search)| *x = to_value(search, *x)),
            }
        }
        candidates
    }
}

fn unit(search: &Search, value: f64) -> f64 {
    let width = if search.max.is_finite() { search.max - search.min } else { search.init[1] - search.init[0] };
    match search.scale {
        Scale::Log => std::f64::consts::LN_10,
        Scale::Linear if width > 0.0 => 0.5 * width,
        Scale::Linear => value.abs().max(1.0),
    }
}

fn to_position(search: &Search, value: f64) -> f64 {
    match search.scale {
        Scale::Linear => value,
        // An unbounded logarithm has no lower end.
        Scale::Log if value == f64::NEG_INFINITY => value,
        Scale::Log => value.ln(),
    }
}

fn to_value(search: &Search, position: f64) -> f64 {
    let value = match search.scale {
        Scale::Linear => position,
        Scale::Log => position.exp(),
    };
    value.max(search.min).min(search.max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameter, Value};
    use proptest::prelude::*;

    fn parameters(searches: Vec<Search>) -> Parameters {
        let named = |search| Parameter { name: "p".to_owned(), unit: None, value: Value::Searched(search) };
        Parameters { all: searches.into_iter().map(named).collect() }
    }

    fn search(scale: Scale, min: f64, max: f64, start: Option<f64>) -> Search {
        Search { min, max, scale, init: [min, max], start }
    }

    proptest! {
        #[test]
        fn round_trips_stay_in_bounds(min in 1e-12..1e3f64, factor in 1.0..1e12f64, share in 0.0..=1.0f64) {
            let max = min * factor;
            let both = [Scale::Linear, Scale::Log].map(|scale| search(scale, min, max, None));
            let coordinates = Coordinates::new(&parameters(both.to_vec()), true);
            let space = coordinates.space();
            let corner = |x: &[f64]| coordinates.candidates(&Population::from_rows(2, x.to_vec())).row(0).to_vec();
            prop_assert_eq!(corner(&space.lower)[0].to_bits(), min.to_bits());
            for (value, end) in [(corner(&space.lower)[1], min), (corner(&space.upper)[1], max)] {
                prop_assert!((min..=max).contains(&value) && (value / end - 1.0).abs() < 1e-13, "{} for {}", value, end);
            }
            let value = min + share * (max - min);
            let back = corner(&coordinates.position(&[value, value]));
            prop_assert_eq!(back[0].to_bits(), value.min(max).to_bits());
            prop_assert!((back[1] / value - 1.0).abs() < 1e-13, "{} for {}", back[1], value);
        }
    }

    #[test]
    fn the_start_is_scored_as_given() {
        let awkward = 0.1 + 0.2;
        let given = search(Scale::Log, 1e-3, 45.0, Some(awkward));
        let coordinates =
            Coordinates::new(&parameters(vec![given.clone(), search(Scale::Linear, 0.0, 4.0, None)]), true);
        assert_eq!(coordinates.start(), Some(&[awkward, 2.0][..]), "the middle stands in for a missing start");
        let space = coordinates.space();
        let scored = coordinates.candidates(&Population::from_rows(2, space.seeds[0].clone()));
        assert_eq!(scored.row(0), [awkward, 2.0]);
        assert!(Coordinates::new(&parameters(vec![given]), false).space().seeds.is_empty(), "include_start = false");
        let none = Coordinates::new(&parameters(vec![search(Scale::Linear, 0.0, 4.0, None)]), true);
        assert!(none.space().seeds.is_empty(), "no start is given");
    }
}
