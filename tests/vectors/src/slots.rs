//! Two slots under uplinks, damage and orders; clock correlations.
//!
//! Block: bytes of a slot u32, images (u32 count, each u32 bytes, then it), then orders to the end.
//! The slots begin as ones. A slot u32 is A for 0, else B.
//!
//! | order, u32 | operands | what it does |
//! |---|---|---|
//! | 0 | slot, image u32, bytes u32 | writes so many bytes of the image, checked or not |
//! | 1 | slot, offset u32, bits u32 | flips these bits of the byte there |
//! | 2 | image u32, now i64, bytes u32 | offers the image; where it is admitted, writes so many bytes |
//! | 3 | 40 bytes, now i64 | a rollback order; where it is good, revokes |
//! | 4 | 72 bytes, count u32, counters u64 | a clock correlation, and its instants at the counters |
//!
//! An order that touches the slots is followed by what either holds and which is active.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use heapless::Vec;
use onboard_core::clock::ClockCorrelation;
use onboard_core::uplink::{RollbackOrder, Slot, Slots, Tables, revoke};

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

    fn write(&mut self, slot: Slot, image: &[u8], count: usize) -> Result<(), Malformed> {
        let image = image.get(..count).ok_or(Malformed)?;
        self.bytes(slot).get_mut(..count).ok_or(Malformed)?.copy_from_slice(image);
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
                let (slot, image) = (slot(block)?, *images.get(block.index()?).ok_or(Malformed)?);
                store.write(slot, image, block.index()?)?;
            }
            1 => {
                let (slot, offset) = (slot(block)?, block.index()?);
                let [flip, ..] = block.u32()?.to_le_bytes();
                *store.bytes(slot).get_mut(offset).ok_or(Malformed)? ^= flip;
            }
            2 => {
                let image = *images.get(block.index()?).ok_or(Malformed)?;
                let (now, count) = (block.instant()?, block.index()?);
                let admitted = store.slots().admit(image, now);
                sink.text("admitted", &admitted);
                if let Ok(slot) = admitted {
                    store.write(slot, image, count)?;
                }
            }
            3 => {
                let order = RollbackOrder::from_le_bytes(&block.field()?);
                let now = block.instant()?;
                sink.text("order", &order);
                if let Ok(order) = order {
                    let left = store.slots().roll_back(&order, now);
                    sink.text("rolled back", &left);
                    if let Ok(slot) = left {
                        sink.word("revoked", revoke(store.bytes(slot)).into());
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
        .and_then(|record| record.replacing(active.as_ref()));
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
