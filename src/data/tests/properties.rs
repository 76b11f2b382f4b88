use proptest::prelude::*;

use super::*;
use crate::data::{Table, Trajectory};

/// `[data]` with every role.
fn full_spec() -> DataSpec {
    DataSpec {
        trajectory: Some("id".to_owned()),
        inputs: vec!["u".to_owned()],
        truth: vec![("x".to_owned(), "x_true".to_owned())],
        ..spec(Some("t"), &["z", "range, m"])
    }
}

fn finite() -> impl Strategy<Value = f64> {
    any::<f64>().prop_map(|v| if v.is_finite() { v } else { 0.1 })
}

fn perhaps_missing() -> impl Strategy<Value = f64> {
    prop_oneof![3 => finite(), 1 => Just(f64::NAN)]
}

fn trajectory() -> impl Strategy<Value = Trajectory> {
    let row = (finite(), prop::array::uniform2(perhaps_missing()), finite(), perhaps_missing());
    ("[a-z#\",; ]{0,4}[#a-z]", prop::collection::vec(row, 1..20)).prop_map(|(id, mut rows)| {
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        rows.dedup_by(|a, b| a.0 <= b.0);
        let (mut z, mut u, mut truth) = (Table::new(2), Table::new(1), Table::new(1));
        for (_, measured, input, true_x) in &rows {
            z.push(measured);
            u.push(&[*input]);
            truth.push(&[*true_x]);
        }
        let time: Vec<f64> = rows.iter().map(|r| r.0).collect();
        Trajectory { id: id.trim().to_owned(), line: vec![0; time.len()], time, z, u, truth }
    })
}

fn log() -> impl Strategy<Value = Log> {
    prop::collection::vec(trajectory(), 1..4).prop_map(|mut trajectories| {
        for (i, trajectory) in trajectories.iter_mut().enumerate() {
            trajectory.id.push_str(&i.to_string());
        }
        let data = full_spec();
        let (measurements, inputs) = (data.measurements, data.inputs);
        Log {
            source: "log.csv".to_owned(),
            measurements,
            inputs,
            truth: vec!["x".to_owned()],
            trajectories,
            ..Log::default()
        }
    })
}

/// Everything of a trajectory but its line numbers, with missing values comparable and signs of zero kept.
fn bits(t: &Trajectory) -> (String, Vec<u64>) {
    let canonical = |v: f64| if v.is_nan() { u64::MAX } else { v.to_bits() };
    let tables = (0..t.len()).flat_map(|k| [t.z.row(k), t.u.row(k), t.truth.row(k)].concat());
    (t.id.clone(), t.time.iter().copied().chain(tables).map(canonical).collect())
}

proptest! {
    #[test]
    fn what_is_written_reads_back_bit_for_bit(log in log()) {
        let measured = |i: usize| log.trajectories.iter().any(|t| t.z.column(i).any(|z| !z.is_nan()));
        prop_assume!(measured(0) && measured(1));
        let mut text = Vec::new();
        log.write_csv(&full_spec(), &mut text).unwrap();
        let back = read(&full_spec(), &text).unwrap();
        prop_assert_eq!(
            back.trajectories.iter().map(bits).collect::<Vec<_>>(),
            log.trajectories.iter().map(bits).collect::<Vec<_>>()
        );
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(&full_spec(), &bytes);
    }

    #[test]
    fn arbitrary_text_under_a_good_header_never_panics_and_errors_name_the_file(
        rows in "(([0-9a-z.\"#, \r-]|2024-0[1-9]-0[1-9]){0,12},){3,6}(\n([0-9e.\"#, -]{0,6},){5}[0-9]{0,2}){0,6}"
    ) {
        if let Err(error) = read(&full_spec(), format!("id,t,z,\"range, m\",u,x_true\n{rows}\n")) {
            prop_assert!(error.to_string().starts_with("log.csv"), "{}", error);
        }
    }
}

#[test]
fn columns_the_problem_does_not_name_are_added_where_the_log_needs_them() {
    let data = DataSpec { trajectory: Some("id".to_owned()), ..spec(Some("t"), &["z"]) };
    let mut log = read(&data, "id,t,z\na,0,1\na,0.5,2\nb,0,\n").unwrap();
    log.truth = vec!["d".to_owned()];
    for t in &mut log.trajectories {
        t.truth = Table::new(1);
        (0..t.len()).for_each(|_| t.truth.push(&[7.5]));
    }
    let mut text = Vec::new();
    log.write_csv(&spec(None, &["z"]), &mut text).unwrap();
    assert_eq!(String::from_utf8(text).unwrap(), "trajectory,t,z,d_true\na,0,1,7.5\na,0.5,2,7.5\nb,0,,7.5\n");
}

#[test]
fn unit_steps_of_one_trajectory_need_no_time_column() {
    let log = read(&spec(None, &["z"]), "z\n0.1\n\"\"\n1e300\n").unwrap();
    let mut text = Vec::new();
    log.write_csv(&spec(None, &["z"]), &mut text).unwrap();
    let back = read(&spec(None, &["z"]), &text).unwrap();
    assert_eq!(known(back.trajectories[0].z.column(0)), [Some(0.1), None, Some(1e300)]);
    assert!(text.starts_with(b"z\n0.1\n\"\"\n"), "{}", String::from_utf8_lossy(&text));
}
