//! Parameters: fixed, tied or searched.

/// All parameters of a problem, in file order. Factored covariances add their elements (`M11`, `M12`, ...) at the end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Parameters {
    /// Every parameter; [`super::Symbol::Parameter`] indexes this list.
    pub all: Vec<Parameter>,
}

/// One named parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name, as formulas use it.
    pub name: String,
    /// Unit for reports, such as `m^2`.
    pub unit: Option<String>,
    /// How it gets its value.
    pub value: Value,
}

/// How a parameter gets its value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Given.
    Fixed(f64),
    /// The same as parameter `i` (never itself tied).
    Tied(usize),
    /// Found by the optimiser.
    Searched(Search),
}

/// The range of a searched parameter, in its own unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Search {
    /// Lower bound; -inf when unbounded.
    pub min: f64,
    /// Upper bound; +inf when unbounded.
    pub max: f64,
    /// Whether steps are taken in the value or its logarithm.
    pub scale: Scale,
    /// First population is drawn uniformly (on `scale`) from here; the bounds when bounded.
    pub init: [f64; 2],
    /// The user's own value: the baseline, and a member of generation 0.
    pub start: Option<f64>,
}

/// On what scale the optimiser moves a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Scale {
    Linear,
    Log,
}

impl Search {
    /// The start, or where none is given the middle of `init` on the parameter's scale.
    #[must_use]
    pub fn start_or_middle(&self) -> f64 {
        self.start.unwrap_or_else(|| self.at(0.5))
    }

    /// The value at this share of the way through `init`, on the parameter's scale.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        let [low, high] = self.init;
        let between = |low: f64, high: f64| (1.0 - share) * low + share * high;
        match self.scale {
            Scale::Linear => between(low, high),
            Scale::Log => between(low.ln(), high.ln()).exp(),
        }
    }
}

impl Parameter {
    /// Whether the optimiser finds its value.
    #[must_use]
    pub const fn is_searched(&self) -> bool {
        matches!(self.value, Value::Searched(_))
    }
}

impl Parameters {
    /// The searched parameters, in order: this is the order of every candidate vector.
    pub fn searched(&self) -> impl Iterator<Item = (&Parameter, &Search)> {
        self.all.iter().filter_map(|p| match &p.value {
            Value::Searched(search) => Some((p, search)),
            _ => None,
        })
    }

    /// Number of searched parameters.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.searched().count()
    }

    /// Names of the searched parameters.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        self.searched().map(|(p, _)| p.name.as_str()).collect()
    }

    /// The user's own candidate: every start, or the middle where none is given.
    #[must_use]
    pub fn baseline(&self) -> Vec<f64> {
        self.searched().map(|(_, s)| s.start_or_middle()).collect()
    }

    /// The values of [`Self::all`] for a candidate (searched values in their own units, in order of [`Self::searched`]).
    ///
    /// # Panics
    /// If `candidate` is not [`Self::dimension`] long.
    #[must_use]
    pub fn resolve(&self, candidate: &[f64]) -> Vec<f64> {
        assert_eq!(candidate.len(), self.dimension(), "a candidate has one value per searched parameter");
        let mut next = candidate.iter();
        let mut values: Vec<f64> = self
            .all
            .iter()
            .map(|p| match p.value {
                Value::Fixed(value) => value,
                Value::Searched(_) => next.next().copied().unwrap_or(f64::NAN),
                Value::Tied(_) => f64::NAN,
            })
            .collect();
        for (i, p) in self.all.iter().enumerate() {
            if let Value::Tied(to) = p.value {
                values[i] = values[to];
            }
        }
        values
    }
}
