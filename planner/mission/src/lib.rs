//! What was asked: mission files, read, checked and typed.
//!
//! A [`Mission`] is a preset or a TOML file over its base, with [`Override`]s on top. A key that is
//! wrong is a [`fault::Fault`] with its place and what would be legal; all are told at once.
//!
//! Modules stand in the order that data flows: exact numbers and quantities with units, faults, the
//! text of a mission and the reading of its sections, presets, then one module per section of the
//! file, the mission, and the files that its schedule names.
//!
//! Nothing is printed here, and nothing knows of a command line but the names of options that an
//! [`Override`] carries into a fault.
//!
//! # Example
//! A preset with another angle, as read and as written with every key explicit:
//! ```
//! use mission::{Mission, Override};
//!
//! let mission = Mission::load("litebird", &[Override::set("scan.alpha_deg=47.5")?])?;
//! assert_eq!(mission.scan.alpha_rad.to_bits(), 47.5_f64.to_radians().to_bits());
//! assert_eq!(mission.scan.precession_period_min.text(), "192.348");
//! assert!(mission.warnings.is_empty() && mission.scan.covers_full_sky());
//! let folder = std::path::Path::new("");
//! let again = Mission::from_toml(mission.resolved_toml(), "again.toml", folder, &[])?;
//! assert_eq!(again.digest(), mission.digest());
//! # Ok::<(), mission::fault::MissionError>(())
//! ```

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
mod span;
mod scan;
pub mod orbit;
pub mod receiver;
mod detector;
mod focal_plane;
pub mod telescope;
pub mod requirement;
pub mod schedule;
pub mod sessions;
pub mod calibration;
mod mission;
pub mod occasions;

pub use file::Override;
pub use file_path::FilePath;
pub use mission::{Mission, Product};
pub use names::{in_any_case, meant, nearest_first};
pub use scan::{Scan, Tolerance};
pub use span::{Span, TimeText};
