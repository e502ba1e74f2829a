//! The folder of a plan: whose it is, and what an earlier plan left in it.

use crate::failure::Failure;
use crate::output::DIGESTS;
use crate::output::unfinished::is_unfinished;
use crate::verb::earlier::TIMELINE;
use formats::products::{ALWAYS, Also};
use planner::provenance::PROGRAM;
use serde_json::Value;
use std::path::Path;

/// Every file that `plan` may have written.
fn own_files() -> impl Iterator<Item = &'static str> {
    let also = Also::EACH.into_iter().flat_map(|it| it.files().iter().copied());
    ALWAYS.into_iter().chain(also).chain([DIGESTS])
}

/// Whether the folder is one that `plan` wrote, or empty. A place that cannot be a folder is told
/// before the work; one that others wrote must be forced.
pub(super) fn is_ours(folder: &Path, force: bool) -> Result<bool, Failure> {
    let not_a_folder = folder.ancestors().find(|path| path.exists() && !path.is_dir());
    if let Some(file) = not_a_folder {
        return Err(Failure::Input(format!(
            "cannot write into {}: {} is a file",
            folder.display(),
            file.display()
        )));
    }
    if !folder.exists() {
        return Ok(true);
    }
    let entries = std::fs::read_dir(folder)
        .and_then(Iterator::collect::<Result<Vec<_>, _>>)
        .map_err(|error| Failure::file("use", folder, &error))?;
    let known = |entry: &std::fs::DirEntry| {
        let found = entry.file_name();
        is_unfinished(&found) || own_files().any(|name| found.as_os_str() == name)
    };
    let program = PROGRAM.split(' ').next().unwrap_or(PROGRAM);
    let marked = || {
        let text = std::fs::read(folder.join(TIMELINE)).unwrap_or_default();
        let value: Value = serde_json::from_slice(&text).unwrap_or_default();
        value["program"].as_str().is_some_and(|name| name.starts_with(program))
    };
    // A plan that was cut short may have left no timeline, or nothing but unfinished files.
    let begun = folder.join(DIGESTS).exists();
    let unfinished = |entry: &std::fs::DirEntry| is_unfinished(&entry.file_name());
    let ours = entries.iter().all(unfinished) || (entries.iter().all(known) && (begun || marked()));
    if ours || force {
        return Ok(ours);
    }
    Err(Failure::Input(format!(
        "{} is not empty and plan did not write it: an empty or new folder is needed (or --force, \
         which overwrites {} there)",
        folder.display(),
        ALWAYS.join(", ")
    )))
}

/// Removes products of an earlier plan that this one does not have: they would contradict it.
pub(super) fn remove_stale(folder: &Path, written: &[&str]) -> Result<(), Failure> {
    for name in own_files().filter(|name| !written.contains(name) && *name != DIGESTS) {
        let path = folder.join(name);
        if path.exists() {
            std::fs::remove_file(&path).map_err(|error| Failure::file("remove", &path, &error))?;
        }
    }
    Ok(())
}
