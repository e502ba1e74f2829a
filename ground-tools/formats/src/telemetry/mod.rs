//! What a spacecraft has sent: a file of telemetry as rows.
//!
//! A file is payloads of the flight core ([`onboard_core::telemetry`], `docs/telemetry.md`) back to
//! back, or CCSDS space packets back to back that hold one each. Which it is, is told byte by byte: a
//! payload begins with 0xa1, a packet with three zero bits.
//!
//! Method: what is read is held to its CRC and to every code before it becomes a row. Damage ends the
//! reading, or is passed over to the next whole payload and counted. Idle packets, and with an APID
//! all others, are passed over.
//!
//! Limits: in a packet with a secondary header the payload is looked for at the packet's end.
//! Segmented packets and telecommands are refused.
//!
//! # Example
//! A payload out of the flight core, and the row that becomes of it:
//! ```
//! use formats::telemetry::{Reports, Wanted};
//! use onboard_core::sequencer::Event;
//! use onboard_core::telemetry::{EventReport, Origin};
//!
//! let origin = Origin { spacecraft: 7, telescope: 0, ticks: 5, at: None };
//! let file = EventReport { origin, event: Event::Ended(3) }.to_be_bytes();
//! let wanted = Wanted { spacecraft: 7, ..Wanted::default() };
//! let rows: Vec<_> = Reports::new(&file[..], wanted).collect::<Result<_, _>>()?;
//! assert_eq!((rows.len(), rows[0].kind(), rows[0].session()), (1, "ended", Some(3)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod words;
mod fault;
mod row;
mod reports;
mod columns;
mod summary;

pub use columns::{Part, columns};
pub use fault::{Fault, Found};
pub use reports::{Passed, Reports, Wanted};
pub use row::Row;
pub use summary::Summary;
pub use words::{KINDS, REASONS, STATES, Value};
