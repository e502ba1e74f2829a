//! The effects, one file each: spins, fields and numbers of a systematic signal.
//!
//! Angles are in radians in the sense of psi, from the detector's x axis, unless an effect says
//! otherwise.

mod pointing;
mod wedge;
mod hwp_ip;
mod hwp_2f;
mod ellipticity;
mod polarisation_angle;
mod gain;
mod time_constant;
mod sidelobe;
mod pair;
mod named;

pub use ellipticity::Ellipticity;
pub use gain::Gain;
pub use hwp_2f::HwpTwoF;
pub use hwp_ip::{HwpIp, IpForm};
pub use named::{ActsOn, EffectKind, KINDS, Measure, Motions, NameError, Parameter};
pub use pair::{PairEllipticity, PairGain, PairPointing};
pub use pointing::Pointing;
pub use polarisation_angle::PolarisationAngle;
pub use sidelobe::Sidelobe;
pub use time_constant::TimeConstant;
pub use wedge::Wedge;
