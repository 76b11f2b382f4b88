use super::*;
use std::path::Path;

fn example(name: &str) -> (Problem, Log) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name).with_extension("toml");
    let problem = Problem::open(&path).unwrap();
    let log = match problem.simulate {
        Some(_) => crate::simulate::simulate(&problem, None).unwrap(),
        None => Log::open(&problem.data, path.parent().unwrap()).unwrap(),
    };
    (problem, log)
}

/// Baseline, and two candidates around it.
fn candidates(problem: &Problem) -> Vec<Vec<f64>> {
    let at = |share| problem.parameters.searched().map(|(_, search)| search.at(share)).collect();
    vec![problem.parameters.baseline(), at(0.4), at(0.6)]
}

/// Rows all over the first trajectory, each with the program traced once.
fn probes(problem: &Problem, log: &Log) -> Vec<Probe> {
    let nominal = single::nominal(problem, log, None).unwrap();
    let (program, nominal) = trace_around(problem, log, &problem.tune.scorers(), Some(nominal), None).unwrap();
    let rows = program.spans()[0].rows.len();
    let mut probes = vec![];
    for candidate in candidates(problem) {
        for row in (0..rows).step_by((rows / 12).max(1)) {
            let nominal = nominal.as_ref().unwrap().row(row).to_vec();
            probes.push(Probe::new(&program, (0, row), &candidate, nominal));
        }
    }
    probes
}

#[test]
fn measure() {
    for name in [
        "nile",
        "rocket",
        "uav_gps_cv",
        "uav_gps_ca",
        "robot",
        "refuelling",
        "rocket_sage_husa",
        "matlab_plant",
        "tum_fr2_desk",
        "robot_em",
    ] {
        let (problem, log) = example(name);
        let mut most = 0.0_f64;
        for probe in probes(&problem, &log) {
            let (f32, f64) = (probe.on_lanes(), probe.in_f64());
            let shares = probe.shares(&f32, &f64);
            let here = shares.into_iter().flatten().fold(0.0, f64::max);
            if here > 3e-5 {
                let p = probe.parting(&f32, &f64);
                println!("{name} row {} {here:e} {p:?}", probe.program().rows() - 1);
            }
            most = most.max(here);
            assert_eq!(probe.wrong(&f32), None);
        }
        println!("{name}: {most:e} = {} eps", most / f64::from(f32::EPSILON));
    }
}
