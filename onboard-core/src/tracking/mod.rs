//! Where is the scan really, when attitudes have been measured.
//!
//! A [`Tracker`] follows the errors of precession phase, alpha, spin phase and both rates. Each
//! accepted [`Measurement`] moves the strategy itself, so that [`Tracker::strategy`] gives the best
//! known scan: transits searched with it follow at once. [`Tracker::covariance_at`] says how well
//! the angles are known at any later instant.
//!
//! Frames: attitudes are of the mission boresight frame in `Ecliptic`
//! ([`Rotation::by_obliquity`](crate::rotation::Rotation::by_obliquity) brings equatorial ones
//! there). Residuals and errors are true or measured minus modelled.
//!
//! Method: a Kalman filter on five errors whose estimates are folded into the exact phases and rates
//! at every update, so the errors it holds are always zero on average and the long-term arithmetic
//! is that of integers. The measured angles (`angles.rs`) enter as a + b, alpha and a - b, whose
//! noises are independent; the measurement is linear in the errors. The start of the mission never
//! moves: the half-wave plate's clock hangs on it.
//!
//! Limits: alpha from 1 to 179 deg ([`MeasurementRefusal::Unobservable`] beyond: only a + b, or a - b, is
//! seen). Beta and the star tracker's mounting are taken as known, the noise as white, isotropic and
//! small against alpha. A phase known worse than an eighth of a turn is [`MeasurementRefusal::Ambiguous`].
//! A measurement that would make alpha + beta exceed pi is refused. `tests/tests/tracking.rs` shows
//! predictions and the stated intervals to hold.

mod angles;
mod filter;
mod settings;
mod state;
#[cfg(test)]
mod rules;

pub use angles::ScanAngles;
pub use settings::{
    GATES, MAX_ANGLE_SIGMA_RAD, MAX_ANGLE_WALK, MAX_RATE_SIGMA, MAX_RATE_WALK, ScanAngle,
    TrackerSettings, TrackerSettingsError,
};
pub use state::{TRACKER_BYTES, TrackerState};

use crate::ephemeris::EphemerisError;
use crate::frame::{Boresight, Ecliptic};
use crate::phase::{Phase, Rotor, TurnRate};
use crate::rotation::Rotation;
use crate::scan::{ScanError, ScanParameters, ScanStrategy};
use crate::sun::SunModel;
use crate::time::{Duration, Instant};
use crate::trigonometry;
use crate::uncertainty::ScanCovariance;
use crate::uplink::checksum;
use core::f64::consts::{FRAC_PI_4, PI};
use filter::{ErrorCovariance, Errors};
use settings::ANGLES;

/// Smallest angle between spin axis and anti-Sun axis (or its opposite) that shows both phases.
pub const MIN_ALPHA_RAD: f64 = PI / 180.0;
/// Legal noises of a measured attitude, rad about each axis.
pub const SIGMAS_RAD: core::ops::RangeInclusive<f64> = 1e-7..=1e-3;
/// Largest standard deviation of a phase's residual that cannot be mistaken by a turn, rad.
pub const MAX_PHASE_SIGMA_RAD: f64 = FRAC_PI_4;

/// A measured attitude.
#[derive(Debug, Clone, Copy)]
pub struct Measurement {
    /// When it was.
    pub at: Instant,
    /// What was measured.
    pub attitude: Rotation<Boresight, Ecliptic>,
    /// Standard deviation of the noise about each axis, rad.
    pub sigma_rad: f64,
}

/// What a measurement showed against the model: precession phase, alpha, spin phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// Measured minus modelled in radians; phases in [-pi, pi).
    pub innovation_rad: [f64; 3],
    /// Their standard deviations, of model and noise together, in radians.
    pub sigma_rad: [f64; 3],
    /// Chi^2 of the three together, correlations included.
    pub chi2: f64,
}

/// Why a measurement was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum MeasurementRefusal {
    /// The noise (rad) is not in [`SIGMAS_RAD`].
    Sigma(f64),
    /// Older than the settings allow (its age).
    Stale(Duration),
    /// Further ahead of now than the settings allow (by how much it is ahead).
    Future(Duration),
    /// Not after the last accepted measurement, or before the tracker's epoch (that instant).
    NotAfter(Instant),
    /// The Sun's direction is not known then.
    Ephemeris(EphemerisError),
    /// The measured alpha (rad) is too near 0 or pi to tell precession from spin.
    Unobservable(f64),
    /// A phase is known so badly (standard deviation, rad) that whole turns may be lost.
    Ambiguous(ScanAngle, f64),
    /// Chi^2 is above the gate.
    Outlier(Residuals),
    /// The correction of an angle (rad) is beyond its limit.
    Correction(ScanAngle, f64),
    /// The corrected strategy would be illegal.
    Strategy(ScanError),
}

/// Why a saved state cannot be taken up.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ResumeError {
    /// The state's strategy is illegal.
    Scan(ScanError),
    /// The state belongs to another nominal strategy than the one that this tracker began with.
    OtherStrategy,
    /// The state's covariance is not one.
    Covariance,
}

/// The best known scan, and how well it is known.
#[derive(Debug, Clone, Copy)]
pub struct Tracker {
    settings: TrackerSettings,
    /// CRC-32 of the nominal strategy.
    nominal: u32,
    scan: ScanStrategy,
    epoch: Instant,
    covariance: ErrorCovariance,
    accepted: u32,
    refused_in_a_row: u32,
}

impl Tracker {
    /// A tracker that knows `scan` at `epoch` as well as the settings say.
    ///
    /// # Errors
    /// [`TrackerSettingsError`] names the setting out of its range.
    pub fn new(
        scan: &ScanStrategy,
        settings: &TrackerSettings,
        epoch: Instant,
    ) -> Result<Self, TrackerSettingsError> {
        settings.check()?;
        Ok(Self {
            settings: *settings,
            nominal: identity(scan),
            scan: *scan,
            epoch,
            covariance: prior(scan, settings),
            accepted: 0,
            refused_in_a_row: 0,
        })
    }

    /// Forgets everything and begins anew with `scan` at `epoch`: the way out when the model is
    /// truly wrong and every measurement is refused.
    pub fn restart(&mut self, scan: &ScanStrategy, epoch: Instant) {
        self.nominal = identity(scan);
        self.scan = *scan;
        self.epoch = epoch;
        self.covariance = prior(scan, &self.settings);
        self.accepted = 0;
        self.refused_in_a_row = 0;
    }

    /// What to save, so that [`Self::resume`] goes on with the same bits.
    #[must_use]
    pub const fn state(&self) -> TrackerState {
        TrackerState {
            nominal: self.nominal,
            scan: *self.scan.parameters(),
            epoch: self.epoch,
            covariance: self.covariance,
            accepted: self.accepted,
            refused_in_a_row: self.refused_in_a_row,
        }
    }

    /// Goes on from a saved state of a tracker that began with the same nominal strategy.
    ///
    /// # Errors
    /// [`ResumeError`] when the state is another strategy's or illegal; nothing changes then.
    #[inline(never)]
    // REQ-TRACK-3.
    pub fn resume(&mut self, state: &TrackerState) -> Result<(), ResumeError> {
        let scan = ScanStrategy::new(state.scan).map_err(ResumeError::Scan)?;
        // Start and beta are never corrected.
        let (own, other) = (self.scan.parameters(), scan.parameters());
        let same = state.nominal == self.nominal
            && own.start == other.start
            && own.beta_rad.to_bits() == other.beta_rad.to_bits();
        if !same {
            return Err(ResumeError::OtherStrategy);
        }
        if !state.covariance.is_legal() {
            return Err(ResumeError::Covariance);
        }
        self.scan = scan;
        self.epoch = state.epoch;
        self.covariance = state.covariance;
        self.accepted = state.accepted;
        self.refused_in_a_row = state.refused_in_a_row;
        Ok(())
    }

    /// The strategy as corrected by all accepted measurements.
    #[must_use]
    pub const fn strategy(&self) -> &ScanStrategy {
        &self.scan
    }

    /// Instant of the last accepted measurement, or the epoch when there is none.
    #[must_use]
    pub const fn epoch(&self) -> Instant {
        self.epoch
    }

    /// Accepted measurements since the (re)start.
    #[must_use]
    pub const fn accepted(&self) -> u32 {
        self.accepted
    }

    /// Refused measurements since the last accepted one.
    #[must_use]
    pub const fn refused_in_a_row(&self) -> u32 {
        self.refused_in_a_row
    }

    /// How well the angles of [`Self::strategy`] are known at `at`.
    ///
    /// Random walks count by the distance from the last update in either direction.
    #[must_use]
    // REQ-TRACK-2.
    pub fn covariance_at(&self, at: Instant) -> ScanCovariance {
        self.propagated(at).angles()
    }

    /// Standard deviations of the precession and the spin rate in rad/s, at the last update.
    #[must_use]
    pub fn rate_sigmas_rad_s(&self) -> [f64; 2] {
        self.covariance.rate_variances().map(libm::sqrt)
    }

    /// Corrects the strategy by a measured attitude; `now` is the clock's instant.
    ///
    /// # Errors
    /// [`MeasurementRefusal`] says why it was not used; nothing but [`Self::refused_in_a_row`] changes then.
    #[inline(never)]
    // REQ-TRACK-1.
    pub fn update(
        &mut self,
        sun: &SunModel<'_>,
        measurement: &Measurement,
        now: Instant,
    ) -> Result<Residuals, MeasurementRefusal> {
        let result = self.consider(sun, measurement, now);
        match result {
            Ok(_) => {
                self.accepted = self.accepted.saturating_add(1);
                self.refused_in_a_row = 0;
            }
            Err(_) => self.refused_in_a_row = self.refused_in_a_row.saturating_add(1),
        }
        result
    }

    fn consider(
        &mut self,
        sun: &SunModel<'_>,
        measurement: &Measurement,
        now: Instant,
    ) -> Result<Residuals, MeasurementRefusal> {
        self.check_time(measurement, now)?;
        let at = measurement.at;
        let seen = ScanAngles::measured(measurement.attitude, &self.scan, sun, at)
            .map_err(MeasurementRefusal::Ephemeris)?;
        if !(MIN_ALPHA_RAD..=PI - MIN_ALPHA_RAD).contains(&seen.alpha_rad) {
            return Err(MeasurementRefusal::Unobservable(seen.alpha_rad));
        }
        let innovation_rad = seen.minus(&ScanAngles::modelled(&self.scan, at));
        self.take(at, innovation_rad, &Noise::new(measurement.sigma_rad, seen.alpha_rad))
    }

    /// Not inlined: its covariances would lie on the stack under the Sun's evaluation.
    #[inline(never)]
    fn take(
        &mut self,
        at: Instant,
        innovation_rad: [f64; 3],
        noise: &Noise,
    ) -> Result<Residuals, MeasurementRefusal> {
        let mut covariance = self.propagated(at);
        let sigma_rad = noise.with(&covariance);
        let [precession, _, spin] = sigma_rad;
        for (angle, sigma) in [(ScanAngle::Precession, precession), (ScanAngle::Spin, spin)] {
            if sigma > MAX_PHASE_SIGMA_RAD {
                return Err(MeasurementRefusal::Ambiguous(angle, sigma));
            }
        }
        let mut errors = [0.0; 5];
        let chi2 = noise.observe(&mut covariance, &mut errors, innovation_rad);
        let residuals = Residuals { innovation_rad, sigma_rad, chi2 };
        if chi2.is_nan() || chi2 > self.settings.gate {
            return Err(MeasurementRefusal::Outlier(residuals));
        }
        for ((angle, limit), error) in ANGLES.into_iter().zip(self.settings.limits_rad).zip(errors)
        {
            if libm::fabs(error) > limit {
                return Err(MeasurementRefusal::Correction(angle, error));
            }
        }
        let corrected = corrected(&self.scan, &errors, at);
        self.scan = ScanStrategy::new(corrected).map_err(MeasurementRefusal::Strategy)?;
        self.covariance = covariance;
        self.epoch = at;
        Ok(residuals)
    }

    fn check_time(
        &self,
        measurement: &Measurement,
        now: Instant,
    ) -> Result<(), MeasurementRefusal> {
        if !SIGMAS_RAD.contains(&measurement.sigma_rad) {
            return Err(MeasurementRefusal::Sigma(measurement.sigma_rad));
        }
        let age = now.since(measurement.at);
        if age > self.settings.max_age {
            return Err(MeasurementRefusal::Stale(age));
        }
        let lead = measurement.at.since(now);
        if lead > self.settings.max_lead {
            return Err(MeasurementRefusal::Future(lead));
        }
        // The first may stand at the epoch itself.
        let in_order =
            measurement.at > self.epoch || (self.accepted == 0 && measurement.at == self.epoch);
        if in_order { Ok(()) } else { Err(MeasurementRefusal::NotAfter(self.epoch)) }
    }

    fn propagated(&self, at: Instant) -> ErrorCovariance {
        let mut covariance = self.covariance;
        covariance.propagate(at.since(self.epoch).seconds(), &self.settings.walks());
        covariance
    }
}

/// What a nominal strategy is known by.
fn identity(scan: &ScanStrategy) -> u32 {
    checksum(&scan.parameters().to_le_bytes())
}

/// What is known before any measurement.
fn prior(scan: &ScanStrategy, settings: &TrackerSettings) -> ErrorCovariance {
    let [a, alpha, b] = settings.angle_sigmas_rad;
    let [a_rate, b_rate] = settings.rate_sigmas;
    let parameters = scan.parameters();
    let a_rate = a_rate * parameters.precession.rate.radians_per_second();
    let b_rate = b_rate * parameters.spin.rate.radians_per_second();
    ErrorCovariance::diagonal([a, alpha, b, a_rate, b_rate].map(|sigma| sigma * sigma))
}

/// A rotor with its rate moved, and its phase moved so that it holds exactly after `elapsed`.
#[inline(never)]
fn anchored(rotor: Rotor, elapsed: Duration, error: f64, rate_error: f64) -> Rotor {
    let rate = rotor.rate.plus(TurnRate::from_radians_per_second(rate_error));
    let here = rotor.phase(elapsed).plus(Phase::from_radians(error));
    Rotor { rate, start: here.plus(rate.after(elapsed).negated()) }
}

/// The strategy moved by the errors at `at`: rates first, then phases anchored so that they hold
/// exactly there.
fn corrected(scan: &ScanStrategy, errors: &Errors, at: Instant) -> ScanParameters {
    let [precession, alpha, spin, precession_rate, spin_rate] = *errors;
    let elapsed = scan.elapsed(at);
    let old = *scan.parameters();
    let turned = |rotor, error, rate_error| anchored(rotor, elapsed, error, rate_error);
    ScanParameters {
        alpha_rad: old.alpha_rad + alpha,
        precession: turned(old.precession, precession, precession_rate),
        spin: turned(old.spin, spin, spin_rate),
        ..old
    }
}

/// Variances of the three independent numbers that a measured attitude gives.
struct Noise {
    sum: f64,
    alpha: f64,
    difference: f64,
}

impl Noise {
    /// Of a + b, alpha and a - b, for `sigma` rad about each axis.
    fn new(sigma: f64, alpha_rad: f64) -> Self {
        let (sin_half, cos_half) = trigonometry::sin_cos(0.5 * alpha_rad);
        let over = |divisor: f64| (sigma / divisor) * (sigma / divisor);
        Self { sum: over(cos_half), alpha: sigma * sigma, difference: over(sin_half) }
    }

    /// Standard deviations of the residuals of precession phase, alpha and spin phase.
    fn with(&self, covariance: &ErrorCovariance) -> [f64; 3] {
        let [a, alpha, b] = covariance.angles().variances;
        let phase = 0.25 * (self.sum + self.difference);
        [a + phase, alpha + self.alpha, b + phase].map(libm::sqrt)
    }

    /// Takes the three in, one after the other; answers their chi^2.
    fn observe(
        &self,
        covariance: &mut ErrorCovariance,
        errors: &mut Errors,
        [a, alpha, b]: [f64; 3],
    ) -> f64 {
        let sum = covariance.observe(errors, &[1.0, 0.0, 1.0, 0.0, 0.0], a + b, self.sum);
        let tilt = covariance.observe(errors, &[0.0, 1.0, 0.0, 0.0, 0.0], alpha, self.alpha);
        let difference =
            covariance.observe(errors, &[1.0, 0.0, -1.0, 0.0, 0.0], a - b, self.difference);
        sum + tilt + difference
    }
}
