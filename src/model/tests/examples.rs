//! Every problem file that ships is read as its comments say.

use std::path::Path;

use crate::model::{First, Problem, Start, Value};

fn example(name: &str) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    Problem::open(&path).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_example_is_read_and_its_data_ship() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let problem = Problem::open(&path).unwrap_or_else(|e| panic!("{e}"));
            if let Some(file) = &problem.data.file {
                assert!(folder.join(file).is_file(), "{}: {file} is missing", path.display());
            }
            count += 1;
        }
    }
    assert_eq!(count, 20, "an example was added or lost");
}

#[test]
fn rocket() {
    let problem = example("rocket.toml");
    let model = &problem.model;
    assert_eq!((model.states.len(), model.measurements.len()), (3, 1));
    assert_eq!(problem.parameters.baseline(), [10.0]);
    assert_eq!(problem.parameters.resolve(&[2.5]), [0.1, 2.5]);
    let zero = |i: usize| model.q[i].is_zero();
    assert!((0..8).all(zero) && !zero(8), "only the acceleration has process noise");
    assert_eq!(model.first, First::Update);
    let simulate = problem.simulate.unwrap();
    assert_eq!((simulate.steps, simulate.skip_first), (200, true));
    assert_eq!(simulate.parameters, [("r".to_owned(), 3.0)]);
}

#[test]
fn refuelling_searches_a_square_factor_without_bounds() {
    let problem = example("refuelling.toml");
    assert_eq!(problem.parameters.names(), ["M11", "M12", "M21", "M22"]);
    assert_eq!(problem.parameters.baseline(), [1.0, 0.0, 0.0, 1.0]);
    let Value::Searched(search) = &problem.parameters.all[1].value else { panic!("M12 is searched") };
    assert_eq!((search.min, search.max, search.init), (f64::NEG_INFINITY, f64::INFINITY, [0.0, 3.1623]));
    assert_eq!(problem.model.x0, Start::Measurement);
    let m = [1.0, 2.0, 3.0, 4.0];
    let r: Vec<f64> = problem.model.r.iter().map(|e| e.evaluate(&|s| value(s, &m))).collect();
    assert_eq!(r, [5.0, 11.0, 11.0, 25.0]);
    assert_eq!(problem.tune.objectives[0].states, [0, 1]);
}

fn value(symbol: crate::model::Symbol, parameters: &[f64]) -> f64 {
    match symbol {
        crate::model::Symbol::Parameter(i) => parameters[i],
        _ => f64::NAN,
    }
}

#[test]
fn robot_em_has_full_covariances() {
    let problem = example("robot_em.toml");
    let q: Vec<f64> = problem.model.q.iter().map(|e| e.evaluate(&|_| f64::NAN)).collect();
    assert!((q[1] - -3.154_716_106_597_41).abs() < 1e-14 && q[1].to_bits() == q[5].to_bits(), "symmetric");
    assert_eq!(problem.parameters.dimension(), 0);
    let mut inputs = 0;
    problem.model.f[4].symbols(&mut |s| inputs += usize::from(s == crate::model::Symbol::Input(4)));
    assert_eq!(inputs, 1);
}

#[test]
fn tum_is_a_built_in_model_with_shared_noise() {
    let problem = example("tum_fr2_desk.toml");
    assert_eq!(problem.model.states, ["x", "y", "z", "vx", "vy", "vz"]);
    assert_eq!(problem.model.kind, Some("constant-velocity"));
    assert_eq!(problem.tune.objectives[0].states, [0, 1, 2]);
}
