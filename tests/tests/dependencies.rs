//! What the project is built from: licences, and one version of flight arithmetic everywhere.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read_toml(path: &str) -> toml::Table {
    std::fs::read_to_string(root().join(path)).unwrap().parse().unwrap()
}

#[test]
fn every_licence_is_one_that_deny_toml_allows() {
    let deny = read_toml("deny.toml");
    let allowed: Vec<&str> =
        deny["licenses"]["allow"].as_array().unwrap().iter().map(|l| l.as_str().unwrap()).collect();
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked", "--filter-platform"])
        .arg("x86_64-unknown-linux-gnu")
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() > 50);
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let licence = package["license"].as_str().unwrap_or_else(|| panic!("{name}: no licence"));
        let expression = spdx::Expression::parse_mode(licence, spdx::ParseMode::LAX)
            .unwrap_or_else(|error| panic!("{name}: {licence}: {error}"));
        let granted =
            expression.evaluate(|requirement| allowed.contains(&requirement.to_string().as_str()));
        assert!(granted, "{name} has licence {licence}");
    }
}

fn versions(lock: &str) -> BTreeMap<String, Vec<String>> {
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in read_toml(lock)["package"].as_array().unwrap() {
        let text = |key: &str| package[key].as_str().unwrap().to_owned();
        versions.entry(text("name")).or_default().push(text("version"));
    }
    versions
}

#[test]
fn what_stands_apart_links_the_same_arithmetic() {
    let ours = versions("Cargo.lock");
    for lock in [
        "onboard-core/c/Cargo.lock",
        "tests/link-probe/Cargo.lock",
        "tests/firmware/Cargo.lock",
        "tests/fuzz/Cargo.lock",
        "tests/rtos/Cargo.lock",
    ] {
        let theirs = versions(lock);
        for name in ["nalgebra", "libm", "heapless", "crc", "serde", "simba", "num-traits"] {
            let found = theirs.get(name).unwrap_or_else(|| panic!("{name} is not in {lock}"));
            let [version] = &found[..] else { panic!("{name} twice in {lock}") };
            assert!(ours[name].contains(version), "{name} {version} in {lock}, {:?}", ours[name]);
        }
    }
}

/// Crates of which `RustSec` says that they are unmaintained or unsound, in all versions or below one.
const ADVISED_AGAINST: [(&str, Option<&str>); 30] = [
    ("adler", None),
    ("ansi_term", None),
    ("atty", None),
    ("backoff", None),
    ("bincode", None),
    ("chrono", Some("0.4.20")),
    ("derivative", None),
    ("dotenv", None),
    ("encoding", None),
    ("failure", None),
    ("fast-float", None),
    ("fxhash", None),
    ("gcc", None),
    ("instant", None),
    ("lexical-core", Some("1.0.0")),
    ("mach", None),
    ("net2", None),
    ("number_prefix", None),
    ("paste", None),
    ("proc-macro-error", None),
    ("proc-macro-error2", None),
    ("quick-xml", Some("0.40.0")),
    ("rustc-serialize", None),
    ("safemem", None),
    ("serde_yaml", None),
    ("stdweb", None),
    ("tempdir", None),
    ("term_size", None),
    ("users", None),
    ("yaml-rust", None),
];

/// A version as numbers.
fn numbers(version: &str) -> Vec<u64> {
    version.split('.').map(|part| part.parse().unwrap_or(0)).collect()
}

#[test]
fn every_crate_advised_against_has_its_reason() {
    let deny = read_toml("deny.toml");
    let reasons: Vec<String> = deny["advisories"]["ignore"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["reason"].as_str().unwrap().to_owned())
        .collect();
    let is_named = |name: &str| {
        let begins = |reason: &String| {
            reason.strip_prefix(name).is_some_and(|it| it.starts_with([':', ' ']))
        };
        reasons.iter().any(begins)
    };
    let ours = versions("Cargo.lock");
    for (name, fixed) in ADVISED_AGAINST {
        let found = ours.get(name).map_or(&[][..], Vec::as_slice);
        let bad = |it: &String| fixed.is_none_or(|fixed| numbers(it) < numbers(fixed));
        let is_here = found.iter().any(bad);
        assert_eq!(is_here, is_named(name), "{name} {found:?}");
    }
}

/// The compilers that bits and budgets were recorded with are named where the budgets are explained.
#[test]
fn the_compilers_of_the_budgets_are_named() {
    let recorded = read_toml("tests/firmware/budget.toml");
    let recorded = |key: &str| recorded["compiler"][key].as_str().unwrap().to_owned();
    let page = std::fs::read_to_string(root().join("docs/onboard.md")).unwrap();
    for version in [recorded("host"), recorded("thumb")] {
        assert_eq!(version.split('.').count(), 3, "{version} is one version");
        assert!(page.contains(&format!("Rust {version}")), "docs/onboard.md names no {version}");
    }
}
