//! What stands in a container, in words.

use formats::uplink::body_told;
use onboard_core::uplink::AvoidanceRecord;
use std::fmt::Write;

/// Bytes as hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// An avoidance limit in words; degrees to nine places.
pub(super) fn avoidance_told(limit: &AvoidanceRecord) -> String {
    let degrees = (limit.angle_rad.to_degrees() * 1e9).round() / 1e9;
    format!("{} by {degrees} deg", body_told(limit.body))
}
