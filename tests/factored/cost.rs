//! What the factors cost.

use crate::case::Case;
use kfgpu::evaluate::Precision;
use kfgpu::filter::Form;

#[test]
fn print() {
    for name in ["nile", "rocket", "refuelling", "robot", "uav_gps_cv", "uav_gps_ca", "tum_fr2_desk"] {
        let mut case = Case::example(name);
        case.problem.tune.objectives.truncate(1);
        let chosen = case.program(Precision::F32, None).form;
        for form in [Form::Full, Form::Factored] {
            let p = case.program(Precision::F32, Some(form));
            println!(
                "{name:20} {form:20} {} carried {}{}",
                p.step.counts(),
                p.carried.len(),
                if chosen == form { " *" } else { "" }
            );
        }
    }
}
