//! Candidates without random numbers, so that any program in any language scores the same ones.

use crate::evaluate::Population;
use crate::model::{Parameters, Scale};

/// `n` candidates of the searched parameters: the additive recurrence u_ij = frac(0.5 + (i + 1) alpha_j), i = 0, 1, ...,
/// with alpha_j = frac(g^-(j+1)) and g the positive root of g^(d+1) = g + 1 (M. Roberts, "The unreasonable
/// effectiveness of quasirandom sequences", 2018), spread over each parameter's `init` range on its own scale.
#[must_use]
pub fn candidates(parameters: &Parameters, n: usize) -> Population {
    let dimension = parameters.dimension();
    let mut population = Population::new(dimension);
    let alpha = steps(dimension);
    for i in 0..n {
        let row: Vec<f64> = parameters
            .searched()
            .zip(&alpha)
            .map(|((_, search), alpha)| place((0.5 + (i + 1) as f64 * alpha) % 1.0, search.init, search.scale))
            .collect();
        population.push(&row);
    }
    population
}

/// The recurrence's step in each of `dimension` directions.
fn steps(dimension: usize) -> Vec<f64> {
    let root = 1.0 / (dimension as f64 + 1.0);
    let g = (0..64).fold(2.0_f64, |g, _| (1.0 + g).powf(root));
    (0..dimension).map(|j| (1.0 / g).powf((j + 1) as f64) % 1.0).collect()
}

/// The value at `u` in [0, 1) of the way through a range.
fn place(u: f64, [low, high]: [f64; 2], scale: Scale) -> f64 {
    match scale {
        Scale::Linear => low + (high - low) * u,
        // log10, not ln: ranges are usually whole decades, whose exponents it gives exactly.
        Scale::Log => 10_f64.powf(low.log10() + (high.log10() - low.log10()) * u),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameter, Search, Value};

    fn searched(name: &str, init: [f64; 2], scale: Scale) -> Parameter {
        let search = Search { min: init[0], max: init[1], scale, init, start: None };
        Parameter { name: name.to_owned(), unit: None, value: Value::Searched(search) }
    }

    #[test]
    fn one_parameter_steps_by_the_golden_ratio() {
        let parameters = Parameters { all: vec![searched("r", [0.0, 1.0], Scale::Linear)] };
        let population = candidates(&parameters, 3);
        let golden = 5.0_f64.sqrt().mul_add(0.5, -0.5);
        for (i, row) in population.rows().enumerate() {
            let expected = (0.5 + (i + 1) as f64 * golden).fract();
            assert!((row[0] - expected).abs() < 1e-12, "candidate {i}: {} is not {expected}", row[0]);
        }
    }

    #[test]
    fn candidates_stay_in_their_ranges_and_fill_them() {
        let parameters =
            Parameters { all: vec![searched("a", [-3.0, 5.0], Scale::Linear), searched("b", [1e-4, 1e2], Scale::Log)] };
        let population = candidates(&parameters, 1000);
        assert_eq!(population.len(), 1000, "one row per candidate");
        assert!(population.rows().all(|c| (-3.0..5.0).contains(&c[0]) && (1e-4..1e2).contains(&c[1])), "in range");
        let median_decade = population.rows().filter(|c| c[1] < 0.1).count();
        assert!((490..=510).contains(&median_decade), "half lie below the middle decade, got {median_decade}");
    }

    #[test]
    fn nothing_searched_gives_an_empty_population() {
        assert!(candidates(&Parameters::default(), 4).is_empty(), "no dimension, no candidate");
    }
}
