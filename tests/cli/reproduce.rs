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
