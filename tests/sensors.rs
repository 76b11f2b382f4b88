//! Several sensors: lanes against the reference where rows have one time, and forms of a log that mean the same.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use kfgpu::data::Log;
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::model::Problem;
use kfgpu::random::{Purpose, Stream};
use kfgpu::reference;
use std::num::NonZero;
use std::path::Path;

/// A train: speed ten times a second and position every second, rows of a sensor each.
fn train() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/two_sensors.toml");
    std::fs::read_to_string(path).unwrap()
}

fn readings() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/train.csv");
    std::fs::read_to_string(path).unwrap()
}

fn open(problem: &str, csv: &str) -> (Problem, Log) {
    let problem = Problem::parse(problem, "p.toml").unwrap_or_else(|error| panic!("{error}"));
    let log = Log::read(&problem.data, csv.as_bytes(), "log.csv").unwrap_or_else(|error| panic!("{error}"));
    problem.check_log(&log).unwrap_or_else(|error| panic!("{error}"));
    (problem, log)
}

/// Candidates all over the ranges on their logarithm.
fn candidates(problem: &Problem, count: u64) -> Population {
    let mut population = Population::new(problem.parameters.dimension());
    for i in 0..count {
        let mut stream = Stream::new(3, Purpose::Workload, 0, i);
        let draw = |(_, s): (_, &kfgpu::model::Search)| s.min * (s.max / s.min).powf(stream.uniform());
        let candidate: Vec<f64> = problem.parameters.searched().map(draw).collect();
        population.push(&candidate);
    }
    population
}

/// Costs on the lanes, a list a candidate.
fn lanes(problem: &Problem, log: &Log, population: &Population, precision: Precision) -> Vec<Vec<f64>> {
    let options = CpuOptions { precision, threads: NonZero::new(1) };
    let evaluation = CpuEvaluator::new(problem, log, options).unwrap().evaluate(population);
    (0..population.len()).map(|i| evaluation.costs(i).to_vec()).collect()
}

fn worst(found: &[Vec<f64>], expected: &[Vec<f64>]) -> f64 {
    let off = |(a, b): (&f64, &f64)| (a - b).abs() / b.abs().max(1.0);
    let each = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(off).fold(0.0, f64::max);
    assert_eq!(found.len(), expected.len(), "as many candidates");
    found.iter().zip(expected).map(each).fold(0.0, f64::max)
}

const EVERYTHING: &str = r#"objectives = ["nll", "mse_innovation", "mismatch", "nis", "nees", "rmse", "distance"]"#;

/// With a form of P and an f of their own, and where x starts far off.
#[test]
fn lanes_equal_the_reference_where_rows_have_one_time() {
    let plain = train().replace("objectives = [\"nll\"]", EVERYTHING);
    let diffuse = plain.replace("[100, 400]", "[1e9, 1e9]");
    let adaptive = plain.clone() + "[filter]\nkind = \"sage-husa-r\"\nfloor = 0.2\n";
    for text in [&plain, &diffuse, &adaptive] {
        let (problem, log) = open(text, &readings());
        let population = candidates(&problem, 33);
        let expected: Vec<Vec<f64>> =
            population.rows().map(|candidate| reference::costs(&problem, &log, candidate).unwrap()).collect();
        let error = worst(&lanes(&problem, &log, &population, Precision::F64), &expected);
        assert!(error < 1e-9, "f64 is off by {error:.1e}");
        let nll = |costs: &[Vec<f64>]| costs.iter().map(|c| vec![c[0] / log.rows() as f64]).collect::<Vec<_>>();
        let error = worst(&nll(&lanes(&problem, &log, &population, Precision::F32)), &nll(&expected));
        assert!(error < 1e-5, "f32 is off by {error:.1e} a row");
    }
}

/// Rows of one time put side by side, each sensor in a column of its own; truth as it was.
fn wide(csv: &str) -> String {
    let mut rows: Vec<[String; 5]> = Vec::new();
    for line in csv.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        if rows.last().is_none_or(|row| row[0] != cells[0]) {
            rows.push([cells[0], "", "", cells[3], cells[4]].map(str::to_owned));
        }
        let column = if cells[1] == "wheel" { 1 } else { 2 };
        rows.last_mut().unwrap()[column] = cells[2].to_owned();
    }
    let lines: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
    format!("t,speed,place,s_true,v_true\n{}\n", lines.join("\n"))
}

/// The problem for columns of their own, without labels.
fn unlabelled() -> String {
    let text =
        train().replace("sensor = \"sensor\"\n", "").replace("when = \"wheel\"\n", "").replace("when = \"gps\"\n", "");
    let text = text.replacen("[\"value\"]", "[\"speed\"]", 1);
    text.replacen("[\"value\"]", "[\"place\"]", 1)
}

/// One filter over all columns, without sensors.
fn single() -> String {
    let text = train();
    let (head, rest) = text.split_once("[[sensor]]").unwrap();
    let (_, tail) = rest.split_once("[model]\n").unwrap();
    let data = head.replace("sensor = \"sensor\"\n", "measurements = [\"speed\", \"place\"]\n");
    format!("{data}[model]\nh = [\"v\", \"s\"]\nR = [\"r_wheel\", \"r_gps\"]\n{tail}")
}

#[test]
fn sensors_without_labels_have_the_bits_of_one_model_of_all_columns() {
    let csv = wide(&readings());
    for precision in [Precision::F64, Precision::F32] {
        let costs = [unlabelled(), single()].map(|text| {
            let (problem, log) = open(&text.replace("objectives = [\"nll\"]", EVERYTHING), &csv);
            lanes(&problem, &log, &candidates(&problem, 17), precision)
        });
        assert_eq!(costs[0], costs[1], "{precision}");
    }
}

#[test]
fn a_log_in_long_form_has_the_likelihood_of_the_wide_one() {
    let (long, long_log) = open(&train(), &readings());
    let (wide, wide_log) = open(&unlabelled(), &wide(&readings()));
    assert_eq!((long_log.rows(), wide_log.rows()), (652, 601));
    let population = candidates(&long, 33);
    let costs = [(&long, &long_log), (&wide, &wide_log)].map(|(p, l)| lanes(p, l, &population, Precision::F64));
    let error = worst(&costs[0], &costs[1]);
    assert!(error < 1e-11, "off by {error:.1e}");
}

#[test]
fn the_order_of_sensors_at_one_time_does_not_matter() {
    let csv = readings();
    let mut lines: Vec<&str> = csv.lines().collect();
    for k in 1..lines.len() - 1 {
        if lines[k].contains(",wheel,") && lines[k + 1].contains(",gps,") {
            lines.swap(k, k + 1);
        }
    }
    let (problem, log) = open(&train(), &csv);
    let (_, swapped) = open(&train(), &(lines.join("\n") + "\n"));
    assert_ne!(log.trajectories[0].z, swapped.trajectories[0].z, "rows have changed places");
    let population = candidates(&problem, 33);
    let costs = [&log, &swapped].map(|log| lanes(&problem, log, &population, Precision::F64));
    let error = worst(&costs[0], &costs[1]);
    assert!(error < 1e-11, "off by {error:.1e}");
}

/// A sensor that moves: what it measures is relative to where it is in the row that it measures in.
#[test]
fn inputs_of_h_are_those_of_the_row_that_measures() {
    let csv = readings();
    let own = |line: usize| (line as f64 * 0.37).sin() * 5.0;
    let moved = csv.lines().enumerate().map(|(line, text)| {
        let mut cells: Vec<String> = text.split(',').map(str::to_owned).collect();
        let is_gps = cells[1] == "gps";
        if is_gps {
            cells[2] = (cells[2].parse::<f64>().unwrap() - own(line)).to_string();
        }
        cells.push(match line {
            0 => "own".to_owned(),
            _ if is_gps => own(line).to_string(),
            _ => String::new(),
        });
        cells.join(",")
    });
    let moved: Vec<String> = moved.collect();
    let text =
        train().replace("h = [\"s\"]", "h = [\"s - own\"]").replace("time = \"t\"", "time = \"t\"\ninputs = [\"own\"]");
    let (problem, log) = open(&text, &(moved.join("\n") + "\n"));
    let (still, still_log) = open(&train(), &csv);
    let population = candidates(&still, 17);
    let expected = lanes(&still, &still_log, &population, Precision::F64);
    let error = worst(&lanes(&problem, &log, &population, Precision::F64), &expected);
    assert!(error < 1e-11, "off by {error:.1e}");
}

/// A filter of any f and h: sensors in the wide form are the model of all columns, to the bit.
#[test]
fn nonlinear_filters_take_sensors_as_well() {
    let filter = "[filter]\nkind = \"extended\"\n";
    let bend = |text: String| {
        text.replace("[\"s\"]", "[\"s + 0.001*s^2\"]").replace("\"v\", \"s\"]\nR", "\"v\", \"s + 0.001*s^2\"]\nR")
            + filter
    };
    let csv = wide(&readings());
    let costs = [unlabelled(), single()].map(|text| {
        let (problem, log) = open(&bend(text), &csv);
        assert_eq!(problem.filter.name(), "extended");
        lanes(&problem, &log, &candidates(&problem, 9), Precision::F64)
    });
    assert_eq!(costs[0], costs[1]);
    let (problem, log) = open(&bend(train()), &readings());
    let long = lanes(&problem, &log, &candidates(&problem, 9), Precision::F64);
    let error = worst(&long, &costs[0]);
    assert!(error < 0.1, "h is linearised once more where rows have one time, and little else differs: {error:.1e}");
    for kind in ["extended", "iterated", "unscented", "cubature"] {
        let (problem, log) = open(&bend(train()).replace("extended", kind), &readings());
        let population = candidates(&problem, 9);
        let expected: Vec<Vec<f64>> =
            population.rows().map(|candidate| reference::costs(&problem, &log, candidate).unwrap()).collect();
        let error = worst(&lanes(&problem, &log, &population, Precision::F64), &expected);
        assert!(error < 1e-8, "{kind}: off by {error:.1e}");
    }
}
