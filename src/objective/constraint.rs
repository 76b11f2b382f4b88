//! Inequality constraints on what a filter run is scored by.

use std::fmt;

use super::Objective;

/// A bound that candidates should keep: `nis_mean <= 1.2`.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// What is bounded: an objective, `nis_mean` or `nees_mean`.
    pub measure: Objective,
    /// On which side.
    pub relation: Relation,
    /// By what, in the measure's own unit.
    pub limit: f64,
}

/// The side of its limit on which a measure should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
pub enum Relation {
    /// `<=`
    #[serde(rename = "<=")]
    AtMost,
    /// `>=`
    #[serde(rename = ">=")]
    AtLeast,
}

impl Relation {
    /// Both, as they are written.
    pub const ALL: [(&'static str, Self); 2] = [("<=", Self::AtMost), (">=", Self::AtLeast)];

    /// The same relation read from the other side: 0.8 <= a is a >= 0.8.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        match self {
            Self::AtMost => Self::AtLeast,
            Self::AtLeast => Self::AtMost,
        }
    }
}

impl fmt::Display for Relation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AtMost => "<=",
            Self::AtLeast => ">=",
        })
    }
}

impl Constraint {
    /// How far `value` lies beyond the limit, in units of |limit| (of 1 where the limit is 0), so that constraints of
    /// different units can be added up; 0 = satisfied, infinite for a value that is no number.
    ///
    /// ```
    /// use kfgpu::objective::{Constraint, Kind, Objective, Relation};
    /// let bound = Constraint { measure: Objective::new(Kind::Rmse), relation: Relation::AtMost, limit: 4.0 };
    /// assert_eq!([3.0, 4.0, 5.0].map(|rmse| bound.violation(rmse)), [0.0, 0.0, 0.25]);
    /// ```
    #[must_use]
    pub fn violation(&self, value: f64) -> f64 {
        if value.is_nan() {
            return f64::INFINITY;
        }
        let beyond = match self.relation {
            Relation::AtMost => value - self.limit,
            Relation::AtLeast => self.limit - value,
        };
        let unit = self.limit.abs();
        beyond.max(0.0) / if unit > 0.0 { unit } else { 1.0 }
    }

    /// The sum of violations of one value per constraint: 0 = feasible.
    #[must_use]
    pub fn total_violation(constraints: &[Self], values: &[f64]) -> f64 {
        constraints.iter().zip(values).map(|(constraint, value)| constraint.violation(*value)).sum()
    }
}

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.measure.name(), self.relation, self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objective::Kind;

    fn constraint(relation: Relation, limit: f64) -> Constraint {
        Constraint { measure: Objective::new(Kind::NisMean), relation, limit }
    }

    #[test]
    fn exceedance_is_in_units_of_the_limit() {
        let cases = [
            (Relation::AtMost, 1.25, 1.5, 0.2),
            (Relation::AtMost, -2.0, -1.0, 0.5),
            (Relation::AtLeast, 0.5, 0.25, 0.5),
            (Relation::AtMost, 0.0, 3.0, 3.0),
            (Relation::AtLeast, 0.0, 3.0, 0.0),
            (Relation::AtLeast, 0.5, f64::NAN, f64::INFINITY),
        ];
        for (relation, limit, value, expected) in cases {
            let found = constraint(relation, limit).violation(value);
            assert!(found.total_cmp(&expected).is_eq(), "{value} against {relation} {limit}: {found}");
        }
        let both = [constraint(Relation::AtMost, 1.25), constraint(Relation::AtLeast, 0.5)];
        assert!((Constraint::total_violation(&both, &[1.5, 0.25]) - 0.7).abs() < 1e-15, "violations add up");
        assert_eq!(both[0].to_string(), "nis_mean <= 1.25");
    }
}
