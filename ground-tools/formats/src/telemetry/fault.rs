//! Why a file of telemetry is refused, and where.

use onboard_core::telemetry::{LAYOUT_VERSION, PacketError, TelemetryError};
use thiserror::Error;

/// A place in a file of telemetry, and what was found there.
#[derive(Debug, Error)]
#[error("byte {offset}: {found}")]
pub struct Fault {
    /// The first byte of the payload or packet.
    pub offset: u64,
    /// What was found.
    pub found: Found,
}

/// What was found instead of telemetry.
#[derive(Debug, Error)]
pub enum Found {
    /// Bytes that begin neither.
    #[error(
        "0x{0:02x} begins neither a payload (0x{LAYOUT_VERSION:02x}) nor a space packet (0x00 to \
         0x0f)"
    )]
    Neither(u8),
    /// The file's end.
    #[error("the file ends in the middle: {needed} bytes are needed, {left} are there")]
    End {
        /// Bytes of the payload or packet.
        needed: usize,
        /// Bytes that are left.
        left: usize,
    },
    /// A packet that is none of telemetry, or a part of one.
    #[error("{}", packet_told(*.0))]
    Packet(PacketError),
    /// A payload that is refused.
    #[error("{}", payload_told(*.0))]
    Payload(TelemetryError),
    /// A payload of another spacecraft.
    #[error(
        "the payload is of spacecraft {found:08x}, the mission's is {wanted:08x}: --mission names \
         another one, or its product.object_name is another"
    )]
    Spacecraft {
        /// The payload's.
        found: u32,
        /// The mission's.
        wanted: u32,
    },
    /// What the system said.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

fn packet_told(error: PacketError) -> String {
    match error {
        PacketError::Version(number) => {
            format!("the packet's version number is {number}: 0 is read")
        }
        PacketError::Telecommand => "the packet is a telecommand".to_owned(),
        PacketError::Segment(flags) => {
            format!("the packet's sequence flags are {flags:02b}: 11, unsegmented, is read")
        }
        other => other.to_string(),
    }
}

fn payload_told(error: TelemetryError) -> String {
    match error {
        TelemetryError::Length(bytes) => {
            format!("the packet's data field has {bytes} bytes, its kind of payload another number")
        }
        TelemetryError::Version(first) => {
            format!("the payload begins with 0x{first:02x}: 0x{LAYOUT_VERSION:02x} is read")
        }
        TelemetryError::Kind(kind) => {
            format!("no kind of payload has the number {kind}: 1 to 8 and 16 are known")
        }
        TelemetryError::Damaged => "the payload is damaged: its CRC does not match".to_owned(),
        TelemetryError::State(state) => {
            format!("no state has the number {state}: 1 to 5 are known")
        }
        TelemetryError::Reason(reason) => {
            format!("no reason of this kind has the number {reason}: docs/telemetry.md lists them")
        }
        TelemetryError::Check(check) => {
            format!("no stage of a check has the number {check}: 1 to 3 are known")
        }
        TelemetryError::Illegal => {
            "the payload's CRC matches, but a word has a value that it cannot have".to_owned()
        }
        other => other.to_string(),
    }
}
