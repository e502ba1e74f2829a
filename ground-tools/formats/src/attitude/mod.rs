//! Which way does a frame point over a span: samples, and the formats that hold them. One file per
//! format; `samples` makes the attitudes of all.
//!
//! # Example
//! A quarter of an hour of the boresight's attitude as one segment of an AEM:
//! ```
//! use formats::attitude::{Attitudes, BodyFrame, Message, Motion, Notation, Span};
//! use mission::{Mission, Override};
//! use planner::{provenance::Provenance, world::World};
//!
//! let set = [Override::set("span.duration_days=1/96")?];
//! let world = World::open(Mission::load("litebird", &set)?, None)?;
//! let tables = world.tables(&world.ground_options())?;
//! let frame = onboard_core::rotation::Rotation::IDENTITY;
//! let motion = Motion { scan: &world.scan, sun: world.sun(tables.parse()?)?, frame };
//! let (product, provenance) = (&world.mission.product, &Provenance::of(&world));
//! let (stamp, step) = (world.start, motion.step(1e-5));
//! let attitudes = Attitudes { product, provenance, stamp, motion, step };
//! let message = Message { notation: Notation::Kvn, frame: BodyFrame::Boresight, attitudes };
//! let mut aem = Vec::new();
//! message.write(&mut aem, &[Span::whole((world.start, world.end))], &|_| String::new())?;
//! let aem = String::from_utf8(aem)?;
//! assert!(aem.contains("REF_FRAME_A = ICRF\nREF_FRAME_B = SC_BODY_1\nTIME_SYSTEM = UTC\n"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod samples;
mod aem;
mod stk;
mod spice_error;
mod spice;

pub use aem::{BodyFrame, Message, Notation};
pub use samples::{Attitudes, Motion, Sample, Span, Step, StepError, lines, sampled, turned};
pub use spice::Kernels;
pub use spice_error::SpiceError;
pub use stk::{write_attitude as write_stk_attitude, write_intervals as write_stk_intervals};
