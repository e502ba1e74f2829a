//! Where the Sun, the planets and the spacecraft are, and the tables that tell the flight core.
//!
//! Modules stand in the order that data flows: time scales, the planetary kernel, the spacecraft's
//! trajectory, the targets, their directions as the observer sees them, the fitted onboard table
//! and its verification. Positions are km in ICRF axes from the solar system barycentre, times TDB;
//! directions leave the crate in the ecliptic of J2000.
//!
//! Limits that hold everywhere: bodies 4 to 8 are the barycentres of planetary systems (Jupiter's
//! lies up to 75 mas from the planet as seen from L2); light deflection by the Sun is not applied
//! (up to 4 mas at 90 deg from it).

mod convert;
pub mod random;

pub mod time;
mod daf;
mod interpolation;
mod spk;
pub mod kernel;
mod oem;
pub mod trajectory;
mod direction_table;
pub mod source;
pub mod apparent;
mod sight;
mod chebyshev;
pub mod fit;
pub mod verify;
