//! What a file of telemetry holds, in numbers.

use super::columns::Part;
use super::fault::Fault;
use super::reports::{Passed, Reports};
use ephem::time::format_utc;
use onboard_core::telemetry::Payload;
use onboard_core::time::Instant;
use serde_json::{Value, json};
use std::io::Read;

/// What a file holds.
#[derive(Debug, Default)]
pub struct Summary {
    /// Events.
    pub events: u64,
    /// Housekeeping.
    pub housekeeping: u64,
    /// The earliest and the latest instant.
    pub ends: Option<(Instant, Instant)>,
    /// What was passed over.
    pub passed: Passed,
}

impl Summary {
    /// Reads a file to its end.
    ///
    /// # Errors
    /// [`Fault`] where it is refused.
    pub fn of<R: Read>(mut reports: Reports<R>, part: Part) -> Result<Self, Fault> {
        let mut summary = Self::default();
        for row in reports.by_ref() {
            let payload = row?.payload;
            if !part.has(&payload) {
                continue;
            }
            match payload {
                Payload::Event(_) => summary.events += 1,
                Payload::Housekeeping(_) => summary.housekeeping += 1,
            }
            if let Some(at) = payload.origin().at {
                let (first, last) = summary.ends.unwrap_or((at, at));
                summary.ends = Some((first.min(at), last.max(at)));
            }
        }
        summary.passed = reports.into_passed();
        Ok(summary)
    }

    /// As an object.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "events": self.events,
            "housekeeping": self.housekeeping,
            "first_utc": self.ends.map(|it| format_utc(it.0)),
            "last_utc": self.ends.map(|it| format_utc(it.1)),
            "other_packets": self.passed.packets,
            "damaged": self.passed.damaged,
            "damaged_bytes": self.passed.damaged_bytes,
        })
    }
}

impl Passed {
    /// What damage was passed over, in a sentence.
    #[must_use]
    pub fn told(&self) -> Option<String> {
        let first = self.first.as_ref()?;
        let (places, bytes) = (self.damaged, self.damaged_bytes);
        let plural = if places == 1 { "place" } else { "places" };
        Some(format!("{places} damaged {plural}, {bytes} bytes, passed over; the first at {first}"))
    }
}
