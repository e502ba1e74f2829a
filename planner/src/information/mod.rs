//! What do passes teach about detectors: gain, pointing, beam, time constant, angle of polarisation.
//!
//! A pass is a straight chord through a Gaussian beam, and its information is a matrix in closed form
//! ([`Crossing`]); matrices add over passes, sessions and targets ([`forecast()`]). [`Errors`] are those of
//! each parameter with all others free, and name what cannot be told apart. [`Profile`] says how well
//! the beam's response is known at a distance from its centre.
//!
//! Frames: the detector's, as in [`crate::worth`]. Units: K, rad, s and fractions.
//!
//! Limits: `docs/information.md` lists them with the tests that show them.
//!
//! # Example
//! How well does Jupiter teach the gain of a channel of LiteBIRD in 30 days?
//! ```
//! use mission::{Mission, Override};
//! use planner::information::{Errors, Parameter, Question, Windows, forecast, looks};
//! use planner::{progress::Quietly, world::World};
//!
//! let mission = Mission::load("litebird", &[Override::set("span.duration_days=30")?])?;
//! let mut world = World::open(mission, None)?;
//! world.keep_targets(&["jupiter".to_owned()])?;
//! let tables = world.tables(&world.ground_options())?;
//! let looks = looks(&world.mission, Some("MFT"), Some("M1-100"))?;
//! let windows = Windows::new((world.start, world.end), &[None]);
//! let question = Question { looks: &looks, windows: &windows, sessions: None };
//! let found = forecast(&world, tables.parse()?, &question, &Quietly)?;
//! let errors = Errors::of(&found.lesson(0, 0, 0).fisher);
//! assert!(errors.of_parameter(Parameter::Gain).is_some_and(|it| it < 0.01));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod parameter;
mod fisher;
mod pass;
mod errors;
mod noise;
mod window;
mod sight;
mod profile;
mod beam_map;
mod signal;
mod error;
mod forecast;
mod rows;
mod teaching;
#[cfg(test)]
mod signal_model;
#[cfg(test)]
mod published;

pub use beam_map::{BeamMap, SIDE};
pub use error::InformationError;
pub use errors::{Degeneracy, Errors, NULL, STRONG};
pub use fisher::Fisher;
pub use forecast::{Forecast, Left, Lesson, Question, Session, beam_map, forecast};
pub use noise::{BACKGROUND_K, SHORT, antenna_per_thermodynamic, share_left};
pub use parameter::{COUNT, Parameter};
pub use pass::{Crossing, Modulation, SIGMA_PER_FWHM};
pub use profile::{ANNULI, CELLS_PER_FWHM, Profile, decibel, gaussian, inner_radius_fwhm};
pub use rows::{Measure, Row, Verdict, Why, rows, verdicts, windows_of};
pub use sight::{Look, REACH, looks};
pub use teaching::{Teaching, one_of_each};
pub use window::{MONTH_DAYS, QUARTER_DAYS, Windows};
