//! Where results go: whole, or not at all.
//!
//! A file is written beside its place and renamed into it; a device or a pipe is written to; a plan's folder gets its files only when
//! all of them could be written. `-` is standard output; a reader that closes it early is no error.

pub mod figures;
pub mod interrupt;
pub mod memory;
pub mod stamp;

use crate::failure::Failure;
use formats::WriteError;
use formats::products::Fill;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Where one result goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Sink {
    /// Standard output.
    Stdout,
    /// A file.
    File(PathBuf),
}

impl Sink {
    /// The place of that path; `-` is standard output.
    #[must_use]
    pub fn at(path: &Path) -> Self {
        if path.as_os_str() == "-" { Self::Stdout } else { Self::File(path.to_owned()) }
    }

    /// Writes `bytes`, whole or not at all.
    ///
    /// # Errors
    /// [`Failure::Input`] names the path and what the system said.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        self.write_with(|out| Ok(out.write_all(bytes)?))
    }

    /// Lets `fill` write: a file appears whole or not at all; a closed pipe ends quietly.
    ///
    /// # Errors
    /// [`Failure::Input`] names the path and what the system said, or what `fill` failed with.
    pub fn write_with<T: Default>(
        &self,
        fill: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
    ) -> Result<T, Failure> {
        match self {
            Self::Stdout => {
                let mut out = BufWriter::new(std::io::stdout().lock());
                let done = fill(&mut out).and_then(|value| {
                    out.flush()?;
                    Ok(value)
                });
                match done {
                    Err(WriteError::Io(error)) if error.kind() == ErrorKind::BrokenPipe => {
                        Ok(T::default())
                    }
                    other => other.map_err(|error| blame(Path::new("standard output"), error)),
                }
            }
            Self::File(path) if is_device(path) => into_device(path, fill),
            Self::File(path) => {
                let (value, written) = beside(path, fill)?;
                written.place()?;
                Ok(value)
            }
        }
    }
}

/// Whether something stands there that is neither a file nor a folder: a device, a pipe. It is written
/// to, never replaced.
fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|it| !it.is_file() && !it.is_dir())
}

fn into_device<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<T, Failure> {
    let fail = |error: std::io::Error| Failure::file("write", path, &error);
    let device = std::fs::OpenOptions::new().write(true).open(path).map_err(fail)?;
    let mut out = BufWriter::new(device);
    let value = fill(&mut out).map_err(|error| blame(path, error))?;
    out.flush().map_err(fail)?;
    Ok(value)
}

fn blame(path: &Path, error: WriteError) -> Failure {
    match error {
        WriteError::Io(error) => Failure::file("write", path, &error),
        error => error.into(),
    }
}

/// Writes text to standard output; a closed pipe ends quietly.
///
/// # Errors
/// [`Failure::Input`] with what the system said.
pub fn to_stdout(bytes: &[u8]) -> Result<(), Failure> {
    Sink::Stdout.write(bytes)
}

/// Writes files into a folder, which is made if need be: all of them or none.
///
/// # Errors
/// [`Failure::Input`] names the path and what the system said.
pub fn write_folder(folder: &Path, files: &[(&str, &[u8])]) -> Result<(), Failure> {
    fill_folder(folder, files.iter().map(|&(name, bytes)| (name, whole(bytes))).collect())
}

/// Writes bytes that are there already.
#[must_use]
pub fn whole(bytes: &[u8]) -> Fill<'_> {
    Box::new(move |out| Ok(out.write_all(bytes)?))
}

/// Fills files in a folder, which is made if need be: all of them appear or none.
///
/// # Errors
/// [`Failure::Input`] names the path and what the system said, or what a file failed with.
pub fn fill_folder(folder: &Path, files: Vec<(&str, Fill<'_>)>) -> Result<(), Failure> {
    let made = !folder.exists();
    std::fs::create_dir_all(folder).map_err(|error| Failure::file("create", folder, &error))?;
    let write = |(name, fill): (&str, Fill<'_>)| {
        beside(&folder.join(name), fill).map(|((), written)| written)
    };
    let written: Result<Vec<_>, _> = files.into_iter().map(write).collect();
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

/// Fills a file next to `path`; dropped before it is placed, it vanishes.
fn beside<T>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<T, WriteError>,
) -> Result<(T, Written), Failure> {
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
    let hidden = builder.prefix(".gyrfalcon-").tempfile_in(folder).map_err(fail)?;
    let mut out = BufWriter::new(hidden);
    let value = fill(&mut out).map_err(|error| blame(path, error))?;
    let hidden = out.into_inner().map_err(|error| fail(error.into_error()))?;
    Ok((value, Written { file: hidden, path: path.to_owned() }))
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

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_written_to_and_stays_one() {
        use std::os::unix::fs::FileTypeExt;
        let is_device =
            |path: &str| std::fs::metadata(path).is_ok_and(|it| it.file_type().is_char_device());
        Sink::File("/dev/null".into()).write(b"x").unwrap();
        assert!(is_device("/dev/null"));
        if is_device("/dev/full") {
            let failure = Sink::File("/dev/full".into()).write(b"x").unwrap_err();
            assert!(failure.to_string().contains("/dev/full"), "{failure}");
            assert!(is_device("/dev/full"));
        }
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
        let good: Fill<'_> = Box::new(|out| Ok(out.write_all(b"3")?));
        let fails: Fill<'_> =
            Box::new(|_| Err(WriteError::row(Failure::Input("no more".to_owned()))));
        assert!(fill_folder(&plan, vec![("a", good), ("b", fails)]).is_err());
        assert_eq!(std::fs::read(plan.join("a")).unwrap(), b"1");
        assert_eq!(std::fs::read_dir(&plan).unwrap().count(), 2);
    }
}
