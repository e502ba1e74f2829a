//! The codes and sizes of the header against the tables of `docs/c-interface.md`.

use crate::toolchain::root;
use libtest_mimic::Failed;
use std::collections::{BTreeMap, BTreeSet};

/// Names and numbers of `enum gyr_error_t`.
fn of_the_header() -> Result<Vec<(String, i32)>, Failed> {
    let header = std::fs::read_to_string(root().join("onboard-core/c/include/gyrfalcon.h"))?;
    let (_, behind) = header.split_once("enum gyr_error_t").ok_or("the header has no codes")?;
    let (codes, _) = behind.split_once("};").ok_or("the codes have no end")?;
    let entry = |line: &str| {
        let (name, number) = line.trim().trim_end_matches(',').split_once(" = ")?;
        Some((name.to_owned(), number.parse().ok()?))
    };
    Ok(codes.lines().filter_map(entry).collect())
}

/// Names and numbers of the rows `| number | `name` | meaning |`.
fn of_the_docs() -> Result<BTreeMap<String, i32>, Failed> {
    let page = std::fs::read_to_string(root().join("docs/c-interface.md"))?;
    let row = |line: &str| {
        let mut cells = line.strip_prefix('|')?.split('|').map(str::trim);
        let number = cells.next()?.parse().ok()?;
        Some((cells.next()?.trim_matches('`').to_owned(), number))
    };
    Ok(page.lines().filter_map(row).collect())
}

/// Both have the same codes.
pub fn documented() -> Result<(), Failed> {
    let header: BTreeMap<String, i32> = of_the_header()?.into_iter().collect();
    let docs = of_the_docs()?;
    if header.len() < 100 {
        return Err(format!("the header was not read: {header:?}").into());
    }
    let missing: Vec<_> = header.iter().filter(|(name, at)| docs.get(*name) != Some(at)).collect();
    let stale: Vec<_> = docs.iter().filter(|(name, at)| header.get(*name) != Some(at)).collect();
    if missing.is_empty() && stale.is_empty() {
        return Ok(());
    }
    Err(format!("docs/c-interface.md lacks {missing:?} and has {stale:?} beyond the header").into())
}

/// No number twice.
pub fn unique() -> Result<(), Failed> {
    let mut by_number = BTreeMap::new();
    for (name, number) in of_the_header()? {
        if let Some(other) = by_number.insert(number, name.clone()) {
            return Err(format!("{name} and {other} are both {number}").into());
        }
    }
    Ok(())
}

/// The docs name every state's words as the header has them.
pub fn words() -> Result<(), Failed> {
    let header = std::fs::read_to_string(root().join("onboard-core/c/include/gyrfalcon.h"))?;
    let page = std::fs::read_to_string(root().join("docs/c-interface.md"))?;
    let mut count = 0;
    for line in header.lines().filter_map(|line| line.strip_prefix("#define ")) {
        if let Some((name, words)) = line.split_once(' ')
            && name.ends_with("_WORDS")
        {
            count += 1;
            if !page.contains(&format!("`{name}` {words} ")) {
                return Err(format!("docs/c-interface.md lacks {name} {words}").into());
            }
        }
    }
    if count < 8 { Err(format!("{count} states in the header").into()) } else { Ok(()) }
}

/// What the pages name of the interface is in the header.
pub fn named() -> Result<(), Failed> {
    let header = std::fs::read_to_string(root().join("onboard-core/c/include/gyrfalcon.h"))?;
    let word = |letter: char| !(letter.is_ascii_alphanumeric() || letter == '_');
    let known: BTreeSet<&str> = header.split(word).collect();
    for page in ["docs/c-interface.md", "docs/integration.md"] {
        let text = std::fs::read_to_string(root().join(page))?;
        let named = |it: &&str| {
            let ours = it.starts_with("gyr_") || it.starts_with("GYR_");
            ours && !it.starts_with("GYR_APP_") && !it.ends_with("_MID") && it.len() > 4
        };
        let strange: Vec<&str> = text.split(word).filter(named).collect();
        if strange.len() < 20 {
            return Err(format!("{page} was not read").into());
        }
        let strange: Vec<_> = strange
            .into_iter()
            .filter(|it| !known.contains(it) && *it != "gyr_panic_is_reachable")
            .collect();
        if !strange.is_empty() {
            return Err(format!("{page} names {strange:?}, which the header lacks").into());
        }
    }
    Ok(())
}
