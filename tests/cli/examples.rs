//! The shipped examples, with the values they are known for.

use serde_json::Value;

use crate::command::Folder;

fn tune(example: &str, more: &[&str]) -> Value {
    let path = format!("{}/examples/{example}.toml", env!("CARGO_MANIFEST_DIR"));
    let arguments = [&["tune", path.as_str(), "--json", "--quiet"], more].concat();
    Folder::new().run(&arguments).expect(0).json()
}

/// The optimum of this form: sigma2_eps = 15099.687, sigma2_eta = 1468.501, nll = 641.5855783461.
#[test]
fn nile_is_solved_by_pso_and_by_pio() {
    for algorithm in ["pso", "pio+"] {
        let json = tune("nile", &["--algorithm", algorithm]);
        let nll = json["objectives"]["nll"].as_f64().unwrap();
        assert!((641.585_578..=641.585_68).contains(&nll), "{algorithm}: {nll}");
        for (name, optimum) in [("sigma2_eps", 15_099.687), ("sigma2_eta", 1468.501)] {
            let value = json["parameters"][name].as_f64().unwrap();
            assert!((value / optimum - 1.0).abs() < 0.01, "{algorithm}: {name} = {value}");
        }
        assert_eq!(json["consistency"]["verdict"], "consistent", "{algorithm}");
        assert_eq!(json["certificate"]["order_held"], true, "{algorithm}");
    }
}

/// Mean NIS of 1 and yet no good filter: the noise is not white and r runs to its bound.
#[test]
fn gps_track_is_not_called_consistent() {
    let json = tune("uav_gps_cv", &[]);
    let consistency = &json["consistency"];
    assert!((consistency["nis_mean"].as_f64().unwrap() - 1.0).abs() < 0.05, "{consistency}");
    assert_ne!(consistency["verdict"], "consistent");
    assert_eq!(json["at_bound"]["r"], "lower", "{json}");
    let lag_1 = consistency["whiteness"][0]["autocorrelation"][0].as_f64().unwrap();
    assert!((lag_1 - 0.74).abs() < 0.02, "{lag_1}");
}

/// Constant acceleration on the same log: 470 nats better, r inside its bounds, and still not white.
#[test]
fn acceleration_stands_beside_velocity_in_the_readme() {
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let row = |filter: &str| readme.lines().find(|line| line.starts_with(&format!("| {filter} |"))).unwrap();
    for (example, filter) in [("uav_gps_cv", "constant velocity"), ("uav_gps_ca", "constant acceleration")] {
        let json = tune(example, &[]);
        let consistency = &json["consistency"];
        let mut shown = vec![
            format!("{:.2}", json["objectives"]["nll"].as_f64().unwrap()),
            format!("{:.3}", consistency["nis_mean"].as_f64().unwrap()),
            consistency["verdict"].as_str().unwrap().replace('_', " "),
        ];
        let lag_1 = |axis: &Value| format!("{:+.3}", axis["autocorrelation"][0].as_f64().unwrap());
        shown.extend(consistency["whiteness"].as_array().unwrap().iter().map(lag_1));
        for figure in shown {
            assert!(row(filter).contains(&figure), "{filter}: {figure} is not in the README's row {}", row(filter));
        }
        assert_eq!(row(filter).contains("bound"), json["at_bound"]["r"].is_string(), "{filter}: {json}");
    }
}

/// Tuned for position it gains at most 0.5 % over the raw measurements, wherever the search starts.
#[test]
fn camera_track_gains_little_and_three_seeds_agree() {
    let costs = ["1", "2", "3"].map(|seed| {
        let json = tune("tum_fr2_desk", &["--seed", seed, "--generations", "20", "--precision", "f32"]);
        let raw = json["raw_measurements"]["rmse"].as_f64().unwrap();
        assert!((raw - 0.00812).abs() < 5e-6, "{raw}");
        let tuned = json["objectives"]["rmse"].as_f64().unwrap();
        assert!(tuned < raw && tuned > 0.995 * raw, "{tuned} {raw}");
        tuned
    });
    assert!(costs.iter().all(|cost| (cost / costs[0] - 1.0).abs() < 1e-5), "{costs:?}");
}

#[test]
fn simulated_examples_are_tuned_and_drawn_alike() {
    let json = tune("rocket", &[]);
    assert_eq!(json["simulated_with"]["r"], 3.0);
    let r = json["parameters"]["r"].as_f64().unwrap();
    // 200 measurements: the standard deviation of a variance is a tenth of it.
    assert!((r / 3.0 - 1.0).abs() < 0.3, "{r}");
    let json = tune("refuelling", &["--generations", "20"]);
    assert!(json["objectives"]["distance"].as_f64() < json["baseline"]["objectives"]["distance"].as_f64(), "{json}");
}

#[test]
fn every_example_runs_its_filter() {
    let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/examples")).unwrap();
    let files = folder.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == "toml"));
    for file in files {
        let finished = Folder::new().run(&["filter", file.to_str().unwrap(), "--quiet"]).expect(0);
        assert!(finished.stdout.lines().count() > 2, "{}", file.display());
    }
}
