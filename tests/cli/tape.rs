//! `kfgpu tape`: the program, and one row of it on every machine.

use crate::command::{Finished, Folder, LEVEL};
use crate::gpu::adapter;

#[test]
fn the_tape_and_its_counts() {
    let tape = Folder::with_level().run(&["tape", "problem.toml", "--quiet"]).expect(0).stdout;
    let head = tape.lines().next().unwrap();
    // Measurements change from row to row, dt does not. Carried are x, P, and of nll a sum and a product.
    assert_eq!(head, "# 60 rows, 1 columns a row, 2 searched parameters, 4 carried, 2 invariants");
    let mut step = tape.lines().skip_while(|line| !line.starts_with("# step, once a row: "));
    // nu = z - x, S = P + R, 1 / S, K = P / S, x + K nu, R / S, P R / S + Q, nu^2, a sum of nu^2 / S, a product of S.
    let counts = "13 flops (1 divisions), 1 comparisons and functions, 0 copies; 10 operations";
    assert!(step.next().unwrap().contains(counts), "{tape}");
    assert_eq!(step.take_while(|line| line.starts_with("    ")).count(), 10, "{tape}");
}

/// Runs the row of an example.
fn row(example: &str, arguments: &[&str]) -> Finished {
    let path = format!("{}/examples/{example}.toml", env!("CARGO_MANIFEST_DIR"));
    Folder::new().run(&[&["tape", &path], arguments].concat())
}

/// The lines of the two tables without their heads, and the sentences.
fn parts(text: &str) -> (Vec<&str>, Vec<&str>, Vec<&str>) {
    let (state, step) = text.split_once("\n# the step of the row in ").unwrap();
    let lines = |text| str::lines(text).skip(2).filter(|line| line.starts_with("  ")).collect();
    let sentences = step.lines().filter(|line| line.starts_with("The ")).collect();
    (lines(state), lines(step), sentences)
}

/// The columns `off` of a line that begins with so many words.
fn offs(line: &str, words: usize) -> Vec<f64> {
    let cells: Vec<f64> = line.split_whitespace().skip(words).map(|cell| cell.parse().unwrap()).collect();
    cells.chunks_exact(2).map(|pair| pair[1]).collect()
}

#[test]
fn a_row_is_that_of_the_reference_and_parts_nowhere() {
    for (example, entries) in [("nile", 2), ("rocket", 9), ("uav_gps_cv", 27)] {
        let found = row(example, &["--row", "17"]).expect(0);
        let (state, step, sentences) = parts(&found.stdout);
        assert_eq!(state.len(), entries, "{}", found.stdout);
        for line in state {
            // Entry and reference, then a value and how far it is off for f64 and f32.
            let off = offs(line, 2);
            assert!(off[0] < 1e-10 && off[1] < 1e-5, "{example}: {line}");
        }
        assert_eq!(sentences.len(), 1 + usize::from(!found.stderr.contains("no column for a GPU")), "{sentences:?}");
        assert!(sentences.iter().all(|s| s.contains("in no operation")), "{sentences:?}");
        let program = row(example, &["--precision", "f32"]).expect(0).stdout;
        let listed = step.iter().filter(|line| {
            let operation = line.trim_start().split("  ").next().unwrap();
            program.lines().any(|known| known.trim() == operation)
        });
        assert_eq!(listed.count(), step.len(), "operations stand as in the program: {step:?}");
        assert!(found.stdout.contains(&format!("in f32: {} operations", step.len())), "{}", found.stdout);
    }
}

#[test]
fn the_candidate_and_the_precision_are_those_asked_for() {
    let folder = Folder::with_level();
    let run = |more: &[&str]| folder.run(&[&["tape", "problem.toml", "--row", "5"], more].concat()).expect(0).stdout;
    let prior = |text: &str| parts(text).0[1].split_whitespace().nth(1).unwrap().parse::<f64>().unwrap();
    // P of the prior is more for a larger q, and named values are not the starts.
    let (start, wide) = (prior(&run(&[])), prior(&run(&["--candidate", "q=9"])));
    assert!(wide > start + 8.0, "{start}, {wide}");
    assert_eq!(prior(&run(&["--candidate", "q=1,r=50"])), start);
    let double = run(&["--precision", "f64"]);
    assert!(double.contains("the step of the row in f64: 10 operations") && !double.contains("f32"), "{double}");
}

#[test]
fn what_is_no_row_or_candidate_is_refused() {
    let folder = Folder::with_level();
    for (arguments, expected) in [
        (&["--row", "60"][..], "--row is 60, but log.csv has 60 rows: expected 0 to 59"),
        (&["--row", "1", "--candidate", "w=1"], "--candidate names `w`, expected one of the searched parameters: q, r"),
        (&["--row", "1", "--candidate", "q"], "--candidate has `q`, expected NAME=VALUE"),
        (&["--row", "1", "--candidate", "q=x"], "--candidate has `q=x`, expected a finite number"),
        (&["--row", "1", "--candidate", "q=inf"], "--candidate has `q=inf`, expected a finite number"),
        (&["--row", "1", "--trajectory", "7"], "log.csv has no trajectory column (leave it out)"),
    ] {
        let message = folder.run(&[&["tape", "problem.toml"], arguments].concat()).refusal();
        assert!(message.contains(expected), "{message}");
    }
    let message = folder.run(&["tape", "problem.toml", "--candidate", "q=1"]).expect(2).stderr;
    assert!(message.contains("--row <K>"), "{message}");
}

/// Rows count from the first of their trajectory in the log, whichever the filter begins with.
#[test]
fn rows_are_those_of_their_trajectory() {
    let folder = Folder::new();
    let from_measurement =
        LEVEL.replace("x0 = [0]", "x0 = \"measurement\"").replace("time =", "trajectory = \"id\"\ntime =");
    folder.write("problem.toml", from_measurement);
    let row = |(id, k): (&str, u32)| {
        let z = if (id, k) == ("b", 0) { String::new() } else { format!("{}", k * k % 7) };
        format!("{id},{k},{z}\n")
    };
    let rows = (0..9).map(|k| ("a", k)).chain((0..6).map(|k| ("b", k)));
    folder.write("log.csv", "id,t,z\n".to_owned() + &rows.map(row).collect::<String>());
    let run = |more: &[&str]| folder.run(&[&["tape", "problem.toml", "--row"], more].concat());
    for (arguments, place) in
        [(&["8"][..], "row 8 (line 10, time 8)"), (&["3", "--trajectory", "b"], "row 3 (line 14, time 3)")]
    {
        let text = run(arguments).expect(0).stdout;
        assert!(text.starts_with(&format!("# prior of {place};")), "{text}");
        for line in parts(&text).0 {
            let off = offs(line, 2);
            assert!(off[0] < 1e-12 && off[1] < 1e-6, "{line}");
        }
    }
    let message = run(&["0", "--trajectory", "b"]).refusal();
    assert!(message.contains("the first complete measurement of trajectory `b`: expected 1 to 5"), "{message}");
    let message = run(&["6", "--trajectory", "b"]).refusal();
    assert!(message.contains("trajectory `b` has 6 rows: expected 0 to 5"), "{message}");
    let message = run(&["6", "--trajectory", "c"]).refusal();
    assert!(message.contains("--trajectory is `c`, expected one of those of log.csv: a, b"), "{message}");
}

#[cfg(feature = "gpu")]
#[test]
fn an_adapter_stands_beside_the_lanes() {
    let Some(name) = adapter(&Folder::new()) else { return };
    for (example, row_at) in [("nile", "40"), ("rocket", "63"), ("rocket_sage_husa", "33"), ("tum_fr2_desk", "1500")] {
        let found = row(example, &["--row", row_at, "--adapter", &name]).expect(0);
        assert!(found.stderr.contains(&format!("adapter: {name}, in f32")), "{}", found.stderr);
        let (state, step, sentences) = parts(&found.stdout);
        for line in state {
            let off = offs(line, 2);
            assert!(off[1] < 1e-4 && off[2] < 1e-4, "{example}: {line}");
        }
        assert!(!step.is_empty() && sentences.len() == 2, "{}", found.stdout);
        assert!(sentences[1].starts_with("The adapter parts from the f32 lanes in no operation: "), "{sentences:?}");
    }
    let message = row("nile", &["--row", "3", "--adapter", "no such adapter"]).refusal();
    assert!(message.contains("no adapter is called `no such adapter`"), "{message}");
}
