//! What stands in a container, in words.

use ephem::kernel::body_name;
use ephem::source::SUN_AS_TARGET;
use onboard_core::ephemeris::{FIRST_USER_BODY, SUN};
use onboard_core::uplink::AvoidanceRecord;
use std::fmt::Write;

/// Bytes as hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// The name of a body in a table.
pub(super) fn name(number: i32) -> String {
    match number {
        SUN => "sun_to_spacecraft".to_owned(),
        SUN_AS_TARGET => "sun".to_owned(),
        own if own >= FIRST_USER_BODY => format!("source {own}"),
        body => body_name(body).to_owned(),
    }
}

/// An avoidance limit in words; degrees to nine places.
pub(super) fn avoidance_told(limit: &AvoidanceRecord) -> String {
    let degrees = (limit.angle_rad.to_degrees() * 1e9).round() / 1e9;
    format!("{} by {degrees} deg", name(limit.body))
}
