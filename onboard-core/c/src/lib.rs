//! The flight core for C: its states in the caller's memory, its answers in out-parameters.
//!
//! One file per room of the core; each only moves arguments, so that what is computed is the core's
//! to the bit. `error.rs` holds every code, `refusal.rs` which refusal of the core each is,
//! `memory.rs` all that is known of the caller's pointers.
//! The header `include/gyrfalcon.h` is made from these files by `header/`, their comments included.
//!
//! No std, no allocation, no statics, no callback, no panic: the panic handler calls a function that
//! nobody defines, so a program in which a panic can be reached does not link.
//!
//! Limits: as `docs/c-interface.md` says; what a caller must hold stands at the header's top.

#![cfg_attr(not(test), no_std)]
#![cfg_attr(
    not(test),
    deny(
        clippy::indexing_slicing,
        clippy::arithmetic_side_effects,
        clippy::integer_division,
        clippy::as_conversions,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::std_instead_of_core
    )
)]
#![expect(non_camel_case_types, reason = "types have the names of the C header")]
#![expect(clippy::doc_markdown, reason = "comments are the C header's, where names stand bare")]
#![expect(
    clippy::missing_safety_doc,
    reason = "the header's top says once what every caller must hold"
)]

pub mod error;
mod refusal;
mod memory;

pub mod tables;
pub mod slots;
pub mod flash;
pub mod scrub;
pub mod clock;
pub mod attitude;
pub mod tracker;
pub mod transits;
pub mod forecast;
pub mod sequencer;
pub mod telemetry;
pub mod visits;

#[cfg(not(test))]
unsafe extern "C" {
    fn gyr_panic_is_reachable() -> !;
}

#[cfg(not(test))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: nobody defines it; a program that contains this call does not link.
    unsafe { gyr_panic_is_reachable() }
}
