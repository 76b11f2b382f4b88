//! The seeds of every fuzz target, and what fuzzing once found, replayed.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../fuzz/bodies/mod.rs"]
mod bodies;

use std::fs;
use std::path::Path;

fn replay(target: &str, body: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target);
    let mut seeds: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    seeds.sort();
    assert!(seeds.len() >= 5, "{} holds seeds", folder.display());
    for seed in seeds {
        let bytes = fs::read(&seed).unwrap();
        let replayed = std::panic::catch_unwind(|| body(&bytes));
        assert!(replayed.is_ok(), "{} breaks the target {target}", seed.display());
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

#[test]
fn checkpoint() {
    replay("checkpoint", bodies::checkpoint);
}

/// The seeds of `checkpoint` are bodies of real ones: `cargo test --test fuzz_seeds -- --ignored` writes them anew after
/// the format has changed.
#[test]
#[ignore = "writes seeds"]
fn write_checkpoint_seeds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/checkpoint");
    for (name, body) in bodies::checkpoint_bodies() {
        fs::write(folder.join(name), body).unwrap();
    }
}

/// Seeds of an older format are refused at once and try nothing.
#[test]
fn checkpoint_seeds_are_of_this_format() {
    for (name, body) in bodies::checkpoint_bodies() {
        let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/checkpoint").join(name);
        let read = |body: &[u8]| kfgpu::study::Checkpoint::read(&kfgpu::study::Checkpoint::seal(body));
        assert!(read(&body).is_ok(), "{name}");
        assert!(read(&fs::read(seed).unwrap()).is_ok(), "{name}: write the seeds anew");
    }
}
