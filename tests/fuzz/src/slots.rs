//! Two slots under uplinks, cut uploads, rollbacks and damage, in any order.
//!
//! The bytes are a stream of operations, one byte each and its operands.

use crate::input::Input;
use onboard_core::time::Instant;
use onboard_core::uplink::{
    CONTAINER_OFFSET, Header, RollbackOrder, SectionKind, Slot, SlotState, Slots, Tables,
};
use std::sync::OnceLock;
use tests::Plain;
use tests::campaign::{ephemeris, sun, telescope};
use tests::uplink::{carry_out, container, mission, plan};

const ROOM: usize = CONTAINER_OFFSET + 704;
const OPERATIONS: usize = 24;
const VALID: i64 = 1_000;
/// First byte of an operation: what it does.
pub const UPLINK: u8 = 0;
/// An uplink that ends after so many operations.
pub const CUT_UPLINK: u8 = 1;
/// An uplink with a byte replaced.
pub const DAMAGED_UPLINK: u8 = 2;
/// An uplink with a section of another set.
pub const MIXED_UPLINK: u8 = 3;
/// The right order to return.
pub const ROLL_BACK: u8 = 4;
/// Any order to return.
pub const OTHER_ORDER: u8 = 5;
/// A byte in a slot replaced.
pub const DAMAGE: u8 = 6;
/// The slots exchanged.
pub const EXCHANGE: u8 = 7;
/// Time moved.
pub const TIME: u8 = 8;
const KINDS: u8 = 9;

/// The contents of the sections of every candidate; the plan is empty.
struct Contents {
    ephemeris: Vec<u8>,
    mission: Vec<u8>,
    plan: Vec<u8>,
}

fn contents() -> &'static Contents {
    static CONTENTS: OnceLock<Contents> = OnceLock::new();
    CONTENTS.get_or_init(|| Contents {
        ephemeris: ephemeris(),
        mission: mission(&Plain::LITEBIRD, sun(), &[telescope()]),
        plan: plan(&[]),
    })
}

/// A sound container; an odd sequence number has a plan.
fn candidate(sequence: u32, valid_until: i64) -> Vec<u8> {
    let header = Header {
        sequence,
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(valid_until),
        mission_digest: [0; 16],
        spacecraft: 1,
    };
    let all = contents();
    let sections: [(SectionKind, &[u8]); 3] = [
        (SectionKind::Ephemeris, &all.ephemeris),
        (SectionKind::Mission, &all.mission),
        (SectionKind::Plan, &all.plan),
    ];
    container(&header, if sequence % 2 == 1 { &sections } else { &sections[..2] })
}

struct Store {
    a: Vec<u8>,
    b: Vec<u8>,
    now: Instant,
}

/// Sequence number and digest of the tables in use, and their place.
type InUse = Option<(u32, u64, Slot)>;

impl Store {
    fn slots(&self) -> Slots<'_> {
        Slots { a: &self.a, b: &self.b }
    }

    fn bytes(&mut self, slot: Slot) -> &mut Vec<u8> {
        match slot {
            Slot::A => &mut self.a,
            Slot::B => &mut self.b,
        }
    }

    /// What both slots hold.
    fn states(&self) -> [SlotState; 2] {
        [Slot::A, Slot::B].map(|slot| self.slots().state(slot))
    }

    /// What is in use; it must be the newest sound container, wherever it lies.
    fn in_use(&self) -> InUse {
        let told = |slots: Slots<'_>| {
            let active = slots.active().ok()?;
            let tables = active.tables;
            Some((tables.header().sequence, tables.set_digest(), active.slot))
        };
        let active = told(self.slots());
        let sound = [Slot::A, Slot::B].map(|slot| self.slots().tables(slot).ok());
        let newest = sound.iter().flatten().map(|it| it.header().sequence).max();
        assert_eq!(active.map(|it| it.0), newest);
        let crossed = told(Slots { a: &self.b, b: &self.a });
        let same = sound.iter().flatten().count() == 2
            && sound[0].map(|it| it.header().sequence) == sound[1].map(|it| it.header().sequence);
        if !same {
            assert_eq!(crossed.map(|it| (it.0, it.1, it.2.other())), active);
        }
        active
    }

    /// Offers a candidate and, where it is admitted, carries so many operations out.
    fn offer(&mut self, candidate: &[u8], operations: usize) {
        let before = self.in_use();
        let Ok(mut upload) = self.slots().admit(candidate, self.now) else {
            assert_eq!(self.in_use(), before);
            return;
        };
        let tables = Tables::load(candidate).expect("an admitted container is sound");
        let sequence = tables.header().sequence;
        assert!(self.now <= tables.header().valid_until);
        for state in self.states() {
            if let SlotState::Committed(held) | SlotState::Revoked(Some(held)) = state {
                assert!(held < sequence, "by the back door");
            }
        }
        let slot = upload.slot();
        assert!(before.is_none_or(|(_, _, active)| active != slot), "over the active tables");
        for _ in 0..operations {
            let Some(operation) = upload.next(&self.slots()).expect("sound memory") else {
                assert_eq!(self.in_use(), Some((sequence, tables.set_digest(), slot)));
                return;
            };
            assert_ne!(self.in_use().map(|it| it.0), Some(sequence), "active before its end");
            carry_out(operation, [&mut self.a, &mut self.b]);
            let after = self.in_use();
            let whole = after == Some((sequence, tables.set_digest(), slot));
            assert!(whole || after == before, "a cut upload changed what is in use");
        }
    }

    /// Carries an order out, where it is accepted.
    fn order(&mut self, order: &RollbackOrder) {
        let before = self.in_use();
        let Ok(mut revocation) = self.slots().roll_back(order, self.now) else {
            assert_eq!(self.in_use(), before);
            return;
        };
        let slot = revocation.slot();
        let (sequence, _, active) = before.expect("something to leave");
        assert_eq!((sequence, active), (order.from, slot));
        assert!(self.now <= order.until);
        while let Some(operation) = revocation.next(&self.slots()).expect("sound memory") {
            carry_out(operation, [&mut self.a, &mut self.b]);
            let (sequence, digest, _) = self.in_use().expect("something to return to");
            assert_eq!((sequence, digest), (order.to, order.to_digest));
        }
        assert_eq!(self.slots().state(slot), SlotState::Revoked(Some(order.from)));
        assert!(self.slots().roll_back(order, self.now).is_err(), "carried out twice");
    }

    /// The order that leads back from what is in use, where there is one.
    fn right_order(&self) -> Option<RollbackOrder> {
        let (from, _, active) = self.in_use()?;
        let older = self.slots().tables(active.other()).ok()?;
        let (to, to_digest) = (older.header().sequence, older.set_digest());
        Some(RollbackOrder { from, to, to_digest, until: Instant::from_tai_ns(VALID) })
    }

    fn operate(&mut self, input: &mut Input<'_>) -> Option<()> {
        let operation = input.byte()? % KINDS;
        match operation {
            UPLINK | CUT_UPLINK | DAMAGED_UPLINK | MIXED_UPLINK => {
                let sequence = u32::from(input.byte()?);
                let mut bytes = candidate(sequence, if sequence == 200 { 1 } else { VALID });
                let mut operations = usize::MAX;
                if operation == CUT_UPLINK {
                    operations = usize::from(input.short()?);
                } else if operation == DAMAGED_UPLINK {
                    let at = usize::from(input.short()?) % bytes.len();
                    bytes[at] ^= input.byte()?;
                } else if operation == MIXED_UPLINK {
                    // The header of one set, the sections of the other.
                    let other = candidate(sequence ^ 1, VALID);
                    let length = bytes.len().min(other.len());
                    let from = usize::from(input.short()?) % length;
                    bytes[from..length].copy_from_slice(&other[from..length]);
                }
                self.offer(&bytes, operations);
            }
            ROLL_BACK => {
                if let Some(order) = self.right_order() {
                    self.order(&order);
                }
            }
            OTHER_ORDER => {
                let mut order = RollbackOrder {
                    from: u32::from(input.byte()?),
                    to: u32::from(input.byte()?),
                    to_digest: 0,
                    until: Instant::from_tai_ns(i64::from(input.byte()?) * 8),
                };
                if let Some(right) = self.right_order() {
                    order.to_digest = right.to_digest;
                }
                if let Ok(order) = RollbackOrder::from_le_bytes(&order.to_le_bytes()) {
                    self.order(&order);
                }
            }
            DAMAGE => {
                let slot = *input.choice(&[Slot::A, Slot::B])?;
                let at = usize::from(input.short()?) % ROOM;
                let value = input.byte()?;
                self.bytes(slot)[at] = value;
            }
            EXCHANGE => std::mem::swap(&mut self.a, &mut self.b),
            _ => self.now = Instant::from_tai_ns(i64::from(input.byte()?) * 8),
        }
        let _ = self.in_use();
        Some(())
    }
}

/// Carries out the operations in the bytes.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let now = Instant::from_tai_ns(100);
    let mut store = Store { a: vec![0xff; ROOM], b: vec![0xff; ROOM], now };
    for _ in 0..OPERATIONS {
        if store.operate(&mut input).is_none() {
            break;
        }
    }
}
