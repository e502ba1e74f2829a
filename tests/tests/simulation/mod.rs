//! The survey kernel's simulation of a uniform motion, which the closed forms are held to: one
//! detector on the boresight, the circular Sun.
//!
//! Periods are whole numbers of units of 5 ms, so that motion and simulation have the same, exactly.

use crate::turning::turning;
use onboard_core::time::Instant;
use planner::healpix::Nside;
use planner::progress::Quietly;
use planner::resonance::{Motion, Predictor, Window};
use planner::survey::{
    BigRational, MapFrame, Moment, SampledScan, SunSource, Survey, SurveyDetector, SurveyMaps,
    SurveySun,
};

/// Units of a second in which periods are whole.
pub(crate) const UNITS: i64 = 200;
/// Units in a quarter of a day.
const QUARTER_DAY: u64 = 21_600 * UNITS as u64;

/// Angles in degrees, periods in units (negative: reversed), phases, length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Simulation {
    /// Anti-Sun axis to spin axis, degrees.
    pub(crate) alpha_deg: f64,
    /// Spin axis to boresight, degrees.
    pub(crate) beta_deg: f64,
    /// Precession period in units.
    pub(crate) precession: i64,
    /// Spin period in units.
    pub(crate) spin: i64,
    /// Precession phase at the start, radians.
    pub(crate) precession_phase_rad: f64,
    /// Spin phase at the start, radians.
    pub(crate) spin_phase_rad: f64,
    /// Length in quarters of a day.
    pub(crate) quarter_days: u64,
    /// Resolution of the map.
    pub(crate) nside: u32,
}

impl Simulation {
    /// The paper's angles and spin, one year; minutes of precession.
    #[must_use]
    pub(crate) fn litebird(minutes: f64, nside: u32) -> Self {
        Self {
            alpha_deg: 45.0,
            beta_deg: 50.0,
            precession: Self::units(minutes * 60.0),
            spin: 1200 * UNITS,
            precession_phase_rad: 0.0,
            spin_phase_rad: 0.0,
            quarter_days: 1461,
            nside,
        }
    }

    /// Seconds in units.
    #[must_use]
    pub(crate) fn units(seconds: f64) -> i64 {
        (seconds * UNITS as f64).round() as i64
    }

    /// The motion that is simulated.
    #[must_use]
    pub(crate) fn motion(&self) -> Motion {
        let seconds = |units: i64| units as f64 / UNITS as f64;
        Motion {
            precession_phase_rad: self.precession_phase_rad,
            spin_phase_rad: self.spin_phase_rad,
            duration_s: self.quarter_days as f64 * 21_600.0,
            ..Motion::year(seconds(self.precession), seconds(self.spin))
        }
    }

    /// The closed forms at its angles and pixels.
    ///
    /// # Panics
    /// When there is no window of that resolution.
    #[must_use]
    pub(crate) fn predictor(&self) -> Predictor {
        let window = Window::pixel(self.side()).expect("a window");
        Predictor::new(self.alpha_deg.to_radians(), self.beta_deg.to_radians(), window)
    }

    /// Its maps, sampled `samples` times in so many units.
    ///
    /// # Panics
    /// When it cannot be surveyed.
    #[must_use]
    pub(crate) fn maps(&self, (samples, units): (u32, u32), moments: &[Moment]) -> SurveyMaps {
        let hz = BigRational::new((i64::from(samples) * UNITS).into(), units.into());
        let survey = Survey {
            scan: SampledScan {
                start: Instant::from_tai_ns(0),
                sampling_hz: hz,
                alpha_rad: self.alpha_deg.to_radians(),
                beta_rad: self.beta_deg.to_radians(),
                precession: turning((self.precession, UNITS), self.precession_phase_rad),
                spin: turning((self.spin, UNITS), self.spin_phase_rad),
            },
            sun: SurveySun {
                source: SunSource::Circular(turning((31_557_600, 1), 0.0)),
                step: None,
            },
            detectors: vec![SurveyDetector::BORESIGHT],
            nside: self.side(),
            frame: MapFrame::Ecliptic,
            moments: moments.to_vec(),
        };
        let count = self.quarter_days * QUARTER_DAY * u64::from(samples) / u64::from(units);
        survey.run(0..count, 2, &Quietly).expect("a survey")
    }

    fn side(&self) -> Nside {
        Nside::new(self.nside).expect("a resolution")
    }
}
