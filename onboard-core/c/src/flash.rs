//! What is to be done to the slots' flash: uploads and rollbacks, one operation after the other.

use crate::error::gyr_error_t;
use crate::memory::{
    State, answer, bytes, content, content_mut, fill, input, output, record, writable,
};
use crate::slots::{GYR_WORD_BYTES, gyr_slots_t, number, slots};
use onboard_core::time::Instant;
use onboard_core::uplink::{
    FlashOperation, MISSION_CHANGE_BYTES, MissionChangeOrder, ROLLBACK_BYTES, Revocation,
    RollbackOrder, Upload,
};

/// Bytes of a rollback order.
pub const GYR_ROLLBACK_BYTES: usize = 40;
const _: () = assert!(GYR_ROLLBACK_BYTES == ROLLBACK_BYTES);

/// Bytes of a mission change order.
pub const GYR_MISSION_CHANGE_BYTES: usize = 40;
const _: () = assert!(GYR_MISSION_CHANGE_BYTES == MISSION_CHANGE_BYTES);

/// 64-bit words of a gyr_upload_t.
pub const GYR_UPLOAD_WORDS: usize = 16;

/// A container that was admitted, on its way into its slot; made by gyr_slots_admit.
///
/// It points into the candidate's bytes: they must stay where and as they are until gyr_upload_next
/// brings GYR_FLASH_DONE or a refusal, or the upload is given up. To give it up, call it no more.
#[repr(C)]
pub struct gyr_upload_t {
    opaque: [u64; GYR_UPLOAD_WORDS],
}

impl State for gyr_upload_t {
    type Content = Upload<'static>;
    const KIND: [u8; 8] = *b"gyruploa";
}

const _: () = assert!(<gyr_upload_t as State>::FITS);

/// 64-bit words of a gyr_revocation_t.
pub const GYR_REVOCATION_WORDS: usize = 6;

/// A rollback on its way; made by gyr_slots_roll_back, holds no pointer.
#[repr(C)]
pub struct gyr_revocation_t {
    opaque: [u64; GYR_REVOCATION_WORDS],
}

impl State for gyr_revocation_t {
    type Content = Revocation;
    const KIND: [u8; 8] = *b"gyrrevoc";
}

const _: () = assert!(<gyr_revocation_t as State>::FITS);

/// Bytes of the caller's.
#[repr(C)]
pub struct gyr_bytes_t {
    /// The first.
    pub first: *const u8,
    /// How many.
    pub length: usize,
}

/// Erase every sector of the slot, the one with its head first.
pub const GYR_FLASH_ERASE: u32 = 1;
/// Program `word` at `offset` of the slot.
pub const GYR_FLASH_PROGRAM: u32 = 2;
/// Nothing is left to be done.
pub const GYR_FLASH_DONE: u32 = 3;

/// The next thing to do to the flash. What its kind does not name is 0.
#[repr(C)]
pub struct gyr_flash_operation_t {
    /// One of GYR_FLASH_ERASE, GYR_FLASH_PROGRAM, GYR_FLASH_DONE.
    pub kind: u32,
    /// GYR_SLOT_A or GYR_SLOT_B.
    pub slot: u32,
    /// Where the word begins in the slot, a multiple of GYR_WORD_BYTES.
    pub offset: usize,
    /// The word's bytes; it was not programmed since it was erased.
    pub word: [u8; GYR_WORD_BYTES],
}

impl From<Option<FlashOperation>> for gyr_flash_operation_t {
    fn from(operation: Option<FlashOperation>) -> Self {
        let done = Self { kind: GYR_FLASH_DONE, slot: 0, offset: 0, word: [0; GYR_WORD_BYTES] };
        match operation {
            None => done,
            Some(FlashOperation::Erase(slot)) => {
                Self { kind: GYR_FLASH_ERASE, slot: number(slot), ..done }
            }
            Some(FlashOperation::Program { slot, offset, word }) => {
                Self { kind: GYR_FLASH_PROGRAM, slot: number(slot), offset, word }
            }
        }
    }
}

/// # Safety
/// As for [`input`], and for the bytes as for [`bytes`].
unsafe fn given<'b>(place: *const gyr_bytes_t) -> Result<&'b [u8], gyr_error_t> {
    // SAFETY: the caller's word for it.
    let place = unsafe { input(place) }?;
    // SAFETY: as above.
    unsafe { bytes(place.first, place.length) }
}

/// # Safety
/// As for [`given`].
unsafe fn order<'b, const N: usize>(place: *const gyr_bytes_t) -> Result<&'b [u8; N], gyr_error_t> {
    // SAFETY: the caller's word for it.
    let place = unsafe { input(place) }?;
    // SAFETY: as above.
    unsafe { record(place.first, place.length) }
}

/// Checks a new container where it was received; on success makes `upload` its way into the slot that
/// is not active. With no container in either slot, that of any spacecraft is taken.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_admit(
    places: *const gyr_slots_t,
    candidate: *const gyr_bytes_t,
    now_tai_ns: i64,
    upload: *mut gyr_upload_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        // SAFETY: as above; the bytes stay as long as the upload is used.
        let candidate: &'static [u8] = unsafe { given(candidate) }?;
        let admitted = slots.admit(candidate, Instant::from_tai_ns(now_tai_ns))?;
        // SAFETY: as above.
        unsafe { fill(upload, admitted) }
    })
}

/// As gyr_slots_admit, for the one container of another spacecraft that the mission change order of
/// GYR_MISSION_CHANGE_BYTES bytes names.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_admit_changed(
    places: *const gyr_slots_t,
    candidate: *const gyr_bytes_t,
    order_bytes: *const gyr_bytes_t,
    now_tai_ns: i64,
    upload: *mut gyr_upload_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        // SAFETY: as above; the bytes stay as long as the upload is used.
        let candidate: &'static [u8] = unsafe { given(candidate) }?;
        // SAFETY: as above.
        let order = unsafe { order::<MISSION_CHANGE_BYTES>(order_bytes) }?;
        let order = MissionChangeOrder::from_le_bytes(order)?;
        let admitted = slots.admit_changed(candidate, &order, Instant::from_tai_ns(now_tai_ns))?;
        // SAFETY: as above.
        unsafe { fill(upload, admitted) }
    })
}

/// The slot that an upload writes; the other one stays in use meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_upload_slot(
    upload: *const gyr_upload_t,
    slot: *mut u32,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(upload) }?;
        // SAFETY: as above.
        unsafe { output(slot, number(own.slot())) }
    })
}

/// The next operation of an upload, with the slots as they now read: carry it out, then ask again,
/// until GYR_FLASH_DONE, with which the container is active. The operation before is read back first;
/// a code that says that it failed ends the upload, as a reset does: admit the candidate again.
/// Tables of the slot that is written may not be in use.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_upload_next(
    upload: *mut gyr_upload_t,
    places: *const gyr_slots_t,
    operation: *mut gyr_flash_operation_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        // Before the step, so that an operation cannot be lost.
        writable(operation)?;
        // SAFETY: as above.
        let next = unsafe { content_mut(upload) }?.next(&slots)?;
        // SAFETY: as above.
        unsafe { output(operation, next.into()) }
    })
}

/// Checks a rollback order of GYR_ROLLBACK_BYTES bytes; on success makes `revocation` the way to carry
/// it out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_slots_roll_back(
    places: *const gyr_slots_t,
    order_bytes: *const gyr_bytes_t,
    now_tai_ns: i64,
    revocation: *mut gyr_revocation_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        // SAFETY: as above.
        let order = unsafe { order::<ROLLBACK_BYTES>(order_bytes) }?;
        let order = RollbackOrder::from_le_bytes(order)?;
        let admitted = slots.roll_back(&order, Instant::from_tai_ns(now_tai_ns))?;
        // SAFETY: as above.
        unsafe { fill(revocation, admitted) }
    })
}

/// The slot whose container a rollback revokes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_revocation_slot(
    revocation: *const gyr_revocation_t,
    slot: *mut u32,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(revocation) }?;
        // SAFETY: as above.
        unsafe { output(slot, number(own.slot())) }
    })
}

/// The next operation of a rollback, as gyr_upload_next. The first one programs a word of the slot that
/// is returned to, which carries the rollback out; the second one a word of the slot that is left. No
/// tables of either slot may be in use.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_revocation_next(
    revocation: *mut gyr_revocation_t,
    places: *const gyr_slots_t,
    operation: *mut gyr_flash_operation_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let slots = unsafe { slots(places) }?;
        writable(operation)?;
        // SAFETY: as above.
        let next = unsafe { content_mut(revocation) }?.next(&slots)?;
        // SAFETY: as above.
        unsafe { output(operation, next.into()) }
    })
}
