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

/// Both studies through the binary: every target is reached, and what is said is written.
#[test]
fn the_quick_studies_pass() {
    let folder = Folder::new();
    let json = folder.run(&["reproduce", "all", "--quick", "--json", "--out", "results"]).expect(0).json();
    assert_eq!((&json["name"], &json["pass"], &json["quick"]), (&"all".into(), &true.into(), &true.into()));
    let targets = json["targets"].as_array().unwrap();
    assert!(targets.len() > 30 && targets.iter().all(|target| target["pass"] == true), "{targets:?}");
    assert_eq!(json["studies"][1]["table"][0]["method"], "Regular");
    let cases = [
        ("kf-pio", ["**Quick run: 10 data sets in place of 30", "| KF-PSO | 37.62 |", "](fig8-convergence.svg)"]),
        ("moma", ["**Quick run: 6 data sets in place of 20", "| MOMA | paper-like | 5.2556 |", "](fig3-error.svg)"]),
    ];
    for (study, parts) in cases {
        let report = folder.read(&format!("results/{study}/report.md"));
        assert!(parts.iter().all(|part| report.contains(part)), "{parts:?} in {report}");
        let names = folder.names(&format!("results/{study}"));
        for name in ["result.json", "runs.csv", "summary.csv", "targets.csv", "tracks.csv"] {
            assert!(names.iter().any(|n| n == name), "{name} in {names:?}");
        }
        assert!(names.iter().filter(|name| name.ends_with(".svg")).count() >= 4, "{names:?}");
    }
}
