//! The same problem by another filter.

use super::error::{Fault, nearest, suggestion};
use super::family::Settings;
use super::{Adapts, Expr, FilterKind, Problem, Span};
use crate::words::{enumerated, shorten};

/// A filter that a problem cannot be run by.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FilterError {
    /// No filter has that name.
    #[error("there is no filter `{}`{}", shorten(.name), suggestion(.nearest.as_deref(), .known))]
    Unknown {
        /// As given.
        name: String,
        /// The one that was meant, perhaps.
        nearest: Option<String>,
        /// Those that can be given.
        known: Vec<String>,
    },
    /// It needs affine f and h.
    #[error("the {name} filter takes affine f and h, and this problem's are not: give {}", alternatives())]
    Nonlinear {
        /// Its name.
        name: &'static str,
    },
    /// What it changes on the way decides its scores.
    #[error("the {name} filter adapts its noise, which hides what its view of f and h costs: give {}", alternatives())]
    Adaptive {
        /// Its name.
        name: &'static str,
    },
    /// It cannot be had by its name alone.
    #[error("the {name} filter has settings without a default: give {}", alternatives())]
    Settings {
        /// Its name.
        name: &'static str,
    },
}

/// "one of ..." those that take any f and h.
fn alternatives() -> String {
    let names: Vec<String> = FilterKind::nonlinear().map(|name| format!("`{name}`")).collect();
    format!("one of {}", enumerated(&names))
}

impl Problem {
    /// The same problem by the filter called `name`: the problem's own kind as it is set there, any other with its settings
    /// at their defaults. Robust updates stay as they are.
    ///
    /// # Errors
    /// If there is no such filter, if it adapts its noise or needs affine f and h and these are not, and it is not the
    /// problem's own.
    pub fn with_filter(&self, name: &str) -> Result<Self, FilterError> {
        if name == self.filter.name() {
            return Ok(self.clone());
        }
        let Some(name) = FilterKind::NAMES.iter().copied().find(|known| *known == name) else {
            let known = self.filters();
            let nearest = nearest(name, known.iter().copied());
            let known = known.into_iter().map(str::to_owned).collect();
            return Err(FilterError::Unknown { name: name.to_owned(), nearest, known });
        };
        let defaults = Defaults { states: self.model.states.len() };
        let filter = FilterKind::read(name, &defaults).map_err(|_| FilterError::Settings { name })?;
        if filter.facts().adapts != Adapts::Nothing {
            return Err(FilterError::Adaptive { name });
        }
        if filter.is_linear() && !self.model.is_affine() {
            return Err(FilterError::Nonlinear { name });
        }
        Ok(Self { filter, ..self.clone() })
    }

    /// The names that [`Self::with_filter`] takes.
    fn filters(&self) -> Vec<&'static str> {
        let linear = FilterKind::NAMES[0];
        let affine = self.model.is_affine().then_some(linear);
        let own = Some(self.filter.name()).filter(|own| *own != linear && self.filter.is_linear());
        // What cannot do without settings is no other filter of the same problem.
        let defaults = Defaults { states: self.model.states.len() };
        let others = FilterKind::nonlinear().filter(|name| FilterKind::read(name, &defaults).is_ok());
        affine.into_iter().chain(own).chain(others).collect()
    }
}

/// `[filter]` without a key.
struct Defaults {
    states: usize,
}

impl Settings for Defaults {
    fn states(&self) -> usize {
        self.states
    }

    fn formula(&self, _: &'static str, default: f64) -> Result<Expr, Fault> {
        Ok(Expr::number(default))
    }

    fn formula_of_each(&self, _: &'static str) -> Result<Option<Vec<Expr>>, Fault> {
        Ok(None)
    }

    fn count(&self, _: &'static str, default: usize, _: u32, _: u32) -> Result<usize, Fault> {
        Ok(default)
    }

    fn modes(&self) -> usize {
        0
    }

    fn rows(&self, _: &'static str) -> Result<Option<Vec<Vec<Expr>>>, Fault> {
        Ok(None)
    }

    fn refuse(&self, key: &'static str, problem: String) -> Fault {
        Fault::invalid(Span::default(), key, problem)
    }
}
