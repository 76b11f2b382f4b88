//! Where the machines part, in sentences.

use super::machines::{Machine, Machines};
use crate::evaluate::probe::{Parting, Probe, Source};
use crate::number::significant;

/// One a comparison.
pub(super) fn of(machines: &Machines, row: usize) -> String {
    let Machines { probe, lanes, adapter } = machines;
    let mut text = String::new();
    if let Some(in_f64) = machines.in_f64() {
        text += &parting(probe, row, lanes, (&in_f64, "the same tape in f64"));
    }
    if let Some(adapter) = adapter {
        text += &wrong(probe, adapter);
        text += &parting(probe, row, adapter, (lanes, &format!("the {}", lanes.name)));
    }
    text
}

/// Which operation an adapter computes wrongly, if one.
fn wrong(probe: &Probe, adapter: &Machine) -> String {
    let Some((operation, share)) = probe.wrong(&adapter.seen) else { return String::new() };
    let line = &probe.program().lines(probe.step().0)[operation];
    let share = significant(share, 2);
    format!(
        "The {} gets `{line}` wrong, by {share} of its largest term: its operands, as it has them, give another result.\n",
        adapter.name
    )
}

/// Where one run parts from another.
fn parting(probe: &Probe, row: usize, found: &Machine, (expected, said): (&Machine, &str)) -> String {
    let (name, bound) = (&found.name, significant(probe.bound(), 2));
    let part = if name.ends_with('s') { "part" } else { "parts" };
    let Some(Parting { operation, share, source }) = probe.parting(&found.seen, &expected.seen) else {
        let most = probe.shares(&found.seen, &expected.seen).into_iter().flatten().fold(0.0, f64::max);
        let most = significant(most, 2);
        return format!("The {name} {part} from {said} in no operation: {most} at most, below {bound}.\n");
    };
    let lines = probe.program().lines(probe.step().0);
    let (line, share) = (&lines[operation], significant(share, 2));
    let first = format!("The {name} {part} from {said} first in `{line}`, by {share} (above {bound})");
    match source {
        Source::Own => format!("{first}: its operands do not.\n"),
        Source::Cancelled { operation, left } => {
            let (line, left) = (&lines[operation], significant(left, 2));
            format!("{first}, because the terms of `{line}` cancel to {left} of the largest.\n")
        }
        Source::Before { register, share } => {
            let names = probe.program().register_names();
            let (name, share) = (&names[register], significant(share, 2));
            let remedy = row.checked_sub(1).map_or_else(String::new, |row| format!("; look at --row {row}"));
            format!("{first}, because `{name}` is off by {share} before the row{remedy}.\n")
        }
    }
}
