//! `--device`, `--adapter`, `--precision`, and the verbs `devices` and `shader`.

use std::io::Write as _;

use serde_json::Value;

use crate::command::Folder;
use crate::tune::without_times;

/// What `devices --json` says.
fn devices(folder: &Folder) -> Value {
    folder.run(&["devices", "--json"]).expect(0).json()
}

/// The adapter to test on; `KFGPU_TEST_GPU` as in tests/gpu.
pub(crate) fn adapter(folder: &Folder) -> Option<String> {
    let policy = std::env::var("KFGPU_TEST_GPU").unwrap_or_default();
    let name = devices(folder)["adapters"][0]["name"].as_str().map(str::to_owned).filter(|_| policy != "off");
    assert!(name.is_some() || policy != "require", "KFGPU_TEST_GPU=require and there is no adapter");
    if name.is_none() {
        let _ = writeln!(std::io::stderr(), "SKIPPED, no GPU adapter to test on");
    }
    name
}

#[cfg(feature = "gpu")]
#[test]
fn devices_names_adapters_and_what_auto_takes() {
    let folder = Folder::new();
    let json = devices(&folder);
    let text = folder.run(&["devices"]).expect(0).stdout;
    assert!(text.contains("--device auto takes "), "{text}");
    for adapter in json["adapters"].as_array().unwrap() {
        assert!(text.contains(adapter["name"].as_str().unwrap()), "{text}");
        assert!(adapter["max_binding"].as_u64().unwrap() >= 1 << 20, "{adapter}");
    }
    let auto = &json["auto"];
    let is_real = |a: &&Value| a["kind"] != "software";
    let real = json["adapters"].as_array().unwrap().iter().find(is_real).map_or(&Value::Null, |a| &a["name"]);
    assert_eq!(&auto["adapter"], real, "never a software renderer");
    assert!(auto["operations"].as_f64().unwrap() > 1e9 && !auto["why"].as_str().unwrap().is_empty(), "{auto}");
}

/// Our functions keep their digits on the adapter, and what it has of its own stands beside them.
#[cfg(feature = "gpu")]
#[test]
fn devices_measures_functions() {
    let folder = Folder::new();
    if adapter(&folder).is_none() {
        return;
    }
    let json = folder.run(&["devices", "--accuracy", "--json"]).expect(0).json();
    let text = folder.run(&["devices", "--accuracy"]).expect(0).stdout;
    for adapter in json.as_array().unwrap() {
        assert!(text.contains(adapter["adapter"].as_str().unwrap()), "{text}");
        for row in adapter["functions"].as_array().unwrap() {
            let error = row["kfgpu"]["absolute"].as_f64().unwrap();
            assert!(error < 1e-5, "{row}");
            assert!(text.contains(row["function"].as_str().unwrap()), "{text}");
        }
    }
}

/// Mesa's layer that orders adapters says so where there is no desktop, and nothing of it is an error of ours.
#[cfg(feature = "gpu")]
#[test]
fn a_machine_without_a_desktop_is_no_error() {
    let folder = Folder::with_level();
    for directory in [None, Some("/no/such/folder")] {
        let run = |arguments: &[&str]| {
            let mut command = folder.command(arguments);
            command
                .env_remove("XDG_RUNTIME_DIR")
                .env_remove("NODEVICE_SELECT")
                .envs(directory.map(|d| ("XDG_RUNTIME_DIR", d)));
            crate::command::Finished::from(command.output().unwrap())
        };
        assert_eq!(run(&["devices"]).expect(0).stderr, "");
        let Some(name) = adapter(&folder) else { continue };
        let tune = ["tune", "problem.toml", "--quiet", "--generations", "1", "--adapter", &name];
        assert_eq!(run(&tune).expect(0).stderr, "");
        // Whatever else is said comes through.
        let refused = run(&["tune", "problem.toml", "--adapter", "no such adapter"]).expect(2);
        assert!(refused.stderr.contains("error: ") && !refused.stderr.contains("XDG"), "{}", refused.stderr);
    }
}

#[cfg(feature = "gpu")]
#[test]
fn shader_prints_the_kernel() {
    let folder = Folder::with_level();
    let single = folder.run(&["shader", "problem.toml"]).expect(0).stdout;
    assert!(single.contains("alias Real = f32;") && single.contains("fn main("), "{single}");
    assert!(!single.lines().any(|line| line.trim_start().starts_with("//#")), "everything is filled in: {single}");
    let double = folder.run(&["shader", "problem.toml", "--precision", "f64"]).expect(0).stdout;
    assert!(double.contains("alias Real = f64;"), "{double}");
    folder.run(&["shader", "nowhere.toml"]).refusal();
}

#[cfg(not(feature = "gpu"))]
#[test]
fn without_the_feature_it_says_so() {
    let folder = Folder::with_level();
    let tune = ["tune", "problem.toml", "--device", "gpu"];
    let named = ["tune", "problem.toml", "--adapter", "any"];
    for arguments in [&tune[..], &named] {
        let message = folder.run(arguments).refusal();
        assert!(message.contains("built without"), "{arguments:?}: {message}");
    }
    let json = folder.run(&["tune", "problem.toml", "--json"]).expect(0).json();
    assert_eq!(json["device"]["backend"], "cpu");
}

#[test]
fn a_small_job_stays_on_the_cpu_in_f64() {
    let folder = Folder::with_level();
    let json = folder.run(&["tune", "problem.toml", "--json"]).expect(0).json();
    assert_eq!((&json["device"]["backend"], &json["device"]["precision"]), (&"cpu".into(), &"f64".into()));
}

#[cfg(feature = "gpu")]
#[test]
fn a_large_job_takes_real_hardware_only() {
    let folder = Folder::with_level();
    let arguments =
        ["tune", "problem.toml", "--json", "--population", "2000", "--generations", "1000000", "--wall-time", "0.2"];
    let finished = folder.run(&arguments).expect(0);
    let expected = if devices(&folder)["auto"]["adapter"].is_null() { ("cpu", "f64") } else { ("gpu", "f32") };
    let device = &finished.json()["device"];
    assert_eq!((&device["backend"], &device["precision"]), (&expected.0.into(), &expected.1.into()));
    // A slow machine may be warned that the time was over before the local search was done.
    let devices = |line: &str| line.starts_with("warning") && (line.contains("GPU") || line.contains("adapter"));
    assert!(!finished.stderr.lines().any(devices), "nobody asked for a GPU: {}", finished.stderr);
}

#[test]
fn an_adapter_and_the_cpu_contradict_each_other() {
    let message = Folder::with_level().run(&["tune", "problem.toml", "--device", "cpu", "--adapter", "x"]).refusal();
    assert!(message.contains("--adapter") && message.contains("--device cpu"), "{message}");
}

#[cfg(feature = "gpu")]
#[test]
fn an_unknown_adapter_is_answered_with_those_there_are() {
    let folder = Folder::with_level();
    folder.write("c.csv", "q,r\n1,50\n");
    let known = devices(&folder)["adapters"][0]["name"].as_str().map(str::to_owned);
    for verb in [&["tune", "problem.toml"][..], &["evaluate", "problem.toml", "c.csv"]] {
        let message = folder.run(&[verb, &["--adapter", "no such card"]].concat()).refusal();
        let expected = known.as_deref().map_or("no GPU adapter", |name| name);
        assert!(message.contains(expected), "{message}");
    }
}

/// The Vulkan loader finds no driver, as on a machine without one.
#[cfg(all(feature = "gpu", target_os = "linux"))]
fn without_driver(folder: &Folder, arguments: &[&str]) -> crate::command::Finished {
    let mut command = folder.command(arguments);
    command.env("VK_ICD_FILENAMES", "/nonexistent").env("VK_DRIVER_FILES", "/nonexistent");
    command.output().unwrap().into()
}

#[cfg(all(feature = "gpu", target_os = "linux"))]
#[test]
fn a_search_of_a_gpu_is_resumed_on_it_or_on_the_cpu_in_f32() {
    let folder = Folder::with_level();
    let Some(name) = adapter(&folder) else { return };
    let begin = ["tune", "problem.toml", "--json", "--out", "out", "--adapter", &name];
    let whole = without_times(folder.run(&begin).expect(0).json());
    folder.run(&[&begin[..], &["--evaluations", "50"]].concat()).expect(0);
    let saved = std::fs::read(folder.path("out/checkpoint.kfgpu")).unwrap();
    let resume = ["tune", "problem.toml", "--json", "--resume", "out"];
    let same = folder.run(&resume).expect(0);
    assert_eq!(without_times(same.json()), whole, "the same adapter is found again, and gives the same bits");
    assert!(!same.stderr.contains("going on"), "{}", same.stderr);

    folder.write("out/checkpoint.kfgpu", &saved);
    let gone = without_driver(&folder, &resume).expect(0);
    let said = format!("warning: the search ran on the GPU ({name} (");
    assert_eq!(gone.stderr.matches(&said).count(), 1, "{}", gone.stderr);
    let json = gone.json();
    assert!(json["warnings"].to_string().contains("going on in f32 on the CPU ("), "{json}");
    assert_eq!((&json["device"]["backend"], &json["device"]["precision"]), (&"cpu".into(), &"f32".into()));
    assert_eq!(json["evaluations"], whole["evaluations"]);
    folder.write("out/checkpoint.kfgpu", &saved);
    let asked = folder.run(&[&resume[..], &["--device", "cpu"]].concat()).expect(0).json();
    assert_eq!(without_times(asked)["parameters"], json["parameters"], "gone or left out, the CPU is the same");
}

#[cfg(all(feature = "gpu", target_os = "linux"))]
#[test]
fn a_gpu_asked_for_where_there_is_none_is_an_error() {
    let folder = Folder::with_level();
    let run = |arguments: &[&str]| without_driver(&folder, arguments);
    let message = run(&["tune", "problem.toml", "--device", "gpu"]).refusal();
    assert!(message.starts_with("no GPU adapter") && message.contains("--device cpu"), "{message}");
    let text = run(&["devices"]).expect(0).stdout;
    assert!(text.contains("no adapter") && text.contains("auto takes the CPU"), "{text}");
}

#[test]
fn on_an_adapter_by_name_reports_say_so() {
    let folder = Folder::with_level();
    if cfg!(not(feature = "gpu")) {
        return;
    }
    let Some(name) = adapter(&folder) else { return };
    for (precision, expected) in [("auto", "f32"), ("f32", "f32")] {
        let arguments = ["tune", "problem.toml", "--json", "--adapter", &name, "--precision", precision];
        let finished = folder.run(&arguments).expect(0);
        let (json, stderr) = (finished.json(), &finished.stderr);
        assert_eq!((&json["device"]["backend"], &json["device"]["precision"]), (&"gpu".into(), &expected.into()));
        assert!(json["device"]["adapter"].as_str().unwrap().contains(&name), "{json}");
        assert!(!stderr.contains("warning"), "{stderr}");
        assert!(json["certificate"]["largest_relative_gap"].as_f64().unwrap() < 1e-5, "{}", json["certificate"]);
    }
    folder.write("c.csv", "q,r\n1,50\n-1,-1e9\n2,80\n");
    let json = folder.run(&["evaluate", "problem.toml", "c.csv", "--json", "--adapter", &name]).expect(0).json();
    assert_eq!(json["device"]["backend"], "gpu");
    assert_eq!(json["status"][0], 0);
    assert_ne!(json["status"][1], 0, "the second has no covariance");
}

/// An hour without measurements in the sight of a hand-held tracker, whose third state goes on as `f`: single precision
/// cannot hold that.
fn blackout(f: &str) -> Folder {
    let folder = Folder::with_level();
    let problem = format!(
        r#"[data]
file = "log.csv"
time = "t"
measurements = ["z"]
[model]
state = ["x", "v", "a"]
f = ["x + v*dt + 0.5*a*dt^2", "v + a*dt", "{f}"]
h = ["x"]
Q = [["q*dt^5/20", "q*dt^4/8", "q*dt^3/6"], ["q*dt^4/8", "q*dt^3/3", "q*dt^2/2"], ["q*dt^3/6", "q*dt^2/2", "q*dt"]]
R = ["r"]
x0 = [0, 0, 0]
P0 = [0.01, 1, 10]
[parameters]
q = {{ min = 0.1, max = 1000, scale = "log", start = 10 }}
r = {{ min = 1e-6, max = 1e-2, scale = "log", start = 1e-4 }}
[tune]
population = 8
generations = 2
"#
    );
    folder.write("problem.toml", problem);
    let time = |k: i32| 0.01 * f64::from(k + k / 3) + if k < 40 { 0.0 } else { 3600.0 };
    let rows = (0..80).map(|k| format!("{},{}\n", time(k), 0.003 * f64::from(k * k % 7 - 3)));
    folder.write("log.csv", format!("t,z\n{}", rows.collect::<String>()));
    folder
}

#[test]
fn what_needs_f64_is_computed_in_f64() {
    let folder = blackout("a");
    if cfg!(not(feature = "gpu")) {
        return;
    }
    let Some(name) = adapter(&folder) else { return };
    let finished = folder.run(&["tune", "problem.toml", "--json", "--adapter", &name]).expect(0);
    let (json, stderr) = (finished.json(), &finished.stderr);
    assert_eq!(json["device"]["precision"], "f64");
    let has_f64 = devices(&folder)["adapters"][0]["f64"].as_bool().unwrap();
    assert_eq!(json["device"]["backend"], if has_f64 { "gpu" } else { "cpu" });
    assert_eq!(stderr.contains("has no f64"), !has_f64, "{stderr}");
    let message = folder.run(&["tune", "problem.toml", "--adapter", &name, "--precision", "f32"]).refusal();
    assert!(message.contains("use --precision f64"), "{message}");
}

#[test]
fn what_a_gpu_cannot_compute_goes_to_the_cpu_and_is_said() {
    let folder = blackout("a*exp(-1e-9*r*dt)");
    if cfg!(not(feature = "gpu")) {
        return;
    }
    let Some(name) = adapter(&folder) else { return };
    let finished = folder.run(&["tune", "problem.toml", "--json", "--adapter", &name]).expect(0);
    let (json, stderr) = (finished.json(), &finished.stderr);
    assert_eq!((&json["device"]["backend"], &json["device"]["precision"]), (&"cpu".into(), &"f64".into()));
    let said = |text: &str| text.matches("computing on the CPU in f64").count();
    assert_eq!(said(stderr), 1, "once: {stderr}");
    assert_eq!(said(&json["warnings"].to_string()), 1, "and in the report: {}", json["warnings"]);
}
