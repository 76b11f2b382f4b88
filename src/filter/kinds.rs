//! Kinds of rows: rows in which the same happens (the same sensors speak, the same rows score) share a tape in which it is
//! decided already, so that nobody computes what a mask takes away again.

use std::collections::HashMap;

/// A kind for each used row of the log.
#[derive(Debug, Clone, Default)]
pub(super) struct Kinds {
    /// Empty where all rows are of one kind.
    of: Vec<u8>,
    /// Rows of each kind.
    counts: Vec<usize>,
}

impl Kinds {
    /// Most kinds of one program.
    const MOST: usize = 8;
    /// Operations of all tapes together up to which rows are parted: what an instruction cache and a shader compiler bear.
    const OPERATIONS: usize = 8192;
    /// One row in so many makes a kind worth its tape.
    const SHARE: usize = 32;

    /// Parts rows by columns of 0 and 1: a kind for each common pattern, and one for all the others, where masks decide.
    /// `operations` is the length of the tape with masks.
    pub(super) fn by_flags(flags: &[&[f64]], rows: usize, operations: usize) -> Option<Self> {
        let most = Self::MOST.min(Self::OPERATIONS / operations.max(1));
        let mut patterns: HashMap<Vec<bool>, (usize, usize)> = HashMap::new();
        let pattern = |row: usize| flags.iter().map(|flag| flag[row] > 0.0).collect::<Vec<_>>();
        for row in 0..rows {
            patterns.entry(pattern(row)).or_insert((0, row)).0 += 1;
        }
        let mut common: Vec<_> = patterns.into_iter().filter(|(_, (count, _))| count * Self::SHARE >= rows).collect();
        common.sort_unstable_by_key(|(_, (count, first))| (std::cmp::Reverse(*count), *first));
        let covered: usize = common.iter().map(|(_, (count, _))| count).sum();
        common.truncate(if covered == rows && common.len() <= most { most } else { most.saturating_sub(1) });
        if common.is_empty() || most < 2 {
            return None;
        }
        let kind: HashMap<Vec<bool>, u8> = (0_u8..).zip(common).map(|(kind, (pattern, _))| (pattern, kind)).collect();
        let (mut of, mut counts) = (Vec::with_capacity(rows), vec![0; kind.len()]);
        let others = u8::try_from(kind.len()).ok()?;
        for row in 0..rows {
            let kind = kind.get(&pattern(row)).copied().unwrap_or(others);
            counts.resize(counts.len().max(usize::from(kind) + 1), 0);
            counts[usize::from(kind)] += 1;
            of.push(kind);
        }
        (counts.len() > 1).then_some(Self { of, counts })
    }

    /// Number of kinds.
    pub(super) fn len(&self) -> usize {
        self.counts.len().max(1)
    }

    /// The kind of each used row; nothing where there is one kind.
    pub(super) fn of(&self) -> &[u8] {
        &self.of
    }

    /// What a column over all rows is over those of a kind.
    pub(super) fn part(&self, kind: usize, values: &[f64]) -> Vec<f64> {
        let own = self.of.iter().zip(values).filter(|(of, _)| usize::from(**of) == kind);
        own.map(|(_, value)| *value).collect()
    }

    /// Rows of a kind, of a log with `rows`.
    pub(super) fn rows(&self, kind: usize, rows: usize) -> usize {
        self.counts.get(kind).copied().unwrap_or(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_patterns_are_kinds_and_the_rest_is_one() {
        let a: Vec<f64> = (0..100).map(|row| f64::from(u8::from(row % 2 == 0))).collect();
        let b: Vec<f64> = (0..100).map(|row| f64::from(u8::from(row == 31))).collect();
        let kinds = Kinds::by_flags(&[&a, &b], 100, 50).unwrap();
        assert_eq!(kinds.len(), 3, "two patterns, and the one row with b");
        assert_eq!(kinds.counts, [50, 49, 1]);
        assert_eq!((kinds.of()[0], kinds.of()[1], kinds.of()[31]), (0, 1, 2));
        let index: Vec<f64> = (0_u8..100).map(f64::from).collect();
        assert_eq!(kinds.part(2, &index), [31.0]);
        assert!(Kinds::by_flags(&[&b], 100, 50).is_some(), "one row apart frees all the others of their masks");
    }

    #[test]
    fn long_tapes_and_rare_patterns_are_left_alone() {
        let a: Vec<f64> = (0..100).map(|row| f64::from(u8::from(row % 2 == 0))).collect();
        assert!(Kinds::by_flags(&[&a], 100, 5000).is_none(), "two tapes of 5000 operations are too many");
        let bits: Vec<Vec<f64>> = (0..6).map(|bit| (0..64_u8).map(|row| f64::from(row >> bit & 1)).collect()).collect();
        let flags: Vec<&[f64]> = bits.iter().map(Vec::as_slice).collect();
        assert!(Kinds::by_flags(&flags, 64, 50).is_none(), "every row is another one");
    }
}
