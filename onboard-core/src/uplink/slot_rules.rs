//! The rules of the slots, one by one: what is active, what is admitted, what leads back.

extern crate std;

use super::flash::{FlashOperation, Upload};
use super::slot_layout::{
    CONTAINER_OFFSET, FLOOR_OFFSET, FLOOR_WORDS, REVOKED_OFFSET, Slot, Slots, WORD_BYTES,
    floor_word, slot_bytes,
};
use super::slots::{NoTables, RollbackRefusal, SlotState, UploadRefusal, committed_head};
use super::tests::container_of;
use super::{
    Container, Counts, Header, MissionChangeOrder, MissionTable, RollbackOrder, SectionKind,
    SequenceError, SunRecord, Tables,
};
use crate::direction::MotionBounds;
use crate::ephemeris::{BodyRecord, Span, table_header};
use crate::phase::{Phase, Rotor, TurnRate};
use crate::scan::ScanParameters;
use crate::time::Instant;
use core::num::NonZeroU64;
use std::vec;
use std::vec::Vec;

const NOW: Instant = Instant::from_tai_ns(100);
const ROOM: usize = 1536;

fn ephemeris(coefficients: u16) -> Vec<u8> {
    let span = Span {
        body: 5,
        coefficients,
        granules: 1,
        first: 0,
        start: Instant::from_tai_ns(0),
        granule_ns: NonZeroU64::new(1000).unwrap(),
        bounds: MotionBounds { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 1.0 },
    };
    let body = BodyRecord { body: 5, spans: 1, first: 0, bounds: span.bounds };
    let mut bytes = table_header(1, 1, 3 * u32::from(coefficients)).to_vec();
    bytes.extend(body.to_le_bytes());
    bytes.extend(span.to_le_bytes());
    bytes.extend([0.0, 0.0, 1.0_f64].iter().flat_map(|number| number.to_le_bytes()));
    bytes.extend(vec![0; 24 * usize::from(coefficients - 1)]);
    bytes
}

/// A container with the circular Sun and no plan, valid for (from, until).
pub(super) fn uplink(sequence: u32, validity: (i64, i64)) -> Vec<u8> {
    uplink_for(1, sequence, validity, 1)
}

/// The same for a spacecraft, with an ephemeris of so many coefficients per component.
pub(super) fn uplink_for(
    spacecraft: u32,
    sequence: u32,
    (from, until): (i64, i64),
    coefficients: u16,
) -> Vec<u8> {
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
        spacecraft,
    };
    container_of(
        &header,
        &[(SectionKind::Ephemeris, &ephemeris(coefficients)), (SectionKind::Mission, &mission)],
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
// REQ-SLOT-1.
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
    let admit = |candidate: &[u8]| place(slots.admit(candidate, NOW)).map_err(std::boxed::Box::new);
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
// REQ-NUMBER-1.
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
// REQ-SLOT-6.
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
// REQ-SLOT-5.
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
// REQ-SLOT-4.
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
    assert!(matches!(floor, FlashOperation::Program { slot: Slot::A, offset: FLOOR_OFFSET, .. }));
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
// REQ-SLOT-4.
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
    assert_eq!(place(Slots { a: &new, b: &empty }.admit(&uplink(6, (0, 900)), NOW)), Ok(Slot::B));
    assert_eq!(place(Slots { a: &empty, b: &new }.admit(&uplink(6, (0, 900)), NOW)), Ok(Slot::A));
}

#[test]
// REQ-SLOT-1.
fn of_equal_numbers_the_first_slot_is_active() {
    let slot = slot_with(&uplink(4, (0, 900)));
    assert_eq!(Slots { a: &slot, b: &slot }.active().unwrap().slot, Slot::A);
}

#[test]
// REQ-SLOT-7.
fn a_container_fills_whole_words_and_no_more() {
    let mut exact = 0;
    for coefficients in 1..=4 {
        let container = uplink_for(1, 4, (0, 900), coefficients);
        let (mut a, mut b) = (blank(), blank());
        let mut upload = Slots { a: &a, b: &b }.admit(&container, NOW).unwrap();
        let mut programmed = 0;
        while let Some(operation) = upload.next(&Slots { a: &a, b: &b }).unwrap() {
            if matches!(operation, FlashOperation::Program { .. }) {
                programmed += 1;
            }
            carry_out(operation, &mut a, &mut b);
        }
        assert_eq!(programmed, container.len().div_ceil(WORD_BYTES) + 1, "and the commit");
        exact += usize::from(container.len().is_multiple_of(WORD_BYTES));
    }
    assert_eq!(exact, 1, "one of four lengths is whole words");
}

/// A slot with the container of this spacecraft and number, revoked.
fn revoked(spacecraft: u32, sequence: u32) -> Vec<u8> {
    let mut slot = slot_with(&uplink_for(spacecraft, sequence, (0, 900), 1));
    slot[REVOKED_OFFSET + 7] = 0x7f;
    slot
}

#[test]
// REQ-SLOT-7.
fn without_active_tables_the_newest_ones_tell_the_spacecraft() {
    let other = uplink_for(3, 9, (0, 900), 1);
    let told = |a: &[u8], b: &[u8]| match (Slots { a, b }).admit(&other, NOW) {
        Err(UploadRefusal::OtherSpacecraft { candidate: 3, flown }) => Some(flown),
        admitted => {
            assert!(admitted.is_ok());
            None
        }
    };
    let blank = blank();
    assert_eq!(told(&revoked(1, 4), &revoked(2, 5)), Some(2));
    assert_eq!(told(&revoked(1, 5), &revoked(2, 4)), Some(1));
    assert_eq!(told(&revoked(1, 5), &revoked(2, 5)), Some(1));
    assert_eq!(told(&revoked(1, 5), &blank), Some(1));
    assert_eq!(told(&blank, &revoked(2, 4)), Some(2));
    assert_eq!(told(&blank, &blank), None);
}

#[test]
// REQ-SLOT-4.
fn a_slot_that_holds_a_container_down_by_its_floor_is_not_erased() {
    // A holds 4, which B's floor revokes; A's own floor is higher than all that B knows.
    let (mut a, mut b) = (slot_with(&uplink(4, (0, 900))), blank());
    a[FLOOR_OFFSET..FLOOR_OFFSET + WORD_BYTES].copy_from_slice(&floor_word(7));
    b[FLOOR_OFFSET..FLOOR_OFFSET + WORD_BYTES].copy_from_slice(&floor_word(4));
    assert_eq!(floor_word(7)[12..16], (!7_u32).to_le_bytes());
    for (slots, free) in [(Slots { a: &a, b: &b }, Slot::A), (Slots { a: &b, b: &a }, Slot::B)] {
        assert!(slots.active().is_err());
        assert_eq!(place(slots.admit(&uplink(8, (0, 900)), NOW)), Ok(free));
    }
}
