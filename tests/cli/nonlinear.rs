//! Verbs on a model whose f and h are no matrices.

use crate::command::Folder;

/// A turning target in range and bearing, as it is drawn and filtered.
fn turning() -> Folder {
    let folder = Folder::new();
    let text = include_str!("../data/nonlinear/ct.toml").replace("ct_range_bearing.csv", "log.csv");
    let simulate = "[simulate]\nsteps = 200\ndt = 1\nseed = 3\nx0 = [-2000, 0, 30, 5, 0.05]\n";
    let start = text.replace("[1010, 990, 295, 5, -0.045]", "[-2000, 10, 31, 4, 0.04]");
    folder.write("problem.toml", format!("{start}\n{simulate}"));
    folder
}

#[test]
fn it_is_simulated_filtered_smoothed_and_checked() {
    let folder = turning();
    folder.run(&["simulate", "problem.toml", "--out", "log.csv"]).expect(0);
    for kind in ["extended", "iterated", "unscented", "cubature"] {
        let text = String::from_utf8(std::fs::read(folder.path("problem.toml")).unwrap()).unwrap();
        folder.write("other.toml", text.replace("kind = \"extended\"", &format!("kind = \"{kind}\"")));
        let finished =
            folder.run(&["filter", "other.toml", "--smooth", "--out", "states.csv", "--force", "--json"]).expect(0);
        let json = finished.json();
        let of = |run: &str, state: &str| json["rmse"][run][state].as_f64().unwrap();
        assert!(of("smoother", "x") < of("filter", "x") && of("filter", "w") < 0.1, "{kind}: {json}");
        assert_eq!(folder.read("states.csv").lines().count(), 202, "{kind}");
        folder.run(&["check", "other.toml"]).expect(0);
    }
}

#[test]
fn errors_of_an_angle_are_taken_modulo_a_turn() {
    let folder = Folder::new();
    let text =
        include_str!("../data/nonlinear/plaza2.toml").replace("../../../examples/data/plaza2_uwb.csv", "log.csv");
    folder.write("problem.toml", text);
    folder.write("log.csv", include_str!("../../examples/data/plaza2_uwb.csv"));
    let json = folder.run(&["filter", "problem.toml", "--json", "--quiet"]).expect(0).json();
    let heading = json["rmse"]["filter"]["heading"].as_f64().unwrap();
    assert!(heading < 0.2, "rmse of the heading {heading} rad");
}

/// A tuned extended filter of the growth model: its Q and R are wide, and still another filter is more likely with them.
#[test]
fn a_study_tells_what_linearising_costs() {
    let folder = Folder::new();
    folder.write("problem.toml", include_str!("../data/nonlinear/growth.toml"));
    folder.write("growth.csv", include_str!("../data/nonlinear/growth.csv"));
    let short = ["--generations", "5", "--population", "20", "--quiet", "--out", "tuned"];
    let text = folder.run(&[&["tune", "problem.toml"][..], &short].concat()).expect(0).stdout;
    let page = folder.read("tuned/report.md");
    let sentence = "With the tuned parameters, on the rows tuned on: ";
    assert!(text.contains(sentence) && page.contains(sentence) && page.contains("extended (own)"), "{text}");
    let json: serde_json::Value = serde_json::from_str(&folder.read("tuned/result.json")).unwrap();
    let filters = json["linearity"]["filters"].as_array().unwrap();
    assert_eq!(filters.len(), 2, "its own and one with sigma points: {json}");
    assert!(json["linearity"]["verdict"]["linearising"].is_string(), "{json}");
    let hidden = "; Q and R were tuned for the extended filter, which may hide what linearising costs";
    assert!(text.contains(hidden), "the tuned filter looks consistent, with a NEES of 300: {text}");
}
