//! Where a detector sits in the focal plane.
//!
//! A detector is a `Rotation<Detector, Boresight>`. Given by a radial offset r from the line of
//! sight, its position angle a from the boresight's x axis and the polarisation angle g, it is
//! `R_z(a) R_y(r) R_z(g - a)`.

use crate::frame::{Boresight, Detector};
use crate::rotation::Rotation;

/// The detector at radial offset `r`, position angle `a`, polarisation angle `g`, all in radians.
#[must_use]
pub fn detector_at(r_rad: f64, a_rad: f64, g_rad: f64) -> Rotation<Detector, Boresight> {
    Rotation::<Detector, Detector>::about_z(g_rad - a_rad)
        .then(Rotation::<Detector, Detector>::about_y(r_rad))
        .then(Rotation::about_z(a_rad))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::Direction;

    #[test]
    fn position_angle_counts_from_x_to_y() {
        let [x, y, z] = detector_at(0.1, 0.5, 0.2).apply(Direction::Z).xyz();
        assert!((libm::atan2(y, x) - 0.5).abs() < 1e-14);
        assert!((z - libm::cos(0.1)).abs() < 1e-15);
    }

    #[test]
    fn on_axis_only_the_polarisation_angle_is_left() {
        let [x, y, _] =
            detector_at(0.0, 0.7, 0.2).apply(Direction::new(1.0, 0.0, 0.0).unwrap()).xyz();
        assert!((libm::atan2(y, x) - 0.2).abs() < 1e-15);
    }
}
