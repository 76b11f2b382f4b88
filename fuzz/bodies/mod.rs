//! What each fuzz target does with its bytes. `tests/fuzz_seeds.rs` replays the committed seeds through the same code.
//!
//! A target fails by panicking: by a bug of the library, or by one of the assertions here.

mod checkpoint;

pub(crate) use checkpoint::{bodies as checkpoint_bodies, checkpoint};

use kfgpu::data::{DataSpec, Format, Log, Oddity, SensorSpec, Summary, Table, TimeUnit, Trajectory};
use kfgpu::filter;
use kfgpu::model::{self, Problem};
use kfgpu::reference;

/// Any bytes as a log: no panic, times in order, and what is written reads back the same.
pub(crate) fn csv(bytes: &[u8]) {
    for spec in specs() {
        let Ok(log) = Log::read(&spec, bytes, "fuzz.csv") else { continue };
        let increasing = |t: &Trajectory| t.time.windows(2).all(|w| w[0] < w[1]) && !t.is_empty();
        assert!(log.trajectories.iter().all(increasing), "times increase within a trajectory: {log:?}");
        let _ = Summary::of(&log).to_string();
        assert_reads_back(&spec, &log);
    }
    for spec in foreign() {
        if let Ok(log) = Log::read(&spec, bytes, "fuzz.csv") {
            let _ = Summary::of(&log).to_string();
            let _ = Oddity::of(&log);
        }
    }
    let Ok(draft) = model::draft("fuzz.csv".as_ref(), bytes) else { return };
    let problem = Problem::parse(&draft.text, "draft.toml").unwrap_or_else(|e| panic!("{e}\n{}", draft.text));
    assert_eq!(problem.data, draft.data, "what was drafted is what is read");
    let log = Log::read(&draft.data, bytes, "fuzz.csv").unwrap_or_else(|e| panic!("{e}\n{}", draft.text));
    problem.check_log(&log).unwrap_or_else(|e| panic!("{e}\n{}", draft.text));
}

/// The same columns in files of other habits.
fn foreign() -> [DataSpec; 3] {
    let [one, all] = specs();
    let sensor =
        |name: &str| SensorSpec { name: name.to_owned(), columns: vec!["z".to_owned()], when: Some(name.to_owned()) };
    let sensors = DataSpec {
        measurements: vec!["a_z".to_owned(), "b_z".to_owned()],
        sensors: vec![sensor("a"), sensor("b")],
        sensor: Some("id".to_owned()),
        trajectory: None,
        ..all.clone()
    };
    let commas = Format { decimal_comma: true, thousands: Some('.'), skip_lines: vec![3], ..Format::default() };
    let blanks = Format { separator: Some(' '), header_line: Some(1), ..Format::default() };
    [
        DataSpec { format: commas, time_unit: Some(TimeUnit::Microsecond), ..all },
        DataSpec { format: blanks, time: Some("t".to_owned()), time_unit: Some(TimeUnit::Month), ..one },
        sensors,
    ]
}

/// One column only; everything a problem file can name.
fn specs() -> [DataSpec; 2] {
    let one = DataSpec { measurements: vec!["z".to_owned()], ..DataSpec::default() };
    let all = DataSpec {
        time: Some("t".to_owned()),
        measurements: vec!["z".to_owned(), "y".to_owned()],
        inputs: vec!["u".to_owned()],
        truth: vec![("x".to_owned(), "truth".to_owned())],
        trajectory: Some("id".to_owned()),
        ..DataSpec::default()
    };
    [one, all]
}

fn assert_reads_back(spec: &DataSpec, log: &Log) {
    let mut written = Vec::new();
    log.write_csv(spec, &mut written).expect("memory takes everything");
    let again = Log::read(spec, written.as_slice(), "fuzz.csv");
    let again = again.unwrap_or_else(|e| panic!("{e}\n{}", String::from_utf8_lossy(&written)));
    assert_eq!(log.trajectories.len(), again.trajectories.len(), "as many trajectories");
    for (a, b) in log.trajectories.iter().zip(&again.trajectories) {
        assert_eq!((&a.id, &a.time), (&b.id, &b.time), "trajectory and times");
        let same = |a: &Table, b: &Table| (0..a.columns()).all(|i| a.column(i).map(bits).eq(b.column(i).map(bits)));
        assert!(same(&a.z, &b.z) && same(&a.u, &b.u) && same(&a.truth, &b.truth), "{a:?}\n{b:?}");
    }
}

/// All missing values are one.
fn bits(value: f64) -> u64 {
    if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }
}

/// Any text as a problem file: no panic, a message of one line's worth, and a problem that survives being tuned.
pub(crate) fn problem(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let problem = match Problem::parse(text, "fuzz.toml") {
        Ok(problem) => problem,
        Err(error) => return assert!(!error.to_string().is_empty(), "an error says something"),
    };
    let baseline = problem.parameters.baseline();
    let again = Problem::parse(&problem.tuned(&baseline), "tuned.toml");
    let again = again.unwrap_or_else(|e| panic!("a tuned problem file must run: {e}\n{}", problem.tuned(&baseline)));
    assert_eq!(problem.parameters.names(), again.parameters.names(), "tuned.toml has the parameters of its source");
    let small = problem.simulate.as_ref().is_some_and(|s| s.steps.saturating_mul(s.trajectories) <= 100);
    if !small || problem.model.states.len() > 6 || problem.model.measurements.len() > 6 {
        return;
    }
    if let Ok(log) = kfgpu::simulate::simulate(&problem, None) {
        run(&problem, &log);
    }
}

/// Any text as a formula of f, h, Q and R: no panic in reading, evaluating, differentiating, simplifying, scheduling.
pub(crate) fn formula(bytes: &[u8]) {
    let Ok(formula) = std::str::from_utf8(bytes) else { return };
    let quoted = toml_string(formula);
    for (f, h, q) in [(quoted.as_str(), "\"x\"", "1"), ("\"x\"", quoted.as_str(), "1"), ("\"x\"", "\"x\"", &quoted)] {
        let text = format!(
            "[data]\nmeasurements = [\"z\"]\ninputs = [\"u\"]\n[model]\nstate = [\"x\", \"y\"]\nf = [{f}, \"0.5*y\"]\n\
             h = [{h}]\nQ = [{q}, 0.1]\nR = [\"r\"]\nx0 = [1, 2]\nP0 = [1, 2]\n[parameters]\n\
             r = {{ min = 0.1, max = 9, start = 1 }}\np = 0.5\n[simulate]\nsteps = 3\ndt = 0.5\nseed = 1\n"
        );
        if let Ok(problem) = Problem::parse(&text, "fuzz.toml") {
            run(&problem, &three_rows());
        }
    }
}

/// A basic string of TOML.
fn toml_string(text: &str) -> String {
    let escape = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", u32::from(c)),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}

fn three_rows() -> Log {
    let table = |columns: usize, rows: &[&[f64]]| {
        let mut table = Table::new(columns);
        rows.iter().for_each(|row| table.push(row));
        table
    };
    Log {
        source: "fuzz.csv".to_owned(),
        measurements: vec!["z".to_owned()],
        inputs: vec!["u".to_owned()],
        truth: Vec::new(),
        trajectories: vec![Trajectory {
            id: String::new(),
            time: vec![0.0, 0.5, 1.5],
            z: table(1, &[&[1.0], &[f64::NAN], &[-2.0]]),
            u: table(1, &[&[0.25], &[-1.0], &[f64::NAN]]),
            truth: table(0, &[&[], &[], &[]]),
            line: vec![2, 3, 4],
        }],
        ..Log::default()
    }
}

/// The reference and the tape may both refuse, but neither may panic.
fn run(problem: &Problem, log: &Log) {
    if problem.check_log(log).is_err() {
        return;
    }
    let _ = reference::costs(problem, log, &problem.parameters.baseline());
    if let Ok(program) = filter::trace(problem, log, &problem.tune.objectives, None) {
        let _ = program.to_string();
    }
}
