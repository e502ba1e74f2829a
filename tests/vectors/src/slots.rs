//! Two slots under uplinks, damage and orders; clock correlations.
//!
//! Block: bytes of a slot u32, images (u32 count, each u32 bytes, then it), then orders to the end.
//! The slots begin as ones. A slot u32 is A for 0, else B.
//!
//! | order, u32 | operands | what it does |
//! |---|---|---|
//! | 0 | slot | erases it |
//! | 1 | slot, offset u32, bits u32 | flips these bits of the byte there |
//! | 2 | image u32, now i64, count u32 | offers the image; where it is admitted, carries so many operations out |
//! | 3 | 40 bytes, now i64, count u32 | a rollback order; where it is good, carries so many operations out |
//! | 4 | 72 bytes, count u32, counters u64 | a clock correlation, and its instants at the counters |
//!
//! An order that touches the slots is followed by what either holds and which is active.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use heapless::Vec;
use onboard_core::clock::ClockCorrelation;
use onboard_core::uplink::{
    FlashError, FlashOperation, RollbackOrder, Slot, Slots, Tables, WORD_BYTES,
};

/// The spacecraft of the clock correlations.
pub const SPACECRAFT: u32 = 3;
/// Most images of a block.
pub const MAX_IMAGES: usize = 16;

struct Store<'m> {
    a: &'m mut [u8],
    b: &'m mut [u8],
}

impl Store<'_> {
    const fn slots(&self) -> Slots<'_> {
        Slots { a: &*self.a, b: &*self.b }
    }

    const fn bytes(&mut self, slot: Slot) -> &mut [u8] {
        match slot {
            Slot::A => self.a,
            Slot::B => self.b,
        }
    }

    /// Carries out up to `count` operations as they come, each word only clearing bits.
    fn carry_out(
        &mut self,
        count: u32,
        mut next: impl FnMut(&Slots<'_>) -> Result<Option<FlashOperation>, FlashError>,
        sink: &mut impl Sink,
    ) -> Result<(), Malformed> {
        for _ in 0..count {
            match next(&self.slots()) {
                Ok(Some(FlashOperation::Erase(slot))) => self.bytes(slot).fill(0xff),
                Ok(Some(FlashOperation::Program { slot, offset, word })) => {
                    let place = self.bytes(slot).get_mut(offset..).ok_or(Malformed)?;
                    let place = place.first_chunk_mut::<WORD_BYTES>().ok_or(Malformed)?;
                    for (old, new) in place.iter_mut().zip(word) {
                        *old &= new;
                    }
                }
                Ok(None) => break,
                Err(error) => {
                    sink.text("flash", &error);
                    break;
                }
            }
        }
        Ok(())
    }

    fn told(&self, sink: &mut impl Sink) {
        let slots = self.slots();
        match slots.active() {
            Ok(active) => {
                sink.text("active slot", &active.slot);
                tables(&active.tables, sink);
            }
            Err(error) => sink.text("no tables", &error),
        }
        for slot in [Slot::A, Slot::B] {
            match slots.tables(slot) {
                Ok(found) => tables(&found, sink),
                Err(error) => sink.text("slot refused", &error),
            }
        }
    }
}

fn tables(tables: &Tables<'_>, sink: &mut impl Sink) {
    sink.text("slot's header", tables.header());
    sink.word("slot's digest", tables.set_digest());
}

fn slot(block: &mut Reader<'_>) -> Result<Slot, Malformed> {
    Ok(if block.u32()? == 0 { Slot::A } else { Slot::B })
}

/// Carries out the orders, with the slots in `scratch`.
///
/// # Errors
/// [`Malformed`] where the memory is too short or an order names what is not there.
pub fn run(
    block: &mut Reader<'_>,
    scratch: &mut [u8],
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let room = block.index()?;
    let (a, rest) = scratch.split_at_mut_checked(room).ok_or(Malformed)?;
    let b = rest.get_mut(..room).ok_or(Malformed)?;
    a.fill(0xff);
    b.fill(0xff);
    let mut store = Store { a, b };
    let mut images = Vec::<&[u8], MAX_IMAGES>::new();
    for _ in 0..block.u32()? {
        images.push(block.sized()?).map_err(|_| Malformed)?;
    }
    let mut clock = None;
    let mut number = 0;
    while !block.is_empty() {
        number += 1;
        sink.item(number);
        match block.u32()? {
            0 => {
                let slot = slot(block)?;
                store.bytes(slot).fill(0xff);
            }
            1 => {
                let (slot, offset) = (slot(block)?, block.index()?);
                let [flip, ..] = block.u32()?.to_le_bytes();
                *store.bytes(slot).get_mut(offset).ok_or(Malformed)? ^= flip;
            }
            2 => {
                let image = *images.get(block.index()?).ok_or(Malformed)?;
                let (now, count) = (block.instant()?, block.u32()?);
                match store.slots().admit(image, now) {
                    Ok(mut upload) => {
                        sink.text("admitted", &upload.slot());
                        store.carry_out(count, |slots| upload.next(slots), sink)?;
                    }
                    Err(refusal) => sink.text("not admitted", &refusal),
                }
            }
            3 => {
                let order = RollbackOrder::from_le_bytes(&block.field()?);
                let (now, count) = (block.instant()?, block.u32()?);
                sink.text("order", &order);
                if let Ok(order) = order {
                    match store.slots().roll_back(&order, now) {
                        Ok(mut revocation) => {
                            sink.text("rolled back", &revocation.slot());
                            store.carry_out(count, |slots| revocation.next(slots), sink)?;
                        }
                        Err(refusal) => sink.text("not rolled back", &refusal),
                    }
                }
            }
            4 => {
                correlate(block, &mut clock, sink)?;
                continue;
            }
            _ => return Err(Malformed),
        }
        store.told(sink);
    }
    Ok(())
}

fn correlate(
    block: &mut Reader<'_>,
    active: &mut Option<ClockCorrelation>,
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let record = ClockCorrelation::from_le_bytes(&block.field()?)
        .and_then(|record| record.replacing(active.as_ref(), SPACECRAFT));
    sink.text("clock correlation", &record);
    if let Ok(record) = record {
        *active = Some(record);
    }
    for _ in 0..block.u32()? {
        let ticks = block.u64()?;
        match active.map(|clock| clock.instant(ticks)) {
            Some(Ok(instant)) => sink.integer("clock's instant", instant.tai_ns()),
            other => sink.text("clock refused", &other),
        }
    }
    Ok(())
}
