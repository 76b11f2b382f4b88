//! What has to be carried from row to row, and what does not.
//!
//! Entries of x, P and what an adaptive filter carries that always have one value (structural zeros above all), or always
//! equal each other (the axes of a model with shared noise), are found by partition refinement: entries start in one class
//! if their initial values are one node; a step is traced with one leaf a class; entries of a class whose next values
//! differ are parted, until none do. The last trace is the filter. A 3-D constant-velocity filter falls apart into three 2-state filters by this alone.

use super::carried::narrow;
use crate::tape::{Graph, Id, Leaf, Node};
use std::collections::HashMap;

/// A partition of the entries of (x, P, what is adapted) into classes that are carried as one value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Partition {
    /// Class of each entry.
    of: Vec<usize>,
    /// For each class its constant value, by bits, if it has one.
    constant: Vec<Option<u64>>,
}

impl Partition {
    /// The coarsest partition: entries with the same initial node; the last `apart` are classes of their own from the start.
    pub(super) fn by_initial(g: &Graph, initial: &[Id], apart: usize) -> Self {
        let mut class: HashMap<Id, usize> = HashMap::new();
        let mut partition = Self { of: vec![], constant: vec![] };
        let (alike, apart) = initial.split_at(initial.len().saturating_sub(apart));
        for id in alike {
            let next = class.len();
            let c = *class.entry(*id).or_insert(next);
            if c == next {
                partition.constant.push(match g.node(*id) {
                    Node::Constant(bits) => Some(bits),
                    _ => None,
                });
            }
            partition.of.push(c);
        }
        for _ in apart {
            partition.of.push(partition.constant.len());
            partition.constant.push(None);
        }
        partition
    }

    /// The node of every entry: constants where they are, leaves elsewhere.
    pub(super) fn nodes(&self, g: &mut Graph) -> Vec<Id> {
        let ids: Vec<Id> = (0..self.constant.len())
            .map(|class| match self.constant[class] {
                Some(bits) => g.constant(f64::from_bits(bits)),
                None => g.leaf(Leaf::Carried(narrow(self.place(class)))),
            })
            .collect();
        self.of.iter().map(|class| ids[*class]).collect()
    }

    /// Place of a class among those that are carried.
    fn place(&self, class: usize) -> usize {
        self.constant[..class].iter().filter(|c| c.is_none()).count()
    }

    /// For each carried value, the first entry that it stands for.
    pub(super) fn representatives(&self) -> Vec<usize> {
        let classes = (0..self.constant.len()).filter(|c| self.constant[*c].is_none());
        classes.filter_map(|class| self.of.iter().position(|c| *c == class)).collect()
    }

    /// Where the value of each entry is found.
    pub(super) fn entries(&self) -> Vec<Entry> {
        let of = |class: usize| match self.constant[class] {
            Some(bits) => Entry::Constant(f64::from_bits(bits)),
            None => Entry::Carried(self.place(class)),
        };
        self.of.iter().map(|class| of(*class)).collect()
    }

    /// Parts the entries of a class whose next values differ; `None` when there are none, so that the partition is right.
    pub(super) fn refine(&self, g: &Graph, next: &[Id]) -> Option<Self> {
        // A constant class keeps the entries that stay at its value; every other group is carried.
        let mut class: HashMap<(usize, Option<Id>), usize> = HashMap::new();
        let mut refined = Self { of: vec![], constant: vec![] };
        for (old, id) in self.of.iter().zip(next) {
            let stays = self.constant[*old].is_some_and(|bits| g.node(*id) == Node::Constant(bits));
            let fresh = class.len();
            let c = *class.entry((*old, (!stays).then_some(*id))).or_insert(fresh);
            if c == fresh {
                refined.constant.push(if stays { self.constant[*old] } else { None });
            }
            refined.of.push(c);
        }
        (refined.constant.len() != self.constant.len()
            || refined.constant.iter().flatten().count() != self.constant.iter().flatten().count())
        .then_some(refined)
    }
}

/// Where the value of an entry is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entry {
    /// It never changes.
    Constant(f64),
    /// In a carried register.
    Carried(usize),
}

impl Entry {
    /// Its value before a row, from what each register holds there.
    #[must_use]
    pub fn value(self, of: impl Fn(usize) -> f64) -> f64 {
        match self {
            Self::Constant(value) => value,
            Self::Carried(register) => of(register),
        }
    }
}
