//! Two slots of raw flash, of which the newest committed container is active.
//!
//! The slots are read in place; how each is divided stands in `slot_layout.rs`. Which one is active
//! follows from their contents alone, so that it is the same after a reset. A new container is
//! checked where it was received ([`Slots::admit`]) and goes into the slot that is not active
//! ([`Upload`]); it becomes active with its COMMIT word, and an upload that is cut short anywhere
//! leaves the other slot active. The only way to an older container is a [`RollbackOrder`]
//! ([`Slots::roll_back`], [`Revocation`]), the only way to another spacecraft's a
//! [`MissionChangeOrder`] ([`Slots::admit_changed`]).
//!
//! | state | what the slot holds | read as |
//! |---|---|---|
//! | erased | ones | [`SlotState::Erased`] |
//! | being written | part of a container | [`SlotState::BeingWritten`] |
//! | complete | a whole container, no COMMIT word | [`SlotState::Complete`] |
//! | torn | a COMMIT word that is not whole, or not this container's | [`SlotState::CommitTorn`] |
//! | committed | a container with its COMMIT word | [`SlotState::Committed`] |
//! | revoked | a REVOKED word, torn ones included, or a number up to the other slot's floor | [`SlotState::Revoked`] |
//! | unsound | a COMMIT word, but contents that are refused | [`SlotState::Unsound`] |
//!
//! The newest committed slot is active. A revoked number is remembered twice: by the REVOKED word and
//! by the floor word of the slot that was returned to, which is erased only when a newer container is
//! active. So an erase that is cut short, whatever bits it leaves, neither brings a revoked container
//! back nor lets its number be uploaded again (`power_cuts.rs` cuts everywhere).
//!
//! Limits: a container can be returned to [`FLOOR_WORDS`] times, cuts in the middle of a floor word
//! counted; after that the way back is an upload of the older contents under a new number. An upset
//! that the memory does not correct costs its slot; the other one is then used.

use super::flash::{Revocation, Upload};
use super::slot_layout::{
    COMMIT_OFFSET, CONTAINER_OFFSET, Slot, Slots, Word, commit_word, committed_sequence, floor,
    free_floor, image, is_erased, is_revoked, slot_bytes, whole_header, word_at,
};
use super::{
    Container, Header, MissionChangeOrder, RollbackOrder, SequenceError, TableError, Tables,
    check_sequence,
};
use crate::bytes::{put, u32_at};
use crate::time::Instant;

/// What a slot holds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SlotState {
    /// The slot is shorter than its head (its bytes).
    TooShort(usize),
    /// Nothing was written since the last erase.
    Erased,
    /// Part of a container, without COMMIT word: an upload that is under way or was cut short.
    BeingWritten,
    /// A whole container (its sequence number), but no COMMIT word.
    Complete(u32),
    /// A COMMIT word that is not whole, or not that of the container here.
    CommitTorn,
    /// A container (its sequence number) with its COMMIT word.
    Committed(u32),
    /// The container (its sequence number, where that is still readable) was rolled back.
    Revoked(Option<u32>),
    /// Committed, but its contents are refused.
    Unsound(TableError),
}

/// Neither slot holds tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoTables {
    /// What A holds instead.
    pub a: SlotState,
    /// What B holds instead.
    pub b: SlotState,
}

/// Why a new container is refused; the active tables stay.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum UploadRefusal {
    /// The candidate's contents.
    Unsound(TableError),
    /// The candidate's validity ended at this instant.
    Expired(Instant),
    /// The candidate's validity begins only at this instant.
    NotYetValid(Instant),
    /// The candidate's sequence number does not follow the newest in a slot, revoked ones included.
    Sequence(SequenceError),
    /// The candidate is another spacecraft's (identities).
    OtherSpacecraft {
        /// The candidate's.
        candidate: u32,
        /// The one that is flown.
        flown: u32,
    },
    /// The last instant of the order to change the mission has passed.
    OrderExpired(Instant),
    /// The order to change the mission names other spacecraft, or another container.
    OtherOrder,
    /// The candidate does not fit into the slot (bytes there, bytes needed).
    TooLong(usize, usize),
}

/// Why a rollback is refused; the active tables stay.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum RollbackRefusal {
    /// The order's last instant has passed.
    OrderExpired(Instant),
    /// The order leaves another container than the active one (its sequence number).
    NotActive(u32),
    /// The other slot does not hold the container that the order returns to.
    NothingToReturnTo,
    /// The validity of the container to return to ended at this instant.
    Expired(Instant),
    /// The validity of the container to return to begins only at this instant.
    NotYetValid(Instant),
    /// The container was returned to [`super::FLOOR_WORDS`] times: upload its contents anew.
    FloorsUsed,
}

/// The tables in use and where they are.
#[derive(Debug, Clone, Copy)]
pub struct Active<'a> {
    /// Their place.
    pub slot: Slot,
    /// The tables.
    pub tables: Tables<'a>,
}

/// Where an instant lies to a container's validity.
enum Outside {
    Before,
    Behind,
}

impl<'a> Slots<'a> {
    /// What a slot holds.
    #[must_use]
    #[inline(never)]
    pub fn state(&self, slot: Slot) -> SlotState {
        match self.tables(slot) {
            Ok(tables) => SlotState::Committed(tables.header().sequence),
            Err(state) => state,
        }
    }

    /// The tables of one slot.
    ///
    /// # Errors
    /// [`SlotState`], what it holds instead.
    #[inline(never)]
    pub fn tables(&self, slot: Slot) -> Result<Tables<'a>, SlotState> {
        let tables = own_tables(self.bytes(slot))?;
        let number = tables.header().sequence;
        if self.is_under_floor(slot, number) {
            return Err(SlotState::Revoked(Some(number)));
        }
        Ok(tables)
    }

    /// The newest committed tables, from the slots' contents alone.
    ///
    /// # Errors
    /// [`NoTables`] when neither slot holds any.
    #[inline(never)]
    pub fn active(&self) -> Result<Active<'a>, NoTables> {
        let slot = self.active_slot().ok_or_else(|| self.neither())?;
        match self.tables(slot) {
            Ok(tables) => Ok(Active { slot, tables }),
            Err(state) => Err(NoTables { a: state, b: state }),
        }
    }

    #[inline(never)]
    fn neither(&self) -> NoTables {
        NoTables { a: self.state(Slot::A), b: self.state(Slot::B) }
    }

    /// The slot of the newest committed tables.
    #[inline(never)]
    fn active_slot(&self) -> Option<Slot> {
        match (self.committed_number(Slot::A), self.committed_number(Slot::B)) {
            (Some(a), Some(b)) if b > a => Some(Slot::B),
            (Some(_), _) => Some(Slot::A),
            (None, Some(_)) => Some(Slot::B),
            (None, None) => None,
        }
    }

    /// The number of a slot's committed container.
    #[inline(never)]
    fn committed_number(&self, slot: Slot) -> Option<u32> {
        own_number(self.bytes(slot)).filter(|number| !self.is_under_floor(slot, *number))
    }

    /// Whether the other slot says that a container with this number is revoked.
    fn is_under_floor(&self, slot: Slot, number: u32) -> bool {
        floor(self.bytes(slot.other())).is_some_and(|floor| number <= floor)
    }

    /// The largest sequence number that was committed or revoked, as far as the slots tell.
    fn newest(&self) -> Option<u32> {
        known(self.a).max(known(self.b))
    }

    /// The slot that a new container goes to: not the active one, and none without which a revoked
    /// container would count again.
    #[inline(never)]
    fn free_slot(&self) -> Slot {
        if let Some(active) = self.active_slot() {
            return active.other();
        }
        let held = |slot| own_number(self.bytes(slot)).is_some();
        match (held(Slot::A), held(Slot::B)) {
            (true, _) => Slot::A,
            (_, true) => Slot::B,
            _ if known(self.a) <= known(self.b) => Slot::A,
            _ => Slot::B,
        }
    }

    /// The spacecraft whose tables are flown, or were last, as far as the slots tell.
    #[inline(never)]
    fn spacecraft(&self) -> Option<u32> {
        let told = |slot: Slot| {
            let bytes = self.bytes(slot);
            let counts = is_revoked(bytes) || committed_sequence(bytes).is_some();
            whole_header(bytes).filter(|_| counts).and_then(|header| u32_at(header, 56))
        };
        match self.active_slot() {
            Some(slot) => told(slot),
            None if known(self.a) < known(self.b) => told(Slot::B).or_else(|| told(Slot::A)),
            None => told(Slot::A).or_else(|| told(Slot::B)),
        }
    }

    /// Checks a new container; on success the way into the slot that is not active. With no container
    /// in either slot, that of any spacecraft is taken.
    ///
    /// # Errors
    /// [`UploadRefusal`], the reason; the active tables stay.
    #[inline(never)]
    pub fn admit<'c>(
        &self,
        candidate: &'c [u8],
        now: Instant,
    ) -> Result<Upload<'c>, UploadRefusal> {
        let (header, set_digest) = sound_header(candidate)?;
        if let Some(flown) = self.spacecraft()
            && header.spacecraft != flown
        {
            let candidate = header.spacecraft;
            return Err(UploadRefusal::OtherSpacecraft { candidate, flown });
        }
        self.place(candidate, header, set_digest, now)
    }

    /// As [`Self::admit`], for the one container of another spacecraft that the order names.
    ///
    /// # Errors
    /// [`UploadRefusal`], the reason; the active tables stay.
    #[inline(never)]
    pub fn admit_changed<'c>(
        &self,
        candidate: &'c [u8],
        order: &MissionChangeOrder,
        now: Instant,
    ) -> Result<Upload<'c>, UploadRefusal> {
        if now > order.until {
            return Err(UploadRefusal::OrderExpired(order.until));
        }
        let (header, set_digest) = sound_header(candidate)?;
        let named = header.spacecraft == order.to
            && header.sequence == order.sequence
            && set_digest == order.set_digest
            && self.spacecraft() == Some(order.from);
        if !named {
            return Err(UploadRefusal::OtherOrder);
        }
        self.place(candidate, header, set_digest, now)
    }

    /// The way of a sound container of the right spacecraft into the slot that is not active.
    fn place<'c>(
        &self,
        candidate: &'c [u8],
        header: Header,
        set_digest: u64,
        now: Instant,
    ) -> Result<Upload<'c>, UploadRefusal> {
        match outside(&header, now) {
            Some(Outside::Behind) => return Err(UploadRefusal::Expired(header.valid_until)),
            Some(Outside::Before) => return Err(UploadRefusal::NotYetValid(header.valid_from)),
            None => {}
        }
        check_sequence(header.sequence, self.newest()).map_err(UploadRefusal::Sequence)?;
        let slot = self.free_slot();
        let room = self.bytes(slot).len();
        let needed = slot_bytes(candidate.len()).unwrap_or(usize::MAX);
        if room < needed {
            return Err(UploadRefusal::TooLong(room, needed));
        }
        Ok(Upload::new(candidate, header, set_digest, slot))
    }

    /// Checks a rollback; on success the way to revoke the active container.
    ///
    /// # Errors
    /// [`RollbackRefusal`], the reason; the active tables stay.
    #[inline(never)]
    pub fn roll_back(
        &self,
        order: &RollbackOrder,
        now: Instant,
    ) -> Result<Revocation, RollbackRefusal> {
        if now > order.until {
            return Err(RollbackRefusal::OrderExpired(order.until));
        }
        let active = self.active_slot().ok_or(RollbackRefusal::NothingToReturnTo)?;
        match self.committed_number(active) {
            Some(sequence) if sequence == order.from => {}
            Some(sequence) => return Err(RollbackRefusal::NotActive(sequence)),
            None => return Err(RollbackRefusal::NothingToReturnTo),
        }
        let kept = active.other();
        let target = self.tables(kept).map_err(|_| RollbackRefusal::NothingToReturnTo)?;
        if target.header().sequence != order.to || target.set_digest() != order.to_digest {
            return Err(RollbackRefusal::NothingToReturnTo);
        }
        match outside(target.header(), now) {
            Some(Outside::Behind) => {
                return Err(RollbackRefusal::Expired(target.header().valid_until));
            }
            Some(Outside::Before) => {
                return Err(RollbackRefusal::NotYetValid(target.header().valid_from));
            }
            None => {}
        }
        let free = free_floor(self.bytes(kept)).ok_or(RollbackRefusal::FloorsUsed)?;
        Ok(Revocation::new(active, order.from, free))
    }
}

/// The head of a slot in which this container is committed: for memory that is programmed as a whole
/// before launch, and for tools.
#[must_use]
#[inline(never)]
pub fn committed_head(container: &Container<'_>) -> [u8; CONTAINER_OFFSET] {
    let mut head = [0xff; CONTAINER_OFFSET];
    put(&mut head, COMMIT_OFFSET, own_commit(container));
    head
}

/// The tables that a slot holds committed by itself, without the other one's floor.
#[inline(never)]
fn own_tables(slot: &[u8]) -> Result<Tables<'_>, SlotState> {
    uncommitted(slot).map_or(Ok(()), Err)?;
    let tables = Tables::load(image(slot)).map_err(SlotState::Unsound)?;
    if is_own_commit(slot, tables.container()) { Ok(tables) } else { Err(SlotState::CommitTorn) }
}

/// The number of the tables that a slot holds committed by itself.
#[inline(never)]
fn own_number(slot: &[u8]) -> Option<u32> {
    Some(own_tables(slot).ok()?.header().sequence)
}

/// Whether the COMMIT word is that of the container in the slot.
#[inline(never)]
fn is_own_commit(slot: &[u8], container: &Container<'_>) -> bool {
    word_at(slot, COMMIT_OFFSET) == Some(own_commit(container))
}

fn own_commit(container: &Container<'_>) -> Word {
    let length = u32::try_from(container.bytes.len()).unwrap_or(u32::MAX);
    commit_word(container.header.sequence, length, container.set_digest)
}

/// What a slot's words say it holds, unless they say that its container is committed.
#[inline(never)]
fn uncommitted(slot: &[u8]) -> Option<SlotState> {
    if slot.len() <= CONTAINER_OFFSET {
        return Some(SlotState::TooShort(slot.len()));
    }
    if is_revoked(slot) {
        return Some(SlotState::Revoked(known(slot)));
    }
    if !is_erased(slot, COMMIT_OFFSET) {
        return committed_sequence(slot).is_none().then_some(SlotState::CommitTorn);
    }
    Some(match Container::parse(image(slot)) {
        Ok(container) => SlotState::Complete(container.header().sequence),
        Err(_) if is_erased(slot, CONTAINER_OFFSET) => SlotState::Erased,
        Err(_) => SlotState::BeingWritten,
    })
}

/// The largest sequence number that a slot says was committed or revoked: in its COMMIT word, in its
/// container's header where one of these words was programmed, and in its floor words.
#[inline(never)]
fn known(slot: &[u8]) -> Option<u32> {
    let carried = committed_sequence(slot);
    let header = || whole_header(slot).and_then(|header| u32_at(header, 16));
    let own = if is_revoked(slot) { carried.max(header()) } else { carried };
    own.max(floor(slot))
}

#[inline(never)]
fn sound_header(candidate: &[u8]) -> Result<(Header, u64), UploadRefusal> {
    let tables = Tables::load(candidate).map_err(UploadRefusal::Unsound)?;
    Ok((*tables.header(), tables.set_digest()))
}

fn outside(header: &Header, now: Instant) -> Option<Outside> {
    if now > header.valid_until {
        Some(Outside::Behind)
    } else if now < header.valid_from {
        Some(Outside::Before)
    } else {
        None
    }
}

#[cfg(test)]
pub(super) mod tests {
    extern crate std;
    use super::*;
    use crate::direction::MotionBounds;
    use crate::ephemeris::Span;
    use crate::phase::{Phase, Rotor, TurnRate};
    use crate::scan::ScanParameters;
    use crate::uplink::flash::FlashOperation;
    use crate::uplink::slot_layout::{FLOOR_OFFSET, FLOOR_WORDS, REVOKED_OFFSET, WORD_BYTES};
    use crate::uplink::tests::container_of;
    use crate::uplink::{Counts, MissionTable, SectionKind, SunRecord};
    use core::num::NonZeroU64;
    use std::vec;
    use std::vec::Vec;

    const NOW: Instant = Instant::from_tai_ns(100);
    const ROOM: usize = 1536;

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
        let mut bytes = [1_u32.to_le_bytes(), 3_u32.to_le_bytes()].concat();
        bytes.extend(span.to_le_bytes());
        bytes.extend([0.0, 0.0, 1.0_f64].iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    /// A container with the circular Sun and no plan, valid for (from, until).
    pub(in crate::uplink) fn uplink(sequence: u32, (from, until): (i64, i64)) -> Vec<u8> {
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
            spacecraft: 1,
        };
        container_of(
            &header,
            &[(SectionKind::Ephemeris, &ephemeris()), (SectionKind::Mission, &mission)],
        )
    }

    /// Carries one operation out on memory that holds what it is given.
    fn carry_out(operation: FlashOperation, a: &mut [u8], b: &mut [u8]) {
        match operation {
            FlashOperation::Erase(Slot::A) => a.fill(0xff),
            FlashOperation::Erase(Slot::B) => b.fill(0xff),
            FlashOperation::Program { slot, offset, word } => {
                let bytes = if slot == Slot::A { a } else { b };
                bytes[offset..offset + WORD_BYTES].copy_from_slice(&word);
            }
        }
    }

    /// A slot with this container, committed.
    fn slot_with(container: &[u8]) -> Vec<u8> {
        let (mut a, mut b) = (blank(), blank());
        let mut upload = Slots { a: &a, b: &b }.admit(container, NOW).unwrap();
        assert_eq!(upload.slot(), Slot::A);
        while let Some(operation) = upload.next(&Slots { a: &a, b: &b }).unwrap() {
            carry_out(operation, &mut a, &mut b);
        }
        let whole = Container::parse(container).unwrap();
        assert_eq!(a[..CONTAINER_OFFSET], committed_head(&whole));
        a
    }

    fn blank() -> Vec<u8> {
        vec![0xff; ROOM]
    }

    fn order(slots: &Slots<'_>, from: u32, to: u32, kept: Slot) -> RollbackOrder {
        let to_digest = slots.tables(kept).unwrap().set_digest();
        RollbackOrder { from, to, to_digest, until: Instant::from_tai_ns(200) }
    }

    fn place(result: Result<Upload<'_>, UploadRefusal>) -> Result<Slot, UploadRefusal> {
        result.map(|upload| upload.slot())
    }

    #[test]
    fn the_newest_committed_slot_is_active_whatever_its_place() {
        let (old, new) = (slot_with(&uplink(4, (0, 900))), slot_with(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        assert_eq!(slots.active().unwrap().slot, Slot::B);
        let slots = Slots { a: &new, b: &old };
        assert_eq!(slots.active().unwrap().slot, Slot::A);
        let blank = blank();
        let slots = Slots { a: &blank, b: &old };
        assert_eq!(slots.active().unwrap().slot, Slot::B);
        let slots = Slots { a: &blank, b: &blank };
        let none = slots.active().unwrap_err();
        assert_eq!(none, NoTables { a: SlotState::Erased, b: SlotState::Erased });
        assert_eq!(place(slots.admit(&uplink(1, (0, 900)), NOW)), Ok(Slot::A));
    }

    #[test]
    fn every_state_has_its_name() {
        let container = uplink(4, (0, 900));
        let committed = slot_with(&container);
        let other = blank();
        let state = |a: &[u8]| Slots { a, b: &other }.state(Slot::A);
        let with = |change: fn(&mut Vec<u8>)| {
            let mut slot = committed.clone();
            change(&mut slot);
            state(&slot)
        };
        let uncommit = |slot: &mut Vec<u8>| slot[..WORD_BYTES].fill(0xff);
        assert_eq!(state(&committed), SlotState::Committed(4));
        assert_eq!(state(&other), SlotState::Erased);
        assert_eq!(state(&[]), SlotState::TooShort(0));
        assert_eq!(state(&committed[..CONTAINER_OFFSET]), SlotState::TooShort(512));
        assert_eq!(with(uncommit), SlotState::Complete(4));
        assert_eq!(with(|slot| slot[..32].fill(0)), SlotState::CommitTorn);
        assert_eq!(with(|slot| slot[REVOKED_OFFSET + 7] = 0x7f), SlotState::Revoked(Some(4)));
        assert_eq!(with(|slot| slot[32..700].fill(0)), SlotState::Revoked(Some(4)));
        assert_eq!(with(|slot| slot[..700].fill(0)), SlotState::Revoked(None));
        assert!(matches!(with(|slot| slot[700] ^= 1), SlotState::Unsound(_)));
        let mut begun = committed.clone();
        uncommit(&mut begun);
        begun[700..].fill(0xff);
        assert_eq!(state(&begun), SlotState::BeingWritten);
        // The COMMIT word of another container of the same number.
        let mut swapped = slot_with(&uplink(4, (0, 901)));
        let longer = slot_with(&container_with_plan());
        swapped[..WORD_BYTES].copy_from_slice(&longer[..WORD_BYTES]);
        assert_eq!(state(&swapped), SlotState::CommitTorn);
    }

    fn container_with_plan() -> Vec<u8> {
        changed(4, |_| ())
    }

    /// A container with an empty plan and another header.
    fn changed(sequence: u32, change: fn(&mut Header)) -> Vec<u8> {
        let whole = uplink(sequence, (0, 900));
        let container = Container::parse(&whole).unwrap();
        let mut header = container.header();
        change(&mut header);
        let plan = [0; 8];
        let section = |kind| container.section(kind).unwrap();
        container_of(
            &header,
            &[
                (SectionKind::Ephemeris, section(SectionKind::Ephemeris)),
                (SectionKind::Mission, section(SectionKind::Mission)),
                (SectionKind::Plan, &plan),
            ],
        )
    }

    #[test]
    fn what_is_not_admitted_has_a_reason() {
        let (old, new) = (slot_with(&uplink(4, (0, 900))), slot_with(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        let admit =
            |candidate: &[u8]| place(slots.admit(candidate, NOW)).map_err(std::boxed::Box::new);
        let refused = |candidate: &[u8]| *admit(candidate).unwrap_err();
        assert_eq!(*admit(&uplink(6, (0, 900))).as_ref().unwrap(), Slot::A);
        let older = UploadRefusal::Sequence(SequenceError::Older { candidate: 5, newest: 5 });
        assert_eq!(refused(&uplink(5, (0, 900))), older);
        let ended = Instant::from_tai_ns(99);
        assert_eq!(refused(&uplink(6, (0, 99))), UploadRefusal::Expired(ended));
        let begins = Instant::from_tai_ns(101);
        assert_eq!(refused(&uplink(6, (101, 900))), UploadRefusal::NotYetValid(begins));
        let mut damaged = uplink(6, (0, 900));
        damaged[200] ^= 1;
        assert!(matches!(refused(&damaged), UploadRefusal::Unsound(_)));
        let needed = slot_bytes(uplink(6, (0, 900)).len()).unwrap();
        let small = Slots { a: &old[..needed - 1], b: &new };
        assert_eq!(
            place(small.admit(&uplink(6, (0, 900)), NOW)),
            Err(UploadRefusal::TooLong(needed - 1, needed))
        );
        let room = Slots { a: &old[..needed], b: &new };
        assert_eq!(place(room.admit(&uplink(6, (0, 900)), NOW)), Ok(Slot::A));
    }

    #[test]
    fn a_step_that_is_too_large_is_refused() {
        let (old, new) = (slot_with(&uplink(4, (0, 900))), slot_with(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        let admit = |number| place(slots.admit(&uplink(number, (0, 900)), NOW));
        assert_eq!(admit(1005), Ok(Slot::A));
        for candidate in [1006, u32::MAX] {
            let far = SequenceError::StepTooLarge { candidate, newest: 5 };
            assert_eq!(admit(candidate), Err(UploadRefusal::Sequence(far)));
        }
        let empty = blank();
        let first = Slots { a: &empty, b: &empty };
        let far = SequenceError::StepTooLarge { candidate: u32::MAX, newest: 0 };
        assert_eq!(
            place(first.admit(&uplink(u32::MAX, (0, 900)), NOW)),
            Err(UploadRefusal::Sequence(far))
        );
    }

    #[test]
    fn another_spacecraft_comes_only_with_its_order() {
        let old = slot_with(&uplink(4, (0, 900)));
        let empty = blank();
        let slots = Slots { a: &old, b: &empty };
        // The same spacecraft with another mission file is taken.
        let edited = changed(5, |header| header.mission_digest = [7; 16]);
        assert_eq!(place(slots.admit(&edited, NOW)), Ok(Slot::B));
        let other = changed(5, |header| header.spacecraft = 2);
        let refusal = UploadRefusal::OtherSpacecraft { candidate: 2, flown: 1 };
        assert_eq!(place(slots.admit(&other, NOW)), Err(refusal));
        let order = MissionChangeOrder {
            from: 1,
            to: 2,
            sequence: 5,
            set_digest: Tables::load(&other).unwrap().set_digest(),
            until: NOW,
        };
        let with = |order: &MissionChangeOrder, now| place(slots.admit_changed(&other, order, now));
        assert_eq!(with(&order, NOW), Ok(Slot::B));
        let late = Instant::from_tai_ns(101);
        assert_eq!(with(&order, late), Err(UploadRefusal::OrderExpired(NOW)));
        for wrong in [
            MissionChangeOrder { from: 3, ..order },
            MissionChangeOrder { to: 1, ..order },
            MissionChangeOrder { sequence: 6, ..order },
            MissionChangeOrder { set_digest: 0, ..order },
        ] {
            assert_eq!(with(&wrong, NOW), Err(UploadRefusal::OtherOrder));
        }
        // It is not forgotten when the tables are damaged, or revoked.
        let mut damaged = old.clone();
        damaged[700] ^= 1;
        let slots = Slots { a: &empty, b: &damaged };
        assert_eq!(place(slots.admit(&other, NOW)), Err(refusal));
        damaged[REVOKED_OFFSET] = 0;
        let slots = Slots { a: &damaged, b: &empty };
        assert_eq!(place(slots.admit(&other, NOW)), Err(refusal));
        // The first container may be anyone's.
        assert_eq!(place(Slots { a: &empty, b: &empty }.admit(&other, NOW)), Ok(Slot::A));
    }

    #[test]
    fn a_rollback_that_does_not_fit_is_refused_with_its_reason() {
        let (old, new) = (slot_with(&uplink(4, (0, 900))), slot_with(&uplink(5, (0, 900))));
        let slots = Slots { a: &old, b: &new };
        let order = order(&slots, 5, 4, Slot::A);
        let refused = |order: &RollbackOrder, now| slots.roll_back(order, now).unwrap_err();
        let late = Instant::from_tai_ns(201);
        assert_eq!(refused(&order, late), RollbackRefusal::OrderExpired(order.until));
        assert!(slots.roll_back(&order, order.until).is_ok());
        let other = RollbackOrder { from: 6, ..order };
        assert_eq!(refused(&other, NOW), RollbackRefusal::NotActive(5));
        let other = RollbackOrder { to_digest: order.to_digest ^ 1, ..order };
        assert_eq!(refused(&other, NOW), RollbackRefusal::NothingToReturnTo);
        let other = RollbackOrder { to: 3, ..order };
        assert_eq!(refused(&other, NOW), RollbackRefusal::NothingToReturnTo);
    }

    #[test]
    fn there_is_no_return_to_expired_tables() {
        for (validity, refusal) in [
            ((0, 150), RollbackRefusal::Expired(Instant::from_tai_ns(150))),
            ((0, 900), RollbackRefusal::NotYetValid(Instant::from_tai_ns(0))),
        ] {
            let (old, new) = (slot_with(&uplink(4, validity)), slot_with(&uplink(5, (0, 900))));
            let slots = Slots { a: &old, b: &new };
            let order = order(&slots, 5, 4, Slot::A);
            let at = if validity.1 == 150 { 151 } else { -1 };
            assert_eq!(slots.roll_back(&order, Instant::from_tai_ns(at)).unwrap_err(), refusal);
            let edge = if validity.1 == 150 { 150 } else { 0 };
            assert!(slots.roll_back(&order, Instant::from_tai_ns(edge)).is_ok());
        }
    }

    #[test]
    fn only_its_own_order_leads_back_and_once() {
        let (mut old, mut new) = (slot_with(&uplink(4, (0, 900))), slot_with(&uplink(5, (0, 900))));
        let order = order(&Slots { a: &old, b: &new }, 5, 4, Slot::A);
        let mut revocation = Slots { a: &old, b: &new }.roll_back(&order, NOW).unwrap();
        assert_eq!(revocation.slot(), Slot::B);
        let mut programmed = Vec::new();
        while let Some(operation) = revocation.next(&Slots { a: &old, b: &new }).unwrap() {
            carry_out(operation, &mut old, &mut new);
            programmed.push(operation);
        }
        let [floor, revoked] = programmed[..] else { panic!("{programmed:?}") };
        assert!(matches!(
            floor,
            FlashOperation::Program { slot: Slot::A, offset: FLOOR_OFFSET, .. }
        ));
        let word = [0; WORD_BYTES];
        assert_eq!(
            revoked,
            FlashOperation::Program { slot: Slot::B, offset: REVOKED_OFFSET, word },
            "one program operation on erased words"
        );
        let slots = Slots { a: &old, b: &new };
        assert_eq!(slots.active().unwrap().slot, Slot::A);
        assert_eq!(slots.tables(Slot::B).unwrap_err(), SlotState::Revoked(Some(5)));
        let twice = slots.roll_back(&order, NOW).unwrap_err();
        assert_eq!(twice, RollbackRefusal::NotActive(4), "once only");
        let again = UploadRefusal::Sequence(SequenceError::Older { candidate: 5, newest: 5 });
        assert_eq!(place(slots.admit(&uplink(5, (0, 900)), NOW)), Err(again), "by the back door");
        assert_eq!(place(slots.admit(&uplink(6, (0, 900)), NOW)), Ok(Slot::B));
        // Either word alone keeps the number revoked.
        new[REVOKED_OFFSET..FLOOR_OFFSET].fill(0xff);
        assert_eq!(Slots { a: &old, b: &new }.state(Slot::B), SlotState::Revoked(Some(5)));
        new.fill(0xff);
        let erased = Slots { a: &old, b: &new };
        assert_eq!(place(erased.admit(&uplink(5, (0, 900)), NOW)), Err(again), "by the back door");
    }

    #[test]
    fn a_container_can_be_returned_to_as_often_as_there_are_floor_words() {
        let (mut a, mut b) = (slot_with(&uplink(4, (0, 900))), blank());
        for number in 5..=5 + u32::try_from(FLOOR_WORDS).unwrap() {
            let candidate = uplink(number, (0, 900));
            let mut upload = Slots { a: &a, b: &b }.admit(&candidate, NOW).unwrap();
            while let Some(operation) = upload.next(&Slots { a: &a, b: &b }).unwrap() {
                carry_out(operation, &mut a, &mut b);
            }
            let order = order(&Slots { a: &a, b: &b }, number, 4, Slot::A);
            let result = Slots { a: &a, b: &b }.roll_back(&order, NOW);
            if number == 5 + u32::try_from(FLOOR_WORDS).unwrap() {
                assert_eq!(result.unwrap_err(), RollbackRefusal::FloorsUsed);
                break;
            }
            let mut revocation = result.unwrap();
            while let Some(operation) = revocation.next(&Slots { a: &a, b: &b }).unwrap() {
                carry_out(operation, &mut a, &mut b);
            }
            assert_eq!(Slots { a: &a, b: &b }.active().unwrap().tables.header().sequence, 4);
        }
        // The uplink stays open.
        let candidate = uplink(100, (0, 900));
        assert_eq!(place(Slots { a: &a, b: &b }.admit(&candidate, NOW)), Ok(Slot::A));
    }

    #[test]
    fn without_active_tables_what_holds_a_revoked_number_down_is_kept() {
        let (mut old, mut new) = (slot_with(&uplink(4, (0, 900))), slot_with(&uplink(5, (0, 900))));
        let order = order(&Slots { a: &old, b: &new }, 5, 4, Slot::A);
        let mut revocation = Slots { a: &old, b: &new }.roll_back(&order, NOW).unwrap();
        let floor = revocation.next(&Slots { a: &old, b: &new }).unwrap().unwrap();
        carry_out(floor, &mut old, &mut new);
        // The REVOKED word is not written, and the slot returned to is damaged.
        old[700] ^= 1;
        let slots = Slots { a: &old, b: &new };
        assert!(slots.active().is_err());
        assert_eq!(place(slots.admit(&uplink(6, (0, 900)), NOW)), Ok(Slot::B));
        let slots = Slots { a: &new, b: &old };
        assert_eq!(place(slots.admit(&uplink(6, (0, 900)), NOW)), Ok(Slot::A));
        // With the REVOKED word, the slot with the smaller number goes.
        new[REVOKED_OFFSET] = 0;
        let empty = blank();
        assert_eq!(
            place(Slots { a: &new, b: &empty }.admit(&uplink(6, (0, 900)), NOW)),
            Ok(Slot::B)
        );
        assert_eq!(
            place(Slots { a: &empty, b: &new }.admit(&uplink(6, (0, 900)), NOW)),
            Ok(Slot::A)
        );
    }
}
