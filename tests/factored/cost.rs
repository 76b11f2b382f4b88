//! What the factors cost, in operations of one step.

use crate::case::Case;
use kfgpu::evaluate::Precision;
use kfgpu::filter::{Form, Program};

/// Constant velocity on three axes that share q but have each its own r: three different filters.
const CV_3D: &str = r#"
[data]
time = "t"
measurements = ["x", "y", "z"]
[model]
kind = "constant-velocity"
axes = ["x", "y", "z"]
noise = "continuous"
q = "q"
R = ["r1", "r2", "r3"]
x0 = [0, 0, 0, 0, 0, 0]
P0 = [1e6, 1e6, 1e6, 1e6, 1e6, 1e6]
[parameters]
q = { min = 1e-3, max = 10, start = 0.1 }
r1 = { min = 0.1, max = 10, start = 1 }
r2 = { min = 0.1, max = 10, start = 1 }
r3 = { min = 0.1, max = 10, start = 1 }
[tune]
algorithm = "pso"
objectives = ["nll"]
[simulate]
steps = 20
x0 = [1, 2, 3, 4, 5, 6]
"#;

fn program(case: &Case, form: Form) -> Program {
    case.program(Precision::F32, Some(form))
}

#[test]
fn three_axes_fall_apart() {
    let program = program(&Case::simulated("CV 3-D", CV_3D), Form::Factored);
    let mut names: Vec<&str> = program.carried().iter().map(|c| c.name.as_str()).collect();
    names.retain(|name| name.starts_with("U.") || name.starts_with("D."));
    names.sort_unstable();
    assert_eq!(names, ["D.vx", "D.vy", "D.vz", "D.x", "D.y", "D.z", "U.x.vx", "U.y.vy", "U.z.vz"]);
}

/// Flops of a step with its nll; a change is to be seen.
#[test]
fn operations_of_both_forms() {
    let cases = [
        (Case::example("rocket"), [50, 70]),
        (Case::simulated("CV 3-D", CV_3D), [81, 117]),
        // The three axes share q and r, and so one covariance.
        (Case::example("uav_gps_cv"), [49, 61]),
        (Case::example("robot"), [655, 805]),
    ];
    let mut changed = vec![];
    for (case, expected) in cases {
        let counts = [Form::Full, Form::Factored].map(|form| program(&case, form).counts());
        counts.iter().for_each(|counts| println!("{:12} {counts}", case.name));
        if counts.map(|c| c.flops) != expected {
            changed.push(case.name);
        }
    }
    assert!(changed.is_empty(), "other flops than noted: {changed:?}");
}
