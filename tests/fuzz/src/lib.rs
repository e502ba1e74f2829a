//! What the fuzz targets run: one module per target, each with the rules that must hold.
//!
//! Every target takes any bytes. Nothing may panic, hang or overflow, and what is accepted must be
//! usable, must keep its own promises, and must come back from its encoder as the same bytes.
//! Targets of parsers try the bytes as they are and once more with lengths, CRCs and digests put
//! right ([`repair`]), so that what lies behind the CRCs is reached.

pub mod input;
pub mod repair;
pub mod seeds;

pub mod ephemeris;
pub mod mission;
pub mod plan;
pub mod container;
pub mod records;
pub mod slots;
pub mod sequencer;
pub mod telemetry;
