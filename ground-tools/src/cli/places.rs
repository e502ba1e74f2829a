//! Which places on the sky did the user ask for: pixels and directions of the command line.
//!
//! Frame: ecliptic or galactic, geometric. Angles carry their unit (`45deg`, `30arcmin`, `0.3rad`).
//!
//! Limits: a direction on an edge of pixels belongs to the one that \[Gorski2005\]'s integer parts name.

use super::quantities::angles_deg;
use crate::failure::Failure;
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
use planner::healpix::{Nside, Ordering};
use planner::survey::MapFrame;
use planner::visits::{Boundary, pixel_at};

/// Resolution of the pixels of [Takase2024, section 6.2].
pub const DEFAULT_NSIDE: u32 = 64;

/// Its three places: colatitude and longitude in degrees.
const PAPER: [(f64, f64); 3] = [(0.0, 0.0), (45.0, 180.0), (90.0, 180.0)];

/// A place that does not move.
#[derive(Debug, Clone)]
pub struct FixedPlace {
    /// What it is called in outputs.
    pub name: String,
    /// Its shape.
    pub shape: PlaceShape,
}

/// What counts as inside.
#[derive(Debug, Clone, Copy)]
pub enum PlaceShape {
    /// A pixel's true boundary.
    Pixel(Boundary),
    /// The line of sight's field of view about this direction.
    Direction(Direction<Ecliptic>),
}

/// How pixels are numbered.
#[derive(Debug, Clone, Copy)]
pub struct Numbering {
    nside: Nside,
    ordering: Ordering,
    frame: MapFrame,
}

impl Numbering {
    /// Pixels of `nside` in a frame, in RING order unless `nested`.
    ///
    /// # Errors
    /// [`Failure::Input`] where nside is no power of two, or too large.
    pub fn new(nside: u32, nested: bool, frame: MapFrame) -> Result<Self, Failure> {
        let nside =
            Nside::new(nside).map_err(|error| Failure::Input(format!("--nside: {error}")))?;
        let ordering = if nested { Ordering::Nested } else { Ordering::Ring };
        Ok(Self { nside, ordering, frame })
    }

    /// The pixel of this number.
    ///
    /// # Errors
    /// [`Failure::Input`] where there is none.
    pub fn pixel(self, number: u32) -> Result<FixedPlace, Failure> {
        let pixels = self.nside.pixels();
        if number >= pixels {
            return Err(Failure::Input(format!(
                "--pixel {number} is beyond the sky: nside {} has pixels 0 to {}",
                self.nside.get(),
                pixels - 1
            )));
        }
        Ok(self.named(self.nside.nested(self.ordering, number)))
    }

    /// The pixel that holds `THETA,PHI`, colatitude and longitude.
    ///
    /// # Errors
    /// [`Failure::Input`] names what is wrong with the text.
    pub fn holding(self, text: &str) -> Result<FixedPlace, Failure> {
        let [theta, phi] = angles_deg("--theta-phi", text, ["colatitude", "longitude"])?;
        if !(0.0..=180.0).contains(&theta) {
            return Err(Failure::Input(format!(
                "--theta-phi {text}: a colatitude from 0 to 180 deg is needed"
            )));
        }
        Ok(self.at_degrees(theta, phi))
    }

    /// The three pixels of [Takase2024, section 6.2].
    #[must_use]
    pub fn of_the_paper(self) -> Vec<FixedPlace> {
        PAPER.iter().map(|(theta, phi)| self.at_degrees(*theta, *phi)).collect()
    }

    fn at_degrees(self, theta: f64, phi: f64) -> FixedPlace {
        self.named(pixel_at(self.nside, theta.to_radians(), phi.to_radians()))
    }

    fn named(self, nested: u32) -> FixedPlace {
        let number = self.nside.numbered(self.ordering, nested);
        let ordering = self.ordering.name().to_lowercase();
        FixedPlace {
            name: format!(
                "pixel:{}:{ordering}:{number}{}",
                self.nside.get(),
                frame_suffix(self.frame)
            ),
            shape: PlaceShape::Pixel(Boundary::new(self.nside, nested).in_frame(self.frame)),
        }
    }
}

/// What names of places end with.
const fn frame_suffix(frame: MapFrame) -> &'static str {
    match frame {
        MapFrame::Ecliptic => "",
        MapFrame::Galactic => ":galactic",
        MapFrame::Equatorial => ":equatorial",
    }
}

/// The direction `LONGITUDE,LATITUDE` in a frame.
///
/// # Errors
/// [`Failure::Input`] names what is wrong with the text.
pub fn direction(text: &str, frame: MapFrame) -> Result<FixedPlace, Failure> {
    let [longitude, latitude] = angles_deg("--direction", text, ["longitude", "latitude"])?;
    if latitude.abs() > 90.0 {
        return Err(Failure::Input(format!(
            "--direction {text}: a latitude from -90 to 90 deg is needed"
        )));
    }
    let (longitude, latitude) = (longitude.to_radians(), latitude.to_radians());
    let there = match frame {
        MapFrame::Ecliptic => Direction::from_longitude_latitude(longitude, latitude),
        MapFrame::Galactic | MapFrame::Equatorial => {
            let there = Direction::from_longitude_latitude(longitude, latitude);
            frame.from_ecliptic().inverse().apply(there)
        }
    };
    let text = text.replace(' ', "").replace(',', ":");
    Ok(FixedPlace {
        name: format!("direction:{text}{}", frame_suffix(frame)),
        shape: PlaceShape::Direction(there),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_pixels_have_healpys_numbers() {
        let numbering = Numbering::new(DEFAULT_NSIDE, false, MapFrame::Ecliptic).unwrap();
        let names: Vec<String> =
            numbering.of_the_paper().into_iter().map(|place| place.name).collect();
        assert_eq!(names, ["pixel:64:ring:0", "pixel:64:ring:7200", "pixel:64:ring:24576"]);
        for (text, name) in ["0deg,0deg", "45deg,180deg", "90deg,180 deg"].iter().zip(&names) {
            assert_eq!(&numbering.holding(text).unwrap().name, name);
        }
    }

    #[test]
    fn bad_places_are_refused_with_what_is_legal() {
        let numbering = Numbering::new(64, true, MapFrame::Ecliptic).unwrap();
        let sentence = |result: Result<FixedPlace, Failure>| result.unwrap_err().to_string();
        assert!(
            Numbering::new(100, false, MapFrame::Ecliptic)
                .unwrap_err()
                .to_string()
                .contains("power of two")
        );
        assert!(sentence(numbering.pixel(49_152)).contains("0 to 49151"));
        assert!(sentence(numbering.holding("45,180")).contains("no unit"));
        assert!(sentence(numbering.holding("45deg")).contains("comma"));
        assert!(sentence(numbering.holding("190deg,0deg")).contains("0 to 180"));
        assert!(sentence(direction("0deg,91deg", MapFrame::Ecliptic)).contains("-90 to 90"));
        assert!(direction("-10deg,-90deg", MapFrame::Galactic).is_ok());
    }
}
