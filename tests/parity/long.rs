//! Long logs: sums in blocks stay exact enough, and memory does not grow with T beyond the log.

use crate::case::{Case, INNOVATIONS, Single, Text};
use crate::logs::{Gap, Interval, Shape, draw};
use crate::{double, evaluate, single, worst};
use kfgpu::data::Table;
use kfgpu::evaluate::Precision;
use kfgpu::filter::{Step, trace};

fn cv(objectives: &'static str) -> Text<'static> {
    Text {
        measurements: &["x", "y", "z"],
        model: "kind = \"constant-velocity\"\naxes = [\"x\", \"y\", \"z\"]\nq = \"q\"\nR = [\"r\", \"r\", \"r\"]\nx0 = [0, 0, 0, 0, 0, 0]\nP0 = [10, 10, 10, 10, 10, 10]",
        objectives,
        ..Text::BASIC
    }
}

const LEVEL: Text<'static> = Text {
    model: "kind = \"local-level\"\naxes = [\"x\"]\nq = \"q\"\nR = [\"r\"]\nx0 = [0]\nP0 = [10]",
    ..Text::BASIC
};

#[test]
fn seventy_thousand_rows() {
    let case = Case::new("70,000 rows", &LEVEL, Shape::regular(&[70_000]).without(&[Gap::Components(0.1)]), 9);
    let costs = case.reference();
    for (precision, promise) in [(Precision::F64, double as fn(&Case, _, _) -> _), (Precision::F32, single)] {
        let error = worst(&case, &costs, &evaluate(&case, precision), promise);
        println!("{} {precision}: {error:.1e} of the promise", case.name);
        assert!(error < 1.0, "{precision}: {error:.2e} times the promise");
    }
    assert_eq!(case.single, Single::Promised, "in single precision too");
}

/// For each kind of rows its columns, and the number of carried registers.
fn sizes(text: &Text<'_>, shape: Shape) -> (Vec<usize>, usize) {
    let case = Case::new("sizes", text, shape, 1);
    let program = trace(&case.problem, &case.log, &case.problem.tune.objectives, None).unwrap();
    assert_eq!(program.steps().iter().map(Step::rows).sum::<usize>(), case.log.rows(), "every row has a kind");
    for step in program.steps() {
        assert_eq!(step.record().len(), step.columns() * step.rows(), "the record is columns x rows");
    }
    (program.steps().iter().map(Step::columns).collect(), program.carried().len())
}

#[test]
fn a_record_holds_only_what_changes_from_row_to_row() {
    let nll = cv("[\"nll\"]");
    let short = sizes(&nll, Shape::regular(&[50]));
    assert_eq!(short, sizes(&nll, Shape::regular(&[5000])), "sizes do not depend on T");
    assert_eq!(short.0, [3], "three measurements a row; dt, weights and masks are folded");
    assert_eq!(short.1, 6 + 3 + 1 + 1, "x, P of the one axis that stands for all, sum NIS, det S");
    let gaps = sizes(&nll, Shape::regular(&[50]).without(&[Gap::Rows(0.3)]));
    assert_eq!(gaps, (vec![3, 0], short.1), "rows with nothing in them read nothing");
    let rare = sizes(&nll, Shape::regular(&[500]).without(&[Gap::Components(0.01)]));
    assert_eq!(rare.0, [3, 3 + 3], "rare patterns share a step with masks");
    let all = sizes(&cv(INNOVATIONS), Shape::regular(&[50]));
    assert_eq!(all.0, [3, 3], "the window of mismatch is a kind");
    let irregular = sizes(&LEVEL, Shape::regular(&[50]).every(Interval::Irregular(1.0)));
    assert_eq!(irregular.0, [2, 2], "z and dt; the window is a kind");
}

/// Two columns vary and their sum does not: no row reads it, and what is multiplied by it is simplified.
#[test]
fn what_columns_add_up_to_is_folded() {
    let model =
        |f: &str| format!("state = [\"x\"]\nf = [\"{f}\"]\nh = [\"x\"]\nQ = [\"q\"]\nR = [\"r\"]\nx0 = [0]\nP0 = [4]");
    let sizes = |f: &str| {
        let model = model(f);
        let text = Text { inputs: &["u", "w"], model: &model, ..Text::BASIC };
        let problem = text.problem();
        let mut log = draw(&problem, Shape::regular(&[50]), 3);
        let inputs = (0..50).map(|k| f64::from(k % 5));
        log.trajectories[0].u = Table::new(2);
        inputs.for_each(|u| log.trajectories[0].u.push(&[u, 4.0 - u]));
        let program = trace(&problem, &log, &problem.tune.objectives, None).unwrap();
        (program.steps()[0].columns(), program.counts().flops)
    };
    let (columns, flops) = sizes("x*(u + w)");
    assert_eq!((columns, flops), sizes("x*4"), "as if 4 had been typed");
    assert!(sizes("x*(u + 2*w)").0 > columns, "what varies is read");
}
