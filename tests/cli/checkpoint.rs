//! `tune --checkpoint` and `--resume`: the same result after any interruption, and what is refused.

use std::time::{Duration, Instant};

use serde_json::Value;

use crate::command::{Finished, Folder};
use crate::tune::without_times;

const FILE: &str = "out/checkpoint.kfgpu";

/// The result of a run that is to end well, as printed and as written in `out`, without times.
fn result(folder: &Folder, arguments: &[&str]) -> Value {
    let json = folder.run(&[&["tune", "--json"], arguments].concat()).expect(0).json();
    assert_eq!(serde_json::from_str::<Value>(&folder.read("out/result.json")).unwrap(), json);
    without_times(json)
}

/// history.csv without its last column, the seconds.
fn history(folder: &Folder) -> Vec<String> {
    let text = folder.read("out/history.csv");
    text.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned()).collect()
}

/// Ends the process as nothing can prevent.
#[cfg(unix)]
fn kill(mut child: std::process::Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

#[cfg(unix)]
#[test]
fn killed_at_any_moment_and_resumed_the_result_is_the_same() {
    let folder = Folder::with_level();
    folder.write("log.csv", crate::command::level_log(4000));
    let arguments = ["problem.toml", "--population", "64", "--generations", "40", "--out", "out"];
    let begin = Instant::now();
    let whole = result(&folder, &arguments);
    let (whole_history, took) = (history(&folder), begin.elapsed());

    let mut killed = Vec::new();
    for share in [0.11, 0.37, 0.74] {
        std::fs::remove_dir_all(folder.path("out")).unwrap();
        let mut child = folder.spawn(&[&["tune"], &arguments[..]].concat());
        while !folder.path(FILE).exists() {
            assert!(child.try_wait().unwrap().is_none(), "it ended without a checkpoint");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(took.mul_f64(share));
        kill(child);
        killed.push(folder.names("out"));
        // Twice more in the middle of what is resumed.
        for more in [0.05, 0.13] {
            let child = folder.spawn(&["tune", "--resume", "out", "--threads", "2"]);
            std::thread::sleep(took.mul_f64(more));
            kill(child);
        }
        let resumed = result(&folder, &["--resume", "out", "--threads", "1"]);
        assert_eq!(resumed, whole, "killed after {share} of {took:?}");
        assert_eq!(history(&folder), whole_history, "killed after {share} of {took:?}");
        assert_eq!(folder.names("out"), crate::command::RUN_FILES);
    }
    let unfinished = killed.iter().filter(|names| !names.contains(&"result.json".to_owned())).count();
    assert!(unfinished > 0, "some process was killed before its end: {killed:?}");
}

#[test]
fn a_limit_that_ended_a_search_can_be_raised() {
    let folder = Folder::with_level();
    let whole = result(&folder, &["problem.toml", "--out", "out"]);
    let early = result(&folder, &["problem.toml", "--out", "out", "--evaluations", "50", "--no-polish"]);
    assert_eq!((&early["stop"], &early["evaluations"]), (&"evaluations".into(), &48.into()));
    assert_eq!(result(&folder, &["--resume", "out"]), early, "an ended search only reports");
    assert_eq!(result(&folder, &["problem.toml", "--resume", "out"]), whole, "the file has neither limit");
    assert_eq!(result(&folder, &["--resume", FILE, "--out", "out"]), whole, "and now neither has the checkpoint");
}

#[test]
fn the_checkpoint_finds_its_problem_and_log_again() {
    let folder = Folder::with_level();
    folder.write("other.csv", crate::command::level_log(40));
    let flags = ["--algorithm", "pio+", "--population", "12", "--seed", "3", "--data", "other.csv"];
    let arguments = [&["tune", "problem.toml", "--json", "--checkpoint", "run.kfgpu"], &flags[..]].concat();
    let whole = without_times(folder.run(&arguments).expect(0).json());
    let resume = |arguments: &[&str]| without_times(folder.run(arguments).expect(0).json());
    assert_eq!(resume(&["tune", "--json", "--resume", "run.kfgpu"]), whole);
    std::fs::create_dir(folder.path("below")).unwrap();
    let mut elsewhere = folder.command(&["tune", "--json", "--resume", "../run.kfgpu"]);
    let finished = Finished::from(elsewhere.current_dir(folder.path("below")).output().unwrap()).expect(0);
    assert_eq!(finished.json()["parameters"], whole["parameters"]);
    assert_eq!(folder.names("."), ["below", "log.csv", "other.csv", "problem.toml", "run.kfgpu"]);

    let piped = ["tune", "problem.toml", "--json", "--checkpoint", "piped.kfgpu", "--data", "-"];
    let piped = without_times(folder.run_with_input(&piped, folder.read("log.csv")).expect(0).json());
    let again = ["tune", "--json", "--resume", "piped.kfgpu"];
    let again = without_times(folder.run_with_input(&again, folder.read("log.csv")).expect(0).json());
    assert_eq!(again, piped, "a piped log is piped again");
}

#[test]
fn simulated_and_built_in_logs_are_made_again() {
    let folder = Folder::with_level();
    let simulated = folder.read("problem.toml").replace("file = \"log.csv\"\ntime = \"t\"", "");
    folder.write("simulated.toml", simulated + "[simulate]\nsteps = 50\n");
    for problem in [&["simulated.toml"][..], &[]] {
        let whole = result(&folder, &[problem, &["--generations", "5", "--out", "out", "--force"]].concat());
        assert_eq!(result(&folder, &["--resume", "out"]), whole, "{problem:?}");
    }
}

#[test]
fn a_search_goes_on_in_its_own_precision() {
    let folder = Folder::with_level();
    let whole = result(&folder, &["problem.toml", "--out", "out", "--precision", "f32"]);
    let early = ["problem.toml", "--out", "out", "--precision", "f32", "--evaluations", "50"];
    result(&folder, &early);
    assert_eq!(result(&folder, &["problem.toml", "--resume", "out"]), whole);
    let message = folder.run(&["tune", "--resume", "out", "--precision", "f64"]).refusal();
    let expected = format!("cannot resume from {FILE}: the search ran in f32, and costs in two precisions do not");
    assert!(message.starts_with(&expected), "{message}");
}

#[test]
fn what_cannot_be_resumed_is_refused_with_the_reason() {
    let folder = Folder::with_level();
    result(&folder, &["problem.toml", "--out", "out", "--evaluations", "50"]);
    let whole = std::fs::read(folder.path(FILE)).unwrap();
    let refused = |more: &[&str]| folder.run(&[&["tune", "--resume", "out"], more].concat()).refusal();
    let with = |bytes: &[u8]| {
        folder.write("broken", bytes);
        folder.run(&["tune", "--resume", "broken"]).refusal()
    };
    let expect = |message: String, part: &str| assert!(message.contains(part), "{part:?} in {message:?}");

    expect(refused(&["--seed", "8"]), "of another problem than this (tune.seed is 7 there and 8 here): resume with");
    expect(refused(&["problem.toml", "--generations", "11"]), "(tune.generations is 10 there and 11 here)");
    folder.write("other.csv", crate::command::level_log(61));
    expect(
        refused(&["--data", "other.csv"]),
        "the log is not the one it was written with (data.file is \"log.csv\" there and \"other.csv\" here)",
    );
    expect(refused(&["--validate", "0.3"]), "(data.validate is absent there and 0.3 here): resume with that log");
    expect(with(b""), "cannot resume from broken: the file is empty: name");
    expect(with(b"t,z\n0,1\n"), "it is not a checkpoint of kfgpu: name");
    expect(with(&whole[..whole.len() - 1]), "it is truncated, ");
    expect(with(&whole[..11]), "it is truncated, 11 of ");
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    expect(with(&flipped), "it is damaged, its checksum does not hold: copy it again");
    let newer = [&whole[..8], &[9], &whole[9..]].concat();
    expect(with(&newer), "it has format 9 of checkpoints, this kfgpu reads format 3");
    let missing = folder.run(&["tune", "--resume", "nowhere"]).refusal();
    expect(missing, "cannot resume from nowhere: it cannot be read: ");
    std::fs::create_dir(folder.path("empty")).unwrap();
    let missing = folder.run(&["tune", "--resume", "empty"]).refusal();
    expect(missing, "cannot resume from empty/checkpoint.kfgpu: it cannot be read: ");
    expect(folder.run(&["tune", "--checkpoint", "empty"]).refusal(), "cannot write empty: it is a folder");
    assert_eq!(std::fs::read(folder.path(FILE)).unwrap(), whole, "what was refused is as it was");

    folder.write("log.csv", crate::command::level_log(59));
    expect(refused(&[]), "the log is not the one it was written with (\"log.csv\", as it was then): resume with");
    std::fs::remove_file(folder.path("log.csv")).unwrap();
    let lost = "cannot resume from out/checkpoint.kfgpu: its log log.csv is neither where it was nor beside the \
                checkpoint (name it with --data)";
    assert_eq!(refused(&[]), lost);
}

/// The project is renamed, its log with it; or the results move alone.
#[test]
fn a_run_that_has_moved_is_resumed() {
    let folder = Folder::new();
    let project = |name: &str, arguments: &[&str]| {
        let mut command = folder.command(&[&["tune", "--json"], arguments].concat());
        without_times(Finished::from(command.current_dir(folder.path(name)).output().unwrap()).expect(0).json())
    };
    std::fs::create_dir_all(folder.path("before/data")).unwrap();
    let problem = crate::command::LEVEL.replace("log.csv", "data/log.csv");
    folder.write("before/problem.toml", problem);
    folder.write("before/data/log.csv", crate::command::level_log(60));
    let whole = project("before", &["problem.toml", "--out", "out"]);
    let early = ["problem.toml", "--out", "early", "--evaluations", "50", "--no-polish"];
    project("before", &early);

    std::fs::rename(folder.path("before"), folder.path("after")).unwrap();
    assert_eq!(project("after", &["--resume", "out"]), whole);
    assert_eq!(project("after", &["problem.toml", "--resume", "early"]), whole);
    // The log lies beside the folder's new parent, not where a relative path leads.
    std::fs::create_dir_all(folder.path("archive/2026")).unwrap();
    std::fs::rename(folder.path("after/out"), folder.path("archive/2026/out")).unwrap();
    let moved = project(".", &["--resume", "archive/2026/out"]);
    assert_eq!(moved["parameters"], whole["parameters"]);
    // To another machine, with the log in the same folder.
    std::fs::rename(folder.path("after/data/log.csv"), folder.path("archive/2026/out/log.csv")).unwrap();
    let moved = project("archive/2026", &["--resume", "out"]);
    assert_eq!((&moved["parameters"], &moved["objectives"]), (&whole["parameters"], &whole["objectives"]));
    folder.run(&["filter", "archive/2026/out/tuned.toml", "--quiet"]).expect(0);
}

#[cfg(unix)]
#[test]
fn a_checkpoint_that_cannot_be_written_is_said_once_and_the_search_goes_on() {
    let folder = Folder::with_level();
    // The temporary file's name is taken by a folder.
    std::fs::create_dir(folder.path(".run.kfgpu.tmp")).unwrap();
    let finished = folder.run(&["tune", "problem.toml", "--json", "--checkpoint", "run.kfgpu"]).expect(0);
    let said = "warning: cannot write the checkpoint run.kfgpu: ";
    assert_eq!(finished.stderr.matches(said).count(), 1, "{}", finished.stderr);
    assert!(finished.json()["warnings"].to_string().contains("the search goes on"), "{}", finished.stdout);
}
