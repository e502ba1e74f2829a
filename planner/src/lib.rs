//! What follows from a mission: what its scanning strategy demands of the hardware, how it covers the
//! sky, which calibration opportunities it offers, and which of them to take.
//!
//! All angles are radians, rates radians per second or hertz, times ns of TAI; degrees, minutes and rpm
//! belong to files and reports. Nothing is printed here.
//!
//! Modules stand in the order that data flows. A [`mission::Mission`] becomes a [`world::World`]: the
//! mission among the planets. From it follow [`constraints`], [`visits`] and a [`survey`] with its
//! [`mapmaking`]; [`opportunities`], which of them the spacecraft would begin ([`onboard`]), what each is
//! [`worth`] and what they teach ([`information`]), a [`schedule`] by integer
//! [`program`]ming, and all of these in one call: a [`plan`]. [`resonance`] judges the periods,
//! [`history_fit`] the attitudes that were flown.
//!
//! # Example
//! The first session of a preset's plan for a week:
//! ```
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, time::format_utc, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=7")?])?;
//! let world = World::open(mission, None)?;
//! let sessions = plan(&world, &Revision::default(), &Quietly)?.sessions(&world)?;
//! let first = &sessions[0];
//! assert_eq!((first.telescope.as_str(), first.target.as_str()), ("MFT", "jupiter"));
//! assert_eq!(format_utc(first.start), "2032-04-01T02:08:51.467582318Z");
//! assert_eq!(first.dwell.seconds().round(), 50.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod progress;
pub mod time;
pub mod healpix;
pub mod harmonics;
pub mod world;
pub mod provenance;
pub mod constraints;
pub mod visits;
pub mod opportunities;
pub mod onboard;
pub mod worth;
pub mod information;
mod conic;
pub mod program;
pub mod schedule;
pub mod plan;
pub mod survey;
pub mod mapmaking;
pub mod systematics;
pub mod resonance;
pub mod history_fit;
