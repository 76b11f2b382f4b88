//! The pictures that `tune --out` and `filter --figures` write.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::command::Folder;

const OF_A_RUN: [&str; 5] = ["autocorrelation.svg", "estimates.svg", "histogram.svg", "innovations.svg", "nis.svg"];

/// Names in a folder; every file must be a well-formed picture.
fn pictures(folder: &Path) -> BTreeSet<String> {
    let files = fs::read_dir(folder).unwrap().map(|file| file.unwrap());
    files
        .map(|file| {
            let text = fs::read_to_string(file.path()).unwrap();
            let document = roxmltree::Document::parse(&text).unwrap();
            assert!(document.root_element().has_tag_name("svg"), "{}", file.path().display());
            file.file_name().into_string().unwrap()
        })
        .collect()
}

fn names(more: &[&str]) -> BTreeSet<String> {
    OF_A_RUN.iter().chain(more).map(|name| (*name).to_owned()).collect()
}

#[test]
fn tune_draws_what_makes_sense_and_leaves_nothing_of_an_earlier_run() {
    let folder = Folder::with_level();
    let figures = folder.path("out/figures");
    fs::create_dir_all(&figures).unwrap();
    fs::write(figures.join("front.svg"), "of an earlier run").unwrap();
    folder.run(&["tune", "problem.toml", "--generations", "3", "--out", "out", "--force"]).expect(0);
    assert_eq!(pictures(&figures), names(&["convergence.svg", "landscape.svg"]));
    folder.run(&["tune", "problem.toml", "--algorithm", "random", "--objectives", "nll,nis", "--out", "out"]).expect(0);
    let of_fronts = ["convergence.svg", "landscape.svg", "front.svg", "parameters.svg", "hypervolume.svg"];
    assert_eq!(pictures(&figures), names(&of_fronts));
}

#[test]
fn filter_draws_its_run() {
    let folder = Folder::with_level();
    folder.run(&["filter", "problem.toml", "--out", "run.csv", "--figures", "seen/here"]).expect(0);
    assert_eq!(pictures(&folder.path("seen/here")), names(&[]));
    let refused = folder.run(&["filter", "problem.toml", "--figures", "run.csv"]).expect(2);
    assert!(refused.stderr.contains("cannot make the output folder"), "{}", refused.stderr);
}
