//! How often the verdict accuses a filter that is right.

use std::collections::BTreeMap;

use kfgpu::data::simulate;
use kfgpu::model::Problem;
use kfgpu::reference::run;
use kfgpu::report::Consistency;
use rayon::prelude::*;

/// Logs of each kind.
const LOGS: u64 = 200;

const LEVEL: &str = r#"
[data]
measurements = ["z"]
[model]
state = ["level"]
f = ["level"]
h = ["level"]
Q = [0.1]
R = [1.0]
x0 = [0.0]
P0 = [1.0]
[tune]
objectives = ["nll"]
[simulate]
dt = 1
"#;

const TRACK: &str = r#"
[data]
measurements = ["gps", "odometer"]
[model]
state = ["p", "v"]
f = ["p + dt * v", "v"]
h = ["p", "v"]
Q = [0.01, 0.04]
R = [4.0, 0.25]
x0 = [0.0, 1.0]
P0 = [4.0, 1.0]
[tune]
objectives = ["nll"]
[simulate]
dt = 1
missing = 0.2
"#;

/// Verdicts on the right filter over logs of so many steps, and how many more a Ljung-Box test at 5 % would accuse.
fn verdicts(text: &str, steps: usize) -> (BTreeMap<String, usize>, usize) {
    let text = format!("{text}steps = {steps}\n");
    let problem = Problem::parse(&text, "right.toml").expect("the problem is valid");
    let one = |seed| {
        let log = simulate(&problem, Some(seed)).expect("drawn");
        let run = run(&problem, &log, &[]).expect("the filter runs");
        let found = Consistency::of(&problem, &log, &[], &run);
        let m = found.whiteness.len() as f64;
        let at_five =
            found.whiteness.iter().any(|w| w.p_value < 0.05 / m && w.autocorrelation.iter().any(|r| r.abs() >= 0.1));
        (found.verdict.to_string(), at_five && found.is_consistent())
    };
    let all: Vec<(String, bool)> = (0..LOGS).into_par_iter().map(one).collect();
    let stricter = all.iter().filter(|(_, more)| *more).count();
    let counts = all.into_iter().fold(BTreeMap::new(), |mut counts, (verdict, _)| {
        *counts.entry(verdict).or_default() += 1;
        counts
    });
    (counts, stricter)
}

/// Each of three tests may be wrong: the band of NIS in 5 % of logs, whiteness in 1 %, tails in at most 2.5 %.
#[test]
fn right_filters_are_seldom_accused() {
    let cases = [(LEVEL, 60), (LEVEL, 100), (LEVEL, 300), (LEVEL, 1000), (TRACK, 100), (TRACK, 300)];
    let (mut accused, mut stricter) = (0, 0);
    for (text, steps) in cases {
        let (verdicts, more) = verdicts(text, steps);
        println!("{steps} steps: {verdicts:?}, and {more} more with whiteness at 5 %");
        let wrong: usize =
            verdicts.iter().filter(|(verdict, _)| *verdict != "consistent").map(|(_, count)| count).sum();
        assert!(wrong <= 30, "{wrong} of {LOGS} right filters over {steps} steps are accused: {verdicts:?}");
        accused += wrong;
        stricter += more;
    }
    let all = 6 * LOGS;
    println!("{accused} of {all} right filters are accused, {} with whiteness at 5 %", accused + stricter);
    assert!(
        (36..=120).contains(&accused),
        "{accused} of {all}: one in ten at most, and no fewer than the tests promise"
    );
}
