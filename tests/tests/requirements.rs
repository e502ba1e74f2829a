//! Is every requirement on the flight core met by code and held by a test?
//!
//! Requirements are the table rows of `docs/onboard.md` that begin with an id such as `REQ-TIME-1`.
//! Code and tests name the ids that they serve in a comment: in `onboard-core/src` a mark outside the
//! modules under `#[cfg(test)]` is code, all others are tests. What serves what is written to
//! `docs/validation/requirements.md`; this test fails when that page is stale, when a requirement has
//! no code or no test, and when a mark names no requirement. `UPDATE_REQUIREMENTS=1` writes the page.
//!
//! Limits: a mark is a claim; that its test fails without the rule is shown by the mutants of
//! `docs/validation`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const STATED_IN: &str = "docs/onboard.md";
const TRACED_IN: &str = "docs/validation/requirements.md";
const CODE: &str = "onboard-core/src";
const TESTS: [&str; 4] =
    ["onboard-core/c", "tests/tests", "tests/fuzz/src", "ground-tools/tests/onboard.rs"];
/// A mark stands at most so many lines before the function that it belongs to.
const REACH: usize = 12;

/// Where a requirement is served: `file: function`.
#[derive(Debug, Default, Clone, PartialEq)]
struct Trace {
    code: Vec<String>,
    tests: Vec<String>,
}

/// The ids in a line, such as `REQ-TIME-1`.
fn ids(line: &str) -> Vec<&str> {
    line.match_indices("REQ-")
        .filter_map(|(at, _)| {
            let rest = &line[at..];
            let end = rest
                .find(|c: char| !(c.is_ascii_uppercase() || c.is_ascii_digit() || c == '-'))
                .unwrap_or(rest.len());
            let id = rest[..end].trim_end_matches('-');
            id.ends_with(|c: char| c.is_ascii_digit()).then_some(id)
        })
        .collect()
}

/// Requirements by id, in the order of the page.
fn stated(page: &str) -> Vec<(String, String)> {
    let row = |line: &str| {
        let mut cells = line.strip_prefix("| REQ-")?.split(" | ");
        let id = format!("REQ-{}", cells.next()?);
        Some((id, cells.next()?.trim_end_matches(" |").to_owned()))
    };
    page.lines().filter_map(row).collect()
}

/// The name of the function that a line begins.
fn function(line: &str) -> Option<&str> {
    let rest = &line[line.find("fn ")? + 3..];
    let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_'))?;
    (!line.trim_start().starts_with("//") && end > 0).then(|| &rest[..end])
}

/// Whether two lines begin a module that only tests have.
fn is_for_tests(lines: &[&str]) -> bool {
    lines[0].trim() == "#[cfg(test)]" && lines[1].contains("mod ")
}

/// The files of the modules that only tests have, declared in a file's text.
fn test_files(file: &str, text: &str) -> Vec<String> {
    let folder = file.rsplit_once('/').map_or("", |it| it.0);
    let lines: Vec<&str> = text.lines().collect();
    let modules = lines.windows(2).filter(|it| is_for_tests(it)).map(|it| it[1]);
    let name = |line: &str| {
        let name = line.split_once("mod ")?.1.strip_suffix(';')?;
        Some(format!("{folder}/{name}.rs"))
    };
    modules.filter_map(name).collect()
}

/// Adds what a file serves. Marks in `code` files count as code as far as their tests.
fn trace(file: &str, text: &str, code: bool, found: &mut BTreeMap<String, Trace>) {
    let lines: Vec<&str> = text.lines().collect();
    let tests_from = lines.windows(2).position(|it| is_for_tests(it) && it[1].ends_with('{'));
    for (number, line) in lines.iter().enumerate().filter(|(_, line)| line.contains("//")) {
        for id in ids(line) {
            let name = lines[number..].iter().take(REACH).find_map(|line| function(line));
            let place = name.map_or_else(|| format!("`{file}`"), |it| format!("`{file}: {it}`"));
            let trace = found.entry(id.to_owned()).or_default();
            let in_code = code && tests_from.is_none_or(|from| number < from);
            let places = if in_code { &mut trace.code } else { &mut trace.tests };
            if !places.contains(&place) {
                places.push(place);
            }
        }
    }
}

/// The page: a row for each requirement.
fn page(stated: &[(String, String)], found: &BTreeMap<String, Trace>) -> String {
    let mut text = format!(
        "# Requirements on the flight core, traced\n\nMade by `tests/tests/requirements.rs` from the \
         ids in [onboard.md](../onboard.md#requirements) and the marks in code and tests; \
         `UPDATE_REQUIREMENTS=1 cargo test --workspace --test requirements` writes it anew.\n\n\
         {} requirements.\n\n| id | requirement | code | tests |\n|---|---|---|---|\n",
        stated.len()
    );
    for (id, sentence) in stated {
        let none = Trace::default();
        let Trace { code, tests } = found.get(id).unwrap_or(&none);
        let _ = writeln!(
            text,
            "| {id} | {sentence} | {} | {} |",
            code.join("<br>"),
            tests.join("<br>")
        );
    }
    text
}

/// What is amiss, a line each.
fn faults(stated: &[(String, String)], found: &BTreeMap<String, Trace>) -> Vec<String> {
    let mut faults = Vec::new();
    for (index, (id, _)) in stated.iter().enumerate() {
        if stated[..index].iter().any(|earlier| earlier.0 == *id) {
            faults.push(format!("{id} is stated twice"));
        }
        let trace = found.get(id).cloned().unwrap_or_default();
        if trace.code.is_empty() {
            faults.push(format!("{id} has no code"));
        }
        if trace.tests.is_empty() {
            faults.push(format!("{id} has no test"));
        }
    }
    for (id, trace) in found.iter().filter(|(id, _)| !stated.iter().any(|it| it.0 == **id)) {
        let mut places = trace.code.iter().chain(&trace.tests);
        let place = places.next().map_or("", String::as_str);
        faults.push(format!("{place} names {id}, which {STATED_IN} does not state"));
    }
    faults
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Files of Rust and C below a path, by their paths in the repository.
fn files(below: &str) -> Vec<String> {
    let path = root().join(below);
    if path.is_file() {
        return vec![below.to_owned()];
    }
    let Ok(entries) = std::fs::read_dir(&path) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    let mut found = Vec::new();
    for name in names {
        let path = format!("{below}/{name}");
        if root().join(&path).is_dir() {
            if name != "target" {
                found.extend(files(&path));
            }
        } else if [".rs", ".c"].iter().any(|end| name.ends_with(end)) {
            found.push(path);
        }
    }
    found
}

#[test]
fn every_requirement_has_code_and_a_test() {
    let stated = stated(&std::fs::read_to_string(root().join(STATED_IN)).unwrap());
    assert!(!stated.is_empty(), "{STATED_IN} states no requirement");
    let mut found = BTreeMap::new();
    let text = |file: &String| std::fs::read_to_string(root().join(file)).unwrap();
    let core = files(CODE);
    let only_tests: Vec<String> =
        core.iter().flat_map(|file| test_files(file, &text(file))).collect();
    for file in &core {
        trace(file, &text(file), !only_tests.contains(file), &mut found);
    }
    for file in TESTS.iter().flat_map(|below| files(below)) {
        if !file.ends_with("requirements.rs") {
            trace(&file, &text(&file), false, &mut found);
        }
    }
    let faults = faults(&stated, &found);
    assert!(faults.is_empty(), "requirements:\n{}", faults.join("\n"));
    let page = page(&stated, &found);
    if std::env::var_os("UPDATE_REQUIREMENTS").is_some() {
        std::fs::write(root().join(TRACED_IN), &page).unwrap();
    }
    let written = std::fs::read_to_string(root().join(TRACED_IN)).unwrap_or_default();
    assert!(
        written == page,
        "{TRACED_IN} is stale: UPDATE_REQUIREMENTS=1 cargo test --workspace --test requirements"
    );
}

#[test]
fn a_requirement_without_code_or_test_is_found() {
    let stated = stated("| id | it must |\n| REQ-A-1 | hold |\n| REQ-A-2 | be | x |\n");
    assert_eq!(stated[1], ("REQ-A-2".to_owned(), "be".to_owned()));
    let mut found = BTreeMap::new();
    let text = "/// Holds (REQ-A-1).\npub fn hold() {}\n#[cfg(test)]\nmod tests {\n    // REQ-A-2, REQ-B-1\n    #[test]\n    fn holds() {}\n}\n";
    trace("a.rs", text, true, &mut found);
    let [first, second] = ["REQ-A-1", "REQ-A-2"].map(|id| found[id].clone());
    assert_eq!(first, Trace { code: vec!["`a.rs: hold`".to_owned()], tests: Vec::new() });
    assert_eq!(second, Trace { code: Vec::new(), tests: vec!["`a.rs: holds`".to_owned()] });
    let faults = faults(&stated, &found);
    assert_eq!(faults[..2], ["REQ-A-1 has no test", "REQ-A-2 has no code"]);
    assert_eq!(faults[2], "`a.rs: holds` names REQ-B-1, which docs/onboard.md does not state");
    assert_eq!(faults.len(), 3);
    let declared = test_files("a/b/mod.rs", "mod code;\n#[cfg(test)]\npub(super) mod rules;\n");
    assert_eq!(declared, ["a/b/rules.rs"]);
}
