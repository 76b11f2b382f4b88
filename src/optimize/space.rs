//! The box that candidates move in.

use super::OptimizeError;

/// The box that an optimiser moves in: one entry per searched parameter, in the parameter's value or its logarithm.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    /// Lower bounds; -inf when unbounded.
    pub lower: Vec<f64>,
    /// Upper bounds; +inf when unbounded.
    pub upper: Vec<f64>,
    /// Where the first population is drawn from, uniformly.
    pub init: Vec<[f64; 2]>,
    /// Candidates that replace the first members of generation 0 (the user's start).
    pub seeds: Vec<Vec<f64>>,
}

impl Space {
    /// A box whose first population is drawn from the whole of it.
    #[must_use]
    pub fn boxed(bounds: &[[f64; 2]]) -> Self {
        Self {
            lower: bounds.iter().map(|b| b[0]).collect(),
            upper: bounds.iter().map(|b| b[1]).collect(),
            init: bounds.to_vec(),
            seeds: Vec::new(),
        }
    }

    /// Number of coordinates.
    #[must_use]
    pub const fn dimension(&self) -> usize {
        self.init.len()
    }

    /// Moves `position` to the nearest point of the box. Unbounded coordinates stay as they are.
    pub fn clip(&self, position: &mut [f64]) {
        for ((x, lower), upper) in position.iter_mut().zip(&self.lower).zip(&self.upper) {
            *x = x.max(*lower).min(*upper);
        }
    }

    /// Whether every list has one entry a coordinate, bounds are in order and `init` is finite.
    ///
    /// # Errors
    /// [`OptimizeError::Space`] names the first coordinate that does not fit.
    pub fn check(&self) -> Result<(), OptimizeError> {
        let n = self.dimension();
        let fail = |coordinate, problem| Err(OptimizeError::Space { coordinate, problem });
        if n == 0 {
            return fail(0, "there is no coordinate to search");
        }
        if self.lower.len() != n || self.upper.len() != n || self.seeds.iter().any(|s| s.len() != n) {
            return fail(n, "bounds, init and seeds differ in length");
        }
        for (d, [low, high]) in self.init.iter().enumerate() {
            let ordered = self.lower[d] <= self.upper[d] && low <= high;
            if !ordered {
                return fail(d, "a lower limit is not below the upper one, or is not a number");
            }
            if !low.is_finite() || !high.is_finite() {
                return fail(d, "the first population needs a finite range to be drawn from");
            }
        }
        let lost = |seed: &Vec<f64>| seed.iter().position(|x| !x.is_finite());
        self.seeds.iter().find_map(lost).map_or(Ok(()), |d| fail(d, "a start is not a finite number"))
    }
}
