//! The flash of the day: two slots in memory, an upload and a rollback.

use crate::teller::Teller;
use onboard_core::time::Instant;
use onboard_core::uplink::{FlashOperation, RollbackOrder, Slot, SlotState, Slots};

/// Two slots; programming only clears bits.
pub struct Flash(pub [Vec<u8>; 2]);

impl Flash {
    pub fn slots(&self) -> Slots<'_> {
        Slots { a: &self.0[0], b: &self.0[1] }
    }

    pub fn carry_out(&mut self, operation: FlashOperation) {
        match operation {
            FlashOperation::Erase(slot) => self.0[number(slot)].fill(0xff),
            FlashOperation::Program { slot, offset, word } => {
                for (to, from) in self.0[number(slot)][offset..].iter_mut().zip(word) {
                    *to &= from;
                }
            }
        }
    }

    pub fn bring(&mut self, container: &[u8], now: Instant, tell: &mut Teller) {
        let mut upload = self.slots().admit(container, now).expect("admitted");
        tell.word("written", number(upload.slot()) as u64);
        let mut programmed = 0;
        while let Some(operation) = upload.next(&self.slots()).expect("flash that works") {
            self.carry_out(operation);
            programmed += u64::from(matches!(operation, FlashOperation::Program { .. }));
        }
        tell.word("programmed", programmed);
    }

    pub fn tell(&self, tell: &mut Teller) {
        for slot in [Slot::A, Slot::B] {
            let (code, sequence) = match self.slots().state(slot) {
                SlotState::Erased => (220, 0),
                SlotState::Committed(sequence) => (224, sequence),
                SlotState::Revoked(sequence) => (90, sequence.unwrap_or(0)),
                other => panic!("not on this flight: {other:?}"),
            };
            tell.word("slot's state", code);
            tell.word("slot's sequence", sequence.into());
        }
    }
}

pub fn number(slot: Slot) -> usize {
    usize::from(slot == Slot::B)
}

/// A newer container, and the way back from it, which the order finds once.
pub fn go_and_return(
    flash: &mut Flash,
    newer: &[u8],
    order: &RollbackOrder,
    now: Instant,
    tell: &mut Teller,
) {
    assert!(flash.slots().roll_back(order, now).is_err());
    tell.word("too early", 97);
    flash.bring(newer, now, tell);
    flash.tell(tell);
    let mut revocation = flash.slots().roll_back(order, now).expect("admitted");
    tell.word("revoked", number(revocation.slot()) as u64);
    while let Some(operation) = revocation.next(&flash.slots()).expect("flash that works") {
        if let FlashOperation::Program { slot, offset, .. } = operation {
            tell.word("programmed in", number(slot) as u64);
            tell.word("programmed at", offset as u64);
        }
        flash.carry_out(operation);
    }
    flash.tell(tell);
    assert!(flash.slots().roll_back(order, now).is_err());
    tell.word("again", 97);
    tell.word("no change of mission", 240);
}
