//! Two slots for containers, of which the newest sound one is active.

use crate::error::gyr_error_t;
use crate::memory::{answer, bytes, bytes_mut, fill, input, output, record};
use crate::tables::{Loaded, gyr_tables_t};
use onboard_core::time::Instant;
use onboard_core::uplink::{ROLLBACK_BYTES, RollbackOrder, Slot, Slots, revoke};

/// Bytes of a rollback order.
pub const GYR_ROLLBACK_BYTES: usize = 40;
const _: () = assert!(GYR_ROLLBACK_BYTES == ROLLBACK_BYTES);

/// The slot A.
pub const GYR_SLOT_A: u32 = 0;
/// The slot B.
pub const GYR_SLOT_B: u32 = 1;

/// Where the two slots lie; a length may be 0 while a slot is written.
#[repr(C)]
pub struct gyr_slots_t {
    /// First byte of A.
    pub a: *const u8,
    /// Bytes of A.
    pub a_length: usize,
    /// First byte of B.
    pub b: *const u8,
    /// Bytes of B.
    pub b_length: usize,
}

/// # Safety
/// As for [`input`], and for the two slots as for [`bytes`].
unsafe fn slots<'s>(places: *const gyr_slots_t) -> Result<Slots<'s>, gyr_error_t> {
    // SAFETY: the caller's word for it.
    let places = unsafe { input(places) }?;
    // SAFETY: as above.
    let a = unsafe { bytes(places.a, places.a_length) }?;
    // SAFETY: as above.
    let b = unsafe { bytes(places.b, places.b_length) }?;
    Ok(Slots { a, b })
}

const fn number(slot: Slot) -> u32 {
    match slot {
        Slot::A => GYR_SLOT_A,
        Slot::B => GYR_SLOT_B,
    }
}

fn bytes_of(slots: &Slots<'static>, slot: Slot) -> &'static [u8] {
    match slot {
        Slot::A => slots.a,
        Slot::B => slots.b,
    }
}

/// Makes `tables` of the newest sound container, from the slots' contents alone, and names its slot.
/// Reads both slots: once after a reset and per change of a slot, not per cycle. The active slot's
/// bytes must stay until gyr_tables_unload. Where neither holds tables, gyr_slots_tables says why.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_active(
    places: *const gyr_slots_t,
    slot: *mut u32,
    tables: *mut gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold; the bytes stay until gyr_tables_unload.
        let slots: Slots<'static> = unsafe { slots(places) }?;
        let active = slots.active()?;
        let loaded = Loaded { tables: active.tables, bytes: bytes_of(&slots, active.slot) };
        // SAFETY: as above.
        unsafe { output(slot, number(active.slot)) }?;
        // SAFETY: as above.
        unsafe { fill(tables, loaded) }
    })
}

/// Makes `tables` of one slot, or says why it holds none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_tables(
    places: *const gyr_slots_t,
    slot: u32,
    tables: *mut gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold; the bytes stay until gyr_tables_unload.
        let slots: Slots<'static> = unsafe { slots(places) }?;
        let slot = match slot {
            GYR_SLOT_A => Slot::A,
            GYR_SLOT_B => Slot::B,
            _ => return Err(gyr_error_t::GYR_ARGUMENT_RANGE),
        };
        let loaded = Loaded { tables: slots.tables(slot)?, bytes: bytes_of(&slots, slot) };
        // SAFETY: as above.
        unsafe { fill(tables, loaded) }
    })
}

/// Checks a new container where it was received, and names the slot to write it to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_admit(
    places: *const gyr_slots_t,
    candidate: *const u8,
    length: usize,
    now_tai_ns: i64,
    slot: *mut u32,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        // SAFETY: as above.
        let candidate = unsafe { bytes(candidate, length) }?;
        let free = slots.admit(candidate, Instant::from_tai_ns(now_tai_ns))?;
        // SAFETY: as above.
        unsafe { output(slot, number(free)) }
    })
}

/// Checks a rollback order of GYR_ROLLBACK_BYTES bytes, and names the slot to revoke.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_roll_back(
    places: *const gyr_slots_t,
    order: *const u8,
    length: usize,
    now_tai_ns: i64,
    slot: *mut u32,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        // SAFETY: as above.
        let order = unsafe { record::<ROLLBACK_BYTES>(order, length) }?;
        let order = RollbackOrder::from_le_bytes(order)?;
        let left = slots.roll_back(&order, Instant::from_tai_ns(now_tai_ns))?;
        // SAFETY: as above.
        unsafe { output(slot, number(left)) }
    })
}

/// Marks a slot's container as rolled back. No tables may be in use on these bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slot_revoke(slot: *mut u8, length: usize) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slot = unsafe { bytes_mut(slot, length) }?;
        if revoke(slot) { Ok(()) } else { Err(gyr_error_t::GYR_ARGUMENT_LENGTH) }
    })
}
