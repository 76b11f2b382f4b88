//! Unicycle: a robot that knows how far it went and turned in each step, by its wheels or a gyro. Midpoint rule: it goes
//! along its mean heading.

use super::{BuiltIn, Keys, Leading, Motion, Noise, call, dt, over, plus, times};
use crate::model::error::Fault;
use crate::model::{Expr, Function, Symbol};

/// States: the heading in radians from the first axis towards the second, then the positions. The heading comes first, because
/// the root of P of a sigma-point filter is the cheapest where what enters f nonlinearly comes first.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "unicycle",
    axes: [2, 2],
    leading: Some(Leading { name: "heading", angle: true, unless: None }),
    components: &[""],
    strengths: &["q", "q_heading", "ds", "dth"],
    read,
};

/// x + ds cos(heading + dth / 2), and so on.
fn read(keys: &dyn Keys) -> Result<Motion, Fault> {
    let (noise, q, q_heading) = (keys.noise()?, keys.strengths("q")?, keys.strength("q_heading")?);
    let (ds, dth) = (keys.known("ds", "the distance of each step")?, keys.known("dth", "the turn of each step")?);
    let [heading, x, y] = [0, 1, 2].map(|i| Expr::symbol(Symbol::State(i)));
    let middle = plus(heading.clone(), over(dth.clone(), Expr::number(2.0)));
    let along = |function: Function| times(ds.clone(), call(function, std::slice::from_ref(&middle)));
    let f = vec![plus(heading, dth), plus(x.clone(), along(Function::Cos)), plus(y.clone(), along(Function::Sin))];
    let mut motion = Motion { f, h: vec![x, y], q: vec![Expr::number(0.0); 9] };
    for (i, strength) in std::iter::once(q_heading).chain(q).enumerate() {
        motion.q[4 * i] = match noise {
            Noise::Continuous => times(strength, dt(1)),
            Noise::Piecewise => strength,
        };
    }
    Ok(motion)
}
