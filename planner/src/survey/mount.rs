//! A line of sight about the spin axis: where a detector points, how its axis is turned.
//!
//! Any `Rotation<Detector, Boresight>` after `R_y(beta)` is `R_z(azimuth) R_y(polar) R_z(turn)`: a
//! boresight of its own at another angle from the spin axis, with another spin phase and another
//! zero of the crossing angle. So every detector costs as much as the boresight.
//!
//! Limits: within 1e-12 rad of the spin axis the azimuth is taken as 0.

use onboard_core::direction::Direction;
use onboard_core::frame::{Boresight, Detector, Spin};
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;

/// A detector's line of sight about the spin axis. Pairs are (cosine, sine).
#[derive(Debug, Clone, Copy)]
pub(super) struct Mount {
    /// Angle from the spin axis.
    pub(super) polar: (f64, f64),
    /// Azimuth from the boresight's spin phase.
    pub(super) azimuth: (f64, f64),
    /// Turn of the detector's x axis from the direction away from the spin axis.
    pub(super) turn: (f64, f64),
    /// Which of the survey's plates.
    pub(super) plate: usize,
}

/// A plate that stands for none.
const NO_PLATE: Rotor = Rotor { rate: TurnRate::from_bits(0), start: Phase::ZERO };

impl Mount {
    /// The mounts of detectors with their plates, and the different plates among these.
    pub(super) fn all(
        beta_rad: f64,
        detectors: impl Iterator<Item = (Rotation<Detector, Boresight>, Option<Rotor>)>,
    ) -> (Vec<Self>, Vec<Rotor>) {
        let mut plates: Vec<Rotor> = Vec::new();
        let mounts = detectors
            .map(|(rotation, plate)| {
                let plate = plate.unwrap_or(NO_PLATE);
                let index = plates.iter().position(|it| *it == plate).unwrap_or(plates.len());
                if index == plates.len() {
                    plates.push(plate);
                }
                Self::new(beta_rad, rotation, index)
            })
            .collect();
        (mounts, plates)
    }

    /// The mount of a detector with plate number `plate`, beta from the spin axis to the boresight.
    pub(super) fn new(
        beta_rad: f64,
        rotation: Rotation<Detector, Boresight>,
        plate: usize,
    ) -> Self {
        let in_spin: Rotation<Detector, Spin> =
            rotation.then(Rotation::<Boresight, Spin>::about_y(beta_rad));
        let [x, y, cos_polar] = in_spin.apply(Direction::Z).xyz();
        let sin_polar = x.hypot(y);
        if sin_polar > 1e-12 {
            // The spin axis in the detector's frame is (-sin polar cos turn, sin polar sin turn, _).
            let [a, b, _] = in_spin.inverse().apply(Direction::Z).xyz();
            let r = a.hypot(b);
            Self {
                polar: (cos_polar, sin_polar),
                azimuth: (x / sin_polar, y / sin_polar),
                turn: (-a / r, b / r),
                plate,
            }
        } else {
            let sign = cos_polar.signum();
            let [a, b, _] = Direction::new(1.0, 0.0, 0.0)
                .map_or([1.0, 0.0, 0.0], |axis| in_spin.apply(axis).xyz());
            Self { polar: (cos_polar, 0.0), azimuth: (1.0, 0.0), turn: (sign * a, b), plate }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn three_angles_make_the_rotation_again(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64, w in 0.1..1.0_f64,
            beta in 0.0..3.0_f64,
        ) {
            let norm = (x * x + y * y + z * z + w * w).sqrt();
            let rotation = Rotation::from_xyzw([x / norm, y / norm, z / norm, w / norm]).unwrap();
            let mount = Mount::new(beta, rotation, 0);
            let angle = |pair: (f64, f64)| pair.1.atan2(pair.0);
            let again = Rotation::<Detector, Detector>::about_z(angle(mount.turn))
                .then(Rotation::<Detector, Detector>::about_y(angle(mount.polar)))
                .then(Rotation::<Detector, Spin>::about_z(angle(mount.azimuth)));
            let direct = rotation.then(Rotation::<Boresight, Spin>::about_y(beta));
            let [x, y, z, w] = again.then(direct.inverse()).to_xyzw();
            prop_assert!(x.hypot(y).hypot(z) < 1e-14, "{x} {y} {z} {w}");
        }
    }

    #[test]
    fn on_the_spin_axis_the_turn_is_all() {
        let mount = Mount::new(0.0, Rotation::about_z(0.3), 0);
        assert!((mount.turn.1.atan2(mount.turn.0) - 0.3).abs() < 1e-15);
        assert!(mount.polar.1.abs() < 1e-15);
    }
}
