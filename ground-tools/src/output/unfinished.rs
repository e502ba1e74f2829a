//! Files that are not finished: hidden beside their places, and removed when the program ends early.
//!
//! Their names begin with [`PREFIX`]. The lock of a folder is one of them.

use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// How the names of unfinished files begin.
pub const PREFIX: &str = ".gyrfalcon-";
const LOCK: &str = ".gyrfalcon-lock";

static ALL: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Notes a file or an empty folder that must go if the program ends early.
pub(super) fn note(path: &Path) {
    ALL.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
}

/// It is finished, or gone.
pub(super) fn forget(path: &Path) {
    ALL.lock().unwrap_or_else(PoisonError::into_inner).remove(path);
}

/// Removes them all; what cannot be removed stays.
pub(super) fn remove_all() {
    let all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
    // Files first, then the folders that held nothing else: longer paths come last in order.
    for path in all.iter().rev() {
        let _ = std::fs::remove_file(path).or_else(|_| std::fs::remove_dir(path));
    }
}

/// Whether a file of this name is one that an earlier program left unfinished.
#[must_use]
pub fn is_unfinished(name: &std::ffi::OsStr) -> bool {
    name.to_string_lossy().starts_with(PREFIX)
}

/// A folder in which nobody else writes meanwhile.
#[derive(Debug)]
pub struct Locked {
    folder: PathBuf,
    lock: PathBuf,
    made: bool,
    _file: File,
}

impl Locked {
    /// Locks a folder, which is made if need be; `None` where another program holds it.
    ///
    /// # Errors
    /// What the system said.
    pub fn folder(folder: &Path) -> std::io::Result<Option<Self>> {
        let made = !folder.exists();
        std::fs::create_dir_all(folder)?;
        let lock = folder.join(LOCK);
        let file = File::options().create(true).append(true).open(&lock)?;
        // Where the system has no locks there is none to wait for.
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            return Ok(None);
        }
        if made {
            note(folder);
        }
        note(&lock);
        Ok(Some(Self { folder: folder.to_owned(), lock, made, _file: file }))
    }

    /// Removes what earlier programs left unfinished in the folder.
    pub fn clear(&self) {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return };
        for entry in entries.flatten() {
            let path = entry.path();
            if is_unfinished(&entry.file_name()) && path != self.lock {
                let _ = std::fs::remove_file(path);
            }
        }
    }
}

impl Drop for Locked {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.lock);
        forget(&self.lock);
        if self.made {
            // Only a folder that stayed empty goes.
            let _ = std::fs::remove_dir(&self.folder);
            forget(&self.folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_one_writer_and_goes_where_it_stays_empty() {
        let base = tempfile::tempdir().unwrap();
        let folder = base.path().join("plan");
        let first = Locked::folder(&folder).unwrap().unwrap();
        assert!(Locked::folder(&folder).unwrap().is_none());
        let left = folder.join(".gyrfalcon-abc");
        std::fs::write(&left, "x").unwrap();
        first.clear();
        assert!(!left.exists());
        drop(first);
        assert!(!folder.exists());
        let second = Locked::folder(&folder).unwrap().unwrap();
        std::fs::write(folder.join("a"), "x").unwrap();
        drop(second);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    }
}
