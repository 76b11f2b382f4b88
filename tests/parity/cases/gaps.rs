//! Long gaps: P grows in the middle of a log as at a diffuse start, and what was predicted through the gap is far off.

use crate::case::{ALL, Case, INNOVATIONS, Single, Text};
use crate::logs::{Gap, Interval, Shape, draw};
use kfgpu::data::Table;

const SHAPE: Shape = Shape::regular(&[150]).every(Interval::Irregular(0.008));

/// A hand-held tracker out of sight for so many seconds, then where it was.
const SECONDS: [f64; 4] = [5.0, 60.0, 600.0, 3600.0];

pub(crate) fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = SECONDS.map(tracker).into();
    cases.extend([stretch("constant-velocity"), stretch("constant-acceleration"), two_sensors(), blind()]);
    cases
}

fn tracker(seconds: f64) -> Case {
    let model = "kind = \"constant-acceleration\"\naxes = [\"x\", \"y\"]\nq = \"q\"\nR = [\"r\", \"r\"]\nx0 = [0, 0, 0, 0, 0, 0]\n\
                 P0 = [0.01, 0.01, 1, 1, 10, 10]";
    let parameters = "q = { min = 0.1, max = 1000, scale = \"log\", start = 10 }\n\
                      r = { min = 1e-6, max = 1e-2, scale = \"log\", start = 1e-4 }";
    let text = Text { measurements: &["x", "y"], model, parameters, objectives: INNOVATIONS, ..Text::BASIC };
    let problem = text.problem();
    let mut log = draw(&problem, SHAPE, 11);
    log.trajectories[0].time[80..].iter_mut().for_each(|time| *time += seconds);
    let case = Case::of(format!("tracker, gap of {seconds} s"), problem, log, 65);
    if seconds > 1000.0 { case.single(Single::Refused) } else { case }
}

/// Many rows without a measurement.
fn stretch(kind: &str) -> Case {
    let n = if kind == "constant-velocity" { 2 } else { 3 };
    let model = format!(
        "kind = \"{kind}\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = {:?}\nP0 = {:?}",
        vec![0; n],
        vec![10; n]
    );
    let truth = &["x", "vx", "ax"][..n];
    let text = Text { truth, model: &model, objectives: ALL, ..Text::BASIC };
    let away = Shape::regular(&[200, 60]).without(&[Gap::Away { component: None, rows: (40, 160) }]);
    let case = Case::new(format!("{kind}, 120 rows missing"), &text, away, 65);
    // Over 120 rows a third integral of noise leaves f32 no seven digits of every objective.
    if n == 3 { case.single(Single::Refused) } else { case }
}

/// The position is lost while the speed is still measured.
fn two_sensors() -> Case {
    let model = "state = [\"x\", \"v\", \"w\"]\nf = [\"x + v*dt + w*dt\", \"v\", \"w\"]\nh = [\"x\", \"v\"]\nQ = [0, \"q\", \"q/9\"]\n\
                 R = [\"r/100\", \"r\"]\nx0 = [0, 0, 0]\nP0 = [4, 4, 4]";
    let text = Text { measurements: &["x", "v"], truth: &["x", "v", "w"], model, objectives: ALL, ..Text::BASIC };
    let away = Shape::regular(&[200]).without(&[Gap::Away { component: Some(0), rows: (40, 160) }]);
    Case::new("position lost, speed measured", &text, away, 65)
}

/// Measured all the time, but for 200 rows through an input of 0: what is measured there says nothing of the state.
fn blind() -> Case {
    let model = |h: &str| {
        format!(
            "state = [\"x\", \"v\", \"a\"]\nf = [\"x + v*dt + a*dt^2/2\", \"v + a*dt\", \"a\"]\nh = [\"{h}\"]\n\
             Q = {{ a = \"q\" }}\nR = [\"r\"]\nx0 = [0, 0, 0]\nP0 = [10, 10, 10]"
        )
    };
    let text = |inputs, model: &str| Text { inputs, model, objectives: INNOVATIONS, ..Text::BASIC }.problem();
    let (lit, dark) = (model("x"), model("u*x"));
    let mut log = draw(&text(&[], &lit), Shape::regular(&[400]), 65);
    let (mut z, mut u) = (Table::new(1), Table::new(1));
    let trajectory = &mut log.trajectories[0];
    for k in 0..trajectory.len() {
        let hidden = (40..240).contains(&k);
        u.push(&[if hidden { 0.0 } else { 1.0 }]);
        z.push(&[if hidden { [0.5, -0.3, -0.7, 0.4][k % 4] } else { trajectory.z.row(k)[0] }]);
    }
    (trajectory.z, trajectory.u) = (z, u);
    log.inputs = vec!["u".to_owned()];
    Case::of("measured through an input of 0".to_owned(), text(&["u"], &dark), log, 65)
}
