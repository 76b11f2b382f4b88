//! Every mistake in a problem file gets one sentence, its exact position and a caret run.

mod file;
mod filter;
mod formulas;
mod front;
mod parameters;
mod sensors;
mod tune;

use proptest::prelude::*;

use crate::model::{Problem, ProblemError};

/// A sound problem of two states, one measurement and one input; every case below changes one piece of it.
const SOUND: &str = r#"[data]
file = "log.csv"
time = "t"
measurements = ["z"]
inputs = ["u"]
truth = { p = "p_true" }

[model]
state = ["p", "v"]
f = ["p + v*dt + 0.5*u*dt^2", "v + u*dt"]
h = ["p"]
Q = [["q*dt^3/3", "q*dt^2/2"], [0, "q*dt"]]
R = { z = "r" }
x0 = [0, 0]
P0 = [100, 10]
first = "update"

[parameters]
q = { min = 0.01, max = 10, scale = "log", start = 1 }
r = { min = 0.1, max = 100, start = 5 }

[filter]
kind = "kalman"

[tune]
algorithm = "pso"
objectives = ["nll"]
population = 20
"#;

fn error(text: &str) -> ProblemError {
    match Problem::parse(text, "p.toml") {
        Err(error) => error,
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// `old` of the sound problem replaced by `new`: the first line of the error, and the text under the carets.
fn broken(old: &str, new: &str) -> (String, String) {
    assert_eq!(SOUND.matches(old).count(), 1, "`{old}` stands once in the sound problem");
    let error = error(&SOUND.replace(old, new));
    let place = error.place.clone().expect("a place");
    let under = place.excerpt.chars().skip(place.indent).take(place.width).collect();
    (error.to_string().lines().next().unwrap().to_owned(), under)
}

/// A line of the table: what is replaced, by what, the text under the carets, and the whole sentence.
struct Case {
    old: String,
    new: String,
    under: &'static str,
    sentence: &'static str,
}

/// The cases of `cases.txt`, whose first lines say how it is written.
fn cases() -> Vec<Case> {
    let (mut cases, mut under) = (Vec::new(), "");
    let (mut old, mut new) = (Vec::new(), Vec::new());
    let mut begins = true;
    for line in include_str!("cases.txt").lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let rest = line[1..].strip_prefix(' ').unwrap_or(&line[1..]);
        match &line[..1] {
            "-" => {
                if begins {
                    old.clear();
                }
                old.push(rest);
            }
            "+" => new.push(rest),
            "^" => under = rest,
            _ => cases.push(Case {
                old: old.join("\n"),
                new: std::mem::take(&mut new).join("\n"),
                under,
                sentence: line,
            }),
        }
        begins = line.starts_with(|first: char| first.is_ascii_digit());
    }
    cases
}

#[test]
fn every_mistake_is_said_where_it_is() {
    let wrong = cases().into_iter().filter_map(|Case { old, new, under, sentence }| {
        let (said, found) = broken(&old, &new);
        let expected = format!("p.toml:{sentence}");
        (said != expected || found != under).then(|| format!("{new}\n  {said} | {found}\n  {expected} | {under}"))
    });
    let wrong: Vec<String> = wrong.collect();
    assert!(wrong.is_empty(), "change, error, expected:\n{}", wrong.join("\n"));
    assert!(cases().len() >= 115, "the table is read whole: {}", cases().len());
}

#[test]
fn the_sound_problem_is_accepted() {
    Problem::parse(SOUND, "p.toml").unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_change_nothing() {
    let text = format!("\u{feff}{}", SOUND.replace('\n', "\r\n"));
    let problem = Problem::parse(&text, "p.toml").unwrap_or_else(|e| panic!("{e}"));
    assert!(problem.tuned(&[2.0, 3.0]).contains("start = 2.0"), "{}", problem.tuned(&[2.0, 3.0]));
    let error = error(&text.replace("h = [\"p\"]", "h = [\"p + w\"]")).to_string();
    assert!(error.starts_with("p.toml:11:11: ") && !error.contains('\r'), "{error}");
}

#[test]
fn the_whole_message() {
    let text = SOUND.replace("[\"p\"]", "[\"p + w\"]");
    let expected = "\
p.toml:11:11: unknown name `w` (known: `p`, `v`, `q`, `r`, `u`, `pi`)
   |
11 | h = [\"p + w\"]
   |           ^";
    assert_eq!(error(&text).to_string(), expected);
}

proptest! {
    #[test]
    fn no_text_breaks_the_reader(text in any::<String>()) {
        let _ = Problem::parse(&text, "p.toml").map_err(|e| e.to_string());
    }

    #[test]
    fn no_damage_breaks_the_reader(at in 0..SOUND.len(), length in 0..40usize, junk in "[-+*/^()\\[\\]{}\"'=.,0-9a-z \n]{0,8}") {
        let end = (at + length).min(SOUND.len());
        let text = format!("{}{junk}{}", &SOUND[..at], &SOUND[end..]);
        if let Err(error) = Problem::parse(&text, "p.toml") {
            let lines = text.lines().count().max(1);
            prop_assert!(error.place.as_ref().is_some_and(|p| p.line <= lines + 1), "{error}");
        }
    }
}
