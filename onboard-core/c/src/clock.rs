//! Clock correlations: a counter's ticks to TAI.

use crate::error::gyr_error_t;
use crate::memory::{State, answer, content, content_or_none, fill, output, record};
use onboard_core::clock::{CLOCK_BYTES, ClockCorrelation};

/// Bytes of a clock correlation's record.
pub const GYR_CLOCK_BYTES: usize = 72;
const _: () = assert!(GYR_CLOCK_BYTES == CLOCK_BYTES);

/// 64-bit words of a gyr_clock_t.
pub const GYR_CLOCK_WORDS: usize = 14;

/// A checked clock correlation; made by gyr_clock_read, holds no pointer.
#[repr(C)]
pub struct gyr_clock_t {
    opaque: [u64; GYR_CLOCK_WORDS],
}

impl State for gyr_clock_t {
    type Content = ClockCorrelation;
    const KIND: [u8; 8] = *b"gyrclock";
}

const _: () = assert!(<gyr_clock_t as State>::FITS);

/// Reads a record of GYR_CLOCK_BYTES bytes for this spacecraft (the identity in the tables' header).
/// `active` is the correlation in use, whose number the new one's must exceed, by 1000 at most; null
/// where there is none, which counts as 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_clock_read(
    bytes: *const u8,
    length: usize,
    active: *const gyr_clock_t,
    spacecraft: u32,
    clock: *mut gyr_clock_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let record = unsafe { record::<CLOCK_BYTES>(bytes, length) }?;
        // SAFETY: as above.
        let active = unsafe { content_or_none(active) }?;
        let newer = ClockCorrelation::from_le_bytes(record)?.replacing(active, spacecraft)?;
        // SAFETY: as above.
        unsafe { fill(clock, newer) }
    })
}

/// The TAI instant at which the counter stands at `ticks`, in ns since 2000-01-01T12:00:00 TAI.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_clock_instant(
    clock: *const gyr_clock_t,
    ticks: u64,
    tai_ns: *mut i64,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let clock = unsafe { content(clock) }?;
        let at = clock.instant(ticks)?;
        // SAFETY: as above.
        unsafe { output(tai_ns, at.tai_ns()) }
    })
}
