//! The seeds of every fuzz target, and what fuzzing once found, replayed.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../fuzz/bodies.rs"]
mod bodies;

use std::fs;
use std::path::Path;

fn replay(target: &str, body: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target);
    let mut seeds: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    seeds.sort();
    assert!(seeds.len() >= 5, "{} holds seeds", folder.display());
    for seed in seeds {
        // Shown only where a body panics.
        println!("{}", seed.display());
        body(&fs::read(&seed).unwrap());
    }
}

#[test]
fn csv() {
    replay("csv", bodies::csv);
}

#[test]
fn problem() {
    replay("problem", bodies::problem);
}

#[test]
fn formula() {
    replay("formula", bodies::formula);
}
