//! The flight core of Gyrfalcon: where a spinning, precessing telescope points, and when targets
//! cross its fields of view. No std, no allocation, no unsafe code, no panic, no recursion.
//!
//! Modules stand in the order that data flows: time and phases, frames, the ephemeris table, the
//! scanning strategy, the attitude, its tracking, the transits. `docs/conventions.md` states units,
//! frames and signs once, `docs/onboard.md` how flight software uses the crate.
//!
//! # Example
//! `LiteBIRD`'s scan, exact from its periods, and where its boresight points an hour after the start:
//! ```
//! use core::num::NonZeroU64;
//! use onboard_core::attitude::attitude;
//! use onboard_core::direction::Direction;
//! use onboard_core::frame::{Boresight, Ecliptic};
//! use onboard_core::phase::{Phase, Rotor, TurnRate};
//! use onboard_core::rotation::Rotation;
//! use onboard_core::scan::{ScanParameters, ScanStrategy};
//! use onboard_core::sun::SunModel;
//! use onboard_core::time::{Duration, Instant};
//!
//! // Precession in 192.348 min, 100 turns in 1154088 s; spin in 20 min.
//! let seconds = NonZeroU64::new(1_154_088).ok_or("zero")?;
//! let rate = TurnRate::from_turns(100, seconds).ok_or("too fast")?;
//! let minute = 60_000_000_000;
//! let spin = Rotor::with_period(Duration::from_ns(20 * minute), Phase::ZERO).ok_or("too fast")?;
//! let start = Instant::from_tai_ns(0);
//! let scan = ScanStrategy::new(ScanParameters {
//!     start,
//!     alpha_rad: 45_f64.to_radians(),
//!     beta_rad: 50_f64.to_radians(),
//!     precession: Rotor { rate, start: Phase::ZERO },
//!     spin,
//! })?;
//!
//! // A circular Sun, once round in 365.25 days; on board it comes from the uplinked tables.
//! let year = Duration::from_ns(31_557_600_000_000_000);
//! let sun = SunModel::Circular(Rotor::with_period(year, Phase::ZERO).ok_or("too fast")?);
//! let at = start.plus(Duration::from_ns(60 * minute));
//! let pointing: Rotation<Boresight, Ecliptic> = attitude(&scan, &sun, at)?;
//! let boresight = pointing.apply(Direction::Z);
//!
//! // From the anti-Sun axis it lies between |alpha - beta| and alpha + beta.
//! let anti_sun = sun.state(start, at)?.direction;
//! let distance = boresight.separation_rad(anti_sun).to_degrees();
//! assert!((5.0..=95.0).contains(&distance));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Requirements: REQ-CORE-1, REQ-CORE-2.

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
mod crc;
mod trigonometry;
mod vector;

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
pub mod telemetry;
mod sentence;
