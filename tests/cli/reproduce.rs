//! `kfgpu reproduce`.

use crate::command::Folder;

#[test]
fn an_unknown_study_is_refused_with_the_nearest() {
    let folder = Folder::new();
    let error = folder.run(&["reproduce", "kf-pie", "--out", "results"]).refusal();
    assert!(error.contains("unknown study \"kf-pie\" (did you mean \"kf-pio\"?)"), "{error}");
    assert!(error.contains("or all"), "{error}");
    assert!(!folder.path("results").exists(), "nothing is made for a study that is not there");
    let error = folder.run(&["reproduce", "everything-else"]).refusal();
    assert!(!error.contains("did you mean"), "{error}");
}

#[test]
fn no_study_and_bad_flags_are_wrong_use() {
    let folder = Folder::new();
    for arguments in
        [&["reproduce"][..], &["reproduce", "kf-pio", "--threads", "0"], &["reproduce", "kf-pio", "--seed", "-1"]]
    {
        assert_eq!(folder.run(arguments).code, 2, "{arguments:?}");
    }
}

#[test]
fn an_unusable_folder_is_refused_before_work_starts() {
    let folder = Folder::new();
    folder.write("file", "");
    let error = folder.run(&["reproduce", "kf-pio", "--out", "file/results"]).refusal();
    assert!(error.contains("cannot make the output folder"), "{error}");
}

/// The whole quick study through the binary: every target is reached, and what it says is written.
#[test]
fn the_quick_moma_study_passes() {
    let folder = Folder::new();
    let json = folder.run(&["reproduce", "moma", "--quick", "--json", "--out", "results"]).expect(0).json();
    assert_eq!((&json["name"], &json["pass"], &json["quick"]), (&"moma".into(), &true.into(), &true.into()));
    let targets = json["targets"].as_array().unwrap();
    assert!(targets.len() > 15 && targets.iter().all(|target| target["pass"] == true), "{targets:?}");
    assert_eq!(json["table"][0]["method"], "Regular");
    assert!(json["reduced"].as_str().unwrap().starts_with("6 data sets in place of 20"), "{json}");
    let report = folder.read("results/report.md");
    for part in ["**Quick run: 6 data sets", "| MOMA | paper-like | 5.2556 |", "](fig3-error.svg)"] {
        assert!(report.contains(part), "{part} in {report}");
    }
    let names = folder.names("results");
    for name in ["fig2-front.svg", "result.json", "runs.csv", "summary.csv", "targets.csv", "tracks.csv"] {
        assert!(names.iter().any(|n| n == name), "{name} in {names:?}");
    }
}
