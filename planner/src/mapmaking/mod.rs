//! Which sky does a survey give back: I, Q and U per pixel from a timestream of a given sky.
//!
//! Data model, for a sample with the polarisation angle `psi_pol` and the plate's angle `phi`:
//!
//! `d = I + Q cos(4 phi - 2 psi_pol) - U sin(4 phi - 2 psi_pol)`
//!
//! with Q and U in the COSMO sense and `psi_pol = psi + 90 deg +` the angle from the detector's x axis
//! to its sensitive direction; without a plate phi = 0. This is [Takase2024, section 3.2], whose U is
//! the IAU's: `-psi_pol` grows from north to east. It is what makes a sky the same sky in every frame.
//!
//! Method: [`MapMaker`] adds up the normal matrix `A^T A` and `A^T d` of each pixel; [`BinnedMaps`]
//! solves. What a sample measures is a function of [`Sample`]: [`Sample::signal`] is the plain sky, and
//! systematic effects are other functions. The angle in a `Sample` is that of the sky's frame, the one
//! in the normal matrix that of the map's, so Q and U turn with the frame as they should.
//!
//! Limits: the sky is constant within each of its pixels, its beam a point.

mod sky;
mod sample;
mod binned;
mod maker;

pub use binned::{BinnedMaps, CONDITION_LIMIT, Solution, StokesMaps, map_bytes};
pub use maker::MapMaker;
pub use sample::Sample;
pub use sky::{PolarisationConvention, Sky, SkyError, SkyMap};
