//! What the sequencer does now, and why it does not do what was planned.

use crate::clock::ClockError;
use crate::ephemeris::EphemerisError;
use crate::time::{Duration, Instant};

/// What the spacecraft does now; the number is the session's index in the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// Surveying; no session runs.
    Idle,
    /// Before the target's first entry.
    Setup(u32),
    /// Between first entry and last exit.
    Calibrating(u32),
    /// After the last exit.
    Cooldown(u32),
    /// Nothing is done until [`Sequencer::resume`](super::Sequencer::resume).
    Safe(SafeReason),
}

/// Why the state is safe.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SafeReason {
    /// The sequencer is new: after a reset nothing begins by itself.
    Boot,
    /// [`Sequencer::stop`](super::Sequencer::stop).
    Commanded,
    /// There is no clock correlation.
    NoClock,
    /// The clock correlation has no answer now.
    Clock(ClockError),
    /// Neither slot holds tables.
    NoTables,
    /// The active tables' bytes are no longer what was checked.
    TablesDamaged,
    /// The tables' validity begins at this instant.
    TablesNotYetValid(Instant),
    /// The tables' validity ended at this instant.
    TablesExpired(Instant),
    /// The tables' mission does not have the sequencer's telescope.
    NoSuchTelescope,
    /// Time ran backwards by this much.
    TimeReversed(Duration),
}

/// Why a session is not begun.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SkipReason {
    /// Its start had passed by more than the longest gap.
    Missed,
    /// Another session was still running at its start.
    Overlap,
    /// The prediction was not finished at its start.
    NotChecked,
    /// The prediction finds no pass.
    NoPass,
    /// The predicted first entry is off by this much; minus two tolerances stand for that or more.
    Entry(Duration),
    /// The predicted last exit is off by this much; two tolerances stand for that or more.
    Exit(Duration),
    /// The prediction finds this number of passes instead.
    Passes(u16),
    /// First entry or last exit is known only within this much (half the 95 % interval).
    Uncertain(Duration),
    /// A field of view would come too close to this body during the session.
    Avoidance(i32),
    /// The tables have no answer.
    Ephemeris(EphemerisError),
}

/// Why a running session is given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AbortReason {
    /// The state became safe.
    Safe,
    /// Other tables were loaded.
    Tables,
    /// Time moved on by more than the longest gap.
    TimeJumped,
    /// A field of view is too close to this body.
    Avoidance(i32),
    /// The tables do not say where a body to avoid is.
    Ephemeris(EphemerisError),
}
