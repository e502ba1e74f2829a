//! Maps of the sky in files: HEALPix columns of a FITS binary table.
//!
//! [`write_maps`] streams columns pixel by pixel, so nothing but the caller's own map is held;
//! [`read_map`] and [`read_stokes`] take maps that others wrote and say in a sentence why they cannot.
//! The file's frame is `COORDSYS`: E, G or C. U has the sign of `POLCCONV` = COSMO in memory; an IAU
//! file's is turned round on reading.
//!
//! Method: [FITS4, section 7.3] for the bytes, the HEALPix keywords (`PIXTYPE`, `ORDERING`, `NSIDE`, ..)
//! for their meaning. Unobserved pixels are NaN in memory and [`UNSEEN`] in a file; a file may name
//! another value by `BAD_DATA`. Files may be compressed by gzip, list their pixels
//! (`INDXSCHM = 'EXPLICIT'`), count from 1, or leave `NSIDE` to the number of values.
//!
//! Limits: numeric columns, `nside` up to [`MAX_NSIDE`](planner::healpix::MAX_NSIDE).
//!
//! # Example
//! A map as bytes, and back:
//! ```
//! use formats::fits::*;
//! use planner::healpix::{Nside, Ordering};
//!
//! let (nside, ordering, frame) = (Nside::new(4)?, Ordering::Nested, MapFrame::Galactic);
//! let name = "SURVEY".to_owned();
//! let header = MapHeader { nside, ordering, frame, name, polcconv: None, cards: Vec::new() };
//! let hits = |pixel: u32| i64::from(pixel % 7);
//! let column = Column { name: "HITS", unit: "", values: Values::Integer(&hits) };
//! let mut bytes = Vec::new();
//! write_maps(&mut bytes, &header, &[column])?;
//! assert!(bytes.starts_with(b"SIMPLE  =                    T") && bytes.len() % 2880 == 0);
//!
//! let frames = Frames { accepted: &[MapFrame::Galactic], unsaid: None };
//! let map = read_map_from(&mut bytes.as_slice(), ColumnChoice::Name("hits"), frames)?;
//! assert_eq!((map.nside, map.ordering, map.values[6]), (nside, ordering, 6.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod card;
mod error;
mod read;
mod stokes;
mod table;
mod write;
mod image;

pub use card::{Card, CardValue};
pub use error::{FitsError, FitsFileError};
pub use image::{Image, Plane, write_images};
pub use read::{ColumnChoice, Columns, Frames, Map, read_columns, read_map, read_map_from};
pub use stokes::{StokesMap, read_stokes, read_stokes_from};
pub use write::{
    Column, MapHeader, Values, provenance_cards, write_maps, write_primary, write_table,
};

/// Bytes of a block: headers and data fill whole ones.
const BLOCK: usize = 2880;

/// What stands for an unobserved pixel in a column of floats.
pub const UNSEEN: f64 = -1.6375e30;

/// The frame of a map's longitudes and latitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapFrame {
    /// Ecliptic of J2000.
    Ecliptic,
    /// Galactic.
    Galactic,
    /// Equatorial: right ascension and declination, ICRF.
    Equatorial,
}

impl MapFrame {
    /// `COORDSYS`.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::Ecliptic => 'E',
            Self::Galactic => 'G',
            Self::Equatorial => 'C',
        }
    }

    /// The frame's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ecliptic => "ecliptic",
            Self::Galactic => "galactic",
            Self::Equatorial => "equatorial",
        }
    }

    /// Of a `COORDSYS`: a letter, or a word that begins with it.
    fn of(text: &str) -> Option<Self> {
        match text.trim().to_ascii_uppercase().as_str() {
            "E" | "ECLIPTIC" => Some(Self::Ecliptic),
            "G" | "GALACTIC" => Some(Self::Galactic),
            "C" | "Q" | "CELESTIAL" | "EQUATORIAL" | "ICRS" => Some(Self::Equatorial),
            _ => None,
        }
    }
}

/// In which sense a polarisation angle grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Polcconv {
    /// From south through east, looking at the sky.
    Cosmo,
    /// From north through east: U has the other sign.
    Iau,
}

impl Polcconv {
    /// `POLCCONV`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cosmo => "COSMO",
            Self::Iau => "IAU",
        }
    }
}

impl From<MapFrame> for planner::survey::MapFrame {
    fn from(frame: MapFrame) -> Self {
        match frame {
            MapFrame::Ecliptic => Self::Ecliptic,
            MapFrame::Galactic => Self::Galactic,
            MapFrame::Equatorial => Self::Equatorial,
        }
    }
}

impl From<planner::survey::MapFrame> for MapFrame {
    fn from(frame: planner::survey::MapFrame) -> Self {
        match frame {
            planner::survey::MapFrame::Ecliptic => Self::Ecliptic,
            planner::survey::MapFrame::Galactic => Self::Galactic,
            planner::survey::MapFrame::Equatorial => Self::Equatorial,
        }
    }
}
