//! Every picture: what it names, and that hostile logs and studies cannot break it.

use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::chart::tests::{any_value, texts};
use crate::data::Log;
use crate::evaluate::mock::{Landscape, Mock};
use crate::evaluate::{CpuEvaluator, CpuOptions, Device, Evaluation, Evaluator, Population, Status};
use crate::model::Problem;
use crate::reference;
use crate::report::Evidence;
use crate::simulate::simulate;
use crate::study::Generation;

fn example(name: &str) -> Problem {
    Problem::open(&Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)).unwrap()
}

/// Every picture of a run, with the names that are on it.
fn of_run(problem: &Problem, log: &Log) -> Vec<(&'static str, Vec<String>)> {
    of_record(RunRecord::new(problem, log), problem, log)
}

fn of_record(mut record: RunRecord<'_>, problem: &Problem, log: &Log) -> Vec<(&'static str, Vec<String>)> {
    let candidate = problem.parameters.baseline();
    let mut evidence = Evidence::new(problem, log);
    reference::visit(problem, log, &candidate, &mut |trajectory, step| {
        record.add(trajectory, step);
        evidence.add(trajectory, step);
    })
    .unwrap();
    if let Some(trajectory) = record.finish() {
        let smoothed = reference::smooth(problem, log, &candidate).unwrap();
        record.add_smoothed(smoothed[trajectory].iter().map(|row| (row.time, &row.estimate)));
    }
    let whiteness = evidence.judge(problem, &candidate).whiteness;
    let figures = [
        ("estimates", Some(record.estimates())),
        ("errors", record.errors()),
        ("innovations", Some(record.innovations())),
        ("nis", Some(record.nis())),
        ("autocorrelation", Some(record.autocorrelation(&whiteness))),
        ("histogram", Some(record.histogram())),
    ];
    figures.into_iter().filter_map(|(name, figure)| Some((name, texts(&figure?.to_svg().unwrap())))).collect()
}

fn expect(pictures: &[(&str, Vec<String>)], name: &str, expected: &[&str]) {
    let (_, found) = pictures.iter().find(|(picture, _)| *picture == name).expect("the picture is drawn");
    for text in expected {
        assert!(found.iter().any(|t| t == text), "{name}: {text:?} is missing of {found:?}");
    }
}

/// A row of history with its cost.
fn generation(generation: usize, best: Option<f64>) -> Generation {
    Generation {
        generation,
        evaluations: 10,
        best,
        median: best.map(|b| b + 2.0),
        spread: best.map(|_| 1.0),
        failed: 0,
        feasible: 10,
        front: None,
        hypervolume: None,
        seconds: 0.1,
    }
}

#[test]
fn pictures_of_a_run_name_what_they_show() {
    let problem = example("rocket.toml");
    let log = simulate(&problem, None).unwrap();
    let found = of_run(&problem, &log);
    let legend = ["3-sigma band", "measured", "truth", "smoothed", "estimate"];
    expect(&found, "estimates", &[&["rocket: estimates", "k", "d", "v", "a"][..], &legend].concat());
    expect(&found, "errors", &["rocket: estimation errors", "error of v", "estimate minus truth"]);
    expect(&found, "innovations", &["innovation of range", "± 2 sqrt(S)", "k"]);
    expect(&found, "nis", &["NIS", "95 % band"]);
    expect(&found, "autocorrelation", &["lag [measured rows]", "autocorrelation", "95 % band"]);
    let title = "range: 200 values, 2 beyond ±8 in the outer bars";
    expect(&found, "histogram", &["normalised innovation", "density", "N(0, 1)", title]);
}

#[test]
fn pictures_say_where_held_out_rows_begin() {
    let problem = example("rocket.toml");
    let log = simulate(&problem, None).unwrap();
    let by = crate::data::SplitBy::Time;
    let held_out = crate::data::HeldOut { from: vec![141], share: 0.3, by, log };
    let found = of_record(RunRecord::of_held_out(&problem, &held_out), &problem, &held_out.log);
    for picture in ["estimates", "errors", "innovations", "nis"] {
        expect(&found, picture, &["held-out rows begin"]);
    }
    expect(&found, "histogram", &["rocket: normalised innovations of the held-out rows", "range: 60 values"]);
    let (_, nis) = found.iter().find(|(name, _)| *name == "nis").unwrap();
    assert!(nis.iter().any(|text| text.ends_with("% of 60 held-out rows in the band")), "{nis:?}");
    assert!(of_run(&problem, &held_out.log).iter().all(|(_, texts)| !texts.iter().any(|t| t.contains("held-out"))));
}

#[test]
fn of_several_trajectories_the_least_consistent_is_drawn() {
    let mut problem = example("rocket.toml");
    if let Some(spec) = &mut problem.simulate {
        spec.trajectories = 3;
    }
    let mut log = simulate(&problem, None).unwrap();
    let spoilt = &mut log.trajectories[1];
    let far: Vec<f64> = spoilt.z.column(0).enumerate().map(|(k, z)| if k > 100 { z + 500.0 } else { z }).collect();
    spoilt.z = crate::data::Table::new(1);
    far.iter().for_each(|z| spoilt.z.push(&[*z]));
    let id = if log.trajectories[1].id.is_empty() { "2".to_owned() } else { log.trajectories[1].id.clone() };
    let found = of_run(&problem, &log);
    let title = format!("rocket: innovations (trajectory {id}: largest mean NIS of 3)");
    expect(&found, "innovations", &[&title]);
}

#[test]
fn logs_of_one_row_with_gaps_or_without_any_measurement_are_drawn() {
    let problem = example("rocket.toml");
    for (text, what) in [
        ("k,range,d,v,a\n0,990,,,\n", "one row"),
        ("k,range,d,v,a\n0,,1,2,3\n1,,1,2,3\n2,5e3,,,\n", "nearly all missing"),
        ("k,range,d,v,a\n0,990,1,2,3\n1,990,1,2,3\n2,990,1,2,3\n", "all equal"),
        ("k,range,d,v,a\n0,990,1,2,3\n1,1e150,1,2,3\n", "huge"),
    ] {
        let log = Log::read(&problem.data, text.as_bytes(), "log.csv").unwrap();
        assert!(of_run(&problem, &log).len() >= 5, "{what}");
    }
}

#[test]
fn nis_far_below_its_band_is_in_the_picture() {
    let problem = example("nile.toml");
    let log = Log::open(&problem.data, &Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap();
    let svg = |problem: &Problem, candidate: &[f64]| {
        let mut record = RunRecord::new(problem, &log);
        reference::visit(problem, &log, candidate, &mut |trajectory, step| record.add(trajectory, step)).unwrap();
        record.finish();
        record.nis().to_svg().unwrap()
    };
    // Each dot is a stroke without extent.
    let dots = |svg: &str| svg.matches("h0").count();
    let [usual, absurd] = [[15_000.0, 1_500.0], [1e12, 1e11]].map(|candidate| dots(&svg(&problem, &candidate)));
    assert!(usual > 90 && absurd > 80, "dots of 100 rows: {usual}, and with a vast R {absurd}");
}

/// Dots of 5,000 rows would cover one another, and the one row in twenty outside the band would look like half of them.
#[test]
fn a_long_log_is_drawn_as_shares() {
    let mut problem = example("rocket.toml");
    if let Some(spec) = &mut problem.simulate {
        spec.steps = 4999;
    }
    let log = simulate(&problem, None).unwrap();
    let found = of_run(&problem, &log);
    let legend = ["middle 95 % of every 50 rows", "middle 50 %", "median"];
    expect(&found, "nis", &[&legend[..], &["95 % band", "highest of them"]].concat());
    expect(&found, "innovations", &[&legend[..], &["± 2 sqrt(S)", "highest and lowest of them"]].concat());
    expect(&found, "errors", &legend);
    expect(&found, "estimates", &["measured, the extremes of every 2 rows"]);
    let short = of_run(&example("rocket.toml"), &simulate(&example("rocket.toml"), None).unwrap());
    assert!(short.iter().all(|(_, texts)| !texts.iter().any(|t| t.starts_with("middle"))), "{short:?}");
}

const MOVING: &str = r#"
[data]
file = "log.csv"
time = "t"
measurements = ["east", "up"]
[model]
kind = "constant-velocity"
axes = ["n", "e"]
noise = "continuous"
q = "q"
R = ["r", "r"]
x0 = [0, 0, 0, 0]
P0 = [1, 1, 1, 1]
[parameters]
q = { min = 0.01, max = 100, start = 1 }
r = { min = 0.01, max = 100, start = 1 }
[tune]
objectives = ["nll"]
"#;

/// 100 rows a second apart with a gap of 400 s in the middle, the track far away after it.
fn with_a_gap(gap: u32) -> Log {
    let problem = Problem::parse(MOVING, "moving.toml").unwrap();
    let row = |k: u32| {
        let (t, away) = if k < 50 { (k, 0) } else { (k + gap, 100 * gap) };
        format!("{t},{},{}\n", away + k * 7 % 3, k * 5 % 4)
    };
    let csv: String = std::iter::once("t,east,up\n".to_owned()).chain((0..100).map(row)).collect();
    Log::read(&problem.data, csv.as_bytes(), "log.csv").unwrap()
}

#[test]
fn a_gap_does_not_hide_the_other_innovations() {
    let problem = Problem::parse(MOVING, "moving.toml").unwrap();
    expect(&of_run(&problem, &with_a_gap(0)), "innovations", &["innovation of east", "± 2 sqrt(S)"]);
    let found = of_run(&problem, &with_a_gap(400));
    expect(&found, "innovations", &["innovation of east / √S", "innovation of up / √S", "± 2"]);
}

#[test]
fn a_track_is_seen_from_above_with_north_up() {
    let problem = Problem::parse(MOVING, "moving.toml").unwrap();
    let log = with_a_gap(0);
    let mut record = RunRecord::new(&problem, &log);
    assert_eq!(record.plan(), None, "nothing ran");
    reference::visit(&problem, &log, &problem.parameters.baseline(), &mut |i, step| record.add(i, step)).unwrap();
    record.finish();
    let found = texts(&record.plan().expect("two axes").to_svg().unwrap());
    for expected in ["moving: track from above", "measured", "estimate", "first row"] {
        assert!(found.iter().any(|t| t == expected), "{expected:?} is missing of {found:?}");
    }
    let place = |name: &str| found.iter().position(|t| t == name).expect(name);
    assert!(place("e") < place("n"), "x is named before y: {found:?}");
    let level = example("nile.toml");
    assert_eq!(plan::Axes::of(&level, &log), None);
    assert_eq!(plan::Axes::of(&problem, &log).map(|axes| axes.states), Some([1, 0]));
}

#[test]
fn unix_times_are_dates() {
    let problem = Problem::parse(&MOVING.replace("axes = [\"n\", \"e\"]", "axes = [\"a\", \"b\"]"), "m.toml").unwrap();
    let csv: String = (0..90).map(|k| format!("{},{k},1\n", 1_700_000_000 + 20 * k)).collect();
    let log = Log::read(&problem.data, format!("t,east,up\n{csv}").as_bytes(), "log.csv").unwrap();
    expect(&of_run(&problem, &log), "nis", &["time from 2023-11-14 [UTC]", "22:20", "22:40"]);
}

#[test]
fn convergence_copes_with_any_history() {
    let problem = example("rocket.toml");
    let histories = [
        vec![],
        vec![generation(0, None)],
        vec![generation(0, Some(-3.0)), generation(1, Some(-3.0))],
        vec![generation(0, Some(1e9)), generation(1, Some(2.0)), generation(2, Some(f64::MAX))],
    ];
    for history in histories {
        let found = texts(&convergence(&problem, &history).to_svg().unwrap());
        for expected in ["nll [nats]", "best so far", "median of the generation", "interquartile range", "generation"] {
            assert!(found.iter().any(|t| t == expected), "{expected:?} is missing of {found:?}");
        }
        let volumes = history.iter().map(|row| (row.generation, row.best.unwrap_or(f64::NAN)));
        assert!(!texts(&hypervolume(&problem, volumes).to_svg().unwrap()).is_empty(), "{history:?}");
    }
}

/// Fails every other candidate, or all.
struct Failing(bool);

impl Evaluator for Failing {
    fn objectives(&self) -> usize {
        1
    }

    fn evaluate(&mut self, population: &Population) -> Evaluation {
        let status = (0..population.len()).map(|i| if self.0 || i % 2 == 0 { Status::NOT_FINITE } else { Status::OK });
        Evaluation::new(1, vec![1.0; population.len()], status.collect())
    }

    fn device(&self) -> Device {
        Mock::new(Landscape::Sphere).device()
    }
}

#[test]
fn the_cost_around_the_winner_is_sliced_or_contoured() {
    let cases = [("rocket.toml", "r [m^2]"), ("matlab_plant.toml", "q")];
    for (name, parameter) in cases {
        let problem = example(name);
        let log = simulate(&problem, None).unwrap();
        let baseline = problem.parameters.baseline();
        let winner: Vec<f64> = baseline.iter().map(|value| 0.5 * value).collect();
        let mut evaluator = CpuEvaluator::new(&problem, &log, CpuOptions::default()).unwrap();
        let found = texts(&landscape(&problem, &winner, &baseline, 300, &mut evaluator).to_svg().unwrap());
        for expected in [parameter, "tuned", "baseline"] {
            assert!(found.iter().any(|t| t == expected), "{name}: {expected:?} is missing of {found:?}");
        }
        assert!(!found.iter().any(|t| t == "no data"), "{name}: {found:?}");
        for all in [true, false] {
            let svg = landscape(&problem, &winner, &baseline, 300, &mut Failing(all)).to_svg().unwrap();
            assert!(!texts(&svg).is_empty(), "{name} with failures");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn any_front_is_drawn(
        values in prop::collection::vec(any_value(), 0..40),
        objectives in 0..5usize,
        knee in prop::option::of(0..9usize),
        baseline in prop::option::of(prop::collection::vec(any_value(), 0..5)),
    ) {
        let names = ["nll", "rmse", "nis", "mismatch"];
        let members: Vec<&[f64]> = values.chunks(objectives.max(1)).collect();
        let title = "front";
        let objectives = &names[..objectives.min(4)];
        let baseline = baseline.as_deref();
        let front = FrontPicture { title, objectives, members: &members, knee, recommended: knee, baseline };
        texts(&front.scatter().to_svg().unwrap());
        let problem = example("matlab_plant.toml");
        let own = problem.parameters.baseline();
        texts(&front.parallel(&problem.parameters, &members, &own).to_svg().unwrap());
    }
}

#[test]
fn a_front_has_its_ends_its_knee_and_the_baseline() {
    let points = [[1.0, 9.0], [2.0, 3.0], [8.0, 2.0]];
    let members: Vec<&[f64]> = points.iter().map(|p| &p[..]).collect();
    let front = FrontPicture {
        title: "front",
        objectives: &["nll", "rmse"],
        members: &members,
        knee: Some(1),
        recommended: Some(0),
        baseline: Some(&[10.0, 10.0]),
    };
    let drawn = |front: FrontPicture<'_>| texts(&front.scatter().to_svg().unwrap());
    let found = drawn(front);
    for expected in ["nll [nats]", "rmse", "front", "best nll", "best rmse", "knee", "recommended", "baseline"] {
        assert!(found.iter().any(|t| t == expected), "{expected:?} is missing of {found:?}");
    }
    let problem = example("matlab_plant.toml");
    let own = problem.parameters.baseline();
    let lines = texts(&front.parallel(&problem.parameters, &members, &own).to_svg().unwrap());
    for expected in [&problem.parameters.names()[..], &["nll", "rmse", "best rmse", "knee", "baseline"]].concat() {
        assert!(lines.iter().any(|t| t == expected), "{expected:?} is missing of {lines:?}");
    }
    let far = drawn(FrontPicture { baseline: Some(&[1e7, 10.0]), ..front });
    assert!(far.iter().any(|t| t.starts_with("baseline, far outside at (1.000e7, 10.00)")), "{far:?}");
}
