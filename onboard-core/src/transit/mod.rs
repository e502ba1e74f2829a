//! When does a target cross a field of view: every transit, none invented, no sampling.
//!
//! A [`Channel`] searches one target against one [`FieldOfView`](crate::field_of_view::FieldOfView);
//! a [`TransitFinder`] runs any number of channels in memory that the caller lends, and emits
//! transits ordered by entry, then by channel. Each [`TransitFinder::step`] does a bounded amount
//! of work; the state of a channel can be saved and resumed with the same bits.
//!
//! Frames: the search runs in [`AntiSun`](crate::frame::AntiSun) and
//! [`Spin`](crate::frame::Spin); separations are measured from the field of view's centre, those of
//! an enlarged field from the nearest point of the field as it was.
//!
//! Method: from each instant a span of time that provably holds no entry (or no exit) is skipped.
//!
//! 1. The target's angle gamma from the anti-Sun axis moves at most at the sum of the bounds in the
//!    tables; outside the annulus that the scan reaches, days are skipped (`anti_sun_gate.rs`).
//! 2. The target's angle delta from the spin axis follows `cos delta = cos alpha cos gamma +
//!    sin alpha sin gamma cos x` in the exact precession phase; with a margin for gamma's motion the
//!    next passage of the field's annulus has a closed form.
//! 3. The field's azimuth about the spin axis must match within `asin(sin r / sin beta_d)`; its rate
//!    is bounded, so most of a spin turn is skipped.
//! 4. Close by, `f = cos(separation) - cos r` obeys `|f''| <= M`, so `f + f' h + M h^2/2 < 0`
//!    certifies h seconds. The steps converge on a crossing quadratically and never pass it.
//!
//! A table's bounds hold within each of its series. Where one series follows another, at a burn above
//! all, direction, rate and second derivative may jump: no skipped span reaches over such a joint, so
//! the search evaluates on both sides of it, and a jump across the edge is an entry or exit there.
//!
//! Limits: crossings shallower than [`SEPARATION_TOLERANCE_RAD`] may be missed or reported; entry
//! and exit are within that separation of the boundary. Where one transit holds several approaches
//! (fields wider than a sixteenth of a spin turn), the closest is the deepest of those told apart at
//! that spacing. `tests/tests/transits.rs` compares with dense sampling and with independent values.

mod sight;
mod edge;
mod rates;
mod anti_sun_gate;
mod precession_gate;
mod spin_gate;
mod reach;
mod search;
mod saved;
mod channel;
mod confidence;
mod finder;
#[cfg(test)]
mod cases;
#[cfg(test)]
mod dense;

pub use channel::Channel;
pub use confidence::{Confidence, EVALUATIONS_PER_CONFIDENCE};
pub use finder::{Step, TransitFinder};
pub use saved::{SEARCH_BYTES, SearchOrigin};
pub(crate) use search::{Lookup, Search};
pub use search::{MAX_EVALUATIONS_PER_STEP, SearchState};
pub(crate) use sight::Seen;

use crate::time::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Depth in radians below which a grazing transit may go either way.
pub const SEPARATION_TOLERANCE_RAD: f64 = 2e-11;

/// A maximal interval with the target inside the field of view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Transit {
    /// Index of the channel that found it.
    pub channel: usize,
    /// First instant inside, or the search's start.
    pub entry: Instant,
    /// Last instant inside, or the search's end.
    pub exit: Instant,
    /// Instant of smallest separation.
    pub closest: Instant,
    /// Separation at closest approach in radians.
    pub min_separation_rad: f64,
    /// The target was inside already at the search's start.
    pub entry_clipped: bool,
    /// The target was still inside at the search's end.
    pub exit_clipped: bool,
}

impl Transit {
    /// Time inside.
    #[must_use]
    pub const fn dwell(&self) -> Duration {
        self.exit.since(self.entry)
    }
}
