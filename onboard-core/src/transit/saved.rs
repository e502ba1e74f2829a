//! What a search remembers across a reset, as bytes.
//!
//! | bytes of the record | field |
//! |---|---|
//! | 0..12 | head, kind `SRCH`, version 1 ([`crate::record`]) |
//! | 12..16 | CRC-32 of strategy, field of view and body: of which search it is |
//! | 16..24 | set digest of the tables, u64 |
//! | 24..32, 32..40 | next instant, end, i64 ns of TAI |
//! | 40..42 | stage: 0 outside, 1 inside, 2 found, 3 done, u16 |
//! | 42..44 | 1 with a previous approach, 2 entry clipped, 4 exit clipped, u16 |
//! | 44..48 | index of the channel that found, u32 |
//! | 48..72 | previous approach: instant, closeness, rate |
//! | 72..80 | entry |
//! | 80..104 | inside: best approach; found: exit, closest, separation |
//! | 104..108 | CRC-32 |
//!
//! Requirements: REQ-TRANSIT-8.

use super::Transit;
use super::search::{Approach, SearchState, Stage, Visit};
use crate::bytes::{f64_at, instant_at, put, u16_at, u32_at, u64_at};
use crate::field_of_view::{FIELD_BYTES, FieldOfView};
use crate::record::{Kind, RecordError};
use crate::scan::{SCAN_BYTES, ScanStrategy};
use crate::uplink::{Header, checksum};

/// Bytes of a saved search.
pub const SEARCH_BYTES: usize = 108;

const KIND: Kind = Kind { letters: *b"SRCH", version: 1 };

/// Of which search a saved state is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchOrigin {
    spacecraft: u32,
    set_digest: u64,
    search: u32,
}

impl SearchOrigin {
    /// The search for this body in this field of view under this strategy, on the tables with this
    /// header and set digest.
    #[must_use]
    #[inline(never)]
    pub fn new(
        header: &Header,
        set_digest: u64,
        scan: &ScanStrategy,
        field: &FieldOfView,
        body: i32,
    ) -> Self {
        let mut bytes = [0; SCAN_BYTES + FIELD_BYTES + 4];
        put(&mut bytes, 0, scan.parameters().to_le_bytes());
        put(&mut bytes, SCAN_BYTES, field.to_le_bytes());
        put(&mut bytes, SCAN_BYTES + FIELD_BYTES, body.to_le_bytes());
        let search = checksum(&bytes);
        Self { spacecraft: header.spacecraft, set_digest, search }
    }
}

impl SearchState {
    /// The record to save.
    #[must_use]
    #[inline(never)]
    pub fn to_le_bytes(&self, of: &SearchOrigin) -> [u8; SEARCH_BYTES] {
        let mut record = [0; SEARCH_BYTES];
        put(&mut record, 12, of.search.to_le_bytes());
        put(&mut record, 16, of.set_digest.to_le_bytes());
        put(&mut record, 24, self.at.tai_ns().to_le_bytes());
        put(&mut record, 32, self.end.tai_ns().to_le_bytes());
        let mut flags = 0_u16;
        if let Some(previous) = &self.previous {
            put_approach(&mut record, 48, previous);
            flags |= 1;
        }
        let stage = match &self.stage {
            Stage::Outside => 0_u16,
            Stage::Inside(visit) => {
                put(&mut record, 72, visit.entry.tai_ns().to_le_bytes());
                put_approach(&mut record, 80, &visit.best);
                flags |= u16::from(visit.clipped).wrapping_shl(1);
                1
            }
            Stage::Found(transit) => {
                let channel = u32::try_from(transit.channel).unwrap_or(u32::MAX);
                put(&mut record, 44, channel.to_le_bytes());
                put(&mut record, 72, transit.entry.tai_ns().to_le_bytes());
                put(&mut record, 80, transit.exit.tai_ns().to_le_bytes());
                put(&mut record, 88, transit.closest.tai_ns().to_le_bytes());
                put(&mut record, 96, transit.min_separation_rad.to_le_bytes());
                flags |= u16::from(transit.entry_clipped).wrapping_shl(1);
                flags |= u16::from(transit.exit_clipped).wrapping_shl(2);
                2
            }
            Stage::Done => 3,
        };
        put(&mut record, 40, stage.to_le_bytes());
        put(&mut record, 42, flags.to_le_bytes());
        KIND.seal(&mut record, of.spacecraft);
        record
    }

    /// Reads a saved state of the same search.
    ///
    /// # Errors
    /// [`RecordError`] when it is damaged, of another version or spacecraft, or of another search.
    #[inline(never)]
    pub fn from_le_bytes(
        record: &[u8; SEARCH_BYTES],
        of: &SearchOrigin,
    ) -> Result<Self, RecordError> {
        KIND.open(record, of.spacecraft)?;
        let same =
            u32_at(record, 12) == Some(of.search) && u64_at(record, 16) == Some(of.set_digest);
        if !same {
            return Err(RecordError::OtherOrigin);
        }
        read(record).ok_or(RecordError::Damaged)
    }
}

#[inline(never)]
fn read(record: &[u8; SEARCH_BYTES]) -> Option<SearchState> {
    let flags = u16_at(record, 42)?;
    let has = |flag: u16| flags & flag != 0;
    let entry = instant_at(record, 72)?;
    let stage = match u16_at(record, 40)? {
        0 => Stage::Outside,
        1 => Stage::Inside(Visit { entry, clipped: has(2), best: approach_at(record, 80)? }),
        2 => Stage::Found(Transit {
            channel: usize::try_from(u32_at(record, 44)?).ok()?,
            entry,
            exit: instant_at(record, 80)?,
            closest: instant_at(record, 88)?,
            min_separation_rad: f64_at(record, 96)?,
            entry_clipped: has(2),
            exit_clipped: has(4),
        }),
        3 => Stage::Done,
        _ => return None,
    };
    Some(SearchState {
        at: instant_at(record, 24)?,
        end: instant_at(record, 32)?,
        previous: if has(1) { Some(approach_at(record, 48)?) } else { None },
        stage,
    })
}

fn put_approach(record: &mut [u8], offset: usize, approach: &Approach) {
    put(record, offset, approach.at.tai_ns().to_le_bytes());
    put(record, offset.wrapping_add(8), approach.closeness.to_le_bytes());
    put(record, offset.wrapping_add(16), approach.rate.to_le_bytes());
}

fn approach_at(record: &[u8], offset: usize) -> Option<Approach> {
    Some(Approach {
        at: instant_at(record, offset)?,
        closeness: f64_at(record, offset.wrapping_add(8))?,
        rate: f64_at(record, offset.wrapping_add(16))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Boresight;
    use crate::phase::{Phase, Rotor, TurnRate};
    use crate::rotation::Rotation;
    use crate::scan::ScanParameters;
    use crate::time::Instant;

    const HEADER: Header = Header {
        sequence: 1,
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(1),
        mission_digest: [0; 16],
        spacecraft: 4,
    };

    fn scan(alpha_rad: f64) -> ScanStrategy {
        let rotor = Rotor { rate: TurnRate::from_bits(1 << 90), start: Phase::ZERO };
        let start = Instant::from_tai_ns(0);
        let parameters =
            ScanParameters { start, alpha_rad, beta_rad: 0.8, precession: rotor, spin: rotor };
        ScanStrategy::new(parameters).unwrap()
    }

    fn field(turn: f64, width: f64) -> FieldOfView {
        let rotation = Rotation::<Boresight, Boresight>::about_z(turn);
        FieldOfView::rectangle(rotation, width, 0.1).unwrap()
    }

    fn origin() -> SearchOrigin {
        SearchOrigin::new(&HEADER, 9, &scan(0.7), &field(0.0, 0.2), 5)
    }

    fn states() -> [SearchState; 5] {
        let at = Instant::from_tai_ns;
        let approach = |ns| Approach { at: at(ns), closeness: -0.25, rate: 1e-5 };
        let transit = Transit {
            channel: 3,
            entry: at(1),
            exit: at(2),
            closest: at(3),
            min_separation_rad: 0.125,
            entry_clipped: true,
            exit_clipped: false,
        };
        let state = |previous, stage| SearchState { at: at(-7), end: at(1 << 60), previous, stage };
        let visit = Visit { entry: at(11), clipped: true, best: approach(12) };
        [
            state(None, Stage::Outside),
            state(Some(approach(5)), Stage::Inside(visit)),
            state(Some(approach(6)), Stage::Found(transit)),
            state(
                None,
                Stage::Found(Transit { entry_clipped: false, exit_clipped: true, ..transit }),
            ),
            state(Some(approach(7)), Stage::Done),
        ]
    }

    #[test]
    // REQ-TRANSIT-8.
    fn a_search_comes_back_and_no_flipped_bit_passes() {
        for state in states() {
            let record = state.to_le_bytes(&origin());
            assert_eq!(SearchState::from_le_bytes(&record, &origin()), Ok(state));
            for bit in 0..SEARCH_BYTES * 8 {
                let mut bad = record;
                bad[bit / 8] ^= 1 << (bit % 8);
                assert!(SearchState::from_le_bytes(&bad, &origin()).is_err(), "bit {bit}");
            }
        }
    }

    #[test]
    // REQ-TRANSIT-8.
    fn another_search_is_refused() {
        let [state, ..] = states();
        let record = state.to_le_bytes(&origin());
        let (own, place) = (scan(0.7), field(0.0, 0.2));
        for other in [
            SearchOrigin::new(&HEADER, 8, &own, &place, 5),
            SearchOrigin::new(&HEADER, 9, &scan(0.71), &place, 5),
            SearchOrigin::new(&HEADER, 9, &own, &field(0.0, 0.21), 5),
            SearchOrigin::new(&HEADER, 9, &own, &field(0.01, 0.2), 5),
            SearchOrigin::new(&HEADER, 9, &own, &place.enlarged(0.01).unwrap(), 5),
            SearchOrigin::new(&HEADER, 9, &own, &place, 6),
        ] {
            let refused = SearchState::from_le_bytes(&record, &other);
            assert_eq!(refused, Err(RecordError::OtherOrigin));
        }
        let header = Header { spacecraft: 5, ..HEADER };
        let stranger = SearchOrigin::new(&header, 9, &own, &place, 5);
        let refused = RecordError::OtherSpacecraft { record: 4, flown: 5 };
        assert_eq!(SearchState::from_le_bytes(&record, &stranger), Err(refused));
    }
}
