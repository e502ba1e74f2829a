//! Which way does the spacecraft point, and how does a detector sweep the sky.
//!
//! [`attitude`] is the rotation from the mission boresight frame to [`Ecliptic`]; [`sweep`] is what
//! one detector does at that instant: direction, crossing angle, speed, scan-beam angle.
//!
//! Crossing angle psi = atan2(north, east) of the detector's x axis on the sky, COSMO sense, zero
//! at east. Scan-beam angle zeta = atan2(v.x, v.y), v the velocity of the line of sight on the sky
//! in the detector's frame, orbital motion included.
//!
//! Method: [Takase2024, A.1] with exact phases; v = omega x n with omega the sum of the anti-Sun
//! frame's, the precession's and the spin's angular velocity.
//!
//! Limits: 1e-12 rad anywhere in ten years (`tests/tests/attitude.rs`). At an ecliptic pole east is
//! taken along longitude +90 deg.

use crate::direction::{Direction, DirectionState};
use crate::ephemeris::EphemerisError;
use crate::frame::{AntiSun, Boresight, Detector, Ecliptic, Spin};
use crate::rotation::Rotation;
use crate::scan::ScanStrategy;
use crate::sun::{SunModel, frame_angular_velocity};
use crate::time::Instant;
use crate::vector::{cross, dot, plus, times};
use nalgebra::Vector3;

/// What a detector does on the sky at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Sweep {
    /// Detector frame to ecliptic.
    pub attitude: Rotation<Detector, Ecliptic>,
    /// Line of sight.
    pub direction: Direction<Ecliptic>,
    /// Crossing angle psi in radians, in (-pi, pi].
    pub crossing_angle_rad: f64,
    /// Speed of the line of sight on the sky in rad/s.
    pub speed_rad_s: f64,
    /// Scan-beam angle zeta in radians, in (-pi, pi]; zero is a sweep along the detector's y.
    pub scan_beam_angle_rad: f64,
}

/// The rotation from the mission boresight frame to the ecliptic at `at`.
///
/// # Errors
/// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
#[inline(never)]
// REQ-ATT-1.
pub fn attitude(
    scan: &ScanStrategy,
    sun: &SunModel<'_>,
    at: Instant,
) -> Result<Rotation<Boresight, Ecliptic>, EphemerisError> {
    let anti_sun = sun.direction(scan.parameters().start, at)?;
    Ok(spin_in_ecliptic(scan, anti_sun, at).after_about_y(scan.half_beta()))
}

fn spin_in_ecliptic(
    scan: &ScanStrategy,
    anti_sun: Direction<Ecliptic>,
    at: Instant,
) -> Rotation<Spin, Ecliptic> {
    scan.spin_in_anti_sun(at)
        .then(Rotation::<AntiSun, Ecliptic>::to_direction_with_x_north(anti_sun))
}

/// What the detector does on the sky at `at`.
///
/// # Errors
/// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
#[inline(never)]
// REQ-ATT-1.
pub fn sweep(
    scan: &ScanStrategy,
    sun: &SunModel<'_>,
    detector: Rotation<Detector, Boresight>,
    at: Instant,
) -> Result<Sweep, EphemerisError> {
    let mut anti_sun = DirectionState::NOWHERE;
    sun.place_state(scan.parameters().start, at, &mut anti_sun)?;
    let spin = spin_in_ecliptic(scan, anti_sun.direction, at);
    let attitude = detector.then(spin.after_about_y::<Boresight>(scan.half_beta()));
    let (x, n) = attitude.x_and_z();
    // omega = omega_frame + w_a n_sun + w_b s, with s the spin axis.
    let (precession_rate, spin_rate) = scan.rates_rad_s();
    let precession = times(anti_sun.direction.vector(), precession_rate);
    let omega =
        plus(plus(frame_angular_velocity(&anti_sun), precession), times(spin.z_axis(), spin_rate));
    // n' = omega x n: its components along x and y = n x x are omega . y and -omega . x.
    let y = cross(n, x);
    let along_x = dot(omega, y);
    let along_y = -dot(omega, x);
    Ok(Sweep {
        attitude,
        direction: Direction::from_unit(n),
        crossing_angle_rad: crossing(x, n),
        speed_rad_s: libm::sqrt(along_x * along_x + along_y * along_y),
        scan_beam_angle_rad: libm::atan2(along_x, along_y),
    })
}

/// Crossing angle of a detector's x axis on the sky in radians, in (-pi, pi].
#[must_use]
pub fn crossing_angle_rad(attitude: Rotation<Detector, Ecliptic>) -> f64 {
    let (x, n) = attitude.x_and_z();
    crossing(x, n)
}

fn crossing(x: Vector3<f64>, n: Vector3<f64>) -> f64 {
    // East and north scaled by the cosine of the latitude rho: (-n_y, n_x, 0) and
    // (-n_z n_x, -n_z n_y, rho^2); at the pole itself the limit at longitude 0.
    let rho2 = n.x * n.x + n.y * n.y;
    if rho2 > 0.0 {
        let east = x.y * n.x - x.x * n.y;
        // x is perpendicular to n, so x . north = x_z (rho^2 + n_z^2) / rho = x_z / rho.
        libm::atan2(x.z, east)
    } else {
        libm::atan2(-n.z * x.x, x.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phase::{Phase, Rotor, TurnRate};
    use crate::scan::ScanParameters;

    #[test]
    fn crossing_angle_is_zero_at_east_and_grows_to_north() {
        // Line of sight at longitude 0 on the ecliptic: east is +y, north is +z.
        let look = Rotation::<Detector, Ecliptic>::to_direction_with_x_north(
            Direction::from_longitude_latitude(0.0, 0.0),
        );
        assert!((crossing_angle_rad(look) - core::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let turned = Rotation::<Detector, Detector>::about_z(0.25).then(look);
        // Seen from inside, R_z(+) about the outward line of sight turns north towards west.
        let expected = core::f64::consts::FRAC_PI_2 + 0.25;
        assert!((crossing_angle_rad(turned) - expected).abs() < 1e-15);
    }

    /// Crossing angle from east and north, worked out as vectors.
    fn crossing_by_vectors(attitude: Rotation<Detector, Ecliptic>) -> f64 {
        let (x, n) = attitude.x_and_z();
        let east = Vector3::new(-n.y, n.x, 0.0).normalize();
        libm::atan2(x.dot(&n.cross(&east)), x.dot(&east))
    }

    #[test]
    fn at_a_pole_east_is_along_longitude_ninety_degrees() {
        let quarter = core::f64::consts::FRAC_PI_2;
        // North pole: north, coming along longitude 0, is -x; x along +x looks south.
        for angle in [0.0, 0.3, 1.0, 2.5, -2.0] {
            let look = Rotation::<Detector, Ecliptic>::about_z(angle);
            let expected = libm::atan2(-libm::cos(angle), libm::sin(angle));
            assert!((crossing_angle_rad(look) - expected).abs() < 1e-15, "{angle}");
            // Near the pole along longitude 0 it is nearly the same.
            let tilt = Rotation::<Ecliptic, Ecliptic>::about_y(1e-9);
            assert!((crossing_angle_rad(look.then(tilt)) - expected).abs() < 1e-8, "{angle}");
        }
        // South pole, x along +x: north, coming along longitude 0, is +x.
        let south = Rotation::<Detector, Ecliptic>::from_xyzw([1.0, 0.0, 0.0, 0.0]).unwrap();
        assert!(south.z_axis().x.abs() + south.z_axis().y.abs() <= 0.0);
        assert!((crossing_angle_rad(south) - quarter).abs() < 1e-15);
        let tilted = south.then(Rotation::<Ecliptic, Ecliptic>::about_y(-1e-9));
        assert!((crossing_angle_rad(tilted) - quarter).abs() < 1e-8);
    }

    #[test]
    // REQ-ATT-1.
    fn a_sweep_is_the_derivative_of_the_direction() {
        let rotor = |rate, start| Rotor {
            rate: TurnRate::from_radians_per_second(rate),
            start: Phase::from_radians(start),
        };
        let scan = ScanStrategy::new(ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad: 0.7,
            beta_rad: 0.6,
            precession: rotor(-0.2, 0.3),
            spin: rotor(0.5, -1.0),
        })
        .unwrap();
        // A year of a minute, so that the orbit counts.
        let sun = SunModel::Circular(rotor(0.1, 2.0));
        let detector = Rotation::<Detector, Boresight>::about_z(0.4)
            .then(Rotation::<Boresight, Boresight>::about_y(0.2));
        let at = |ns: i64| Instant::from_tai_ns(ns);
        for second in 0..40 {
            let (ns, step_ns) = (second * 1_000_000_000, 50_000);
            let look = |ns: i64| sweep(&scan, &sun, detector, at(ns)).unwrap();
            let now = look(ns);
            let own = detector.then(attitude(&scan, &sun, at(ns)).unwrap());
            let off = own.then(now.attitude.inverse()).to_xyzw();
            assert!(off[0].abs() + off[1].abs() + off[2].abs() < 1e-14);
            assert!(now.direction.separation_rad(now.attitude.apply(Direction::Z)) < 1e-15);
            assert!((now.crossing_angle_rad - crossing_by_vectors(now.attitude)).abs() < 1e-12);
            let moved =
                look(ns + step_ns).direction.vector() - look(ns - step_ns).direction.vector();
            let velocity = moved / 1e-4;
            let seen = now.attitude.inverse().rotate(velocity);
            assert!((now.speed_rad_s - velocity.norm()).abs() < 1e-8, "{second}");
            let beam = libm::remainder(
                now.scan_beam_angle_rad - libm::atan2(seen.x, seen.y),
                core::f64::consts::TAU,
            );
            assert!(beam.abs() < 1e-7, "{second}: {beam}");
        }
    }
}
