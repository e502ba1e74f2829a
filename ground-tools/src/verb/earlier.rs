//! An earlier plan of the same mission, to stay close to or to show the difference from.

use crate::failure::Failure;
use crate::output::{DIGESTS, digest};
use ephem::time::format_tdb;
use formats::products::ALWAYS;
use formats::timeline::{Difference, Timeline};
use mission::digest::sha256_hex;
use planner::world::World;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The file by which a plan is known.
pub(super) const TIMELINE: &str = ALWAYS[0];

/// Refuses a timeline beside files of another plan, as one that was cut short leaves them.
///
/// # Errors
/// [`Failure::Input`] names a file whose digest is not that of the folder's list.
pub(super) fn of_one_plan(timeline: &Path) -> Result<(), Failure> {
    let Some(folder) = timeline.parent() else { return Ok(()) };
    let list = folder.join(DIGESTS);
    let Ok(digests) = std::fs::read_to_string(&list) else { return Ok(()) };
    for line in digests.lines() {
        let Some((expected, name)) = line.split_once("  ") else { continue };
        let path = folder.join(name);
        // A file may have been taken away; what is there must be of this plan.
        let Ok(file) = std::fs::File::open(&path) else { continue };
        let found = digest(file).map_err(|error| Failure::file("read", &path, &error))?;
        if found != expected {
            return Err(Failure::Input(format!(
                "{} is not the file of that name in {}: the folder holds more than one plan, or was \
                 changed; plan writes it anew",
                path.display(),
                list.display()
            )));
        }
    }
    Ok(())
}

/// An earlier plan.
pub(super) struct Earlier {
    /// Its `timeline.json`.
    file: PathBuf,
    /// SHA-256 of that file.
    pub(super) sha256: String,
    /// What it holds.
    pub(super) timeline: Timeline,
}

impl Earlier {
    /// The plan of a folder, or of a `timeline.json`.
    ///
    /// # Errors
    /// [`Failure::Input`] where it is not one, names a session twice, or is another mission's.
    pub(super) fn read(path: &Path, world: &World) -> Result<Self, Failure> {
        let file = if path.is_dir() { path.join(TIMELINE) } else { path.to_owned() };
        of_one_plan(&file)?;
        let (timeline, bytes) = Timeline::read(&file)?;
        let place = file.display();
        let (mission, before) = (&world.mission.name, &timeline.provenance);
        if before.mission != *mission {
            return Err(Failure::Input(format!(
                "{place} is a plan of {}, but this mission is {mission}: an earlier plan of the \
                 same mission is needed",
                before.mission
            )));
        }
        if before.start_tai_ns != world.zero().tai_ns() {
            return Err(Failure::Input(format!(
                "{place} is a plan of {mission} from {}, but this mission starts at {}: precession \
                 turns, and so the ids of sessions, count from the start, which must be the same",
                before.start_tdb,
                format_tdb(world.zero())
            )));
        }
        let mut ids = BTreeSet::new();
        if let Some(twice) = timeline.sessions.iter().find(|it| !ids.insert(&it.id)) {
            return Err(Failure::Input(format!("{place} holds the session {} twice", twice.id)));
        }
        Ok(Self { file, sha256: sha256_hex(&bytes), timeline })
    }

    /// What a timeline changes.
    pub(super) fn difference(&self, now: &Timeline) -> Difference {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        Difference::of(&self.timeline, now, format!("{name}, SHA-256 {}", self.sha256))
    }
}
