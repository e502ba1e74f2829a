//! One target against one field of view.

use super::Transit;
use super::reach::Reach;
use super::search::{Lookup, Search, SearchState};
use super::sight::{Motion, Seen, Sight};
use crate::ephemeris::{BodyTable, EphemerisError};
use crate::field_of_view::FieldOfView;
use crate::scan::ScanStrategy;
use crate::sun::SunModel;
use crate::time::Instant;

/// A search for one target in one field of view.
#[derive(Debug, Clone, Copy)]
pub struct Channel<'a> {
    search: Search,
    sun: SunModel<'a>,
    target: BodyTable<'a>,
    part: Part,
}

/// How a finder treats a channel, in the order in which it turns to them; not part of the state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// Searched in turn.
    Active,
    /// Could not be evaluated: tried again once no other channel is left.
    Failed,
    /// No longer wanted.
    Retired,
}

impl<'a> Channel<'a> {
    /// A search from `start` to `end`, both included.
    #[must_use]
    #[inline(never)]
    pub fn new(
        scan: &ScanStrategy,
        sun: SunModel<'a>,
        target: BodyTable<'a>,
        field: &FieldOfView,
        ends: (Instant, Instant),
    ) -> Self {
        let search = Search::new(scan, &Lookup { sun: &sun, target }, field, ends);
        Self { search, sun, target, part: Part::Active }
    }

    /// What to save, so that [`Self::resume`] goes on with the same bits.
    #[must_use]
    pub const fn state(&self) -> SearchState {
        self.search.state()
    }

    /// Goes on from a saved state of the same search.
    pub const fn resume(&mut self, state: SearchState) {
        self.search.resume(state);
        self.part = Part::Active;
    }

    /// Evaluations (Sun, target and phases at one instant) made so far; not part of the state.
    #[must_use]
    pub const fn evaluations(&self) -> u64 {
        self.search.evaluations()
    }

    /// No transit that is still to come from this channel begins before this instant.
    #[must_use]
    pub const fn frontier(&self) -> Option<Instant> {
        self.search.frontier()
    }

    /// How the finder treats this channel.
    pub(super) const fn part(&self) -> Part {
        self.part
    }

    #[inline(never)]
    pub(super) const fn set_part(&mut self, part: Part) {
        self.part = part;
    }

    /// Takes back a transit that was taken just before.
    pub(super) const fn take_back(&mut self, transit: Transit) {
        self.search.take_back(transit);
    }

    /// Whether a whole transit waits to be taken.
    pub(super) const fn has_found(&self) -> bool {
        self.search.has_found()
    }

    /// Takes the transit that waits.
    pub(super) fn take(&mut self) -> Option<Transit> {
        self.search.take()
    }

    /// Searches on by one certified span.
    pub(super) fn advance(&mut self, seen: &mut Seen) -> Result<(), EphemerisError> {
        self.search.advance(&Lookup { sun: &self.sun, target: self.target }, seen)
    }

    /// The target at any instant; not counted.
    pub(super) fn sight_at(&self, at: Instant) -> Result<Sight, EphemerisError> {
        self.search.sight_at(at, &Lookup { sun: &self.sun, target: self.target })
    }

    pub(super) const fn motion(&self) -> &Motion {
        self.search.motion()
    }

    pub(super) const fn reach(&self) -> &Reach {
        self.search.reach()
    }
}
