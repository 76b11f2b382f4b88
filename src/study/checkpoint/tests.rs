//! Files whole, broken, and of others.

use std::path::PathBuf;

use proptest::prelude::*;

use super::*;
use crate::evaluate::{Backend, Device, Precision};
use crate::simulate::simulate;
use crate::study::{Front, Generation, Observer as _, Reached, Scored};

const TEXT: &str = r#"
[data]
measurements = ["z"]
[model]
kind = "local-level"
q = "q"
R = ["r"]
x0 = [0]
P0 = [3]
[parameters]
q = { min = 0.1, max = 1 }
r = { min = 0.1, max = 1, start = 0.5 }
[tune]
seed = 7
[simulate]
steps = 20
"#;

fn problem(text: &str) -> (Problem, Log) {
    let problem = Problem::parse(text, "level.toml").expect("a problem");
    let log = simulate(&problem, None).expect("a log");
    (problem, log)
}

fn snapshot(generations: usize) -> Snapshot {
    let row = |generation| Generation {
        generation,
        evaluations: 4 * (generation as u64 + 1),
        best: Some(0.1 + 0.2),
        median: None,
        spread: Some(f64::MIN_POSITIVE),
        failed: 1,
        feasible: 3,
        front: Some(1),
        hypervolume: Some(1.0 / 3.0),
        seconds: 0.5,
    };
    let scored = Scored { candidate: vec![f64::EPSILON, -0.0], costs: vec![0.1 + 0.2], violation: 0.0 };
    Snapshot {
        algorithm: "pso".to_owned(),
        optimizer: vec![1, 2, 3],
        archive: vec![scored.clone()],
        start: Some(scored),
        history: (0..generations).map(row).collect(),
        stalled: 1,
        reached: Some(Reached { violation: 0.0, cost: -1.0 / 3.0 }),
        front: Some(Front::new(2, 128)),
        evaluate_s: 0.25,
        wall_s: 0.5,
        device: Device { backend: Backend::Cpu, adapter: "a".into(), precision: Precision::F64 },
    }
}

fn checkpoint() -> Checkpoint {
    let (problem, log) = problem(TEXT);
    let source = Source { problem: problem.source.clone(), text: problem.text.clone(), ..Source::default() };
    Checkpoint::new(Identity::of(&problem, &log), source, snapshot(3))
}

fn bytes() -> Vec<u8> {
    checkpoint().to_bytes().expect("bytes")
}

#[test]
fn what_is_written_is_read() {
    assert_eq!(Checkpoint::read(&bytes()), Ok(checkpoint()));
}

#[test]
fn no_part_of_a_file_and_no_file_with_a_flipped_bit_is_read() {
    let whole = bytes();
    for length in 1..whole.len() {
        let error = Checkpoint::read(&whole[..length]).expect_err("truncated");
        assert!(matches!(error, CheckpointError::Truncated { .. }), "{length} bytes: {error}");
    }
    assert_eq!(Checkpoint::read(&[whole.as_slice(), b"\n"].concat()), Err(CheckpointError::Damaged), "a byte too many");
    for bit in 0..8 * whole.len() {
        let mut flipped = whole.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert!(Checkpoint::read(&flipped).is_err(), "bit {bit}");
    }
}

#[test]
fn every_refusal_says_what_to_do() {
    let with = |at: usize, new: &[u8]| {
        let mut changed = bytes();
        changed[at..at + new.len()].copy_from_slice(new);
        Checkpoint::read(&changed).expect_err("refused").to_string()
    };
    assert!(Checkpoint::read(b"").expect_err("refused").to_string().starts_with("the file is empty: name a"));
    assert!(with(0, b"t,z\n").starts_with("it is not a checkpoint of kfgpu: name the checkpoint.kfgpu"));
    assert!(with(8, &[9]).starts_with("it has format 9 of checkpoints, this kfgpu reads format 3: resume"));
    assert!(with(15, &[1]).starts_with("it is truncated, "));
    assert!(with(60, &[255; 4]).starts_with("it is damaged, its checksum does not hold: copy it again"));
    let older = Checkpoint { written_by: "0.0.9".to_owned(), ..checkpoint() };
    let error = |checkpoint: &Checkpoint| {
        Checkpoint::read(&checkpoint.to_bytes().expect("bytes")).expect_err("refused").to_string()
    };
    let said = error(&older);
    assert!(said.starts_with(&format!("it was written by kfgpu 0.0.9 with numerics {NUMERICS}, this is 0.")), "{said}");
    let said = error(&Checkpoint { numerics: NUMERICS - 1, ..checkpoint() });
    let expected = format!(" with numerics {}, this is {} with numerics ", NUMERICS - 1, env!("CARGO_PKG_VERSION"));
    assert!(said.contains(&expected) && said.contains("costs may differ in bits: resume it with"), "{said}");
    let missing = Checkpoint::open(&PathBuf::from("no/such/file")).expect_err("refused").to_string();
    assert!(missing.starts_with("it cannot be read: "), "{missing}");
}

/// Whoever adds an entry there has moved bits of searches that others may have saved.
#[test]
fn the_number_of_the_arithmetic_is_that_of_the_entries_in_the_changelog() {
    let changelog = include_str!("../../../CHANGELOG.md");
    let mut is_numerics = false;
    let mut entries = 0;
    for line in changelog.lines() {
        if line.starts_with('#') {
            is_numerics = line == "### Numerics";
        }
        entries += u32::from(is_numerics && line.starts_with("- "));
    }
    assert_eq!(NUMERICS, entries, "CHANGELOG.md has {entries} entries under Numerics: set NUMERICS to as many");
}

/// What the identity of this problem is, whatever the Rust types that hold it are called.
#[test]
fn the_identity_is_taken_over_words_of_its_own() {
    let text = TEXT.replace("seed = 7", "seed = 7\nalgorithm = \"pso\"\npopulation = 9\ngenerations = 5");
    let (problem, log) = problem(&text);
    let hex = |bytes: [u8; 32]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    let Identity { problem, log } = Identity::of(&problem, &log);
    assert_eq!(
        (hex(problem).as_str(), hex(log).as_str()),
        (
            "f616ec1f3618b039f52f1633a9f00635f7fef32bc56afee66aae1a2913299c38",
            "14c2908a3c5ee73bd09d31f430b24badf526d2c240b2b3e943f2f25715675147"
        ),
        "no checkpoint of before could be resumed: a change of this number needs a new Checkpoint::VERSION"
    );
}

/// A body that is no checkpoint under a checksum that holds.
#[test]
fn a_right_checksum_is_not_believed_either() {
    let body = &bytes()[HEADER..];
    assert_eq!(Checkpoint::read(&Checkpoint::seal(body)), Ok(checkpoint()), "the seal is right");
    assert_eq!(Checkpoint::read(&Checkpoint::seal(&[body, &[0]].concat())), Err(CheckpointError::Content));
    // A string of 2^60 bytes.
    let endless = [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x10];
    assert_eq!(Checkpoint::read(&Checkpoint::seal(&endless)), Err(CheckpointError::Content));
}

#[test]
fn identity_is_what_the_bits_of_a_search_depend_on() {
    let checkpoint = checkpoint();
    let check = |text: &str| {
        let (problem, log) = problem(text);
        checkpoint.check(&problem, &log).map_err(|error| error.to_string())
    };
    let limits =
        "seed = 7 # mine\npolish = false\nstop = { evaluations = 9000, wall_time = 9, stall = 8, target = -1 }";
    assert_eq!(check(&TEXT.replace("seed = 7", limits)), Ok(()), "neither limits nor polish nor where formulas stand");
    for (old, new) in [
        ("seed = 7", "seed = 8"),
        ("seed = 7", "seed = 7\ngenerations = 61"),
        ("seed = 7", "seed = 7\npopulation = 257"),
        ("seed = 7", "seed = 7\nalgorithm = \"pio\""),
        ("seed = 7", "seed = 7\nobjectives = [{ name = \"nll\", skip = 1 }]"),
        ("seed = 7", "seed = 7\ninclude_start = false"),
        ("start = 0.5", "start = 0.25"),
        ("max = 1 }", "max = 2 }"),
        ("\"q\"", "\"2*q\""),
        ("P0 = [3]", "P0 = [4]"),
        ("[simulate]", "[filter]\nrobust = \"gate\"\n[simulate]"),
    ] {
        let error = check(&TEXT.replace(old, new)).expect_err(new);
        assert!(error.starts_with("it is of another problem than this ("), "{new}: {error}");
    }
    let error = check(&TEXT.replace("steps = 20", "steps = 21")).expect_err("another log");
    let said =
        "the log is not the one it was written with (simulate.steps is 20 there and 21 here): resume with that log";
    assert!(error.starts_with(said), "{error}");
    let (problem, mut log) = problem(TEXT);
    log.source = "elsewhere.csv".to_owned();
    assert_eq!(checkpoint.check(&problem, &log), Ok(()), "the same numbers under another name");
    log.trajectories[0].time[3] += 1e-9;
    let error = checkpoint.check(&problem, &log).expect_err("a nanosecond").to_string();
    assert!(error.starts_with("the log is not the one it was written with: resume with that log"), "{error}");
}

/// Not what a curve is called, nor where it lies.
#[test]
fn the_numbers_of_a_table_belong_to_a_search() {
    let folder = tempfile::tempdir().unwrap();
    let identity = |file: &str, points: &str| {
        std::fs::write(folder.path().join(file), format!("x,y\n{points}")).unwrap();
        let table = format!("'table(\"{}\", q)'", folder.path().join(file).display());
        let (problem, log) = problem(&TEXT.replace("\"q\"", &table));
        Identity::of(&problem, &log)
    };
    let first = identity("a.csv", "0,1\n1,2\n");
    assert_eq!(first, identity("b.csv", "0,1\n1.0,2\n"));
    assert_ne!(first, identity("a.csv", "0,1\n1,2.5\n"));
    assert_ne!(first, identity("a.csv", "0,1\n1.5,2\n"));
}

/// A flag that is written into `[tune]` moves every formula behind it.
#[test]
fn formulas_of_an_adaptive_filter_may_stand_elsewhere() {
    let adaptive = |tune: &str, forgetting: &str| {
        let (before, after) = TEXT.split_once("[simulate]").expect("a table");
        let filter = format!("[filter]\nkind = \"sage-husa\"\nforgetting = \"{forgetting}\"\n[simulate]");
        let (problem, log) = problem(&format!("{}{filter}{after}", before.replace("seed = 7", tune)));
        Identity::of(&problem, &log)
    };
    let written = adaptive("seed = 7", "1 - 0.1*r");
    assert_eq!(adaptive("seed = 7\nstop = { stall = 8 }", "1 - 0.1*r"), written);
    assert_ne!(adaptive("seed = 7", "1 - 0.2*r"), written, "another filter");
}

#[test]
fn the_file_is_there_after_every_generation_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("checkpoint.kfgpu");
    // What a process that was killed while it wrote has left.
    std::fs::write(folder.path().join(".checkpoint.kfgpu.tmp"), "half").expect("written");
    let mut file = CheckpointFile::new(path.clone(), checkpoint().identity, checkpoint().source);
    for generations in 1..4 {
        file.state(&|| snapshot(generations), false);
        assert_eq!((file.failure(), file.written()), (None, Some(generations)));
        assert_eq!(Checkpoint::open(&path).expect("whole").snapshot, snapshot(generations));
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "no temporary file stays");
    }
}

/// A file of 2 MB is not written again at once, but at the end.
#[test]
fn a_large_file_takes_no_more_than_its_share_of_the_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("checkpoint.kfgpu");
    let mut file = CheckpointFile::new(path, checkpoint().identity, checkpoint().source);
    let large = |generations| Snapshot { optimizer: vec![7; 2 * CheckpointFile::SMALL], ..snapshot(generations) };
    let begin = std::time::Instant::now();
    let mut written = 0;
    for generations in 1..200 {
        file.state(&|| large(generations), false);
        written += usize::from(file.written() == Some(generations));
    }
    assert!((1..199).contains(&written), "{written} of 199 written in {:?}", begin.elapsed());
    file.state(&|| large(200), true);
    assert_eq!((file.failure(), file.written()), (None, Some(200)));
}

#[test]
fn a_write_that_fails_leaves_the_search_running_and_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("gone").join("checkpoint.kfgpu");
    let mut file = CheckpointFile::new(path.clone(), checkpoint().identity, checkpoint().source);
    file.state(&|| snapshot(1), false);
    assert!(file.failure().is_some() && file.written().is_none(), "{file:?}");
    std::fs::create_dir(folder.path().join("gone")).expect("a folder");
    file.state(&|| snapshot(2), false);
    assert_eq!((file.failure(), file.written()), (None, Some(2)), "and it tries again");
    // A folder of that name cannot be replaced.
    std::fs::remove_file(&path).expect("removed");
    std::fs::create_dir(&path).expect("a folder");
    file.state(&|| snapshot(3), true);
    assert!(file.failure().is_some(), "{file:?}");
    assert_eq!(std::fs::read_dir(folder.path().join("gone")).expect("a folder").count(), 1, "no temporary file stays");
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(noise in proptest::collection::vec(any::<u8>(), 0..400), whole_magic: bool) {
        let magic = if whole_magic { bytes()[..HEADER].to_vec() } else { Vec::new() };
        prop_assert!(Checkpoint::read(&[magic, noise].concat()).is_err());
    }

    /// Changed bodies under a right checksum, which a fuzzer does not find by itself.
    #[test]
    fn changed_bodies_never_panic(at in 0..10_000_usize, byte: u8, cut in 0..10_000_usize) {
        let mut body = bytes()[HEADER..].to_vec();
        let (at, length) = (at % body.len(), body.len());
        body[at] = byte;
        body.truncate(length - (cut % (2 * length)).saturating_sub(length));
        let _ = Checkpoint::read(&Checkpoint::seal(&body));
    }
}
