//! Signals: the first ends a study with the best so far, the second ends the process.

use std::process::{Child, Command};
use std::time::{Duration, Instant};

use crate::command::{Finished, Folder, RUN_FILES, level_log};

/// As a shell, a scheduler or a container sends it.
fn send(signal: &str, process: &Child) {
    let id = process.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status().unwrap();
    assert!(sent.success(), "kill {signal} {id}");
}

/// Waits for something that a child does, which it must do in two minutes.
fn wait(what: &str, child: &mut Child, done: impl Fn() -> bool) {
    let begin = Instant::now();
    while !done() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before {what}");
        assert!(begin.elapsed() < Duration::from_secs(120), "no {what} in two minutes");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Generations in the checkpoint of a run, which is there once one is done.
fn generations(folder: &Folder) -> usize {
    let checkpoint = kfgpu::study::Checkpoint::open(&folder.path("out/checkpoint.kfgpu"));
    checkpoint.map_or(0, |checkpoint| checkpoint.snapshot.history.len())
}

const ENDLESS: [&str; 7] = ["tune", "problem.toml", "--json", "--generations", "1000000", "--out", "out"];

#[test]
fn the_first_signal_writes_the_best_so_far() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let folder = Folder::with_level();
        let mut child = folder.spawn(&ENDLESS);
        wait("five generations", &mut child, || generations(&folder) >= 5);
        send(signal, &child);
        let finished = Finished::from(child.wait_with_output().unwrap()).expect(code);
        let json = finished.json();
        assert_eq!(json["stop"], "interrupted");
        assert!(json["generations"].as_u64() >= Some(4), "{json}");
        // The start values are among the candidates, and what five generations found is kept where it is better.
        assert!(json["objectives"]["nll"].as_f64() <= json["baseline"]["objectives"]["nll"].as_f64(), "{json}");
        assert_eq!(folder.names("out"), RUN_FILES);
        assert_eq!(folder.read("out/result.json").trim_end(), finished.stdout.trim_end());
    }
}

#[test]
fn a_second_signal_does_not_wait() {
    for (second, code) in [("-INT", 130), ("-TERM", 143)] {
        let folder = Folder::with_level();
        folder.write("log.csv", level_log(20_000));
        // One generation takes minutes.
        let mut child = folder.spawn(&["tune", "problem.toml", "--population", "1000000", "--out", "out"]);
        wait("lock", &mut child, || folder.path("out/.kfgpu.lock").exists());
        std::thread::sleep(Duration::from_millis(500));
        let asked = Instant::now();
        send("-INT", &child);
        std::thread::sleep(Duration::from_millis(200));
        send(second, &child);
        let finished = Finished::from(child.wait_with_output().unwrap()).expect(code);
        assert!(asked.elapsed() < Duration::from_secs(60), "{:?}", asked.elapsed());
        assert_eq!(finished.stdout, "");
        assert_eq!(folder.names("out"), [".kfgpu.lock"], "nothing half written");
    }
}

/// As under `nohup`, which lets a process live on without its terminal.
#[cfg(target_os = "linux")]
#[test]
fn a_hangup_that_is_ignored_stays_ignored() {
    let folder = Folder::with_level();
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_kfgpu")]).args(ENDLESS);
    command.current_dir(folder.path(".")).stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
    let mut child = command.spawn().unwrap();
    wait("a generation", &mut child, || generations(&folder) >= 1);
    send("-HUP", &child);
    let seen = generations(&folder);
    wait("a later generation", &mut child, || generations(&folder) > seen + 1);
    send("-TERM", &child);
    Finished::from(child.wait_with_output().unwrap()).expect(143);
}

/// Before there is anything to keep, one signal is enough.
#[test]
fn a_signal_before_the_study_ends_the_process() {
    let folder = Folder::with_level();
    // It waits for its log.
    let mut child = folder.spawn(&["tune", "problem.toml", "--data", "-"]);
    let input = child.stdin.take();
    std::thread::sleep(Duration::from_millis(500));
    assert!(child.try_wait().unwrap().is_none(), "it waits");
    send("-TERM", &child);
    Finished::from(child.wait_with_output().unwrap()).expect(143);
    drop(input);
}
