//! The file as a whole.

use super::{broken, error};
use crate::model::Problem;

#[test]
fn toml_itself() {
    let (sentence, _) = broken("time = \"t\"", "time = \"t\"\ntime = \"t\"");
    assert!(sentence.starts_with("p.toml:4:1: not valid TOML: duplicate key"), "{sentence}");
    let (sentence, _) = broken("time = \"t\"", "time = \"t");
    assert!(sentence.starts_with("p.toml:3:"), "{sentence}");
}

#[test]
fn sizes() {
    let many = (0..33).map(|i| format!("\"z{i}\"")).collect::<Vec<_>>().join(", ");
    let (sentence, _) = broken("[\"z\"]", &format!("[{many}]"));
    assert_eq!(sentence, "p.toml:4:16: 33 measurements: at most 32 are allowed");
    let many: String = (0..1100).map(|i| format!("k{i} = 1\n")).collect();
    let (sentence, _) = broken("r = { min", &format!("{many}r = {{ min"));
    assert_eq!(sentence, "p.toml:18:1: 1102 parameters: at most 1024 are allowed");
    let many = (0..100_000).map(|i| format!("\"s{i}\"")).collect::<Vec<_>>().join(", ");
    let (sentence, _) = broken("[\"p\", \"v\"]", &format!("[{many}]"));
    assert_eq!(sentence, "p.toml:9:9: 100000 states: at most 32 are allowed");
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.toml");
    let open = || Problem::open(&path).expect_err("refused").to_string();
    assert!(open().contains("p.toml: cannot read the problem file: "), "{}", open());
    std::fs::write(&path, [0xff, 0xfe, 0, 1]).unwrap();
    assert!(
        open().ends_with("p.toml: the problem file is not UTF-8 text (is this really a problem file?)"),
        "{}",
        open()
    );
    std::fs::write(&path, vec![b'\n'; 5_000_000]).unwrap();
    assert!(open().contains("the problem file has 5000000 bytes"), "{}", open());
    std::fs::write(&path, "").unwrap();
    assert!(open().contains("p.toml:1:1: the problem file lacks `data`"), "{}", open());
}

#[test]
fn absurd_toml() {
    for text in ["x = ".to_owned() + &"[".repeat(1_000_000), "a.".repeat(1_000_000) + "a = 1", "[".repeat(1_000_000)] {
        let message = error(&text).to_string();
        assert!(message.starts_with("p.toml:1:") && message.len() < 1000, "{message}");
    }
}
