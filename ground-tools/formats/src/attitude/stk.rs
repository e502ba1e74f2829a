//! Attitude and sessions for STK: an attitude file (`.a`) and an interval list (`.int`).
//!
//! Quaternions are scalar last and of the rotation that turns the ICRF axes to the mission boresight
//! frame's, about n by A: (n sin A/2, cos A/2). These are the numbers that take components in the
//! boresight frame to ICRF by q v q*, so they stand unchanged. Times are seconds since `ScenarioEpoch`,
//! which is UTC; intervals are UTC.
//!
//! Method: the samples of the other products, one block; STK's linear interpolation between them.
//!
//! Limits: the format has no gaps: between the spans of sessions STK interpolates across what is not
//! there, so the interval list says where the attitude holds (or the whole mission is written). Both
//! follow the published format; no STK read them here.

use super::aem::sampling;
use super::samples::{Attitudes, Sample, Span, lines, sampled};
use crate::error::WriteError;
use crate::timeline::Timeline;
use ephem::time::{civil_from_day, format_utc, utc_day};
use onboard_core::time::Instant;
use std::fmt::Write as _;
use std::io::Write;

/// The version from which on STK knows ICRF axes.
const VERSION: &str = "stk.v.11.0";
const MONTHS: [&str; 12] =
    ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

/// Writes the attitude file.
///
/// # Errors
/// What the writer says, or an attitude cannot be made.
pub fn write_attitude(
    out: &mut dyn Write,
    attitudes: &Attitudes<'_>,
    spans: &[Span],
) -> Result<(), WriteError> {
    let Attitudes { motion, step, .. } = attitudes;
    let count: usize = spans.iter().map(|span| span.count(step.step)).sum();
    // The epoch is a whole second, so that seconds since it are short.
    let epoch = spans.first().map_or(motion.scan.parameters().start, |span| span.first);
    let epoch = Instant::from_tai_ns(epoch.tai_ns().div_euclid(1_000_000_000) * 1_000_000_000);
    write!(
        out,
        "{VERSION}\n# {}\nBEGIN Attitude\nNumberOfAttitudePoints {count}\nBlockingFactor 20\n\
         InterpolationOrder 1\nCentralBody Sun\nScenarioEpoch {}\nCoordinateAxes ICRF\n\
         AttitudeTimeQuaternions\n\n",
        sampling(step),
        gregorian(epoch)
    )?;
    for span in spans {
        sampled(motion, span.instants(step.step), |samples| -> Result<(), WriteError> {
            for piece in lines(samples, |text, sample| row(text, sample, epoch)) {
                out.write_all(piece.as_bytes())?;
            }
            Ok(())
        })?;
    }
    out.write_all(b"\nEND Attitude\n")?;
    Ok(())
}

fn row(text: &mut String, sample: &Sample, epoch: Instant) {
    let us = sample.at.since(epoch).ns().div_euclid(1000);
    let [x, y, z, w] = sample.quaternion;
    let (seconds, us) = (us / 1_000_000, us % 1_000_000);
    let _ = writeln!(text, "{seconds}.{us:06} {x:.10} {y:.10} {z:.10} {w:.10}");
}

/// Writes the interval list: one interval per session, its id as data.
///
/// # Errors
/// What the writer says.
pub fn write_intervals(out: &mut dyn Write, timeline: &Timeline) -> Result<(), WriteError> {
    write!(
        out,
        "{VERSION}\n# {}: calibration sessions\nBEGIN IntervalList\nDATEUNITABRV UTCG\nBEGIN \
         Intervals\n",
        timeline.provenance.mission
    )?;
    for session in &timeline.sessions {
        let [from, until] = [session.start_tai_ns, session.end_tai_ns]
            .map(|ns| gregorian(Instant::from_tai_ns(ns)));
        writeln!(out, "\"{from}\" \"{until}\" \"{}\"", session.id)?;
    }
    out.write_all(b"END Intervals\nEND IntervalList\n")?;
    Ok(())
}

/// `1 Apr 2032 06:30:00.123456789`, UTC.
fn gregorian(at: Instant) -> String {
    let (year, month, day) = civil_from_day(utc_day(at));
    let month = usize::try_from(month - 1).ok().and_then(|it| MONTHS.get(it)).unwrap_or(&"");
    let text = format_utc(at);
    format!("{day} {month} {year:04} {}", text.get(11..29).unwrap_or(""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ephem::time::parse_time;

    #[test]
    fn dates_are_gregorian() {
        let at = parse_time("2032-04-01T06:30:00.5Z").unwrap();
        assert_eq!(gregorian(at), "1 Apr 2032 06:30:00.500000000");
        let at = parse_time("2032-12-21T23:59:59.999999999Z").unwrap();
        assert_eq!(gregorian(at), "21 Dec 2032 23:59:59.999999999");
    }

    #[test]
    fn rows_count_microseconds_from_the_epoch() {
        let epoch = Instant::from_tai_ns(1_000_000_000_000_000_000);
        let at = Instant::from_tai_ns(1_000_000_004_000_007_000);
        let sample = Sample { at, quaternion: [0.0, 0.6, -0.0, 0.8], body_rate_rad_s: [0.0; 3] };
        let mut text = String::new();
        row(&mut text, &sample, epoch);
        assert!(text.starts_with("4.000007 0.0000000000 0.6000000000"), "{text}");
    }
}
