//! What does not fit in memory is told before the work starts.
#![cfg(target_os = "linux")]

use std::process::{Command, Stdio};

use crate::command::{Finished, Folder, LEVEL};

/// The binary with at most so many kilobytes of addresses, as `ulimit -v` sets them.
fn within(kilobytes: u32, folder: &Folder, arguments: &[&str]) -> Finished {
    let mut command = Command::new("sh");
    let script = format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_kfgpu")]).args(arguments);
    // A thread takes 2 MB of stack and 64 MB of addresses for its allocator.
    command.env("RAYON_NUM_THREADS", "2").env("MALLOC_ARENA_MAX", "1");
    command.current_dir(folder.path(".")).stdin(Stdio::null()).output().unwrap().into()
}

#[test]
fn a_simulated_log() {
    let folder = Folder::new();
    let simulated = |steps: u32| LEVEL.replace("file = \"log.csv\"\n", "") + &format!("[simulate]\nsteps = {steps}\n");
    folder.write("big.toml", simulated(100_000_000));
    for verb in ["simulate", "tune", "filter"] {
        let message = within(2_000_000, &folder, &[verb, "big.toml"]).refusal();
        let said = "[simulate] steps = 100000000 takes at least 3.2 GB of memory, and this process may take ";
        assert!(message.starts_with(said), "{verb}: {message}");
        assert!(message.ends_with(" GB more (by ulimit -v): take fewer steps or trajectories"), "{verb}: {message}");
    }
    folder.write("small.toml", simulated(1000));
    within(2_000_000, &folder, &["simulate", "small.toml", "--quiet"]).expect(0);
}

#[test]
fn a_population() {
    let folder = Folder::with_level();
    let tune = |population: &str| {
        ["tune", "problem.toml", "--generations", "1", "--quiet", "--population", population].map(str::to_owned)
    };
    let run = |population: &str| {
        let arguments = tune(population);
        within(1_000_000, &folder, &arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let message = run("16777216").refusal();
    assert!(message.starts_with("a population of 16777216 takes at least 2.1 GB of memory, and"), "{message}");
    assert!(message.ends_with("(by ulimit -v): take a smaller population"), "{message}");
    run("1000").expect(0);
}

#[test]
fn a_smoother() {
    let folder = Folder::with_level();
    let rows: String = (0..1_000_001).map(|k| format!("{k},{}\n", k * 7 % 13)).collect();
    folder.write("log.csv", format!("t,z\n{rows}"));
    let message = within(400_000, &folder, &["filter", "problem.toml", "--smooth", "--out", "s.csv"]).refusal();
    assert!(message.starts_with("smoothing 1000001 rows of 1 state takes at least "), "{message}");
    assert!(message.ends_with(" more (by ulimit -v): leave out --smooth, or take a part of the log"), "{message}");
    assert!(!folder.path("s.csv").exists());
}
