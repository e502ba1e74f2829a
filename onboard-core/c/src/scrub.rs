//! The scrub: are the tables in use still what they were when they were loaded.

use crate::error::gyr_error_t;
use crate::memory::{State, answer, content, content_mut, fill, output, writable};
use crate::tables::{Identity, gyr_tables_t};
use onboard_core::uplink::{Scrub, ScrubStep};

/// 64-bit words of a gyr_scrub_t.
pub const GYR_SCRUB_WORDS: usize = 16;

/// A scrub of the container that tables were made of. It belongs to the tables it was made with and is
/// given them at every step.
#[repr(C)]
pub struct gyr_scrub_t {
    opaque: [u64; GYR_SCRUB_WORDS],
}

/// A scrub between two steps.
pub(crate) struct Watched {
    made_with: Identity,
    /// Its borrow is used only in calls that are given the same tables.
    pub(crate) scrub: Scrub<'static>,
}

impl State for gyr_scrub_t {
    type Content = Watched;
    const KIND: [u8; 8] = *b"gyrscrub";
}

const _: () = assert!(<gyr_scrub_t as State>::FITS);

/// Nothing so far; the round goes on.
pub const GYR_SCRUB_GOES_ON: u32 = 1;
/// A round is over and nothing was found.
pub const GYR_SCRUB_ROUND_OVER: u32 = 2;
/// The container is damaged: unload the tables, tell the sequencer, and ask the slots anew.
pub const GYR_SCRUB_DAMAGED: u32 = 3;

/// What a step found.
#[repr(C)]
pub struct gyr_scrub_step_t {
    /// One of GYR_SCRUB_GOES_ON, GYR_SCRUB_ROUND_OVER, GYR_SCRUB_DAMAGED.
    pub kind: u32,
    /// What is damaged, with GYR_SCRUB_DAMAGED, else GYR_OK.
    pub damage: gyr_error_t,
}

/// Begins with the first round of these tables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_scrub_init(
    scrub: *mut gyr_scrub_t,
    tables: *const gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let loaded = unsafe { content(tables) }?;
        let made = Watched { made_with: loaded.identity(), scrub: Scrub::new(&loaded.tables) };
        // SAFETY: as above.
        unsafe { fill(scrub, made) }
    })
}

/// Steps after which a flipped bit is found at the latest: two rounds.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_scrub_longest(
    scrub: *const gyr_scrub_t,
    steps: *mut u32,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let longest = unsafe { content(scrub) }?.scrub.longest();
        // SAFETY: as above.
        unsafe { output(steps, longest) }
    })
}

/// Looks at the next 256 bytes at most; after the last the next round begins.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_scrub_step(
    scrub: *mut gyr_scrub_t,
    tables: *const gyr_tables_t,
    result: *mut gyr_scrub_step_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let loaded = unsafe { content(tables) }?;
        // SAFETY: as above.
        let own = unsafe { content_mut(scrub) }?;
        loaded.check(&own.made_with)?;
        // Before the step, so that a finding cannot be lost.
        writable(result)?;
        let (kind, damage) = match own.scrub.step() {
            ScrubStep::GoesOn => (GYR_SCRUB_GOES_ON, gyr_error_t::GYR_OK),
            ScrubStep::RoundOver => (GYR_SCRUB_ROUND_OVER, gyr_error_t::GYR_OK),
            ScrubStep::Damaged(error) => (GYR_SCRUB_DAMAGED, error.into()),
        };
        // SAFETY: as above.
        unsafe { output(result, gyr_scrub_step_t { kind, damage }) }
    })
}
