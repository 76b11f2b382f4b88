//! Keys, data, names, and the file as a whole.

use super::{broken, check, error};
use crate::model::Problem;

#[test]
fn keys() {
    check(&[
        (
            "time =",
            "tiem =",
            "tiem",
            "3:1: unknown key `tiem` in [data]: did you mean `time`? (known: `file`, `time`, `measurements`, `inputs`, `truth`, `trajectory`, `validate`, `time_unit`, `separator`, `decimal`, `thousands`, `header_line` and 1 more)",
        ),
        (
            "[filter]",
            "[filters]",
            "filters",
            "22:2: unknown key `filters` in the problem file: did you mean `filter`? (known: `data`, `model`, `parameters`, `filter`, `tune`, `simulate`)",
        ),
        (
            "start = 5",
            "strat = 5",
            "strat",
            "20:29: unknown key `strat` in [parameters.r]: did you mean `start`? (known: `min`, `max`, `scale`, `start`, `init`, `unit`, `tie`, `value`)",
        ),
        (
            "file = \"log.csv\"",
            "",
            "[data]",
            "1:1: [data] lacks `file`: give the log's file name, relative to the problem file, or a [simulate] table",
        ),
        ("P0 = [100, 10]", "", "[model]", "8:1: [model] lacks `P0`: give the initial covariance"),
        ("time = \"t\"", "time = 3", "3", "3:8: `data.time`: expected a string, found the number 3"),
        (
            "population = 20",
            "population = \"many\"",
            "\"many\"",
            "28:14: `tune.population`: expected a whole number, found the string \"many\"",
        ),
        (
            "population = 20",
            "population = 0",
            "0",
            "28:14: `tune.population` is 0: expected a whole number from 1 to 16777216",
        ),
        (
            "population = 20",
            "population = 20\nseed = -1",
            "-1",
            "29:8: `tune.seed` is -1: expected a whole number from 0",
        ),
    ]);
    let (sentence, _) = broken("time = \"t\"", "time = \"t\"\ntime = \"t\"");
    assert!(sentence.starts_with("p.toml:4:1: not valid TOML: duplicate key"), "{sentence}");
    let (sentence, _) = broken("time = \"t\"", "time = \"t");
    assert!(sentence.starts_with("p.toml:3:"), "{sentence}");
}

#[test]
fn data() {
    check(&[
        ("[\"z\"]", "[\"z\", \"z\"]", "\"z\"", "4:22: `data.measurements[2]`: `z` is listed twice"),
        ("[\"z\"]", "[]", "[]", "4:16: `data.measurements` has 0 entries: expected a list of column names"),
        (
            "[\"u\"]",
            "[\"u 1\"]",
            "\"u 1\"",
            "5:11: `u 1` cannot be a name in formulas: use letters, digits and underscores, not starting with a digit",
        ),
        (
            "{ p = \"p_true\" }",
            "{ w = \"p_true\" }",
            "w",
            "6:11: `data.truth` names the state `w`, which does not exist (known: `p`, `v`)",
        ),
    ]);
    check(&[
        (
            "time = \"t\"",
            "time = \"t\"\ntime_unit = \"msec\"",
            "\"msec\"",
            "4:13: `data.time_unit` is \"msec\": expected a unit of time (did you mean \"ms\"? known: \"s\", \"ms\", \"us\", \"ns\", \"min\", \"h\", \"day\", \"month\", \"year\")",
        ),
        (
            "time = \"t\"",
            "time_unit = \"us\"",
            "\"us\"",
            "3:13: `data.time_unit` is \"us\": expected \"s\", \"min\", \"h\", \"day\", \"month\" or \"year\" where no `time` column has numbers to convert",
        ),
        (
            "time = \"t\"",
            "time = \"t\"\ndecimal = \";\"",
            "\";\"",
            "4:11: `data.decimal` is \";\": expected \".\" or \",\"",
        ),
        (
            "time = \"t\"",
            "time = \"t\"\nthousands = \".\"",
            "\".\"",
            "4:13: `data.thousands` is \".\": expected another character than the one before decimals",
        ),
        (
            "time = \"t\"",
            "time = \"t\"\nskip_lines = [0]",
            "0",
            "4:15: `data.skip_lines[1]` is 0: expected a whole number from 1",
        ),
        (
            "time = \"t\"",
            "time = \"t\"\nheader_line = \"2\"",
            "\"2\"",
            "4:15: `data.header_line`: expected a whole number, found the string \"2\"",
        ),
    ]);
    let many = (0..33).map(|i| format!("\"z{i}\"")).collect::<Vec<_>>().join(", ");
    let (sentence, _) = broken("[\"z\"]", &format!("[{many}]"));
    assert_eq!(sentence, "p.toml:4:16: 33 measurements: at most 32 are allowed");
    let many = (0..100_000).map(|i| format!("\"s{i}\"")).collect::<Vec<_>>().join(", ");
    let (sentence, _) = broken("[\"p\", \"v\"]", &format!("[{many}]"));
    assert_eq!(sentence, "p.toml:9:9: 100000 states: at most 32 are allowed");
}

#[test]
fn names() {
    check(&[
        (
            "[\"p\", \"v\"]",
            "[\"p\", \"dt\"]",
            "\"dt\"",
            "9:15: the name `dt` is already the interval to the next row: choose another",
        ),
        ("[\"p\", \"v\"]", "[\"p\", \"sin\"]", "\"sin\"", "9:15: the name `sin` is already a function: choose another"),
        (
            "[\"p\", \"v\"]",
            "[\"p\", \"2v\"]",
            "\"2v\"",
            "9:15: `2v` cannot be a name in formulas: use letters, digits and underscores, not starting with a digit",
        ),
        ("[\"p\", \"v\"]", "[\"p\", \"p\"]", "\"p\"", "9:15: `model.state[2]`: `p` is listed twice"),
        ("[\"u\"]", "[\"p\"]", "\"p\"", "5:11: the name `p` is already a state: choose another"),
        ("r = { min", "v = { min", "v", "20:1: the name `v` is already a state: choose another"),
        ("r = { min", "u = { min", "u", "20:1: the name `u` is already an input: choose another"),
    ]);
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
