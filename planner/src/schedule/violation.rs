//! A rule that a schedule breaks, and by how much.

use thiserror::Error;

/// A rule that a schedule breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Violation {
    /// No such candidate.
    #[error("candidate {0} does not exist")]
    Unknown(usize),
    /// Taken twice.
    #[error("candidate {0} is taken twice")]
    Twice(usize),
    /// A session reaches outside the mission.
    #[error("the session of candidate {0} reaches outside the mission")]
    Outside(usize),
    /// Two sessions overlap that must not.
    #[error("the sessions of candidates {0} and {1} overlap")]
    Overlap(usize, usize),
    /// A day is overfull.
    #[error("day {day} has {used_ns} ns reserved, more than {limit_ns} ns")]
    Day {
        /// Index of the day, from the first boundary.
        day: usize,
        /// Reserved time.
        used_ns: i128,
        /// The limit.
        limit_ns: i64,
    },
    /// A window holds too many starts.
    #[error("{starts} sessions start in the window from {from_tai_ns} ns TAI, more than {count}")]
    Count {
        /// Start of the window.
        from_tai_ns: i128,
        /// Starts in it.
        starts: usize,
        /// Most allowed.
        count: u32,
    },
    /// A forbidden session stands.
    #[error("candidate {0} is forbidden")]
    Forbidden(usize),
    /// A session that the spacecraft would not begin stands, such as one too near to a body to avoid.
    #[error("candidate {0} comes too near to a body to avoid, or would be skipped on board")]
    Avoided(usize),
    /// A session touches a blackout.
    #[error("the session of candidate {0} touches a blackout")]
    Blackout(usize),
    /// A session that must stand does not.
    #[error("candidate {0} must stand and does not")]
    Fixed(usize),
    /// A window holds too much reserved time.
    #[error("{used_ns} ns are reserved in the thermal window from {from_tai_ns} ns TAI")]
    Thermal {
        /// Start of the window.
        from_tai_ns: i128,
        /// Reserved time in it.
        used_ns: i128,
    },
    /// The memory overflows.
    #[error("the memory would hold {held_bit} bits at {at_tai_ns} ns TAI")]
    Memory {
        /// When.
        at_tai_ns: i128,
        /// What it would hold.
        held_bit: i128,
    },
    /// Scan angles are too alike.
    #[error("scan angles of target {target} on telescope {telescope} are too alike at n = {n}")]
    ScanAngle {
        /// Multiple of the crossing angle.
        n: u32,
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
    },
    /// A season holds too few sessions.
    #[error(
        "a season of target {target} on telescope {telescope} holds {held} sessions, fewer than \
         {wanted}"
    )]
    Season {
        /// Index of the target.
        target: usize,
        /// Index of the telescope.
        telescope: usize,
        /// Sessions in it.
        held: i128,
        /// Fewest allowed.
        wanted: i128,
    },
}
