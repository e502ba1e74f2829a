//! What did the user ask for: the raw options of each verb, one file per part of the work.
//!
//! Options that several verbs share are groups of their own ([`SightArgs`], [`InstantArgs`],
//! [`FigureArgs`]); `meaning` says in `--help` what they mean to one verb.
//!
//! Limits: durations and angles are text here; the verbs read them, so that a fault names its option.

mod meaning;
mod sight;
mod instants;
mod figures;
mod looking;
mod forecast;
mod survey;
mod resonance;
mod systematics;
mod onboard;
mod verify;
mod telemetry;
mod plan;

pub use figures::FigureArgs;
pub use forecast::ForecastArgs;
pub use instants::InstantArgs;
pub use looking::{MissionsArgs, PointingArgs, TransitsArgs, VisitsArgs};
pub use onboard::{ClockArgs, SequenceArgs, TableVerb, VectorsArgs};
pub use plan::{AttitudeSpan, PlanArgs, ProductArgs, ReportArgs, RevisionArgs};
pub use resonance::{ActuatorArgs, ResonanceArgs};
pub use sight::SightArgs;
pub use survey::{SkyFrame, SurveyArgs};
pub use systematics::SystematicsArgs;
pub use telemetry::{DecodeArgs, Only, TelemetryVerb};
pub use verify::{Against, ReferenceFrame, VerifyArgs};
