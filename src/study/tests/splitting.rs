//! Which rows are held out, and splits that cannot be.

use crate::data::{Log, SplitBy};
use crate::model::{Problem, ProblemError};
use crate::simulate::simulate;
use crate::study::{Split, scoring_rows};

fn problem(data: &str, rest: &str) -> Problem {
    let text = format!(
        "[data]\nmeasurements = [\"z\"]\n{data}\n[model]\nkind = \"local-level\"\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\n\
         P0 = [3]\n[parameters]\nq = {{ min = 0.1, max = 1 }}\nr = {{ min = 0.1, max = 1 }}\n{rest}"
    );
    Problem::parse(&text, "p.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Trajectories of these lengths, interleaved where they overlap.
fn csv(lengths: &[usize]) -> String {
    let rows = (0..10).flat_map(|k| (1..).zip(lengths).filter(move |(_, n)| k < **n).map(move |(t, _)| (t, k)));
    rows.fold("t,z\n".to_owned(), |text, (t, k)| format!("{text}run{t},{t}.{k}\n"))
}

fn split(validate: &str, csv: &str) -> Result<Split, ProblemError> {
    let problem = problem(&format!("file = \"log.csv\"\ntrajectory = \"t\"\n{validate}"), "");
    Split::of(&problem, Log::read(&problem.data, csv.as_bytes(), "log.csv").unwrap())
}

fn names(log: &Log) -> Vec<&str> {
    log.trajectories.iter().map(|t| t.id.as_str()).collect()
}

fn lengths(log: &Log) -> Vec<usize> {
    log.trajectories.iter().map(|t| t.len()).collect()
}

#[test]
fn trajectories_are_held_out_evenly_and_the_last_always() {
    for (share, count, held) in [
        ("0.3", 10, "run4 run7 run10"),
        ("0.3", 3, "run3"),
        ("0.5", 4, "run2 run4"),
        ("0.8", 4, "run2 run3 run4"),
        ("{ share = 0.25, by = \"trajectory\" }", 2, "run2"),
    ] {
        let all = csv(&vec![2; count]);
        let parted = split(&format!("validate = {share}"), &all).unwrap_or_else(|e| panic!("{e}"));
        let held_out = parted.held_out.expect("something is held out");
        assert_eq!(names(&held_out.log).join(" "), held, "{share} of {count}");
        assert_eq!((held_out.by, held_out.rows()), (SplitBy::Trajectory, 2 * held_out.log.trajectories.len()));
        assert_eq!(parted.train.trajectories.len() + held_out.log.trajectories.len(), count);
    }
}

#[test]
fn by_time_the_last_rows_of_each_trajectory_are_held_out_but_never_its_first() {
    let text = csv(&[10, 3, 1]);
    let parted = split("validate = { share = 0.6, by = \"time\" }", &text).unwrap_or_else(|e| panic!("{e}"));
    let held_out = parted.held_out.expect("something is held out");
    assert_eq!((lengths(&parted.train), held_out.from.clone()), (vec![4, 1, 1], vec![4, 1, 1]));
    assert_eq!((held_out.by, held_out.rows(), held_out.log.rows()), (SplitBy::Time, 8, 14));
    assert_eq!(parted.train.trajectories[0].z.row(3), [1.3], "the earlier rows train");
    let one = split("validate = 0.3", &csv(&[10])).unwrap().held_out.unwrap();
    assert_eq!((one.by, one.from), (SplitBy::Time, vec![7]), "one trajectory is parted in time");
}

#[test]
fn nothing_is_held_out_unless_asked_for() {
    for validate in ["", "validate = false"] {
        let whole = split(validate, &csv(&[4, 4])).unwrap();
        assert_eq!((whole.held_out, whole.train.rows()), (None, 8), "{validate:?}");
    }
}

#[test]
fn fresh_realisations_are_held_out_of_a_simulated_log() {
    let table = "[simulate]\nsteps = 5\ntrajectories = 4\n";
    let parted = |validate: &str, table: &str| {
        let problem = problem(validate, table);
        Split::of(&problem, simulate(&problem, None).unwrap()).unwrap_or_else(|e| panic!("{e}"))
    };
    let split = parted("validate = 0.3", table);
    let held_out = split.held_out.unwrap();
    // 0.3 of all is 1.71 beside 4.
    assert_eq!((names(&split.train).join(" "), names(&held_out.log).join(" ")), ("1 2 3 4".into(), "5 6".into()));
    let six = problem("", &table.replace("= 4", "= 6"));
    let six = simulate(&six, None).unwrap();
    assert_eq!(held_out.log.trajectories, six.trajectories[4..], "those that a longer log would go on with");
    assert_eq!(split.train.trajectories, six.trajectories[..4]);

    let single = parted("validate = 0.1", "[simulate]\nsteps = 5\n");
    assert_eq!(single.held_out.unwrap().log.trajectories.len(), 1, "at least one");
    let in_time = parted("validate = { share = 0.5, by = \"time\" }", table);
    assert_eq!(lengths(&in_time.train), [3; 4]);
}

#[test]
fn what_leaves_nothing_is_refused_with_its_place() {
    let two = csv(&[4, 4]);
    let by_time = |share: &str| format!("validate = {{ share = {share}, by = \"time\" }}");
    let cases = [
        (
            "validate = 0.1",
            two.as_str(),
            "5:12: `data.validate`: 0.1 of the 2 trajectories of log.csv rounds to none, so nothing is held out (give more)",
        ),
        (
            "validate = 0.8",
            &two,
            "5:12: `data.validate`: 0.8 of the 2 trajectories of log.csv rounds to all, so nothing is left to train on (give less)",
        ),
        (
            &by_time("0.1"),
            &two,
            "5:12: `data.validate`: 0.1 of the 4 rows (in the longest trajectory) of log.csv rounds to none, so nothing is held out (give more)",
        ),
        (
            &by_time("0.99"),
            &two,
            "5:12: `data.validate`: 0.99 of the 4 rows (in the longest trajectory) of log.csv rounds to all, so nothing is left to train on (give less)",
        ),
        (
            "validate = { share = 0.5, by = \"trajectory\" }",
            &csv(&[4]),
            "5:12: `data.validate`: validation by trajectory needs at least two, and log.csv has one (use by = \"time\")",
        ),
    ];
    for (validate, csv, expected) in cases {
        let error = split(validate, csv).unwrap_err().to_string();
        assert_eq!(error.lines().next(), Some(format!("p.toml:{expected}").as_str()), "{validate}");
    }
}

#[test]
fn each_objective_needs_a_row_to_score_in_each_part() {
    let parted = |tune: &str, model: &str, csv: &str| {
        let data = "file = \"log.csv\"\ntime = \"t\"\ntruth = { z = \"truth\" }\nvalidate = 0.5";
        let mut problem = problem(data, &format!("[tune]\nobjectives = [{tune}]\n"));
        if !model.is_empty() {
            problem = Problem::parse(&problem.text.replace("x0 = [0]", model), "p.toml").unwrap();
        }
        let log = Log::read(&problem.data, csv.as_bytes(), "log.csv").unwrap();
        Split::of(&problem, log).map(drop).map_err(|e| e.to_string().lines().next().unwrap().to_owned())
    };
    let log = "t,z,truth\n0,1,\n1,2,\n2,,1\n3,,1\n";
    let none = |part: &str, objective: &str, needs: &str| {
        Err(format!(
            "p.toml:6:12: `data.validate`: no {part} row of log.csv scores under the objective `{objective}`, which needs \
             {needs} there (give another share)"
        ))
    };
    assert_eq!(parted("\"nll\"", "", log), none("held-out", "nll", "a measurement"));
    assert_eq!(parted("{ name = \"nll\", skip = 2 }", "", log), none("training", "nll", "a measurement"));
    let truth = parted("\"rmse\"", "", log).unwrap_err();
    assert!(truth.starts_with("p.toml:6:12: `data.validate`: the training rows of log.csv cannot serve"), "{truth}");
    let truth = parted("\"rmse\"", "", "t,z,truth\n0,1,1\n1,2,1\n2,1,\n3,1,\n").unwrap_err();
    assert!(truth.contains("the held-out rows of log.csv cannot serve") || truth.contains("held-out row"), "{truth}");
    // Row 0 gives x0 and does not update.
    let start = "t,z,truth\n0,1,\n1,,1\n2,1,1\n3,1,1\n";
    assert_eq!(parted("\"nll\"", "x0 = \"measurement\"", start), none("training", "nll", "a measurement"));
    let late = "t,z,truth\n0,,\n1,,1\n2,1,1\n3,1,1\n";
    let error = parted("\"nll\"", "x0 = \"measurement\"", late).unwrap_err();
    assert!(error.contains("the training rows of log.csv cannot serve by themselves: x0 = \"measurement\""), "{error}");
}

#[test]
fn rows_that_score_are_counted_as_the_filter_does() {
    let problem =
        problem("file = \"log.csv\"\ntruth = { z = \"truth\" }", "[tune]\nobjectives = [\"nll\", \"rmse\"]\n");
    let log = Log::read(&problem.data, "z,truth\n1,\n,2\n3,3\n,\n5,5\n".as_bytes(), "log.csv").unwrap();
    let [nll, rmse] = &problem.tune.objectives[..] else { panic!("two objectives") };
    assert_eq!((scoring_rows(&problem, &log, &[0], nll), scoring_rows(&problem, &log, &[0], rmse)), (3, 3));
    assert_eq!((scoring_rows(&problem, &log, &[2], nll), scoring_rows(&problem, &log, &[3], rmse)), (2, 1));
    let mut from_measurement = problem.clone();
    from_measurement.model.x0 = crate::model::Start::Measurement;
    assert_eq!(scoring_rows(&from_measurement, &log, &[0], nll), 2, "the first only starts the filter");
}

/// What outliers are taken for must not change with the rows that are scored.
#[test]
fn held_out_rows_are_judged_by_the_ranges_of_training() {
    let text = csv(&[10, 3]);
    for validate in ["{ share = 0.5, by = \"time\" }", "{ share = 0.5, by = \"trajectory\" }"] {
        let parted = split(&format!("validate = {validate}"), &text).unwrap_or_else(|e| panic!("{e}"));
        let held_out = parted.held_out.expect("something is held out");
        let own = Log { ranges: None, ..held_out.log.clone() }.ranges();
        assert_eq!(held_out.log.ranges(), parted.train.ranges(), "{validate}");
        assert_ne!(held_out.log.ranges(), own, "{validate}");
    }
}
