//! A mission as a survey takes it: periods, rates and the sampling rate as the rationals of its text.
//!
//! The survey rounds each of them once, so sample j lies at exactly j / `f_s` whatever the rates are.
//!
//! # Example
//! The hit map of a preset's first day through the mission boresight, at 1 Hz:
//! ```
//! use mission::{Mission, Override, number::Number};
//! use planner::survey::{MapFrame, SunSource, SunTable, Survey, SurveySun, input::SurveyInput};
//! use planner::{healpix::Nside, opportunities::boresight, progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = World::open(mission, None)?;
//! let lines = [boresight(&world.mission)?];
//! let input = SurveyInput::new(&world, &lines, &Number::parse("1")?)?;
//! let table = SunTable::new(world.tables(&world.ground_options())?.fitted.bytes);
//! let source = SunSource::Table(table.map_err(|error| format!("{error:?}"))?);
//! let (sun, nside) = (SurveySun { source, step: None }, Nside::new(32)?);
//! let SurveyInput { scan, detectors, samples, .. } = input;
//! let (frame, moments) = (MapFrame::Galactic, Vec::new());
//! let maps = Survey { scan, sun, detectors, nside, frame, moments }.run(0..samples, 0, &Quietly)?;
//! assert_eq!(maps.hits_map().iter().sum::<u64>(), 86_400);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{ExactRotor, SampledScan, SamplingError, SurveyDetector};
use crate::opportunities::SightLine;
use crate::world::World;
use mission::Mission;
use mission::number::Number;
use num_rational::BigRational;
use onboard_core::phase::Rotor;
use onboard_core::time::Duration;

/// What a survey needs of a mission.
#[derive(Debug, Clone)]
pub struct SurveyInput {
    /// The strategy and the rate of its samples.
    pub scan: SampledScan,
    /// The anti-Sun longitude, where the mission has the circular Sun.
    pub circular_sun: Option<ExactRotor>,
    /// Who looks.
    pub detectors: Vec<SurveyDetector>,
    /// Samples of each detector: those before the end.
    pub samples: u64,
}

impl SurveyInput {
    /// The mission sampled at `rate` Hz through lines of sight.
    ///
    /// # Errors
    /// [`SamplingError`] for a rate that is not positive, or at which the spin turns by half a turn
    /// or more between samples.
    pub fn new(world: &World, lines: &[SightLine], rate: &Number) -> Result<Self, SamplingError> {
        let scan = &world.mission.scan;
        let elapsed = world.start.since(world.zero());
        let turning = |period: &Number, rotor: Rotor| ExactRotor {
            turns_per_s: period.times(sign(rotor) * 60, 1).recip(),
            start: rotor.phase(elapsed),
        };
        let scan = SampledScan {
            start: world.start,
            sampling_hz: rate.exact().clone(),
            alpha_rad: scan.alpha_rad,
            beta_rad: scan.beta_rad,
            precession: turning(&scan.precession_period_min, scan.precession),
            spin: turning(&scan.spin_period_min, scan.spin),
        };
        scan.check()?;
        let year = BigRational::from_integer(mission::orbit::CIRCULAR_YEAR_S.into());
        let circular_sun =
            world.circular_sun.and_then(|sun| ExactRotor::with_period(&year, sun.phase(elapsed)));
        let detectors = lines
            .iter()
            .map(|line| SurveyDetector {
                rotation: line.rotation,
                plate: line.hwp.and_then(|plate| exact_plate(&world.mission, plate, elapsed)),
                polarisation_rad: line.polarisation_rad,
            })
            .collect();
        let samples = scan.samples_before(world.end.since(world.start));
        Ok(Self { scan, circular_sun, detectors, samples })
    }

    /// Samples taken before `elapsed_ns` after the start.
    #[must_use]
    pub fn samples_before(&self, elapsed_ns: i64) -> u64 {
        self.scan.samples_before(Duration::from_ns(elapsed_ns))
    }
}

fn sign(rotor: Rotor) -> i64 {
    if rotor.rate.is_negative() { -1 } else { 1 }
}

/// A plate with its sense, from the text of the telescope that has it, so long after the mission's start.
fn exact_plate(mission: &Mission, plate: Rotor, elapsed: Duration) -> Option<ExactRotor> {
    let telescope = mission.telescopes.iter().find(|it| it.hwp == Some(plate))?;
    let turns_per_s = telescope.hwp_rate_rpm.as_ref()?.times(sign(plate), 60);
    Some(ExactRotor { turns_per_s, start: plate.phase(elapsed) })
}
