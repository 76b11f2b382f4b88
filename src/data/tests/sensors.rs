//! Logs of several sensors: rows told apart by a label, or by what is filled.

use proptest::prelude::*;

use super::*;
use crate::data::{SensorSpec, Summary};

/// A sensor of these columns; an empty label is none.
fn sensor(name: &str, when: &str, columns: &[&str]) -> SensorSpec {
    SensorSpec {
        name: name.to_owned(),
        columns: columns.iter().map(|c| (*c).to_owned()).collect(),
        when: (!when.is_empty()).then(|| when.to_owned()),
    }
}

/// GPS and radar by label, which share the column `range`.
fn long() -> DataSpec {
    DataSpec {
        sensors: vec![sensor("gps", "gps", &["range"]), sensor("radar", "radar 2", &["range", "bearing"])],
        sensor: Some("who".to_owned()),
        ..spec(Some("t"), &["gps_range", "radar_range", "bearing"])
    }
}

/// The same without a label, by columns of their own.
fn wide() -> DataSpec {
    DataSpec {
        sensors: vec![sensor("gps", "", &["g"]), sensor("radar", "", &["r", "b"])],
        ..spec(Some("t"), &["g", "r", "b"])
    }
}

fn message(spec: &DataSpec, text: &str) -> String {
    read(spec, text).unwrap_err().to_string()
}

#[test]
fn a_label_says_which_measurements_a_row_has() {
    let text = "t,who,range,bearing\n0,gps,5,not read\n0,radar 2,6,0.1\n1,,7,8\n2,radar 2,,0.2\n2,gps,9,\n";
    let log = read(&long(), text).unwrap();
    let t = &log.trajectories[0];
    assert_eq!(log.measurements, ["gps_range", "radar_range", "bearing"]);
    assert_eq!(t.time, [0.0, 0.0, 1.0, 2.0, 2.0]);
    assert_eq!(known(t.z.column(0)), [Some(5.0), None, None, None, Some(9.0)]);
    assert_eq!(known(t.z.column(1)), [None, Some(6.0), None, None, None]);
    assert_eq!(known(t.z.column(2)), [None, Some(0.1), None, Some(0.2), None]);
    assert_eq!([0, 1, 2, 3].map(|k| t.dt(k)), [Some(0.0), Some(1.0), Some(1.0), Some(0.0)]);
    assert_eq!(log.regular_dt(), None, "steps of no time are no interval of a regular log");
    let summary = Summary::of(&log).to_string();
    assert!(summary.contains("dt: 1 s, regular; 2 rows at the time of the row before"), "{summary}");
}

#[test]
fn without_a_label_sensors_have_the_rows_that_their_columns_are_filled_in() {
    let log = read(&wide(), "t,g,r,b\n0,5,,\n0,,6,0.1\n1,7,8,0.2\n").unwrap();
    let t = &log.trajectories[0];
    assert_eq!(t.time, [0.0, 0.0, 1.0]);
    assert_eq!(known(t.z.column(0)), [Some(5.0), None, Some(7.0)]);
    assert_eq!(known(t.z.column(2)), [None, Some(0.1), Some(0.2)]);
}

#[test]
fn time_increases_within_a_sensor_and_never_goes_back() {
    let twice = "log.csv:4:1: sensor \"gps\" has time 0 a second time, after line 2 (times must increase strictly within a \
                 trajectory and sensor)";
    assert_eq!(message(&long(), "t,who,range,bearing\n0,gps,1,\n0,radar 2,1,1\n0,gps,1,\n"), twice);
    assert_eq!(message(&wide(), "t,g,r,b\n0,1,,\n0,,1,1\n0,2,,\n"), twice);
    assert!(message(&wide(), "t,g,r,b\n0,1,1,1\n0,,1,\n").contains("sensor \"radar\" has time 0"), "a part of it");
    assert_eq!(
        message(&long(), "t,who,range,bearing\n0,gps,1,\n2,gps,1,\n1.5,radar 2,1,1\n"),
        "log.csv:4:1: sensor \"radar\": time 1.5 comes before 2 of line 3 (rows of all sensors stand in the order of time \
         within a trajectory: sort the log)"
    );
    let nobody =
        "log.csv:4:1: time 1 does not come after 1 of line 3 (times must increase strictly within a trajectory)";
    assert_eq!(message(&wide(), "t,g,r,b\n0,1,1,1\n1,,,\n1,,,\n"), nobody);
    let trajectories = DataSpec { trajectory: Some("id".to_owned()), ..wide() };
    assert!(read(&trajectories, "id,t,g,r,b\n1,0,1,,\n2,0,1,,\n1,0,,1,1\n").is_ok(), "each has its own clock");
    let plain = spec(Some("t"), &["g", "r", "b"]);
    assert!(message(&plain, "t,g,r,b\n0,5,,\n0,,6,0.1\n").contains("does not come after"), "without sensors as ever");
}

#[test]
fn labels_that_no_sensor_has_are_refused_or_left_out() {
    let text = "t,who,range,bearing\n0,gps,1,\n0,radar 1,1,1\n1,radar 2,1,1\n";
    assert_eq!(
        message(&long(), text),
        "log.csv:3:3: column \"who\": no [[sensor]] has when = \"radar 1\"; did you mean \"radar 2\"? (add one, or list it \
         in `ignore_sensors` of [data] to leave its rows out)"
    );
    let ignoring = DataSpec { ignore_sensors: vec!["radar 1".to_owned()], ..long() };
    assert_eq!(read(&ignoring, text).unwrap().trajectories[0].line, [2, 4]);
}

#[test]
fn a_sensor_without_a_measurement_is_refused() {
    assert_eq!(
        message(&long(), "t,who,range,bearing\n0,gps,1,\n"),
        "log.csv: sensor \"radar\" has no measurement: no row has \"radar 2\" in the sensor column (correct it, or leave \
         the sensor out)"
    );
    assert!(message(&long(), "t,who,range,bearing\n0,gps,1,\n1,radar 2,,\n").contains("its rows are empty"));
    assert!(
        message(&wide(), "t,g,r,b\n0,1,,\n").contains("sensor \"radar\" has no measurement: its columns are empty")
    );
    let half = message(&wide(), "t,g,r,b\n0,1,1,\n");
    assert_eq!(half, "log.csv: column \"b\": all values are missing (leave it out of `measurements`)");
    let missing = message(&long(), "t,whom,range,bearing\n0,gps,1,\n");
    assert!(
        missing.starts_with("log.csv:1: no column \"who\", which [data] names as the sensor of a row"),
        "{missing}"
    );
    assert!(missing.contains("did you mean \"whom\"?"), "{missing}");
    let used = DataSpec { sensor: Some("range".to_owned()), ..long() };
    assert!(message(&used, "t,range,bearing\n").contains("twice"), "each column has one role");
}

#[test]
fn an_input_that_only_one_sensor_reads_may_be_empty_elsewhere() {
    let mut data = DataSpec { inputs: vec!["own".to_owned(), "push".to_owned()], ..long() };
    data.readers = vec![Some(vec![1, 2]), None];
    let log = read(&data, "t,who,range,bearing,own,push\n0,gps,1,,,3\n0,radar 2,1,1,8,3\n1,gps,1,,,3\n").unwrap();
    assert_eq!(log.trajectories[0].u.column(0).collect::<Vec<_>>(), [8.0; 3], "what nobody reads stands at a value");
    let first = "t,who,range,bearing,own,push\n0,radar 2,1,1,,3\n";
    assert_eq!(
        message(&data, first),
        "log.csv:2:15: column \"own\": the input is missing where \"radar_range\" is measured, whose h uses it"
    );
    let push = message(&data, "t,who,range,bearing,own,push\n0,gps,1,,,\n1,radar 2,1,1,8,3\n");
    assert!(push.starts_with("log.csv:2:11: column \"push\": the input is missing (only"), "{push}");
}

#[test]
fn a_drawn_log_is_written_as_it_is_read() {
    let text = "t,who,range,bearing\n0,gps,5,\n0,radar 2,6,0.1\n1,,,\n2,radar 2,,0.2\n2,gps,9,\n";
    let log = read(&long(), text).unwrap();
    let mut written = Vec::new();
    log.write_csv(&long(), &mut written).unwrap();
    assert_eq!(String::from_utf8(written).unwrap(), text);
    // Measured by all at once, as a log is drawn.
    let rows =
        read(&DataSpec { sensors: vec![], sensor: None, ..long() }, "t,gps_range,radar_range,bearing\n0,5,6,7\n");
    let mut written = Vec::new();
    rows.unwrap().write_csv(&long(), &mut written).unwrap();
    assert_eq!(String::from_utf8(written).unwrap(), "t,who,range,bearing\n0,gps,5,\n0,radar 2,6,7\n");
}

proptest! {
    #[test]
    fn arbitrary_rows_never_panic_and_what_is_read_is_in_order(
        rows in "((0|1|1.5|2|x),(gps|radar 2||sonar),[0-9.]{0,3},[0-9.]{0,3}\n){0,8}"
    ) {
        for (spec, header) in [(long(), "t,who,range,bearing"), (wide(), "t,g,r,b")] {
            match read(&spec, format!("{header}\n{rows}")) {
                Ok(log) => prop_assert!(log.trajectories[0].time.is_sorted()),
                Err(error) => prop_assert!(error.to_string().starts_with("log.csv"), "{}", error),
            }
        }
    }
}
