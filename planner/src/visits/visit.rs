//! A visit: a maximal interval inside, of a circle, a field of view or a pixel.
//!
//! Instants are TAI; both ends are inside.

use onboard_core::ephemeris::EphemerisError;
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, Step, Transit, TransitFinder};

/// A maximal interval inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Visit {
    /// First instant inside, or the search's start.
    pub entry: Instant,
    /// Last instant inside, or the search's end.
    pub exit: Instant,
    /// It was inside already at the search's start.
    pub entry_clipped: bool,
    /// It was still inside at the search's end.
    pub exit_clipped: bool,
}

impl Visit {
    /// Time inside.
    #[must_use]
    pub const fn dwell(&self) -> Duration {
        self.exit.since(self.entry)
    }
}

impl From<&Transit> for Visit {
    fn from(transit: &Transit) -> Self {
        Self {
            entry: transit.entry,
            exit: transit.exit,
            entry_clipped: transit.entry_clipped,
            exit_clipped: transit.exit_clipped,
        }
    }
}

/// All transits of one channel, in order.
///
/// # Errors
/// [`EphemerisError`] where the channel's tables do not serve its span.
pub fn transits(channel: Channel<'_>) -> Result<Vec<Transit>, EphemerisError> {
    let mut channels = [channel];
    let mut finder = TransitFinder::new(&mut channels);
    let mut found = Vec::new();
    loop {
        match finder.step() {
            Step::Transit(transit) => found.push(transit),
            Step::Searched(_) => {}
            Step::Done => return Ok(found),
            Step::Failed { error, .. } => return Err(error),
        }
    }
}
