//! What the spacecraft says about itself, as fixed bytes.
//!
//! An [`EventReport`] is one event of a sequencer, [`Housekeeping`] the state of one telescope's
//! sequencer with tables, clock, tracker, scrub and forecast. Each becomes a payload of its own fixed
//! length, the user data field of a CCSDS space packet \[CCSDS133\], whose header a [`PacketHeader`]
//! writes. `docs/telemetry.md` has the layouts and the codes.
//!
//! Method: a payload is a row of unsigned words of 1, 2, 4 or 8 bytes, big-endian as in CCSDS, and a
//! CRC-32 behind them, because a space packet carries none. Signed numbers are two's complement, an
//! f64 its bits. Codes are written out (`code.rs`), those of the C interface, and are never given to
//! another meaning. What a kind does not use is zero.
//!
//! Reading payloads is the ground's: [`Payload`] is compiled for hosts and not for bare metal.
//!
//! Limits: a CRC guards against damage, not against forgery. An unknown version or code is refused
//! with its number. `rules.rs` shows that a million random reports come back and that no flipped bit
//! passes.

mod words;
mod code;
mod report;
mod event;
mod housekeeping;
mod packet;
#[cfg(not(target_os = "none"))]
mod payload;
#[cfg(test)]
mod rules;

pub use event::{EVENT_BYTES, EventReport};
pub use housekeeping::{
    ClockInUse, HOUSEKEEPING_BYTES, HOUSEKEEPING_KIND, Housekeeping, TablesInUse, TrackerHealth,
    VisitToCome,
};
pub use packet::{IDLE_APID, MAX_APID, PACKET_HEADER_BYTES, PacketError, PacketHeader};
#[cfg(not(target_os = "none"))]
pub use payload::{Payload, TelemetryError, payload_bytes};
pub use report::Origin;
pub use words::LAYOUT_VERSION;
