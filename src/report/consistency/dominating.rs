//! Rows that carry the sum of NIS: what a single wrong value does to a filter, however the noise was tuned around it.

use serde::Serialize;

use super::band::f_exceedance;
use super::rows::{RowNis, Sum, number};
use super::{Place, Test, TestKind};
use crate::data::Log;

/// Most rows that are named.
const NAMED: usize = 20;
/// Share of the sum of NIS from which a row matters.
const PRACTICAL: f64 = 0.01;

/// A row whose NIS is too large beside that of the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DominatingRow {
    /// Where it is.
    #[serde(flatten)]
    pub place: Place,
    /// Its NIS.
    pub nis: f64,
    /// Its share of the sum of NIS.
    pub share: f64,
    /// Probability that the largest of all rows is as large beside the others if the filter is right.
    pub p_value: f64,
}

/// At most [`NAMED`] of them, the largest first, and the test; no test of fewer than three rows.
///
/// The NIS of a row with c components, over c, beside the mean NIS of the others is F-distributed with c and their
/// degrees of freedom, whatever the scale of the noise; the largest of n rows has n times that tail (Bonferroni). A row
/// that is found is left out before the next is looked at.
pub(super) fn rows(log: &Log, rows: &[&RowNis]) -> (Vec<DominatingRow>, Option<Test>) {
    let all = Sum::of(rows.iter().copied());
    let (mut found, mut others, mut left) = (Vec::new(), all, rows.len());
    let level = TestKind::DominatingRows.level();
    let mut test = None;
    for row in largest(rows, all.mean()) {
        if left < 3 {
            break;
        }
        let components = row.components as usize;
        others = Sum { total: others.total - row.nis, count: others.count - components };
        let p_value = (number(left) * tail(row, others)).min(1.0);
        let share = row.nis / all.total;
        test.get_or_insert_with(|| {
            let measured = ("largest share of one row in the sum of NIS", share);
            Test::of(TestKind::DominatingRows, measured, p_value, (share >= PRACTICAL, "below 0.01"))
        });
        if !(p_value < level && share >= PRACTICAL) || found.len() == NAMED {
            break;
        }
        found.push(DominatingRow { place: Place::of(log, row.trajectory, row.row), nis: row.nis, share, p_value });
        left -= 1;
    }
    (found, test)
}

/// Probability of a NIS as large as this row's beside that of the others.
fn tail(row: &RowNis, others: Sum) -> f64 {
    let components = f64::from(row.components);
    // What rounding leaves of the others is nothing beside it.
    if others.total <= 0.0 {
        return if row.nis > 0.0 { 0.0 } else { 1.0 };
    }
    f_exceedance(row.nis / components / others.mean(), [components, number(others.count)])
}

/// The rows of largest NIS for their components, by the cube root that makes chi-square nearly normal (Wilson and
/// Hilferty 1931, doi:10.1073/pnas.17.12.684), `scale` being the mean NIS.
fn largest<'a>(rows: &[&'a RowNis], scale: f64) -> Vec<&'a RowNis> {
    let key = |row: &RowNis| {
        let spread = 2.0 / (9.0 * f64::from(row.components));
        ((row.nis / scale / f64::from(row.components)).cbrt() - 1.0 + spread) / spread.sqrt()
    };
    let mut rows: Vec<(f64, &RowNis)> = rows.iter().map(|row| (key(row), *row)).collect();
    let kept = (NAMED + 1).min(rows.len());
    if kept < rows.len() {
        rows.select_nth_unstable_by(kept, |a, b| b.0.total_cmp(&a.0));
    }
    rows.truncate(kept);
    // Equal ones stay in the order of the log.
    rows.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1.trajectory, a.1.row).cmp(&(b.1.trajectory, b.1.row))));
    rows.into_iter().map(|(_, row)| row).collect()
}
