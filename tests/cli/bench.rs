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
fn the_share_of_a_given_limit_is_told() {
    let arguments = ["bench", "--n", "64", "--t", "50", "--repetitions", "1", "--device", "cpu", "--json"];
    let json = Folder::new().run(&[&arguments[..], &["--peak-gflops", "50"]].concat()).expect(0).json();
    let (share, gflops) = (json["share_of_peak"].as_f64().unwrap(), json["gflops"].as_f64().unwrap());
    assert!((share - gflops / 50.0).abs() < 1e-12, "{json}");
    let flops = json["flops_per_step"].as_f64().unwrap() * json["steps_per_s"].as_f64().unwrap();
    assert!((gflops / (flops * 1e-9) - 1.0).abs() < 1e-9, "{json}");
}

#[test]
fn a_comparison_is_one_json_object_with_a_list() {
    let arguments = ["bench", "--n", "64", "--t", "50", "--repetitions", "1", "--threads", "2", "--json", "--quiet"];
    let json = Folder::new().run(&arguments).expect(0).json();
    let measured = json["measurements"].as_array().unwrap();
    let on_cpu: Vec<&str> =
        measured.iter().filter(|m| m["device"] == "cpu").map(|m| m["dtype"].as_str().unwrap()).collect();
    assert_eq!(on_cpu, ["f64", "f32"], "{json}");
    // Only hardware may be measured unasked.
    assert!(measured.iter().all(|m| m["device"] == "cpu" || m["device"] == "gpu"), "{json}");
    assert_eq!((&json["N"], &json["T"]), (&64.into(), &50.into()), "{json}");
}

#[test]
fn wrong_use() {
    let folder = Folder::with_level();
    for arguments in [
        &["bench", "--workload", "D"][..],
        &["bench", "--n", "0"],
        &["bench", "--budget", "-1"],
        &["bench", "problem.toml", "--workload", "A"],
        &["bench", "--device", "gpu", "--adapter", "no such adapter"],
        &["bench", "--adapter", "no such adapter"],
        &["bench", "--device", "cpu", "--adapter", "llvmpipe"],
        &["bench", "--device", "cpu", "--software"],
        &["bench", "--device", "gpu", "--threads", "2"],
        &["bench", "--peak-gflops", "100"],
        &["bench", "--device", "cpu", "--peak-gflops", "0"],
        &["bench", "--device", "tpu"],
    ] {
        let finished = folder.run(arguments).expect(2);
        assert_eq!(finished.stdout, "", "{arguments:?}");
        assert!(finished.stderr.starts_with("error: "), "{arguments:?}: {}", finished.stderr);
    }
}
