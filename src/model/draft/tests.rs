use std::fmt::Write;
use std::fs::File;
use std::path::PathBuf;

use proptest::prelude::*;
use rand_distr::{Distribution, StandardNormal};

use super::*;
use crate::data::Log;
use crate::model::Problem;
use crate::random::{Purpose, Stream};
use crate::reference;

fn of(text: &str) -> Draft {
    draft(Path::new("log.csv"), text.as_bytes()).unwrap()
}

/// The draft of a log that ships with the examples, its problem and its log.
fn shipped(name: &str) -> (Draft, Problem, Log) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/data");
    let draft = draft(Path::new(name), File::open(folder.join(name)).unwrap()).unwrap();
    let problem = Problem::parse(&draft.text, "draft.toml").unwrap_or_else(|e| panic!("{name}: {e}\n{}", draft.text));
    let log = Log::open(&problem.data, &folder).unwrap();
    (draft, problem, log)
}

/// The start of a searched parameter.
fn start(draft: &Draft, name: &str) -> f64 {
    let problem = Problem::parse(&draft.text, "draft.toml").unwrap();
    let (_, search) = problem.parameters.searched().find(|(p, _)| p.name == name).unwrap();
    search.start.unwrap()
}

/// A log of one column `z` every `dt` seconds: a level or a position with noise of the given variances.
fn simulated(rows: usize, dt: f64, q: f64, r: f64, is_motion: bool) -> String {
    let mut stream = Stream::new(5, Purpose::Workload, 0, 0);
    let mut normal = || -> f64 { StandardNormal.sample(&mut stream) };
    let (mut x, mut v) = (0.0, 0.0);
    let mut text = "t,z\n".to_owned();
    for k in 0..rows {
        let _ = writeln!(text, "{},{}", k as f64 * dt, x + r.sqrt() * normal());
        // Exact sampling of integrated white noise: the position gets v dt and the part of the noise v does not have.
        let kick = (q * dt).sqrt() * normal();
        if is_motion {
            x += v * dt + 0.5 * dt * kick + (q * dt.powi(3) / 12.0).sqrt() * normal();
            v += kick;
        } else {
            x += kick;
        }
    }
    text
}

#[test]
fn drafts_of_every_shipped_log_parse_and_their_baselines_run() {
    for name in ["nile.csv", "uav_gps.csv", "tum_fr2_desk.csv", "robot.csv", "train.csv"] {
        let (_, problem, log) = shipped(name);
        problem.check_log(&log).unwrap_or_else(|e| panic!("{name}: {e}"));
        let costs = reference::costs(&problem, &log, &problem.parameters.baseline()).unwrap();
        assert!(costs[0].is_finite(), "{name}: {costs:?}");
    }
}

#[test]
fn nile_is_a_local_level_close_to_its_optimum() {
    let (draft, problem, log) = shipped("nile.csv");
    assert_eq!(problem.model.kind, Some("local-level"));
    assert_eq!(draft.data.time.as_deref(), Some("year"));
    // The optimum is r = 15100, q = 1469 (Durbin and Koopman 2012, section 2.10).
    let (r, q) = (start(&draft, "r_volume"), start(&draft, "q_volume"));
    assert!((7500.0..30000.0).contains(&r) && (500.0..4500.0).contains(&q), "r {r}, q {q}");
    let nll = |candidate: &[f64]| reference::costs(&problem, &log, candidate).unwrap()[0];
    assert!(nll(&problem.parameters.baseline()) < nll(&[15099.0, 1469.1]) + 2.0, "the start is near the optimum");
}

#[test]
fn tracks_are_constant_velocity_and_truth_finds_its_states() {
    let (draft, problem, _) = shipped("tum_fr2_desk.csv");
    assert_eq!(problem.model.states, ["x", "y", "z", "vx", "vy", "vz"]);
    let truth = [("x", "x_true"), ("y", "y_true"), ("z", "z_true")].map(|(s, c)| (s.to_owned(), c.to_owned()));
    assert_eq!(draft.data.truth, truth);
    assert_eq!(draft.data.measurements, ["zx", "zy", "zz"]);
    let (draft, ..) = shipped("uav_gps.csv");
    assert_eq!(draft.data.measurements, ["e", "n", "u"]);
    assert!(draft.text.contains("not taken: \"speed\", \"heading\", \"vx\", \"vy\"."), "{}", draft.text);
    let (draft, ..) = shipped("robot.csv");
    assert_eq!(draft.data.measurements, ["z0", "z1"]);
    assert!(draft.text.contains("Looks like truth, but of no state of this model: \"x0_true\""), "{}", draft.text);
}

#[test]
fn starts_are_within_a_factor_of_two_of_the_truth_of_simulated_logs() {
    let near = |value: f64, truth: f64| (0.5..2.0).contains(&(value / truth));
    for (dt, q, r) in [(1.0, 0.4, 9.0), (0.1, 2.0, 0.5)] {
        let level = of(&simulated(4000, dt, q, r, false));
        assert!(level.text.contains("\"local-level\""), "{}", level.text);
        let found = (start(&level, "r_z"), start(&level, "q_z"));
        assert!(near(found.0, r) && near(found.1, q), "level dt {dt}: r, q = {found:?}, expected {r}, {q}");
    }
    for (dt, q, r) in [(1.0, 0.05, 4.0), (0.1, 1.0, 1e-3)] {
        let motion = of(&simulated(4000, dt, q, r, true));
        assert!(motion.text.contains("\"constant-velocity\""), "{}", motion.text);
        let found = (start(&motion, "r_z"), start(&motion, "q_z"));
        assert!(near(found.0, r) && near(found.1, q), "motion dt {dt}: r, q = {found:?}, expected {r}, {q}");
    }
}

#[test]
fn roles_are_guessed_by_name_then_by_content() {
    let draft =
        of("run,when,note,fixed,range (m),gt_d\nb,2024-01-01,x,1,5,0\na,2024-01-01,y,1,4,0\nb,2024-01-02,z,1,6,1\n");
    assert_eq!(draft.data.trajectory.as_deref(), Some("run"));
    assert_eq!(draft.data.time.as_deref(), Some("when"), "the first column that increases within each run");
    assert_eq!(draft.data.measurements, ["range (m)"]);
    assert!(draft.text.contains("# Left out: \"note\" (text), \"fixed\" (constant).\n"), "{}", draft.text);
    assert!(draft.text.contains("R = { \"range (m)\" = \"r_range__m_\" }"), "{}", draft.text);
    Problem::parse(&draft.text, "draft.toml").unwrap();
}

#[test]
fn a_time_that_does_not_increase_is_not_used_and_the_draft_says_where() {
    let draft = of("time,z\n0,1\n1,3\n1,2\n");
    assert_eq!((draft.data.time, draft.data.measurements), (None, vec!["z".to_owned()]));
    assert!(draft.text.contains("Column \"time\" cannot be the time: it stands still at line 4"), "{}", draft.text);
    assert!(draft.warnings[0].contains("stands still at line 4"), "{:?}", draft.warnings);
}

#[test]
fn a_counter_or_unnamed_index_is_no_measurement_and_one_rising_column_is_no_time() {
    let draft = of(",frame,z,t\n0,7,1,0.5\n1,8,5,0.6\n2,9,3,0.7\n");
    assert_eq!((draft.data.time.as_deref(), draft.data.measurements), (Some("t"), vec!["z".to_owned()]));
    let draft = of(",frame,z\n0,7,1\n1,8,5\n2,9,3\n");
    assert_eq!((draft.data.time.as_deref(), draft.data.measurements), (Some("frame"), vec!["z".to_owned()]));
    let draft = of("z\n1\n2\n4\n");
    assert_eq!((draft.data.time, draft.data.measurements), (None, vec!["z".to_owned()]));
}

#[test]
fn five_slow_columns_are_a_random_walk_by_formulas() {
    let mut stream = Stream::new(6, Purpose::Workload, 0, 0);
    let mut text = "t,a,b,c,d,e\n".to_owned();
    for k in 0..100 {
        let cells: [f64; 5] = std::array::from_fn(|_| StandardNormal.sample(&mut stream));
        let _ = writeln!(text, "{k},{}", cells.map(|z| z.to_string()).join(","));
    }
    let problem = Problem::parse(&of(&text).text, "draft.toml").unwrap();
    assert_eq!((problem.model.kind, problem.model.states.len()), (None, 5));
    let log = Log::read(&problem.data, text.as_bytes(), "log.csv").unwrap();
    let costs = reference::costs(&problem, &log, &problem.parameters.baseline()).unwrap();
    assert!(costs[0].is_finite(), "{costs:?}");
}

#[test]
fn what_cannot_be_drafted_says_why() {
    let message = |text: &str| draft(Path::new("log.csv"), text.as_bytes()).unwrap_err().to_string();
    assert_eq!(message("t,z\n"), "log.csv: has a header but no row");
    assert_eq!(message("t,note\n0,a\n1,b\n"), "log.csv: no column of changing numbers that could be a measurement");
    assert!(message("0,1\n1,2\n").starts_with("log.csv:1: expected a header"), "{}", message("0,1\n1,2\n"));
    assert_eq!(message("t,z\n0,1\n1\n"), "log.csv:3: expected as many cells as the header has, 2, found 1");
}

proptest! {
    #[test]
    fn any_column_names_give_a_draft_that_parses_and_reads_its_log(
        names in prop::collection::hash_set("[a-z\"'(é#%]{1,3}|v?x|a?x|[qr]_x|x_true|dt|pi|sqrt|state|t|id", 1..7),
        cells in prop::collection::vec(prop::array::uniform7(-99_i32..99), 2..30),
    ) {
        let mut csv = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(Vec::new());
        csv.write_record(&names).unwrap();
        for row in &cells {
            csv.write_record(row.iter().take(names.len()).map(ToString::to_string)).unwrap();
        }
        let text = csv.into_inner().unwrap();
        if let Ok(draft) = draft(Path::new("log.csv"), text.as_slice()) {
            let problem = Problem::parse(&draft.text, "draft.toml");
            prop_assert!(problem.is_ok(), "{}\n{}", problem.unwrap_err(), draft.text);
            let problem = problem.unwrap();
            prop_assert_eq!(&problem.data, &draft.data);
            let log = Log::read(&draft.data, text.as_slice(), "log.csv");
            prop_assert!(log.is_ok(), "{}", log.unwrap_err());
            let costs = reference::costs(&problem, &log.unwrap(), &problem.parameters.baseline());
            prop_assert!(matches!(&costs, Ok(c) if c[0].is_finite()), "{:?}\n{}", costs, draft.text);
        }
    }

    /// Sensors that report when they like, in several trajectories, in any unit: what is drafted is accepted.
    #[test]
    fn drafts_of_logs_with_gaps_are_accepted(
        rows in prop::collection::vec((0..3_u8, prop::array::uniform4(prop::option::weighted(0.4, -99_i32..99))), 2..40),
        unit in prop::sample::select(vec!["t", "t_ms", "stamp_us", "time [ns]", "t_min", "day"]),
        labelled in any::<bool>(),
    ) {
        let mut text = format!("{}{unit},a,b,current,lat\n", if labelled { "id," } else { "" });
        for (k, (id, cells)) in rows.iter().enumerate() {
            let cells: Vec<String> = cells.iter().map(|cell| cell.map_or_else(String::new, |v| v.to_string())).collect();
            let label = if labelled { format!("{id},") } else { String::new() };
            let _ = writeln!(text, "{label}{},{}", 1_600_000_000_000_u64 + 100 * k as u64, cells.join(","));
        }
        let Ok(draft) = draft(Path::new("log.csv"), text.as_bytes()) else { return Ok(()) };
        let problem = Problem::parse(&draft.text, "draft.toml");
        prop_assert!(problem.is_ok(), "{}\n{}", problem.unwrap_err(), draft.text);
        let problem = problem.unwrap();
        prop_assert_eq!(&problem.data, &draft.data);
        let log = Log::read(&draft.data, text.as_bytes(), "log.csv");
        prop_assert!(log.is_ok(), "{}\n{}", log.unwrap_err(), draft.text);
        let log = log.unwrap();
        prop_assert!(problem.check_log(&log).is_ok(), "{:?}\n{}\n{}", problem.check_log(&log), draft.text, text);
        let costs = reference::costs(&problem, &log, &problem.parameters.baseline());
        prop_assert!(matches!(&costs, Ok(c) if c[0].is_finite()), "{:?}\n{}", costs, draft.text);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let _ = draft(Path::new("log.csv"), bytes.as_slice());
    }
}

#[test]
fn a_column_of_words_may_say_which_sensor_a_row_is_of() {
    let (draft, _, _) = shipped("train.csv");
    let advice = "column \"sensor\" seems to say which sensor a row is of (\"wheel\", \"gps\"): give sensor = \"sensor\" in \
                  [data], and for each a [[sensor]] table with when = \"wheel\" or the like";
    assert!(draft.warnings.iter().any(|w| w.starts_with(advice)), "{:?}", draft.warnings);
    assert!(draft.text.contains("# Note: column \"sensor\" seems to say"), "{}", draft.text);
    let weather = "t,sky,z\n0,dry,1\n1,wet,2\n2,dry,1.5\n3,wet,1\n4,dry,2\n5,wet,1\n6,dry,1.2\n";
    assert!(of(weather).warnings.iter().all(|w| !w.contains("which sensor")), "words of another kind");
}
