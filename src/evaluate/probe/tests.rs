use super::*;
use crate::data::{Table, Trajectory};
use crate::reference;
use std::path::Path;

fn problem(name: &str, replaced: (&str, &str)) -> (Problem, Log) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).with_extension("toml");
    let text = std::fs::read_to_string(&path).unwrap().replace(replaced.0, replaced.1);
    let problem = Problem::parse(&text, name).unwrap();
    let log = match problem.simulate {
        Some(_) => crate::simulate::simulate(&problem, None).unwrap(),
        None => Log::open(&problem.data, path.parent().unwrap()).unwrap(),
    };
    (problem, log)
}

fn example(name: &str) -> (Problem, Log) {
    problem(name, ("", ""))
}

/// Two states, two trajectories with gaps, and so two kinds of rows.
fn plant() -> (Problem, Log) {
    problem("matlab_plant", ("steps = 500", "steps = 90\nmissing = 0.2\ntrajectories = 2"))
}

/// Baseline, and two candidates around it.
fn candidates(problem: &Problem) -> Vec<Vec<f64>> {
    let at = |share| problem.parameters.searched().map(|(_, search)| search.at(share)).collect();
    vec![problem.parameters.baseline(), at(0.4), at(0.6)]
}

/// About twelve rows all over a trajectory for each candidate, in both precisions.
fn probes(problem: &Problem, log: &Log, t: usize) -> Vec<[Probe; 2]> {
    let scorers = problem.tune.scorers();
    let (double, _) = trace_around(problem, log, &scorers, None, None).unwrap();
    let nominal = single::nominal(problem, log, None).unwrap();
    let (single, nominal) = trace_around(problem, log, &scorers, Some(nominal), None).unwrap();
    let span = single.spans()[t].rows.clone();
    let mut probes = vec![];
    for candidate in candidates(problem) {
        for row in (0..span.len()).step_by((span.len() / 12).max(1)) {
            let nominal = nominal.as_ref().unwrap().row(span.start + row).to_vec();
            let double = Probe::new(&double, (t, row), &candidate, vec![]);
            probes.push([double, Probe::new(&single, (t, row), &candidate, nominal)]);
        }
    }
    probes
}

/// The largest share over the rows, in units of f32's rounding.
fn most(problem: &Problem, log: &Log) -> f64 {
    let of = |probe: &Probe| {
        let (found, expected) = (probe.on_lanes(), probe.in_f64());
        assert_eq!(probe.wrong(&found), None, "the lanes compute what the lanes compute");
        assert_eq!(probe.parting(&found, &expected), None, "{}", probe.program().rows());
        probe.shares(&found, &expected).into_iter().flatten().fold(0.0, f64::max)
    };
    probes(problem, log, 0).iter().map(|[_, single]| of(single)).fold(0.0, f64::max) / f64::from(f32::EPSILON)
}

/// What [`Probe::bound`] rests on: 22 roundings at most, 450 where P is close to singular, 2200 of an adaptive filter.
#[test]
fn ordinary_runs_part_nowhere() {
    let names = ["nile", "rocket", "uav_gps_cv", "uav_gps_ca", "refuelling", "matlab_plant", "tum_fr2_desk"];
    for name in names {
        let (problem, log) = example(name);
        let roundings = most(&problem, &log);
        assert!(roundings < 40.0, "{name}: {roundings}");
    }
    for (name, expected) in [("robot", 900.0), ("rocket_sage_husa", 4000.0)] {
        let (problem, log) = example(name);
        let roundings = most(&problem, &log);
        assert!(roundings < expected, "{name}: {roundings}");
    }
}

#[test]
fn priors_are_those_of_the_reference() {
    let cases = [("nile", example("nile"), 0), ("rocket", example("rocket"), 0), ("plant", plant(), 1)];
    for (name, (problem, log), t) in cases {
        let n = problem.model.states.len();
        for [double, single] in probes(&problem, &log, t) {
            let run = reference::run(&problem, &log, double.candidate()).unwrap();
            let prior = &run.trajectories[t][double.program().rows() - 1].prior;
            let sigma = |i: usize| prior.p[(i, i)].sqrt();
            let upper = (0..n).flat_map(|i| (i..n).map(move |j| (i, j)));
            let x = (0..n).map(|i| (prior.x[i], sigma(i)));
            let expected: Vec<(f64, f64)> =
                x.chain(upper.map(|(i, j)| (prior.p[(i, j)], sigma(i) * sigma(j)))).collect();
            for (probe, bound) in [(&double, 1e-9), (&single, 2e-5)] {
                let found = probe.prior(&probe.on_lanes());
                assert_eq!(found.len(), expected.len(), "{name}");
                for (found, (value, sigma)) in found.iter().zip(&expected) {
                    assert!((found - value).abs() <= bound * sigma, "{name}: {found}, the reference says {value}");
                }
            }
        }
    }
    let (problem, log) = plant();
    let probe = Probe::double(&problem, &log, (1, 40), &problem.parameters.baseline()).unwrap();
    assert_eq!(probe.program().steps().len(), 2, "kinds of rows");
    assert_eq!((probe.program().rows(), probe.program().spans().len()), (41, 1));
}

fn rocket() -> Probe {
    let (problem, log) = example("rocket");
    Probe::single(&problem, &log, (0, 20), &candidates(&problem)[1]).unwrap()
}

#[test]
fn what_an_earlier_row_has_spoiled_is_named() {
    let probe = rocket();
    let expected = probe.on_lanes();
    let names = probe.program().register_names();
    for name in ["P.d.d", "P.a.a", "x.v"] {
        let register = names.iter().position(|known| known == name).unwrap();
        let mut before = expected.before.clone();
        let spread = probe.program().spreads(&before).iter().find(|(r, _)| *r == register).map_or(0.0, |(_, s)| *s);
        before[register] = f32::from_f64(1.01 * (before[register] + spread)).to_f64();
        let found = Seen { values: probe.values::<f32>(&before), before };
        let parting = probe.parting(&found, &expected).unwrap();
        let line = &probe.program().lines(probe.step().0)[parting.operation];
        assert!(line.contains(name), "{name}: {line}");
        assert!(matches!(parting.source, Source::Before { register: r, share } if r == register && share > 0.009));
        assert_eq!(probe.wrong(&found), None, "{name}: the row itself is right");
    }
}

#[test]
fn an_operation_that_a_machine_gets_wrong_is_named() {
    let probe = rocket();
    let right = probe.on_lanes();
    for operation in 0..right.values.len() {
        let mut found = right.clone();
        found.values[operation] *= 1.0 + 1e-3;
        found.values[operation] += 1e-3;
        let (named, share) = probe.wrong(&found).unwrap();
        assert_eq!(named, operation, "{}", probe.program().lines(probe.step().0)[operation]);
        assert!(share > 1e-4, "{share}");
    }
}

/// In absolute coordinates z - x cancels in f32; nothing is off beside 1e8 before what that leaves is used.
#[test]
fn cancellation_is_named_where_it_happens() {
    let text = "[data]\nfile = \"none.csv\"\nmeasurements = [\"z\"]\n[model]\nstate = [\"x\"]\nf = [\"x\"]\nh = [\"x\"]\n\
                Q = [\"q\"]\nR = [1]\nx0 = [1e8]\nP0 = [1]\n[parameters]\nq = { min = 0.01, max = 1, start = 0.1 }\n";
    let problem = Problem::parse(text, "far.toml").unwrap();
    let (mut z, mut none) = (Table::new(1), Table::new(0));
    let time: Vec<f64> = (0_u8..30).map(f64::from).collect();
    for t in &time {
        z.push(&[1e8 + (1.7 * t).sin()]);
        none.push(&[]);
    }
    let line = (2..32).collect();
    let trajectory = Trajectory { id: String::new(), line, time, z, u: none.clone(), truth: none };
    let log = Log { measurements: vec!["z".to_owned()], trajectories: vec![trajectory], ..Log::default() };
    let probe = Probe::double(&problem, &log, (0, 20), &[0.1]).unwrap();
    let lines = probe.program().lines(probe.step().0);
    let bound = 4096.0 * f64::from(f32::EPSILON);
    let parting = probe.parting_beyond(bound, &probe.run::<f32>(), &probe.in_f64()).unwrap();
    let Source::Cancelled { operation, left } = parting.source else { panic!("{parting:?}") };
    assert!(lines[operation].ends_with("= row.0 - x.x"), "{}", lines[operation]);
    assert!(parting.operation > operation && left < 1e-7, "{parting:?}");
    // The deviation form is there so that this does not happen.
    let probe = Probe::single(&problem, &log, (0, 20), &[0.3]).unwrap();
    assert_eq!(probe.parting(&probe.on_lanes(), &probe.in_f64()), None);
}
