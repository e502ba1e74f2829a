//! A short piece of the line of sight's path as a cubic, and how far it may be off.
//!
//! Frame: `Ecliptic`; times in ns from the piece's start.
//!
//! Method: Hermite's cubic through directions and velocities at both ends. With m the path in the
//! anti-Sun frame, `w_a`, `w_b` and `w_f` the rates of precession, spin and frame, `beta_d` the detector's angle
//! from the spin axis and h the piece's length, a frame that turns evenly leaves at most
//! `M h^4/384`, `M = sin beta_d (w_a + w_b + w_f)^4 + (w_a + w_f)^4`, for each derivative brings one
//! factor of a rate. What an uneven frame adds starts with value and rate zero, and its second
//! derivative is at most A times `1 + 2 w h + w^2 h^2/2`; its cubic has at most half of `A h^2` from the
//! value at the end and 4/27 from the rate there, so it adds less than `1.3 A h^2`.
//!
//! Limits: pieces so long that the error stays below [`ERROR_RAD`]; a test compares.

use super::line_of_sight::Sight;
use onboard_core::attitude::sweep;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::frame::Ecliptic;
use onboard_core::time::{Duration, Instant};

/// No point of a piece is off by more, half from each kind of error.
pub(super) const ERROR_RAD: f64 = 2e-10;

/// Where the line of sight is and how it moves, at one instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) at: Instant,
    pub(super) direction: Direction<Ecliptic>,
    velocity_per_s: [f64; 3],
}

/// A piece of the path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    start: Instant,
    length_ns: f64,
    /// Coefficients of the powers of the share of the piece, x, y, z each.
    powers: [[f64; 3]; 4],
}

impl Motion {
    /// At `at`.
    pub(super) fn of(line: &Sight<'_>, at: Instant) -> Result<Self, EphemerisError> {
        let seen = sweep(line.scan, &line.sun, line.detector, at)?;
        let (along_x, along_y) = seen.scan_beam_angle_rad.sin_cos();
        let ahead = Direction::new(along_x, along_y, 0.0).unwrap_or(Direction::Z);
        let velocity_per_s = seen.attitude.apply(ahead).xyz().map(|it| it * seen.speed_rad_s);
        Ok(Self { at, direction: seen.direction, velocity_per_s })
    }
}

impl Arc {
    /// The piece between two instants.
    pub(super) fn between(from: &Motion, to: &Motion) -> Self {
        let length = to.at.since(from.at);
        let (p, q) = (from.direction.xyz(), to.direction.xyz());
        let scaled = |motion: &Motion| motion.velocity_per_s.map(|it| it * length.seconds());
        let (u, v) = (scaled(from), scaled(to));
        let mut powers = [p, u, [0.0; 3], [0.0; 3]];
        for axis in 0..3 {
            let chord = q[axis] - p[axis];
            powers[2][axis] = 3.0 * chord - 2.0 * u[axis] - v[axis];
            powers[3][axis] = u[axis] + v[axis] - 2.0 * chord;
        }
        Self { start: from.at, length_ns: real(length), powers }
    }

    /// Where the cubic is, within [`ERROR_RAD`] of the line of sight.
    pub(super) fn direction(&self, at: Instant) -> Direction<Ecliptic> {
        let share = real(at.since(self.start)) / self.length_ns;
        let [one, two, three, four] = &self.powers;
        let along = |axis: usize| {
            one[axis] + share * (two[axis] + share * (three[axis] + share * four[axis]))
        };
        Direction::new(along(0), along(1), along(2)).unwrap_or(Direction::Z)
    }
}

/// The longest piece whose error is certain to stay below [`ERROR_RAD`].
pub(super) fn longest(line: &Sight<'_>) -> Duration {
    let parameters = line.scan.parameters();
    let bounds = line.sun.bounds();
    let cos_latitude = (1.0 - bounds.max_abs_z * bounds.max_abs_z).max(1e-12).sqrt();
    let turn = bounds.rate_rad_s / cos_latitude;
    let slow = parameters.precession.rate.radians_per_second().abs() + turn;
    let fast = slow + parameters.spin.rate.radians_per_second().abs();
    let fourth = line.sine_from_spin_axis() * fast.powi(4) + slow.powi(4);
    let even = (384.0 * 0.5 * ERROR_RAD / fourth).sqrt().sqrt();
    let turn_change =
        2.0 * (bounds.acceleration_per_s2 + 2.0 * bounds.rate_rad_s * turn) / cos_latitude;
    let uneven = (0.5 * ERROR_RAD / (1.3 * (turn_change + 2.0 * turn * turn))).sqrt();
    // w h is below 0.06, for which 1 + 2 w h + w^2 h^2/2 is below 1.13: 0.5 + 0.65 of it are 1.3.
    let seconds = even.min(uneven).min(0.06 / fast);
    Duration::from_ns(Duration::from_seconds_floor(seconds).ns().max(1))
}

#[expect(clippy::cast_precision_loss, reason = "spans of at most days")]
fn real(span: Duration) -> f64 {
    span.ns() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::frame::{Boresight, Detector};
    use onboard_core::phase::{Phase, Rotor, TurnRate};
    use onboard_core::rotation::Rotation;
    use onboard_core::scan::{ScanParameters, ScanStrategy};
    use onboard_core::sun::SunModel;
    use std::f64::consts::TAU;

    #[test]
    fn a_piece_is_where_the_line_of_sight_is() {
        let rotor = |period_s: f64, start: f64| Rotor {
            rate: TurnRate::from_radians_per_second(TAU / period_s),
            start: Phase::from_radians(start),
        };
        let ends = (Instant::from_tai_ns(0), Instant::from_tai_ns(i64::MAX / 4));
        let mut worst = 0.0_f64;
        for (alpha, beta, precession_s, spin_s) in [
            (45.0_f64, 50.0_f64, 11_540.88, 1_200.0),
            (26.0, 69.0, 36_000.0, 60.0),
            (7.5, 85.0, 1.6e7, 60.0),
            (80.0, 2.0, 900.0, 700.0),
        ] {
            let scan = ScanStrategy::new(ScanParameters {
                start: ends.0,
                alpha_rad: alpha.to_radians(),
                beta_rad: beta.to_radians(),
                precession: rotor(precession_s, 0.3),
                spin: rotor(spin_s, 1.1),
            })
            .unwrap();
            for detector in [Rotation::IDENTITY, Rotation::<Detector, Boresight>::about_x(0.2)] {
                let sun = SunModel::Circular(rotor(365.25 * 86_400.0, 0.2));
                let line = Sight { scan: &scan, sun, detector, ends };
                let length = longest(&line);
                for piece in 0..50 {
                    let start = Instant::from_tai_ns(piece * 97_531_234_567);
                    let [from, to] =
                        [start, start.plus(length)].map(|at| Motion::of(&line, at).unwrap());
                    let arc = Arc::between(&from, &to);
                    for share in 0..=20 {
                        let at = start.plus(Duration::from_ns(length.ns() / 20 * share));
                        let there = line.direction(at).unwrap();
                        worst = worst.max(arc.direction(at).separation_rad(there));
                    }
                }
            }
        }
        // The bound is met, and not by far too much.
        assert!(worst < ERROR_RAD && worst > 0.1 * ERROR_RAD, "{worst:e}");
    }
}
