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
    let finished = folder
        .run(&["bench", "problem.toml", "--n", "32", "--repetitions", "1", "--device", "cpu", "--quiet"])
        .expect(0);
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
        &["bench", "--n", "99999999999"],
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

/// Name and kind of the adapter to measure: the first. `KFGPU_TEST_GPU` as in tests/gpu.
#[cfg(feature = "gpu")]
fn adapter() -> Option<kfgpu::evaluate::gpu::AdapterInfo> {
    use std::io::Write as _;
    let policy = std::env::var("KFGPU_TEST_GPU").unwrap_or_default();
    let found = kfgpu::evaluate::gpu::adapters().into_iter().next().filter(|_| policy != "off");
    assert!(found.is_some() || policy != "require", "KFGPU_TEST_GPU=require and there is no adapter");
    if found.is_none() {
        let _ = writeln!(std::io::stderr(), "SKIPPED, no GPU adapter to measure");
    }
    found
}

#[cfg(feature = "gpu")]
#[test]
fn an_adapter_is_measured_kernels_and_end_to_end_apart() {
    let Some(adapter) = adapter() else { return };
    let folder = Folder::new();
    let measure = |more: &[&str]| {
        let arguments = ["bench", "--workload", "B", "--n", "70", "--t", "100", "--precision", "f32", "--json"];
        folder.run(&[&arguments[..], more].concat()).expect(0).json()
    };
    let json = measure(&["--device", "gpu", "--adapter", &adapter.name]);
    assert_eq!(json["device"], if adapter.is_software() { "software adapter" } else { "gpu" }, "{json}");
    assert!(json["isa"].as_str().unwrap().starts_with(&adapter.name) && json["threads"].is_null(), "{json}");
    let number = |field: &str| json[field].as_f64();
    if adapter.timestamps {
        let (kernel, rate) = (number("kernel_s").unwrap(), number("kernel_steps_per_s").unwrap());
        assert!(kernel > 0.0 && kernel < number("median_s").unwrap(), "kernels are a part of the whole: {json}");
        assert!((rate * kernel / 7000.0 - 1.0).abs() < 1e-9, "{json}");
    }
    let built = number("kernel_build_s").unwrap();
    assert!(built > 0.0 && built < number("compile_s").unwrap(), "building the kernel is a part of preparing: {json}");
    let on_cpu = measure(&["--device", "cpu"]);
    for cost in ["check", "check_mse", "check_nis", "mean_ll"] {
        let (found, expected) = (number(cost).unwrap(), on_cpu[cost].as_f64().unwrap());
        assert!((found / expected - 1.0).abs() < 1e-5, "{cost}: {found} on the adapter, {expected} on the CPU");
    }
    assert_eq!((json["failed"].as_u64(), number("flops_per_step")), (Some(0), on_cpu["flops_per_step"].as_f64()));
}

#[cfg(feature = "gpu")]
#[test]
fn a_named_adapter_is_compared_with_the_cpu() {
    let Some(adapter) = adapter() else { return };
    let common = ["bench", "--n", "100", "--t", "40", "--threads", "2", "--precision", "f32", "--repetitions", "1"];
    let folder = Folder::new();
    let run = |more: &[&str]| folder.run(&[&common[..], &["--adapter", &adapter.name], more].concat()).expect(0);
    let json = run(&["--json"]).json();
    let label = if adapter.is_software() { "software adapter" } else { "gpu" };
    let devices: Vec<_> = json["measurements"].as_array().unwrap().iter().map(|m| m["device"].clone()).collect();
    assert_eq!(devices, ["cpu", label], "{json}");
    let crossover = &json["crossover"][0];
    let sizes: Vec<_> =
        crossover["ladder"].as_array().unwrap().iter().map(|rung| rung["N"].as_u64().unwrap()).collect();
    assert_eq!((&crossover["adapter"], sizes), (&adapter.name.as_str().into(), vec![64, 100]), "{json}");
    let table = run(&[]).stdout;
    assert!(table.contains(&format!("\n  {label} ")) && table.contains("crossover: "), "{table}");
    assert!(!adapter.is_software() || !table.contains("gpu"), "software is never called a GPU: {table}");
}
