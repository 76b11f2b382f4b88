//! What stands where a verb writes: locked against a second run, kept, or refused, never lost without a word.

use std::fs;

use crate::command::{Finished, Folder, LEVEL, RUN_FILES, level_log};

fn short(folder: &Folder, more: &[&str]) -> Finished {
    folder.run(&[&["tune", "problem.toml", "--generations", "2", "--population", "8"], more].concat())
}

fn seed(folder: &Folder, run: &str) -> u64 {
    let json: serde_json::Value = serde_json::from_str(&folder.read(&format!("{run}/result.json"))).unwrap();
    json["seed"].as_u64().unwrap()
}

#[test]
fn a_second_run_waits_for_the_first() {
    let folder = Folder::with_level();
    let first = ["tune", "problem.toml", "--generations", "1000000", "--out", "out", "--seed", "1"];
    let mut first = folder.spawn(&first);
    while !folder.path("out/checkpoint.kfgpu").exists() {
        assert!(first.try_wait().unwrap().is_none(), "it runs until it is killed");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let id = first.id();
    let resume = ["tune", "--resume", "out"];
    let (again, force) =
        (["tune", "problem.toml", "--out", "out"], ["tune", "problem.toml", "--out", "out", "--force"]);
    for arguments in [&again[..], &force, &resume] {
        let message = folder.run(arguments).refusal();
        let said = format!("another kfgpu (process {id}) is writing the folder out: wait until it ends, or choose");
        assert!(message.starts_with(&said), "{arguments:?}: {message}");
    }
    let message = folder.run(&["tune", "--resume", "out/checkpoint.kfgpu"]).refusal();
    assert!(message.contains("is writing the folder out"), "{message}");
    first.kill().unwrap();
    first.wait().unwrap();
    assert!(folder.path("out/.kfgpu.lock").exists(), "the file stays, the lock does not");
    short(&folder, &["--out", "out", "--seed", "2"]).expect(0);
    assert_eq!((folder.names("out"), seed(&folder, "out")), (RUN_FILES.map(str::to_owned).to_vec(), 2));
    assert_eq!(folder.names("out.1"), ["checkpoint.kfgpu"], "what the killed run had reached is kept");
}

#[test]
fn an_earlier_run_of_the_same_study_is_kept_beside_it() {
    let folder = Folder::with_level();
    folder.write("mine.toml", LEVEL);
    short(&folder, &["--out", "out", "--seed", "1"]).expect(0);
    folder.write("out/notes.txt", "mine");
    let again = short(&folder, &["--out", "out", "--seed", "2"]).expect(0);
    assert!(again.stderr.contains("kept the earlier run of out in out.1\n"), "{}", again.stderr);
    // Another model for the same log is what one compares.
    folder.run(&["tune", "mine.toml", "--generations", "2", "--out", "out", "--seed", "3"]).expect(0);
    assert_eq!(["out.1", "out.2", "out"].map(|run| seed(&folder, run)), [1, 2, 3]);
    assert_eq!(folder.names("out.1"), RUN_FILES);
    assert_eq!(folder.read("out/notes.txt"), "mine");
    // They are whole: their paths lead where they led.
    folder.run(&["compare", "out.1", "out.2", "out"]).expect(0);
    folder.run(&["filter", "out.1/tuned.toml", "--quiet"]).expect(0);
    folder.run(&["tune", "--resume", "out.1"]).expect(0);

    short(&folder, &["--out", "out", "--force", "--seed", "4"]).expect(0);
    assert_eq!((seed(&folder, "out"), folder.path("out.3").exists()), (4, false), "replaced in place");
    folder.run(&["tune", "--resume", "out"]).expect(0);
    assert!(!folder.path("out.3").exists(), "a run that goes on is no other one");
}

#[test]
fn what_is_not_of_this_study_is_refused() {
    let folder = Folder::with_level();
    folder.write("other.toml", LEVEL.replace("log.csv", "other.csv"));
    folder.write("other.csv", level_log(50));
    short(&folder, &["--out", "out"]).expect(0);
    let before = folder.read("out/result.json");
    let refused = |out: &str| folder.run(&["tune", "other.toml", "--out", out]).refusal();
    assert_eq!(
        refused("out"),
        "out holds a run of problem.toml, not of other.toml (choose another folder, or give --force to replace what is \
         there)"
    );
    for name in ["report.md", "result.json", "tuned.toml", "figures/nis.svg"] {
        fs::create_dir_all(folder.path("theirs/figures")).unwrap();
        folder.write(&format!("theirs/{name}"), "{}");
        let message = refused("theirs");
        assert!(message.starts_with(&format!("theirs holds {name}, which is of no run of kfgpu (")), "{message}");
        assert_eq!(folder.read(&format!("theirs/{name}")), "{}");
        fs::remove_dir_all(folder.path("theirs")).unwrap();
    }
    assert_eq!(folder.read("out/result.json"), before, "what was refused is as it was");
    assert_eq!(folder.names("out"), RUN_FILES);
    folder.run(&["tune", "other.toml", "--generations", "2", "--out", "out", "--force"]).expect(0);
    fs::create_dir(folder.path("unrelated")).unwrap();
    folder.write("unrelated/notes.txt", "mine");
    folder.run(&["tune", "other.toml", "--generations", "2", "--out", "unrelated"]).expect(0);
}

#[test]
fn a_checkpoint_that_is_not_resumed_is_refused() {
    let folder = Folder::with_level();
    folder.write("run.kfgpu", "theirs");
    let message = short(&folder, &["--checkpoint", "run.kfgpu"]).refusal();
    assert!(message.starts_with("run.kfgpu exists (go on with its search by --resume run.kfgpu, or give"), "{message}");
    short(&folder, &["--checkpoint", "run.kfgpu", "--force"]).expect(0);
    folder.run(&["tune", "--resume", "run.kfgpu", "--checkpoint", "run.kfgpu"]).expect(0);
    assert_eq!(folder.names("."), ["log.csv", "problem.toml", "run.kfgpu"], "locks are gone");
}

#[test]
fn tables_and_pictures_are_treated_alike() {
    let folder = Folder::with_level();
    folder.write("sim.toml", LEVEL.replace("file = \"log.csv\"\n", "") + "[simulate]\nsteps = 20\n");
    for verb in [&["simulate", "sim.toml"][..], &["filter", "problem.toml"]] {
        let run = |more: &[&str]| folder.run(&[verb, &["--out", "t.csv"], more].concat());
        folder.write("mine.toml", "theirs\n");
        let message = folder.run(&[verb, &["--out", "mine.toml"]].concat()).refusal();
        assert!(message.starts_with("mine.toml exists and is no earlier table of these columns ("), "{message}");
        assert_eq!(folder.read("mine.toml"), "theirs\n");
        run(&["--force"]).expect(0);
        let first = folder.read("t.csv");
        let second = run(&[]).expect(0);
        assert!(second.stderr.contains("kept the earlier t.csv as t.csv.1\n"), "{}", second.stderr);
        assert_eq!((folder.read("t.csv.1"), folder.read("t.csv")), (first.clone(), first));
        fs::remove_file(folder.path("t.csv.1")).unwrap();
    }
    folder.run(&["filter", "problem.toml", "--figures", "seen", "--quiet"]).expect(0);
    let message = folder.run(&["filter", "problem.toml", "--figures", "seen"]).refusal();
    assert!(message.contains(" exists (choose another folder, or give --force to replace the pictures"), "{message}");
    folder.run(&["filter", "problem.toml", "--figures", "seen", "--force", "--quiet"]).expect(0);
    fs::create_dir(folder.path("study")).unwrap();
    folder.write("study/report.md", "theirs");
    let message = folder.run(&["reproduce", "kf-pio", "--quick", "--out", "study"]).refusal();
    assert!(message.starts_with("study/report.md exists (choose another folder, or give --force"), "{message}");
}

/// A process that is killed while it writes leaves a half file.
#[cfg(unix)]
#[test]
fn what_killed_runs_left_is_removed() {
    let folder = Folder::with_level();
    fs::create_dir_all(folder.path("out/figures")).unwrap();
    let half = ["out/.history.csv.2147483647.tmp", "out/figures/.nis.svg.2147483647.tmp", ".t.csv.2147483647.tmp"];
    half.iter().for_each(|name| folder.write(name, "half"));
    folder.write("out/.notes.2147483647.tmp", "not ours");
    folder.write("out/.checkpoint.kfgpu.tmp", "half");
    short(&folder, &["--out", "out"]).expect(0);
    folder.run(&["filter", "problem.toml", "--out", "t.csv"]).expect(0);
    assert_eq!(half.map(|name| folder.path(name).exists()), [false; 3]);
    let mut expected = RUN_FILES.map(str::to_owned).to_vec();
    expected.insert(0, ".notes.2147483647.tmp".to_owned());
    assert_eq!(folder.names("out"), expected);
}

/// A disk that is full when the pictures come: here a file stands where their folder belongs.
#[test]
fn results_are_written_before_pictures() {
    let folder = Folder::with_level();
    fs::create_dir(folder.path("out")).unwrap();
    folder.write("out/figures", "a file");
    let finished = short(&folder, &["--out", "out", "--json"]).expect(2);
    assert!(finished.stderr.contains("error: cannot make the output folder out/figures"), "{}", finished.stderr);
    assert_eq!(folder.read("out/result.json").trim_end(), finished.stdout.trim_end());
    for name in ["report.md", "tuned.toml", "history.csv"] {
        assert!(!folder.read(&format!("out/{name}")).is_empty(), "{name}");
    }
}

/// What a command reads it does not write over, whatever is forced.
#[test]
fn an_input_is_no_output() {
    let folder = Folder::with_level();
    let (log, problem) = (folder.read("log.csv"), folder.read("problem.toml"));
    for arguments in [
        &["filter", "problem.toml", "--out", "log.csv", "--force"][..],
        &["filter", "problem.toml", "--out", "./problem.toml", "--force"],
        &["init", "log.csv", "--out", "log.csv", "--force"],
        &["tune", "problem.toml", "--generations", "1", "--checkpoint", "log.csv", "--force"],
        &["tune", "problem.toml", "--generations", "1", "--checkpoint", "problem.toml", "--force"],
    ] {
        let message = folder.run(arguments).refusal();
        assert!(message.contains(" is read by this command and would be replaced (choose"), "{arguments:?}: {message}");
        assert_eq!(
            (folder.read("log.csv"), folder.read("problem.toml")),
            (log.clone(), problem.clone()),
            "{arguments:?}"
        );
    }
    folder.write("tuned.toml", &problem);
    let message = folder
        .run(&["filter", "problem.toml", "--parameters", "tuned.toml", "--out", "tuned.toml", "--force"])
        .refusal();
    assert!(message.contains("tuned.toml is read by this command"), "{message}");
    let message = folder.run(&["tune", "tuned.toml", "--generations", "1", "--out", "."]).refusal();
    assert!(message.contains("tuned.toml is read by this command"), "{message}");
    assert_eq!(folder.read("tuned.toml"), problem);
}
