//! What may use what: the table of ARCHITECTURE.md against the imports of the source. A module is a folder or file of `src`; its
//! tests may use anything.

#![expect(clippy::unwrap_used, reason = "a file that cannot be read fails the test")]

#[path = "house/circles.rs"]
mod circles;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What each module uses, with a file that does.
type Uses = BTreeMap<String, BTreeMap<String, PathBuf>>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Source files below a folder, without those that hold tests alone.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_test = |path: &PathBuf| path.file_stem().is_some_and(|stem| stem == "tests");
    let found =
        entries.filter(|path| !is_test(path)).flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] });
    found.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The module that a file of `src` belongs to; none for `lib.rs` and `main.rs`.
fn module(path: &Path) -> Option<String> {
    let first = path.strip_prefix(root().join("src")).unwrap().components().next().unwrap();
    let name = first.as_os_str().to_str().unwrap().trim_end_matches(".rs").to_owned();
    (!["lib", "main"].contains(&name.as_str())).then_some(name)
}

/// Names after `crate::` in code, not in comments or in a test module at the end.
fn names(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.flat_map(|line| line.split("crate::").skip(1)).map(|rest| {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        &rest[..end]
    })
}

fn uses() -> Uses {
    let files: Vec<(String, PathBuf)> =
        sources(&root().join("src")).into_iter().filter_map(|path| Some((module(&path)?, path))).collect();
    let mut uses: Uses = files.iter().map(|(module, _)| (module.clone(), BTreeMap::new())).collect();
    let modules: BTreeSet<String> = uses.keys().cloned().collect();
    for (own, path) in files {
        let text = fs::read_to_string(&path).unwrap();
        assert!(!text.contains("use crate::{"), "{}: one `use` a module, so that it can be seen", path.display());
        for name in names(&text).filter(|name| *name != own && modules.contains(*name)) {
            uses.get_mut(&own).unwrap().entry(name.to_owned()).or_insert_with(|| path.clone());
        }
    }
    uses
}

/// Rows of the table: a module and what it may use; `None` for all above it.
fn table() -> Vec<(String, Option<BTreeSet<String>>)> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let quoted = |cell: &str| -> Vec<String> { cell.split('`').skip(1).step_by(2).map(str::to_owned).collect() };
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
        let module =
            quoted(cells[0])[0].trim_start_matches("src/").trim_end_matches(".rs").trim_end_matches('/').to_owned();
        let last = cells[cells.len() - 1];
        (module, (last.trim() != "all").then(|| quoted(last).into_iter().collect()))
    };
    text.lines().filter(|line| line.starts_with("| `src/")).map(row).collect()
}

#[test]
fn modules_use_what_the_table_says() {
    let (uses, table) = (uses(), table());
    let listed: Vec<&String> = table.iter().map(|(module, _)| module).collect();
    let missing: Vec<&String> = uses.keys().filter(|module| !listed.contains(module)).collect();
    assert!(missing.is_empty(), "ARCHITECTURE's table lacks {missing:?}");
    let mut wrong = Vec::new();
    for (module, allowed) in &table {
        let Some(found) = uses.get(module) else {
            wrong.push(format!("the table has `{module}`, which is not there"));
            continue;
        };
        let Some(allowed) = allowed else { continue };
        let more = found.iter().filter(|(name, _)| !allowed.contains(*name));
        wrong.extend(
            more.map(|(name, file)| {
                format!("`{module}` uses `{name}` ({}), the table does not say so", file.display())
            }),
        );
        let less = allowed.iter().filter(|name| !found.contains_key(*name));
        wrong.extend(less.map(|name| format!("`{module}` does not use `{name}`, the table says so")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The table is ordered: a module uses what stands above it, so there is no circle.
#[test]
fn modules_use_only_what_stands_above_them() {
    let (uses, table) = (uses(), table());
    let floor = |name: &str| table.iter().position(|(module, _)| module == name).unwrap();
    let upward =
        table.iter().filter_map(|(module, _)| Some((module, uses.get(module)?))).flat_map(|(module, found)| {
            let up = found.iter().filter(move |(name, _)| floor(name) >= floor(module));
            up.map(move |(name, file)| format!("{} uses {name}, which stands below {module}", file.display()))
        });
    let upward: Vec<String> = upward.collect();
    assert!(upward.is_empty(), "{}", upward.join("\n"));
}

/// The scan sees what it is for.
#[test]
fn imports_are_found() {
    let uses = uses();
    assert!(uses.len() >= 15 && uses["filter"].contains_key("tape") && uses["data"].contains_key("words"), "{uses:?}");
    let text = "use crate::data::Log; // crate::cli\n/// [`crate::study`]\nlet x = crate::tape::run();\n#[cfg(test)]\nmod tests { use crate::evaluate; }";
    assert_eq!(names(text).collect::<Vec<_>>(), ["data", "tape"]);
}

/// Files of `src` whose code says one of the words, tests left out.
fn saying(words: &[&str]) -> BTreeSet<String> {
    let said = |path: &PathBuf| {
        let text = fs::read_to_string(path).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let lines = code.lines().map(|line| line.split("//").next().unwrap_or_default());
        let mut tokens = lines.flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '-'));
        tokens.any(|token| words.contains(&token))
    };
    let name = |path: PathBuf| path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned();
    sources(&root().join("src")).into_iter().filter(said).map(name).collect()
}

/// Source files that the paragraph of ARCHITECTURE.md on how to add something names.
fn named_for(what: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let paragraph = text.split("\n\n").find(|paragraph| paragraph.starts_with(&format!("**{what}**")));
    let paragraph = paragraph.unwrap_or_else(|| panic!("ARCHITECTURE.md says how to add {what}"));
    let quoted = paragraph.split('`').skip(1).step_by(2);
    let files = quoted.filter(|name| Path::new(name).extension().is_some_and(|extension| extension == "rs"));
    let files: BTreeSet<String> = files.filter(|name| name.starts_with("src/")).map(str::to_owned).collect();
    files.iter().for_each(|file| assert!(root().join(file).is_file(), "{what}: there is no {file}"));
    files
}

/// Types that implement a trait below a folder, with the file of each.
fn implementors(of: &str, folder: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for path in sources(&root().join(folder)) {
        let text = fs::read_to_string(&path).unwrap();
        let file = path.strip_prefix(root()).unwrap().to_str().unwrap().to_owned();
        for line in text.lines().filter(|line| line.starts_with("impl")) {
            let Some((_, rest)) = line.split_once(&format!("{of} for ")) else { continue };
            let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
            found.push((rest[..end].to_owned(), file.clone()));
        }
    }
    found
}

/// Files that know every one of some things: those that whoever adds another has to touch.
fn knowing_all(things: &[Vec<&str>]) -> BTreeSet<String> {
    let sets: Vec<BTreeSet<String>> = things.iter().map(|words| saying(words)).collect();
    let first = sets[0].clone();
    sets.iter().fold(first, |all, set| all.intersection(set).cloned().collect())
}

#[test]
fn a_newcomer_adds_an_objective_by_the_files_named() {
    let text = fs::read_to_string(root().join("src/objective/mod.rs")).unwrap();
    let list = text.split("pub const ALL").nth(1).unwrap().split("];").next().unwrap();
    let kinds: Vec<&str> = list.split("Self::").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    assert!(kinds.len() >= 7 && kinds.contains(&"Distance"), "{kinds:?}");
    let things: Vec<Vec<&str>> = kinds.iter().map(|kind| vec![*kind]).collect();
    assert_eq!(knowing_all(&things), named_for("An objective"));
}

#[test]
fn a_newcomer_adds_an_optimiser_by_the_files_named() {
    let methods = implementors("Optimizer", "src/optimize");
    let listed = saying(&["ALGORITHMS"]);
    assert!(methods.len() >= 4 && listed.contains("src/optimize/registry.rs"), "{methods:?}");
    let of_the_registry: Vec<Vec<&str>> = methods
        .iter()
        .map(|(name, _)| vec![name.as_str()])
        .filter(|name| saying(name).contains("src/optimize/registry.rs"))
        .collect();
    assert!(of_the_registry.len() >= 3, "{methods:?}");
    assert_eq!(knowing_all(&of_the_registry), named_for("An optimiser"));
}

#[test]
fn a_newcomer_adds_a_moment_rule_by_the_files_named() {
    let rules = implementors("MomentRule", "src/filter");
    assert!(!rules.is_empty(), "there is a moment rule");
    for (name, file) in &rules {
        let mut others = saying(&[name.as_str()]);
        others.retain(|other| other.starts_with("src/filter/") && other != file);
        assert_eq!(others, named_for("A moment rule"), "{name}");
    }
}

/// A filter kind stands in its own files and in the lists of kinds; everybody else asks its facts.
#[test]
fn filter_kinds_are_known_to_their_own_files_and_lists() {
    let kinds = implementors("Described", "src/model/family");
    assert!(kinds.len() >= 4, "{kinds:?}");
    let lists = named_for("A family of filters");
    // The Kalman filter's name is on everything that all of them share.
    for (name, file) in kinds.iter().filter(|(name, _)| name != "Kalman") {
        let own = file.rsplit('/').next().unwrap();
        let mut others = saying(&[name.as_str(), own.trim_end_matches(".rs").replace('_', "-").as_str()]);
        others.retain(|other| !other.ends_with(&format!("/{own}")) && !other.starts_with("src/reproduce/"));
        let unknown: Vec<_> = others.difference(&lists).collect();
        assert!(unknown.is_empty(), "{name} is known to {unknown:?}");
    }
}
