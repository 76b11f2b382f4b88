//! No two files of a folder of `src` use each other, directly or around. A file and the folder of its name are one; what a
//! folder's `mod.rs` has belongs to the folder, so that its files may use it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use crate::{root, sources};

/// Folders in which files still use each other around a circle: errors and what they are of, optimisers and their registry, a
/// record and what it can be resumed from.
const KNOWN: [&str; 4] = ["data", "optimize", "study", "study/front"];

/// A module by its path, without `crate`.
type Path = Vec<String>;

/// The paths that each module names, and of each module the names that it takes from a child.
#[derive(Default)]
struct Modules {
    named: BTreeMap<Path, Vec<Path>>,
    given: BTreeMap<Path, BTreeMap<String, Path>>,
}

fn joined(path: &[String], name: &str) -> Path {
    path.iter().cloned().chain([name.to_owned()]).collect()
}

/// Code without comments and without a test module at its end.
fn code(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    code.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// `a::{b, c::d}` is `a::b` and `a::c::d`.
fn expanded(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((before, list)) = tree.strip_suffix('}').and_then(|tree| tree.split_once('{')) else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in list.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 { parts.push(String::new()) } else { parts.last_mut().unwrap().push(c) }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| expanded(part)).map(|path| format!("{before}{path}")).collect()
}

/// The paths of `use` statements, and those that begin with `super` or `crate` in between.
fn paths(code: &str) -> Vec<Path> {
    let uses = code.split(';').filter_map(|statement| {
        let at = statement.rfind("use ").filter(|at| *at == 0 || statement[..*at].ends_with(['\n', ' ']))?;
        Some(expanded(&statement[at + "use ".len()..]))
    });
    let inline = ["super::", "crate::"].into_iter().flat_map(|start| {
        let whole = code.match_indices(start).filter(|(at, _)| !code[..*at].ends_with("::"));
        whole.map(|(at, _)| {
            let rest = &code[at..];
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_' && c != ':').unwrap_or(rest.len());
            rest[..end].to_owned()
        })
    });
    let split = |path: String| path.split("::").map(str::to_owned).collect();
    uses.flatten().chain(inline).map(split).collect()
}

impl Modules {
    fn read() -> Self {
        let mut modules = Self::default();
        for file in sources(&root().join("src")) {
            let inside = file.strip_prefix(root().join("src")).unwrap().with_extension("");
            let mut path: Path = inside.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
            if ["mod", "lib"].contains(&path.last().unwrap().as_str()) {
                path.pop();
            }
            modules.named.insert(path, paths(&code(&fs::read_to_string(file).unwrap())));
        }
        for (module, named) in &modules.named {
            let child = |path: &&Path| path.len() > 1 && modules.named.contains_key(&joined(module, &path[0]));
            let given = named.iter().filter(child);
            let given = given.map(|path| (path[path.len() - 1].clone(), joined(module, &path[0]))).collect();
            modules.given.insert(module.clone(), given);
        }
        modules
    }

    /// The module that a path named in `from` leads to, through what modules on the way take from their children.
    fn resolve(&self, from: &Path, path: &Path) -> Path {
        let ups = path.iter().take_while(|part| *part == "super").count();
        let (mut at, mut rest) = match path[0].as_str() {
            "crate" => (Path::new(), &path[1..]),
            _ => (from[..from.len().saturating_sub(ups)].to_vec(), &path[ups..]),
        };
        while let Some((name, after)) = rest.split_first() {
            let child = joined(&at, name);
            if self.named.contains_key(&child) {
                (at, rest) = (child, after);
            } else if let Some(origin) = self.given.get(&at).and_then(|given| given.get(name)) {
                at.clone_from(origin);
            } else {
                break;
            }
        }
        at
    }

    /// Of a folder's entries, which uses which.
    fn among(&self, folder: &[String]) -> BTreeMap<&str, BTreeSet<String>> {
        let entry = |path: &[String]| path.strip_prefix(folder).and_then(<[String]>::first).cloned();
        let mut uses: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
        for (module, named) in self.named.iter().filter(|(module, _)| module.starts_with(folder)) {
            let Some(own) = module.get(folder.len()) else { continue };
            let others = named.iter().filter_map(|path| entry(&self.resolve(module, path)));
            uses.entry(own).or_default().extend(others.filter(|other| other != own));
        }
        uses
    }
}

/// Entries that reach themselves.
fn circles(uses: &BTreeMap<&str, BTreeSet<String>>) -> Vec<String> {
    let reaches_itself = |start: &&&str| {
        let mut seen = BTreeSet::new();
        let mut next: Vec<&str> = vec![**start];
        while let Some(entry) = next.pop() {
            let used = uses.get(entry).into_iter().flatten().map(String::as_str);
            next.extend(used.filter(|used| seen.insert(used.to_owned())));
        }
        seen.contains(**start)
    };
    uses.keys().filter(reaches_itself).map(|entry| (*entry).to_owned()).collect()
}

#[test]
fn no_two_files_of_a_folder_use_each_other() {
    let modules = Modules::read();
    let folders: BTreeSet<&[String]> = modules.named.keys().filter_map(|path| Some(path.split_last()?.1)).collect();
    let mut found = BTreeMap::new();
    for folder in folders {
        let circles = circles(&modules.among(folder));
        if !circles.is_empty() {
            found.insert(folder.join("/"), circles);
        }
    }
    let new: Vec<_> = found.iter().filter(|(folder, _)| !KNOWN.contains(&folder.as_str())).collect();
    assert!(new.is_empty(), "files use each other around a circle (move what they share below them): {new:?}");
    let gone: Vec<_> = KNOWN.iter().filter(|folder| !found.contains_key(**folder)).collect();
    assert!(gone.is_empty(), "no circle is left there, so take them off the list: {gone:?}");
}

/// The scan sees what it is for.
#[test]
fn circles_are_found() {
    let text = "use super::{b, c::{D, e}}; // use super::x;\npub use f::G as H;\nlet y = super::super::h::i(crate::j::K);\n#[cfg(test)]\nmod tests { use super::t; }";
    let mut found: Vec<String> = paths(&code(text)).iter().map(|path| path.join("::")).collect();
    found.retain(|path| !path.ends_with("::"));
    found.sort();
    assert_eq!(found, ["crate::j::K", "f::G", "super::b", "super::c::D", "super::c::e", "super::super::h::i"]);
    let uses = |edges: &[(&'static str, &str)]| {
        let mut uses: BTreeMap<&str, BTreeSet<String>> = BTreeMap::new();
        edges.iter().for_each(|(a, b)| _ = uses.entry(*a).or_default().insert((*b).to_owned()));
        circles(&uses)
    };
    assert_eq!(uses(&[("a", "b"), ("b", "c"), ("c", "b"), ("c", "d")]), ["b", "c"]);
    assert!(uses(&[("a", "b"), ("b", "c"), ("a", "c")]).is_empty());
}
