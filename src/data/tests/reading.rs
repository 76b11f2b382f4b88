use super::*;

/// Reads `text` with time `t` and measurement `z`; gives times and measurements of the only trajectory.
fn times_and_z(text: impl AsRef<[u8]>) -> (Vec<f64>, Vec<Option<f64>>) {
    let log = read(&spec(Some("t"), &["z"]), text).unwrap();
    assert_eq!(log.trajectories.len(), 1, "one trajectory");
    (log.trajectories[0].time.clone(), known(log.trajectories[0].z.column(0)))
}

#[test]
fn every_dress_of_the_same_table_reads_alike() {
    let expected = (vec![0.0, 0.5, 1.25], vec![Some(1.0), None, Some(-3e-2)]);
    for text in [
        "t,z\n0,1\n0.5,\n1.25,-3e-2\n",
        "t,z\n0,1\n0.5,\n1.25,-3e-2",
        "\u{FEFF}t,z\r\n0,1\r\n0.5,\r\n1.25,-3e-2\r\n",
        "t;z\n0;1\n0.5;NaN\n1.25;-3e-2\n",
        "t\tz\n0\t1\n0.5\tNA\n1.25\t-3e-2\n",
        "# a comment, with; delimiters\n\nt,z\n# another \"quote\n0,1\n  # indented\n0.5,null\n   \n1.25,-3e-2\n# last",
        " t , z \n 0 , +1.0\n.5, nan \n1.25,-.03\n",
        "\"t\",\"z\"\n\"0\",\"1\"\n\"0.5\",\"\"\n\"1.25\",\"-3e-2\"\n",
        "note,z,t\n\"a, b\n\"\"c\"\"\",1,0\n,,0.5\nx,-3e-2,1.25\n",
    ] {
        assert_eq!(times_and_z(text), expected, "{text:?}");
    }
}

#[test]
fn lines_are_counted_through_comments_blanks_and_quoted_breaks() {
    let text = "# one\n\r\nz,note\n1,a\n# five\n\n2,\"b\r\nc\"\r\n   \r\n3,\"d\n\ne\"\n4,f";
    let log = read(&spec(None, &["z"]), text).unwrap();
    assert_eq!(log.trajectories[0].line, [4, 7, 10, 13]);
}

#[test]
fn a_line_longer_than_every_buffer_is_one_line() {
    let text = format!("z,note\n1,{}\n2,x\n", "y".repeat(300_000));
    let log = read(&spec(None, &["z"]), text).unwrap();
    assert_eq!(log.trajectories[0].line, [2, 3]);
}

#[test]
fn a_quoted_hash_is_data_and_a_one_column_row_may_be_missing() {
    let data = DataSpec { trajectory: Some("id".to_owned()), ..spec(None, &["z"]) };
    let log = read(&data, "id,z\n\"#1\",5\n").unwrap();
    assert_eq!(log.trajectories[0].id, "#1");
    let log = read(&spec(None, &["z"]), "z\n1\n\"\"\n\nNaN\n2\n").unwrap();
    assert_eq!(known(log.trajectories[0].z.column(0)), [Some(1.0), None, None, Some(2.0)]);
}

#[test]
fn without_a_time_column_rows_of_each_trajectory_count_from_zero() {
    let data = DataSpec { trajectory: Some("id".to_owned()), ..spec(None, &["z"]) };
    let log = read(&data, "id,z\na,1\nb,2\na,3\na,4\nb,5\n").unwrap();
    let ids: Vec<&str> = log.trajectories.iter().map(|t| t.id.as_str()).collect();
    assert_eq!(ids, ["a", "b"]);
    assert_eq!(log.trajectories[0].time, [0.0, 1.0, 2.0]);
    assert_eq!(log.trajectories[1].time, [0.0, 1.0]);
    assert_eq!(known(log.trajectories[0].z.column(0)), [Some(1.0), Some(3.0), Some(4.0)]);
}

#[test]
fn interleaved_trajectories_have_their_own_clocks_and_share_the_iso_origin() {
    let data = DataSpec { trajectory: Some("id".to_owned()), ..spec(Some("t"), &["z"]) };
    let log = read(&data, "id,t,z\na,5,1\nb,2,2\na,6,3\nb,2.5,4\n").unwrap();
    assert_eq!(log.trajectories[0].time, [5.0, 6.0]);
    assert_eq!(log.trajectories[1].time, [2.0, 2.5]);
    let log = read(&data, "id,t,z\na,2024-01-01T00:00:10Z,1\nb,2024-01-01T00:00:04Z,2\n").unwrap();
    assert_eq!(log.trajectories[1].time, [-6.0], "seconds since the first row of the log");
}

#[test]
fn iso_times_become_seconds_since_the_first_row() {
    for text in [
        "t,z\n2024-02-28T23:59:59Z,1\n2024-02-29T00:00:00.5Z,2\n2024-03-01T00:00:00+00:00,3\n",
        "t,z\n2024-02-28 23:59:59,1\n2024-02-29 00:00:00.500,2\n2024-03-01,3\n",
        "t,z\n2024-02-29T00:59:59+01:00,1\n2024-02-28T20:00:00.5-04:00,2\n2024-03-01T05:30:00+05:30[Asia/Kolkata],3\n",
    ] {
        assert_eq!(times_and_z(text).0, [0.0, 1.5, 86401.0], "{text}");
    }
}

#[test]
fn nanoseconds_survive_because_the_origin_is_subtracted_before_rounding() {
    // As doubles since 1970 these three would be one and the same number.
    let text = "t,z\n2024-01-01T00:00:00.000000001Z,1\n2024-01-01T00:00:00.000000002Z,2\n\
                2024-01-01T00:00:00.000000102Z,3\n";
    assert_eq!(times_and_z(text).0, [0.0, 1e-9, 101e-9]);
}

#[test]
fn plain_numbers_stay_as_they_are_even_years() {
    assert_eq!(times_and_z("t,z\n1871,1\n1872,2\n").0, [1871.0, 1872.0]);
}

#[test]
fn inputs_may_be_missing_on_the_last_row_of_each_trajectory_only() {
    let data = DataSpec {
        trajectory: Some("id".to_owned()),
        inputs: vec!["u".to_owned()],
        truth: vec![("d".to_owned(), "d_true".to_owned())],
        ..spec(None, &["z"])
    };
    let log = read(&data, "id,z,u,d_true\na,1,7,1\nb,2,8,\na,,,2\nb,,9,3\nb,1,,nan\n").unwrap();
    assert_eq!(known(log.trajectories[0].u.column(0)), [Some(7.0), None]);
    assert_eq!(known(log.trajectories[1].u.column(0)), [Some(8.0), Some(9.0), None]);
    assert_eq!(known(log.trajectories[1].truth.column(0)), [None, Some(3.0), None]);
    assert_eq!(log.truth, ["d"], "truth is listed by state");
}

#[test]
fn columns_follow_the_problem_not_the_file() {
    let log = read(&spec(None, &["b", "a"]), "a,x,b\n1,text,2\n3,,4\n").unwrap();
    assert_eq!(log.measurements, ["b", "a"]);
    assert_eq!(log.trajectories[0].z.row(1), [4.0, 3.0]);
}
