//! What does a CCSDS navigation message say: headers, metadata, epochs and frames, for OEM and AEM.
//!
//! A [`Document`] is KVN or XML; read as a [`MessageKind`] it gives one [`Segment`] after the other:
//! a [`Block`] of metadata and [`Record`]s. Both notations come in the same shape, each entry and
//! record with its line, counted from 1.
//!
//! Method: KVN \[CCSDS502, CCSDS504\] line by line, without blank lines and comments; XML \[CCSDS505\]
//! by `roxmltree`, which refuses document types and so entities, elements told by their local names.
//! Values are read in letters of any case, keywords in capitals. An [`epoch()`] is read in the
//! `TIME_SYSTEM` of its segment, by calendar or by day of the year, and rounded to the ns.
//!
//! Limits: time systems UTC, TAI, TT, TDB. GCRF, EME2000 and J2000 are taken as ICRF (23 mas at
//! most), see [`Axes`]. The header's keywords are checked in KVN alone, units in XML alone.
//!
//! # Example
//! ```
//! use ephem::ccsds::{Axes, CcsdsError, Column, Document, MessageKind};
//!
//! let text = "CCSDS_AEM_VERS = 2.0\nMETA_START\nREF_FRAME_A = gcrf\nTIME_SYSTEM = UTC\nMETA_STOP\n\
//!             DATA_START\n2032-092T00:00:00.5 0 0 0 1\nDATA_STOP\n";
//! let document = Document::parse(text)?;
//! for segment in document.segments(&MessageKind::AEM)? {
//!     let segment = segment?;
//!     assert_eq!(Axes::from_name(segment.meta.need("REF_FRAME_A")?.value), Some(Axes::Icrf));
//!     let epoch = segment.records[0].fields(&[Column::of("EPOCH")], &[4])?.unwrap_or_default()[0];
//!     let at = ephem::ccsds::epoch(7, "epoch", epoch, segment.meta.time_system()?)?;
//!     assert_eq!(ephem::time::format_utc(at), "2032-04-01T00:00:00.500000000Z");
//! }
//! # Ok::<(), CcsdsError>(())
//! ```

mod error;
mod kind;
mod frame;
mod epoch;
mod block;
mod record;
mod segment;
mod kvn;
mod xml;
mod document;

pub use block::{Block, Entry};
pub use document::{Document, Notation, Segments};
pub use epoch::epoch;
pub use error::{CcsdsError, Expected, Holder, Legal, Unfinished};
pub use frame::Axes;
pub use kind::{Fence, MessageKind};
pub use record::{Column, Record};
pub use segment::Segment;
