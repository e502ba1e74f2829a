//! What others read and write: rows as CSV, JSON lines and Parquet, maps in FITS, a plan's timeline and
//! calendar, attitudes for operations and simulators, the container that goes on board, test vectors,
//! attitude histories, telemetry.
//!
//! Modules stand in the order that data flows: what every file needs ([`degrees`], [`rows`], [`fits`]);
//! what is told of [`resonance`], [`visits`], a [`survey`] and a [`forecast`]; a plan's [`timeline`], its [`calendar`],
//! [`attitude`] and pointing [`periods`], and the [`products`] that its folder holds; what goes on
//! board ([`uplink`]) and tests it ([`vectors`]); what comes back ([`history`], [`telemetry`]).
//!
//! Nothing is printed here and no file is named: writers take a [`std::io::Write`] or give bytes,
//! readers take a text or a path.
//!
//! # Example
//! A day's plan as JSON, and as the table for the uplink:
//! ```
//! use formats::timeline::timeline;
//! use formats::uplink::{Contents, records};
//! use mission::{Mission, Override};
//! use planner::plan::{Revision, plan};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=1")?])?;
//! let world = &World::open(mission, None)?;
//! let plan = plan(world, &Revision::default(), &Quietly)?;
//! let json = timeline(world, &plan, None)?.to_json()?;
//! let sessions = records(world, &plan)?;
//! let ephemeris = &plan.offered.tables.fitted.bytes;
//! let table = Contents { world, ephemeris, sessions: Some(&sessions), sequence: 1 }.to_bytes()?;
//! assert!(json.starts_with(b"{\n \"mission\": \"LiteBIRD\","));
//! assert!(table.starts_with(b"GYRFALCN"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
pub mod degrees;
pub mod rows;
pub mod fits;
pub mod maps;
pub mod resonance;
pub mod visits;
pub mod survey;
pub mod forecast;
pub mod timeline;
pub mod calendar;
pub mod attitude;
pub mod periods;
pub mod products;
pub mod uplink;
pub mod flown;
pub mod sequence;
pub mod vectors;
pub mod history;
pub mod telemetry;

pub use error::WriteError;
