//! The flight core of Gyrfalcon: where a spinning, precessing telescope points, and when targets
//! cross its fields of view. No std, no allocation, no unsafe code, no panic, no recursion.
//!
//! Modules stand in the order that data flows: time and phases, frames, the ephemeris table, the
//! scanning strategy, the attitude, its tracking, the transits. `docs/conventions.md` states units,
//! frames and signs once.

#![no_std]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(
        clippy::indexing_slicing,
        clippy::arithmetic_side_effects,
        clippy::integer_division,
        clippy::as_conversions,
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_precision_loss,
        clippy::cast_sign_loss,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::std_instead_of_core,
        clippy::large_stack_arrays
    )
)]

mod convert;
mod bytes;
mod trigonometry;

pub mod time;
pub mod phase;
pub mod frame;
pub mod direction;
pub mod rotation;
pub mod ephemeris;
pub mod sun;
pub mod scan;
pub mod uncertainty;
pub mod detector;
mod rectangle;
pub mod field_of_view;
pub mod hwp;
pub mod attitude;
pub mod tracking;
pub mod transit;
pub mod avoidance;
pub mod visits;
pub mod saved_visits;
pub mod forecast;

pub mod uplink;
pub mod clock;
pub mod record;
pub mod sequencer;
