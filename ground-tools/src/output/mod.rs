//! Where results go: whole, or not at all.
//!
//! A file is written beside its place and renamed into it; a device or a pipe is written to; a plan's
//! folder gets its files only when all of them could be written, and the digests of all of them before
//! any other, so that a mixture of two plans is known as one. `-` is standard output; a reader that
//! closes it early is no error.

pub mod unfinished;
pub mod figures;
pub mod interrupt;
pub mod memory;
pub mod stamp;
mod place;

use crate::failure::Failure;
use formats::WriteError;
use formats::products::Fill;
pub use place::is_device;

use place::{Written, beside, blame, into_device};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::io::{BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

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
    filled(folder, files)?.into_iter().try_for_each(|(_, written)| written.place())
}

/// The file of a folder's digests, as `sha256sum --check` takes it.
pub const DIGESTS: &str = "SHA256SUMS";

/// The same, with [`DIGESTS`] of all of them put in place before any other; the file named first comes
/// last.
///
/// # Errors
/// As [`fill_folder`].
pub fn fill_folder_with_digests(
    folder: &Path,
    files: Vec<(&str, Fill<'_>)>,
) -> Result<(), Failure> {
    let mut written = filled(folder, files)?;
    let mut digests = String::new();
    for (name, file) in &written {
        let fail = |error: std::io::Error| Failure::file("read", &folder.join(name), &error);
        let digest = digest(file.open().map_err(fail)?).map_err(fail)?;
        let _ = writeln!(digests, "{digest}  {name}");
    }
    let digests = beside(&folder.join(DIGESTS), |out| Ok(out.write_all(digests.as_bytes())?))?;
    let first = written.len().min(1);
    written.rotate_left(first);
    digests.1.place()?;
    written.into_iter().try_for_each(|(_, written)| written.place())
}

/// The SHA-256 of what a file holds, in hexadecimal.
///
/// # Errors
/// What the system said.
pub fn digest(mut file: std::fs::File) -> std::io::Result<String> {
    let mut digest = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => break,
            count => digest.update(&buffer[..count]),
        }
    }
    Ok(digest.finalize().iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    }))
}

fn filled<'n>(
    folder: &Path,
    files: Vec<(&'n str, Fill<'_>)>,
) -> Result<Vec<(&'n str, Written)>, Failure> {
    let made = !folder.exists();
    std::fs::create_dir_all(folder).map_err(|error| Failure::file("create", folder, &error))?;
    let write = |(name, fill): (&'n str, Fill<'_>)| {
        beside(&folder.join(name), fill).map(|((), written)| (name, written))
    };
    let written: Result<Vec<_>, _> = files.into_iter().map(write).collect();
    if written.is_err() && made {
        // The folder is empty: what was written in it is already gone.
        let _ = std::fs::remove_dir(folder);
    }
    written
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
