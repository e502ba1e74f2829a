//! What every payload begins with.

use super::code::Reason;
use super::words::LAYOUT_VERSION;
use crate::clock::ClockCorrelation;
use crate::convert::bits_from_i64;
use crate::time::Instant;

/// Words that every payload begins with.
pub(super) const HEAD: usize = 12;
/// Their bytes: version, kind, telescope, spacecraft, counter, instant, what is there, state, reason,
/// session, value, second value.
pub(super) const HEAD_SIZES: [u8; HEAD] = [1, 1, 2, 4, 8, 8, 1, 1, 2, 4, 8, 8];
/// The instant is known.
pub(super) const INSTANT_KNOWN: u8 = 1;

/// Whose report it is, and of when.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// Identity of the spacecraft, as in a container's header.
    pub spacecraft: u32,
    /// Index of the sequencer's telescope in the mission.
    pub telescope: u16,
    /// The on-board counter.
    pub ticks: u64,
    /// The counter's instant, where there was a clock correlation that answered.
    pub at: Option<Instant>,
}

impl Origin {
    /// At the counter `ticks`, whose instant the clock correlation tells where it can.
    #[must_use]
    pub fn new(
        spacecraft: u32,
        telescope: u16,
        ticks: u64,
        clock: Option<&ClockCorrelation>,
    ) -> Self {
        let at = clock.and_then(|clock| clock.instant(ticks).ok());
        Self { spacecraft, telescope, ticks, at }
    }

    /// The words up to the second value; `there` says what else is there.
    #[inline(never)]
    pub(super) fn head(
        &self,
        (kind, there): (u8, u8),
        (state, session, reason): (u8, u32, Reason),
    ) -> [u64; HEAD] {
        let known = if self.at.is_some() { INSTANT_KNOWN } else { 0 };
        [
            LAYOUT_VERSION.into(),
            kind.into(),
            self.telescope.into(),
            self.spacecraft.into(),
            self.ticks,
            self.at.map_or(0, instant),
            (known | there).into(),
            state.into(),
            reason.code.into(),
            session.into(),
            bits_from_i64(reason.value),
            bits_from_i64(reason.second),
        ]
    }
}

/// An instant's word.
pub(super) const fn instant(at: Instant) -> u64 {
    bits_from_i64(at.tai_ns())
}
