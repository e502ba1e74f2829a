//! Where does the observer see a target.
//!
//! A [`Sky`] gives unit vectors in the ecliptic of J2000: the geometric Sun-to-spacecraft direction
//! (always of the real trajectory), and the direction of a source as seen from the spacecraft, the
//! Earth's centre or the Sun's centre, apparent or geometric.
//!
//! Method: light time tau from `c tau = |x_target(t - tau) - x_observer(t)|`, barycentric, by
//! Newton's iteration to convergence; then stellar aberration with the observer's barycentric
//! velocity, `n' = (n/g + b (1 + n.b/(1 + 1/g))) / (1 + n.b)`, `b = v/c`, `1/g = sqrt(1 - b.b)`
//! [Urban2013, chapter 7]. Fixed sources are aberrated too; tables are used as given.
//! ICRF to ecliptic is a rotation about x by [`OBLIQUITY_ARCSEC`], 84381.448 arcsec.
//!
//! Limits: no light deflection by the Sun (4 mas at 90 deg from it, 18 mas at 25 deg). Light time
//! needs the target's ephemeris from tau before: 4.2 h for Neptune. 1e-12 rad against independent
//! programs on the same kernel (`tests/apparent.rs`).
//!
//! # Example
//! ```
//! use ephem::apparent::{Corrections, Sky};
//! use ephem::source::Source;
//! use ephem::time::parse_time;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let start = parse_time("2032-04-01T00:00:00 TDB")?;
//! let mut sky = Sky::from_l2(start);
//! let jupiter = Source::by_name("jupiter")?;
//! let seen = sky.direction(&jupiter, start)?;
//! sky.corrections = Corrections::Geometric;
//! // Light time and aberration together move a planet by less than an arcminute.
//! let shift_rad = seen.separation_rad(sky.direction(&jupiter, start)?);
//! assert!((1e-6..3e-4).contains(&shift_rad));
//! // L2 lies in the ecliptic, opposite to the Sun.
//! assert!(sky.sun_to_spacecraft(start)?.latitude_rad().abs() < 1e-4);
//! # Ok(())
//! # }
//! ```

use crate::ecliptic::{direction_from_icrf, icrf_from_direction};
use crate::kernel::{EARTH, Kernel, SUN, State, StateError};
use crate::source::{Place, Source};
use crate::time::{format_tdb, tdb_seconds};
use crate::trajectory::Trajectory;
use nalgebra::Vector3;
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
pub use onboard_core::frame::OBLIQUITY_ARCSEC;
use onboard_core::time::{Duration, Instant};
use thiserror::Error;

/// Speed of light in km/s, by definition.
pub const SPEED_OF_LIGHT_KM_S: f64 = 299_792.458;

/// Newton steps below this many seconds leave 1e-13 km, less than rounding.
const LIGHT_TIME_STEP_S: f64 = 1e-3;
/// Newton's iteration needs two or three steps; speeds near light's would need more.
const LIGHT_TIME_STEPS: usize = 20;

/// From where targets are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Observer {
    /// The spacecraft.
    Spacecraft,
    /// The Earth's centre.
    Earth,
    /// The Sun's centre.
    Sun,
}

/// Which corrections a direction has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Corrections {
    /// Light time and stellar aberration.
    Apparent,
    /// None: positions at one instant.
    Geometric,
}

/// Why there is no direction.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SkyError {
    /// A state is not known.
    #[error(transparent)]
    State(#[from] StateError),
    /// The light that arrives left before the target's ephemeris begins.
    #[error(
        "the light of '{source_name}' seen at {} TDB left at {} TDB, before its ephemeris, which begins at {} TDB: start the span {:.0} s later, or use a kernel that begins earlier",
        format_tdb(*at), format_tdb(*needed), format_tdb(*start), start.since(*needed).seconds().ceil()
    )]
    LightTime {
        /// The target.
        source_name: String,
        /// The time asked for.
        at: Instant,
        /// When the light left.
        needed: Instant,
        /// First instant of the target's ephemeris.
        start: Instant,
    },
    /// Target and observer are one.
    #[error("the direction of '{source_name}' is undefined: the observer is there")]
    Coincident {
        /// The target.
        source_name: String,
    },
    /// The user's table does not reach the time.
    #[error(
        "the directions of '{source_name}' are tabulated from {first_s} to {last_s} s after the mission's start; asked for {at_s} s"
    )]
    OutOfTable {
        /// The target.
        source_name: String,
        /// Elapsed seconds asked for.
        at_s: f64,
        /// First row's.
        first_s: f64,
        /// Last row's.
        last_s: f64,
    },
}

/// Everything that fixes directions: ephemeris, trajectory, observer, corrections, scan clock.
#[derive(Debug, Clone)]
pub struct Sky {
    /// Planetary ephemeris.
    pub kernel: Kernel,
    /// The spacecraft's path.
    pub trajectory: Trajectory,
    /// From where targets are seen.
    pub observer: Observer,
    /// Which corrections their directions have.
    pub corrections: Corrections,
    /// Zero of the scan clock, which direction tables run on.
    pub mission_start: Instant,
}

impl Sky {
    /// The embedded kernel, the spacecraft at L2 observing, apparent directions.
    #[must_use]
    pub fn from_l2(mission_start: Instant) -> Self {
        Self {
            kernel: Kernel::embedded(),
            trajectory: Trajectory::l2(),
            observer: Observer::Spacecraft,
            corrections: Corrections::Apparent,
            mission_start,
        }
    }

    /// Geometric direction from the Sun to the spacecraft, whoever observes.
    ///
    /// # Errors
    /// [`SkyError::State`] outside kernel or trajectory.
    pub fn sun_to_spacecraft(&self, at: Instant) -> Result<Direction<Ecliptic>, SkyError> {
        let spacecraft = self.trajectory.state(&self.kernel, at)?;
        let sun = self.kernel.state(SUN, at)?;
        direction_from_icrf(spacecraft.position_km - sun.position_km)
            .ok_or_else(|| SkyError::Coincident { source_name: "sun".to_owned() })
    }

    /// Direction of a source as the observer sees it.
    ///
    /// # Errors
    /// [`SkyError`]: outside kernel, trajectory or table, or the observer is at the source.
    pub fn direction(&self, source: &Source, at: Instant) -> Result<Direction<Ecliptic>, SkyError> {
        let naif = match source.place() {
            Place::Table(table) => {
                let elapsed = at.since(self.mission_start);
                let (first, last) = table.span_ns();
                let vector = table.at(elapsed.ns()).ok_or_else(|| SkyError::OutOfTable {
                    source_name: source.name().to_owned(),
                    at_s: elapsed.seconds(),
                    first_s: Duration::from_ns(first).seconds(),
                    last_s: Duration::from_ns(last).seconds(),
                })?;
                return Direction::new(vector.x, vector.y, vector.z)
                    .ok_or_else(|| coincident(source));
            }
            Place::Fixed(direction) if self.corrections == Corrections::Geometric => {
                return Ok(*direction);
            }
            Place::Fixed(direction) => {
                let velocity = self.observer_state(at)?.velocity_km_s;
                let unit = icrf_from_direction(*direction);
                return direction_from_icrf(aberrated(unit, velocity))
                    .ok_or_else(|| coincident(source));
            }
            Place::SolarSystem(naif) => *naif,
        };
        let here = self.observer_state(at)?;
        if self.corrections == Corrections::Geometric {
            let there = self.kernel.state(naif, at)?;
            return direction_from_icrf(there.position_km - here.position_km)
                .ok_or_else(|| coincident(source));
        }
        let path = self.light_path(source, naif, &here, at)?;
        let length = path.norm();
        if length > 0.0 {
            direction_from_icrf(aberrated(path / length, here.velocity_km_s))
        } else {
            None
        }
        .ok_or_else(|| coincident(source))
    }

    /// Distance of a body of the kernel from the observer in km: with corrections, the way of the light
    /// that arrives. `None` for fixed sources and tables.
    ///
    /// # Errors
    /// [`SkyError`]: outside kernel or trajectory.
    pub fn distance_km(&self, source: &Source, at: Instant) -> Result<Option<f64>, SkyError> {
        let Place::SolarSystem(naif) = source.place() else { return Ok(None) };
        let here = self.observer_state(at)?;
        Ok(Some(match self.corrections {
            Corrections::Geometric => {
                (self.kernel.state(*naif, at)?.position_km - here.position_km).norm()
            }
            Corrections::Apparent => self.light_path(source, *naif, &here, at)?.norm(),
        }))
    }

    fn observer_state(&self, at: Instant) -> Result<State, StateError> {
        match self.observer {
            Observer::Spacecraft => self.trajectory.state(&self.kernel, at),
            Observer::Earth => self.kernel.state(EARTH, at),
            Observer::Sun => self.kernel.state(SUN, at),
        }
    }

    /// From the observer to where the target was when its light left, km.
    fn light_path(
        &self,
        source: &Source,
        naif: i32,
        here: &State,
        at: Instant,
    ) -> Result<Vector3<f64>, SkyError> {
        let arrival_s = tdb_seconds(at);
        let mut light_time_s = 0.0;
        let mut path = Vector3::zeros();
        for _ in 0..LIGHT_TIME_STEPS {
            let departure_s = arrival_s - light_time_s;
            let there = match self.kernel.state_at(naif, departure_s) {
                Err(StateError::OutOfSpan { at: needed, start, .. })
                    if light_time_s > 0.0 && needed < start =>
                {
                    let source_name = source.name().to_owned();
                    return Err(SkyError::LightTime { source_name, at, needed, start });
                }
                other => other?,
            };
            let offset = there.position_km - here.position_km;
            let distance = offset.norm();
            if distance <= 0.0 {
                return Err(coincident(source));
            }
            // The lag that was evaluated, without the rounding of the departure (0.1 us, 3 mm).
            let lag_s = arrival_s - departure_s;
            // F(tau) = c tau - |x(t - tau) - x_o|, F' = c + n . v.
            let receding = offset.dot(&there.velocity_km_s) / distance;
            let step_s =
                (distance - SPEED_OF_LIGHT_KM_S * lag_s) / (SPEED_OF_LIGHT_KM_S + receding);
            light_time_s = lag_s + step_s;
            path = offset - there.velocity_km_s * step_s;
            if step_s.abs() < LIGHT_TIME_STEP_S {
                break;
            }
        }
        Ok(path)
    }
}

fn coincident(source: &Source) -> SkyError {
    SkyError::Coincident { source_name: source.name().to_owned() }
}

/// Direction in which light arrives from the unit vector `n` for an observer of that velocity.
fn aberrated(n: Vector3<f64>, velocity_km_s: Vector3<f64>) -> Vector3<f64> {
    let b = velocity_km_s / SPEED_OF_LIGHT_KM_S;
    let inverse_gamma = libm::sqrt((1.0 - b.norm_squared()).max(0.0));
    let along = n.dot(&b);
    (n * inverse_gamma + b * (1.0 + along / (1.0 + inverse_gamma))) / (1.0 + along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aberration_has_its_closed_form() {
        // Across the motion tan(theta') = sin(theta)/(g (cos(theta) + b)).
        let beta: f64 = 0.3;
        let velocity = Vector3::new(beta * SPEED_OF_LIGHT_KM_S, 0.0, 0.0);
        for theta in [0.0_f64, 0.4, 1.5, 2.9] {
            let seen = aberrated(Vector3::new(theta.cos(), theta.sin(), 0.0), velocity);
            let gamma = 1.0 / (1.0 - beta * beta).sqrt();
            let expected = (theta.sin() / gamma).atan2(theta.cos() + beta);
            assert!((seen.y.atan2(seen.x) - expected).abs() < 1e-15);
            assert!((seen.norm() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn distances_are_those_of_the_states_to_a_light_time() {
        // Speeds of 60 km/s over 4.2 h of light time are 9e5 km.
        let at = Instant::from_tai_ns(1_000_000_000_000_000_000);
        let mut sky = Sky::from_l2(at);
        let jupiter = Source::by_name("jupiter").unwrap();
        let apparent = sky.distance_km(&jupiter, at).unwrap().unwrap();
        sky.corrections = Corrections::Geometric;
        let geometric = sky.distance_km(&jupiter, at).unwrap().unwrap();
        assert!((apparent - geometric).abs() < 9e5 && apparent.to_bits() != geometric.to_bits());
        // Between 3.9 and 6.5 au from anywhere near the Earth.
        assert!((5.8e8..9.8e8).contains(&apparent), "{apparent}");
        assert_eq!(sky.distance_km(&Source::by_name("tau_a").unwrap(), at), Ok(None));
    }
}
