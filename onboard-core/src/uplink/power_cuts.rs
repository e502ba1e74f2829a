//! Power cuts at every operation of uploads, rollbacks and uploads after them, on simulated flash.
//!
//! The flash erases by sectors to ones, programs by units of 8, 16 or 32 bytes, each once between two
//! erases (a second time fails the test), and only clears bits. A cut leaves the unit or sector under
//! way with none, all, or a random part of its bits changed, or unreadable. A unit whose programming
//! was cut may read as erased; programmed again, it becomes unreadable. After every cut: the active
//! container is the one before or the one after the step, nothing revoked is active or admitted again,
//! and the step can be repeated.

#![expect(
    clippy::panic_in_result_fn,
    reason = "an error is a cut that the simulation wants; what must not happen panics"
)]

extern crate std;

use super::slot_rules::uplink;
use super::{
    CONTAINER_OFFSET, FlashOperation, RollbackOrder, RollbackRefusal, SequenceError, Slot, Slots,
    UploadRefusal,
};
use crate::time::Instant;
use std::collections::BTreeSet;
use std::vec;
use std::vec::Vec;

const NOW: Instant = Instant::from_tai_ns(100);
const VALID: (i64, i64) = (0, 900);
const ROOM: usize = 1536;
const SECTOR: usize = 512;

/// Small, seeded, good enough to choose bits.
#[derive(Clone)]
struct Noise(u64);

impl Noise {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: u64) -> u64 {
        self.bits() % end
    }

    fn choose(&mut self, end: u64) -> usize {
        usize::try_from(self.below(end)).unwrap()
    }

    /// A byte with about an eighth, a half or seven eighths of its bits set.
    fn mask(&mut self, density: u64) -> u8 {
        let [a, b, c, ..] = self.bits().to_le_bytes();
        match density {
            0 => a & b & c,
            1 => a,
            _ => a | b | c,
        }
    }
}

/// What a cut leaves of the unit or sector under way.
#[derive(Debug, Clone, Copy)]
enum Tear {
    Nothing,
    All,
    /// A random part of the bits, of this density.
    Part(u64),
    /// A unit that the controller cannot correct, handed in as zeros.
    Unreadable,
}

const TEARS: [Tear; 6] =
    [Tear::Nothing, Tear::All, Tear::Part(0), Tear::Part(1), Tear::Part(2), Tear::Unreadable];

/// What was done to a unit since its sector was erased.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Use {
    Erased,
    /// Its erase or its programming was cut short.
    Torn,
    Programmed,
}

/// Power was cut.
#[derive(Debug)]
struct Cut;

#[derive(Clone)]
struct Flash {
    slots: [Vec<u8>; 2],
    used: [Vec<Use>; 2],
    unit: usize,
    noise: Noise,
    /// Erases and programs of sectors and units so far.
    done: u64,
    cut: Option<(u64, Tear)>,
}

impl Flash {
    fn new(unit: usize, seed: u64) -> Self {
        Self {
            slots: [vec![0xff; ROOM], vec![0xff; ROOM]],
            used: [vec![Use::Erased; ROOM / unit], vec![Use::Erased; ROOM / unit]],
            unit,
            noise: Noise(seed),
            done: 0,
            cut: None,
        }
    }

    fn slots(&self) -> Slots<'_> {
        Slots { a: &self.slots[0], b: &self.slots[1] }
    }

    /// How the next sector or unit ends.
    fn tear(&mut self) -> Option<Tear> {
        self.done += 1;
        let (at, tear) = self.cut?;
        (at == self.done).then(|| {
            self.cut = None;
            tear
        })
    }

    fn erase(&mut self, slot: usize) -> Result<(), Cut> {
        for sector in 0..ROOM / SECTOR {
            let (from, until) = (sector * SECTOR, (sector + 1) * SECTOR);
            let tear = self.tear();
            for at in from..until {
                let byte = self.slots[slot][at];
                self.slots[slot][at] = match tear {
                    None | Some(Tear::All) => 0xff,
                    Some(Tear::Nothing) => byte,
                    Some(Tear::Part(density)) => byte | self.noise.mask(density),
                    // Words at random whole, erased or unreadable.
                    Some(Tear::Unreadable) => match (at / self.unit + at / 97) % 3 {
                        0 => byte,
                        1 => 0xff,
                        _ => 0,
                    },
                };
            }
            let done = if tear.is_some() { Use::Torn } else { Use::Erased };
            self.used[slot][from / self.unit..until / self.unit].fill(done);
            if tear.is_some() {
                return Err(Cut);
            }
        }
        Ok(())
    }

    fn program(&mut self, slot: usize, offset: usize, word: &[u8]) -> Result<(), Cut> {
        assert_eq!(offset % word.len(), 0, "alignment");
        for (index, unit) in word.chunks(self.unit).enumerate() {
            let from = offset + index * self.unit;
            let mut tear = self.tear();
            let used = &mut self.used[slot][from / self.unit];
            assert_ne!(*used, Use::Programmed, "a unit is programmed twice");
            let cut = tear.is_some();
            if *used == Use::Torn {
                tear = Some(Tear::Unreadable);
            }
            *used = if cut { Use::Torn } else { Use::Programmed };
            for (at, new) in (from..).zip(unit) {
                let kept = match tear {
                    None | Some(Tear::All) => 0,
                    Some(Tear::Nothing) => 0xff,
                    Some(Tear::Part(density)) => self.noise.mask(density),
                    Some(Tear::Unreadable) => {
                        self.slots[slot][at] = 0;
                        continue;
                    }
                };
                assert_eq!(self.slots[slot][at], 0xff, "programmed over what was not erased");
                self.slots[slot][at] &= new | kept;
            }
            if cut {
                return Err(Cut);
            }
        }
        Ok(())
    }

    fn carry_out(&mut self, operation: FlashOperation) -> Result<(), Cut> {
        let index = |slot| usize::from(slot == Slot::B);
        match operation {
            FlashOperation::Erase(slot) => self.erase(index(slot)),
            FlashOperation::Program { slot, offset, word } => {
                self.program(index(slot), offset, &word)
            }
        }
    }

    fn active(&self) -> Option<u32> {
        self.slots().active().ok().map(|active| active.tables.header().sequence)
    }
}

/// What the ground asks for.
#[derive(Debug, Clone, Copy)]
enum Step {
    Upload(u32),
    /// From the active container to the other one.
    RollBack,
}

/// The flash, and what must hold of it.
#[derive(Clone)]
struct Flight {
    flash: Flash,
    revoked: BTreeSet<u32>,
}

impl Flight {
    fn new(unit: usize, seed: u64) -> Self {
        Self { flash: Flash::new(unit, seed), revoked: BTreeSet::new() }
    }

    /// The order from the active container to the one in the other slot.
    fn order(&self) -> Option<RollbackOrder> {
        let slots = self.flash.slots();
        let active = slots.active().ok()?;
        let kept = slots.tables(active.slot.other()).ok()?;
        Some(RollbackOrder {
            from: active.tables.header().sequence,
            to: kept.header().sequence,
            to_digest: kept.set_digest(),
            until: NOW,
        })
    }

    /// Carries a step out to its end or to the cut; the active container afterwards must be the one
    /// before or the one after.
    fn step(&mut self, step: Step) -> Result<(), Cut> {
        let before = self.flash.active();
        let (result, after) = match step {
            Step::Upload(number) => (self.upload(number), Some(number)),
            Step::RollBack => match self.order() {
                Some(order) => (self.roll_back(&order), Some(order.to)),
                None => return Ok(()),
            },
        };
        let active = self.flash.active();
        match result {
            Ok(()) => assert_eq!(active, after, "{step:?} carried out"),
            Err(Cut) => assert!(active == before || active == after, "{step:?}: {active:?}"),
        }
        if let (Step::RollBack, Some(from)) = (step, before)
            && active == after
        {
            self.revoked.insert(from);
        }
        self.check();
        result
    }

    fn upload(&mut self, number: u32) -> Result<(), Cut> {
        let candidate = uplink(number, VALID);
        let slots = self.flash.slots();
        let mut upload = slots.admit(&candidate, NOW).expect("a new number");
        if let Ok(active) = slots.active() {
            assert_ne!(upload.slot(), active.slot, "over the active tables");
        }
        while let Some(operation) = upload.next(&self.flash.slots()).expect("sound flash") {
            self.flash.carry_out(operation)?;
        }
        Ok(())
    }

    fn roll_back(&mut self, order: &RollbackOrder) -> Result<(), Cut> {
        let mut revocation = match self.flash.slots().roll_back(order, NOW) {
            Ok(revocation) => revocation,
            Err(RollbackRefusal::FloorsUsed) => return Err(Cut),
            Err(other) => panic!("{other:?}"),
        };
        // A word whose programming was cut once before may not take the next one either.
        while let Some(operation) = revocation.next(&self.flash.slots()).map_err(|_| Cut)? {
            self.flash.carry_out(operation)?;
        }
        Ok(())
    }

    /// Nothing revoked is active or comes in again.
    fn check(&self) {
        let slots = self.flash.slots();
        let active = self.flash.active();
        for number in &self.revoked {
            assert_ne!(active, Some(*number), "revoked and active");
            for slot in [Slot::A, Slot::B] {
                let held = slots.tables(slot).ok().map(|tables| tables.header().sequence);
                assert_ne!(held, Some(*number), "revoked and whole");
            }
            let again = slots.admit(&uplink(*number, VALID), NOW).map(|_| ());
            let older =
                |error| matches!(error, UploadRefusal::Sequence(SequenceError::Older { .. }));
            assert!(again.is_err_and(older), "{number}: {again:?}");
        }
    }
}

/// Uploads into either slot, rollbacks from either, two from one container, uploads over what was
/// revoked and over what was not.
const SCRIPT: [Step; 12] = [
    Step::Upload(1),
    Step::Upload(2),
    Step::RollBack,
    Step::Upload(3),
    Step::RollBack,
    Step::Upload(4),
    Step::Upload(5),
    Step::RollBack,
    Step::Upload(6),
    Step::Upload(7),
    Step::Upload(8),
    Step::RollBack,
];

/// Where the script ends: 7 of 8.
const LAST: Option<u32> = Some(7);

/// Carries the script out; a step that was cut is ordered again, unless it was carried out.
fn fly(flight: &mut Flight, script: &[Step], second: Option<(u64, Tear)>) {
    let mut second = second;
    for step in script {
        let before = flight.flash.active();
        while flight.step(*step).is_err() {
            if let Some((later, tear)) = second.take() {
                flight.flash.cut = Some((flight.flash.done + later, tear));
            }
            let carried_out = match step {
                Step::Upload(number) => flight.flash.active() == Some(*number),
                Step::RollBack => flight.flash.active() != before,
            };
            if carried_out {
                break;
            }
        }
    }
}

/// Every operation of every step is cut in every way; then the step is repeated and two more follow.
#[test]
// REQ-SLOT-2.
fn a_cut_at_every_operation_of_every_kind_loses_nothing() {
    for unit in [8, 16, 32] {
        let mut before = Flight::new(unit, 1);
        for first in 0..SCRIPT.len() {
            let script = &SCRIPT[first..SCRIPT.len().min(first + 3)];
            let mut whole = before.clone();
            fly(&mut whole, &script[..1], None);
            let (from, until) = (before.flash.done + 1, whole.flash.done);
            let next = whole.clone();
            fly(&mut whole, &script[1..], None);
            for (number, tear) in (0_u64..).zip(TEARS) {
                for at in from..=until {
                    let mut flight = before.clone();
                    flight.flash.noise = Noise(at * 8 + number);
                    flight.flash.cut = Some((at, tear));
                    fly(&mut flight, script, None);
                    assert_eq!(flight.flash.active(), whole.flash.active(), "{tear:?} at {at}");
                    assert_eq!(flight.revoked, whole.revoked, "{tear:?} at {at}");
                }
            }
            before = next;
        }
        assert!(before.flash.done > 100, "{} operations", before.flash.done);
        assert_eq!(before.flash.active(), LAST);
        assert_eq!(before.revoked, BTreeSet::from([2, 3, 5, 8]));
    }
}

#[test]
// REQ-SLOT-2.
fn a_second_cut_while_the_step_is_repeated_loses_nothing() {
    let mut whole = Flight::new(16, 1);
    fly(&mut whole, &SCRIPT, None);
    let mut noise = Noise(5);
    for at in (1..=whole.flash.done).step_by(3) {
        let mut flight = Flight::new(16, at);
        flight.flash.cut = Some((at, TEARS[noise.choose(6)]));
        let second = (1 + noise.below(60), TEARS[noise.choose(6)]);
        fly(&mut flight, &SCRIPT, Some(second));
        assert_eq!(flight.flash.active(), LAST);
        assert_eq!(flight.revoked, BTreeSet::from([2, 3, 5, 8]));
    }
}

/// Steps at random, every third one cut: whatever the order, what holds of one cut holds of many.
#[test]
// REQ-SLOT-2.
fn many_cuts_in_any_order_lose_nothing() {
    let mut carried_out = 0;
    for seed in 0..100 {
        let mut noise = Noise(seed);
        let mut flight = Flight::new([8, 16, 32][noise.choose(3)], seed);
        let mut number = 0;
        for _ in 0..24 {
            if noise.below(3) == 0 {
                let at = flight.flash.done + 1 + noise.below(50);
                flight.flash.cut = Some((at, TEARS[noise.choose(6)]));
            } else {
                flight.flash.cut = None;
            }
            let step = if noise.below(5) < 2 {
                Step::RollBack
            } else {
                number += 1 + u32::try_from(noise.below(3)).unwrap();
                Step::Upload(number)
            };
            carried_out += u32::from(flight.step(step).is_ok());
        }
        assert!(flight.flash.active().is_some());
    }
    assert!(carried_out > 1000, "{carried_out}");
}

#[test]
fn flash_that_fails_ends_the_plan() {
    use super::FlashError;
    let candidate = uplink(1, VALID);
    let flash = Flash::new(32, 0);
    // The erase did nothing to a slot that was written.
    let mut written = flash.slots[0].clone();
    written[40] = 0;
    let slots = Slots { a: &written, b: &flash.slots[1] };
    let mut upload = slots.admit(&candidate, NOW).unwrap();
    assert_eq!(upload.next(&slots), Ok(Some(FlashOperation::Erase(Slot::A))));
    assert_eq!(upload.next(&slots), Err(FlashError::NotErased(Slot::A, 32)));
    assert_eq!(upload.next(&slots), Ok(None), "nothing follows");
    // A word takes nothing.
    let slots = flash.slots();
    let mut upload = slots.admit(&candidate, NOW).unwrap();
    assert!(upload.next(&slots).is_ok() && upload.next(&slots).is_ok());
    let failed = FlashError::NotProgrammed(Slot::A, CONTAINER_OFFSET);
    assert_eq!(upload.next(&slots), Err(failed));
    // What was written changes before it is committed: a flipped bit, another container's header.
    let mut flash = Flash::new(32, 0);
    let mut upload = flash.slots().admit(&candidate, NOW).unwrap();
    for _ in 0..=candidate.len().div_ceil(32) {
        let operation = upload.next(&flash.slots()).unwrap().unwrap();
        flash.carry_out(operation).unwrap();
    }
    let slot = &mut flash.slots[0][CONTAINER_OFFSET..];
    slot[100] ^= 1;
    assert!(matches!(upload.clone().next(&flash.slots()), Err(FlashError::Unsound(_))));
    flash.slots[0][CONTAINER_OFFSET..][..candidate.len()].copy_from_slice(&uplink(2, VALID));
    assert_eq!(upload.clone().next(&flash.slots()), Err(FlashError::Changed));
    flash.slots[0][CONTAINER_OFFSET..][..candidate.len()].copy_from_slice(&candidate);
    assert!(matches!(upload.next(&flash.slots()), Ok(Some(FlashOperation::Program { .. }))));
}
