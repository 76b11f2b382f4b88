//! The interacting multiple model filter.

use super::{Adapts, Described, Facts, Range, Setting, Settings};
use crate::model::error::Fault;
use crate::model::{Binary, Expr, ExprKind, Function, Span, Symbol};

/// A filter a mode, mixed before every step by a Markov chain between the modes (Blom and Bar-Shalom 1988,
/// doi 10.1109/9.1299). The modes themselves stand in [`Problem::modes`](crate::model::Problem::modes).
#[derive(Debug, Clone, PartialEq)]
pub struct Imm {
    /// The chain, r x r row-major: entry (i, j) is the probability of mode j after a step from mode i, a formula of
    /// parameters and dt.
    pub transition: Vec<Expr>,
    /// The probabilities of the modes before the first row, r.
    pub start: Vec<Expr>,
    /// What has been typed, and what it has to fulfil.
    typed: Vec<Typed>,
}

/// A formula of the user, or a condition on several.
#[derive(Debug, Clone, PartialEq)]
struct Typed {
    key: &'static str,
    condition: Option<&'static str>,
    formula: Expr,
    range: Range,
}

type Rows = Vec<Vec<Expr>>;

impl Imm {
    /// Below this no mode falls that is not ruled out, so that each can come back. It is part of the filter's definition.
    pub const FLOOR: f64 = 1e-12;
}

impl Described for Imm {
    const NAME: &'static str = "imm";
    const KEYS: &'static [&'static str] = &["transition", "stay", "sojourn", "start"];
    const LINEAR: bool = false;

    fn read(settings: &dyn Settings) -> Result<Self, Fault> {
        let r = settings.modes();
        let (transition, mut typed) = chain(settings, r)?;
        let start = match settings.rows("start")? {
            None => vec![divided(Expr::number(1.0), r); r],
            Some(rows) => {
                let start = rows.concat();
                counted(settings, "start", start.len(), r)?;
                typed.extend(distribution("start", "their sum", &start));
                start
            }
        };
        Ok(Self { transition, start, typed })
    }

    /// What has been typed: a chain is made of it.
    fn settings(&self) -> Vec<Setting<'_>> {
        let all = self.typed.iter();
        all.map(|Typed { key, condition, formula, range }| Setting {
            key,
            formula,
            range: *range,
            condition: *condition,
        })
        .collect()
    }

    fn facts(&self) -> Facts<'_> {
        Facts { ordered: false, adapts: Adapts::Nothing, noise_floor: None }
    }
}

/// The matrix of the chain, and what has been typed for it.
fn chain(settings: &dyn Settings, r: usize) -> Result<(Vec<Expr>, Vec<Typed>), Fault> {
    let [transition, stay, sojourn] = ["transition", "stay", "sojourn"].map(|key| settings.rows(key));
    match (transition?, stay?, sojourn?) {
        (Some(rows), None, None) => matrix(settings, rows, r),
        (None, Some(stay), None) => {
            let stay = each(settings, "stay", stay.concat(), r)?;
            let leave = |stay: &Expr| Expr::binary(Binary::Subtract, Expr::number(1.0), stay.clone());
            let entries = stay.iter().map(|stay| (stay.clone(), leave(stay))).collect();
            Ok((shared(entries), typed("stay", Range::Probability, &stay)))
        }
        (None, None, Some(sojourn)) => {
            let sojourn = each(settings, "sojourn", sojourn.concat(), r)?;
            let entries = sojourn.iter().map(|mean| (decay(Function::Exp, mean), negated(decay(Function::Expm1, mean))));
            Ok((shared(entries.collect()), typed("sojourn", Range::Positive, &sojourn)))
        }
        (None, None, None) => Err(settings.refuse(
            "transition",
            "it lacks the chain between the modes: give `transition` (a matrix), `stay` (probabilities) or `sojourn` (seconds)"
                .to_owned(),
        )),
        (_, stay, _) => {
            let key = if stay.is_some() { "stay" } else { "sojourn" };
            Err(settings.refuse(key, "`transition`, `stay` and `sojourn` all give the chain between the modes: keep one".to_owned()))
        }
    }
}

/// The rows as they have been typed.
fn matrix(settings: &dyn Settings, rows: Rows, r: usize) -> Result<(Vec<Expr>, Vec<Typed>), Fault> {
    let widths = rows.iter().map(Vec::len);
    if let Some(found) = widths.chain([rows.len()]).find(|found| *found != r) {
        let problem = format!("expected {r} rows of {r} probabilities, one per mode, found {found}");
        return Err(settings.refuse("transition", problem));
    }
    check_sums(settings, &rows)?;
    let typed = rows.iter().flat_map(|row| distribution("transition", "the sum of a row", row)).collect();
    Ok((rows.concat(), typed))
}

/// Numbers are known when the problem is read: who has written down the transpose is told so.
fn check_sums(settings: &dyn Settings, rows: &Rows) -> Result<(), Fault> {
    let value = |entry: &Expr| entry.evaluate(&|_| f64::NAN);
    let is_one = |sum: f64| Range::One.contains(sum);
    let sums = || rows.iter().map(|row| row.iter().map(value).sum::<f64>());
    let Some((i, sum)) = sums().enumerate().find(|(_, sum)| !sum.is_nan() && !is_one(*sum)) else { return Ok(()) };
    let columns = (0..rows.len()).all(|j| is_one(rows.iter().map(|row| value(&row[j])).sum()));
    let problem = if columns {
        "columns sum to one, not rows: transpose".to_owned()
    } else {
        format!("row {} sums to {sum}, expected 1: a row holds the probabilities of all modes after one", i + 1)
    };
    Err(settings.refuse("transition", problem))
}

/// Staying and leaving of each mode as a matrix: the others share alike.
fn shared(entries: Vec<(Expr, Expr)>) -> Vec<Expr> {
    let r = entries.len();
    let row = |(i, (stay, leave)): (usize, (Expr, Expr))| {
        let share = divided(leave, r.saturating_sub(1));
        (0..r).map(move |j| if i == j { stay.clone() } else { share.clone() }).collect::<Vec<_>>()
    };
    entries.into_iter().enumerate().flat_map(row).collect()
}

/// One formula for all modes, or one per mode.
fn each(settings: &dyn Settings, key: &'static str, mut given: Vec<Expr>, r: usize) -> Result<Vec<Expr>, Fault> {
    if let [one] = given.as_slice() {
        given = vec![one.clone(); r];
    }
    counted(settings, key, given.len(), r)?;
    Ok(given)
}

fn counted(settings: &dyn Settings, key: &'static str, found: usize, r: usize) -> Result<(), Fault> {
    let problem = || format!("expected {r} formulas, one per mode, found {found}");
    if found == r { Ok(()) } else { Err(settings.refuse(key, problem())) }
}

fn typed(key: &'static str, range: Range, formulas: &[Expr]) -> Vec<Typed> {
    formulas.iter().map(|formula| Typed { key, condition: None, formula: formula.clone(), range }).collect()
}

/// Probabilities that add up to one.
fn distribution(key: &'static str, what: &'static str, formulas: &[Expr]) -> Vec<Typed> {
    let mut all = typed(key, Range::Probability, formulas);
    let sum = formulas.iter().cloned().reduce(|a, b| Expr::binary(Binary::Add, a, b));
    all.extend(sum.map(|formula| Typed { key, condition: Some(what), formula, range: Range::One }));
    all
}

/// A function of -dt / mean.
fn decay(function: Function, mean: &Expr) -> Expr {
    let share = Expr::binary(Binary::Divide, negated(Expr::symbol(Symbol::Dt)), mean.clone());
    Expr { kind: ExprKind::Call(function, vec![share]), span: Span::default() }
}

fn negated(a: Expr) -> Expr {
    Expr { kind: ExprKind::Negate(Box::new(a)), span: Span::default() }
}

/// a / count, or a itself where there is nothing to share.
fn divided(a: Expr, count: usize) -> Expr {
    let divisor = Expr::number(u32::try_from(count).unwrap_or(u32::MAX).into());
    if count > 1 { Expr::binary(Binary::Divide, a, divisor) } else { a }
}
