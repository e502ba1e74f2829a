//! Why a file is no map that can be read.

use super::MapFrame;
use planner::healpix::MAX_NSIDE;
use std::path::PathBuf;
use thiserror::Error;

/// A map's file that cannot be used.
#[derive(Debug, Error)]
#[error("{}", told(path, error))]
pub struct FitsFileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub error: FitsError,
}

fn told(path: &std::path::Path, error: &FitsError) -> String {
    match error {
        FitsError::Io(error) => format!("cannot read {}: {error}", path.display()),
        error => format!("{} {error}", path.display()),
    }
}

/// What is wrong with a map's file, and what would be legal.
#[derive(Debug, Error)]
pub enum FitsError {
    /// The system could not read it.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// The first card is not `SIMPLE = T`.
    #[error("is no FITS file: its first card is not SIMPLE = T{}", .0.hint())]
    NotFits(Beginning),
    /// The file ends within a header or its data.
    #[error("is cut short: it ends within {0}")]
    Truncated(&'static str),
    /// A header without an end.
    #[error("has a header of more than {0} cards; its END card is missing")]
    Endless(usize),
    /// Sizes that cannot be.
    #[error("has a header that says {keyword} = {value}; {legal}")]
    Header {
        /// Keyword.
        keyword: String,
        /// What it says.
        value: String,
        /// What it may say.
        legal: &'static str,
    },
    /// No table holds a map.
    #[error("holds no map: a binary table with PIXTYPE = 'HEALPIX' is needed")]
    NoMap,
    /// Pixels are listed by number, but one of the numbers is none.
    #[error(
        "lists pixel {found} in column {column} (INDXSCHM = 'EXPLICIT'); each of {first} to {last} at most once is needed"
    )]
    Pixel {
        /// Column of the numbers.
        column: String,
        /// The number.
        found: f64,
        /// Number of the sky's first pixel.
        first: u32,
        /// Number of its last.
        last: u32,
    },
    /// Pixels are listed by number in a column that has another length than the values'.
    #[error("has {found} values in column {column}, but lists {needed} pixels")]
    Listed {
        /// Column.
        column: String,
        /// Values found.
        found: usize,
        /// Pixels listed.
        needed: usize,
    },
    /// Part of the sky.
    #[error("holds pixels {first} to {last}; a whole sky, 0 to {whole}, is needed")]
    Part {
        /// `FIRSTPIX`.
        first: i64,
        /// `LASTPIX`.
        last: i64,
        /// Number of the sky's last pixel.
        whole: u32,
    },
    /// No ordering of pixels.
    #[error("says ORDERING = {0}; 'RING' or 'NESTED' is needed")]
    Ordering(String),
    /// No resolution.
    #[error("says NSIDE = {0}; a power of two from 1 to {MAX_NSIDE} is needed")]
    Nside(String),
    /// Another number of values than pixels.
    #[error("has {found} values in column {column}; NSIDE = {nside} needs {pixels}")]
    Count {
        /// Column.
        column: String,
        /// Values found.
        found: u64,
        /// Resolution.
        nside: u32,
        /// Values needed.
        pixels: u32,
    },
    /// No such column.
    #[error("has no column {wanted}; its columns are {present}")]
    NoColumn {
        /// Name or number asked for.
        wanted: String,
        /// Names that there are.
        present: String,
    },
    /// A column that holds no numbers.
    #[error(
        "has TFORM = '{form}' in column {column}; B, I, J, K, E or D, with a count before it, is needed"
    )]
    Form {
        /// Column.
        column: String,
        /// Its form.
        form: String,
    },
    /// Not I, Q and U.
    #[error(
        "has {found} column(s) ({present}); I, Q and U are needed: columns of these names, or three columns"
    )]
    Stokes {
        /// Number of columns.
        found: usize,
        /// Their names.
        present: String,
    },
    /// Another sense of polarisation angles.
    #[error("says POLCCONV = {0}; 'COSMO' or 'IAU' is needed")]
    Polcconv(String),
    /// Another frame.
    #[error("says COORDSYS = {found}; {} is needed", letters(.legal))]
    Frame {
        /// What it says.
        found: String,
        /// What is accepted.
        legal: Vec<MapFrame>,
    },
}

/// How a file that is no FITS file begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beginning {
    /// As a gzip file does.
    Gzip,
    /// As an HDF5 file does.
    Hdf5,
    /// Not at all.
    Empty,
    /// Otherwise.
    Other,
}

impl Beginning {
    pub(super) fn of(bytes: &[u8]) -> Self {
        match bytes {
            [] => Self::Empty,
            [0x1f, 0x8b, ..] => Self::Gzip,
            [0x89, b'H', b'D', b'F', ..] => Self::Hdf5,
            _ => Self::Other,
        }
    }

    fn hint(self) -> &'static str {
        match self {
            Self::Gzip => " (it is compressed with gzip: unpack it first)",
            Self::Hdf5 => " (it is an HDF5 file)",
            Self::Empty => " (it is empty)",
            Self::Other => "",
        }
    }
}

fn letters(frames: &[MapFrame]) -> String {
    let names: Vec<_> =
        frames.iter().map(|frame| format!("'{}' ({})", frame.letter(), frame.name())).collect();
    names.join(" or ")
}
