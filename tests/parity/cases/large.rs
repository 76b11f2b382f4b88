//! Coordinates hundreds of kilometres from the origin, where only the deviation form saves single precision.

use crate::case::{ALL, Case, Single, Text};
use crate::logs::{Gap, Interval, Shape};

pub(crate) fn cases() -> Vec<Case> {
    let rocket = "state = [\"d\", \"v\", \"a\"]\nf = [\"d + v*dt + 0.5*a*dt^2\", \"v + a*dt\", \"a\"]\nh = [\"d\"]\nQ = { a = \"q\" }\nR = [\"r\"]\nx0 = [400000, 2000, 20]\nP0 = [30, 20, 10]";
    let rocket = Text { truth: &["d", "v", "a"], model: rocket, objectives: ALL, ..Text::BASIC };
    let cv = "kind = \"constant-velocity\"\naxes = [\"x\", \"y\", \"z\"]\nq = \"q\"\nR = [\"r\", \"r\", \"r\"]\nP0 = [10, 10, 10, 10, 10, 10]\n";
    let at = format!("{cv}x0 = [500000, -300000, 700000, 200, 100, -50]");
    let measured = format!("{cv}x0 = \"measurement\"");
    let cv = Text {
        measurements: &["x", "y", "z"],
        truth: &["x", "y", "z", "vx", "vy", "vz"],
        model: &at,
        objectives: ALL,
        ..Text::BASIC
    };
    let biased = "state = [\"d\", \"v\"]\nf = [\"d + v*dt\", \"v\"]\nh = [\"d + bias\"]\nQ = { v = \"q\" }\nR = [\"r\"]\nx0 = [\"400000 + d0\", 100]\nP0 = [30, 20]";
    let parameters = format!(
        "{}\nbias = {{ min = -3, max = 3, start = 0 }}\nd0 = {{ min = -5, max = 5, start = 0 }}",
        Text::BASIC.parameters
    );
    let biased = Text { truth: &["d", "v"], model: biased, parameters: &parameters, objectives: ALL, ..Text::BASIC };
    // A gain off by 1 % moves the innovation by kilometres.
    let gain = biased.model.replace("d + bias", "d*(1 + bias/300)");
    let scaled = Text { model: &gain, ..biased };
    let irregular = Shape::regular(&[120]).every(Interval::Irregular(0.5)).without(&[Gap::Components(0.2)]);
    vec![
        Case::new("rocket at 400 km", &rocket, Shape::regular(&[200]), 257),
        Case::new("rocket at 400 km, irregular", &rocket, irregular, 257),
        Case::new("cv at 500 km", &cv, irregular, 40),
        Case::new("cv at 500 km, x0 measured", &Text { model: &measured, ..cv }, irregular.from(500_000.0), 40),
        Case::new("searched bias and x0 at 400 km", &biased, Shape::regular(&[150]), 257),
        Case::new("searched gain at 400 km", &scaled, Shape::regular(&[150]), 65).single(Single::Measured),
    ]
}
