//! From ICRF axes to the ecliptic of J2000 and back.
//!
//! A rotation about x by 84381.448 arcsec, as SPICE's ECLIPJ2000:
//! `y_ecl = cos(e) y + sin(e) z`, `z_ecl = cos(e) z - sin(e) y`.

use nalgebra::Vector3;
use onboard_core::direction::Direction;
use onboard_core::frame::{Ecliptic, OBLIQUITY_ARCSEC};

/// An ICRF vector's direction in the ecliptic of J2000; `None` for a vector without length.
pub(crate) fn direction_from_icrf(icrf: Vector3<f64>) -> Option<Direction<Ecliptic>> {
    let (sin, cos) = obliquity();
    Direction::new(icrf.x, cos * icrf.y + sin * icrf.z, cos * icrf.z - sin * icrf.y)
}

/// The ICRF unit vector of a direction in the ecliptic of J2000.
pub(crate) fn icrf_from_direction(direction: Direction<Ecliptic>) -> Vector3<f64> {
    icrf_from_ecliptic(direction.xyz().into())
}

/// The ICRF components of a vector given in the ecliptic of J2000.
pub(crate) fn icrf_from_ecliptic(ecliptic: Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = obliquity();
    let (y, z) = (ecliptic.y, ecliptic.z);
    Vector3::new(ecliptic.x, cos * y - sin * z, cos * z + sin * y)
}

fn obliquity() -> (f64, f64) {
    libm::sincos((OBLIQUITY_ARCSEC / 3600.0).to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ecliptic_pole_is_where_it_should_be() {
        let pole = icrf_from_direction(Direction::Z);
        let obliquity = (OBLIQUITY_ARCSEC / 3600.0).to_radians();
        assert!((pole - Vector3::new(0.0, -obliquity.sin(), obliquity.cos())).norm() < 1e-15);
        let back = direction_from_icrf(pole).unwrap();
        assert!(back.separation_rad(Direction::Z) < 1e-15);
    }
}
