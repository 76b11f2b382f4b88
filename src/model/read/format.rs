//! Keys of `[data]` that say how the file writes times, cells and numbers.

use super::node::{Fields, Node};
use crate::data::{Format, TimeUnit};
use crate::model::error::{Fault, nearest};
use crate::words::shorten;

/// Reads `time_unit`; fractions of a second are for numbers of a time column.
pub(super) fn read_time_unit(fields: &Fields<'_>, has_time: bool) -> Result<Option<TimeUnit>, Fault> {
    let Some(node) = fields.get("time_unit") else { return Ok(None) };
    let name = node.string()?;
    let Some((unit, _)) = TimeUnit::ALL.iter().find(|(_, known)| *known == name) else {
        let names = TimeUnit::ALL.map(|(_, name)| name);
        let meant = spelled(name).or_else(|| nearest(name, names));
        let meant = meant.map_or_else(String::new, |name| format!("did you mean \"{name}\"? "));
        let list = names.map(|name| format!("\"{name}\"")).join(", ");
        return Err(node.bad_value(format!("\"{}\"", shorten(name)), format!("a unit of time ({meant}known: {list})")));
    };
    if unit.decimals() > 0 && !has_time {
        let expected =
            "\"s\", \"min\", \"h\", \"day\", \"month\" or \"year\" where no `time` column has numbers to convert";
        return Err(node.bad_value(format!("\"{name}\""), expected));
    }
    Ok(Some(*unit))
}

/// The name of a unit that people write out.
fn spelled(name: &str) -> Option<String> {
    let name = name.to_lowercase();
    let unit = match name.trim_end_matches('s') {
        "sec" | "second" | "" => "s",
        "msec" | "milli" | "millisecond" | "m" => "ms",
        "usec" | "µ" | "μ" | "u" | "micro" | "microsecond" => "us",
        "nsec" | "nano" | "nanosecond" | "n" => "ns",
        "minute" | "min" => "min",
        "hour" | "hr" | "h" => "h",
        "d" | "day" => "day",
        "mon" | "month" => "month",
        "y" | "yr" | "year" | "a" => "year",
        _ => return None,
    };
    Some(unit.to_owned())
}

pub(super) fn read(fields: &Fields<'_>) -> Result<Format, Fault> {
    let format = Format {
        separator: fields.optional("separator", |n| one_of(n, &[',', ';', '\t', ' ']))?,
        decimal_comma: fields.optional("decimal", |n| one_of(n, &['.', ',']))? == Some(','),
        thousands: fields.optional("thousands", |n| one_of(n, &[',', '.', '\'', ' ']))?,
        header_line: fields.optional("header_line", |n| n.integer(1, u64::MAX))?,
        skip_lines: fields.optional("skip_lines", read_lines)?.unwrap_or_default(),
    };
    let decimal = if format.decimal_comma { ',' } else { '.' };
    if let Some(node) = fields.get("thousands").filter(|_| format.thousands == Some(decimal)) {
        return Err(node.bad_value(format!("\"{decimal}\""), "another character than the one before decimals"));
    }
    Ok(format)
}

fn one_of(node: &Node<'_>, known: &[char]) -> Result<char, Fault> {
    let text = node.string()?;
    let mut characters = text.chars();
    match (characters.next(), characters.next()) {
        (Some(c), None) if known.contains(&c) => Ok(c),
        _ => {
            let known: Vec<String> = known.iter().map(|c| format!("\"{}\"", c.escape_debug())).collect();
            Err(node.bad_value(format!("\"{}\"", shorten(text)), known.join(" or ")))
        }
    }
}

/// Lines in rising order.
fn read_lines(node: &Node<'_>) -> Result<Vec<u64>, Fault> {
    let nodes = node.list("a list of line numbers, such as [2]")?;
    let mut lines = nodes.iter().map(|line| line.integer(1, u64::MAX)).collect::<Result<Vec<u64>, Fault>>()?;
    lines.sort_unstable();
    lines.dedup();
    Ok(lines)
}
