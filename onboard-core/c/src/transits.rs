//! The transit finder: up to eight channels, one stream of transits in order.

use crate::attitude::gyr_strategy_t;
use crate::error::gyr_error_t;
use crate::memory::{
    State, answer, content, content_mut, fill, input, output, record, record_mut, writable,
};
use crate::tables::{Identity, Loaded, gyr_tables_t};
use heapless::Vec;
use onboard_core::scan::ScanStrategy;
use onboard_core::time::Instant;
use onboard_core::transit::{
    Channel, SEARCH_BYTES, SearchOrigin, SearchState, Step, Transit, TransitFinder,
};

/// Most channels of a finder or a forecast.
pub const GYR_CHANNELS: usize = 8;

/// Bytes of a channel's saved search.
pub const GYR_SEARCH_BYTES: usize = 108;
const _: () = assert!(GYR_SEARCH_BYTES == SEARCH_BYTES);

/// 64-bit words of a gyr_finder_t.
pub const GYR_FINDER_WORDS: usize = 960;

/// A search over up to GYR_CHANNELS channels. It belongs to the tables it was made with and is given
/// them at every step.
#[repr(C)]
pub struct gyr_finder_t {
    opaque: [u64; GYR_FINDER_WORDS],
}

/// Channels, and the tables that they look up.
pub(crate) struct Searches {
    pub(crate) made_with: Identity,
    /// Their borrows are used only in calls that are given the same tables.
    pub(crate) channels: Vec<Channel<'static>, GYR_CHANNELS>,
    /// Which search each channel is.
    origins: Vec<SearchOrigin, GYR_CHANNELS>,
}

impl State for gyr_finder_t {
    type Content = Searches;
    const KIND: [u8; 8] = *b"gyrfindr";
}

const _: () = assert!(<gyr_finder_t as State>::FITS);

/// What a channel searches for.
#[repr(C)]
pub struct gyr_channel_t {
    /// Start and end of the search, both included, ns of TAI.
    pub from_tai_ns: i64,
    /// See `from_tai_ns`.
    pub until_tai_ns: i64,
    /// The target's number in the ephemeris.
    pub body: i32,
    /// The telescope's index.
    pub telescope: u16,
    /// Which of the fields it is calibrated through: a listed detector's circle, or 0 for its field
    /// of view where none is listed.
    pub field: u16,
}

/// A maximal interval with the target inside the field of view.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct gyr_transit_t {
    /// First instant inside, or the search's start, ns of TAI.
    pub entry_tai_ns: i64,
    /// Last instant inside, or the search's end, ns of TAI.
    pub exit_tai_ns: i64,
    /// Instant of smallest separation, ns of TAI.
    pub closest_tai_ns: i64,
    /// Separation there, rad.
    pub min_separation_rad: f64,
    /// Index of the channel that found it.
    pub channel: u32,
    /// 1 where the target was inside already at the search's start, else 0.
    pub entry_clipped: u32,
    /// 1 where the target was still inside at the search's end, else 0.
    pub exit_clipped: u32,
}

/// A gyr_step_t brings a transit.
pub const GYR_STEP_TRANSIT: u32 = 1;
/// A gyr_step_t brings nothing yet.
pub const GYR_STEP_SEARCHED: u32 = 2;
/// All channels have reached their end.
pub const GYR_STEP_DONE: u32 = 3;

/// What one step of a search brought.
#[repr(C)]
pub struct gyr_step_t {
    /// One of GYR_STEP_TRANSIT, GYR_STEP_SEARCHED, GYR_STEP_DONE.
    pub kind: u32,
    /// No transit that is still to come begins before this instant, ns of TAI; with
    /// GYR_STEP_SEARCHED alone.
    pub searched_tai_ns: i64,
    /// The next transit in order; with GYR_STEP_TRANSIT alone.
    pub transit: gyr_transit_t,
}

impl gyr_transit_t {
    pub(crate) const NONE: Self = Self {
        entry_tai_ns: 0,
        exit_tai_ns: 0,
        closest_tai_ns: 0,
        min_separation_rad: 0.0,
        channel: 0,
        entry_clipped: 0,
        exit_clipped: 0,
    };
}

impl From<&Transit> for gyr_transit_t {
    fn from(transit: &Transit) -> Self {
        Self {
            entry_tai_ns: transit.entry.tai_ns(),
            exit_tai_ns: transit.exit.tai_ns(),
            closest_tai_ns: transit.closest.tai_ns(),
            min_separation_rad: transit.min_separation_rad,
            channel: u32::try_from(transit.channel).unwrap_or(u32::MAX),
            entry_clipped: transit.entry_clipped.into(),
            exit_clipped: transit.exit_clipped.into(),
        }
    }
}

impl From<&gyr_transit_t> for Transit {
    fn from(given: &gyr_transit_t) -> Self {
        Self {
            channel: usize::try_from(given.channel).unwrap_or(usize::MAX),
            entry: Instant::from_tai_ns(given.entry_tai_ns),
            exit: Instant::from_tai_ns(given.exit_tai_ns),
            closest: Instant::from_tai_ns(given.closest_tai_ns),
            min_separation_rad: given.min_separation_rad,
            entry_clipped: given.entry_clipped != 0,
            exit_clipped: given.exit_clipped != 0,
        }
    }
}

impl Searches {
    pub(crate) const fn new(made_with: Identity) -> Self {
        Self { made_with, channels: Vec::new(), origins: Vec::new() }
    }

    /// Adds what `given` searches for, on these tables.
    #[inline(never)]
    pub(crate) fn add(
        &mut self,
        loaded: &Loaded,
        strategy: &ScanStrategy,
        given: &gyr_channel_t,
    ) -> Result<(), gyr_error_t> {
        loaded.check(&self.made_with)?;
        if self.channels.is_full() {
            return Err(gyr_error_t::GYR_ARGUMENT_FULL);
        }
        let mission = loaded.tables.mission();
        let field = mission
            .calibration_field(given.telescope, given.field)
            .ok_or(gyr_error_t::GYR_ARGUMENT_RANGE)?;
        let ends =
            (Instant::from_tai_ns(given.from_tai_ns), Instant::from_tai_ns(given.until_tai_ns));
        let channel = Channel::new(strategy, loaded.sun()?, loaded.body(given.body)?, &field, ends);
        let (header, digest) = (loaded.tables.header(), loaded.tables.set_digest());
        let origin = SearchOrigin::new(header, digest, strategy, &field, given.body);
        let full = gyr_error_t::GYR_ARGUMENT_FULL;
        self.origins.push(origin).map_err(|_| full)?;
        self.channels.push(channel).map_err(|_| full)
    }

    /// A channel, and which search it is.
    fn channel_mut(
        &mut self,
        index: u32,
    ) -> Result<(&mut Channel<'static>, &SearchOrigin), gyr_error_t> {
        let index = usize::try_from(index).unwrap_or(usize::MAX);
        match (self.channels.get_mut(index), self.origins.get(index)) {
            (Some(channel), Some(origin)) => Ok((channel, origin)),
            _ => Err(gyr_error_t::GYR_ARGUMENT_RANGE),
        }
    }
}

/// Makes a finder without channels on these tables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_finder_init(
    finder: *mut gyr_finder_t,
    tables: *const gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let made_with = unsafe { content(tables) }?.identity();
        // SAFETY: as above.
        unsafe { fill(finder, Searches::new(made_with)) }
    })
}

/// Adds a channel; its index is the number of channels before. The strategy is copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_finder_add(
    finder: *mut gyr_finder_t,
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
        unsafe { content_mut(finder) }?.add(loaded, strategy, given)
    })
}

/// Searches on by a bounded amount of work, or hands out the next transit. Where a channel cannot be
/// evaluated, the ephemeris' refusal is returned once; the channel stands where it was, the others go
/// on in the next steps, and it is tried again when they are done.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_finder_step(
    finder: *mut gyr_finder_t,
    tables: *const gyr_tables_t,
    result: *mut gyr_step_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let loaded = unsafe { content(tables) }?;
        // SAFETY: as above.
        let finder = unsafe { content_mut(finder) }?;
        loaded.check(&finder.made_with)?;
        // Before the step, so that a transit cannot be lost.
        writable(result)?;
        let brought = match TransitFinder::resume(&mut finder.channels).step() {
            Step::Transit(transit) => gyr_step_t {
                kind: GYR_STEP_TRANSIT,
                searched_tai_ns: 0,
                transit: (&transit).into(),
            },
            Step::Searched(until) => gyr_step_t {
                kind: GYR_STEP_SEARCHED,
                searched_tai_ns: until.tai_ns(),
                transit: gyr_transit_t::NONE,
            },
            Step::Done => {
                gyr_step_t { kind: GYR_STEP_DONE, searched_tai_ns: 0, transit: gyr_transit_t::NONE }
            }
            Step::Failed { error, .. } => return Err(error.into()),
        };
        // SAFETY: as above.
        unsafe { output(result, brought) }
    })
}

/// Writes the record of GYR_SEARCH_BYTES bytes to keep of a channel's search through a reset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_finder_save(
    finder: *mut gyr_finder_t,
    channel: u32,
    bytes: *mut u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let (channel, origin) = unsafe { content_mut(finder) }?.channel_mut(channel)?;
        // SAFETY: as above.
        let place = unsafe { record_mut::<SEARCH_BYTES>(bytes, length) }?;
        *place = channel.state().to_le_bytes(origin);
        Ok(())
    })
}

/// Goes on with the same bits from a saved record, in a channel that gyr_finder_add made for the same
/// body, field and strategy on the same tables. A refused record changes nothing: search anew.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_finder_resume(
    finder: *mut gyr_finder_t,
    channel: u32,
    bytes: *const u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let saved = unsafe { record::<SEARCH_BYTES>(bytes, length) }?;
        // SAFETY: as above.
        let (channel, origin) = unsafe { content_mut(finder) }?.channel_mut(channel)?;
        channel.resume(SearchState::from_le_bytes(saved, origin)?);
        Ok(())
    })
}
