//! `gyrfalcon table inspect`: what a container, a clock correlation or an order holds.

use super::container::{load, read};
use super::words::{avoidance_told, hex};
use crate::cli::SharedArgs;
use crate::failure::Failure;
use crate::verb::delivered::{answer, answer_json};
use ephem::time::format_tdb;
use formats::uplink::{body_told, span_told};
use onboard_core::clock::{CLOCK_BYTES, ClockCorrelation, ClockError};
use onboard_core::ephemeris::Span;
use onboard_core::uplink::{
    MISSION_CHANGE_BYTES, MissionChangeError, MissionChangeOrder, ROLLBACK_BYTES, RollbackError,
    RollbackOrder,
};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

const DAMAGED: &str = "it is damaged: its CRC does not match";

pub(super) fn run(shared: &SharedArgs, file: &Path) -> Result<(), Failure> {
    let bytes = read(file)?;
    match bytes.get(..8) {
        Some(b"GYRCLOCK") => return clock(shared, file, &bytes),
        Some(b"GYRBACK\0") => return rollback(shared, file, &bytes),
        Some(b"GYRCHNGE") => return change(shared, file, &bytes),
        _ => {}
    }
    let tables = load(file, &bytes)?;
    let header = tables.header();
    let digest = hex(&header.mission_digest);
    let spans: Vec<Span> = tables.ephemeris().spans().collect();
    if shared.json {
        let spans: Vec<Value> = spans
            .iter()
            .map(|span| {
                json!({
                    "body": span.body,
                    "name": body_told(span.body),
                    "start_tai_ns": span.start.tai_ns(),
                    "granules": span.granules,
                    "granule_ns": span.granule_ns,
                    "coefficients": span.coefficients,
                })
            })
            .collect();
        return answer_json(
            shared,
            &json!({
                "bytes": bytes.len(),
                "version": onboard_core::uplink::VERSION,
                "sequence": header.sequence,
                "valid_from_tai_ns": header.valid_from.tai_ns(),
                "valid_until_tai_ns": header.valid_until.tai_ns(),
                "set_digest": format!("{:016x}", tables.set_digest()),
                "mission_sha256_prefix": digest,
                "spacecraft": format!("{:08x}", header.spacecraft),
                "spans": spans,
                "telescopes": tables.mission().telescopes().count(),
                "detectors": tables.mission().detectors().count(),
                "avoidance": tables.mission().avoidance().count(),
                "sessions": tables.plan().sessions().count(),
            }),
        );
    }
    let mission = tables.mission();
    let parameters = *mission.strategy().parameters();
    let mut text = format!(
        "{}: {} bytes, format version {}, sequence {}\nvalid {}\nmission SHA-256 {digest}..., set \
         digest {:016x}\nmission: alpha {} deg, beta {} deg, {} telescopes, {} listed detectors\n",
        file.display(),
        bytes.len(),
        onboard_core::uplink::VERSION,
        header.sequence,
        span_told(header.valid_from, header.valid_until),
        tables.set_digest(),
        parameters.alpha_rad.to_degrees(),
        parameters.beta_rad.to_degrees(),
        mission.telescopes().count(),
        mission.detectors().count()
    );
    for limit in mission.avoidance() {
        let _ = writeln!(text, "avoidance: {}", avoidance_told(&limit));
    }
    let _ = writeln!(text, "plan: {} sessions", tables.plan().sessions().count());
    let _ = writeln!(
        text,
        "\n{:<18} {:>8} {:>12} {:>6}  span",
        "body", "granules", "granule (d)", "terms"
    );
    for span in spans {
        let end = span.end().unwrap_or(span.start);
        let granule = onboard_core::time::Duration::from_ns(
            i64::try_from(span.granule_ns.get()).unwrap_or(i64::MAX),
        );
        let _ = writeln!(
            text,
            "{:<18} {:>8} {:>12.3} {:>6}  {}",
            body_told(span.body),
            span.granules,
            granule.seconds() / 86_400.0,
            span.coefficients,
            span_told(span.start, end)
        );
    }
    answer(shared, &text)
}

fn clock(shared: &SharedArgs, file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let record: &[u8; CLOCK_BYTES] = sized(file, bytes, "a clock correlation")?;
    let record = ClockCorrelation::from_le_bytes(record).map_err(|error| match error {
        ClockError::Illegal => {
            refused(file, "its tick has no length, or its validity runs backwards")
        }
        _ => refused(file, DAMAGED),
    })?;
    let tick_ns = {
        let (ns, fraction) = (record.tick_bits >> 64, record.tick_bits & u128::from(u64::MAX));
        format!("{ns} + {fraction}/2^64")
    };
    if shared.json {
        return answer_json(
            shared,
            &json!({
                "sequence": record.sequence,
                "spacecraft": format!("{:08x}", record.spacecraft),
                "ticks": record.ticks,
                "at_tai_ns": record.at.tai_ns(),
                "tick_ns": tick_ns,
                "uncertainty_ns": record.uncertainty_ns,
                "valid_from_tai_ns": record.valid_from.tai_ns(),
                "valid_until_tai_ns": record.valid_until.tai_ns(),
            }),
        );
    }
    answer(
        shared,
        &format!(
            "{}: clock correlation, sequence {}\ncounter {} at {} TDB (+- {} ns), tick {tick_ns} \
             ns\nvalid {}\n",
            file.display(),
            record.sequence,
            record.ticks,
            format_tdb(record.at),
            record.uncertainty_ns,
            span_told(record.valid_from, record.valid_until)
        ),
    )
}

fn rollback(shared: &SharedArgs, file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let order: &[u8; ROLLBACK_BYTES] = sized(file, bytes, "a rollback order")?;
    let order = RollbackOrder::from_le_bytes(order).map_err(|error| match error {
        RollbackError::NotBack => {
            refused(file, "it does not lead back to an older sequence number")
        }
        _ => refused(file, DAMAGED),
    })?;
    if shared.json {
        return answer_json(
            shared,
            &json!({
                "from": order.from,
                "to": order.to,
                "to_set_digest": format!("{:016x}", order.to_digest),
                "until_tai_ns": order.until.tai_ns(),
            }),
        );
    }
    answer(
        shared,
        &format!(
            "{}: rollback from sequence {} to {} (set digest {:016x}), until {} TDB\n",
            file.display(),
            order.from,
            order.to,
            order.to_digest,
            format_tdb(order.until)
        ),
    )
}

fn change(shared: &SharedArgs, file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let order: &[u8; MISSION_CHANGE_BYTES] = sized(file, bytes, "an order to change the mission")?;
    let order = MissionChangeOrder::from_le_bytes(order).map_err(|error| match error {
        MissionChangeError::NoChange => refused(file, "it names the same spacecraft twice"),
        _ => refused(file, DAMAGED),
    })?;
    let (from, to) = (format!("{:08x}", order.from), format!("{:08x}", order.to));
    if shared.json {
        return answer_json(
            shared,
            &json!({
                "from_spacecraft": from,
                "to_spacecraft": to,
                "sequence": order.sequence,
                "set_digest": format!("{:016x}", order.set_digest),
                "until_tai_ns": order.until.tai_ns(),
            }),
        );
    }
    answer(
        shared,
        &format!(
            "{}: change from spacecraft {from} to {to} with sequence {} (set digest {:016x}), \
             until {} TDB\n",
            file.display(),
            order.sequence,
            order.set_digest,
            format_tdb(order.until)
        ),
    )
}

/// The bytes of a record of fixed size.
fn sized<'b, const N: usize>(
    file: &Path,
    bytes: &'b [u8],
    what: &str,
) -> Result<&'b [u8; N], Failure> {
    bytes
        .try_into()
        .map_err(|_| refused(file, &format!("{what} takes {N} bytes, not {}", bytes.len())))
}

fn refused(file: &Path, why: &str) -> Failure {
    Failure::Input(format!("{}: {why}", file.display()))
}
