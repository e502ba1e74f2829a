//! A mission as a survey takes it: everything in turns per sample, exactly.
//!
//! Periods, rates and the sampling rate are rationals of the mission's text; each ratio is rounded
//! once, so sample j lies at exactly j / `f_s` whatever the rates are.

use super::{SampledScan, SurveyDetector};
use crate::opportunities::SightLine;
use crate::world::World;
use mission::number::Number;
use mission::{Mission, rounding};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use onboard_core::phase::Rotor;
use thiserror::Error;

/// Why a rate cannot be surveyed at.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SurveyInputError {
    /// Not above zero.
    #[error("rate {0}: a rate above 0 Hz is needed")]
    NotPositive(Number),
    /// The spin turns by half a turn or more between samples.
    #[error("rate {rate}: more than two samples per turn are needed, above {fastest_hz} Hz")]
    TooSlow {
        /// The rate.
        rate: Number,
        /// What it must exceed.
        fastest_hz: f64,
    },
    /// No time between samples of 2^-64 ns or more.
    #[error("rate {0}: a rate from 1e-9 to 1e18 Hz is needed")]
    NoPeriod(Number),
}

/// What a survey needs of a mission.
#[derive(Debug, Clone)]
pub struct SurveyInput {
    /// The strategy on the clock of samples.
    pub scan: SampledScan,
    /// The anti-Sun longitude in turns per sample, where the mission has the circular Sun.
    pub circular_sun: Option<Rotor>,
    /// Who looks.
    pub detectors: Vec<SurveyDetector>,
    /// Samples of each detector: those before the mission's end.
    pub samples: u64,
    rate: BigRational,
}

impl SurveyInput {
    /// The mission sampled at `rate` Hz through lines of sight.
    ///
    /// # Errors
    /// [`SurveyInputError`] for a rate that is not positive, or at which the spin turns by half a turn
    /// or more between samples.
    pub fn new(
        world: &World,
        lines: &[SightLine],
        rate: &Number,
    ) -> Result<Self, SurveyInputError> {
        let scan = &world.mission.scan;
        let hz = rate.exact();
        if !hz.is_positive() {
            return Err(SurveyInputError::NotPositive(rate.clone()));
        }
        let turns = |period: &Number, rotor: Rotor| {
            let sign = if rotor.rate.is_negative() { -1 } else { 1 };
            period.times(sign * 60, 1).recip()
        };
        let spin = turns(&scan.spin_period_min, scan.spin);
        let precession = turns(&scan.precession_period_min, scan.precession);
        let fastest = if spin.abs() > precession.abs() { spin.abs() } else { precession.abs() };
        if &fastest * BigRational::from_integer(2.into()) >= *hz {
            return Err(SurveyInputError::TooSlow {
                rate: rate.clone(),
                fastest_hz: fastest.to_f64().unwrap_or(f64::NAN) * 2.0,
            });
        }
        let period = rounding::sampling_period(hz)
            .ok_or_else(|| SurveyInputError::NoPeriod(rate.clone()))?;
        let on_samples = |turns: &BigRational, rotor: Rotor| Rotor {
            rate: rounding::turns_per_sample(turns, hz),
            start: rotor.start,
        };
        let year = BigRational::new(BigInt::from(1), mission::orbit::CIRCULAR_YEAR_S.into());
        let detectors = lines
            .iter()
            .map(|line| SurveyDetector {
                rotation: line.rotation,
                plate: line.hwp.and_then(|plate| {
                    Some(on_samples(&plate_turns(&world.mission, plate)?, plate))
                }),
            })
            .collect();
        let samples = samples_before(world.mission.span.duration.ns(), hz);
        Ok(Self {
            scan: SampledScan {
                start: world.start,
                period,
                alpha_rad: scan.alpha_rad,
                beta_rad: scan.beta_rad,
                precession: on_samples(&precession, scan.precession),
                spin: on_samples(&spin, scan.spin),
            },
            circular_sun: world.circular_sun.map(|sun| on_samples(&year, sun)),
            detectors,
            samples,
            rate: hz.clone(),
        })
    }

    /// Samples taken before `elapsed_ns` after the start.
    #[must_use]
    pub fn samples_before(&self, elapsed_ns: i64) -> u64 {
        samples_before(elapsed_ns, &self.rate)
    }
}

fn samples_before(elapsed_ns: i64, hz: &BigRational) -> u64 {
    let samples = BigRational::new(elapsed_ns.into(), 1_000_000_000.into()) * hz;
    samples.ceil().to_integer().to_u64().unwrap_or(0)
}

/// Turns per second of a plate, with its sign, from the text of the telescope that has it.
fn plate_turns(mission: &Mission, plate: Rotor) -> Option<BigRational> {
    let telescope = mission.telescopes.iter().find(|it| it.hwp == Some(plate))?;
    let sign = if plate.rate.is_negative() { -1 } else { 1 };
    Some(telescope.hwp_rate_rpm.as_ref()?.times(sign, 60))
}
