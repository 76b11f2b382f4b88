//! Coordinated turn: constant speed and turn rate in a plane, but for noise (Bar-Shalom, Li and Kirubarajan 2001, section
//! 11.7). A positive rate turns from the first axis to the second.

use super::{BuiltIn, Keys, Leading, Motion, Noise, call, constant_velocity, dt, minus, plus, times};
use crate::model::error::Fault;
use crate::model::{Expr, Function, Symbol};

/// States: the turn rate in radians, unless `rate` says it, then the positions and velocities. The rate comes first, because the
/// root of P of a sigma-point filter is the cheapest where what enters f nonlinearly comes first.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "coordinated-turn",
    axes: [2, 2],
    leading: Some(Leading { name: "w", angle: false, unless: Some("rate") }),
    components: &["", "v"],
    strengths: &["q", "q_rate", "rate"],
    read,
};

/// Q is that of constant velocity on each axis, and of a rate that wanders.
fn read(keys: &dyn Keys) -> Result<Motion, Fault> {
    let (noise, q) = (keys.noise()?, keys.strengths("q")?);
    let mut motion = match keys.has("rate") {
        true if keys.has("q_rate") => {
            return Err(
                keys.refuse("q_rate", "it is the noise of a rate that is estimated: remove it or `rate`".to_owned())
            );
        }
        true => turn(keys.known("rate", "the turn rate")?, 0),
        false => turn(Expr::symbol(Symbol::State(0)), 1),
    };
    let (n, first) = (motion.f.len(), motion.f.len() - 4);
    for (axis, strength) in q.iter().enumerate() {
        for (i, entry) in
            constant_velocity::process_noise(noise, std::slice::from_ref(strength)).into_iter().enumerate()
        {
            motion.q[(first + i / 2 * 2 + axis) * n + first + i % 2 * 2 + axis] = entry;
        }
    }
    if first == 1 {
        let strength = keys.strength("q_rate")?;
        motion.q[0] = match noise {
            Noise::Continuous => times(strength, dt(1)),
            Noise::Piecewise => strength,
        };
    }
    Ok(motion)
}

/// x + (sin a / w) vx - ((1 - cos a) / w) vy and so on with a = w dt, the quotients as dt sinc a and dt cosc a, which have a
/// value at w = 0. `first` states come before x.
fn turn(rate: Expr, first: usize) -> Motion {
    let n = first + 4;
    let [x, y, vx, vy] = [0, 1, 2, 3].map(|i| Expr::symbol(Symbol::State(first + i)));
    let angle = times(rate, dt(1));
    let of = |function: Function, state: &Expr| times(call(function, std::slice::from_ref(&angle)), state.clone());
    let mut f: Vec<Expr> = (0..first).map(|i| Expr::symbol(Symbol::State(i))).collect();
    f.extend([
        plus(x.clone(), times(dt(1), minus(of(Function::Sinc, &vx), of(Function::Cosc, &vy)))),
        plus(y.clone(), times(dt(1), plus(of(Function::Cosc, &vx), of(Function::Sinc, &vy)))),
        minus(of(Function::Cos, &vx), of(Function::Sin, &vy)),
        plus(of(Function::Sin, &vx), of(Function::Cos, &vy)),
    ]);
    Motion { f, h: vec![x, y], q: vec![Expr::number(0.0); n * n] }
}
