//! Bad input of every kind: exit code 2, one clear sentence on stderr, nothing lost.

use crate::command::{Folder, LEVEL, level_log};

/// Tunes with this log and gives the sentence on stderr.
fn refused_log(log: impl AsRef<[u8]>) -> String {
    let folder = Folder::with_level();
    folder.write("log.csv", log);
    refusal(&folder)
}

/// Tunes with `from` replaced by `to` in the problem and gives the sentence on stderr.
fn refused_problem(from: &str, to: &str) -> String {
    assert!(LEVEL.contains(from), "{from}");
    let folder = Folder::with_level();
    folder.write("problem.toml", LEVEL.replace(from, to));
    refusal(&folder)
}

/// The refusal, with an output folder that must stay as it was.
fn refusal(folder: &Folder) -> String {
    std::fs::create_dir_all(folder.path("out")).unwrap();
    folder.write("out/result.json", "earlier");
    let message = folder.run(&["tune", "problem.toml", "--out", "out", "--force"]).refusal();
    assert_eq!(folder.read("out/result.json"), "earlier");
    assert_eq!(folder.names("out"), ["result.json"], "no file is left behind");
    message
}

#[track_caller]
fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{part:?} in: {message}");
    }
}

#[test]
fn missing_log() {
    let folder = Folder::with_level();
    std::fs::remove_file(folder.path("log.csv")).unwrap();
    says(&refusal(&folder), &["log.csv"]);
}

#[test]
fn missing_problem() {
    says(&Folder::new().run(&["tune", "nowhere.toml"]).refusal(), &["nowhere.toml"]);
}

#[test]
fn problem_without_a_log() {
    says(&refused_problem("file = \"log.csv\"\n", ""), &["[data]", "file"]);
}

#[test]
fn empty_log() {
    says(&refused_log(""), &["log.csv", "empty"]);
}

#[test]
fn header_only_log() {
    says(&refused_log("t,z\n"), &["log.csv"]);
}

#[test]
fn binary_log() {
    let bytes: Vec<u8> = (0..4096_u32).map(|i| (i * 197 % 256) as u8).collect();
    says(&refused_log(bytes), &["log.csv"]);
}

#[test]
fn ragged_log() {
    says(&refused_log("t,z\n0,1\n1,2,3\n2,3\n"), &["log.csv:3"]);
}

#[test]
fn text_in_a_number_column() {
    says(&refused_log("t,z\n0,1\n1,n/a\n2,3\n"), &["log.csv:3", "\"z\"", "n/a"]);
}

#[test]
fn duplicate_times() {
    says(&refused_log("t,z\n0,1\n1,2\n1,3\n"), &["log.csv:4"]);
}

#[test]
fn decreasing_times() {
    says(&refused_log("t,z\n0,1\n2,2\n1,3\n"), &["log.csv:4"]);
}

#[test]
fn column_named_twice() {
    says(&refused_log("t,z,z\n0,1,1\n1,2,2\n"), &["log.csv", "\"z\""]);
}

#[test]
fn column_that_does_not_exist() {
    says(&refused_log("t,y\n0,1\n1,2\n"), &["\"z\""]);
}

#[test]
fn all_values_missing() {
    says(&refused_log("t,z\n0,\n1,nan\n2,\n"), &["log.csv"]);
}

#[test]
fn infinite_values() {
    says(&refused_log("t,z\n0,1\n1,inf\n2,3\n"), &["log.csv:3", "inf"]);
}

#[test]
fn bounds_reversed() {
    says(
        &refused_problem("min = 1e-3, max = 1e2, scale = \"log\", start = 1,", "min = 5, max = 2,"),
        &["problem.toml:1"],
    );
}

#[test]
fn log_bounds_not_positive() {
    says(
        &refused_problem("min = 1e-3, max = 1e2, scale = \"log\", start = 1,", "min = 0, max = 2, scale = \"log\","),
        &["problem.toml:1"],
    );
}

#[test]
fn p0_not_positive_definite() {
    says(&refused_problem("P0 = [1e4]", "P0 = [-1]"), &["problem.toml:14", "P0"]);
}

#[test]
fn q_of_wrong_size() {
    says(&refused_problem("Q = { x = \"q\" }", "Q = [[\"q\", 0], [0, \"q\"]]"), &["problem.toml:11", "Q"]);
}

#[test]
fn r_of_wrong_size() {
    says(&refused_problem("R = { z = \"r\" }", "R = [[\"r\", 0]]"), &["problem.toml:12", "R"]);
}

#[test]
fn formula_with_a_syntax_error() {
    says(&refused_problem("f = [\"x\"]", "f = [\"x +* 2\"]"), &["problem.toml:9"]);
}

#[test]
fn formula_of_100_000_parentheses() {
    let deep = format!("f = [\"{}x{}\"]", "(".repeat(100_000), ")".repeat(100_000));
    says(&refused_problem("f = [\"x\"]", &deep), &["problem.toml:9"]);
}

#[test]
fn formula_of_one_megabyte() {
    let long = format!("f = [\"x{}\"]", " + x".repeat(250_000));
    says(&refused_problem("f = [\"x\"]", &long), &["problem.toml"]);
}

#[test]
fn unknown_function() {
    says(&refused_problem("f = [\"x\"]", "f = [\"sine(x)\"]"), &["problem.toml:9", "sine"]);
}

#[test]
fn unknown_name() {
    says(&refused_problem("f = [\"x\"]", "f = [\"x + drift\"]"), &["problem.toml:9", "drift"]);
}

#[test]
fn unknown_key_names_the_nearest() {
    says(&refused_problem("generations = 10", "generation = 10"), &["problem.toml:", "`generation`", "`generations`"]);
}

#[test]
fn nonlinear_formula_for_a_linear_filter() {
    says(&refused_problem("f = [\"x\"]", "f = [\"x^2\"]"), &["problem.toml:9", "linear"]);
}

#[test]
fn the_place_is_marked_with_a_caret() {
    let folder = Folder::with_level();
    folder.write("problem.toml", LEVEL.replace("f = [\"x\"]", "f = [\"x + drift\"]"));
    let stderr = folder.run(&["tune", "problem.toml"]).expect(2).stderr;
    let lines: Vec<&str> = stderr.lines().collect();
    assert!(lines[0].starts_with("error: problem.toml:9:11: "), "{stderr}");
    let (formula, carets) = (lines[lines.len() - 2], lines[lines.len() - 1]);
    assert_eq!(formula.find("drift"), carets.find("^^^^^"), "{stderr}");
}

#[test]
fn absurdly_many_states() {
    let names: Vec<String> = (0..5000).map(|i| format!("\"x{i}\"")).collect();
    let state = format!("state = [{}]", names.join(", "));
    says(&refused_problem("state = [\"x\"]", &state), &["problem.toml"]);
}

#[test]
fn absurdly_many_measurements() {
    let names: Vec<String> = (0..5000).map(|i| format!("\"z{i}\"")).collect();
    let measurements = format!("measurements = [{}]", names.join(", "));
    says(&refused_problem("measurements = [\"z\"]", &measurements), &["problem.toml"]);
}

#[test]
fn unwritable_output_folder() {
    let folder = Folder::with_level();
    let message = folder.run(&["tune", "problem.toml", "--out", "log.csv/out"]).refusal();
    says(&message, &["log.csv/out"]);
    assert_eq!(folder.read("log.csv"), level_log(60), "the log is untouched");
}

#[test]
fn no_searched_parameter() {
    let fixed = LEVEL.lines().map(|line| match line.split_once(" = {") {
        Some((name @ ("q" | "r"), _)) => format!("{name} = 1\n"),
        _ => format!("{line}\n"),
    });
    let folder = Folder::with_level();
    folder.write("problem.toml", fixed.collect::<String>());
    says(&refusal(&folder), &["search"]);
}

#[test]
fn wrong_use_of_flags() {
    let folder = Folder::with_level();
    for arguments in [
        &["tune", "problem.toml", "--population", "none"][..],
        &["tune", "problem.toml", "--no-such-flag"],
        &["no-such-verb"],
        &["filter"],
        &[],
    ] {
        let finished = folder.run(arguments).expect(2);
        assert_eq!(finished.stdout, "", "{arguments:?}");
        assert!(!finished.stderr.is_empty(), "{arguments:?}");
    }
    for (flag, value) in [
        ("--algorithm", "annealing"),
        ("--objectives", "nll,nothing"),
        ("--objectives", "rmse"),
        ("--population", "0"),
        ("--seed", "-1"),
        ("--wall-time", "-1"),
        ("--wall-time", "nan"),
        ("--threads", "0"),
        ("--threads", "100000"),
    ] {
        let finished = folder.run(&["tune", "problem.toml", flag, value]).expect(2);
        assert_eq!(finished.stdout, "", "{flag} {value}");
        assert!(!finished.stderr.contains("panicked"), "{flag} {value}: {}", finished.stderr);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let folder = Folder::with_level();
    for verb in ["filter", "tune", "tape"] {
        let full = std::fs::File::create("/dev/full").unwrap();
        let mut command = folder.command(&[verb, "problem.toml", "--quiet"]);
        let message = crate::command::Finished::from(command.stdout(full).output().unwrap()).refusal();
        says(&message, &["cannot write to standard output"]);
    }
}
