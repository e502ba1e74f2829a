//! Two slots of flash for containers, of which the newest committed one is active.

use crate::error::gyr_error_t;
use crate::memory::{answer, bytes, fill, input, output};
use crate::tables::{Loaded, gyr_tables_t};
use onboard_core::uplink::{CONTAINER_OFFSET, Slot, SlotState, Slots, WORD_BYTES};

/// Bytes of a slot's word: offsets are multiples of it.
pub const GYR_WORD_BYTES: usize = 32;
const _: () = assert!(GYR_WORD_BYTES == WORD_BYTES);

/// Bytes of a slot before its container. A slot needs them and the container's length, filled up to a
/// whole word.
pub const GYR_SLOT_HEAD_BYTES: usize = 512;
const _: () = assert!(GYR_SLOT_HEAD_BYTES == CONTAINER_OFFSET);

/// The slot A.
pub const GYR_SLOT_A: u32 = 0;
/// The slot B.
pub const GYR_SLOT_B: u32 = 1;

/// Where the two slots lie in flash, which is read in place. A slot is whole sectors and begins at a
/// multiple of GYR_WORD_BYTES; a word that cannot be corrected must read as bytes (zeros, for
/// instance), not as a fault.
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

/// What a slot holds.
#[repr(C)]
pub struct gyr_slot_state_t {
    /// GYR_SLOT_ERASED to GYR_SLOT_TOO_SHORT, GYR_SLOTS_REVOKED, or, where the slot is committed but its
    /// contents are refused, why.
    pub state: gyr_error_t,
    /// The container's sequence number.
    pub sequence: u32,
    /// Whether it is known: of a complete or committed container, and mostly of a revoked one.
    pub has_sequence: bool,
}

/// # Safety
/// As for [`input`], and for the two slots as for [`bytes`].
pub(crate) unsafe fn slots<'s>(places: *const gyr_slots_t) -> Result<Slots<'s>, gyr_error_t> {
    // SAFETY: the caller's word for it.
    let places = unsafe { input(places) }?;
    // SAFETY: as above.
    let a = unsafe { bytes(places.a, places.a_length) }?;
    // SAFETY: as above.
    let b = unsafe { bytes(places.b, places.b_length) }?;
    Ok(Slots { a, b })
}

pub(crate) const fn number(slot: Slot) -> u32 {
    match slot {
        Slot::A => GYR_SLOT_A,
        Slot::B => GYR_SLOT_B,
    }
}

const fn named(slot: u32) -> Result<Slot, gyr_error_t> {
    match slot {
        GYR_SLOT_A => Ok(Slot::A),
        GYR_SLOT_B => Ok(Slot::B),
        _ => Err(gyr_error_t::GYR_ARGUMENT_RANGE),
    }
}

/// Makes `tables` of the newest committed container, from the slots' contents alone, and names its
/// slot. Reads both slots several times: once after a reset and per change of a slot, not per cycle.
/// The active slot's bytes must stay until gyr_tables_unload; the other slot's may change at once.
/// Where neither holds tables, gyr_slots_state says what they hold instead.
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
        let loaded = Loaded { tables: active.tables, bytes: slots.bytes(active.slot) };
        // SAFETY: as above.
        unsafe { output(slot, number(active.slot)) }?;
        // SAFETY: as above.
        unsafe { fill(tables, loaded) }
    })
}

/// Makes `tables` of one slot; where it holds none, the code is what gyr_slots_state says of it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_tables(
    places: *const gyr_slots_t,
    slot: u32,
    tables: *mut gyr_tables_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold; the bytes stay until gyr_tables_unload.
        let slots: Slots<'static> = unsafe { slots(places) }?;
        let slot = named(slot)?;
        let loaded = Loaded { tables: slots.tables(slot)?, bytes: slots.bytes(slot) };
        // SAFETY: as above.
        unsafe { fill(tables, loaded) }
    })
}

/// What a slot holds.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_state(
    places: *const gyr_slots_t,
    slot: u32,
    state: *mut gyr_slot_state_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        let found = slots.state(named(slot)?);
        let sequence = match found {
            SlotState::Complete(number) | SlotState::Committed(number) => Some(number),
            SlotState::Revoked(number) => number,
            _ => None,
        };
        let answer = gyr_slot_state_t {
            state: found.into(),
            sequence: sequence.unwrap_or(0),
            has_sequence: sequence.is_some(),
        };
        // SAFETY: as above.
        unsafe { output(state, answer) }
    })
}
