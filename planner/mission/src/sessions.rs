//! Which passes of a target over a telescope belong to one session.
//!
//! Where a precession turn is short ([`LONGEST_TURN_MIN`]) it is the passes of a turn, counted from the
//! mission's start. Elsewhere, or with `calibration.session`, passes belong together while the pause
//! between them is at most `gap_min`; what lasts longer than `longest_min` is cut at multiples of that
//! time since the mission's start. Places fixed on the scan clock leave the sessions of a replanned
//! mission their names.
//!
//! # Example
//! Planck's passes come each minute for a day and more; LiteBIRD's make a session per turn:
//! ```
//! use mission::{Mission, sessions::Sessions};
//!
//! let planck = Mission::load("planck", &[])?.sessions();
//! assert!(matches!(planck, Sessions::ByPause { gap, longest, .. }
//!     if gap.seconds() == 300.0 && longest.seconds() == 10_800.0));
//! assert_eq!(Mission::load("litebird", &[])?.sessions(), Sessions::ByTurn);
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

use crate::number::Number;
use crate::reading::range::Range;
use crate::reading::section::Section;
use crate::rounding;
use crate::scan::Scan;
use num_rational::BigRational;
use onboard_core::time::Duration;

/// The longest precession turn whose passes are a session, in minutes.
pub const LONGEST_TURN_MIN: i64 = 240;
/// The longest pause within a session, in spin periods, where nothing else is asked for.
const GAP_TURNS: i64 = 5;
/// After which time a session is cut, in minutes, where nothing else is asked for.
const LONGEST_MIN: i64 = 180;
/// No cut falls into a pause shorter than this part of a spin period.
const CUT_PART: i64 = 4;
const PAUSE: Range = Range::closed("a duration", 1e-6, 52_596_000.0, "min");

/// Which passes of a target over a telescope belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sessions {
    /// Those of a precession turn.
    ByTurn,
    /// Those with short pauses between them.
    ByPause {
        /// The longest pause between two passes.
        gap: Duration,
        /// What lasts longer is cut at multiples of this since the mission's start.
        longest: Duration,
        /// Passes with at most this pause between them are never cut apart.
        breath: Duration,
    },
}

/// `calibration.session`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Asked {
    gap_min: Option<Number>,
    longest_min: Option<Number>,
}

impl Asked {
    pub(crate) fn read(section: &mut Section<'_>) -> Self {
        Self {
            gap_min: section.optional_number("gap_min", &PAUSE),
            longest_min: section.optional_number("longest_min", &PAUSE),
        }
    }
}

impl Sessions {
    /// What was asked for, with what the scan suggests for the rest.
    pub(crate) fn of(asked: Option<&Asked>, scan: &Scan) -> Self {
        let turn = scan.precession_period_min.exact();
        let minutes = |it: i64| BigRational::from_integer(it.into());
        if asked.is_none() && *turn <= minutes(LONGEST_TURN_MIN) {
            return Self::ByTurn;
        }
        let given = |pick: &dyn Fn(&Asked) -> Option<&Number>| {
            asked.and_then(pick).map(|it| it.exact().clone())
        };
        let spins = |above, below| scan.spin_period_min.times(above, below);
        let gap = given(&|it| it.gap_min.as_ref()).unwrap_or_else(|| spins(GAP_TURNS, 1));
        let longest = given(&|it| it.longest_min.as_ref()).unwrap_or_else(|| minutes(LONGEST_MIN));
        let breath = spins(1, CUT_PART).min(gap.clone());
        Self::ByPause {
            gap: duration(&gap),
            longest: duration(&longest),
            breath: duration(&breath),
        }
    }
}

fn duration(minutes: &BigRational) -> Duration {
    let seconds = minutes * BigRational::from_integer(60.into());
    rounding::duration(&seconds).unwrap_or(Duration::ZERO)
}
