//! Correlated measurement noise: constant and searched, factored, with everything present and with gaps.

use crate::case::{ALL, Case, Double, OPTIONS, Single, Text};
use crate::logs::{Gap, Shape};

const FULL: Shape = Shape::regular(&[100]);
const GAPS: Shape = Shape::regular(&[60, 1, 30]).without(&[Gap::Components(0.25), Gap::Truth(0.1)]);

const PLANE: &str = r#"state = ["x", "y"]
f = ["x + 0.1*y", "0.9*y"]
h = ["x", "y"]
Q = ["q", "q"]
x0 = [0, 1]
P0 = [2, 2]"#;

const SPACE: &str = r#"state = ["x", "y"]
f = ["x + 0.1*y", "0.9*y"]
h = ["x", "y", "x + y - 1"]
Q = ["q", "q"]
x0 = [0, 1]
P0 = [2, 2]"#;

pub(crate) fn cases() -> Vec<Case> {
    let q = "q = { min = 0.01, max = 10, scale = \"log\", start = 0.3 }";
    let c = format!("{}\nc = {{ min = -0.6, max = 0.6, start = 0.2 }}", Text::BASIC.parameters);
    let constant = format!("{q}\nunused = 1");
    // Well away from singular, and as it comes: the conditioning of R decides what any precision can hold.
    let diagonal =
        |m: usize| -> String { (1..=m).map(|i| format!("M{i}{i} = {{ min = 1, max = 2, start = 1 }}\n")).collect() };
    let square = |m| format!("{}{q}\nM = {{ min = -0.4, max = 0.4, start = 0 }}", diagonal(m));
    let (square_two, square_three) = (square(2), square(3));
    let wild = format!("{q}\nM = {{ min = -2, max = 2, start = 1 }}");
    let lower = format!("{q}\nM = {{ min = 0.2, max = 2, start = 1 }}").replace("start = 1 }", "init = [0.3, 2] }");
    let kinds = [
        ("constant R, two", 2, "[[2, 0.7], [0.7, 1]]", &constant),
        ("constant R, three", 3, "[[2, 0.7, 0], [0.7, 1, -0.2], [0, -0.2, 3]]", &constant),
        ("searched correlation", 2, "[[\"r\", \"c*r\"], [\"c*r\", \"r\"]]", &c),
        ("searched correlation, three", 3, "[[\"r\"], [\"c*r\", \"r\"], [0, \"c*r\", \"2*r\"]]", &c),
        ("square factor", 2, "{ factor = \"M\", form = \"square\" }", &square_two),
        ("square factor, three", 3, "{ factor = \"M\", form = \"square\" }", &square_three),
        ("square factor, any condition", 3, "{ factor = \"M\", form = \"square\" }", &wild),
        ("lower factor, three", 3, "{ factor = \"M\", form = \"lower\" }", &lower),
    ];
    let mut cases = Vec::new();
    for (turn, (name, m, r, parameters)) in kinds.into_iter().enumerate() {
        let model = format!("{}\nR = {r}", if m == 2 { PLANE } else { SPACE });
        let text = Text {
            measurements: &["z1", "z2", "z3"][..m],
            truth: &["x", "y"],
            model: &model,
            parameters,
            objectives: if turn.is_multiple_of(2) { ALL } else { OPTIONS },
            ..Text::BASIC
        };
        for (shape, log) in [("full", FULL), ("gaps", GAPS)] {
            let case = Case::new(format!("{name}, {shape}"), &text, log, 257);
            let measured = name.ends_with("any condition");
            cases.push(if measured { case.single(Single::Measured).double(Double::Measured) } else { case });
        }
    }
    cases
}
