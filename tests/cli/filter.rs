//! `kfgpu filter`, `simulate`, `init`.

use crate::command::Folder;

#[test]
fn the_table_has_a_row_for_every_row_of_the_log() {
    let folder = Folder::with_level();
    let finished = folder.run(&["filter", "problem.toml"]).expect(0);
    let table = finished.table();
    assert_eq!(table[0], ["t", "x", "P_x_x", "nu_z", "S_z", "nis"]);
    assert_eq!(table.len(), 61);
    let first: Vec<f64> = table[1].iter().map(|cell| cell.parse().unwrap()).collect();
    // One update from x0 = 0, P0 = 1e4 by z = -2.4 with R = 50: the textbook's scalar formulas.
    let (s, nu) = (1e4 + 50.0, -2.4);
    let expected = [0.0, nu * 1e4 / s, 1e4 * 50.0 / s, nu, s, nu * nu / s];
    for (value, expected) in first.iter().zip(expected) {
        assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{first:?}");
    }
    assert!(finished.stderr.contains("60 rows"), "{}", finished.stderr);
}

#[test]
fn missing_values_leave_their_cells_empty() {
    let folder = Folder::with_level();
    folder.write("log.csv", "t,z\n0,1\n1,\n2,3\n");
    let table = folder.run(&["filter", "problem.toml", "--quiet"]).expect(0).table();
    assert_eq!(table[2][3..], ["", "", ""]);
    assert_ne!(table[3][3], "");
}

#[test]
fn quiet_says_nothing_on_stderr() {
    let finished = Folder::with_level().run(&["filter", "problem.toml", "--quiet"]).expect(0);
    assert_eq!(finished.stderr, "");
}

#[test]
fn a_log_too_short_to_test_is_not_called_consistent() {
    let folder = Folder::with_level();
    folder.write("log.csv", "t,z\n0,1\n1,14\n2,3\n");
    let finished = folder.run(&["filter", "problem.toml"]).expect(0);
    assert!(finished.stderr.contains("white z: too few innovations to tell"), "{}", finished.stderr);
    let json = folder.run(&["filter", "problem.toml", "--json", "--quiet"]).expect(0).json();
    assert_eq!(json["consistency"]["verdict"], "too_few_innovations", "{json}");
}

#[test]
fn a_file_is_written_whole_and_json_goes_to_stdout() {
    let folder = Folder::with_level();
    let json = folder.run(&["filter", "problem.toml", "--json", "--out", "run.csv"]).expect(0).json();
    assert_eq!(folder.read("run.csv").lines().count(), 61);
    assert!(json["objectives"]["nll"].is_f64(), "{json}");
    assert!(json["consistency"]["nis_mean"].is_f64(), "{json}");
    assert_eq!(json["parameters"]["r"], 50.0);
    assert_eq!(folder.names(""), ["log.csv", "problem.toml", "run.csv"], "no temporary file is left");
}

#[test]
fn starts_of_another_problem_file_are_used() {
    let folder = Folder::with_level();
    folder.write("other.toml", folder.read("problem.toml").replace("start = 50", "start = 5"));
    let json = folder.run(&["filter", "problem.toml", "--parameters", "other.toml", "--json"]).expect(0).json();
    assert_eq!(json["parameters"]["r"], 5.0);

    let renamed = folder.read("problem.toml").replace("r = {", "noise = {").replace("\"r\"", "\"noise\"");
    folder.write("other.toml", renamed);
    let message = folder.run(&["filter", "problem.toml", "--parameters", "other.toml"]).refusal();
    assert!(message.contains("`r`"), "{message}");
}

#[test]
fn a_log_comes_through_a_pipe() {
    let folder = Folder::with_level();
    let file = folder.run(&["filter", "problem.toml", "--quiet"]).expect(0);
    let pipe = folder.run_with_input(&["filter", "problem.toml", "--quiet", "--data", "-"], folder.read("log.csv"));
    assert_eq!(pipe.expect(0).stdout, file.stdout);
}

#[test]
fn a_reader_that_leaves_early_is_no_error() {
    let folder = Folder::with_level();
    folder.write("log.csv", crate::command::level_log(20_000));
    let mut child = folder.spawn(&["filter", "problem.toml", "--quiet"]);
    drop(child.stdout.take());
    let finished = crate::command::Finished::from(child.wait_with_output().unwrap()).expect(0);
    assert_eq!(finished.stderr, "");
}

#[test]
fn a_table_cannot_be_written_over_a_folder() {
    let message = Folder::with_level().run(&["filter", "problem.toml", "--out", "."]).refusal();
    assert!(message.contains("folder"), "{message}");
}

#[test]
fn a_drafted_problem_runs() {
    let folder = Folder::with_level();
    let text = folder.run(&["init", "log.csv"]).expect(0).stdout;
    folder.run(&["init", "log.csv", "--out", "new.toml"]).expect(0);
    assert_eq!(folder.read("new.toml").trim_end(), text.trim_end());
    folder.run(&["tune", "new.toml", "--population", "8", "--generations", "2"]).expect(0);

    let message = folder.run(&["init", "log.csv", "--out", "new.toml"]).refusal();
    assert!(message.contains("--force"), "{message}");
    folder.run(&["init", "log.csv", "--out", "new.toml", "--force"]).expect(0);
    let message = folder.run(&["init", "nowhere.csv"]).refusal();
    assert!(message.contains("nowhere.csv"), "{message}");
}

#[test]
fn a_simulated_log_has_a_seed() {
    let folder = Folder::with_level();
    let simulated = folder.read("problem.toml").replace("file = \"log.csv\"\n", "")
        + "\n[simulate]\nsteps = 30\ndt = 1.0\nparameters = { q = 0.5, r = 4.0 }\nx0 = [3]\nseed = 1\n";
    folder.write("sim.toml", simulated);
    let one = folder.run(&["simulate", "sim.toml"]).expect(0).stdout;
    assert_eq!(one.lines().count(), 32, "{one}");
    assert_eq!(folder.run(&["simulate", "sim.toml", "--seed", "1"]).expect(0).stdout, one);
    assert_ne!(folder.run(&["simulate", "sim.toml", "--seed", "2"]).expect(0).stdout, one);
    folder.run(&["simulate", "sim.toml", "--out", "sim.csv"]).expect(0);
    assert_eq!(folder.read("sim.csv"), one);
    let message = folder.run(&["simulate", "problem.toml"]).refusal();
    assert!(message.contains("simulate"), "{message}");
}

#[test]
fn smoothed_columns_stand_beside_the_filters() {
    let folder = Folder::with_level();
    folder.write("log.csv", "t,z\n0,1\n1,\n2.5,3\n");
    let plain = folder.run(&["filter", "problem.toml", "--quiet"]).expect(0).table();
    let table = folder.run(&["filter", "problem.toml", "--quiet", "--smooth"]).expect(0).table();
    assert_eq!(table[0], ["t", "x", "P_x_x", "nu_z", "S_z", "nis", "x_smoothed", "P_x_x_smoothed"]);
    assert!(plain.iter().zip(&table).all(|(plain, with)| plain[..] == with[..6]), "what was there stays: {table:?}");
    let cell = |row: usize, column: usize| table[row][column].parse::<f64>().unwrap();
    assert_eq!((cell(3, 6), cell(3, 7)), (cell(3, 1), cell(3, 2)), "nothing follows the last row");
    // By hand: row 1 has P = P0 R / (P0 + R) + q, and is seen once more, through q + R.
    let (p, seen) = (cell(2, 2), 1.0 + 50.0);
    assert!((cell(2, 7) - p * seen / (p + seen)).abs() < 1e-11, "{table:?}");
    assert!((cell(2, 6) - (cell(2, 1) + p / (p + seen) * (3.0 - cell(2, 1)))).abs() < 1e-12, "{table:?}");
}

/// Trajectories start at their first complete measurement.
#[test]
fn smoothing_follows_trajectories_that_start_late() {
    let folder = Folder::with_level();
    let several = folder
        .read("problem.toml")
        .replace("time = \"t\"", "time = \"t\"\ntrajectory = \"id\"")
        .replace("x0 = [0]", "x0 = \"measurement\"");
    folder.write("problem.toml", several);
    folder.write("log.csv", "id,t,z\na,0,1\nb,0,\na,1,2\nb,1,5\na,2,4\nb,2,6\nb,3,9\n");
    let table = folder.run(&["filter", "problem.toml", "--quiet", "--smooth", "--diagonal"]).expect(0).table();
    assert_eq!(table.len(), 1 + 3 + 3, "three rows of a, three of b: {table:?}");
    assert!(table.iter().flatten().filter(|cell| cell.is_empty()).count() == 6, "only the starts' nu, S and nis");
    for (row, last) in [(3, true), (4, false), (6, true)] {
        assert_eq!(table[row][2] == table[row][7], last, "the last row of a trajectory is not moved: {table:?}");
    }
}

#[test]
fn the_summary_compares_filter_and_smoother_with_truth() {
    let folder = Folder::with_level();
    let simulated = folder
        .read("problem.toml")
        .replace("file = \"log.csv\"\n", "")
        .replace("measurements = [\"z\"]", "measurements = [\"z\"]\ntruth = { x = \"x\" }")
        .replace("start = 1,", "start = 0.5,")
        .replace("start = 50", "start = 4")
        + "\n[simulate]\nsteps = 300\ndt = 1.0\nx0 = [3]\nseed = 1\n";
    folder.write("sim.toml", simulated);
    let json = folder.run(&["filter", "sim.toml", "--json", "--smooth"]).expect(0).json();
    let rmse = |of: &str| json["rmse"][of]["x"].as_f64().unwrap();
    // In the long run: P = (sqrt(q^2 + 4 q r) - q) / 2, and half as large again is what the future halves.
    assert!(rmse("smoother") < 0.9 * rmse("filter"), "{json}");
    let finished = folder.run(&["filter", "sim.toml", "--smooth"]).expect(0);
    assert!(
        finished.stderr.contains("rmse of x: filter ") && finished.stderr.contains(", smoother "),
        "{}",
        finished.stderr
    );
    let json = folder.run(&["filter", "sim.toml", "--json"]).expect(0).json();
    assert!(json["rmse"]["filter"]["x"].is_f64() && json["rmse"]["smoother"].is_null(), "{json}");
}

/// The 17th row is an outlier: the table says what is left out of it, the summary how many such rows there are.
#[test]
fn a_robust_filter_says_what_it_rejects() {
    let folder = Folder::with_level();
    let mut log = "t,z\n".to_owned();
    (0..60).for_each(|k| log += &format!("{k},{}\n", if k == 16 { 900.0 } else { f64::from(k % 5) }));
    folder.write("log.csv", &log);
    let text = folder.read("problem.toml");
    folder.write("problem.toml", format!("{text}\n[filter]\nrobust = \"gate\"\n"));
    let finished = folder.run(&["filter", "problem.toml", "--smooth"]).expect(0);
    let table = finished.table();
    assert_eq!(table[0], ["t", "x", "P_x_x", "nu_z", "S_z", "nis", "rejected", "x_smoothed", "P_x_x_smoothed"]);
    assert_eq!((table[16][6].as_str(), table[17][6].as_str()), ("0", "1"));
    assert_eq!(table[17][1], table[16][1], "the estimate stays where it is");
    let said = "rejected 1.67 % of the measured rows; 1 of 60 counted less than half, and are not in these tests";
    let words = finished.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains(said), "{}", finished.stderr);
    let json = folder.run(&["filter", "problem.toml", "--json", "--quiet"]).expect(0).json();
    assert_eq!(json["consistency"]["rejected"]["rows"], 1, "{json}");
}
