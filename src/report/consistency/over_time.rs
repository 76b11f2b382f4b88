//! Whether NIS is the same at all times: its mean may be right because too much here makes up for too little there.

use serde::Serialize;
use statrs::statistics::{Data, OrderStatistics, RankTieBreaker};

use super::band::exceedance;
use super::rows::{RowNis, Sum, number};
use super::{Place, Test, TestKind};
use crate::data::Log;
use crate::report::short;

/// Most blocks of the log.
const BLOCKS: usize = 8;
/// Components of a block on average, at least; of two blocks half as many.
const COMPONENTS: usize = 20;
/// Ratio of the mean NIS of two parts of the log from which the difference matters: a tenth in standard deviation.
const PRACTICAL: f64 = 1.2;
/// Probability of ranks as unequal down to which stretches count as alike.
pub(super) const ALIKE: f64 = 0.01;

/// NIS over blocks of the log, one after the other, of about as many components each.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NisOverTime {
    /// Two, four or eight blocks, in the order of the log; trajectories follow each other.
    pub blocks: Vec<NisSpan>,
    /// The run of blocks that differs most from the rest.
    pub apart: NisSpan,
    /// Mean NIS of that rest.
    pub rest: f64,
    /// Probability of blocks as unequal if the filter is right. Bartlett's test (1937, doi:10.1098/rspa.1937.0109) on the
    /// sums of NIS, which are chi-square: it asks whether they have one scale, whatever that is. Halves are tested beside
    /// the blocks, and it is twice the smaller of the two p-values.
    pub p_value: f64,
    /// The same by the ranks of NIS alone, which no few large values move (Kruskal and Wallis 1952,
    /// doi:10.1080/01621459.1952.10483441). It decides which of two things is said: noise with outliers has sums as unequal
    /// as noise that changes, but even ranks.
    pub ranks_p_value: f64,
    /// Whether `apart` begins with the first block.
    #[serde(skip)]
    leads: bool,
}

/// A stretch of the log with its mean NIS.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NisSpan {
    /// Its first measured row.
    pub from: Place,
    /// Its last.
    pub to: Place,
    /// Present components in it.
    pub components: usize,
    /// Sum of NIS / components.
    pub nis_mean: f64,
}

impl NisOverTime {
    /// Of measured rows in the order of the log; `None` where they are too few to part.
    pub(super) fn of(log: &Log, rows: &[&RowNis]) -> Option<Self> {
        let blocks = parted(rows);
        if blocks.len() < 2 {
            return None;
        }
        let sums: Vec<Sum> = blocks.iter().map(|block| Sum::of(block.iter().copied())).collect();
        let p_value = match sums.len() {
            2 => bartlett(&sums),
            all => (2.0 * bartlett(&sums).min(bartlett(&[added(&sums[..all / 2]), added(&sums[all / 2..])]))).min(1.0),
        };
        let (from, to) = most_different(&sums);
        let ranks_p_value = by_ranks(&blocks);
        let span = |from: usize, to: usize| -> Option<NisSpan> {
            let (first, last) = (blocks[from].first()?, blocks[to - 1].last()?);
            let sum = added(&sums[from..to]);
            let place = |row: &RowNis| Place::of(log, row.trajectory, row.row);
            Some(NisSpan { from: place(first), to: place(last), components: sum.count, nis_mean: sum.mean() })
        };
        let rest = added(&[added(&sums[..from]), added(&sums[to..])]).mean();
        let blocks = (0..sums.len()).filter_map(|i| span(i, i + 1)).collect();
        Some(Self { blocks, apart: span(from, to)?, rest, p_value, ranks_p_value, leads: from == 0 })
    }

    /// Whether NIS is as large here as there but for a few rows.
    pub(super) fn is_alike(&self) -> bool {
        self.ranks_p_value > ALIKE
    }

    /// How many times as large NIS is in one part as in the other.
    fn ratio(&self) -> f64 {
        let (a, b) = (self.apart.nis_mean, self.rest);
        a.max(b) / a.min(b)
    }

    pub(super) fn test(&self) -> Test {
        let measured = ("ratio of NIS of two parts of the log", self.ratio());
        Test::of(TestKind::NisOverTime, measured, self.p_value, (self.ratio() >= PRACTICAL, "below 1.2"))
    }

    /// Where NIS is what, such as "NIS is 0.57 from time 1871 to 1915 and 1.42 after".
    pub(super) fn sentence(&self) -> String {
        let [apart, rest] = [self.apart.nis_mean, self.rest].map(|mean| short(mean, 3));
        let elsewhere = if self.leads { "after" } else { "elsewhere" };
        format!(
            "NIS is {apart} from time {} to {} and {rest} {elsewhere}",
            self.apart.from.moment(),
            self.apart.to.moment()
        )
    }
}

/// Blocks of about as many components each.
fn parted<'a, 'b>(rows: &'b [&'a RowNis]) -> Vec<&'b [&'a RowNis]> {
    let components = Sum::of(rows.iter().copied()).count;
    let blocks = [8, 4].into_iter().find(|blocks| components >= blocks * COMPONENTS).unwrap_or(2).min(BLOCKS);
    if components < COMPONENTS {
        return Vec::new();
    }
    let (mut parts, mut start, mut passed) = (Vec::with_capacity(blocks), 0, 0);
    for (i, row) in rows.iter().enumerate() {
        passed += row.components as usize;
        if passed * blocks >= components * (parts.len() + 1) {
            parts.push(&rows[start..=i]);
            start = i + 1;
        }
    }
    parts
}

fn added(sums: &[Sum]) -> Sum {
    let add = |a: Sum, b: &Sum| Sum { total: a.total + b.total, count: a.count + b.count };
    sums.iter().fold(Sum::default(), add)
}

/// sum of d ln(mean of all / mean): twice the log of the likelihood ratio of many scales against one.
fn log_ratio(sums: &[Sum]) -> f64 {
    let all = added(sums).mean();
    sums.iter().map(|sum| number(sum.count) * (all / sum.mean()).ln()).sum()
}

/// Probability of sums as unequal, with Bartlett's correction for small ones.
fn bartlett(sums: &[Sum]) -> f64 {
    let inverse = |count: usize| 1.0 / number(count);
    let degrees = number(sums.len() - 1);
    let spread = sums.iter().map(|sum| inverse(sum.count)).sum::<f64>() - inverse(added(sums).count);
    exceedance(log_ratio(sums) / (1.0 + spread / (3.0 * degrees)), degrees)
}

/// The test of Kruskal and Wallis on the probabilities of NIS given their numbers of components. 1 without rows.
pub(super) fn by_ranks(groups: &[&[&RowNis]]) -> f64 {
    let unlikely = |row: &&RowNis| exceedance(row.nis, f64::from(row.components));
    let all: Vec<f64> = groups.iter().flat_map(|group| group.iter().map(unlikely)).collect();
    if all.iter().any(|p| p.is_nan()) {
        return f64::NAN;
    }
    let n = number(all.len());
    let ranks = Data::new(all).ranks(RankTieBreaker::Average);
    let mut rest = ranks.as_slice();
    let mut sum = 0.0;
    for group in groups.iter().filter(|group| !group.is_empty()) {
        let (own, others) = rest.split_at(group.len());
        rest = others;
        sum += own.iter().sum::<f64>().powi(2) / number(own.len());
    }
    let degrees = number(groups.len().max(2) - 1);
    if n < 2.0 { 1.0 } else { exceedance(12.0 / (n * (n + 1.0)) * sum - 3.0 * (n + 1.0), degrees) }
}

/// The run of blocks, `from..to`, whose mean differs most from that of the others.
fn most_different(sums: &[Sum]) -> (usize, usize) {
    let n = sums.len();
    // A run at the end is the rest of one at the beginning.
    let runs = (0..n).flat_map(|from| (from + 1..=n).map(move |to| (from, to))).filter(|(_, to)| *to < n);
    let ratio = |(from, to): (usize, usize)| {
        let rest = added(&[added(&sums[..from]), added(&sums[to..])]);
        log_ratio(&[added(&sums[from..to]), rest])
    };
    runs.max_by(|a, b| ratio(*a).total_cmp(&ratio(*b))).unwrap_or((0, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(nis: &[f64]) -> Vec<RowNis> {
        let row = |(row, nis): (usize, &f64)| RowNis { trajectory: 0, row, nis: *nis, components: 1, number: row + 1 };
        nis.iter().enumerate().map(row).collect()
    }

    /// scipy 1.17: `scipy.stats.kruskal([2.9, 3.0, 2.5, 2.6, 3.2], [3.8, 2.7, 4.0, 2.4], [2.8, 3.4, 3.7, 2.2, 2.01])` is
    /// 0.771429 with p = 0.679965; without ties it corrects nothing.
    #[test]
    fn ranks_as_scipy_has_them() {
        let rows = rows(&[2.9, 3.0, 2.5, 2.6, 3.2, 3.8, 2.7, 4.0, 2.4, 2.8, 3.4, 3.7, 2.2, 2.01]);
        let all: Vec<&RowNis> = rows.iter().collect();
        let p = by_ranks(&[&all[..5], &all[5..9], &all[9..]]);
        assert!((p - 0.679_965).abs() < 1e-6, "{p}");
    }

    #[test]
    fn a_large_value_is_one_rank() {
        let mut rows = rows(&[1.0; 40]);
        rows[3].nis = 1e6;
        let all: Vec<&RowNis> = rows.iter().collect();
        let p = by_ranks(&[&all[..20], &all[20..]]);
        assert!(p > 0.3, "{p}");
        rows[..20].iter_mut().for_each(|row| row.nis = 0.1);
        let all: Vec<&RowNis> = rows.iter().collect();
        assert!(by_ranks(&[&all[..20], &all[20..]]) < 1e-6);
    }
}
