//! What may be done with the pointers that C hands in.
//!
//! A pointer is checked for null and alignment, a length for its range, before anything is read. A
//! state's memory begins with a seal: a word made of the state's kind, its size and its address. Any
//! other word there means that the memory was never made a state, is another kind's, was copied from
//! elsewhere, or was overwritten; then nothing else of it is read.
//!
//! Method: behind the seal the content lies at the first address of its alignment, which may exceed
//! that of the 64-bit words the C type is made of (a 128-bit integer's on 64-bit machines).
//!
//! Limits: that a pointer points to memory of its type, that nobody else writes there during a call,
//! and that the bytes of tables stay as they are while the tables are in use, is the caller's to
//! hold. The seal is no checksum: bits that flip behind it are not seen.

use crate::error::gyr_error_t;
use core::mem::{align_of, size_of};
use core::slice;

/// Memory of the caller's, and what the library keeps in it.
pub(crate) trait State: Sized {
    /// What is kept.
    type Content;
    /// Eight letters that no other kind of state has.
    const KIND: [u8; 8];
    /// Whether the content fits: to be asserted where the state is defined.
    const FITS: bool = size_of::<Self>() >= Self::NEEDED && align_of::<Self>() == SEAL_BYTES;
    /// Bytes needed, wherever a word's alignment lets the memory begin.
    const NEEDED: usize = SEAL_BYTES
        .wrapping_add(align_of::<Self::Content>().saturating_sub(SEAL_BYTES))
        .wrapping_add(size_of::<Self::Content>());
}

const SEAL_BYTES: usize = size_of::<u64>();

/// The word before a state's content at this address.
fn seal<S: State>(address: usize) -> u64 {
    let number = |value: usize| u64::try_from(value).unwrap_or(u64::MAX);
    u64::from_le_bytes(S::KIND) ^ number(size_of::<S::Content>()).rotate_left(48) ^ number(address)
}

/// Where the content lies: the first address of its alignment behind the seal.
fn place<S: State>(state: *mut S) -> *mut S::Content {
    let behind = state.addr().wrapping_add(SEAL_BYTES);
    let mask = align_of::<S::Content>().wrapping_sub(1);
    let offset = SEAL_BYTES.wrapping_add(behind.wrapping_neg() & mask);
    state.wrapping_byte_add(offset).cast()
}

/// Whether a pointer can be used at all.
fn check<T>(pointer: *const T) -> Result<(), gyr_error_t> {
    if pointer.is_null() {
        Err(gyr_error_t::GYR_ARGUMENT_NULL)
    } else if pointer.is_aligned() {
        Ok(())
    } else {
        Err(gyr_error_t::GYR_ARGUMENT_ALIGNMENT)
    }
}

fn check_seal<S: State>(state: *const S) -> Result<(), gyr_error_t> {
    check(state)?;
    // SAFETY: checked above; volatile, since the memory may never have been written.
    let found = unsafe { state.cast::<u64>().read_volatile() };
    if found == seal::<S>(state.addr()) { Ok(()) } else { Err(gyr_error_t::GYR_ARGUMENT_STATE) }
}

/// The content of a state.
///
/// # Safety
/// Memory of the state's type, which nobody writes to during the call.
pub(crate) unsafe fn content<'s, S: State>(state: *const S) -> Result<&'s S::Content, gyr_error_t> {
    check_seal(state)?;
    // SAFETY: the seal says that `fill` put a content there, and the place is aligned.
    Ok(unsafe { &*place(state.cast_mut()) })
}

/// The content of a state that may be left out.
///
/// # Safety
/// Null, or as for [`content`].
pub(crate) unsafe fn content_or_none<'s, S: State>(
    state: *const S,
) -> Result<Option<&'s S::Content>, gyr_error_t> {
    if state.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's word for it.
    unsafe { content(state) }.map(Some)
}

/// The content of a state, to be changed.
///
/// # Safety
/// Memory of the state's type, which nobody else reads or writes during the call.
pub(crate) unsafe fn content_mut<'s, S: State>(
    state: *mut S,
) -> Result<&'s mut S::Content, gyr_error_t> {
    check_seal(state.cast_const())?;
    // SAFETY: the seal says that `fill` put a content there, and the place is aligned.
    Ok(unsafe { &mut *place(state) })
}

/// Makes the memory a state with this content.
///
/// # Safety
/// Memory of the state's type, which nobody else reads or writes during the call.
pub(crate) unsafe fn fill<S: State>(state: *mut S, content: S::Content) -> Result<(), gyr_error_t> {
    check(state.cast_const())?;
    // SAFETY: aligned, and inside the memory by `State::FITS`.
    unsafe { place(state).write(content) };
    // SAFETY: checked above; the seal comes last, behind a whole content.
    unsafe { state.cast::<u64>().write_volatile(seal::<S>(state.addr())) };
    Ok(())
}

/// Makes the memory no state any more.
///
/// # Safety
/// Memory of the state's type, which nobody else reads or writes during the call.
pub(crate) unsafe fn clear<S: State>(state: *mut S) -> Result<(), gyr_error_t> {
    check_seal(state.cast_const())?;
    // SAFETY: checked above.
    unsafe { state.cast::<u64>().write_volatile(0) };
    Ok(())
}

/// What an argument points to: a structure in which any bits are legal.
///
/// # Safety
/// A structure of this type, which nobody writes to during the call.
pub(crate) unsafe fn input<'s, T>(argument: *const T) -> Result<&'s T, gyr_error_t> {
    check(argument)?;
    // SAFETY: checked above, the rest is the caller's word.
    Ok(unsafe { &*argument })
}

/// Bytes of the caller's; null only where there are none.
///
/// # Safety
/// So many bytes, which nobody writes to as long as what borrows them is in use.
pub(crate) unsafe fn bytes<'b>(first: *const u8, length: usize) -> Result<&'b [u8], gyr_error_t> {
    if length == 0 {
        return Ok(&[]);
    }
    check(first)?;
    if isize::try_from(length).is_err() {
        return Err(gyr_error_t::GYR_ARGUMENT_LENGTH);
    }
    // SAFETY: not null, of a legal length, the rest is the caller's word.
    Ok(unsafe { slice::from_raw_parts(first, length) })
}

/// A record of exactly `N` bytes.
///
/// # Safety
/// As for [`bytes`].
pub(crate) unsafe fn record<'b, const N: usize>(
    first: *const u8,
    length: usize,
) -> Result<&'b [u8; N], gyr_error_t> {
    // SAFETY: the caller's word for it.
    let all = unsafe { bytes(first, length) }?;
    all.try_into().map_err(|_| gyr_error_t::GYR_ARGUMENT_LENGTH)
}

/// Bytes of the caller's, to be changed.
///
/// # Safety
/// So many bytes, which nobody else reads or writes during the call.
pub(crate) unsafe fn bytes_mut<'b>(
    first: *mut u8,
    length: usize,
) -> Result<&'b mut [u8], gyr_error_t> {
    check(first.cast_const())?;
    if isize::try_from(length).is_err() {
        return Err(gyr_error_t::GYR_ARGUMENT_LENGTH);
    }
    // SAFETY: not null, of a legal length, the rest is the caller's word.
    Ok(unsafe { slice::from_raw_parts_mut(first, length) })
}

/// Bytes of a record of exactly `N` bytes, to be written.
///
/// # Safety
/// As for [`bytes_mut`].
pub(crate) unsafe fn record_mut<'b, const N: usize>(
    first: *mut u8,
    length: usize,
) -> Result<&'b mut [u8; N], gyr_error_t> {
    // SAFETY: the caller's word for it.
    let all = unsafe { bytes_mut(first, length) }?;
    all.try_into().map_err(|_| gyr_error_t::GYR_ARGUMENT_LENGTH)
}

/// Whether a result could be written there: asked before what cannot be undone.
pub(crate) fn writable<T>(result: *mut T) -> Result<(), gyr_error_t> {
    check(result.cast_const())
}

/// Writes a result to where the caller wants it.
///
/// # Safety
/// Memory of this type, which nobody else reads or writes during the call.
pub(crate) unsafe fn output<T>(result: *mut T, value: T) -> Result<(), gyr_error_t> {
    check(result.cast_const())?;
    // SAFETY: checked above, the rest is the caller's word.
    unsafe { result.write(value) };
    Ok(())
}

/// Writes a result that the caller may not want (null).
///
/// # Safety
/// Null, or as for [`output`].
pub(crate) unsafe fn output_or_none<T>(result: *mut T, value: T) -> Result<(), gyr_error_t> {
    if result.is_null() {
        return Ok(());
    }
    // SAFETY: the caller's word for it.
    unsafe { output(result, value) }
}

/// Runs a function's work and gives its code to C.
pub(crate) fn answer(work: impl FnOnce() -> Result<(), gyr_error_t>) -> gyr_error_t {
    match work() {
        Ok(()) => gyr_error_t::GYR_OK,
        Err(error) => error,
    }
}

#[cfg(test)]
#[expect(clippy::undocumented_unsafe_blocks, reason = "the memory is the tests' own")]
mod tests {
    use super::*;

    #[repr(C)]
    struct Wide {
        opaque: [u64; 5],
    }

    impl State for Wide {
        type Content = u128;
        const KIND: [u8; 8] = *b"wide    ";
    }

    const _: () = assert!(<Wide as State>::FITS);

    #[repr(C)]
    struct Other {
        opaque: [u64; 5],
    }

    impl State for Other {
        type Content = [u8; 16];
        const KIND: [u8; 8] = *b"other   ";
    }

    /// Both placements of a wide content among words.
    #[test]
    fn a_content_comes_back_from_any_word() {
        let mut memory = [0_u64; 8];
        for first in 0..2 {
            let state = memory.as_mut_ptr().wrapping_add(first).cast::<Wide>();
            unsafe { fill(state, 7) }.unwrap();
            assert_eq!(unsafe { content(state) }, Ok(&7));
            *unsafe { content_mut(state) }.unwrap() += 1;
            assert_eq!(unsafe { content(state) }, Ok(&8));
            unsafe { clear(state) }.unwrap();
            assert_eq!(unsafe { content(state) }, Err(gyr_error_t::GYR_ARGUMENT_STATE));
            assert_eq!(unsafe { clear(state) }, Err(gyr_error_t::GYR_ARGUMENT_STATE));
        }
    }

    #[test]
    fn memory_that_is_no_such_state_is_refused() {
        let refused = Err(gyr_error_t::GYR_ARGUMENT_STATE);
        for filling in [0, u64::MAX, 0x5555_5555_5555_5555] {
            let never = Wide { opaque: [filling; 5] };
            assert_eq!(unsafe { content(&raw const never) }, refused);
        }
        let mut state = Wide { opaque: [0; 5] };
        unsafe { fill(&raw mut state, 7) }.unwrap();
        let moved = Box::new(Wide { opaque: state.opaque });
        assert_eq!(unsafe { content(&raw const *moved) }, refused);
        let other = (&raw const state).cast::<Other>();
        assert_eq!(unsafe { content(other) }, Err(gyr_error_t::GYR_ARGUMENT_STATE));
        state.opaque[0] ^= 1;
        assert_eq!(unsafe { content(&raw const state) }, refused);
    }

    /// The words are chosen for the largest target, with room for what the core gains, not for more.
    #[test]
    fn no_state_is_far_larger_than_it_must_be() {
        fn spare<S: State>() -> (usize, usize) {
            (size_of::<S>() - S::NEEDED, size_of::<S>())
        }
        let states = [
            spare::<crate::tables::gyr_tables_t>(),
            spare::<crate::flash::gyr_upload_t>(),
            spare::<crate::flash::gyr_revocation_t>(),
            spare::<crate::scrub::gyr_scrub_t>(),
            spare::<crate::clock::gyr_clock_t>(),
            spare::<crate::attitude::gyr_strategy_t>(),
            spare::<crate::tracker::gyr_tracker_t>(),
            spare::<crate::transits::gyr_finder_t>(),
            spare::<crate::forecast::gyr_forecast_t>(),
            spare::<crate::sequencer::gyr_sequencer_t>(),
            spare::<crate::visits::gyr_visit_log_t>(),
        ];
        for (spare, size) in states {
            assert!(spare <= 64 || spare * 4 <= size, "{states:?}");
        }
    }

    #[test]
    fn bad_pointers_and_lengths_are_refused() {
        let mut memory = [0_u64; 8];
        let odd = memory.as_mut_ptr().wrapping_byte_add(4);
        let null = gyr_error_t::GYR_ARGUMENT_NULL;
        let misaligned = gyr_error_t::GYR_ARGUMENT_ALIGNMENT;
        assert_eq!(unsafe { fill(odd.cast::<Wide>(), 1) }, Err(misaligned));
        assert_eq!(unsafe { fill(core::ptr::null_mut::<Wide>(), 1) }, Err(null));
        assert_eq!(unsafe { output(odd, 1) }, Err(misaligned));
        assert_eq!(unsafe { output(core::ptr::null_mut(), 1) }, Err(null));
        assert_eq!(unsafe { output_or_none(core::ptr::null_mut(), 1) }, Ok(()));
        assert_eq!(unsafe { output_or_none(odd, 1) }, Err(misaligned));
        assert_eq!(unsafe { input(odd) }, Err(misaligned));
        assert_eq!(memory, [0; 8]);
        let byte = memory.as_ptr().cast::<u8>();
        assert_eq!(unsafe { bytes(core::ptr::null(), 1) }, Err(null));
        assert_eq!(unsafe { bytes(core::ptr::null(), 0) }, Ok(&[][..]));
        assert_eq!(unsafe { bytes(byte, usize::MAX) }, Err(gyr_error_t::GYR_ARGUMENT_LENGTH));
        assert_eq!(unsafe { record::<4>(byte, 3) }, Err(gyr_error_t::GYR_ARGUMENT_LENGTH));
        assert_eq!(unsafe { record::<4>(byte, 4) }, Ok(&[0; 4]));
        assert!(unsafe { content_or_none(core::ptr::null::<Wide>()) }.unwrap().is_none());
    }
}
