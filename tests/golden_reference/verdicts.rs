//! What is said of filters that are wrong in ways that leave the mean NIS right.

use kfgpu::data::Log;
use kfgpu::model::Problem;
use kfgpu::reference::run;
use kfgpu::report::{Consistency, TestKind, Verdict};
use kfgpu::simulate::simulate;

const LEVEL: &str = "[data]\nmeasurements = [\"z\"]\n[model]\nstate = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\nQ = [Q_]\nR = [R_]\nx0 = [0]\nP0 = [P0_]\n\
    [tune]\nobjectives = [\"nll\"]\n[simulate]\ndt = 1\nsteps = STEPS\n";

/// A level filter; also the model that its logs are drawn from.
fn level(q: f64, r: f64, p0: f64, steps: usize) -> Problem {
    let text = [("Q_", q), ("R_", r), ("P0_", p0)]
        .iter()
        .fold(LEVEL.replace("STEPS", &steps.to_string()), |text, (key, value)| {
            text.replace(key, &format!("{value:?}"))
        });
    Problem::parse(&text, "level.toml").expect("valid")
}

/// A log of the right filter (q = 0.09, r = 1), with each measurement changed.
fn drawn(steps: usize, seed: u64, change: impl Fn(usize, f64) -> f64) -> Log {
    let mut log = simulate(&level(0.09, 1.0, 1.0, steps), Some(seed)).expect("drawn");
    let trajectory = &mut log.trajectories[0];
    let mut z = kfgpu::data::Table::new(1);
    (0..trajectory.len()).for_each(|k| z.push(&[change(k, trajectory.z.row(k)[0])]));
    trajectory.z = z;
    log
}

fn judged(problem: &Problem, log: &Log) -> Consistency {
    Consistency::of(problem, log, &[], &run(problem, log, &[]).expect("runs"))
}

/// The filter (q, r), its noise scaled so that its mean NIS is 1: what tuning does to one of a wrong shape.
fn scaled(q: f64, r: f64, log: &Log, steps: usize) -> Consistency {
    let nis = judged(&level(q, r, r, steps), log).nis_mean;
    let found = judged(&level(q * nis, r * nis, r * nis, steps), log);
    assert!((found.nis_mean - 1.0).abs() < 1e-9, "the mean is right: {found}");
    found
}

fn advice(found: &Consistency, verdict: Verdict) -> &str {
    let finding = found.findings.iter().find(|finding| finding.verdict == verdict);
    &finding.unwrap_or_else(|| panic!("no {verdict}: {found}")).advice
}

#[test]
fn one_glitch_is_named_with_its_line() {
    for (size, steps) in [(500.0, 1999), (50.0, 1999), (20.0, 499)] {
        for seed in 0..5 {
            let log = drawn(steps, seed, |k, z| if k == 300 { z + size } else { z });
            let found = scaled(0.09, 1.0, &log, steps);
            assert_eq!(found.verdict, Verdict::Outliers, "{size}: {found}");
            assert_eq!(
                (found.dominating_rows[0].place.row, found.dominating_rows[0].place.line),
                (300, 302),
                "{found}"
            );
            let said = advice(&found, Verdict::Outliers);
            assert!(said.contains("line 302 (row 300, time 300)") && said.contains("% of the sum of NIS"), "{said}");
            assert!(found.dominating_rows.iter().all(|row| row.p_value < 0.003 && row.share >= 0.01), "{found}");
        }
    }
}

/// Too little in one half and too much in the other: cases of a changing noise have a mean NIS of 1 all the same.
#[test]
fn noise_that_changes_is_named_with_its_time() {
    let mut halves = 0;
    for seed in 0..10 {
        let log = drawn(999, seed, |k, z| if k < 500 { z } else { 2.0 * z });
        let found = scaled(0.09, 1.0, &log, 999);
        let said = advice(&found, Verdict::ChangesWithTime);
        halves += usize::from(said.starts_with("NIS is 0.") && said.contains("from time 0 to 499 and 1."));
        let over_time = found.nis_over_time.as_ref().expect("rows enough");
        assert!(over_time.p_value < 1e-6 && over_time.blocks.len() == 8, "{over_time:?}");
    }
    assert!(halves >= 7, "{halves} of 10 name the halves; the others leave out first rows that are unlike the next");
    // A quarter in the middle.
    let log = drawn(999, 3, |k, z| if (375..625).contains(&k) { 3.0 * z } else { z });
    let found = scaled(0.09, 1.0, &log, 999);
    let said = advice(&found, Verdict::ChangesWithTime);
    assert!(said.contains("to 624 and 0.") && said.contains("elsewhere"), "{said}");
}

/// One row in twenty with ten times the noise: sums of NIS are as uneven as where noise changes, but not its ranks.
#[test]
fn outliers_all_along_are_no_change_and_no_start() {
    for seed in 0..20 {
        let log = drawn(999, seed, |k, z| if k * 7919 % 20 == 3 { 6.0 * z } else { z });
        let found = scaled(0.09, 2.5, &log, 999);
        let over_time = found.nis_over_time.as_ref().expect("rows enough");
        let said: Vec<Verdict> = found.findings.iter().map(|finding| finding.verdict).collect();
        let course = [Verdict::ChangesWithTime, Verdict::WrongStart].iter().any(|verdict| said.contains(verdict));
        assert_eq!(course, over_time.ranks_p_value <= 0.01, "seed {seed}: {over_time:?}\n{found}");
    }
}

/// 2.9 in the first rows and too little after them.
#[test]
fn a_start_that_cancels_the_rest_is_named() {
    // x0 is 30 off, which P0 does not allow for, and R is twice what it should be.
    let log = drawn(299, 1, |_, z| z + 18.0);
    let found = judged(&level(0.16, 1.8, 1.0, 299), &log);
    let first = found.tests.iter().find(|test| test.kind == TestKind::FirstRows).expect("tested");
    assert!(!first.pass && first.measured > 2.0 && found.judged_after == 20, "{found}");
    assert_eq!(found.verdict, Verdict::Underconfident, "the rest is worse: {found}");
    assert!(advice(&found, Verdict::Underconfident).contains("after the first 20 measured rows"), "{found}");
    assert!(!advice(&found, Verdict::WrongStart).contains("Q and R fit"), "{found}");
    // The right noise with that start: nothing but the start is to blame, and its transient is no correlation. (Of ten right
    // filters some other test accuses at most two.)
    let right = (0..10).map(|seed| judged(&level(0.09, 1.0, 1.0, 299), &drawn(299, seed, |_, z| z + 18.0)));
    let (mut alone, mut white) = (0, 0);
    for found in right {
        let said = advice(&found, Verdict::WrongStart);
        assert!(said.contains("P0 is too small for this x0"), "{found}");
        assert_eq!(found.whiteness[0].count, 280, "{found}");
        alone += usize::from(found.findings.len() == 1 && said.contains(", and Q and R fit"));
        white += usize::from(!found.whiteness[0].correlated);
    }
    assert!(alone >= 8 && white >= 9, "{alone} of 10 blame the start alone, {white} are white");
}

/// Rows too small in one half are not the start's fault, though the first are too small.
#[test]
fn a_quiet_beginning_is_no_wrong_start() {
    let blamed = |seed| {
        let log = drawn(199, seed, |k, z| if k < 100 { z } else { 2.5 * z });
        scaled(0.09, 1.0, &log, 199).findings.iter().any(|finding| finding.verdict == Verdict::WrongStart)
    };
    let blamed = (0..20).filter(|seed| blamed(*seed)).count();
    assert!(blamed <= 4, "{blamed} of 20 blame the start, where 5 % may");
}

/// One value in twenty ten times as noisy: tails. Values between two bounds: none.
#[test]
fn both_sides_of_the_tail_count() {
    let heavy = drawn(1999, 2, |k, z| if k % 20 == 7 { z + if k % 40 == 7 { 9.0 } else { -9.0 } } else { z });
    let found = scaled(0.09, 1.0, &heavy, 1999);
    let tails = found.tests.iter().find(|test| test.kind == TestKind::Tails).expect("tested");
    assert!(!tails.pass && advice(&found, Verdict::HeavyTails).contains("99 % quantile"), "{found}");
    // A square wave of noise: every innovation has nearly the same size.
    let log = drawn(1999, 2, |k, z| if (k * 7919) % 13 < 6 { 3.0 + 0.01 * z } else { -3.0 + 0.01 * z });
    let found = scaled(1e-6, 1.0, &log, 1999);
    assert!(advice(&found, Verdict::LightTails).contains("95 % quantile"), "{found}");
    assert!(found.tests.iter().any(|test| test.kind == TestKind::NisDistribution && !test.pass), "{found}");
}

/// A weak correlation is called one, a strong one accuses the model.
#[test]
fn the_words_for_a_correlation_go_with_its_strength() {
    let sine = drawn(999, 1, |k, z| z + 5.0 * (k as f64 / 5.0).sin());
    let found = scaled(0.09, 1.0, &sine, 999);
    assert!(
        advice(&found, Verdict::InnovationsCorrelated).contains("the model, not only the noise, is wrong"),
        "{found}"
    );
    let weak = (0..200).map(|seed| drawn(199, seed, |_, z| z)).map(|log| judged(&level(0.09, 1.0, 1.0, 199), &log));
    let weak: Vec<Consistency> = weak.filter(|found| found.whiteness[0].correlated).collect();
    println!("{} of 200", weak.len());
    assert!(!weak.is_empty(), "some right filter is accused");
    for found in weak {
        let said = advice(&found, Verdict::InnovationsCorrelated);
        assert!(said.contains("a weak sign, as one right filter in ") && !said.contains("is wrong"), "{said}");
    }
}
