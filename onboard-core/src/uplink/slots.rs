//! Two places for containers, of which the newest sound one is active.
//!
//! The slots are the caller's memory (flash, as a rule) and are read in place. Which one is active
//! follows from their contents alone, so that it is the same after a reset. A new container is
//! checked where it was received ([`Slots::admit`]), written by the caller to the slot that is not
//! active, and becomes active by being there; a write that is cut short leaves an unsound slot, and
//! the other one stays active. The only way to an older container is a [`RollbackOrder`]: the
//! caller then marks the newer one as revoked ([`revoke`]); its sequence number remains readable and
//! is not accepted again.
//!
//! A slot may be longer than its container.

use super::{
    Container, HEADER_BYTES, Header, MAGIC, RollbackOrder, TableError, Tables, UplinkError,
    checksum,
};
use crate::bytes::{field, put, span, u32_at};
use crate::time::Instant;

/// What stands in place of the magic in a container that was rolled back.
pub const REVOKED: [u8; 8] = *b"REVOKED\0";

/// One of the two places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// The first.
    A,
    /// The second.
    B,
}

impl Slot {
    /// The other place.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// Why a slot holds no tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SlotError {
    /// Its container (the sequence number) was rolled back.
    Revoked(u32),
    /// Its contents are refused.
    Unsound(TableError),
}

/// Neither slot holds tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoTables {
    /// Why not A.
    pub a: SlotError,
    /// Why not B.
    pub b: SlotError,
}

/// Why a new container, or a rollback, is refused; the active tables stay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// The candidate's contents.
    Unsound(TableError),
    /// The candidate's validity ended at this instant.
    Expired(Instant),
    /// The candidate's validity begins only at this instant.
    NotYetValid(Instant),
    /// The candidate's sequence number is not above the newest one seen.
    Older {
        /// The candidate's.
        candidate: u32,
        /// The newest in a slot, revoked ones included.
        newest: u32,
    },
    /// The candidate does not fit into the slot (bytes there, bytes needed).
    TooLong(usize, usize),
    /// The rollback order's last instant has passed.
    OrderExpired(Instant),
    /// The order leaves another container than the active one (its sequence number).
    NotActive(u32),
    /// The other slot does not hold the container that the order returns to.
    NothingToReturnTo,
}

/// The tables in use and where they are.
#[derive(Debug, Clone, Copy)]
pub struct Active<'a> {
    /// Their place.
    pub slot: Slot,
    /// The tables.
    pub tables: Tables<'a>,
}

/// The two places, in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct Slots<'a> {
    /// The first.
    pub a: &'a [u8],
    /// The second.
    pub b: &'a [u8],
}

impl<'a> Slots<'a> {
    const fn bytes(&self, slot: Slot) -> &'a [u8] {
        match slot {
            Slot::A => self.a,
            Slot::B => self.b,
        }
    }

    fn container(&self, slot: Slot) -> Result<Container<'a>, SlotError> {
        let bytes = self.bytes(slot);
        if let Some(sequence) = revoked_sequence(bytes) {
            return Err(SlotError::Revoked(sequence));
        }
        Container::parse(image(bytes))
            .map_err(|error| SlotError::Unsound(TableError::Container(error)))
    }

    /// The tables of one slot.
    ///
    /// # Errors
    /// [`SlotError`], why it holds none.
    #[inline(never)]
    pub fn tables(&self, slot: Slot) -> Result<Tables<'a>, SlotError> {
        let container = self.container(slot)?;
        Tables::from_container(&container).map_err(SlotError::Unsound)
    }

    /// The newest sound tables, from the slots' contents alone.
    ///
    /// # Errors
    /// [`NoTables`] when neither slot holds any.
    pub fn active(&self) -> Result<Active<'a>, NoTables> {
        let Some(slot) = self.active_slot() else {
            let why = |slot| self.refusal(slot).unwrap_or(SlotError::Unsound(UNREADABLE));
            return Err(NoTables { a: why(Slot::A), b: why(Slot::B) });
        };
        match self.tables(slot) {
            Ok(tables) => Ok(Active { slot, tables }),
            Err(error) => Err(NoTables { a: error, b: error }),
        }
    }

    /// The slot of the newest sound tables.
    #[inline(never)]
    fn active_slot(&self) -> Option<Slot> {
        // The newer container first; the other only where the newer one's tables are unsound.
        let newer = match (self.sequence(Slot::A), self.sequence(Slot::B)) {
            (a, Some(b)) if a.is_none_or(|a| b > a) => Slot::B,
            _ => Slot::A,
        };
        [newer, newer.other()].into_iter().find(|slot| self.refusal(*slot).is_none())
    }

    /// Why a slot holds no tables.
    #[inline(never)]
    fn refusal(&self, slot: Slot) -> Option<SlotError> {
        self.tables(slot).err()
    }

    /// The sequence number of a slot's container.
    #[inline(never)]
    fn sequence(&self, slot: Slot) -> Option<u32> {
        self.container(slot).ok().map(|container| container.header().sequence)
    }

    /// The largest sequence number that either slot ever held, as far as it can be read.
    fn newest(&self) -> Option<u32> {
        let seen = |slot| self.sequence(slot).or_else(|| revoked_sequence(self.bytes(slot)));
        seen(Slot::A).max(seen(Slot::B))
    }

    /// Checks a new container; on success the slot to which the caller is to write it.
    ///
    /// # Errors
    /// [`Refusal`], the reason; the active tables stay.
    #[inline(never)]
    pub fn admit(&self, candidate: &[u8], now: Instant) -> Result<Slot, Refusal> {
        let header = sound_header(candidate)?;
        check_validity(&header, now)?;
        if let Some(newest) = self.newest()
            && header.sequence <= newest
        {
            return Err(Refusal::Older { candidate: header.sequence, newest });
        }
        let slot = self.active_slot().map_or(Slot::A, Slot::other);
        let room = self.bytes(slot).len();
        if room < candidate.len() {
            return Err(Refusal::TooLong(room, candidate.len()));
        }
        Ok(slot)
    }

    /// Checks a rollback; on success the slot that the caller is to [`revoke`].
    ///
    /// # Errors
    /// [`Refusal`], the reason; the active tables stay.
    #[inline(never)]
    pub fn roll_back(&self, order: &RollbackOrder, now: Instant) -> Result<Slot, Refusal> {
        if now > order.until {
            return Err(Refusal::OrderExpired(order.until));
        }
        let active = self.active_slot().ok_or(Refusal::NothingToReturnTo)?;
        match self.sequence(active) {
            Some(sequence) if sequence == order.from => {}
            other => return Err(Refusal::NotActive(other.unwrap_or(0))),
        }
        let target = self.tables(active.other()).map_err(|_| Refusal::NothingToReturnTo)?;
        if target.header().sequence != order.to || target.set_digest() != order.to_digest {
            return Err(Refusal::NothingToReturnTo);
        }
        check_validity(target.header(), now)?;
        Ok(active)
    }
}

/// Marks a slot's container as rolled back: its magic becomes [`REVOKED`], and the header's CRC
/// that of the header with it, so that a new container's first bytes do not bring it back.
///
/// False when the slot is too short for a container.
pub fn revoke(slot: &mut [u8]) -> bool {
    if slot.len() < HEADER_BYTES || !put(slot, 0, REVOKED) {
        return false;
    }
    let crc = slot.first_chunk::<60>().map(|covered| checksum(covered));
    crc.is_some_and(|crc| put(slot, 60, crc.to_le_bytes()))
}

#[inline(never)]
fn sound_header(candidate: &[u8]) -> Result<Header, Refusal> {
    let tables = Tables::load(candidate).map_err(Refusal::Unsound)?;
    Ok(*tables.header())
}

/// Stands where a slot's contents change while they are read.
const UNREADABLE: TableError = TableError::Container(UplinkError::NotAContainer);

fn check_validity(header: &Header, now: Instant) -> Result<(), Refusal> {
    if now > header.valid_until {
        Err(Refusal::Expired(header.valid_until))
    } else if now < header.valid_from {
        Err(Refusal::NotYetValid(header.valid_from))
    } else {
        Ok(())
    }
}

/// The container in a slot: as long as its header says, where that fits.
fn image(slot: &[u8]) -> &[u8] {
    u32_at(slot, 12).and_then(|length| span(slot, 0, length)).unwrap_or(slot)
}

/// The sequence number of a revoked container whose header is otherwise whole; its CRC may still be
/// the one from before, when the revoking was cut short.
#[inline(never)]
fn revoked_sequence(slot: &[u8]) -> Option<u32> {
    if field(slot, 0) != Some(REVOKED) {
        return None;
    }
    let mut header: [u8; 60] = field(slot, 0)?;
    let crc = u32_at(slot, 60)?;
    if crc != checksum(&header) {
        put(&mut header, 0, MAGIC);
        (crc == checksum(&header)).then_some(())?;
    }
    u32_at(slot, 16)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::direction::MotionBounds;
    use crate::ephemeris::{BodyRecord, Span, table_header};
    use crate::phase::{Phase, Rotor, TurnRate};
    use crate::scan::ScanParameters;
    use crate::uplink::tests::container_of;
    use crate::uplink::{Counts, MissionTable, SectionKind, SunRecord};
    use core::num::NonZeroU64;
    use std::vec;
    use std::vec::Vec;

    const NOW: Instant = Instant::from_tai_ns(100);

    fn ephemeris() -> Vec<u8> {
        let span = Span {
            body: 5,
            coefficients: 1,
            granules: 1,
            first: 0,
            start: Instant::from_tai_ns(0),
            granule_ns: NonZeroU64::new(1000).unwrap(),
            bounds: MotionBounds { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 1.0 },
        };
        let body = BodyRecord { body: 5, spans: 1, first: 0, bounds: span.bounds };
        let mut bytes = table_header(1, 1, 3).to_vec();
        bytes.extend(body.to_le_bytes());
        bytes.extend(span.to_le_bytes());
        bytes.extend([0.0, 0.0, 1.0_f64].iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    /// A container with the circular Sun and no plan, valid for (from, until).
    fn uplink(sequence: u32, (from, until): (i64, i64)) -> Vec<u8> {
        let rotor = Rotor { rate: TurnRate::from_bits(1 << 80), start: Phase::ZERO };
        let parameters = ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad: 0.7,
            beta_rad: 0.8,
            precession: rotor,
            spin: rotor,
        };
        let sun = SunRecord::Circular(rotor);
        let mission = MissionTable::fixed_to_le_bytes(&parameters, sun, Counts::default(), 0.01);
        let header = Header {
            sequence,
            valid_from: Instant::from_tai_ns(from),
            valid_until: Instant::from_tai_ns(until),
            mission_digest: [3; 16],
        };
        container_of(
            &header,
            &[(SectionKind::Ephemeris, &ephemeris()), (SectionKind::Mission, &mission)],
        )
    }

    fn padded(container: &[u8]) -> Vec<u8> {
        let mut slot = vec![0xff; 1000];
        slot[..container.len()].copy_from_slice(container);
        slot
    }

    #[test]
    fn the_newest_sound_slot_is_active_whatever_its_place() {
        let (old, new) = (padded(&uplink(4, (0, 900))), padded(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        assert_eq!(slots.active().unwrap().slot, Slot::B);
        let slots = Slots { a: &new, b: &old };
        assert_eq!(slots.active().unwrap().slot, Slot::A);
        let blank = vec![0xff; 1000];
        let slots = Slots { a: &blank, b: &old };
        assert_eq!(slots.active().unwrap().slot, Slot::B);
        let slots = Slots { a: &blank, b: &blank };
        let none = slots.active().unwrap_err();
        assert!(matches!(none.a, SlotError::Unsound(TableError::Container(_))));
        assert_eq!(slots.admit(&uplink(1, (0, 900)), NOW), Ok(Slot::A));
    }

    #[test]
    fn a_write_that_is_cut_short_leaves_the_active_tables() {
        let active = padded(&uplink(4, (0, 900)));
        let candidate = uplink(5, (0, 900));
        let mut other = vec![0xff; 1000];
        for written in 0..=candidate.len() {
            other[..written].copy_from_slice(&candidate[..written]);
            let now_active = Slots { a: &active, b: &other }.active().unwrap();
            let expected = if written == candidate.len() { Slot::B } else { Slot::A };
            assert_eq!(now_active.slot, expected, "{written} bytes written");
        }
    }

    #[test]
    fn what_is_not_admitted_has_a_reason() {
        let (old, new) = (padded(&uplink(4, (0, 900))), padded(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        assert_eq!(slots.admit(&uplink(6, (0, 900)), NOW), Ok(Slot::A));
        let older = Refusal::Older { candidate: 5, newest: 5 };
        assert_eq!(slots.admit(&uplink(5, (0, 900)), NOW), Err(older));
        let ended = Instant::from_tai_ns(99);
        assert_eq!(slots.admit(&uplink(6, (0, 99)), NOW), Err(Refusal::Expired(ended)));
        let begins = Instant::from_tai_ns(101);
        assert_eq!(slots.admit(&uplink(6, (101, 900)), NOW), Err(Refusal::NotYetValid(begins)));
        let mut damaged = uplink(6, (0, 900));
        damaged[200] ^= 1;
        assert!(matches!(slots.admit(&damaged, NOW), Err(Refusal::Unsound(_))));
        let small = Slots { a: &old[..300], b: &new };
        assert_eq!(
            small.admit(&uplink(6, (0, 900)), NOW),
            Err(Refusal::TooLong(300, uplink(6, (0, 900)).len()))
        );
    }

    #[test]
    fn only_its_own_order_leads_back() {
        let (old, mut new) = (padded(&uplink(4, (0, 900))), padded(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        let digest = slots.tables(Slot::A).unwrap().set_digest();
        let order =
            RollbackOrder { from: 5, to: 4, to_digest: digest, until: Instant::from_tai_ns(200) };
        let late = Instant::from_tai_ns(201);
        assert_eq!(slots.roll_back(&order, late), Err(Refusal::OrderExpired(order.until)));
        let other = RollbackOrder { from: 6, ..order };
        assert_eq!(slots.roll_back(&other, NOW), Err(Refusal::NotActive(5)));
        let other = RollbackOrder { to_digest: digest ^ 1, ..order };
        assert_eq!(slots.roll_back(&other, NOW), Err(Refusal::NothingToReturnTo));
        assert_eq!(slots.roll_back(&order, NOW), Ok(Slot::B));

        assert!(revoke(&mut new));
        let slots = Slots { a: &old, b: &new };
        assert_eq!(slots.active().unwrap().slot, Slot::A);
        assert_eq!(slots.tables(Slot::B).unwrap_err(), SlotError::Revoked(5));
        assert_eq!(slots.roll_back(&order, NOW), Err(Refusal::NotActive(4)), "once only");
        let again = Refusal::Older { candidate: 5, newest: 5 };
        assert_eq!(slots.admit(&uplink(5, (0, 900)), NOW), Err(again), "not by the back door");
        assert_eq!(slots.admit(&uplink(6, (0, 900)), NOW), Ok(Slot::B));
    }

    #[test]
    fn a_cut_write_does_not_bring_a_revoked_container_back() {
        let (old, mut new) = (padded(&uplink(4, (0, 900))), padded(&uplink(5, (0, 900))));
        let whole = new.clone();
        assert!(revoke(&mut new));
        let candidate = uplink(6, (0, 900));
        // Behind the header the two are alike.
        for written in 0..HEADER_BYTES {
            let mut slot = new.clone();
            slot[..written].copy_from_slice(&candidate[..written]);
            let slots = Slots { a: &old, b: &slot };
            assert_eq!(slots.active().unwrap().slot, Slot::A, "{written} bytes written");
        }
        // Nor is the number forgotten where the revoking itself is cut behind the magic.
        let mut cut = whole;
        cut[..8].copy_from_slice(&REVOKED);
        let slots = Slots { a: &old, b: &cut };
        assert_eq!(slots.tables(Slot::B).unwrap_err(), SlotError::Revoked(5));
    }

    #[test]
    fn tables_must_cover_their_validity() {
        let candidate = uplink(1, (0, 1000));
        assert!(Tables::load(&candidate).is_ok(), "no body is needed with the circular Sun");
        assert!(!revoke(&mut [0; 10]));
    }
}
