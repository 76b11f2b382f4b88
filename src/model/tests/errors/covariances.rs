//! Covariances and the start of the filter.

use super::{SOUND, check, error};

#[test]
fn covariances() {
    let positive = "make the off-diagonal entries smaller";
    check(&[
        (
            "[0, \"q*dt\"]]",
            "[\"q*dt\", \"q*dt\"]]",
            "q*dt",
            "12:34: `model.Q` is not symmetric: entry [2, 1] differs from [1, 2] (write both alike, or one of them 0)",
        ),
        ("[0, \"q*dt\"]]", "[0]]", "[0]", "12:32: `model.Q[2]` has 1 entry: expected 2, one per column"),
        (
            "{ z = \"r\" }",
            "{ y = \"r\" }",
            "y",
            "13:7: `model.R` names measurement `y`, which does not exist (known: `z`)",
        ),
        (
            "{ z = \"r\" }",
            "{ }",
            "{ }",
            "13:5: `model.R` gives no variance for `z`: name each of them, because this matrix must be positive definite",
        ),
        (
            "{ z = \"r\" }",
            "[\"r\", \"r\"]",
            "[\"r\", \"r\"]",
            "13:5: `model.R` has 2 entries: expected 1, one per measurement (z)",
        ),
        (
            "P0 = [100, 10]",
            "P0 = 100",
            "100",
            "15:6: `model.P0`: expected a list of 2 variances, a list of 2 lists, a table by state, or a factor, found the number 100",
        ),
        (
            "P0 = [100, 10]",
            "P0 = [100, 0]",
            "[100, 0]",
            "15:6: `model.P0` is not positive definite at the start values: the variance of `v` is 0, expected above 0",
        ),
        (
            "P0 = [100, 10]",
            "P0 = [[1, 2], [2, 1]]",
            "[[1, 2], [2, 1]]",
            &format!(
                "15:6: `model.P0` is not positive definite at the start values: its smallest eigenvalue is -1.000e0 ({positive})"
            ),
        ),
        (
            "{ z = \"r\" }",
            "[\"r - 6\"]",
            "[\"r - 6\"]",
            "13:5: `model.R` is not positive definite at the start values: the variance of `z` is -1, expected above 0",
        ),
        (
            "{ z = \"r\" }",
            "[\"ln(r - 6)\"]",
            "[\"ln(r - 6)\"]",
            "13:5: `model.R` is not positive definite at the start values: entry [1, 1] is NaN, not a finite number",
        ),
        (
            "[[\"q*dt^3/3\", \"q*dt^2/2\"], [0, \"q*dt\"]]",
            "[[1, 2], [2, 1]]",
            "[[1, 2], [2, 1]]",
            &format!(
                "12:5: `model.Q` is not positive semidefinite at the start values: its smallest eigenvalue is -1.000e0 ({positive})"
            ),
        ),
        (
            "{ z = \"r\" }",
            "{ factor = \"M\", form = \"round\" }",
            "\"round\"",
            "13:28: `model.R.form` is \"round\": expected \"square\" or \"lower\"",
        ),
        (
            "{ z = \"r\" }",
            "{ factor = \"M\", form = \"lower\" }",
            "\"M\"",
            "13:16: `M`: the factor `M` has no template: give `M` in [parameters], such as M = { init = [0, 1], start = 1 }",
        ),
    ]);
}

#[test]
fn first_and_start() {
    check(&[
        (
            "first = \"update\"",
            "first = \"predict\"",
            "\"predict\"",
            "16:9: `model.first`: \"predict\" needs the inputs of a step before the first row, which no log has: use \"update\"",
        ),
        (
            "first = \"update\"",
            "first = \"later\"",
            "\"later\"",
            "16:9: `model.first` is \"later\": expected \"update\" or \"predict\"",
        ),
        (
            "first = \"update\"",
            "first_dt = 1",
            "1",
            "16:12: `model.first_dt`: it belongs to first = \"predict\", the step before the first row: remove it",
        ),
        (
            "h = [\"p\"]\nQ = [[\"q*dt^3/3\", \"q*dt^2/2\"], [0, \"q*dt\"]]\nR = { z = \"r\" }\nx0 = [0, 0]",
            "h = [\"r*p\"]\nQ = [0, 0]\nR = { z = \"r\" }\nx0 = \"measurement\"",
            "\"measurement\"",
            "14:6: `model.x0`: \"measurement\" needs an h without searched parameters: give numbers",
        ),
    ]);
    let text = SOUND.replace("inputs = [\"u\"]\n", "").replace("+ 0.5*u*dt^2", "").replace("+ u*dt", "");
    let text = text.replace("x0 = [0, 0]", "x0 = \"measurement\"").replace("\"update\"", "\"predict\"");
    let first = error(&text).to_string();
    assert!(first.contains("15:9: `model.first`: \"predict\" cannot go with x0 = \"measurement\""), "{first}");
}
