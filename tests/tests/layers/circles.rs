//! Circles among the files of a graph of imports.
//!
//! The folder of a file is the directory that it lies in: `foo.rs` beside `foo/` belongs to the folder
//! of both, `foo/mod.rs` to `foo`.
//!
//! For each import the shortest way back is sought; the two together are a circle.
//!
//! Limits: a circle is told once for its set of files, and not where the files of a smaller one are
//! all in it; dissolve that one first.

use super::imports::Graph;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Files that import each other one after the other, the last one the first.
pub type Circle = Vec<String>;

/// The directory of a file.
pub fn folder(file: &str) -> &str {
    file.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Circles with an import from one folder to another.
pub fn across_folders(graph: &Graph) -> Vec<Circle> {
    circles(graph, |from, to| folder(from) != folder(to), |_, _| true)
}

/// Circles that stay in one folder.
pub fn in_one_folder(graph: &Graph) -> Vec<Circle> {
    let same = |from: &str, to: &str| folder(from) == folder(to);
    circles(graph, same, same)
}

/// For each import that `begins` a circle, the shortest way back over imports that `count`.
fn circles(
    graph: &Graph,
    begins: impl Fn(&str, &str) -> bool,
    count: impl Fn(&str, &str) -> bool,
) -> Vec<Circle> {
    let mut found = BTreeMap::<BTreeSet<String>, Circle>::new();
    for (from, ties) in graph {
        for to in ties.keys().filter(|to| begins(from, to)) {
            if let Some(mut back) = way(graph, to, from, &count) {
                let files = back.iter().cloned().collect();
                back.insert(0, from.clone());
                found.entry(files).or_insert(back);
            }
        }
    }
    let smaller = |files: &BTreeSet<String>| {
        found.keys().any(|other| other.len() < files.len() && other.is_subset(files))
    };
    found.iter().filter(|(files, _)| !smaller(files)).map(|(_, circle)| circle.clone()).collect()
}

/// The shortest way from one file to another, both included.
fn way(
    graph: &Graph,
    from: &str,
    to: &str,
    count: impl Fn(&str, &str) -> bool,
) -> Option<Vec<String>> {
    let mut came = BTreeMap::from([(from, from)]);
    let mut next = VecDeque::from([from]);
    while let Some(at) = next.pop_front() {
        if at == to {
            let mut way = vec![at.to_owned()];
            let mut at = at;
            while at != from {
                at = came[at];
                way.insert(0, at.to_owned());
            }
            return Some(way);
        }
        for other in graph.get(at).into_iter().flatten().map(|(other, _)| other.as_str()) {
            if count(at, other) && !came.contains_key(other) {
                came.insert(other, at);
                next.push_back(other);
            }
        }
    }
    None
}

/// A circle in one line, each import with the names that tie it.
pub fn told(graph: &Graph, circle: &Circle) -> String {
    let ties = circle.windows(2).map(|pair| {
        let names: Vec<&str> = graph[&pair[0]][&pair[1]].iter().map(String::as_str).collect();
        format!("{} ({})", pair[1], names.join(", "))
    });
    std::iter::once(circle[0].clone()).chain(ties).collect::<Vec<_>>().join(" -> ")
}
