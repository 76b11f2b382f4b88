//! `kfgpu evaluate`.

use std::fs::File;
use std::io::{BufRead as _, BufReader, Write as _};

use crate::command::Folder;

const CANDIDATES: &str = "q,r\n1,50\n0.5,4\n2,80\n";

fn costs(folder: &Folder, arguments: &[&str]) -> Vec<f64> {
    let table = folder.run(arguments).expect(0).table();
    assert_eq!(table[0], ["nll", "status"]);
    table[1..].iter().map(|row| row[0].parse().unwrap()).collect()
}

#[test]
fn costs_of_a_file_in_order() {
    let folder = Folder::with_level();
    folder.write("c.csv", CANDIDATES);
    let forward = costs(&folder, &["evaluate", "problem.toml", "c.csv"]);
    assert_eq!(forward.len(), 3);
    assert!(forward[1] < forward[0] && forward[0] < forward[2], "{forward:?}");

    folder.write("swapped.csv", "r,q\n80,2\n4,0.5\n50,1\n");
    let mut backward = costs(&folder, &["evaluate", "problem.toml", "swapped.csv"]);
    backward.reverse();
    assert_eq!(forward, backward, "order of columns and rows does not change a cost");
}

#[test]
fn costs_are_those_of_the_filter() {
    let folder = Folder::with_level();
    folder.write("c.csv", "q,r\n1,50\n");
    let cost = costs(&folder, &["evaluate", "problem.toml", "c.csv"])[0];
    let json = folder.run(&["filter", "problem.toml", "--json"]).expect(0).json();
    let reference = json["objectives"]["nll"].as_f64().unwrap();
    assert!((cost - reference).abs() <= 1e-10 * reference.abs(), "{cost} {reference}");
}

#[test]
fn json_is_one_object() {
    let folder = Folder::with_level();
    folder.write("c.csv", CANDIDATES);
    let json = folder.run(&["evaluate", "problem.toml", "c.csv", "--json"]).expect(0).json();
    assert_eq!(json["objectives"]["nll"].as_array().unwrap().len(), 3);
    assert_eq!(json["status"], serde_json::json!([0, 0, 0]));
    assert_eq!(json["device"]["backend"], "cpu");
    assert_eq!(json["device"]["precision"], "f64");
}

#[test]
fn f32_is_close_to_f64_and_says_so() {
    let folder = Folder::with_level();
    folder.write("c.csv", CANDIDATES);
    let f64_costs = costs(&folder, &["evaluate", "problem.toml", "c.csv"]);
    let json = folder.run(&["evaluate", "problem.toml", "c.csv", "--json", "--precision", "f32"]).expect(0).json();
    assert_eq!(json["device"]["precision"], "f32");
    for (i, cost) in f64_costs.iter().enumerate() {
        let single = json["objectives"]["nll"][i].as_f64().unwrap();
        assert!((single - cost).abs() < 1e-3 * cost.abs(), "{single} {cost}");
    }
}

#[test]
fn a_failed_candidate_gets_a_status_and_the_worst_finite_cost() {
    let folder = Folder::with_level();
    folder.write("c.csv", "q,r\n1,50\n-1,-1e9\n");
    let table = folder.run(&["evaluate", "problem.toml", "c.csv"]).expect(0).table();
    assert_eq!(table[1][1], "0");
    assert_ne!(table[2][1], "0");
    assert_eq!(table[2][0].parse::<f64>().unwrap(), f64::MAX);
}

#[test]
fn a_pipe_is_answered_line_by_line() {
    let folder = Folder::with_level();
    let mut child = folder.spawn(&["evaluate", "problem.toml", "-", "--quiet"]);
    let mut ask = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines();
    writeln!(ask, "q,r").unwrap();
    assert_eq!(answers.next().unwrap().unwrap(), "nll,status");
    let mut seen = Vec::new();
    for line in ["1,50", "0.5,4", "2,80"] {
        // The next line is written only when this one has been answered.
        writeln!(ask, "{line}").unwrap();
        let answer = answers.next().unwrap().unwrap();
        seen.push(answer.split(',').next().unwrap().parse::<f64>().unwrap());
    }
    drop(ask);
    assert!(answers.next().is_none(), "nothing follows the last answer");
    assert_eq!(child.wait().unwrap().code(), Some(0));

    folder.write("c.csv", CANDIDATES);
    assert_eq!(seen, costs(&folder, &["evaluate", "problem.toml", "c.csv"]), "alone or together: the same bits");
}

const JUNK: &str = "q,r\n1,50\nNaN,2\n1,\n\n1\n1,oops\n\u{0},1\n1,2\n";

/// A foreign optimiser that sends a NaN keeps its process, and gets an answer to every line.
#[test]
fn a_line_that_is_no_candidate_is_answered_as_failed() {
    let folder = Folder::with_level();
    let finished = folder.run_with_input(&["evaluate", "problem.toml", "-"], JUNK).expect(0);
    let table = finished.table();
    let status: Vec<&str> = table[1..].iter().map(|row| row[1].as_str()).collect();
    assert_eq!(status, ["0", "8", "8", "8", "8", "8", "0"]);
    let costs: Vec<f64> = table[1..].iter().map(|row| row[0].parse().unwrap()).collect();
    assert!(costs[1..6].iter().all(|cost| *cost == f64::MAX), "{costs:?}");
    assert_eq!([costs[0], costs[6]].map(|cost| cost < 1e4), [true; 2]);
    for said in [
        "warning: <stdin>:3: column \"q\": expected a finite number, found \"NaN\" (answered as failed, with status 8)",
        "warning: <stdin>:4: column \"r\": expected a finite number, found \"\" (answered",
        "warning: <stdin>:6: expected 2 values as in the header, found 1 (answered",
        "warning: <stdin>:8: expected a line of UTF-8 text, found binary data (answered",
    ] {
        assert!(finished.stderr.contains(said), "{said:?} in {}", finished.stderr);
    }
    let json = folder.run_with_input(&["evaluate", "problem.toml", "-", "--json"], JUNK).expect(0).json();
    assert_eq!(json["status"].to_string(), "[0,8,8,8,8,8,0]");
    assert_eq!(json["objectives"]["nll"][0].as_f64(), Some(costs[0]));
}

/// Nobody may be reading stderr: a pipe that is full would stop the process.
#[test]
fn much_junk_is_told_ten_times() {
    let folder = Folder::with_level();
    let junk = format!("q,r\n{}1,50\n", "nan,nan\n".repeat(5000));
    let finished = folder.run_with_input(&["evaluate", "problem.toml", "-"], junk).expect(0);
    assert_eq!(finished.table().len(), 5002);
    assert_eq!(finished.stderr.matches("answered as failed").count(), 10, "{}", finished.stderr);
    assert!(finished.stderr.contains("status 8; more such lines are not told)"), "{}", finished.stderr);
}

#[test]
fn candidates_out_of_bounds_are_scored_and_said_once() {
    let folder = Folder::with_level();
    let finished = folder.run_with_input(&["evaluate", "problem.toml", "-"], "r,q\n50,1\n200,1\n300,1\n").expect(0);
    assert!(finished.table()[1..].iter().all(|row| row[1] == "0"), "{}", finished.stdout);
    let said = "warning: <stdin>:3: r = 200 lies outside its bounds 0.001 to 100 (";
    assert_eq!(finished.stderr.matches(said).count(), 1, "{}", finished.stderr);
    assert_eq!(finished.stderr.matches("outside its bounds").count(), 1, "{}", finished.stderr);
}

#[test]
fn a_file_is_answered_up_to_its_first_bad_line() {
    let folder = Folder::with_level();
    folder.write("c.csv", "q,r\n1,50\n1,2\n1,oops\n1,3\n");
    let finished = folder.run(&["evaluate", "problem.toml", "c.csv", "--quiet"]).expect(2);
    assert_eq!(finished.table().len(), 3, "{}", finished.stdout);
    assert_eq!(finished.stderr, "error: c.csv:4: column \"r\": expected a finite number, found \"oops\"\n");
}

#[test]
fn bad_candidates_are_refused() {
    let folder = Folder::with_level();
    for (text, part) in [
        ("", "c.csv: the file is empty"),
        ("q,z\n1,2\n", "c.csv:1: unknown column \"z\""),
        ("q\n1\n", "column \"r\" is missing"),
        ("q,r,q\n1,2,3\n", "column \"q\" is named twice"),
    ] {
        folder.write("c.csv", text);
        let message = folder.run(&["evaluate", "problem.toml", "c.csv"]).refusal();
        assert!(message.contains(part), "{text:?}: {message}");
    }
    let message = folder.run(&["evaluate", "problem.toml", "nowhere.csv"]).refusal();
    assert!(message.contains("nowhere.csv"), "{message}");
    folder.write("piped.toml", folder.read("problem.toml").replace("log.csv", "-"));
    let message = folder.run_with_input(&["evaluate", "piped.toml", "-"], "t,z\n0,1\n1,2\n").refusal();
    assert!(message.contains("standard input"), "{message}");
}

#[test]
fn a_large_file_is_answered_whole() {
    let folder = Folder::with_level();
    let mut file = File::create(folder.path("c.csv")).unwrap();
    writeln!(file, "q,r").unwrap();
    // More than one read of the input buffer.
    for i in 0..120_000 {
        writeln!(file, "{}e-1,{}", 1 + i % 7, 10 + i % 3).unwrap();
    }
    drop(file);
    let costs = costs(&folder, &["evaluate", "problem.toml", "c.csv"]);
    assert_eq!(costs.len(), 120_000);
    assert!((21..costs.len()).all(|i| costs[i].to_bits() == costs[i - 21].to_bits()), "equal candidates, equal bits");
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::with_level();
    let mut child = folder.spawn(&["evaluate", "problem.toml", "-", "--quiet"]);
    let mut ask = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap());
    writeln!(ask, "q,r\n1,50").unwrap();
    answers.read_line(&mut String::new()).unwrap();
    drop(answers);
    for _ in 0..10_000 {
        if writeln!(ask, "1,50").is_err() {
            break;
        }
    }
    drop(ask);
    let finished = crate::command::Finished::from(child.wait_with_output().unwrap()).expect(0);
    assert_eq!(finished.stderr, "");
}
