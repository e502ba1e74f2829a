//! What opportunities are worth by purpose, for targets whose weight is a table.
//!
//! The **effective seconds** of a purpose are the time in view times f = (signal / reference)^2, both
//! antenna temperatures in the telescope's beam at the time: the reference is Jupiter at 5.2 au, for
//! `polarisation_angle` the polarised signal of Tau A; there f is also multiplied by the coverage of the
//! half-wave plate's phases, where there is a plate.
//!
//! Method: linear, the value is the sum of weight times effective seconds. Logarithmic, each purpose has
//! its own cells: one for `gain`; `beam_map` by impact parameter, in steps of half a beam for detectors
//! and of an eighth of the field for fields of view; `pointing` by scan-beam angle and
//! `polarisation_angle` by crossing angle, in 16 ranges. Effective seconds in cells are whole ms.
//!
//! Limits: noise is taken as equal at all times and for all telescopes; a strength that is not known is
//! bad input, as is a band in which the reference is not known.

use super::angle::angle_bin;
use super::error::{Unknown, WorthError};
use super::scene::Scene;
use super::signal::{beam, hwp_coverage, impact_rad, strength, strength_at};
use super::strength::Strength;
use crate::opportunities::{NONE, Opportunity, SightLine};
use crate::world::{TableFault, body};
use mission::number::Number;
use mission::schedule::Purpose;
use onboard_core::attitude::sweep;
use onboard_core::field_of_view::FieldShape;
use onboard_core::time::Duration;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Distance of the reference planet in km.
const REFERENCE_KM: f64 = 5.2 * 149_597_870.7;
/// Bins of one purpose, those of the crossing angle of plain weights before them.
const BINS_OF_PURPOSE: u32 = 1 << 16;
/// Parts of a field of view.
const PARTS_OF_FIELD: f64 = 8.0;

/// The bins and times of an opportunity.
pub(crate) type Parts = Vec<(u32, Duration)>;

/// What the opportunities of one mission are worth.
#[derive(Debug, Default)]
pub(crate) struct Worth {
    /// Per opportunity; `None` where the weight is plain.
    pub(crate) each: Vec<Option<Valued>>,
    /// Weights of cells by target and bin.
    pub(crate) weights: BTreeMap<(usize, u32), f64>,
}

/// What one opportunity is worth.
#[derive(Debug)]
pub(crate) struct Valued {
    /// Sum of weight times effective seconds.
    pub(crate) value: f64,
    /// Effective seconds by bin.
    pub(crate) parts: Parts,
}

impl Scene<'_> {
    /// The worth of each opportunity; nothing where all weights are plain.
    ///
    /// # Errors
    /// [`WorthError`] names a weight whose source has no known strength.
    pub(crate) fn worth(&self) -> Result<Worth, WorthError> {
        let keys = &self.world.mission.calibration.schedule;
        if self.world.targets.iter().all(|it| keys.purposes(it.name()).is_empty()) {
            return Ok(Worth::default());
        }
        self.known()?;
        let list = self.offers.opportunities.list();
        let each = list.par_iter().map(|it| self.valued(it)).collect::<Result<Vec<_>, _>>()?;
        let mut weights = BTreeMap::new();
        for (it, valued) in list.iter().zip(&each) {
            let by_purpose = keys.purposes(self.world.targets[it.target].name());
            for (bin, _) in valued.iter().flat_map(|it| &it.parts) {
                let of = by_purpose
                    .iter()
                    .find(|entry| first_bin(entry.0) == *bin & !(BINS_OF_PURPOSE - 1));
                if let Some((_, weight)) = of {
                    weights.insert((it.target, *bin), weight.to_f64());
                }
            }
        }
        Ok(Worth { each, weights })
    }

    /// Whether every weight has a strength, seen in the mission or not.
    fn known(&self) -> Result<(), WorthError> {
        let world = self.world;
        let keys = &world.mission.calibration.schedule;
        for (target, source) in world.targets.iter().enumerate() {
            for telescope in 0..world.mission.telescopes.len() {
                for (purpose, _) in weighted(keys.purposes(source.name())) {
                    let pair = (target, telescope);
                    self.share(pair, *purpose, &strength_at(world, pair, world.start)?)?;
                }
            }
        }
        Ok(())
    }

    fn valued(&self, it: &Opportunity) -> Result<Option<Valued>, WorthError> {
        let world = self.world;
        let target = world.targets[it.target].name();
        let by_purpose = world.mission.calibration.schedule.purposes(target);
        if by_purpose.is_empty() {
            return Ok(None);
        }
        let seen = strength(world, it)?;
        let passes = self.offers.opportunities.passes(it);
        let found = || passes.iter().map(|&pass| &self.offers.found[pass]);
        let line = found().next().map(|it| &self.offers.lines[it.line]);
        let coverage = line.and_then(|line| hwp_coverage(world, line, found())).unwrap_or(1.0);
        let mut value = 0.0;
        let mut milliseconds: BTreeMap<u32, f64> = BTreeMap::new();
        for (purpose, weight) in weighted(by_purpose) {
            let share = self.share((it.target, it.telescope), *purpose, &seen)?;
            let share =
                if *purpose == Purpose::PolarisationAngle { share * coverage } else { share };
            for found in found() {
                let line = &self.offers.lines[found.line];
                let outside = |error| WorthError::Table(TableFault(error));
                let at = found.transit.closest;
                let looks = sweep(&world.scan, &self.sun, line.rotation, at).map_err(outside)?;
                let inside = match purpose {
                    Purpose::Gain => 0,
                    Purpose::BeamMap => {
                        let body = body(self.table, world.targets[it.target].body())?;
                        let target = body.state(at).map_err(outside)?.direction;
                        let step =
                            impact_step(line, world.mission.telescopes[it.telescope].fwhm_rad);
                        impact_bin(impact_rad(&looks, target), step)
                    }
                    Purpose::Pointing => angle_bin(looks.scan_beam_angle_rad),
                    Purpose::PolarisationAngle => angle_bin(looks.crossing_angle_rad),
                };
                let effective_s = found.transit.dwell().seconds() * share;
                value += weight.to_f64() * effective_s;
                *milliseconds.entry(first_bin(*purpose) + inside).or_default() += 1e3 * effective_s;
            }
        }
        let whole = |(bin, ms): (u32, f64)| (bin, Duration::from_seconds(1e-3 * ms.round()));
        Ok(Some(Valued { value, parts: milliseconds.into_iter().map(whole).collect() }))
    }

    /// (signal / reference)^2.
    fn share(
        &self,
        (target, telescope): (usize, usize),
        purpose: Purpose,
        seen: &Strength,
    ) -> Result<f64, WorthError> {
        let telescope = &self.world.mission.telescopes[telescope];
        let beam = beam(telescope);
        let (signal, reference) = match purpose {
            Purpose::PolarisationAngle => {
                (seen.polarised_k, beam.strength_of("tau_a", None).polarised_k)
            }
            _ => (seen.antenna_k, beam.strength_of("jupiter", Some(REFERENCE_KM)).antenna_k),
        };
        if let (Some(signal), Some(reference)) = (signal, reference) {
            return Ok((signal / reference) * (signal / reference));
        }
        let missing = match beam.frequency_ghz {
            None => Unknown::NoFrequency,
            Some(at_ghz) if reference.is_none() => Unknown::Reference { at_ghz },
            Some(at_ghz) => Unknown::Source { at_ghz },
        };
        Err(WorthError::Strength {
            target: self.world.targets[target].name().to_owned(),
            telescope: telescope.name.clone(),
            purpose,
            missing,
        })
    }
}

/// The weights above zero.
fn weighted(by_purpose: &[(Purpose, Number)]) -> impl Iterator<Item = &(Purpose, Number)> {
    by_purpose.iter().filter(|it| it.1.to_f64() > 0.0)
}

/// The first bin of a purpose.
const fn first_bin(purpose: Purpose) -> u32 {
    BINS_OF_PURPOSE
        * match purpose {
            Purpose::BeamMap => 1,
            Purpose::Gain => 2,
            Purpose::Pointing => 3,
            Purpose::PolarisationAngle => 4,
        }
}

/// Width of a range of impact parameters.
fn impact_step(line: &SightLine, fwhm_rad: f64) -> f64 {
    if line.detector_name != NONE {
        return 0.5 * fwhm_rad;
    }
    match line.field.shape() {
        FieldShape::Circle(radius) => 2.0 * radius / PARTS_OF_FIELD,
        FieldShape::Rectangle { width_rad, height_rad } => {
            width_rad.max(height_rad) / PARTS_OF_FIELD
        }
    }
}

/// The range that holds an impact parameter, 0 to 65535, those below zero first.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 65535 after the clamp"
)]
fn impact_bin(impact_rad: f64, step_rad: f64) -> u32 {
    let middle = f64::from(BINS_OF_PURPOSE / 2);
    ((impact_rad / step_rad).floor() + middle).clamp(0.0, f64::from(BINS_OF_PURPOSE - 1)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impacts_of_either_sign_have_ranges_of_their_own() {
        let bins = [-2.1, -2.0, -0.1, 0.0, 0.99, 1.0].map(|impact| impact_bin(impact, 1.0));
        assert_eq!(bins, [32_765, 32_766, 32_767, 32_768, 32_768, 32_769]);
        assert_eq!(impact_bin(1e9, 1.0), BINS_OF_PURPOSE - 1);
        assert_eq!(impact_bin(-1e9, 1.0), 0);
    }
}
