//! Where results go: whole, or not at all.
//!
//! A file is written beside its place and renamed into it; a plan's folder gets its files only when
//! all of them could be written. `-` is standard output; a reader that closes it early is no error.

use crate::failure::Failure;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use tempfile::NamedTempFile;

/// Where one result goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sink {
    /// Standard output.
    Stdout,
    /// A file.
    File(PathBuf),
}

impl FromStr for Sink {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "" => Err("a path, or - for standard output, is needed".to_owned()),
            "-" => Ok(Self::Stdout),
            path => Ok(Self::File(PathBuf::from(path))),
        }
    }
}

impl Sink {
    /// Writes `bytes`, whole or not at all.
    ///
    /// # Errors
    /// [`Failure::Input`] names the path and what the system said.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        match self {
            Self::Stdout => to_stdout(bytes),
            Self::File(path) => beside(path, bytes)?.place(),
        }
    }
}

/// Writes to standard output; a closed pipe ends quietly.
///
/// # Errors
/// [`Failure::Input`] with what the system said.
pub fn to_stdout(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::file("write", Path::new("standard output"), &error))
        }
        _ => Ok(()),
    }
}

/// Writes files into a folder, which is made if need be: all of them or none.
///
/// # Errors
/// [`Failure::Input`] names the path and what the system said.
pub fn write_folder(folder: &Path, files: &[(&str, &[u8])]) -> Result<(), Failure> {
    let made = !folder.exists();
    std::fs::create_dir_all(folder).map_err(|error| Failure::file("create", folder, &error))?;
    let written: Result<Vec<_>, _> =
        files.iter().map(|(name, bytes)| beside(&folder.join(name), bytes)).collect();
    match written {
        Ok(files) => files.into_iter().try_for_each(Written::place),
        Err(failure) => {
            if made {
                // The folder is empty: what was written in it is already gone.
                let _ = std::fs::remove_dir(folder);
            }
            Err(failure)
        }
    }
}

/// A file that is complete but not yet in its place.
struct Written {
    file: NamedTempFile,
    path: PathBuf,
}

impl Written {
    fn place(self) -> Result<(), Failure> {
        let Self { file, path } = self;
        file.persist(&path).map_err(|error| Failure::file("write", &path, &error.error))?;
        Ok(())
    }
}

fn beside(path: &Path, bytes: &[u8]) -> Result<Written, Failure> {
    let fail = |error: std::io::Error| Failure::file("write", path, &error);
    if path.is_dir() {
        return Err(Failure::Input(format!("cannot write {}: it is a folder", path.display())));
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As a plain file would be; the user's mask still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.prefix(".gyrfalcon-").tempfile_in(folder).map_err(fail)?;
    file.write_all(bytes).and_then(|()| file.flush()).map_err(fail)?;
    Ok(Written { file, path: path.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_whole_and_replaces_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        Sink::File(path.clone()).write(b"old").unwrap();
        Sink::File(path.clone()).write(b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_unwritable_place_is_named_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("no/such/place.csv");
        let failure = Sink::File(missing).write(b"x").unwrap_err();
        assert!(failure.to_string().contains("place.csv"), "{failure}");
        assert_eq!(failure.exit_code(), 2);
        let failure = Sink::File(folder.path().to_owned()).write(b"x").unwrap_err();
        assert!(failure.to_string().contains("it is a folder"), "{failure}");

        let plan = folder.path().join("plan");
        let failure = write_folder(&plan, &[("a", b"1"), ("no/b", b"2")]).unwrap_err();
        assert!(failure.to_string().contains("no/b"), "{failure}");
        assert!(!plan.exists());
        write_folder(&plan, &[("a", b"1"), ("b", b"2")]).unwrap();
        assert_eq!(std::fs::read_dir(&plan).unwrap().count(), 2);
    }
}
