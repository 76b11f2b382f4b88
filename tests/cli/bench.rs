//! `kfgpu bench`.

use crate::command::Folder;

#[test]
fn one_json_line_with_the_harness_fields() {
    let arguments = ["bench", "--workload", "A", "--n", "64", "--t", "50", "--repetitions", "2", "--threads", "1"];
    let more = ["--precision", "f32", "--device", "cpu", "--json"];
    let json = Folder::new().run(&[&arguments[..], &more].concat()).expect(0).json();
    assert_eq!(json["workload"], "A");
    assert_eq!(json["dtype"], "f32");
    assert_eq!((&json["N"], &json["T"], &json["reps"]), (&64.into(), &50.into(), &2.into()));
    for field in ["peer", "median_s", "min_s", "steps_per_s", "compile_s", "check", "check_mse", "check_nis", "mean_ll"]
    {
        assert!(!json[field].is_null(), "{field} in {json}");
    }
    let (rate, time) = (json["steps_per_s"].as_f64().unwrap(), json["median_s"].as_f64().unwrap());
    assert!((rate * time / 3200.0 - 1.0).abs() < 0.01, "steps per second times seconds are the steps: {json}");
}

#[test]
fn a_problem_file_is_measured_too() {
    let folder = Folder::with_level();
    let finished = folder.run(&["bench", "problem.toml", "--n", "32", "--repetitions", "1", "--quiet"]).expect(0);
    assert!(finished.stdout.contains("filter-steps/s"), "{}", finished.stdout);
    assert_eq!(finished.stderr, "");
}

#[test]
fn wrong_use() {
    let folder = Folder::with_level();
    for arguments in [
        &["bench", "--workload", "D"][..],
        &["bench", "--n", "0"],
        &["bench", "--n", "99999999999"],
        &["bench", "--budget", "-1"],
        &["bench", "problem.toml", "--workload", "A"],
        &["bench", "--device", "gpu"],
    ] {
        let finished = folder.run(arguments).expect(2);
        assert_eq!(finished.stdout, "", "{arguments:?}");
        assert!(finished.stderr.starts_with("error: "), "{arguments:?}: {}", finished.stderr);
    }
}
