//! README and docs against the program: what they name exists, what exists they name, what they quote is so.
#![expect(clippy::unwrap_used, reason = "a file that is not there fails its test")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use kfgpu::model::{FilterKind, Function, Problem, Robust, built_in_models, built_in_sensors};
use kfgpu::objective::Kind;
use kfgpu::optimize::ALGORITHMS;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn read(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Every page for users.
const PAGES: [&str; 6] = [
    "README.md",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "docs/problem-file.md",
    "docs/semantics.md",
    "docs/reproductions.md",
];

/// The words in backticks of a line.
fn quoted(line: &str) -> BTreeSet<&str> {
    line.split('`').skip(1).step_by(2).collect()
}

/// The contents of fenced blocks of one language.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let open = format!("```{language}\n");
    let inside = |rest: &'a str| rest.split_once("\n```").map(|(block, _)| block);
    text.split(&open).skip(1).filter_map(inside).collect()
}

/// The row of README's table of what is supported.
fn supported(readme: &str, what: &str) -> BTreeSet<String> {
    let start = format!("| {what} |");
    let row = readme.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("no row {what}"));
    quoted(row).into_iter().map(str::to_owned).collect()
}

#[test]
fn the_supported_table_has_what_the_registries_have() {
    let readme = read("README.md");
    let check = |what: &str, names: Vec<&str>| {
        let expected: BTreeSet<String> = names.into_iter().map(str::to_owned).collect();
        assert_eq!(supported(&readme, what), expected, "README, row {what}");
    };
    check("models", built_in_models().collect());
    check("built-in sensors", built_in_sensors().collect());
    check("filters", FilterKind::NAMES.to_vec());
    check("outliers", Robust::NAMES.to_vec());
    check("functions", Function::ALL.iter().map(|(name, _)| *name).collect());
    check("objectives", Kind::ALL.iter().map(|(name, _)| *name).collect());
    check("optimisers", ALGORITHMS.iter().map(|row| row.name).collect());
}

#[test]
fn the_page_of_reproductions_has_every_study() {
    let page = read("docs/reproductions.md");
    let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
    for study in kfgpu::reproduce::STUDIES {
        let heading = format!("## {}", study.name);
        assert!(page.lines().any(|line| line.starts_with(&heading)), "docs/reproductions.md has no section {heading}");
        assert!(words.contains(study.paper), "docs/reproductions.md does not name {}", study.paper);
    }
}

#[test]
fn the_problem_file_page_names_every_model_filter_function_objective_and_optimiser() {
    let page = read("docs/problem-file.md");
    let named = quoted(&page);
    let names = built_in_models()
        .chain(built_in_sensors())
        .chain(FilterKind::NAMES.iter().copied())
        .chain(Function::ALL.iter().map(|(name, _)| *name))
        .chain(Kind::ALL.iter().map(|(name, _)| *name))
        .chain(ALGORITHMS.iter().map(|row| row.name))
        .chain(["if", "table", "and", "or", "not", "pi", "dt", "let"]);
    for name in names {
        assert!(named.contains(name), "docs/problem-file.md does not name `{name}`");
    }
}

#[test]
fn problem_files_in_the_docs_parse() {
    for name in ["README.md", "docs/problem-file.md"] {
        let text = read(name);
        let problems: Vec<&str> = blocks(&text, "toml").into_iter().filter(|b| b.contains("[model]")).collect();
        assert!(!problems.is_empty(), "{name} shows a problem file");
        for problem in problems {
            if let Err(error) = Problem::parse(problem, name) {
                panic!("{error}");
            }
        }
    }
}

/// The README's table of problem files has each that ships.
#[test]
fn the_readme_lists_every_problem_that_ships() {
    let readme = read("README.md");
    for entry in std::fs::read_dir(path("examples")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if let Some(name) = name.strip_suffix(".toml") {
            let link = format!("[`{name}`](examples/{name}.toml)");
            assert!(readme.contains(&link), "README.md has no row for examples/{name}.toml");
        }
    }
}

/// The README's rocket is the shipped one without its comments.
#[test]
fn the_readme_shows_the_shipped_rocket() {
    let readme = read("README.md");
    let shown = blocks(&readme, "toml").into_iter().find(|b| b.contains("[simulate]")).unwrap();
    let shown = Problem::parse(shown, "README.md").unwrap();
    let shipped = Problem::open(&path("examples/rocket.toml")).unwrap();
    assert_eq!(shown.data, shipped.data, "data");
    assert_eq!(shown.parameters, shipped.parameters, "parameters");
    assert_eq!(shown.tune, shipped.tune, "tune");
    assert_eq!(shown.simulate, shipped.simulate, "simulate");
    assert_eq!(shown.model.without_spans(), shipped.model.without_spans(), "model");
    assert_eq!(shown.filter, shipped.filter, "filter");
}

/// Every command in code is a verb of the program, and every verb is shown.
#[cfg(feature = "gpu")]
#[test]
fn every_command_shown_exists_and_every_verb_is_shown() {
    let mut shown = BTreeSet::new();
    for name in PAGES {
        let text = read(name);
        let lines = blocks(&text, "sh").into_iter().chain(blocks(&text, "text")).flat_map(str::lines);
        let code = lines.map(|line| line.trim_start_matches("$ ")).chain(quoted(&text));
        for command in code.filter_map(|code| code.strip_prefix("kfgpu ")) {
            let verb = command.split(' ').next().unwrap();
            assert!(verb == "help" || succeeds(&[verb, "--help"]), "{name} shows `kfgpu {command}`");
            shown.insert(verb.to_owned());
        }
    }
    let verbs = [
        "tune",
        "filter",
        "check",
        "compare",
        "init",
        "tape",
        "simulate",
        "evaluate",
        "bench",
        "devices",
        "shader",
        "reproduce",
    ];
    for verb in verbs {
        assert!(shown.contains(verb), "the docs show no `kfgpu {verb}`");
    }
}

#[cfg(feature = "gpu")]
fn succeeds(arguments: &[&str]) -> bool {
    Command::new(env!("CARGO_BIN_EXE_kfgpu")).args(arguments).output().unwrap().status.success()
}

/// What the README prints of `tune` and `evaluate`, but for times and the machine.
#[test]
fn outputs_in_the_readme_are_what_is_printed() {
    let readme = read("README.md");
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_kfgpu")).current_dir(path("")).args(arguments).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    for line in
        run(&["tune", "--quiet"]).lines().filter(|line| !line.starts_with("pso") && !line.starts_with("Certificate"))
    {
        assert!(readme.contains(line), "the README's output of `tune` lacks: {line}");
    }
    let folder = tempfile::tempdir().unwrap();
    let candidates = folder.path().join("candidates.csv");
    std::fs::write(&candidates, "sigma2_eps,sigma2_eta\n15099,1469.1\n10000,10000\n").unwrap();
    let costs = run(&["evaluate", "examples/nile.toml", candidates.to_str().unwrap(), "--quiet"]);
    for line in costs.lines() {
        let significant: String = line.chars().take(12).collect();
        assert!(readme.contains(&significant), "the README's output of `evaluate` lacks: {line}");
    }
}

/// Cells of a table's row.
fn cells(row: &str) -> Vec<&str> {
    row.trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`')).collect()
}

/// Accuracy and speed are quoted from the files that the measurements are recorded in.
#[test]
fn figures_in_the_readme_are_the_recorded_ones() {
    let (readme, speed) = (read("README.md"), read("benches/RESULTS.md"));
    let mut budget = csv::Reader::from_path(path("tests/parity/budget.csv")).unwrap();
    let records: Vec<(String, String, f64)> = budget.deserialize().map(Result::unwrap).collect();
    let section = |from: &str| readme.split(from).nth(1).unwrap().split("\n## ").next().unwrap().to_owned();
    let rows = |text: String| -> Vec<String> {
        text.lines().filter(|l| l.starts_with("| ")).skip(1).map(str::to_owned).collect()
    };
    let accuracy = rows(section("\n## Accuracy\n"));
    assert!(accuracy.len() > 5, "the README has a table of accuracy");
    for row in accuracy {
        let cells = cells(&row);
        for (precision, error) in [("f64", cells[1]), ("f32", cells[2])] {
            let record = records.iter().find(|(case, p, _)| case == cells[0] && p == precision);
            if error == "refused" {
                assert!(record.is_none(), "{}: {precision} has a record and is not refused", cells[0]);
                continue;
            }
            let recorded = record.unwrap_or_else(|| panic!("budget.csv has no {} {precision}", cells[0])).2;
            let shown: f64 = error.parse().unwrap();
            // As far as the budget itself lets an error move before it asks for a new record.
            let close = shown.total_cmp(&recorded).is_eq() || (0.25..4.0).contains(&(shown / recorded));
            assert!(close, "{} {precision}: README {shown}, budget.csv {recorded}: copy the record", cells[0]);
        }
    }
    let measured = rows(section("\n## Speed\n"));
    assert!(measured.len() > 5, "the README has a table of speed");
    for row in measured {
        assert!(speed.contains(&row), "benches/RESULTS.md has no row {row}: copy the row from there");
    }
}

/// Relative links lead somewhere.
#[test]
fn links_lead_to_files() {
    for name in PAGES {
        let folder = path(name).parent().unwrap().to_owned();
        let text = read(name);
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let local = !target.starts_with("http") && !target.starts_with('#');
            assert!(!local || folder.join(target).exists(), "{name} links to {target}");
        }
    }
}

/// Every test that docs/semantics.md names is a test of this repository.
#[test]
fn the_rules_name_tests_that_exist() {
    let mut code = String::new();
    for folder in ["src", "tests"] {
        gather(&path(folder), &mut code);
    }
    let page = read("docs/semantics.md");
    let tests: Vec<&str> =
        quoted(&page).into_iter().filter(|word| word.matches('_').count() >= 3 && !word.contains('/')).collect();
    assert!(tests.len() > 30, "the page names {} tests", tests.len());
    for test in tests {
        assert!(code.contains(&format!("fn {test}(")), "docs/semantics.md names the test {test}, which is not there");
    }
}

fn gather(folder: &Path, code: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(&path, code);
        } else if path.extension().is_some_and(|e| e == "rs") {
            code.push_str(&std::fs::read_to_string(&path).unwrap());
        }
    }
}
