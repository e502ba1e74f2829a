//! What is a session worth: how strong sources are in a beam, where passes cross it, and the effective
//! seconds that they bring to each purpose.
//!
//! # Example
//! How strong is Jupiter in the beam of LiteBIRD's first telescope, now and half a year later?
//! ```
//! use mission::Mission;
//! use planner::time::Duration;
//! use planner::{world::World, worth::strength_at};
//!
//! let world = World::open(Mission::load("litebird", &[])?, None)?;
//! let jupiter = world.targets.iter().position(|it| it.name() == "jupiter").ok_or("no Jupiter")?;
//! let later = world.start.plus(Duration::from_seconds(0.5 * 31_557_600.0));
//! let now = strength_at(&world, (jupiter, 0), world.start)?;
//! let then = strength_at(&world, (jupiter, 0), later)?;
//! assert!(now.antenna_k > Some(0.05) && now.diameter_rad != then.diameter_rad);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod strength;
mod signal;
mod angle;
mod error;
mod scene;
mod purposes;

pub(crate) use angle::angle_bin;
pub use error::{Unknown, WorthError};
pub(crate) use purposes::{Parts, Valued, Worth};
pub(crate) use scene::Scene;
pub use signal::{beam, flux, hwp_coverage, impact_rad, strength, strength_at};
