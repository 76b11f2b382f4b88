//! Curves in formulas, `table("file", x)`.

use std::fs;

use crate::model::{Expr, ExprKind, Problem, ProblemError, Symbol};

/// A problem whose formulas are `f` and `h`, in a folder with the file `c.csv`.
fn parse(f: &str, h: &str, csv: &str) -> Result<Problem, ProblemError> {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("tables")).unwrap();
    fs::write(folder.path().join("tables/c.csv"), csv).unwrap();
    let text = text(f, h);
    fs::write(folder.path().join("p.toml"), &text).unwrap();
    Problem::open(&folder.path().join("p.toml"))
}

fn text(f: &str, h: &str) -> String {
    format!(
        "[data]\nfile = \"l.csv\"\nmeasurements = [\"z\"]\ninputs = [\"u\"]\n[model]\nstate = [\"x\"]\nf = [{f}]\n\
         h = [{h}]\nQ = [\"1\"]\nR = [\"r\"]\nx0 = [0]\nP0 = [1]\n[parameters]\nr = {{ min = 1, max = 2 }}\n"
    )
}

const POINTS: &str = "x,y\n0,0\n1,1\n2,5\n";

/// The value with u = 1.5.
fn value(formula: &Expr) -> f64 {
    formula.evaluate(&|symbol| if symbol == Symbol::Input(0) { 1.5 } else { f64::NAN })
}

#[test]
fn both_quotes_and_every_separator_are_read() {
    for formula in [
        r#"'x + table("tables/c.csv", u)'"#,
        r#""x + table('tables/c.csv', u)""#,
        r#""x + table ( \"tables/c.csv\" , 2*u - u)""#,
    ] {
        for csv in [
            POINTS,
            "# a comment\nsoc;V\n0;0\n\n1;1\n2;5\n",
            "a\tb\n0\t 0\n1\t\"1\"\n2\t5e0",
            "\u{feff}x,y\r\n0,0\r\n1,1\r\n2,5\r\n",
        ] {
            let problem = parse(formula, "\"x\"", csv).unwrap_or_else(|error| panic!("{error}"));
            // Slopes 2.5 and 4 at 1 and 2: 0.5 (1 + 5) + (2.5 - 4)/8.
            let ExprKind::Binary(_, _, table) = &problem.model.f[0].kind else { panic!("a sum") };
            assert!((value(table) - 2.8125).abs() < 1e-15, "{csv:?}: {}", value(table));
        }
    }
}

#[test]
fn a_table_of_a_state_is_not_linear() {
    let error = parse("\"x\"", r#"'table("tables/c.csv", x)'"#, POINTS).unwrap_err().to_string();
    assert!(error.contains(r#":8:7: `table("tables/c.csv", x)` is not linear in the states"#), "{error}");
}

#[test]
fn mistakes_are_told_where_they_are() {
    let long = format!("x,y\n{}", (0..1001).map(|i| format!("{i},1\n")).collect::<String>());
    for (csv, sentence) in [
        ("", "c.csv:1:1: is empty, expected a header and rows of two numbers"),
        ("0,1\n1,2\n", "c.csv:1:1: expected a header, found numbers: add a first line that names the columns"),
        ("x,y\n0,1\n", "c.csv:2:1: 1 rows, expected at least 2"),
        ("x,y\n0,1\n1,2,3\n", "c.csv:3:1: 3 cells, expected two: x and y"),
        ("x\n0\n", "c.csv:1:1: 1 cells, expected two: x and y"),
        ("x,y\n0,1\n1, n/a\n", "c.csv:3:4: expected a number, found \"n/a\""),
        ("x,y\n0,1\n1,inf\n", "c.csv:3:3: expected a number, found \"inf\""),
        ("x,y\n0,1\n2,2\n1,3\n", "c.csv:4:1: 1 follows 2, expected x to increase from row to row"),
        ("x,y\n0,1\n0,2\n", "c.csv:3:1: 0 follows 0, expected x to increase from row to row"),
        ("x,y\n0,0\n1e-300,1e300\n", "c.csv:3:1: its slopes are not finite: points too close, or numbers too large"),
        (long.as_str(), "c.csv:1002:1: more than 1000 rows: leave some out"),
    ] {
        let error = parse(r#"'x + table("tables/c.csv", u)'"#, "\"x\"", csv).unwrap_err().to_string();
        assert!(error.contains(":7:17: ") && error.contains(&format!("tables/{sentence}")), "{error}");
        assert!(error.lines().last().unwrap().trim_end().ends_with("^^^^^^^^^^^^^^"), "{error}");
    }
    for (formula, sentence) in [
        (
            "table(\"no.csv\", u)",
            "no.csv: no such file (a path in a formula is relative to the folder of the problem file)",
        ),
        ("table(\"tables\", u)", "tables: is no file, expected a CSV file with two columns"),
        ("table(u, \"tables/c.csv\")", "a formula has `u` where a file's name in quotes was expected"),
        ("table(\"tables/c.csv\")", "a formula has `)` where `,` and where to look it up was expected"),
        ("table(\"tables/c.csv\", u, 2)", "a formula has `,` where `)` or an operator was expected"),
        ("table(\"tables/c.csv, u)", "a formula stops short: expected the closing quote of a file's name"),
        ("\"a\" + u", "a formula has `\"a\"` where a number, a name or `(` was expected"),
        ("tabel(\"a\", u)", "unknown function `tabel`: did you mean `table`?"),
    ] {
        let error = parse(&format!("'{formula}'"), "\"x\"", POINTS).unwrap_err().to_string();
        assert!(error.contains(sentence), "{error}\nexpected {sentence}");
    }
}

#[test]
fn tables_are_called_otherwise_from_another_folder() {
    let text = text(r#"'x + table("c.csv", u)'"#, r#""x""#);
    let lets =
        "[model.let]\na = \"table('d.csv', r)\"\nb = 'max(table(\"c.csv\", r), table(\"d.csv\", 1))'\n[parameters]";
    let text = text.replace("u)']", "u)']  # a curve").replace("[parameters]", lets);
    let found = Problem::tables_renamed(&text, &|name| format!("../{name}"));
    let expected = text
        .replace("\"c.csv\"", "\"../c.csv\"")
        .replace("\"d.csv\"", "\"../d.csv\"")
        .replace("\"table('d.csv', r)\"", "'table(\"../d.csv\", r)'");
    assert_eq!(found, expected);
    assert_eq!(
        Problem::tables_renamed(&text, &str::to_owned).replace("'table(\"d.csv\", r)'", "\"table('d.csv', r)\""),
        text
    );
}
