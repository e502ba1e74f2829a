//! A mission as a survey takes it: periods, rates and the sampling rate as the rationals of its text.
//!
//! The survey rounds each of them once, so sample j lies at exactly j / `f_s` whatever the rates are.

use crate::failure::Failure;
use crate::mission::Mission;
use crate::number::Number;
use crate::sightline::SightLine;
use crate::world::World;
use num_rational::BigRational;
use onboard_core::phase::Rotor;
use onboard_core::time::Duration;
use planner::survey::{ExactRotor, SampledScan, SamplingError, SurveyDetector};

/// What a survey needs of a mission.
#[derive(Debug, Clone)]
pub struct SurveyInput {
    /// The strategy and the rate of its samples.
    pub scan: SampledScan,
    /// The anti-Sun longitude, where the mission has the circular Sun.
    pub circular_sun: Option<ExactRotor>,
    /// Who looks.
    pub detectors: Vec<SurveyDetector>,
    /// Samples of each detector: those before the mission's end.
    pub samples: u64,
}

impl SurveyInput {
    /// The mission sampled at `rate` Hz through lines of sight.
    ///
    /// # Errors
    /// [`Failure::Input`] for a rate that is not positive, or at which the spin turns by half a turn
    /// or more between samples.
    pub fn new(world: &World, lines: &[SightLine], rate: &Number) -> Result<Self, Failure> {
        let scan = &world.mission.scan;
        // Where one turn takes no time there is no rate; a mission's periods are above zero.
        let turning = |period: &Number, rotor: Rotor| {
            ExactRotor::with_period(&period.times(sign(rotor) * 60, 1), rotor.start)
                .ok_or_else(|| Failure::internal("a period of zero"))
        };
        let scan = SampledScan {
            start: world.start,
            sampling_hz: rate.exact().clone(),
            alpha_rad: scan.alpha_rad,
            beta_rad: scan.beta_rad,
            precession: turning(&scan.precession_period_min, scan.precession)?,
            spin: turning(&scan.spin_period_min, scan.spin)?,
        };
        scan.check().map_err(|error| refused(rate, error))?;
        let year = BigRational::from_integer(crate::mission::orbit::CIRCULAR_YEAR_S.into());
        let circular_sun =
            world.circular_sun.and_then(|sun| ExactRotor::with_period(&year, sun.start));
        let detectors = lines
            .iter()
            .map(|line| SurveyDetector {
                rotation: line.rotation,
                plate: line.hwp.and_then(|plate| exact_plate(&world.mission, plate)),
                polarisation_rad: line.polarisation_rad,
            })
            .collect();
        let samples = scan.samples_before(world.mission.span.duration);
        Ok(Self { scan, circular_sun, detectors, samples })
    }

    /// Samples taken before `elapsed_ns` after the start.
    #[must_use]
    pub fn samples_before(&self, elapsed_ns: i64) -> u64 {
        self.scan.samples_before(Duration::from_ns(elapsed_ns))
    }
}

fn refused(rate: &Number, error: SamplingError) -> Failure {
    Failure::Input(match error {
        SamplingError::NotPositive { .. } => {
            format!("--rate {rate}: a rate above 0 Hz is needed")
        }
        SamplingError::TooSlow { least_hz, .. } => {
            format!("--rate {rate}: more than two samples per turn are needed, above {least_hz} Hz")
        }
        SamplingError::OutOfRange { .. } => {
            format!("--rate {rate}: a rate from 1e-9 to 1e18 Hz is needed")
        }
    })
}

fn sign(rotor: Rotor) -> i64 {
    if rotor.rate.is_negative() { -1 } else { 1 }
}

/// A plate with its sense, from the text of the telescope that has it.
fn exact_plate(mission: &Mission, plate: Rotor) -> Option<ExactRotor> {
    let telescope = mission.telescopes.iter().find(|it| it.hwp == Some(plate))?;
    let turns_per_s = telescope.hwp_rate_rpm.as_ref()?.times(sign(plate), 60);
    Some(ExactRotor { turns_per_s, start: plate.start })
}
