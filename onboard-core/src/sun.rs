//! Where is the Sun, and how does the anti-Sun frame turn.
//!
//! [`SunModel`] gives the geometric Sun-to-spacecraft direction in [`Ecliptic`]: from the table
//! (default) or as a uniform circular motion in longitude (the paper's and Falcons.jl's model).
//! [`AntiSunAxes`] are the axes of [`AntiSun`] and their angular velocity.
//!
//! Method: z along the direction, x ecliptic north made perpendicular to z, y = z cross x.
//!
//! Limits: undefined with the spacecraft over an ecliptic pole of the Sun; x is then taken along
//! the longitude 0.

use crate::direction::{Direction, DirectionState, MotionBounds, root_near_one};
use crate::ephemeris::{BodyTable, EphemerisError};
use crate::frame::{AntiSun, Ecliptic};
use crate::phase::Rotor;
use crate::rotation::Rotation;
use crate::time::{Duration, Instant};
use crate::vector::{cross, minus, plus, times, vector};
use nalgebra::Vector3;

/// The Sun-to-spacecraft direction over the mission.
#[derive(Debug, Clone, Copy)]
pub enum SunModel<'a> {
    /// The anti-Sun longitude turns uniformly, latitude 0.
    Circular(Rotor),
    /// From an ephemeris table.
    Table(BodyTable<'a>),
}

impl SunModel<'_> {
    /// Sun-to-spacecraft direction and rate at `at`, for a mission that starts at `start`.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the table.
    pub fn state(
        &self,
        start: Instant,
        at: Instant,
    ) -> Result<DirectionState<Ecliptic>, EphemerisError> {
        let mut state = DirectionState::NOWHERE;
        self.place_state(start, at, &mut state)?;
        Ok(state)
    }

    /// As [`Self::state`], written in place, with the instant up to which the bounds hold without a
    /// break.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the table.
    pub(crate) fn place_state(
        &self,
        start: Instant,
        at: Instant,
        state: &mut DirectionState<Ecliptic>,
    ) -> Result<Instant, EphemerisError> {
        match self {
            Self::Circular(longitude) => {
                place_circular(*longitude, at.since(start), state);
                Ok(Instant::from_tai_ns(i64::MAX))
            }
            Self::Table(body) => body.place_state(at, state),
        }
    }

    /// The direction of [`Self::state`] alone.
    pub(crate) fn direction(
        &self,
        start: Instant,
        at: Instant,
    ) -> Result<Direction<Ecliptic>, EphemerisError> {
        match self {
            Self::Circular(longitude) => {
                let (sin, cos) = longitude.phase(at.since(start)).sin_cos();
                Ok(Direction::from_unit(Vector3::new(cos, sin, 0.0)))
            }
            Self::Table(body) => body.direction(at),
        }
    }

    /// Bounds on the direction's motion over all the time it is known.
    #[must_use]
    #[inline(never)]
    pub fn bounds(&self) -> MotionBounds {
        match self {
            Self::Circular(longitude) => {
                let rate = libm::fabs(longitude.rate.radians_per_second());
                MotionBounds { rate_rad_s: rate, acceleration_per_s2: rate * rate, max_abs_z: 0.0 }
            }
            Self::Table(body) => body.bounds(),
        }
    }
}

/// The state of a uniform motion in longitude, so long after its start.
#[cfg_attr(target_os = "none", inline(never))]
fn place_circular(longitude: Rotor, elapsed: Duration, state: &mut DirectionState<Ecliptic>) {
    let (sin, cos) = longitude.phase(elapsed).sin_cos();
    let rate = longitude.rate.radians_per_second();
    state.direction = Direction::from_unit(Vector3::new(cos, sin, 0.0));
    state.rate_per_s = [-rate * sin, rate * cos, 0.0];
}

/// Angular velocity in rad/s of the [`AntiSun`] frame that follows `sun`, components in [`Ecliptic`].
///
/// `omega = longitude' north + latitude' y`, y level: with n the direction, v its rate and rho the
/// cosine of the latitude, `omega = (v_z n_y, -v_z n_x, n_x v_y - n_y v_x) / rho^2`.
pub(crate) fn frame_angular_velocity(sun: &DirectionState<Ecliptic>) -> Vector3<f64> {
    let n = sun.direction.vector();
    let [vx, vy, vz] = sun.rate_per_s;
    let rho2 = n.x * n.x + n.y * n.y;
    let per_rho2 = if rho2 > 0.0 { 1.0 / rho2 } else { 0.0 };
    times(vector(vz * n.y, -vz * n.x, n.x * vy - n.y * vx), per_rho2)
}

/// The axes of [`AntiSun`] in [`Ecliptic`], and how they turn.
#[derive(Debug, Clone, Copy)]
pub struct AntiSunAxes {
    x: Vector3<f64>,
    y: Vector3<f64>,
    z: Vector3<f64>,
    /// Angular velocity in rad/s, components in [`Ecliptic`].
    angular_velocity: Vector3<f64>,
}

impl AntiSunAxes {
    /// The axes that follow `sun` (Sun to spacecraft).
    #[must_use]
    pub fn new(sun: &DirectionState<Ecliptic>) -> Self {
        let z = sun.direction.vector();
        let [vx, vy, vz] = sun.rate_per_s;
        let rho = root_near_one(z.x * z.x + z.y * z.y);
        let (cos_lon, sin_lon) = if rho > 0.0 { (z.x / rho, z.y / rho) } else { (1.0, 0.0) };
        let x = Vector3::new(-z.z * cos_lon, -z.z * sin_lon, rho);
        let y = Vector3::new(sin_lon, -cos_lon, 0.0);
        // omega = longitude' north + latitude' y: raising the latitude turns z towards x.
        let safe_rho = if rho > 0.0 { rho } else { 1.0 };
        let longitude_rate = (cos_lon * vy - sin_lon * vx) / safe_rho;
        let latitude_rate = vz / safe_rho;
        let north = Vector3::new(0.0, 0.0, longitude_rate);
        Self { x, y, z, angular_velocity: plus(north, times(y, latitude_rate)) }
    }

    /// A direction's components in [`AntiSun`], and their rate, the frame's own motion included.
    #[must_use]
    pub fn in_anti_sun(&self, target: &DirectionState<Ecliptic>) -> DirectionState<AntiSun> {
        let p = target.direction.vector();
        let [vx, vy, vz] = target.rate_per_s;
        let relative = minus(vector(vx, vy, vz), cross(self.angular_velocity, p));
        let seen = self.components(p);
        let rate = self.components(relative);
        DirectionState {
            direction: Direction::from_unit(seen),
            rate_per_s: [rate.x, rate.y, rate.z],
        }
    }

    /// Angular velocity of the frame in rad/s, components in [`AntiSun`].
    #[must_use]
    pub fn angular_velocity_rad_s(&self) -> [f64; 3] {
        let omega = self.components(self.angular_velocity);
        [omega.x, omega.y, omega.z]
    }

    /// The rotation from [`AntiSun`] to [`Ecliptic`].
    #[must_use]
    pub fn rotation(&self) -> Rotation<AntiSun, Ecliptic> {
        Rotation::to_direction_with_x_north(Direction::from_unit(self.z))
    }

    fn components(&self, v: Vector3<f64>) -> Vector3<f64> {
        let dot = |a: &Vector3<f64>| a.x * v.x + a.y * v.y + a.z * v.z;
        Vector3::new(dot(&self.x), dot(&self.y), dot(&self.z))
    }
}

/// Bounds on how the anti-Sun frame and a target in it move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RelativeBounds {
    /// Largest rate of the target's direction in [`AntiSun`], rad/s.
    pub(crate) rate: f64,
    /// Largest second derivative of that direction, 1/s^2.
    pub(crate) acceleration: f64,
}

impl RelativeBounds {
    /// From bounds on the Sun's and the target's motion in [`Ecliptic`].
    ///
    /// With rho the smallest cosine of the Sun's latitude, v and a the Sun's bounds: the frame turns
    /// at most at v/rho and changes that at most by 2 (a + 2 v^2/rho)/rho; the target's second
    /// derivative in the turning frame follows from the rule for relative motion.
    pub(crate) fn new(sun: &MotionBounds, target: &MotionBounds) -> Self {
        let sin_latitude = libm::fmin(sun.max_abs_z, 1.0);
        let rho = libm::sqrt(libm::fmax(1.0 - sin_latitude * sin_latitude, 1e-12));
        let turn = sun.rate_rad_s / rho;
        let turn_change =
            2.0 * (sun.acceleration_per_s2 + 2.0 * sun.rate_rad_s * sun.rate_rad_s / rho) / rho;
        Self {
            rate: turn + target.rate_rad_s,
            acceleration: target.acceleration_per_s2
                + 2.0 * turn * target.rate_rad_s
                + turn_change
                + turn * turn,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn axes_and_rotation_agree(lon in -4.0..4.0_f64, lat in -1.4..1.4_f64) {
            let sun = DirectionState {
                direction: Direction::from_longitude_latitude(lon, lat),
                rate_per_s: [0.0; 3],
            };
            let axes = AntiSunAxes::new(&sun);
            let there = axes.in_anti_sun(&DirectionState {
                direction: Direction::from_longitude_latitude(0.3, 0.4),
                rate_per_s: [0.0; 3],
            });
            let back = axes.rotation().apply(there.direction);
            prop_assert!(back.separation_rad(Direction::from_longitude_latitude(0.3, 0.4)) < 2e-15);
        }

        #[test]
        fn the_frame_turns_as_its_angular_velocity_says(
            lon in -3.0..3.0_f64, lat in -1.2..1.2_f64, dlon in -1.0..1.0_f64, dlat in -1.0..1.0_f64,
        ) {
            // Central difference of the view of a fixed direction against the analytic rate.
            let sun = |t: f64| {
                let (l, b) = (lon + dlon * t, lat + dlat * t);
                let (sl, cl) = libm::sincos(l);
                let (sb, cb) = libm::sincos(b);
                DirectionState {
                    direction: Direction::<Ecliptic>::from_longitude_latitude(l, b),
                    rate_per_s: [
                        -sb * cl * dlat - cb * sl * dlon,
                        -sb * sl * dlat + cb * cl * dlon,
                        cb * dlat,
                    ],
                }
            };
            let target = DirectionState {
                direction: Direction::from_longitude_latitude(0.3, -0.4),
                rate_per_s: [0.0; 3],
            };
            let h = 1e-5;
            let whole = AntiSunAxes::new(&sun(0.0)).angular_velocity;
            let direct = frame_angular_velocity(&sun(0.0));
            for (a, b) in whole.iter().zip(direct.iter()) {
                prop_assert!((a - b).abs() < 1e-14 / lat.cos());
            }
            let at = |t: f64| AntiSunAxes::new(&sun(t)).in_anti_sun(&target);
            let (after, before) = (at(h).direction.xyz(), at(-h).direction.xyz());
            for ((a, b), rate) in after.iter().zip(before).zip(at(0.0).rate_per_s) {
                prop_assert!(((a - b) / (2.0 * h) - rate).abs() < 1e-8 / lat.cos().powi(3));
            }
        }
    }

    /// The Sun's direction swings in longitude and latitude.
    fn swinging(t: f64, [a, b, fast, slow]: [f64; 4]) -> DirectionState<Ecliptic> {
        let (lon, lat) = (a * libm::sin(fast * t), b * libm::sin(slow * t));
        let (dlon, dlat) = (a * fast * libm::cos(fast * t), b * slow * libm::cos(slow * t));
        let ((sl, cl), (sb, cb)) = (libm::sincos(lon), libm::sincos(lat));
        DirectionState {
            direction: Direction::from_longitude_latitude(lon, lat),
            rate_per_s: [
                -sb * cl * dlat - cb * sl * dlon,
                -sb * sl * dlat + cb * cl * dlon,
                cb * dlat,
            ],
        }
    }

    #[test]
    fn the_relative_motion_stays_within_its_bounds() {
        let (h, mut rates, mut accelerations) = (1e-4, [0.0_f64; 2], [0.0_f64; 2]);
        // Slow swings turn the frame, quick ones change how it turns; the target at rest, or moving.
        for (index, numbers) in
            [[1.5, 0.3, 0.2, 0.1], [0.02, 0.001, 2.0, 1.0], [0.01, 0.3, 3.0, 0.5]]
                .iter()
                .enumerate()
        {
            for speed in [0.0, 0.7] {
                let sun = |t: f64| swinging(t, *numbers);
                let target = |t: f64| DirectionState::<Ecliptic> {
                    direction: Direction::from_longitude_latitude(0.4 + speed * t, 0.1),
                    rate_per_s: [
                        -speed * libm::cos(0.1) * libm::sin(0.4 + speed * t),
                        speed * libm::cos(0.1) * libm::cos(0.4 + speed * t),
                        0.0,
                    ],
                };
                let norm = |v: [f64; 3]| Vector3::from(v).norm();
                let change = |after: [f64; 3], before: [f64; 3]| {
                    (Vector3::from(after) - Vector3::from(before)).norm() / (2.0 * h)
                };
                let times = || (0..4_000).map(|k| f64::from(k) * 0.02);
                let most = |f: &dyn Fn(f64) -> f64| times().map(f).fold(0.0_f64, f64::max);
                let bounds = MotionBounds {
                    rate_rad_s: most(&|t| norm(sun(t).rate_per_s)),
                    acceleration_per_s2: most(&|t| {
                        change(sun(t + h).rate_per_s, sun(t - h).rate_per_s)
                    }),
                    max_abs_z: most(&|t| sun(t).direction.xyz()[2].abs()),
                };
                let own = MotionBounds {
                    rate_rad_s: speed,
                    acceleration_per_s2: speed * speed,
                    max_abs_z: 0.1,
                };
                let limit = RelativeBounds::new(&bounds, &own);
                let seen = |t: f64| AntiSunAxes::new(&sun(t)).in_anti_sun(&target(t));
                for t in times() {
                    let rate = norm(seen(t).rate_per_s) / limit.rate;
                    let acceleration =
                        change(seen(t + h).rate_per_s, seen(t - h).rate_per_s) / limit.acceleration;
                    let kind = usize::from(index > 0);
                    rates[kind] = rates[kind].max(rate);
                    accelerations[kind] = accelerations[kind].max(acceleration);
                }
            }
        }
        for (kind, (rate, acceleration)) in rates.into_iter().zip(accelerations).enumerate() {
            assert!(rate > 0.7 && rate < 1.0 + 1e-3, "{kind}: {rate}");
            assert!(acceleration > 0.4 && acceleration < 1.0 + 1e-3, "{kind}: {acceleration}");
        }
    }
}
