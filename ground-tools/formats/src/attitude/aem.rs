//! A CCSDS Attitude Ephemeris Message, version 2 \[CCSDS504\], in KVN or XML \[CCSDS505\].
//!
//! `REF_FRAME_A` is ICRF, `REF_FRAME_B` `SC_BODY_1`, the mission boresight frame, or `INSTRUMENT_1`,
//! that of one line of sight. Q1 Q2 Q3 QC is the quaternion that takes components in B to components in
//! ICRF, as B turned by +90 deg about A's z is (0, 0, 0.7071, 0.7071). ANGVEL is B's angular velocity
//! against ICRF, components in B, deg/s. Times are UTC.
//!
//! Method: one segment per span, written as its samples are made; USEABLE times are those of the
//! sessions.
//!
//! Limits: quaternions have 10 decimals (2e-10 rad), rates 9 decimals of deg/s, times whole
//! microseconds.

use super::samples::{Attitudes, Sample, Span, Step, lines, sampled};
use crate::error::WriteError;
use ephem::time::format_utc;
use onboard_core::time::{Duration, Instant};
use std::fmt::Write as _;
use std::io::Write;

/// Notation of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Notation {
    /// Keyword = value.
    Kvn,
    /// XML.
    Xml,
}

/// `REF_FRAME_B`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BodyFrame {
    /// The mission boresight's frame.
    Boresight,
    /// The frame of this telescope or detector.
    Instrument(String),
}

impl BodyFrame {
    /// Its name in the registry of frames \[CCSDS504\].
    const fn name(&self) -> &'static str {
        match self {
            Self::Boresight => "SC_BODY_1",
            Self::Instrument(_) => "INSTRUMENT_1",
        }
    }

    fn meaning(&self) -> String {
        match self {
            Self::Boresight => {
                "SC_BODY_1: z the mission's line of sight, x away from the spin axis, y \
                                along the scan"
                    .to_owned()
            }
            Self::Instrument(line) => {
                format!("INSTRUMENT_1: the frame of {line}, z its line of sight")
            }
        }
    }
}

/// What the message says but for its attitudes.
#[derive(Debug, Clone)]
pub struct Message<'m> {
    /// Its notation.
    pub notation: Notation,
    /// Whose attitude it is.
    pub frame: BodyFrame,
    /// What it is made from.
    pub attitudes: Attitudes<'m>,
}

impl Message<'_> {
    /// Writes a segment for each span; `named` says whose the spans are, by position.
    ///
    /// # Errors
    /// What the writer says, or an attitude cannot be made.
    pub fn write(
        &self,
        out: &mut dyn Write,
        spans: &[Span],
        named: &dyn Fn(usize) -> String,
    ) -> Result<(), WriteError> {
        out.write_all(self.head().as_bytes())?;
        for span in spans {
            let comments: Vec<String> = span.sessions.iter().map(|&it| named(it)).collect();
            out.write_all(self.metadata(span, &comments).as_bytes())?;
            let instants = span.instants(self.attitudes.step.step);
            sampled(&self.attitudes.motion, instants, |samples| -> Result<(), WriteError> {
                for piece in lines(samples, |text, sample| self.row(text, sample)) {
                    out.write_all(piece.as_bytes())?;
                }
                Ok(())
            })?;
            out.write_all(self.text("DATA_STOP\n", "   </data>\n  </segment>\n").as_bytes())?;
        }
        out.write_all(self.text("", " </body>\n</aem>\n").as_bytes())?;
        Ok(())
    }

    fn text<'t>(&self, kvn: &'t str, xml: &'t str) -> &'t str {
        match self.notation {
            Notation::Kvn => kvn,
            Notation::Xml => xml,
        }
    }

    fn head(&self) -> String {
        let mut comments: Vec<String> = self
            .attitudes
            .provenance
            .lines()
            .map(|(key, value)| format!("{key}: {value}"))
            .collect();
        comments.push(self.frame.meaning());
        comments.push(sampling(&self.attitudes.step));
        let mut text = self
            .text(
                "CCSDS_AEM_VERS = 2.0\n",
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<aem id=\"CCSDS_AEM_VERS\" \
                 version=\"2.0\">\n <header>\n",
            )
            .to_owned();
        for comment in &comments {
            self.pair(&mut text, "COMMENT", comment, 2);
        }
        self.pair(&mut text, "CREATION_DATE", &utc(self.attitudes.stamp), 2);
        self.pair(&mut text, "ORIGINATOR", &self.attitudes.product.originator, 2);
        text.push_str(self.text("", " </header>\n <body>\n"));
        text
    }

    fn metadata(&self, span: &Span, comments: &[String]) -> String {
        let mut text = self.text("\nMETA_START\n", "  <segment>\n   <metadata>\n").to_owned();
        for comment in comments {
            self.pair(&mut text, "COMMENT", comment, 4);
        }
        let (from, until) = span.covered;
        let pairs = [
            ("OBJECT_NAME", self.attitudes.product.object_name.clone()),
            ("OBJECT_ID", self.attitudes.product.object_id.clone()),
            ("REF_FRAME_A", "ICRF".to_owned()),
            ("REF_FRAME_B", self.frame.name().to_owned()),
            ("TIME_SYSTEM", "UTC".to_owned()),
            ("START_TIME", utc(span.first)),
            ("USEABLE_START_TIME", utc(from.max(span.first))),
            ("USEABLE_STOP_TIME", utc(down_to_us(until.min(span.last)))),
            ("STOP_TIME", utc(span.last)),
            ("ATTITUDE_TYPE", "QUATERNION/ANGVEL".to_owned()),
            ("ANGVEL_FRAME", self.frame.name().to_owned()),
        ];
        for (key, value) in &pairs {
            self.pair(&mut text, key, value, 4);
        }
        text.push_str(self.text("META_STOP\n\nDATA_START\n", "   </metadata>\n   <data>\n"));
        text
    }

    fn pair(&self, text: &mut String, key: &str, value: &str, indent: usize) {
        let _ = match (self.notation, key) {
            (Notation::Kvn, "COMMENT") => writeln!(text, "COMMENT {value}"),
            (Notation::Kvn, _) => writeln!(text, "{key} = {value}"),
            (Notation::Xml, _) => {
                writeln!(text, "{:indent$}<{key}>{}</{key}>", "", escaped(value))
            }
        };
    }

    fn row(&self, text: &mut String, sample: &Sample) {
        let time = utc(sample.at);
        let [q1, q2, q3, qc] = sample.quaternion;
        let [rate_x, rate_y, rate_z] = sample.body_rate_rad_s.map(f64::to_degrees);
        let _ = match self.notation {
            Notation::Kvn => {
                writeln!(
                    text,
                    "{time} {q1:.10} {q2:.10} {q3:.10} {qc:.10} {rate_x:.9} {rate_y:.9} {rate_z:.9}"
                )
            }
            Notation::Xml => writeln!(
                text,
                "    <attitudeState><quaternionAngVel><EPOCH>{time}</EPOCH><quaternion>\
                 <Q1>{q1:.10}</Q1><Q2>{q2:.10}</Q2><Q3>{q3:.10}</Q3><QC>{qc:.10}</QC></quaternion>\
                 <angVel><ANGVEL_X units=\"deg/s\">{rate_x:.9}</ANGVEL_X>\
                 <ANGVEL_Y units=\"deg/s\">{rate_y:.9}</ANGVEL_Y>\
                 <ANGVEL_Z units=\"deg/s\">{rate_z:.9}</ANGVEL_Z></angVel></quaternionAngVel>\
                 </attitudeState>"
            ),
        };
    }
}

/// How far samples are apart and what lies between, in a sentence.
#[must_use]
pub(super) fn sampling(step: &Step) -> String {
    format!(
        "samples every {} s of TAI, ends aside; spherical interpolation (slerp) between them errs \
         by at most {:.4} arcsec",
        step.step.seconds(),
        (step.error_rad.to_degrees() * 36_000_000.0).ceil() / 10_000.0
    )
}

/// UTC to the microsecond, without zeros at its end and the letter of its zone.
#[must_use]
pub(super) fn utc(at: Instant) -> String {
    let mut text = format_utc(at);
    text.truncate(26);
    text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    text
}

fn down_to_us(at: Instant) -> Instant {
    at.plus(Duration::from_ns(-at.tai_ns().rem_euclid(1000)))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_cut_to_the_microsecond_and_bounds_rounded_up() {
        let at = Instant::from_tai_ns(1_000_000_000_123_456_789);
        assert_eq!(utc(at).len(), 26);
        let minute = Instant::from_tai_ns(37_000_000_000 + 43_200_000_000_000 * 24_000);
        assert!(utc(minute).ends_with("T00:00:00") || utc(minute).ends_with("T12:00:00"));
        assert_eq!(down_to_us(at).tai_ns(), 1_000_000_000_123_456_000);
        let step = Step { step: Duration::from_ns(4_000_000_000), error_rad: 4e-6 };
        // 4e-6 rad is 0.825059 arcsec.
        assert!(sampling(&step).ends_with("at most 0.8251 arcsec"), "{}", sampling(&step));
        assert_eq!(escaped("a<b>&c"), "a&lt;b&gt;&amp;c");
    }
}
