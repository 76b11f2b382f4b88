//! Singer's manoeuvring target: an acceleration of variance q that forgets itself at the rate alpha = 1 / tau (Singer 1970,
//! doi:10.1109/TAES.1970.310128).
//!
//! F and Q are the exact ones. With u = alpha dt, E = exp(-u), p1 = (1 - E) / u and p2 = (u - 1 + E) / u^2, the response of
//! position, velocity and acceleration to white noise is [dt^2 p2, dt p1, E], and Q = 2 alpha q times the integral of its
//! products. As each is the derivative of the one before, three entries are in closed form: Q12 = alpha q dt^4 p2^2, Q23 =
//! alpha q dt^2 p1^2, Q33 = q (1 - E^2). What is left cancels at small u and is a power series there.

use super::{BuiltIn, Keys, Motion, by_axes, call, dt, minus, over, plus, power, times};
use crate::model::error::Fault;
use crate::model::{Expr, ExprKind, Function, Span, Symbol};

/// States: the positions, then the velocities, then the accelerations.
pub(super) const MODEL: BuiltIn = BuiltIn {
    name: "singer",
    axes: [1, 3],
    leading: None,
    components: &["", "v", "a"],
    strengths: &["q", "alpha", "tau"],
    read,
};

fn read(keys: &dyn Keys) -> Result<Motion, Fault> {
    if keys.has("noise") {
        let problem = "`q` of a singer model is the variance of its acceleration: remove `noise`";
        return Err(keys.refuse("noise", problem.to_owned()));
    }
    let (axes, q) = (keys.axes(), keys.strengths("q")?);
    let alpha: Vec<Expr> = match (keys.has("alpha"), keys.has("tau")) {
        (true, true) => {
            let problem = "it is 1 / `alpha`, which is given too: remove one of them";
            return Err(keys.refuse("tau", problem.to_owned()));
        }
        (false, true) => keys.strengths("tau")?.into_iter().map(|tau| over(Expr::number(1.0), tau)).collect(),
        _ => keys.strengths("alpha")?,
    };
    let transition = |component: usize, axis: usize| {
        let [x, v, a] = [0, 1, 2].map(|c| Expr::symbol(Symbol::State(c * axes + axis)));
        let response = Response::of(&alpha[axis]);
        match component {
            0 => plus(plus(x, times(dt(1), v)), times(response.position, a)),
            1 => plus(v, times(response.velocity, a)),
            _ => times(response.acceleration, a),
        }
    };
    Ok(by_axes(axes, 3, transition, |axis| process_noise(&q[axis], &alpha[axis])))
}

/// What an acceleration of 1 becomes in a step.
struct Response {
    position: Expr,
    velocity: Expr,
    acceleration: Expr,
}

impl Response {
    fn of(alpha: &Expr) -> Self {
        let u = times(alpha.clone(), dt(1));
        let alternating = |k: u8, offset: u8| sign(k) / factorial(k + offset);
        let gone = call(Function::Expm1, &[negative(&u)]);
        let p1 = small(&u, series(&u, (0..18).map(|k| alternating(k, 1))), over(negative(&gone), u.clone()));
        let p2 =
            small(&u, series(&u, (0..18).map(|k| alternating(k, 2))), over(plus(u.clone(), gone), power(u.clone(), 2)));
        Self {
            position: times(dt(2), p2),
            velocity: times(dt(1), p1),
            acceleration: call(Function::Exp, &[negative(&u)]),
        }
    }
}

/// Q of one axis.
fn process_noise(q: &Expr, alpha: &Expr) -> Vec<Expr> {
    let u = times(alpha.clone(), dt(1));
    let Response { position, velocity, acceleration } = Response::of(alpha);
    let density = times(alpha.clone(), q.clone());
    let [q11, q13, q22] =
        integrals(&u, &acceleration).map(|integral| times(times(Expr::number(2.0), density.clone()), integral));
    let q12 = times(density.clone(), power(position, 2));
    let q23 = times(density, power(velocity, 2));
    let q33 = times(negative(q), call(Function::Expm1, &[times(Expr::number(-2.0), u)]));
    vec![q11, q12.clone(), q13.clone(), q12, q22, q23.clone(), q13, q23, q33]
}

/// The integrals of the squared response of the position, of those of position and acceleration, and of the velocity
/// squared. Their series are E times those of E^-1 times the closed form, whose terms all have one sign.
fn integrals(u: &Expr, e: &Expr) -> [Expr; 3] {
    let number = Expr::number;
    let times_u = |factor: f64, exponent: u8| times(number(factor), power(u.clone(), exponent));
    let (e2, ue) = (power(e.clone(), 2), times(u.clone(), e.clone()));
    // (1 - E^2 + 2 u - 2 u^2 + 2/3 u^3 - 4 u E) / (2 u^5)
    let closed = plus(minus(number(1.0), e2.clone()), times(number(2.0), u.clone()));
    let closed = minus(plus(minus(closed, times_u(2.0, 2)), times_u(2.0 / 3.0, 3)), times(number(4.0), ue.clone()));
    let term = |k: u8| {
        let x = f64::from(k);
        (1.0 + 2.0 * x - 2.0 * x * (x - 1.0) + 2.0 / 3.0 * x * (x - 1.0) * (x - 2.0) - sign(k)) / (2.0 * factorial(k))
    };
    let first = small(u, times(e.clone(), series(u, (5..23).map(term))), over(closed, times_u(2.0, 5)));
    // (1 - E^2 - 2 u E) / (2 u^3) = E (sinh u - u) / u^3
    let closed = minus(minus(number(1.0), e2.clone()), times(number(2.0), ue));
    let even = series(&power(u.clone(), 2), (0..9).map(|k| 1.0 / factorial(2 * k + 3)));
    let second = small(u, times(e.clone(), even), over(closed, times_u(2.0, 3)));
    // (4 E - 3 - E^2 + 2 u) / (2 u^3)
    let closed = minus(minus(times(number(4.0), e.clone()), number(3.0)), e2);
    let closed = plus(closed, times(number(2.0), u.clone()));
    let term = |k: u8| (2.0 * f64::from(k) - 3.0 - sign(k)) / (2.0 * factorial(k));
    let third = small(u, times(e.clone(), series(u, (3..21).map(term))), over(closed, times_u(2.0, 3)));
    [times(dt(5), first), times(dt(3), second), times(dt(3), third)]
}

/// The series below u = 1, where the closed form cancels, else that.
fn small(u: &Expr, series: Expr, closed: Expr) -> Expr {
    let below = minus(Expr::number(1.0), u.clone());
    Expr { kind: ExprKind::If(Box::new([below, series, closed])), span: Span::default() }
}

/// c0 + u (c1 + u (c2 + ...)).
fn series(u: &Expr, coefficients: impl DoubleEndedIterator<Item = f64>) -> Expr {
    let add = |rest: Option<Expr>, c: f64| match rest {
        None => Expr::number(c),
        Some(rest) => plus(Expr::number(c), times(u.clone(), rest)),
    };
    coefficients.rev().fold(None, |rest, c| Some(add(rest, c))).unwrap_or(Expr::number(0.0))
}

fn negative(a: &Expr) -> Expr {
    Expr { kind: ExprKind::Negate(Box::new(a.clone())), span: Span::default() }
}

/// (-1)^k.
fn sign(k: u8) -> f64 {
    if k.is_multiple_of(2) { 1.0 } else { -1.0 }
}

fn factorial(k: u8) -> f64 {
    (1..=k).map(f64::from).product()
}
