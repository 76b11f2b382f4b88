use std::path::Path;

use super::*;

/// The message for `text` read with time `t` and measurement `z`.
fn message(text: impl AsRef<[u8]>) -> String {
    read(&spec(Some("t"), &["z"]), text).unwrap_err().to_string()
}

/// The message for one input `u` beside the measurement `z`, in trajectories `id`.
fn input_message(text: &str) -> String {
    let data = DataSpec { inputs: vec!["u".to_owned()], trajectory: Some("id".to_owned()), ..spec(None, &["z"]) };
    read(&data, text).unwrap_err().to_string()
}

#[test]
fn files_that_are_no_logs() {
    let folder = tempfile::tempdir().unwrap();
    let open = |name: Option<&str>| {
        let data = DataSpec { file: name.map(str::to_owned), ..spec(None, &["z"]) };
        Log::open(&data, folder.path()).unwrap_err().to_string().replace(&folder.path().display().to_string(), "DIR")
    };
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    std::fs::write(folder.path().join("empty.csv"), "").unwrap();
    assert_eq!(
        open(Some("none.csv")),
        "DIR/none.csv: no such file (check the name; a path in a problem file is relative to the folder of that file)"
    );
    assert_eq!(open(Some("sub")), "DIR/sub: is a folder, expected a CSV file (name the file in it)");
    assert_eq!(open(Some("empty.csv")), "DIR/empty.csv: is empty, expected a header line and rows of numbers");
    assert!(open(None).starts_with("[data] names no file"), "{}", open(None));
}

#[test]
fn a_log_opens_relative_to_the_problem_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("log.csv"), "z\n1\n").unwrap();
    let log = Log::open(&spec(None, &["z"]), folder.path()).unwrap();
    assert_eq!(log.rows(), 1);
    assert!(Path::new(&log.source).ends_with("log.csv"), "{}", log.source);
}

#[test]
fn nothing_to_read() {
    assert_eq!(message(""), "log.csv: is empty, expected a header line and rows of numbers");
    assert_eq!(message("# only\n\n  \n"), "log.csv: is empty, expected a header line and rows of numbers");
    assert_eq!(message("t,z\n# no row\n\n"), "log.csv: has a header but no row");
    assert_eq!(
        message("0,1\n1,2\n"),
        "log.csv:1: expected a header, found only numbers (add a first line that names the columns)"
    );
}

#[test]
fn bytes_that_are_not_text() {
    let binary = |line: u64, found: &str| format!("log.csv:{line}: {found} is not text (expected a CSV file in UTF-8)");
    assert_eq!(message(b"\x7fELF\x02\x00\x00"), binary(1, "a zero byte"));
    assert_eq!(message(b"t,z\n0,1\n\x001,2\n"), binary(3, "a zero byte"));
    assert_eq!(message(b"\xFF\xFEt\0,\0z\0"), binary(1, "UTF-16"));
    assert_eq!(message(vec![b'x'; (1 << 20) + 1]), binary(1, "a line of more than a mebibyte"));
    let latin1 = "is not UTF-8 (convert the file, for example with `iconv -f latin1 -t utf-8`)";
    assert_eq!(message(b"t,z,\xB0C\n0,1,2\n"), format!("log.csv:1:5: {latin1}"));
    assert_eq!(message(b"t,z\n0,1\n1,\xB0\n"), format!("log.csv:3:3: {latin1}"));
}

#[test]
fn ragged_rows() {
    let expected = "expected as many cells as the header has, 2, found";
    assert_eq!(message("t,z\n0,1\n1\n"), format!("log.csv:3: {expected} 1"));
    assert_eq!(message("t,z\n0,1,\n"), format!("log.csv:2: {expected} 3"));
    assert_eq!(message("t,z\n0,1\n\"1,2\n2,3\n"), format!("log.csv:3: {expected} 1 (is a quote left open?)"));
}

#[test]
fn cells_that_are_no_numbers() {
    let remedy = "(leave the cell empty for a missing measurement)";
    assert_eq!(
        message("t,z\n0,1\n# note\n1,  n/a\n"),
        format!("log.csv:4:5: column \"z\": expected a number, found \"n/a\" {remedy}")
    );
    assert_eq!(
        message("\u{FEFF}t,é,z\r\n0,\"ä, ö\",x\r\n"),
        format!("log.csv:2:10: column \"z\": expected a number, found \"x\" {remedy}"),
        "columns count characters"
    );
    assert_eq!(
        message("t;z\n0;1,5\n"),
        "log.csv:2:3: column \"z\": expected a number, found \"1,5\" (a decimal comma: give decimal = \",\" in [data], or write \
         a decimal point)"
    );
    let long = format!("t,z\n0,{}\n", "ü".repeat(99));
    assert!(message(&long).contains(&format!("found \"{}...\"", "ü".repeat(60))), "{}", message(&long));
    for infinite in ["inf", "-Infinity", "1e999", "-1e400"] {
        assert_eq!(
            message(format!("t,z\n0,{infinite}\n")),
            format!("log.csv:2:3: column \"z\": expected a finite number, found \"{infinite}\" {remedy}")
        );
    }
    assert!(message("t,z\n1e999,1\n").contains("column \"t\": expected a finite number, found \"1e999\""));
}

#[test]
fn times_that_do_not_increase() {
    let rule = "(times must increase strictly within a trajectory)";
    assert_eq!(
        message("t,z\n0,1\n3,1\n3.0,1\n"),
        format!("log.csv:4:1: time 3 does not come after 3 of line 3 {rule}")
    );
    assert_eq!(
        message("z,t\n1,2.5\n\n1,-1\n"),
        format!("log.csv:4:3: time -1 does not come after 2.5 of line 2 {rule}")
    );
    assert_eq!(
        message("t,z\n2024-05-01,1\n2024-05-02,1\n2024-05-01T12:00:00Z,1\n"),
        format!("log.csv:4:1: time 2024-05-01T12:00:00Z does not come after 2024-05-02T00:00:00Z of line 3 {rule}")
    );
}

#[test]
fn times_that_are_none() {
    let missing = "column \"t\": the time is missing (every row needs one)";
    assert_eq!(message("t,z\n0,1\n,2\n"), format!("log.csv:3:1: {missing}"));
    assert_eq!(message("t,z\nNaN,1\n"), format!("log.csv:2:1: {missing}"));
    let expected = "column \"t\": expected a time in seconds or ISO-8601, found";
    assert_eq!(message("t,z\nnoon,1\n"), format!("log.csv:2:1: {expected} \"noon\""));
    assert_eq!(message("t,z\n0,1\nx,1\n"), format!("log.csv:3:1: {expected} \"x\""));
    for out_of_range in ["2024-13-01", "2024-02-30", "10000-01-01", "+010000-01-01T00:00:00Z", "2024-01-01T25:00:00Z"] {
        let message = message(format!("t,z\n{out_of_range},1\n"));
        assert!(message.starts_with(&format!("log.csv:2:1: {expected} \"{out_of_range}\" (")), "{message}");
    }
    let named = message("t,z\n2024-01-01T00:00:00[Europe/Paris],1\n");
    assert!(named.ends_with("(a named zone needs its offset beside it, such as +01:00[Europe/Paris])"), "{named}");
}

#[test]
fn seconds_and_dates_do_not_mix() {
    assert_eq!(
        message("t,z\n0,1\n2024-01-01,2\n"),
        "log.csv:3:1: column \"t\": expected seconds as in the first row, found \"2024-01-01\" (use one kind of time)"
    );
    assert_eq!(
        message("t,z\n2024-01-01,1\n1,2\n"),
        "log.csv:3:1: column \"t\": expected an ISO-8601 time as in the first row, found \"1\" (use one kind of time)"
    );
}

#[test]
fn inputs_and_trajectories_that_are_missing() {
    assert_eq!(
        input_message("id,z,u\na,1,\nb,1,2\na,1,3\n"),
        "log.csv:2:5: column \"u\": the input is missing (only a trajectory's last row may leave it empty)"
    );
    assert_eq!(
        input_message("id,z,u\na,1,x\n"),
        "log.csv:2:5: column \"u\": expected a number, found \"x\" (only a trajectory's last row may leave an input empty)"
    );
    assert_eq!(
        input_message("id,z,u\n,1,2\n"),
        "log.csv:2:1: column \"id\": the trajectory is missing (every row needs one)"
    );
}

#[test]
fn columns_that_are_not_there_or_twice() {
    assert_eq!(
        message("time,range,t,range\n"),
        "log.csv:1:14: column \"range\" is named twice in the header, as columns 2 and 4 (rename one)"
    );
    let ask = |column: &str| read(&spec(None, &[column]), "# c\nt,Range,bearing\n0,1,2\n").unwrap_err().to_string();
    assert_eq!(
        ask("rnge"),
        "log.csv:2: no column \"rnge\", which [data] names as a measurement (did you mean \"Range\"?); \
         the header has \"t\", \"Range\", \"bearing\""
    );
    assert!(!ask("qqq").contains("did you mean"), "{}", ask("qqq"));
    let wide: String = (0..30).map(|i| format!("c{i},")).collect();
    assert!(message(format!("{wide}\n")).ends_with("\"c19\" and 11 more"), "{}", message(format!("{wide}\n")));
}

#[test]
fn a_column_has_one_role() {
    let data = DataSpec { truth: vec![("d".to_owned(), "z".to_owned())], ..spec(None, &["z"]) };
    assert_eq!(
        read(&data, "z\n1\n").unwrap_err().to_string(),
        "[data] uses column \"z\" twice, as a measurement and as truth of state \"d\" (each column has one role)"
    );
    let message = read(&spec(Some("z"), &["z"]), "z\n1\n").unwrap_err().to_string();
    assert!(message.contains("as time and as a measurement"), "{message}");
}

#[test]
fn a_measurement_needs_one_value_somewhere() {
    let message = read(&spec(None, &["a", "b"]), "a,b\n1,\n,NaN\n").unwrap_err().to_string();
    assert_eq!(message, "log.csv: column \"b\": all values are missing (leave it out of `measurements`)");
}
