//! Payloads and packet headers, as they are and with their CRC put right.

use onboard_core::telemetry::{
    EventReport, LAYOUT_VERSION, PacketHeader, Payload, TelemetryError, payload_bytes,
};
use onboard_core::uplink::checksum;

/// Reads a payload and a packet's header from the front of the bytes.
pub fn run(data: &[u8]) {
    read(data);
    if let [first, kind, ..] = *data
        && let Some(size) = payload_bytes(kind)
    {
        let mut image = data.to_vec();
        image.resize(size, 0);
        image[0] = LAYOUT_VERSION;
        let crc = checksum(&image[..size - 4]).to_be_bytes();
        image[size - 4..].copy_from_slice(&crc);
        assert_ne!(read(&image), Some(TelemetryError::Damaged), "{first}");
    }
    if let Some(bytes) = data.first_chunk()
        && let Ok(header) = PacketHeader::from_be_bytes(*bytes)
    {
        assert_eq!(header.to_be_bytes(), *bytes);
    }
}

/// What is accepted comes back as the same bytes, and an event out of them as the same event.
fn read(bytes: &[u8]) -> Option<TelemetryError> {
    match Payload::from_be_bytes(bytes) {
        Ok(Payload::Event(report)) => {
            let again = EventReport { origin: report.origin, event: report.event };
            assert_eq!(again.to_be_bytes(), bytes);
            None
        }
        Ok(Payload::Housekeeping(report)) => {
            assert_eq!(report.to_be_bytes(), bytes);
            None
        }
        Err(error) => Some(error),
    }
}
