//! What objectives remember from row to row: entries that are carried behind those of the filter.

use super::error::TraceError;
use super::family::Family;
use super::tracer::Tracer;
use crate::model::Model;
use crate::tape::{Graph, Id};
use std::collections::HashMap;

/// One number that is remembered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Memo {
    /// The standardised innovation of a component, `lag` of its values ago, of scorers that leave out `skip` rows; 0 where there
    /// was none.
    Innovation { component: usize, lag: usize, skip: usize },
    /// A state of this row as it was predicted `rows` rows before its own prior, which `rows` = 0 would be.
    Lead { state: usize, rows: usize },
}

impl Memo {
    fn name(self, model: &Model) -> String {
        match self {
            Self::Innovation { component, lag, skip } => {
                let rows = if skip > 0 { format!(".skip{skip}") } else { String::new() };
                format!("nu.{}-{lag}{rows}", model.measurements[component])
            }
            Self::Lead { state, rows } => format!("x.{}-{rows}", model.states[state]),
        }
    }

    /// Its value before the first row of a trajectory, whose filter starts from `entries`.
    fn start(self, g: &mut Graph, entries: &[Id]) -> Id {
        match self {
            Self::Innovation { .. } => g.constant(0.0),
            // Nothing scores by it, but f must have a value there.
            Self::Lead { state, .. } => entries[state],
        }
    }
}

/// What all scorers of a problem remember; what several of them do is there once.
#[derive(Debug, Default)]
pub(super) struct Memory {
    memos: Vec<Memo>,
    place: HashMap<Memo, usize>,
}

impl Memory {
    pub(super) fn of(asked: impl IntoIterator<Item = Memo>) -> Self {
        let mut memory = Self::default();
        for memo in asked {
            let next = memory.memos.len();
            if *memory.place.entry(memo).or_insert(next) == next {
                memory.memos.push(memo);
            }
        }
        memory
    }

    pub(super) const fn len(&self) -> usize {
        self.memos.len()
    }
}

/// A filter, and what is remembered beside it.
pub(super) struct Remembering {
    pub(super) family: Box<dyn Family>,
    pub(super) memory: Memory,
}

impl Remembering {
    /// Names of what is carried, in order: the filter's entries, then those of the memory.
    pub(super) fn names(&self, model: &Model) -> Vec<String> {
        let memos = self.memory.memos.iter().map(|memo| memo.name(model));
        self.family.names(model).into_iter().chain(memos).collect()
    }

    /// As [`Family::opaque`]: what is remembered never equals anything else.
    pub(super) fn opaque(&self, model: &Model) -> usize {
        self.family.opaque(model) + self.memory.len()
    }

    /// What is carried before the first row of a trajectory.
    ///
    /// # Errors
    /// If the model does not fit the filter.
    pub(super) fn start(&self, t: &mut Tracer<'_>) -> Result<Vec<Id>, TraceError> {
        let mut entries = self.family.start(t)?;
        let memory: Vec<Id> = self.memory.memos.iter().map(|memo| memo.start(&mut t.g, &entries)).collect();
        entries.extend(memory);
        Ok(entries)
    }
}

/// The memory in a row: what it holds, and what the row leaves in it.
pub(super) struct Recall<'a> {
    memory: &'a Memory,
    now: &'a [Id],
    next: Vec<Id>,
}

impl<'a> Recall<'a> {
    pub(super) fn new(memory: &'a Memory, now: &'a [Id]) -> Self {
        Self { memory, now, next: now.to_vec() }
    }

    /// What is remembered; `None` of what no scorer said it would need.
    pub(super) fn get(&self, memo: Memo) -> Option<Id> {
        self.memory.place.get(&memo).map(|place| self.now[*place])
    }

    /// Remembers `value` from the next row on; what is not set stays.
    pub(super) fn set(&mut self, memo: Memo, value: Id) {
        if let Some(place) = self.memory.place.get(&memo) {
            self.next[*place] = value;
        }
    }

    pub(super) fn finish(self) -> Vec<Id> {
        self.next
    }
}
