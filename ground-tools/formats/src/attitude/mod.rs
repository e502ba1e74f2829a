//! Which way does a frame point over a span: samples, and the formats that hold them. One file per
//! format; `samples` makes the attitudes of all.

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
