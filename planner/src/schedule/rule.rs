//! The rules: what a problem asks for, and how far each is used at one place.
//!
//! [`Rules`] are those of time on telescopes, which every problem states; further ones are in
//! `demands.rs`. [`RuleName`] names a rule by its key in mission files, [`Rule`] a rule at one place: a
//! day, a window, a season. Times are instants of TAI, durations nanoseconds; [`ConstraintUse`] is told
//! in the rule's own [`Unit`].

use onboard_core::time::{Duration, Instant};
use std::fmt;

/// Which sessions must not overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exclusive {
    /// Any may.
    None,
    /// No two on one telescope.
    Telescope,
    /// No two at all.
    All,
}

/// At most `count` sessions start in any half-open window of length `window`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SessionCount {
    /// Most sessions.
    pub count: u32,
    /// Length of the sliding window, positive.
    pub window: Duration,
}

/// What a schedule must respect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rules {
    /// Reserved before the first entry.
    pub setup: Duration,
    /// Reserved after the last exit.
    pub cooldown: Duration,
    /// Overlap of reserved intervals; intervals that touch do not overlap.
    pub exclusive: Exclusive,
    /// Most reserved time of all sessions together in each day; each day counts its own part.
    pub max_per_day: Option<Duration>,
    /// Most sessions per sliding window, by the start of the reserved interval.
    pub max_sessions: Option<SessionCount>,
    /// UTC midnights, ascending, from the mission's start or before to its end or after. Needed with
    /// `max_per_day`; days may differ in length.
    pub day_boundaries: Vec<Instant>,
}

/// A rule by its key in mission files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RuleName {
    /// Sessions must not overlap.
    Exclusive,
    /// Reserved time per day.
    MaxMinutesPerDay,
    /// Sessions per sliding window.
    MaxSessions,
    /// Sessions per season.
    MinSessions,
    /// Scan angles.
    ScanAngle,
    /// Memory and contacts.
    Data,
    /// Reserved time per sliding window.
    Thermal,
    /// Times when nothing is allowed.
    Blackouts,
    /// Sessions that a person asks for.
    Fixed,
    /// Sessions that a person forbids.
    Forbidden,
}

impl fmt::Display for RuleName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exclusive => "exclusive",
            Self::MaxMinutesPerDay => "max_minutes_per_day",
            Self::MaxSessions => "max_sessions",
            Self::MinSessions => "min_sessions",
            Self::ScanAngle => "scan_angle",
            Self::Data => "data",
            Self::Thermal => "thermal",
            Self::Blackouts => "blackouts",
            Self::Fixed => "fixed sessions",
            Self::Forbidden => "forbidden sessions",
        })
    }
}

/// In what the use and the limit of a rule are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Seconds, of reserved time or of producing data.
    Seconds,
    /// Days of 86,400 s.
    Days,
    /// Sessions.
    Sessions,
    /// A pure number.
    None,
}

/// A rule at one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// No overlap, on one telescope or (`None`) at all: reserved time of the mission's.
    Exclusive {
        /// Index of the telescope.
        telescope: Option<usize>,
    },
    /// Reserved time in a day, from the first boundary.
    Day {
        /// Index of the day.
        day: usize,
    },
    /// Starts in the window that begins here.
    SessionCount {
        /// Start of the window.
        from: Instant,
    },
    /// Sessions in a season; the limit is a least number.
    MinSessions {
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
        /// Start of the season.
        from: Instant,
    },
    /// Windows of the longest gap without a session: days beyond it, limit 0.
    Gap {
        /// Index of the telescope.
        telescope: usize,
        /// Start of the first window.
        from: Instant,
    },
    /// Reserved time in the window that begins here.
    Thermal {
        /// Start of the window.
        from: Instant,
    },
    /// Data produced in a stretch of time, as time of production.
    Memory {
        /// Start of the stretch.
        from: Instant,
        /// Its end.
        until: Instant,
    },
    /// Mean resultant length of scan angles.
    ScanAngle {
        /// Multiple of the crossing angle.
        n: u32,
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
    },
}

impl Rule {
    /// In what the rule's use and limit are counted.
    #[must_use]
    pub const fn unit(&self) -> Unit {
        match self {
            Self::Exclusive { .. }
            | Self::Day { .. }
            | Self::Thermal { .. }
            | Self::Memory { .. } => Unit::Seconds,
            Self::Gap { .. } => Unit::Days,
            Self::SessionCount { .. } | Self::MinSessions { .. } => Unit::Sessions,
            Self::ScanAngle { .. } => Unit::None,
        }
    }
}

/// How far a rule is used, and what loosening it would bring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstraintUse {
    /// The rule.
    pub rule: Rule,
    /// What the schedule uses.
    pub used: f64,
    /// What the rule allows.
    pub limit: f64,
    /// Objective per unit of the limit that a small loosening would bring in the relaxation; for
    /// exclusivity the mean over the mission.
    pub shadow_price: f64,
}

impl ConstraintUse {
    /// In what use and limit are counted.
    #[must_use]
    pub const fn unit(&self) -> Unit {
        self.rule.unit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rule_has_its_unit() {
        let from = Instant::from_tai_ns(0);
        let (target, telescope) = (0, 0);
        let units = [
            (Rule::Exclusive { telescope: None }, Unit::Seconds),
            (Rule::Day { day: 0 }, Unit::Seconds),
            (Rule::Thermal { from }, Unit::Seconds),
            (Rule::Memory { from, until: from }, Unit::Seconds),
            (Rule::Gap { telescope, from }, Unit::Days),
            (Rule::SessionCount { from }, Unit::Sessions),
            (Rule::MinSessions { target, telescope, from }, Unit::Sessions),
            (Rule::ScanAngle { n: 2, target, telescope }, Unit::None),
        ];
        for (rule, unit) in units {
            let it = ConstraintUse { rule, used: 0.0, limit: 0.0, shadow_price: 0.0 };
            assert_eq!((rule.unit(), it.unit()), (unit, unit));
        }
    }
}
