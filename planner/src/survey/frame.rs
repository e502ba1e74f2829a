//! The frame of a map: ecliptic, galactic or equatorial.
//!
//! Galactic axes: x towards the galactic centre, z towards the galactic north pole, from ICRS by the
//! Hipparcos catalogue's definition [ESA1997, vol. 1, 1.5.3]: pole at right ascension 192.85948 deg,
//! declination 27.12825 deg, galactic longitude of the celestial pole 122.93192 deg (1.5.11).

use onboard_core::direction::Direction;
use onboard_core::frame::{Ecliptic, Icrf};
use onboard_core::rotation::Rotation;

/// Galactic axes.
#[derive(Debug, Clone, Copy)]
pub struct Galactic;

/// In which frame pixels lie and crossing angles are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MapFrame {
    /// Ecliptic longitude and latitude.
    Ecliptic,
    /// Galactic longitude and latitude.
    Galactic,
    /// Right ascension and declination, ICRF.
    Equatorial,
}

const POLE_RIGHT_ASCENSION_DEG: f64 = 192.859_48;
const POLE_DECLINATION_DEG: f64 = 27.128_25;
const CELESTIAL_POLE_LONGITUDE_DEG: f64 = 122.931_92;

impl MapFrame {
    /// From the ecliptic to this frame.
    #[must_use]
    pub fn from_ecliptic(self) -> Rotation<Ecliptic, Galactic> {
        match self {
            Self::Ecliptic => Rotation::about_z(0.0),
            Self::Equatorial => {
                let to_icrf = Rotation::<Icrf, Ecliptic>::by_obliquity().inverse();
                to_icrf.then(Rotation::about_z(0.0))
            }
            Self::Galactic => {
                let to_icrf = Rotation::<Icrf, Ecliptic>::by_obliquity().inverse();
                // R_z(180 deg - longitude) R_y(90 deg - declination) R_z(right ascension), inverted.
                let to_galactic: Rotation<Icrf, Galactic> =
                    Rotation::<Icrf, Icrf>::about_z(-POLE_RIGHT_ASCENSION_DEG.to_radians())
                        .then(Rotation::<Icrf, Icrf>::about_y(
                            -(90.0 - POLE_DECLINATION_DEG).to_radians(),
                        ))
                        .then(Rotation::about_z(
                            -(180.0 - CELESTIAL_POLE_LONGITUDE_DEG).to_radians(),
                        ));
                to_icrf.then(to_galactic)
            }
        }
    }

    /// The frame's axes x, y, z in the ecliptic; none where they are the ecliptic's.
    pub(super) fn map_axes(self) -> Option<[[f64; 3]; 3]> {
        (self != Self::Ecliptic).then(|| self.axes_in_ecliptic())
    }

    fn axes_in_ecliptic(self) -> [[f64; 3]; 3] {
        let back = self.from_ecliptic().inverse();
        [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)].map(|(x, y, z)| {
            Direction::new(x, y, z).map_or([x, y, z], |axis| back.apply(axis).xyz())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_celestial_pole_is_the_equatorial_z_axis() {
        let pole = Direction::<Icrf>::new(0.0, 0.0, 1.0).unwrap();
        let pole = Rotation::<Icrf, Ecliptic>::by_obliquity().apply(pole).xyz();
        let axes = MapFrame::Equatorial.axes_in_ecliptic();
        for (a, b) in axes[2].iter().zip(pole).chain(axes[0].iter().zip([1.0, 0.0, 0.0])) {
            assert!((a - b).abs() < 1e-15, "{axes:?}");
        }
    }

    #[test]
    fn galactic_axes_are_those_of_astropy() {
        // astropy 8.0: SkyCoord(l, b, frame="galactic").icrs, then R_x(-84381.448 arcsec); its
        // galactic frame is tied to FK5 J2000, which differs from ICRS by 0.02 arcsec.
        let axes = MapFrame::Galactic.axes_in_ecliptic();
        let centre = axes[0];
        let pole = axes[2];
        let expected_centre =
            [-0.054_875_657_712_592, -0.993_821_367_039_231, -0.096_476_694_630_799];
        let expected_pole = [-0.867_666_137_559_658, -0.000_351_541_808_821, 0.497_147_211_749_860];
        for (a, b) in centre.iter().zip(expected_centre).chain(pole.iter().zip(expected_pole)) {
            assert!((a - b).abs() < 2e-7, "{centre:?} {pole:?}");
        }
    }
}
