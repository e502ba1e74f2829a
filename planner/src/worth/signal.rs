//! What a session measures: where the target crosses the beam, at which angles, how strong it is.
//!
//! Frames: the **impact parameter** is the offset of the target from the line of sight at closest
//! approach, across the scan: positive along z x v, z the line of sight and v its velocity on the sky.
//! Its size is the least separation, but for the target's own motion.
//!
//! Method: offset and velocity in the frame of the line of sight, v = (sin zeta, cos zeta), so that
//! z x v = (-cos zeta, sin zeta). Strengths are [`mod@super::strength`]'s at the middle of the session,
//! at the distance of the mission's ephemeris; a source of the user's has the flux that is given.
//!
//! Limits: those of [`super::strength::table`]; a strength is that of the beam's centre.

use super::strength::{Beam, Flux, Strength, Turning, phase_coverage};
use crate::opportunities::{Found, Opportunity, SightLine};
use crate::world::World;
use ephem::apparent::SkyError;
use mission::calibration::CalibrationSource;
use mission::number::Number;
use mission::telescope::Telescope;
use onboard_core::attitude::Sweep;
use onboard_core::direction::Direction;
use onboard_core::frame::Ecliptic;
use onboard_core::hwp::hwp_phase;
use onboard_core::time::{Duration, Instant};

/// A telescope's beam, by which the strength of sources is told.
#[must_use]
pub fn beam(telescope: &Telescope) -> Beam {
    let frequency_ghz = telescope.frequency_ghz.as_ref().map(Number::to_f64);
    Beam { fwhm_rad: telescope.fwhm_rad, frequency_ghz }
}

/// The flux of a source of the mission's own, where it is given.
#[must_use]
pub fn flux(source: &CalibrationSource) -> Option<Flux> {
    let jy = source.flux_jy.as_ref()?.to_f64();
    let polarised_fraction = source.polarised_fraction.as_ref().map(Number::to_f64);
    Some(Flux { jy, polarised_fraction })
}

/// The strength of an opportunity's target in its telescope's beam.
///
/// # Errors
/// [`SkyError`] where the ephemeris does not serve the mission's own span.
pub fn strength(world: &World, it: &Opportunity) -> Result<Strength, SkyError> {
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
) -> Result<Strength, SkyError> {
    let source = &world.targets[target];
    let beam = beam(&world.mission.telescopes[telescope]);
    let own = world.mission.calibration.sources.iter().find(|own| own.name == source.name());
    if let Some(own) = own {
        return Ok(flux(own).map_or_else(Strength::default, |flux| beam.strength_of_flux(&flux)));
    }
    let distance = world.sky.distance_km(source, at)?;
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
