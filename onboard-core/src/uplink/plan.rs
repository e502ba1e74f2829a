//! The calibration plan as the spacecraft needs it.
//!
//! Bytes 0..4 hold the number of sessions, u32; 4..8 are zero; then [`SESSION_BYTES`] each, by start:
//!
//! | bytes | field |
//! |---|---|
//! | 0..8, 8..16 | start and end with setup and cooldown, i64 ns of TAI |
//! | 16..24, 24..32 | first entry and last exit, i64 ns of TAI |
//! | 32..36 | body number, i32 |
//! | 36..40 | precession turn since the mission's start, u32 |
//! | 40..42 | telescope's index, u16 |
//! | 42..44 | passes, u16 |
//! | 44..48 | zero |

use crate::bytes::{i32_at, i64_at, put, u16_at, u32_at};
use crate::convert::index_from_u32;
use crate::time::Instant;

/// Bytes of one session.
pub const SESSION_BYTES: usize = 48;

/// Why a plan section is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlanError {
    /// Fewer or more bytes than the number of sessions says.
    WrongLength,
    /// A session (its index) runs backwards, begins before the one before it, or has spare bytes
    /// that are not zero.
    BadSession(u32),
}

/// One planned calibration session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SessionRecord {
    /// Start, setup included.
    pub start: Instant,
    /// End, cooldown included.
    pub end: Instant,
    /// First entry of the target.
    pub first_entry: Instant,
    /// Last exit of the target.
    pub last_exit: Instant,
    /// Body number of the target.
    pub body: i32,
    /// Precession turn since the mission's start.
    pub turn: u32,
    /// Index of the telescope.
    pub telescope: u16,
    /// Passes in the session; 65535 stands for that many or more.
    pub passes: u16,
}

/// A checked plan in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct PlanTable<'a> {
    sessions: &'a [[u8; SESSION_BYTES]],
}

impl SessionRecord {
    /// The session's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; SESSION_BYTES] {
        let mut bytes = [0; SESSION_BYTES];
        put(&mut bytes, 0, self.start.tai_ns().to_le_bytes());
        put(&mut bytes, 8, self.end.tai_ns().to_le_bytes());
        put(&mut bytes, 16, self.first_entry.tai_ns().to_le_bytes());
        put(&mut bytes, 24, self.last_exit.tai_ns().to_le_bytes());
        put(&mut bytes, 32, self.body.to_le_bytes());
        put(&mut bytes, 36, self.turn.to_le_bytes());
        put(&mut bytes, 40, self.telescope.to_le_bytes());
        put(&mut bytes, 42, self.passes.to_le_bytes());
        bytes
    }

    /// Reads a session; `None` when its times run backwards or spare bytes are not zero.
    #[must_use]
    #[inline(never)]
    pub fn from_le_bytes(bytes: &[u8; SESSION_BYTES]) -> Option<Self> {
        let instant = |offset| i64_at(bytes, offset).map(Instant::from_tai_ns);
        let session = Self {
            start: instant(0)?,
            end: instant(8)?,
            first_entry: instant(16)?,
            last_exit: instant(24)?,
            body: i32_at(bytes, 32)?,
            turn: u32_at(bytes, 36)?,
            telescope: u16_at(bytes, 40)?,
            passes: u16_at(bytes, 42)?,
        };
        let forwards = session.start <= session.first_entry
            && session.first_entry <= session.last_exit
            && session.last_exit <= session.end;
        (forwards && u32_at(bytes, 44)? == 0).then_some(session)
    }
}

impl<'a> PlanTable<'a> {
    /// No sessions.
    pub const EMPTY: Self = Self { sessions: &[] };

    /// Checks and borrows a section.
    ///
    /// # Errors
    /// [`PlanError`], the first thing found wrong.
    #[inline(never)]
    pub fn parse(bytes: &'a [u8]) -> Result<Self, PlanError> {
        let count = u32_at(bytes, 0).ok_or(PlanError::WrongLength)?;
        let rest = bytes.get(8..).ok_or(PlanError::WrongLength)?;
        let (sessions, spare) = rest.as_chunks::<SESSION_BYTES>();
        if usize::try_from(count) != Ok(sessions.len())
            || !spare.is_empty()
            || u32_at(bytes, 4) != Some(0)
        {
            return Err(PlanError::WrongLength);
        }
        let mut previous: Option<Instant> = None;
        let mut index = 0_u32;
        for record in sessions {
            let session =
                SessionRecord::from_le_bytes(record).ok_or(PlanError::BadSession(index))?;
            if previous.is_some_and(|start| session.start < start) {
                return Err(PlanError::BadSession(index));
            }
            previous = Some(session.start);
            index = index.wrapping_add(1);
        }
        Ok(Self { sessions })
    }

    /// The session at `index`, by start.
    #[must_use]
    pub fn session(&self, index: u32) -> Option<SessionRecord> {
        SessionRecord::from_le_bytes(self.sessions.get(index_from_u32(index))?)
    }

    /// The index of the first session that starts at or after `at`.
    #[must_use]
    #[inline(never)]
    pub fn first_from(&self, at: Instant) -> u32 {
        let before = |record: &[u8; SESSION_BYTES]| {
            i64_at(record, 0).is_some_and(|start| start < at.tai_ns())
        };
        u32::try_from(self.sessions.partition_point(before)).unwrap_or(u32::MAX)
    }

    /// The sessions by start.
    pub fn sessions(&self) -> impl Iterator<Item = SessionRecord> + 'a {
        self.sessions.iter().filter_map(SessionRecord::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn session(start: i64) -> SessionRecord {
        let at = |offset| Instant::from_tai_ns(start + offset);
        SessionRecord {
            start: at(0),
            end: at(40),
            first_entry: at(10),
            last_exit: at(30),
            body: 5,
            turn: 17,
            telescope: 2,
            passes: 9,
        }
    }

    fn section(sessions: &[SessionRecord]) -> Vec<u8> {
        let mut bytes = u32::try_from(sessions.len()).unwrap().to_le_bytes().to_vec();
        bytes.extend([0; 4]);
        for session in sessions {
            bytes.extend(session.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn a_plan_comes_back() {
        let sessions = [session(0), session(5), session(5), session(100)];
        let bytes = section(&sessions);
        let plan = PlanTable::parse(&bytes).unwrap();
        assert_eq!(plan.sessions().collect::<Vec<_>>(), sessions);
        assert_eq!(plan.session(3), Some(sessions[3]));
        assert_eq!(plan.session(4), None);
        let first = |ns| plan.first_from(Instant::from_tai_ns(ns));
        assert_eq!([first(-1), first(1), first(5), first(6), first(101)], [0, 1, 1, 3, 4]);
        assert_eq!(PlanTable::EMPTY.sessions().count(), 0);
        assert_eq!(PlanTable::parse(&section(&[])).unwrap().sessions().count(), 0);
    }

    #[test]
    fn disorder_is_refused() {
        let bytes = section(&[session(6), session(5)]);
        assert_eq!(PlanTable::parse(&bytes).unwrap_err(), PlanError::BadSession(1));
        let backwards = SessionRecord { end: Instant::from_tai_ns(-1), ..session(0) };
        let bytes = section(&[backwards]);
        assert_eq!(PlanTable::parse(&bytes).unwrap_err(), PlanError::BadSession(0));
        let bytes = section(&[session(0)]);
        assert_eq!(PlanTable::parse(&bytes[..50]).unwrap_err(), PlanError::WrongLength);
    }

    #[test]
    fn each_instant_of_a_session_keeps_its_order() {
        let at = |ns: i64| Instant::from_tai_ns(ns);
        let parse = |session: SessionRecord| PlanTable::parse(&section(&[session])).map(|_| ());
        let bad = Err(PlanError::BadSession(0));
        assert_eq!(parse(SessionRecord { first_entry: at(-1), ..session(0) }), bad);
        assert_eq!(parse(SessionRecord { last_exit: at(9), ..session(0) }), bad);
        assert_eq!(parse(SessionRecord { last_exit: at(41), ..session(0) }), bad);
        let instant =
            SessionRecord { first_entry: at(0), last_exit: at(0), end: at(0), ..session(0) };
        assert_eq!(parse(instant), Ok(()));
    }

    #[test]
    fn the_count_is_that_of_the_sessions() {
        let good = section(&[session(0), session(5)]);
        let with = |change: fn(&mut Vec<u8>)| {
            let mut bytes = good.clone();
            change(&mut bytes);
            PlanTable::parse(&bytes).map(|_| ())
        };
        assert_eq!(with(|_| {}), Ok(()));
        let wrong = Err(PlanError::WrongLength);
        assert_eq!(with(|bytes| bytes[0] = 1), wrong);
        assert_eq!(with(|bytes| bytes[4] = 1), wrong);
        assert_eq!(with(|bytes| bytes.push(0)), wrong);
        assert_eq!(with(|bytes| bytes[8 + 44] = 1), Err(PlanError::BadSession(0)));
    }
}
