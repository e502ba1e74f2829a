//! Why a candidate was not taken.

use onboard_core::sequencer::SkipReason;
use onboard_core::time::{Duration, Instant};
use std::fmt;

/// Why a candidate was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Because {
    /// Its weight or its dwell is zero.
    NoValue,
    /// Its session would begin before the mission.
    BeforeMission,
    /// Its session would end after the mission.
    AfterMission,
    /// Its session alone needs more of a day than the limit.
    TooLongForDay {
        /// Index of the day, from the first boundary.
        day: usize,
        /// What it needs of that day.
        needs: Duration,
    },
    /// It overlaps a session on its telescope, or at all, as the rule says.
    Conflict {
        /// Candidate of that session.
        with: usize,
    },
    /// A day has too little time left.
    DayFull {
        /// Index of the day, from the first boundary.
        day: usize,
        /// What the session needs of that day.
        needs: Duration,
        /// What is left.
        left: Duration,
    },
    /// A sliding window would hold too many starts.
    SessionCount {
        /// Start of such a window.
        from: Instant,
        /// Most sessions that may start in it.
        count: usize,
    },
    /// It touches a blackout.
    Blackout {
        /// Index of the blackout.
        index: usize,
    },
    /// A field of view of its telescope comes too near to a body to avoid, setup and cooldown
    /// included.
    Avoided,
    /// The spacecraft would skip it for another reason.
    Skipped(SkipReason),
    /// A person forbids it.
    Forbidden,
    /// Reserved time in a sliding window would exceed the limit.
    Thermal,
    /// The memory would overflow.
    Memory,
    /// The scan angles of its target and telescope would be too alike.
    ScanAngle {
        /// Multiple of the crossing angle.
        n: u32,
    },
    /// No rule: taking it would bring less than it costs, or only together with other changes.
    NotWorth,
}

impl Because {
    pub(super) const fn day_full(day: usize, needs_ns: i64, left_ns: i64) -> Self {
        Self::DayFull { day, needs: Duration::from_ns(needs_ns), left: Duration::from_ns(left_ns) }
    }
}

impl fmt::Display for Because {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoValue => f.write_str("it has no value: its weight or its dwell is zero"),
            Self::BeforeMission => f.write_str("its setup would begin before the mission"),
            Self::AfterMission => f.write_str("its cooldown would end after the mission"),
            Self::TooLongForDay { day, needs } => write!(
                f,
                "its session alone needs {} s of day {day}, more than the limit",
                needs.seconds()
            ),
            Self::Conflict { with } => write!(f, "it overlaps the session of candidate {with}"),
            Self::DayFull { day, needs, left } => write!(
                f,
                "it needs {} s of day {day}, which has {} s left",
                needs.seconds(),
                left.seconds()
            ),
            Self::SessionCount { from, count } => write!(
                f,
                "the window from {} ns TAI already holds {count} sessions, the most allowed",
                from.tai_ns()
            ),
            Self::Blackout { index } => write!(f, "it touches blackout {index}"),
            Self::Avoided => f.write_str("its line of sight comes too near to a body to avoid"),
            Self::Skipped(reason) => {
                write!(f, "the spacecraft would skip it: {}", skipped(reason))
            }
            Self::Forbidden => f.write_str("it is forbidden"),
            Self::Thermal => f.write_str("the reserved time in a thermal window would be too long"),
            Self::Memory => f.write_str("the memory would overflow before the next contacts"),
            Self::ScanAngle { n } => {
                write!(f, "the scan angles would be too alike at n = {n}")
            }
            Self::NotWorth => f.write_str("taking it brings less than it costs"),
        }
    }
}

/// Why the spacecraft skips a session, in words.
#[must_use]
pub fn skipped(reason: SkipReason) -> String {
    match reason {
        SkipReason::Missed => "its start had passed".to_owned(),
        SkipReason::Overlap => "another session still runs at its start".to_owned(),
        SkipReason::NotChecked => "there is no time to check it beforehand".to_owned(),
        SkipReason::NoPass => "it finds no pass".to_owned(),
        SkipReason::Entry(by) => format!("it finds the first entry {} s off", by.seconds()),
        SkipReason::Exit(by) => format!("it finds the last exit {} s off", by.seconds()),
        SkipReason::Passes(passes) => format!("it finds {passes} passes"),
        SkipReason::Uncertain(within) => {
            format!("it knows its passes only within {} s", within.seconds())
        }
        SkipReason::Avoidance(body) => {
            format!("a field of view comes too near to body {body}")
        }
        SkipReason::Ephemeris(error) => format!("its tables have no answer: {error:?}"),
        other => format!("{other:?}"),
    }
}

/// A candidate that was not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rejection {
    /// Index of the candidate.
    pub candidate: usize,
    /// Why.
    pub because: Because,
}
