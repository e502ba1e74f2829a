//! The tracker: measured attitudes correct the strategy.

use crate::attitude::gyr_strategy_t;
use crate::error::gyr_error_t;
use crate::memory::{
    State, answer, content, content_mut, fill, input, output, output_or_none, record, record_mut,
    writable,
};
use crate::tables::{gyr_quaternion_t, gyr_tables_t};
use onboard_core::time::{Duration, Instant};
use onboard_core::tracking::{
    Measurement, MeasurementRefusal, Residuals, TRACKER_BYTES, Tracker, TrackerSettings,
    TrackerState,
};

/// Bytes of a saved tracker.
pub const GYR_TRACKER_BYTES: usize = 228;
const _: () = assert!(GYR_TRACKER_BYTES == TRACKER_BYTES);

/// 64-bit words of a gyr_tracker_t.
pub const GYR_TRACKER_WORDS: usize = 72;

/// The best known scan, and how well it is known; holds no pointer.
#[repr(C)]
pub struct gyr_tracker_t {
    opaque: [u64; GYR_TRACKER_WORDS],
}

impl State for gyr_tracker_t {
    type Content = Tracker;
    const KIND: [u8; 8] = *b"gyrtrack";
}

const _: () = assert!(<gyr_tracker_t as State>::FITS);

/// What the tracker is told. Angles stand in the order precession phase, alpha, spin phase; rates in
/// the order precession, spin.
#[repr(C)]
pub struct gyr_tracker_settings_t {
    /// Standard deviations of the angles before any measurement, rad; in [0, 0.5].
    pub angle_sigmas_rad: [f64; 3],
    /// Standard deviations of the rates before any measurement, relative; in [0, 0.01].
    pub rate_sigmas: [f64; 2],
    /// Random walks of the angles, rad/s^(1/2); in [0, 1e-3].
    pub angle_walks: [f64; 3],
    /// Random walks of the rates, rad/s^(3/2); in [0, 1e-6].
    pub rate_walks: [f64; 2],
    /// Oldest measurement that is used, ns; positive.
    pub max_age_ns: i64,
    /// How far a measurement may lie ahead of now, ns; not negative.
    pub max_lead_ns: i64,
    /// Largest chi^2 that is not an outlier; in [1, 1e4].
    pub gate: f64,
    /// Largest correction of each angle by one measurement, rad; in (0, pi/2].
    pub limits_rad: [f64; 3],
}

/// A measured attitude.
#[repr(C)]
pub struct gyr_measurement_t {
    /// When it was, ns of TAI.
    pub at_tai_ns: i64,
    /// From the mission boresight frame to the ecliptic.
    pub attitude: gyr_quaternion_t,
    /// Standard deviation of the noise about each axis, rad.
    pub sigma_rad: f64,
}

/// What a measurement showed against the model: precession phase, alpha, spin phase.
#[repr(C)]
pub struct gyr_residuals_t {
    /// Measured minus modelled, rad.
    pub innovation_rad: [f64; 3],
    /// Their standard deviations, of model and noise together, rad.
    pub sigma_rad: [f64; 3],
    /// Chi^2 of the three together.
    pub chi2: f64,
}

/// Covariance of the errors in precession phase, alpha and spin phase, rad^2.
#[repr(C)]
pub struct gyr_covariance_t {
    /// Variances.
    pub variances: [f64; 3],
    /// Precession phase with alpha, precession phase with spin phase, alpha with spin phase.
    pub covariances: [f64; 3],
}

/// How the tracker stands.
#[repr(C)]
pub struct gyr_tracker_status_t {
    /// Instant of the last accepted measurement, or the epoch when there is none, ns of TAI.
    pub epoch_tai_ns: i64,
    /// Standard deviations of precession and spin rate, rad/s.
    pub rate_sigmas_rad_s: [f64; 2],
    /// Accepted measurements since the start.
    pub accepted: u32,
    /// Refused measurements since the last accepted one.
    pub refused_in_a_row: u32,
}

impl From<&gyr_tracker_settings_t> for TrackerSettings {
    fn from(given: &gyr_tracker_settings_t) -> Self {
        Self {
            angle_sigmas_rad: given.angle_sigmas_rad,
            rate_sigmas: given.rate_sigmas,
            angle_walks: given.angle_walks,
            rate_walks: given.rate_walks,
            max_age: Duration::from_ns(given.max_age_ns),
            max_lead: Duration::from_ns(given.max_lead_ns),
            gate: given.gate,
            limits_rad: given.limits_rad,
        }
    }
}

impl From<Residuals> for gyr_residuals_t {
    fn from(residuals: Residuals) -> Self {
        Self {
            innovation_rad: residuals.innovation_rad,
            sigma_rad: residuals.sigma_rad,
            chi2: residuals.chi2,
        }
    }
}

/// Makes a tracker that knows `strategy` at the epoch as well as the settings say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_init(
    tracker: *mut gyr_tracker_t,
    strategy: *const gyr_strategy_t,
    settings: *const gyr_tracker_settings_t,
    epoch_tai_ns: i64,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let strategy = unsafe { content(strategy) }?;
        // SAFETY: as above.
        let settings = unsafe { input(settings) }?.into();
        let made = Tracker::new(strategy, &settings, Instant::from_tai_ns(epoch_tai_ns))?;
        // SAFETY: as above.
        unsafe { fill(tracker, made) }
    })
}

/// Forgets everything and begins anew: the way out when every measurement is refused.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_restart(
    tracker: *mut gyr_tracker_t,
    strategy: *const gyr_strategy_t,
    epoch_tai_ns: i64,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let strategy = unsafe { content(strategy) }?;
        // SAFETY: as above.
        unsafe { content_mut(tracker) }?.restart(strategy, Instant::from_tai_ns(epoch_tai_ns));
        Ok(())
    })
}

/// Corrects the strategy by a measured attitude. `residuals` may be null; it is written where the
/// measurement is accepted and where it is an outlier.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_update(
    tracker: *mut gyr_tracker_t,
    tables: *const gyr_tables_t,
    measurement: *const gyr_measurement_t,
    now_tai_ns: i64,
    residuals: *mut gyr_residuals_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let sun = unsafe { content(tables) }?.sun()?;
        // SAFETY: as above.
        let given = unsafe { input(measurement) }?;
        let measurement = Measurement {
            at: Instant::from_tai_ns(given.at_tai_ns),
            attitude: given.attitude.rotation()?,
            sigma_rad: given.sigma_rad,
        };
        if !residuals.is_null() {
            writable(residuals)?;
        }
        // SAFETY: as above.
        let tracker = unsafe { content_mut(tracker) }?;
        let result = tracker.update(&sun, &measurement, Instant::from_tai_ns(now_tai_ns));
        if let Ok(found) | Err(MeasurementRefusal::Outlier(found)) = result {
            // SAFETY: as above.
            unsafe { output_or_none(residuals, found.into()) }?;
        }
        result.map(drop).map_err(gyr_error_t::from)
    })
}

/// The strategy as corrected by all accepted measurements.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_strategy(
    tracker: *const gyr_tracker_t,
    strategy: *mut gyr_strategy_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = *unsafe { content(tracker) }?.strategy();
        // SAFETY: as above.
        unsafe { fill(strategy, own) }
    })
}

/// How well the angles of the strategy are known at an instant.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_covariance(
    tracker: *const gyr_tracker_t,
    at_tai_ns: i64,
    covariance: *mut gyr_covariance_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let tracker = unsafe { content(tracker) }?;
        let known = tracker.covariance_at(Instant::from_tai_ns(at_tai_ns));
        let answer =
            gyr_covariance_t { variances: known.variances, covariances: known.covariances };
        // SAFETY: as above.
        unsafe { output(covariance, answer) }
    })
}

/// How the tracker stands.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_status(
    tracker: *const gyr_tracker_t,
    status: *mut gyr_tracker_status_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let tracker = unsafe { content(tracker) }?;
        let answer = gyr_tracker_status_t {
            epoch_tai_ns: tracker.epoch().tai_ns(),
            rate_sigmas_rad_s: tracker.rate_sigmas_rad_s(),
            accepted: tracker.accepted(),
            refused_in_a_row: tracker.refused_in_a_row(),
        };
        // SAFETY: as above.
        unsafe { output(status, answer) }
    })
}

/// Writes the record of GYR_TRACKER_BYTES bytes to keep through a reset, for this spacecraft (the
/// identity in the tables' header).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_save(
    tracker: *const gyr_tracker_t,
    spacecraft: u32,
    bytes: *mut u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(tracker) }?;
        // SAFETY: as above.
        let place = unsafe { record_mut::<TRACKER_BYTES>(bytes, length) }?;
        *place = own.state().to_le_bytes(spacecraft);
        Ok(())
    })
}

/// Goes on with the same bits from a saved record, in a tracker that gyr_tracker_init or
/// gyr_tracker_restart made with the same strategy as the saved one was. A refused record changes
/// nothing: begin anew.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_tracker_resume(
    tracker: *mut gyr_tracker_t,
    spacecraft: u32,
    bytes: *const u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let saved = unsafe { record::<TRACKER_BYTES>(bytes, length) }?;
        let state = TrackerState::from_le_bytes(saved, spacecraft)?;
        // SAFETY: as above.
        Ok(unsafe { content_mut(tracker) }?.resume(&state)?)
    })
}
