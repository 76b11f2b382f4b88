//! The f64 reference against values that were not computed by it: other programs, closed forms, rules worked by hand.
//!
//! Nothing else in kfgpu is trusted before these pass, because everything else is compared with the reference.

mod adaptive;
mod adaptive_study;
mod amplification;
mod calibration;
mod diffuse;
mod examples;
mod gap;
mod held_out;
mod imm;
mod joint;
mod joint_density;
mod library;
mod linear_kinds;
mod nonlinear;
mod nonlinear_smoother;
mod robust;
mod rules;
mod simulated;
mod smoother;
mod support;
mod uncertainty;
mod values;
mod verdicts;
