//! Where the Sun, the planets and the spacecraft are, and the tables that tell the flight core.
//!
//! Modules stand in the order that data flows; no file uses a later one.
//!
//! | modules | what goes in | what comes out |
//! |---|---|---|
//! | [`random`] | a seed | numbers that are the same in every run |
//! | [`time`] | texts, scales | `onboard_core::time::Instant` |
//! | [`ccsds`] | OEM or AEM in KVN or XML | metadata and records with their lines |
//! | `interpolation`, `daf`, `spk` | bytes of an SPK | states by segment |
//! | [`kernel`] | an SPK of the planets | barycentric states of bodies |
//! | `oem`, [`trajectory`] | L2, an SPK or an OEM | barycentric states of the spacecraft |
//! | `direction_table`, [`source`] | names, coordinates, CSV | what can be a target |
//! | [`apparent`] | kernel, trajectory, source | directions as the observer sees them |
//! | `sight`, `chebyshev`, [`fit`] | directions over a span | the onboard table |
//! | [`verify`] | a table, the directions | how far they differ |
//!
//! `convert` holds the numeric casts, `ecliptic` the rotation from ICRF. Positions are km in ICRF
//! axes from the solar system barycentre, times TDB; directions leave the crate in the ecliptic of
//! J2000.
//!
//! Limits that hold everywhere: bodies 4 to 8 are the barycentres of planetary systems (Jupiter's
//! lies up to 75 mas from the planet as seen from L2); light deflection by the Sun is not applied
//! (up to 4 mas at 90 deg from it).

mod convert;
pub mod random;

pub mod time;
mod ecliptic;
pub mod ccsds;
mod interpolation;
mod daf;
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
