//! What a session measures: where the target crosses the beam, at which angles, how strong it is.
//!
//! Frames: the **impact parameter** is the offset of the target from the line of sight at closest
//! approach, across the scan: positive along z x v, z the line of sight and v its velocity on the sky.
//! Its size is the least separation, but for the target's own motion.
//!
//! Method: offset and velocity in the frame of the line of sight, v = (sin zeta, cos zeta), so that
//! z x v = (-cos zeta, sin zeta). Strengths are [`planner::strength`]'s at the middle of the session,
//! at the distance of the mission's ephemeris; a source of the user's has the flux that is given.
//!
//! Limits: those of [`planner::strength::table`]; a strength is that of the beam's centre.

use crate::failure::Failure;
use crate::passes::Found;
use crate::sightline::SightLine;
use crate::world::World;
use onboard_core::attitude::Sweep;
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
use onboard_core::hwp::hwp_phase;
use onboard_core::time::{Duration, Instant};
use planner::opportunity::Opportunity;
use planner::strength::{Strength, Turning, phase_coverage};
use serde::{Deserialize, Serialize};

/// The strength of a session's target at the beam's centre; null for what is not known.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Signal {
    /// Angular diameter of a planet.
    pub angular_diameter_arcsec: Option<f64>,
    /// Temperature of a black body as bright as a planet in the telescope's band.
    pub brightness_temperature_k: Option<f64>,
    /// Part of the beam that a planet fills.
    pub beam_dilution: Option<f64>,
    /// Peak antenna temperature, Rayleigh-Jeans.
    pub antenna_temperature_mk: Option<f64>,
    /// The polarised part of it.
    pub polarised_temperature_mk: Option<f64>,
}

impl From<Strength> for Signal {
    fn from(it: Strength) -> Self {
        let in_mk = |kelvin: f64| 1e3 * kelvin;
        Self {
            angular_diameter_arcsec: it.diameter_rad.map(|rad| 3600.0 * rad.to_degrees()),
            brightness_temperature_k: it.brightness_k,
            beam_dilution: it.dilution,
            antenna_temperature_mk: it.antenna_k.map(in_mk),
            polarised_temperature_mk: it.polarised_k.map(in_mk),
        }
    }
}

/// The strength of an opportunity's target in its telescope's beam.
///
/// # Errors
/// [`Failure::Internal`] where the ephemeris does not serve the mission's own span.
pub fn strength(world: &World, it: &Opportunity) -> Result<Strength, Failure> {
    strength_at(world, (it.target, it.telescope), middle(it.first_entry, it.last_exit))
}

/// The strength of a target in a telescope's beam, both by index, at an instant.
///
/// # Errors
/// As [`strength`].
pub fn strength_at(
    world: &World,
    (target, telescope): (usize, usize),
    at: Instant,
) -> Result<Strength, Failure> {
    let source = &world.targets[target];
    let beam = world.mission.telescopes[telescope].beam();
    let own = world.mission.calibration.sources.iter().find(|own| own.name == source.name());
    if let Some(own) = own {
        return Ok(own.flux().map_or_else(Strength::default, |flux| beam.strength_of_flux(&flux)));
    }
    let distance = world.sky.distance_km(source, at).map_err(Failure::internal)?;
    Ok(beam.strength_of(source.name(), distance))
}

/// How evenly the passes cover the phases of the half-wave plate; `None` without a plate.
pub fn hwp_coverage<'f>(
    world: &World,
    line: &SightLine,
    passes: impl Iterator<Item = &'f Found>,
) -> Option<f64> {
    let plate = line.hwp?;
    let times = passes.map(|it| Turning {
        middle_rad: hwp_phase(&world.scan, plate, middle(it.transit.entry, it.transit.exit))
            .radians(),
        length_s: it.transit.dwell().seconds(),
    });
    phase_coverage(times, plate.rate.radians_per_second())
}

/// The impact parameter in radians of a target seen in that direction.
#[must_use]
pub fn impact_rad(seen: &Sweep, target: Direction<Ecliptic>) -> f64 {
    let [x, y, z] = seen.attitude.inverse().apply(target).xyz();
    let offset = x.hypot(y);
    if offset <= 0.0 {
        return 0.0;
    }
    let (sin, cos) = seen.scan_beam_angle_rad.sin_cos();
    offset.atan2(z) * (y * sin - x * cos) / offset
}

fn middle(from: Instant, until: Instant) -> Instant {
    from.plus(Duration::from_ns(until.since(from).ns() / 2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::rotation::Rotation;

    #[test]
    fn a_target_to_the_left_of_the_scan_has_a_positive_impact() {
        // The line of sight is z and moves towards +y (zeta = 0): z x v is -x.
        let seen = Sweep {
            attitude: Rotation::IDENTITY,
            direction: Direction::Z,
            crossing_angle_rad: 0.0,
            speed_rad_s: 1.0,
            scan_beam_angle_rad: 0.0,
        };
        let at = |x: f64, y: f64| Direction::new(x, y, 1.0).unwrap();
        assert!((impact_rad(&seen, at(-0.01, 0.0)) - 0.01_f64.atan()).abs() < 1e-15);
        assert!((impact_rad(&seen, at(0.02, 0.0)) + 0.02_f64.atan()).abs() < 1e-15);
        assert!(impact_rad(&seen, at(0.0, 0.3)).abs() < 1e-15);
        assert!(impact_rad(&seen, Direction::Z).abs() < 1e-300);
        // Towards +x (zeta = 90 deg): z x v is +y.
        let turned = Sweep { scan_beam_angle_rad: std::f64::consts::FRAC_PI_2, ..seen };
        assert!((impact_rad(&turned, at(0.0, 0.01)) - 0.01_f64.atan()).abs() < 1e-15);
    }
}
