//! Models x objectives x log shapes.

mod adaptive;
mod built_in;
mod correlated;
mod diffuse;
mod failing;
mod formulas;
mod gaps;
mod imm;
mod large;
mod manoeuvres;
mod nonlinear;
mod objectives;
pub(crate) mod robust;

use crate::case::Case;
use kfgpu::data::Log;
use kfgpu::model::Problem;
use kfgpu::simulate::simulate;
use std::path::Path;

/// An example with the log that ships with it, or that it simulates.
fn example(name: &str) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(format!("{name}.toml"));
    let problem = Problem::open(&path).unwrap_or_else(|e| panic!("{name}: {e}"));
    let log = match &problem.data.file {
        Some(_) => Log::open(&problem.data, path.parent().unwrap()).unwrap(),
        None => simulate(&problem, None).unwrap(),
    };
    // The reference takes its time over sigma points and tables.
    let candidates = if log.rows() > 400 || !problem.filter.is_linear() { 17 } else { 257 };
    Case::of(name.to_owned(), problem, log, candidates)
}

pub(crate) fn all() -> Vec<Case> {
    let examples = [
        "nile",
        "rocket",
        "rocket_sage_husa",
        "refuelling",
        "robot",
        "uav_gps_cv",
        "uav_gps_ca",
        "tum_fr2_desk",
        "radar",
        "reentry",
        "battery",
    ];
    let mut cases: Vec<Case> = examples.map(example).into();
    cases.extend(adaptive::cases());
    cases.extend(built_in::cases());
    cases.extend(formulas::cases());
    cases.extend(correlated::cases());
    cases.extend(failing::cases());
    cases.extend(robust::cases());
    cases.extend(large::cases());
    cases.extend(manoeuvres::cases());
    cases.extend(diffuse::cases());
    cases.extend(gaps::cases());
    cases.extend(imm::cases());
    cases.extend(nonlinear::cases());
    cases.extend(objectives::cases());
    cases
}
