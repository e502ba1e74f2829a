//! How the workspace is put together: no file imports what imports it, no file and no crate grows
//! without bounds.
//!
//! Crates are the workspace's members outside `tests`; files are named from the workspace's root.
//!
//! Imports are read from the source (`imports.rs`), circles among them found as `circles.rs` says.
//! `ACROSS_FOLDERS` and `IN_ONE_FOLDER` name what stands, `LIMITS` how large things may be: entries
//! are taken out and numbers lowered as the work on them ends.
//!
//! Limits: those of `modules.rs` and `imports.rs`. `made_up.rs` shows that the check can fail.

mod modules;
mod imports;
mod circles;
mod made_up;

use circles::Circle;
use imports::Graph;
use modules::Sources;
use std::collections::BTreeSet;
use std::fs::read_to_string;
use std::path::{Path, PathBuf};

/// Files, each with the folder it lies in, that may import each other in circles from folder to
/// folder; a folder with `/` at its end stands for all its files.
const ACROSS_FOLDERS: &[&[&str]] = &[];

/// The same for circles that stay in one folder.
const IN_ONE_FOLDER: &[&[&str]] = &[];

/// The largest number that a measure may have.
struct Limit {
    what: &'static str,
    measured: fn() -> Vec<(String, usize)>,
    at_most: usize,
    /// What `at_most` is to become.
    goal: usize,
    reason: &'static str,
}

const LIMITS: &[Limit] = &[
    Limit {
        what: "lines of a file",
        measured: lines_of_files,
        at_most: 600,
        goal: 600,
        reason: "a file is about one idea and is read in one sitting",
    },
    Limit {
        what: "lines below ground-tools/src",
        measured: || vec![("ground-tools/src".into(), lines_below("ground-tools/src"))],
        // Until the report is a crate of its own.
        at_most: 13_000,
        goal: 12_000,
        reason: "the command's crate holds what a person types and reads, not what is computed",
    },
    Limit {
        what: "rooms of ground-tools/src",
        measured: || vec![("ground-tools/src".into(), rooms("ground-tools/src").len())],
        at_most: 12,
        goal: 12,
        reason: "a newcomer finds the place for a change by the names at the top",
    },
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Adds the paths of files below a folder, but for hidden folders and what Cargo builds.
fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() {
            if !name.starts_with('.') && name != "target" {
                walk(&path, found);
            }
        } else {
            found.push(path);
        }
    }
}

/// The files below a folder with one of these extensions, from the root, with their texts.
fn read(folder: &str, extensions: &[&str]) -> Sources {
    let mut files = Vec::new();
    walk(&root().join(folder), &mut files);
    files
        .into_iter()
        .filter(|path| path.extension().is_some_and(|it| extensions.iter().any(|name| it == *name)))
        .map(|path| {
            let name = path.strip_prefix(root()).unwrap().to_str().unwrap().replace('\\', "/");
            (name, read_to_string(&path).unwrap())
        })
        .collect()
}

fn lines_of_files() -> Vec<(String, usize)> {
    // The C header is made from the sources, so nobody reads it for its ideas.
    let files = read("", &["rs", "js", "css", "sh", "py", "c"]);
    files.into_iter().map(|(name, text)| (name, text.lines().count())).collect()
}

fn lines_below(folder: &str) -> usize {
    read(folder, &["rs"]).values().map(|text| text.lines().count()).sum()
}

/// What stands at the top of a crate: `foo.rs` and `foo/` are one room.
fn rooms(folder: &str) -> BTreeSet<String> {
    std::fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned())
        .filter(|name| name != "lib" && name != "main")
        .collect()
}

/// Imports of the crates of a workspace.
fn graph() -> Graph {
    let manifest: toml::Table = read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    let members = manifest["workspace"]["members"].as_array().unwrap();
    let mut graph = Graph::new();
    for member in members.iter().map(|it| it.as_str().unwrap()) {
        if member.split('/').next() == Some("tests") {
            continue;
        }
        let sources = read(&format!("{member}/src"), &["rs"]);
        for name in ["lib.rs", "main.rs"] {
            let root = format!("{member}/src/{name}");
            if sources.contains_key(&root) {
                imports::add(&sources, &root, &mut graph);
            }
        }
    }
    graph
}

/// The last folder of a file and its name, so that a crate may take over a folder as it is.
fn place(file: &str) -> &str {
    file.rmatch_indices('/').nth(1).map_or(file, |(at, _)| &file[at + 1..])
}

/// What `circles` and the list of those that `may_stand` do not agree on, in sentences.
fn told(graph: &Graph, circles: &[Circle], may_stand: &[&[&str]]) -> Vec<String> {
    let holds = |files: &[&str], circle: &Circle| {
        circle.iter().map(|it| place(it)).all(|file| {
            files.iter().any(|it| *it == file || it.ends_with('/') && file.starts_with(it))
        })
    };
    let new = circles
        .iter()
        .filter(|circle| !may_stand.iter().any(|files| holds(files, circle)))
        .map(|circle| format!("a circle: {}", circles::told(graph, circle)));
    let gone = may_stand
        .iter()
        .filter(|files| !circles.iter().any(|circle| holds(files, circle)))
        .map(|files| format!("dissolved, take it off the list: {}", files.join(", ")));
    new.chain(gone).collect()
}

#[test]
fn no_circle_of_imports_crosses_folders() {
    let graph = graph();
    assert!(graph.len() > 200, "the source was not read: {} files", graph.len());
    let found = told(&graph, &circles::across_folders(&graph), ACROSS_FOLDERS);
    assert!(found.is_empty(), "imports across folders:\n{}", found.join("\n"));
}

#[test]
fn no_new_circle_of_imports_stays_in_a_folder() {
    let graph = graph();
    let found = told(&graph, &circles::in_one_folder(&graph), IN_ONE_FOLDER);
    assert!(found.is_empty(), "imports in one folder:\n{}", found.join("\n"));
}

#[test]
fn nothing_is_larger_than_its_limit() {
    let mut found = Vec::new();
    for limit in LIMITS {
        assert!(limit.goal <= limit.at_most);
        let measured = (limit.measured)();
        assert!(!measured.is_empty(), "nothing to count: {}", limit.what);
        found.extend(measured.into_iter().filter(|(_, number)| *number > limit.at_most).map(
            |(name, number)| {
                let Limit { what, at_most, reason, .. } = limit;
                format!("{name}: {number} {what}, at most {at_most}: {reason}")
            },
        ));
    }
    assert!(found.is_empty(), "too large:\n{}", found.join("\n"));
}
