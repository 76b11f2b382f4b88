//! Where two problem files differ, for messages.

use toml::{Table, Value};

use crate::words::shorten;

/// So many are named.
const NAMED: usize = 3;

/// Keys that no search depends on.
const OUTSIDE: [&str; 3] = ["tune.stop", "tune.polish", "tune.pick"];
/// Tables that only decide what the log is.
const LOG: [&str; 2] = ["data", "simulate"];

/// The keys by which the searches of a saved problem and of the one at hand differ, with both values, as part of a
/// sentence; empty where none is found.
pub(super) fn of_searches(saved: &str, here: &str) -> String {
    said(saved, here, |path| ![&OUTSIDE[..], &LOG].concat().iter().any(|key| path.starts_with(key)))
}

/// The same for the keys that decide which rows are searched on, such as `data.validate`.
pub(super) fn of_logs(saved: &str, here: &str) -> String {
    said(saved, here, |path| LOG.iter().any(|key| path.starts_with(key)))
}

fn said(saved: &str, here: &str, counts: impl Fn(&str) -> bool) -> String {
    let (Ok(saved), Ok(here)) = (saved.parse::<Table>(), here.parse::<Table>()) else { return String::new() };
    let mut found = Vec::new();
    compare("", &saved, &here, &mut found);
    found.retain(|(path, _)| counts(path));
    let more = found.len().saturating_sub(NAMED);
    let mut named: Vec<String> = found.into_iter().take(NAMED).map(|(_, said)| said).collect();
    if more > 0 {
        named.push(format!("and {more} more"));
    }
    named.join(", ")
}

fn compare(path: &str, saved: &Table, here: &Table, found: &mut Vec<(String, String)>) {
    let missing = here.keys().filter(|key| !saved.contains_key(*key));
    for key in saved.keys().chain(missing) {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        match (saved.get(key), here.get(key)) {
            (a, b) if a == b => {}
            (Some(Value::Table(a)), Some(Value::Table(b))) => compare(&path, a, b, found),
            (a, b) => {
                let said = format!("{} is {} there and {} here", shorten(&path), show(a), show(b));
                found.push((path, said));
            }
        }
    }
}

/// A value in a line, cut where it is long.
fn show(value: Option<&Value>) -> String {
    let Some(value) = value else { return "absent".to_owned() };
    shorten(&value.to_string().split_whitespace().collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_the_keys_that_shape_a_search() {
        let saved =
            "[model]\nf = [\"x\"]\n[tune]\nseed = 7\npopulation = 9\nstop = { stall = 3 }\n[parameters]\nr = 1\n";
        let here =
            "[model]\nf = [\"2*x\"]\n[tune]\nseed = 8\nstop = { stall = 9 }\npolish = true\n[parameters]\nr = 1\n";
        let expected = "model.f is [\"x\"] there and [\"2*x\"] here, tune.population is 9 there and absent here, tune.seed \
                        is 7 there and 8 here";
        assert_eq!(of_searches(saved, here), expected);
        assert_eq!(of_searches(saved, &here.replace("r = 1", "r = 2")).matches(" is ").count(), NAMED);
        assert!(of_searches(saved, &here.replace("r = 1", "r = 2")).ends_with(", and 1 more"));
        assert_eq!(of_searches(saved, saved), "");
        assert_eq!(of_searches("data.a = 1", "data.a = 2"), "");
        assert_eq!(of_logs("data.a = 1", "data.a = 2"), "data.a is 1 there and 2 here");
        assert_eq!(of_searches("no = [toml", here), "");
    }
}
