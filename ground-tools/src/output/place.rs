//! One file on its way to its place: written beside it, then put there.
//!
//! A link is followed, the mode of a file that is replaced stays, other names of it (hard links) see the
//! new contents; a read-only file is refused. What is no file, a device or a pipe, is written to.

use super::unfinished::{self, PREFIX};
use crate::failure::Failure;
use formats::WriteError;
use std::fs::{Metadata, OpenOptions, Permissions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Most links that are followed.
const MOST_LINKS: usize = 40;

/// Whether something stands there that is neither a file nor a folder: a device, a pipe. It is written
/// to, never replaced.
#[must_use]
pub fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

pub(super) fn into_device<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<T, Failure> {
    let fail = |error: std::io::Error| Failure::file("write", path, &error);
    let device = OpenOptions::new().write(true).open(path).map_err(fail)?;
    let mut out = BufWriter::new(device);
    let value = fill(&mut out).map_err(|error| blame(path, error))?;
    out.flush().map_err(fail)?;
    Ok(value)
}

/// What could not be written, with the place.
pub(super) fn blame(path: &Path, error: WriteError) -> Failure {
    match error {
        WriteError::Io(error) => Failure::file("write", path, &error),
        error => error.into(),
    }
}

/// A file that is complete but not yet in its place.
pub(super) struct Written {
    hidden: Option<NamedTempFile>,
    noted: PathBuf,
    path: PathBuf,
    /// Its contents are copied into what is there, which is not replaced.
    copied: bool,
}

impl Written {
    /// Puts it in its place.
    pub(super) fn place(mut self) -> Result<(), Failure> {
        let Some(hidden) = self.hidden.take() else { return Ok(()) };
        let fail = |error: &std::io::Error| Failure::file("write", &self.path, error);
        if self.copied {
            let mut from = hidden.reopen().map_err(|error| fail(&error))?;
            let mut options = OpenOptions::new();
            options.write(true).truncate(!is_device(&self.path));
            let mut to = options.open(&self.path).map_err(|error| fail(&error))?;
            std::io::copy(&mut from, &mut to).map_err(|error| fail(&error))?;
        } else {
            hidden.persist(&self.path).map_err(|error| fail(&error.error))?;
        }
        Ok(())
    }

    /// The bytes that it has.
    pub(super) fn open(&self) -> std::io::Result<std::fs::File> {
        match &self.hidden {
            Some(hidden) => hidden.reopen(),
            None => std::fs::File::open(&self.path),
        }
    }
}

impl Drop for Written {
    fn drop(&mut self) {
        unfinished::forget(&self.noted);
    }
}

/// Where a path leads over links, to what need not be there.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(target) = std::fs::read_link(&path) else { break };
        path = path.parent().map_or_else(|| target.clone(), |folder| folder.join(&target));
    }
    path
}

/// How many names a file has.
fn names(of: &Metadata) -> u64 {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        of.nlink()
    }
    #[cfg(not(unix))]
    {
        let _ = of;
        1
    }
}

/// The permissions of what is there, or those of a new file; the user's mask applies to these.
#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "other systems have no permissions for a new file")]
fn permissions(there: Option<&Metadata>) -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(there.map_or_else(|| Permissions::from_mode(0o666), Metadata::permissions))
}

#[cfg(not(unix))]
fn permissions(there: Option<&Metadata>) -> Option<Permissions> {
    there.map(Metadata::permissions)
}

/// Fills a file next to `path`; dropped before it is placed, it vanishes.
pub(super) fn beside<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<(T, Written), Failure> {
    let fail = |error: std::io::Error| Failure::file("write", path, &error);
    if path.is_dir() {
        return Err(Failure::Input(format!("cannot write {}: it is a folder", path.display())));
    }
    let place = followed(path);
    let there = std::fs::metadata(&place).ok();
    if there.as_ref().is_some_and(|it| it.is_file() && it.permissions().readonly()) {
        return Err(Failure::Input(format!("cannot write {}: it is read-only", path.display())));
    }
    let is_device = is_device(&place);
    let temporary = std::env::temp_dir();
    let folder = match place.parent() {
        _ if is_device => temporary.as_path(),
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    let plain = there.as_ref().filter(|it| it.is_file());
    if let Some(permissions) = permissions(plain) {
        builder.permissions(permissions);
    }
    let hidden = builder.prefix(PREFIX).tempfile_in(folder).map_err(fail)?;
    if let Some(plain) = plain {
        // The mask does not apply to the mode that was there.
        std::fs::set_permissions(hidden.path(), plain.permissions()).map_err(fail)?;
    }
    let noted = hidden.path().to_owned();
    unfinished::note(&noted);
    let copied = is_device || plain.is_some_and(|it| names(it) > 1);
    let mut written = Written { hidden: None, noted, path: place, copied };
    let mut out = BufWriter::new(hidden);
    let value = fill(&mut out).map_err(|error| blame(path, error))?;
    let hidden = out.into_inner().map_err(|error| fail(error.into_error()))?;
    written.hidden = Some(hidden);
    Ok((value, written))
}
