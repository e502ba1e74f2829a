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
//! Limits: a container can be returned to [`FLOOR_WORDS`](super::slot_layout::FLOOR_WORDS) times, cuts in the middle of a floor word
//! counted; after that the way back is an upload of the older contents under a new number. An upset
//! that the memory does not correct costs its slot; the other one is then used.

use super::flash::{Revocation, Upload};
use super::slot_layout::{
    COMMIT_OFFSET, CONTAINER_OFFSET, Slot, Slots, WORD_BYTES, Word, commit_word,
    committed_sequence, floor, free_floor, image, is_erased, is_revoked, reads, slot_bytes,
    whole_header,
};
use super::{
    Container, Header, MissionChangeOrder, RollbackOrder, SequenceError, TableError, Tables,
    check_sequence,
};
use crate::bytes::{put, u32_at};
use crate::convert::{rolled, uncounted};
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
        match self.number(slot) {
            Ok(number) => SlotState::Committed(number),
            Err(state) => state,
        }
    }

    /// The tables of one slot.
    ///
    /// # Errors
    /// [`SlotState`], what it holds instead.
    #[inline(never)]
    pub fn tables(&self, slot: Slot) -> Result<Tables<'a>, SlotState> {
        self.number(slot)?;
        Tables::load(image(self.bytes(slot))).map_err(SlotState::Unsound)
    }

    /// The newest committed tables, from the slots' contents alone.
    ///
    /// # Errors
    /// [`NoTables`] when neither slot holds any.
    #[inline(never)]
    pub fn active(&self) -> Result<Active<'a>, NoTables> {
        let Some(slot) = self.active_slot() else {
            return Err(NoTables { a: self.state(Slot::A), b: self.state(Slot::B) });
        };
        // Not through `tables`, to spare the stack.
        match Tables::load(image(self.bytes(slot))) {
            Ok(tables) => Ok(Active { slot, tables }),
            Err(error) => {
                let state = SlotState::Unsound(error);
                Err(NoTables { a: state, b: state })
            }
        }
    }

    /// The slot of the newest committed tables.
    #[inline(never)]
    // REQ-SLOT-1.
    fn active_slot(&self) -> Option<Slot> {
        match (self.number(Slot::A).ok(), self.number(Slot::B).ok()) {
            (Some(a), Some(b)) if b > a => Some(Slot::B),
            (Some(_), _) => Some(Slot::A),
            (None, Some(_)) => Some(Slot::B),
            (None, None) => None,
        }
    }

    /// The sequence number of a slot's committed container, or what the slot holds instead.
    #[inline(never)]
    fn number(&self, slot: Slot) -> Result<u32, SlotState> {
        let number = own_number(self.bytes(slot))?;
        if self.is_under_floor(slot, number) {
            return Err(SlotState::Revoked(Some(number)));
        }
        Ok(number)
    }

    /// Whether the other slot says that a container with this number is revoked.
    fn is_under_floor(&self, slot: Slot, number: u32) -> bool {
        floor(self.bytes(slot.other())).is_some_and(|floor| number <= floor)
    }

    /// The largest sequence number that was committed or revoked, as far as the slots tell.
    // REQ-SLOT-4.
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
        let held = |slot| own_number(self.bytes(slot)).is_ok();
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
        let told = |slot| known_spacecraft(self.bytes(slot));
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
    // REQ-SLOT-7.
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
    // REQ-SLOT-6.
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
    // REQ-SLOT-5.
    pub fn roll_back(
        &self,
        order: &RollbackOrder,
        now: Instant,
    ) -> Result<Revocation, RollbackRefusal> {
        if now > order.until {
            return Err(RollbackRefusal::OrderExpired(order.until));
        }
        let active = self.active_slot().ok_or(RollbackRefusal::NothingToReturnTo)?;
        match self.number(active) {
            Ok(sequence) if sequence == order.from => {}
            Ok(sequence) => return Err(RollbackRefusal::NotActive(sequence)),
            Err(_) => return Err(RollbackRefusal::NothingToReturnTo),
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
    let mut head = [0; CONTAINER_OFFSET];
    put(&mut head, COMMIT_OFFSET, own_commit(container));
    let rest = head.get_mut(COMMIT_OFFSET + WORD_BYTES..).unwrap_or(&mut []);
    for byte in rest.iter_mut().take(uncounted(CONTAINER_OFFSET)) {
        rolled();
        *byte = 0xff;
    }
    head
}

/// The number of the container that a slot holds committed by itself, without the other one's floor.
#[inline(never)]
fn own_number(slot: &[u8]) -> Result<u32, SlotState> {
    if let Some(state) = uncommitted(slot) {
        return Err(state);
    }
    match Tables::load(image(slot)) {
        Ok(tables) if is_own_commit(slot, tables.container()) => Ok(tables.header().sequence),
        Ok(_) => Err(SlotState::CommitTorn),
        Err(error) => Err(SlotState::Unsound(error)),
    }
}

/// Whether the COMMIT word is that of the container in the slot.
#[inline(never)]
fn is_own_commit(slot: &[u8], container: &Container<'_>) -> bool {
    reads(slot, COMMIT_OFFSET, &own_commit(container))
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

/// The spacecraft in the header of a container that was committed or revoked.
#[inline(never)]
fn known_spacecraft(slot: &[u8]) -> Option<u32> {
    let counts = is_revoked(slot) || committed_sequence(slot).is_some();
    whole_header(slot).filter(|_| counts).and_then(|header| u32_at(header, 56))
}
