//! The forecast: when each target is seen next, and how sure that is.

use crate::attitude::gyr_strategy_t;
use crate::error::gyr_error_t;
use crate::memory::{
    State, answer, content, content_mut, content_or_none, fill, input, output, writable,
};
use crate::tables::gyr_tables_t;
use crate::tracker::gyr_tracker_t;
use crate::transits::{
    GYR_CHANNELS, GYR_STEP_DONE, GYR_STEP_SEARCHED, Searches, gyr_channel_t, gyr_transit_t,
};
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::transit::Transit;
use onboard_core::uncertainty::ScanCovariance;

/// 64-bit words of a gyr_forecast_t.
pub const GYR_FORECAST_WORDS: usize = 1120;

/// The next visit of up to GYR_CHANNELS targets, a channel each. It belongs to the tables it was
/// made with and is given them at every step.
#[repr(C)]
pub struct gyr_forecast_t {
    opaque: [u64; GYR_FORECAST_WORDS],
}

/// A forecast between two steps.
pub(crate) struct Visits {
    search: Searches,
    next: [Option<NextVisit>; GYR_CHANNELS],
    waiting: Option<Transit>,
}

impl State for gyr_forecast_t {
    type Content = Visits;
    const KIND: [u8; 8] = *b"gyrforec";
}

const _: () = assert!(<gyr_forecast_t as State>::FITS);

/// A gyr_forecast_step_t says that a target has its next visit.
pub const GYR_STEP_FOUND: u32 = 4;

/// What one step of a forecast brought.
#[repr(C)]
pub struct gyr_forecast_step_t {
    /// One of GYR_STEP_FOUND, GYR_STEP_SEARCHED, GYR_STEP_DONE.
    pub kind: u32,
    /// The target's index, with GYR_STEP_FOUND.
    pub target: u32,
    /// No visit that is still to come begins before this instant, ns of TAI, with GYR_STEP_SEARCHED.
    pub searched_tai_ns: i64,
}

/// A predicted visit and how well it is known.
#[repr(C)]
pub struct gyr_next_visit_t {
    /// The visit.
    pub transit: gyr_transit_t,
    /// Standard deviations of entry, exit and closest approach, s.
    pub entry_sigma_s: f64,
    /// See `entry_sigma_s`.
    pub exit_sigma_s: f64,
    /// See `entry_sigma_s`.
    pub closest_sigma_s: f64,
    /// Standard deviation of the track's offset across the scan, rad.
    pub separation_sigma_rad: f64,
    /// Probability that the target enters the field of view at all in this passage.
    pub probability: f64,
    /// Entry less 1.96 standard deviations, ns of TAI.
    pub earliest_entry_tai_ns: i64,
    /// Exit plus 1.96 standard deviations, ns of TAI.
    pub latest_exit_tai_ns: i64,
}

impl From<&NextVisit> for gyr_next_visit_t {
    fn from(next: &NextVisit) -> Self {
        let sure = &next.confidence;
        Self {
            transit: (&next.transit).into(),
            entry_sigma_s: sure.entry_sigma_s,
            exit_sigma_s: sure.exit_sigma_s,
            closest_sigma_s: sure.closest_sigma_s,
            separation_sigma_rad: sure.separation_sigma_rad,
            probability: sure.probability,
            earliest_entry_tai_ns: sure.earliest_entry.tai_ns(),
            latest_exit_tai_ns: sure.latest_exit.tai_ns(),
        }
    }
}

/// Makes a forecast without targets on these tables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_forecast_init(
    forecast: *mut gyr_forecast_t,
    tables: *const gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let made_with = unsafe { content(tables) }?.identity();
        let made =
            Visits { search: Searches::new(made_with), next: [None; GYR_CHANNELS], waiting: None };
        // SAFETY: as above.
        unsafe { fill(forecast, made) }
    })
}

/// Adds a target; its index is the number of targets before. The strategy is copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_forecast_add(
    forecast: *mut gyr_forecast_t,
    tables: *const gyr_tables_t,
    strategy: *const gyr_strategy_t,
    channel: *const gyr_channel_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let loaded = unsafe { content(tables) }?;
        // SAFETY: as above.
        let strategy = unsafe { content(strategy) }?;
        // SAFETY: as above.
        let given = unsafe { input(channel) }?;
        // SAFETY: as above.
        unsafe { content_mut(forecast) }?.search.add(loaded, strategy, given)
    })
}

/// Searches on by a bounded amount of work, or judges a visit by the tracker's covariance. Without a
/// tracker (null) the strategy counts as known exactly.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_forecast_step(
    forecast: *mut gyr_forecast_t,
    tables: *const gyr_tables_t,
    tracker: *const gyr_tracker_t,
    result: *mut gyr_forecast_step_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let loaded = unsafe { content(tables) }?;
        // SAFETY: as above.
        let tracker = unsafe { content_or_none(tracker) }?;
        // SAFETY: as above.
        let own = unsafe { content_mut(forecast) }?;
        loaded.check(&own.search.made_with)?;
        writable(result)?;
        let targets = own.search.channels.len();
        let next = own.next.get_mut(..targets).ok_or(gyr_error_t::GYR_ARGUMENT_STATE)?;
        let mut going = Forecast::resume(&mut own.search.channels, next, own.waiting);
        let step = going
            .step(|at| tracker.map_or(ScanCovariance::ZERO, |tracker| tracker.covariance_at(at)));
        own.waiting = going.waiting();
        let (kind, target, searched_tai_ns) = match step {
            ForecastStep::Found(target) => {
                (GYR_STEP_FOUND, u32::try_from(target).unwrap_or(u32::MAX), 0)
            }
            ForecastStep::Searched(until) => (GYR_STEP_SEARCHED, 0, until.tai_ns()),
            ForecastStep::Done => (GYR_STEP_DONE, 0, 0),
            ForecastStep::Failed { error, .. } => return Err(error.into()),
        };
        // SAFETY: as above.
        unsafe { output(result, gyr_forecast_step_t { kind, target, searched_tai_ns }) }
    })
}

/// The next visit of a target, as far as it is known: GYR_NOTHING until it is found.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_forecast_next(
    forecast: *const gyr_forecast_t,
    target: u32,
    visit: *mut gyr_next_visit_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(forecast) }?;
        let index = usize::try_from(target).unwrap_or(usize::MAX);
        if index >= own.search.channels.len() {
            return Err(gyr_error_t::GYR_ARGUMENT_RANGE);
        }
        let Some(Some(next)) = own.next.get(index) else { return Err(gyr_error_t::GYR_NOTHING) };
        // SAFETY: as above.
        unsafe { output(visit, next.into()) }
    })
}
