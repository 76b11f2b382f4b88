//! The mean NIS, of the whole log and of its first rows.

use super::band::{Band, f_exceedance, two_sided};
use super::rows::{SETTLING, Sum, number};
use super::{Test, TestKind};

/// Fewest components after the first rows that tell what these should be like.
const SETTLED: usize = 20;

/// Whether the mean NIS is 1; the sum is chi-square with as many degrees of freedom as components. `None` without any.
pub(super) fn test(nis: Sum) -> Option<Test> {
    tested(TestKind::MeanNis, "mean NIS", nis)
}

/// The same of the first measured rows, where there are rows after them.
pub(super) fn start_test(first: Sum, settled: Sum) -> Option<Test> {
    let name = format!("mean NIS of the first {SETTLING} measured rows");
    if settled.count < SETTLED { None } else { tested(TestKind::FirstRows, &name, first) }
}

/// Whether the first rows differ from those that follow, by an F test at 5 %: if not, what is wrong with them is not the
/// start. It decides which of two things is said, not whether anything is.
pub(super) fn differ(first: Sum, next: Sum) -> bool {
    let above = f_exceedance(first.mean() / next.mean(), [number(first.count), number(next.count)]);
    above.min(1.0 - above) < 0.025
}

fn tested(kind: TestKind, name: &str, nis: Sum) -> Option<Test> {
    if nis.count == 0 {
        return None;
    }
    let degrees = number(nis.count);
    let p_value = two_sided(nis.total, degrees);
    let Band { mean, low, high } = Band::outside(nis.total, degrees, kind.level());
    let test = Test::of(kind, (name, mean), p_value, (true, ""));
    Some(Test { required: format!("{low:.3}..{high:.3}"), ..test })
}
