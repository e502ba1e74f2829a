//! What is a session worth: how strong sources are in a beam, where passes cross it, and the effective
//! seconds that they bring to each purpose.

pub mod strength;
pub mod signal;
mod angle;
mod error;
mod scene;
mod purposes;

pub(crate) use angle::angle_bin;
pub use error::{Unknown, WorthError};
pub(crate) use purposes::{Parts, Valued, Worth};
pub(crate) use scene::Scene;
