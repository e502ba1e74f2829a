//! What was asked: mission files, read, checked and typed.
//!
//! Modules stand in the order that data flows: exact numbers and quantities with units, faults, the
//! text of a mission and the reading of its sections, presets, then one module per section of the
//! file, and the mission.
//!
//! Nothing is printed here, and nothing knows of a command line but the names of options that an
//! [`Override`] carries into a fault.

pub mod number;
pub mod rounding;
pub mod quantity;
pub mod digest;
mod names;
pub mod fault;
mod reading;
pub mod presets;
mod file;
mod file_path;
pub mod span;
pub mod scan;
pub mod orbit;
mod detector;
mod focal_plane;
pub mod telescope;
pub mod schedule;
pub mod calibration;
mod mission;
pub mod occasions;

pub use file::Override;
pub use file_path::FilePath;
pub use mission::{Mission, Product};
pub use names::nearest_first;
