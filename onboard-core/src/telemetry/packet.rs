//! The primary header of a CCSDS space packet \[CCSDS133, 4.1.3\], around a payload.
//!
//! Six bytes, big-endian: version 000, type 0 (telemetry), secondary header flag, APID of 11 bits;
//! sequence flags 11 (a packet of its own) and a count of 14 bits; the data field's bytes less one.
//!
//! Limits: telemetry, unsegmented. A secondary header is the mission's, and in the data field.

use crate::bytes::{field, put};

/// Bytes of a packet's primary header.
pub const PACKET_HEADER_BYTES: usize = 6;
/// Largest application process identifier.
pub const MAX_APID: u16 = 0x7ff;
/// The identifier of idle packets, which hold nothing.
pub const IDLE_APID: u16 = MAX_APID;

const TELECOMMAND: u16 = 0x1000;
const SECONDARY_HEADER: u16 = 0x800;
const UNSEGMENTED: u16 = 0xc000;

/// Why six bytes are no header of a packet that is read here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PacketError {
    /// Another packet version number.
    Version(u8),
    /// It is a telecommand's.
    Telecommand,
    /// Its sequence flags: part of a longer unit of data.
    Segment(u8),
}

/// A packet's primary header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PacketHeader {
    /// Application process identifier, 0 to [`MAX_APID`].
    pub apid: u16,
    /// The data field begins with a secondary header.
    pub secondary_header: bool,
    /// Sequence count, 0 to 16383.
    pub count: u16,
    /// Bytes of the data field less one.
    pub data_bytes_less_one: u16,
}

impl PacketHeader {
    /// The header's bytes; of identifier and count the lower 11 and 14 bits.
    #[must_use]
    // REQ-TLM-4.
    pub fn to_be_bytes(&self) -> [u8; PACKET_HEADER_BYTES] {
        let flag = if self.secondary_header { SECONDARY_HEADER } else { 0 };
        let mut bytes = [0; PACKET_HEADER_BYTES];
        put(&mut bytes, 0, ((self.apid & MAX_APID) | flag).to_be_bytes());
        put(&mut bytes, 2, (self.count | UNSEGMENTED).to_be_bytes());
        put(&mut bytes, 4, self.data_bytes_less_one.to_be_bytes());
        bytes
    }

    /// Reads a header.
    ///
    /// # Errors
    /// [`PacketError`], the first thing found wrong.
    // REQ-TLM-4.
    pub fn from_be_bytes(bytes: [u8; PACKET_HEADER_BYTES]) -> Result<Self, PacketError> {
        let word = |offset| field(&bytes, offset).map_or(0, u16::from_be_bytes);
        let [first, second] = [word(0), word(2)];
        let [version, _] = first.wrapping_shr(5).to_be_bytes();
        let [segment, _] = second.wrapping_shr(6).to_be_bytes();
        if version != 0 {
            return Err(PacketError::Version(version));
        }
        if first & TELECOMMAND != 0 {
            return Err(PacketError::Telecommand);
        }
        if second & UNSEGMENTED != UNSEGMENTED {
            return Err(PacketError::Segment(segment));
        }
        Ok(Self {
            apid: first & MAX_APID,
            secondary_header: first & SECONDARY_HEADER != 0,
            count: second & !UNSEGMENTED,
            data_bytes_less_one: word(4),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    // REQ-TLM-4.
    fn a_header_is_the_standards_bits() {
        let header = PacketHeader {
            apid: 0x123,
            secondary_header: false,
            count: 5,
            data_bytes_less_one: 95,
        };
        assert_eq!(header.to_be_bytes(), [0x01, 0x23, 0xc0, 0x05, 0x00, 0x5f]);
        let most = PacketHeader {
            apid: MAX_APID,
            secondary_header: true,
            count: 0x3fff,
            data_bytes_less_one: u16::MAX,
        };
        assert_eq!(most.to_be_bytes(), [0x0f, 0xff, 0xff, 0xff, 0xff, 0xff]);
        for header in [header, most] {
            assert_eq!(PacketHeader::from_be_bytes(header.to_be_bytes()), Ok(header));
        }
        // What does not fit touches no other field.
        let wide = PacketHeader { apid: u16::MAX, secondary_header: false, ..most };
        assert_eq!(wide.to_be_bytes()[..2], [0x07, 0xff]);
    }

    #[test]
    // REQ-TLM-4.
    fn other_packets_are_refused() {
        let read = |a, c| PacketHeader::from_be_bytes([a, 0, c, 0, 0, 0]).unwrap_err();
        assert_eq!(read(0xa1, 0xc0), PacketError::Version(5));
        assert_eq!(read(0x20, 0xc0), PacketError::Version(1));
        assert_eq!(read(0x18, 0xc0), PacketError::Telecommand);
        assert_eq!(read(0x08, 0x40), PacketError::Segment(1));
        assert_eq!(read(0x08, 0xbf), PacketError::Segment(2));
    }
}
