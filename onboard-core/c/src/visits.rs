//! The visit log: counts and histograms of transits, per target.

use crate::error::gyr_error_t;
use crate::memory::{State, answer, content, content_mut, fill, input, output, record, record_mut};
use crate::transits::gyr_transit_t;
use onboard_core::saved_visits::visits_record_bytes;
use onboard_core::time::Duration;
use onboard_core::transit::Transit;
use onboard_core::visits::{Bins, Divisions, Histogram, Spacing, TargetVisits, VisitLog};

/// Targets of a visit log.
pub const GYR_VISIT_TARGETS: usize = 8;
/// Bins of each histogram.
pub const GYR_VISIT_BINS: usize = 20;
/// Bytes of a target's saved visits.
pub const GYR_VISIT_BYTES: usize = 336;
const _: () = assert!(GYR_VISIT_BYTES == visits_record_bytes(GYR_VISIT_BINS));

/// 64-bit words of a gyr_visit_log_t.
pub const GYR_VISIT_LOG_WORDS: usize = 368;

/// Running statistics of the visits of GYR_VISIT_TARGETS targets; holds no pointer.
#[repr(C)]
pub struct gyr_visit_log_t {
    opaque: [u64; GYR_VISIT_LOG_WORDS],
}

/// A log between two calls.
pub(crate) struct Kept {
    divisions: Divisions,
    targets: [TargetVisits<GYR_VISIT_BINS>; GYR_VISIT_TARGETS],
}

impl State for gyr_visit_log_t {
    type Content = Kept;
    const KIND: [u8; 8] = *b"gyrvisit";
}

const _: () = assert!(<gyr_visit_log_t as State>::FITS);

/// Bins of equal widths.
pub const GYR_BINS_LINEAR: u32 = 1;
/// Bins of equal ratios.
pub const GYR_BINS_LOGARITHMIC: u32 = 2;

/// The range of a histogram and how it is divided into GYR_VISIT_BINS bins.
#[repr(C)]
pub struct gyr_bins_t {
    /// GYR_BINS_LINEAR or GYR_BINS_LOGARITHMIC.
    pub spacing: u32,
    /// Lower end, s.
    pub low_s: f64,
    /// Upper end, s.
    pub high_s: f64,
}

/// The bins of the three histograms.
#[repr(C)]
pub struct gyr_divisions_t {
    /// Of dwells: exit less entry.
    pub dwell: gyr_bins_t,
    /// Of revisits: next entry less entry.
    pub revisit: gyr_bins_t,
    /// Of gaps: next entry less exit.
    pub gap: gyr_bins_t,
}

/// Counts of values by bin.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct gyr_histogram_t {
    /// Values in each bin.
    pub counts: [u32; GYR_VISIT_BINS],
    /// Values below the first bin.
    pub under: u32,
    /// Values at or above the end of the last bin.
    pub over: u32,
}

/// What is known of one target's visits.
#[repr(C)]
pub struct gyr_target_visits_t {
    /// Sum of the dwells of whole visits, ns.
    pub dwell_sum_ns: i64,
    /// Longest gap between an exit and the next entry, ns; -1 where there is none.
    pub longest_gap_ns: i64,
    /// Entry of the last visit, ns of TAI.
    pub last_entry_tai_ns: i64,
    /// Exit of the last visit, ns of TAI.
    pub last_exit_tai_ns: i64,
    /// Visits, clipped ones included.
    pub visits: u32,
    /// Visits whose entry or exit is a search's start or end.
    pub clipped: u32,
    /// 1 where there is a last visit, else 0.
    pub has_last: u32,
    /// 1 where the last visit's entry is a search's start, else 0.
    pub last_entry_clipped: u32,
    /// 1 where the last visit's exit is a search's end, else 0.
    pub last_exit_clipped: u32,
    /// Dwells of whole visits.
    pub dwell: gyr_histogram_t,
    /// Spans from entry to next entry, both whole.
    pub revisit: gyr_histogram_t,
    /// Spans from exit to next entry, both whole.
    pub gap: gyr_histogram_t,
}

impl gyr_bins_t {
    fn bins(&self) -> Result<Bins, gyr_error_t> {
        let spacing = match self.spacing {
            GYR_BINS_LINEAR => Spacing::Linear,
            GYR_BINS_LOGARITHMIC => Spacing::Logarithmic,
            _ => return Err(gyr_error_t::GYR_ARGUMENT_RANGE),
        };
        Ok(Bins::new(spacing, self.low_s, self.high_s)?)
    }
}

impl From<Histogram<GYR_VISIT_BINS>> for gyr_histogram_t {
    fn from(own: Histogram<GYR_VISIT_BINS>) -> Self {
        Self { counts: own.counts, under: own.under, over: own.over }
    }
}

impl From<&TargetVisits<GYR_VISIT_BINS>> for gyr_target_visits_t {
    fn from(own: &TargetVisits<GYR_VISIT_BINS>) -> Self {
        let last = own.last;
        Self {
            dwell_sum_ns: own.dwell_sum.ns(),
            longest_gap_ns: own.longest_gap.map_or(-1, Duration::ns),
            last_entry_tai_ns: last.map_or(0, |last| last.entry.tai_ns()),
            last_exit_tai_ns: last.map_or(0, |last| last.exit.tai_ns()),
            visits: own.visits,
            clipped: own.clipped,
            has_last: last.is_some().into(),
            last_entry_clipped: last.is_some_and(|last| last.entry_clipped).into(),
            last_exit_clipped: last.is_some_and(|last| last.exit_clipped).into(),
            dwell: own.dwell.into(),
            revisit: own.revisit.into(),
            gap: own.gap.into(),
        }
    }
}

/// Makes a log without visits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_visit_log_init(
    log: *mut gyr_visit_log_t,
    divisions: *const gyr_divisions_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let given = unsafe { input(divisions) }?;
        let divisions = Divisions {
            dwell: given.dwell.bins()?,
            revisit: given.revisit.bins()?,
            gap: given.gap.bins()?,
        };
        let made = Kept { divisions, targets: [TargetVisits::EMPTY; GYR_VISIT_TARGETS] };
        // SAFETY: as above.
        unsafe { fill(log, made) }
    })
}

/// Counts a visit; a target's visits come in order of entry. A refused one leaves the log as it was.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_visit_log_record(
    log: *mut gyr_visit_log_t,
    target: u32,
    transit: *const gyr_transit_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let transit = Transit::from(unsafe { input(transit) }?);
        // SAFETY: as above.
        let own = unsafe { content_mut(log) }?;
        let target = usize::try_from(target).unwrap_or(usize::MAX);
        Ok(VisitLog::new(&own.divisions, &mut own.targets).record(target, &transit)?)
    })
}

/// What is known of a target's visits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_visit_log_get(
    log: *const gyr_visit_log_t,
    target: u32,
    visits: *mut gyr_target_visits_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(log) }?;
        let index = usize::try_from(target).unwrap_or(usize::MAX);
        let found = own.targets.get(index).ok_or(gyr_error_t::GYR_VISIT_NO_SUCH_TARGET)?;
        // SAFETY: as above.
        unsafe { output(visits, found.into()) }
    })
}

/// Writes the record of GYR_VISIT_BYTES bytes to keep of a target through a reset, for this spacecraft
/// (the identity in the tables' header).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_visit_log_save(
    log: *const gyr_visit_log_t,
    target: u32,
    spacecraft: u32,
    bytes: *mut u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(log) }?;
        let index = usize::try_from(target).unwrap_or(usize::MAX);
        let found = own.targets.get(index).ok_or(gyr_error_t::GYR_VISIT_NO_SUCH_TARGET)?;
        // SAFETY: as above.
        let record = unsafe { record_mut::<GYR_VISIT_BYTES>(bytes, length) }?;
        Ok(found.to_record(&own.divisions, target, spacecraft, record)?)
    })
}

/// Goes on from a saved record of the same target (index) of a log with the same divisions. A refused
/// record changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_visit_log_resume(
    log: *mut gyr_visit_log_t,
    target: u32,
    spacecraft: u32,
    bytes: *const u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let saved = unsafe { record::<GYR_VISIT_BYTES>(bytes, length) }?;
        // SAFETY: as above.
        let own = unsafe { content_mut(log) }?;
        let index = usize::try_from(target).unwrap_or(usize::MAX);
        let place = own.targets.get_mut(index).ok_or(gyr_error_t::GYR_VISIT_NO_SUCH_TARGET)?;
        *place = TargetVisits::from_record(saved, &own.divisions, target, spacecraft)?;
        Ok(())
    })
}
