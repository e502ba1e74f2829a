//! The spacecraft's states out of a CCSDS Orbit Ephemeris Message.
//!
//! Reads OEM in keyword = value notation [CCSDS 502.0-B-2, section 5]. Each META segment becomes a
//! tabulated track from its own centre, legal on its useable span; burns lie where segments meet.
//!
//! Frames: `REF_FRAME` ICRF, GCRF, EME2000 and J2000 are taken as the same axes; the frame bias of
//! EME2000 (23 mas at most) is not applied.
//!
//! Method: interpolation of the stated kind and degree; without one, Hermite of degree 7 on position
//! and velocity, whose track has a continuous velocity. LAGRANGE and LINEAR take position and
//! velocity apart. Covariance blocks and accelerations are skipped.
//!
//! Limits: KVN only, one object; an unknown key is an error that lists the legal ones.

mod meta;

use crate::interpolation::{PosVel, StateSeries};
use crate::time::{Scale, TimeError, format_tdb, from_tdb_seconds, parse_in_scale, tdb_seconds};
use meta::Meta;
use nalgebra::Vector3;
use onboard_core::time::Instant;
use thiserror::Error;

/// Keys that may stand in the header.
const HEADER_KEYS: [&str; 6] =
    ["CCSDS_OEM_VERS", "CLASSIFICATION", "COMMENT", "CREATION_DATE", "MESSAGE_ID", "ORIGINATOR"];
/// Versions whose KVN this reads.
const VERSIONS: [&str; 3] = ["1.0", "2.0", "3.0"];
/// Largest speed that is taken for a spacecraft's, km/s.
const LARGEST_KM_S: f64 = 1e3;
/// Largest distance that is taken for a spacecraft's, km.
const LARGEST_KM: f64 = 1e11;

/// Why an OEM file is refused; lines count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OemError {
    /// A value is not one of those known.
    #[error("line {line}: {key} is '{value}'; legal is {legal}")]
    Value {
        /// Line number.
        line: usize,
        /// Keyword.
        key: String,
        /// Its value.
        value: String,
        /// Legal values.
        legal: String,
    },
    /// A keyword is not known where it stands.
    #[error("line {line}: unknown key '{key}'; legal are {legal}")]
    Key {
        /// Line number.
        line: usize,
        /// Keyword.
        key: String,
        /// Legal keywords.
        legal: String,
    },
    /// A META block lacks a keyword.
    #[error("line {line}: META_STOP, but the block has no {key}")]
    Missing {
        /// Line of `META_STOP`.
        line: usize,
        /// Keyword.
        key: &'static str,
    },
    /// A line is not what its place asks for.
    #[error("line {line}: '{text}' is not {expected}")]
    Line {
        /// Line number.
        line: usize,
        /// The line.
        text: String,
        /// What it should be.
        expected: &'static str,
    },
    /// A time cannot be read.
    #[error("line {line}: {key}: {fault}")]
    Time {
        /// Line number.
        line: usize,
        /// Keyword, or `epoch` in a line of states.
        key: String,
        /// Why.
        fault: TimeError,
    },
    /// Epochs do not rise.
    #[error("line {line}: the epoch '{epoch}' is not later than the one before")]
    Order {
        /// Line number.
        line: usize,
        /// The epoch.
        epoch: String,
    },
    /// A segment has fewer than two states.
    #[error("the segment that begins at line {line} has {count} states; legal is 2 or more")]
    Few {
        /// Line of `META_START`.
        line: usize,
        /// States found.
        count: usize,
    },
    /// A segment's useable span is empty, or has no states around it.
    #[error(
        "the segment that begins at line {line} has no useable span: {} to {} TDB, states considered",
        format_tdb(*start), format_tdb(*stop)
    )]
    EmptySpan {
        /// Line of `META_START`.
        line: usize,
        /// Its first useable instant.
        start: Instant,
        /// Its last.
        stop: Instant,
    },
    /// A segment begins before the one before it ends.
    #[error(
        "the segment that begins at line {line} is useable from {} TDB, but the one before runs to {} TDB: state USEABLE_START_TIME and USEABLE_STOP_TIME so that they do not overlap",
        format_tdb(*start), format_tdb(*stop)
    )]
    Overlap {
        /// Line of the later `META_START`.
        line: usize,
        /// Its first useable instant.
        start: Instant,
        /// The last one of the segment before.
        stop: Instant,
    },
    /// The file ends too early.
    #[error("the file ends {0}")]
    Ended(&'static str),
}

/// One META segment's track.
#[derive(Debug, Clone)]
pub(crate) struct OemSegment {
    pub(crate) start: Instant,
    pub(crate) stop: Instant,
    /// NAIF number of the centre.
    pub(crate) center: i32,
    series: StateSeries,
}

impl OemSegment {
    /// State from the centre.
    pub(crate) fn state(&self, tdb_s: f64) -> PosVel {
        self.series.at(tdb_s)
    }

    /// Instants where its interpolation changes its window.
    pub(crate) fn joints(&self) -> Vec<Instant> {
        self.series.joints_s().into_iter().map(from_tdb_seconds).collect()
    }
}

/// The lines of a file that are not blank or comments, with their numbers.
struct Lines<'a> {
    lines: Vec<(usize, &'a str)>,
    next: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let is_comment = |line: &str| {
            line.strip_prefix("COMMENT").is_some_and(|r| r.is_empty() || r.starts_with([' ', '\t']))
        };
        let lines = text
            .trim_start_matches('\u{feff}')
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line.trim()))
            .filter(|(_, line)| !line.is_empty() && !is_comment(line))
            .collect();
        Self { lines, next: 0 }
    }

    fn peek(&self) -> Option<(usize, &'a str)> {
        self.lines.get(self.next).copied()
    }

    fn take(&mut self) -> Option<(usize, &'a str)> {
        let line = self.peek();
        self.next += 1;
        line
    }
}

/// Splits `KEY = value`.
fn key_value(line: usize, text: &str) -> Result<(&str, &str), OemError> {
    text.split_once('=').map(|(key, value)| (key.trim(), value.trim())).ok_or_else(|| {
        OemError::Line { line, text: text.to_owned(), expected: "of the form KEY = value" }
    })
}

/// The segments of a file, in time order.
pub(crate) fn parse(text: &str) -> Result<Vec<OemSegment>, OemError> {
    let mut lines = Lines::new(text);
    read_header(&mut lines)?;
    let mut segments: Vec<OemSegment> = Vec::new();
    while let Some((line, _)) = lines.peek() {
        let segment = read_segment(&mut lines)?;
        if let Some(before) = segments.last().filter(|before| segment.start < before.stop) {
            return Err(OemError::Overlap { line, start: segment.start, stop: before.stop });
        }
        segments.push(segment);
    }
    if segments.is_empty() {
        return Err(OemError::Ended("before any META_START"));
    }
    Ok(segments)
}

fn read_header(lines: &mut Lines<'_>) -> Result<(), OemError> {
    let (line, first) = lines.peek().ok_or(OemError::Ended("before its first line"))?;
    let (key, version) = key_value(line, first)?;
    if key != "CCSDS_OEM_VERS" {
        let expected = "CCSDS_OEM_VERS = 2.0, with which an OEM begins";
        return Err(OemError::Line { line, text: first.to_owned(), expected });
    }
    if !VERSIONS.contains(&version) {
        return Err(illegal(line, key, version, &VERSIONS));
    }
    while let Some((line, text)) = lines.peek() {
        if text == "META_START" {
            return Ok(());
        }
        let (key, _) = key_value(line, text)?;
        if !HEADER_KEYS.contains(&key) {
            return Err(unknown_key(line, key, &HEADER_KEYS));
        }
        lines.take();
    }
    Err(OemError::Ended("before any META_START"))
}

fn illegal(line: usize, key: &str, value: &str, legal: &[&str]) -> OemError {
    OemError::Value { line, key: key.to_owned(), value: value.to_owned(), legal: legal.join(", ") }
}

fn unknown_key(line: usize, key: &str, legal: &[&str]) -> OemError {
    OemError::Key { line, key: key.to_owned(), legal: legal.join(", ") }
}

fn read_time(line: usize, key: &str, text: &str, scale: Scale) -> Result<Instant, OemError> {
    let bare = if scale == Scale::Utc { text.strip_suffix('Z').unwrap_or(text) } else { text };
    parse_in_scale(bare, scale).map_err(|fault| OemError::Time { line, key: key.to_owned(), fault })
}

fn read_segment(lines: &mut Lines<'_>) -> Result<OemSegment, OemError> {
    let start_line = lines.peek().map_or(0, |(line, _)| line);
    let meta = meta::read(lines)?;
    let (mut nodes, mut states): (Vec<Instant>, Vec<PosVel>) = (Vec::new(), Vec::new());
    while let Some((line, text)) = lines.peek() {
        if text == "META_START" {
            break;
        }
        if text == "COVARIANCE_START" {
            skip_covariance(lines)?;
            continue;
        }
        let (at, state) = read_state(line, text, &meta)?;
        if nodes.last().is_some_and(|before| at <= *before) {
            let epoch = text.split_whitespace().next().unwrap_or_default().to_owned();
            return Err(OemError::Order { line, epoch });
        }
        nodes.push(at);
        states.push(state);
        lines.take();
    }
    let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else {
        return Err(OemError::Few { line: start_line, count: 0 });
    };
    let few = OemError::Few { line: start_line, count: nodes.len() };
    if nodes.len() < 2 {
        return Err(few);
    }
    let (start, stop) = (meta.start.max(*first), meta.stop.min(*last));
    if start >= stop {
        return Err(OemError::EmptySpan { line: start_line, start, stop });
    }
    let times = nodes.iter().map(|at| tdb_seconds(*at)).collect();
    let series = StateSeries::new(times, states, meta.method, meta.window).ok_or(few)?;
    Ok(OemSegment { start, stop, center: meta.center, series })
}

fn skip_covariance(lines: &mut Lines<'_>) -> Result<(), OemError> {
    while let Some((_, text)) = lines.take() {
        if text == "COVARIANCE_STOP" {
            return Ok(());
        }
    }
    Err(OemError::Ended("inside a covariance block, without COVARIANCE_STOP"))
}

fn read_state(line: usize, text: &str, meta: &Meta) -> Result<(Instant, PosVel), OemError> {
    let expected =
        "a state: epoch, x y z in km, vx vy vz in km/s (then three accelerations or nothing)";
    let refuse = || OemError::Line { line, text: text.to_owned(), expected };
    let mut fields = text.split_whitespace();
    let epoch = fields.next().ok_or_else(refuse)?;
    let numbers: Vec<f64> =
        fields.map(|field| field.parse().map_err(|_| refuse())).collect::<Result<_, _>>()?;
    let (&[x, y, z, vx, vy, vz] | &[x, y, z, vx, vy, vz, ..]) = numbers.as_slice() else {
        return Err(refuse());
    };
    if !matches!(numbers.len(), 6 | 9) {
        return Err(refuse());
    }
    let at = read_time(line, "epoch", epoch, meta.scale)?;
    let state = (Vector3::new(x, y, z), Vector3::new(vx, vy, vz));
    // NaN fails both comparisons.
    let plausible = state.0.norm() <= LARGEST_KM && state.1.norm() <= LARGEST_KM_S;
    if !plausible {
        let expected = "a plausible state (km and km/s: below 1e11 km and 1000 km/s)";
        return Err(OemError::Line { line, text: text.to_owned(), expected });
    }
    Ok((at, state))
}
