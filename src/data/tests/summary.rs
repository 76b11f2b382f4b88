use super::*;
use crate::data::Summary;

const IRREGULAR: &str = "id,t,z,u,x\na,0,1,1,\na,1,,1,2\na,3,2,1,2\na,3.5,4,,1\nb,10,,5,1\n";

fn summary() -> Summary {
    let data = DataSpec {
        trajectory: Some("id".to_owned()),
        inputs: vec!["u".to_owned()],
        truth: vec![("d".to_owned(), "x".to_owned())],
        ..spec(Some("t"), &["z"])
    };
    Summary::of(&read(&data, IRREGULAR).unwrap())
}

#[test]
fn a_summary_counts_what_is_there() {
    let summary = summary();
    assert_eq!((summary.rows, summary.trajectories, summary.span), (5, 2, [0.0, 10.0]));
    let dt = summary.dt.unwrap();
    assert_eq!((dt.min, dt.median, dt.max, dt.regular), (0.5, 1.0, 2.0, false));
    let missing: Vec<_> = summary.columns.iter().map(|c| (c.name.as_str(), c.role, c.missing)).collect();
    assert_eq!(missing, [("z", "measurement", 2), ("u", "input", 1), ("d", "truth", 1)]);
    assert!((summary.columns[0].share - 0.4).abs() < 1e-15, "{}", summary.columns[0].share);
}

#[test]
fn a_summary_prints_in_three_lines() {
    assert_eq!(
        summary().to_string(),
        "log.csv: 5 rows in 2 trajectories, time 0 to 10 s\n  \
         dt: min 0.5, median 1, max 2 s, irregular\n  \
         missing: z 2 (40.0 %), input u 1 (20.0 %), truth d 1 (20.0 %)"
    );
    let regular = read(&spec(None, &["z"]), "z\n1\n2\n3\n4\n").unwrap();
    assert_eq!(
        Summary::of(&regular).to_string(),
        "log.csv: 4 rows in 1 trajectory, time 0 to 3 s\n  dt: 1 s, regular\n  missing: none in 1 column"
    );
    let single = read(&spec(None, &["z"]), "z\n1\n").unwrap();
    assert!(Summary::of(&single).to_string().contains("dt: none"), "one row has no interval");
}

#[test]
fn the_median_of_an_even_number_of_intervals_lies_between_the_middle_two() {
    let log = read(&spec(Some("t"), &["z"]), "t,z\n0,1\n1,1\n3,1\n10,1\n14,1\n").unwrap();
    let dt = Summary::of(&log).dt.unwrap();
    assert_eq!((dt.min, dt.median, dt.max), (1.0, 3.0, 7.0));
}
