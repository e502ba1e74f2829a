//! The spacecraft's states out of a CCSDS Orbit Ephemeris Message.
//!
//! Reads OEM in KVN or XML \[CCSDS502, CCSDS505\]. Each segment becomes a tabulated track from its
//! own centre, legal on its useable span; burns lie where segments meet.
//!
//! Frames: `REF_FRAME` ICRF, GCRF, EME2000 and J2000 are taken as the same axes (`ccsds::Axes`); the
//! frame bias of EME2000 (23 mas at most) is not applied. States in ECLIPJ2000 are turned to ICRF.
//!
//! Method: interpolation of the stated kind and degree; without one, Hermite of degree 7 on position
//! and velocity, whose track has a continuous velocity. LAGRANGE and LINEAR take position and
//! velocity apart. Covariance blocks and accelerations are skipped.
//!
//! Limits: one object; an unknown key is an error that lists the legal ones.

mod error;
mod meta;

pub use error::OemError;

use crate::ccsds::{
    Axes, CcsdsError, Column, Document, Expected, MessageKind, Record, Segment, epoch,
};
use crate::ecliptic::icrf_from_ecliptic;
use crate::interpolation::{PosVel, StateSeries};
use crate::time::{from_tdb_seconds, tdb_seconds};
use meta::Meta;
use nalgebra::Vector3;
use onboard_core::time::Instant;

/// Largest speed that is taken for a spacecraft's, km/s.
const LARGEST_KM_S: f64 = 1e3;
/// Largest distance that is taken for a spacecraft's, km.
const LARGEST_KM: f64 = 1e11;

const COLUMNS: [Column; 7] = [
    Column::of("EPOCH"),
    Column::in_unit("X", "km"),
    Column::in_unit("Y", "km"),
    Column::in_unit("Z", "km"),
    Column::in_unit("X_DOT", "km/s"),
    Column::in_unit("Y_DOT", "km/s"),
    Column::in_unit("Z_DOT", "km/s"),
];
/// What follows them: nothing, or three accelerations.
const MORE: [usize; 2] = [0, 3];
const STATE: Expected = Expected::Such(
    "a state: epoch, x y z in km, vx vy vz in km/s (then three accelerations or nothing)",
);
const PLAUSIBLE: Expected =
    Expected::Such("a plausible state (km and km/s: below 1e11 km and 1000 km/s)");

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

/// The segments of a file, in time order.
pub(crate) fn parse(text: &str) -> Result<Vec<OemSegment>, OemError> {
    let document = Document::parse(text)?;
    let mut segments: Vec<OemSegment> = Vec::new();
    for segment in document.segments(&MessageKind::OEM)? {
        let segment = segment?;
        let line = segment.line;
        let segment = track(&segment)?;
        if let Some(before) = segments.last().filter(|before| segment.start < before.stop) {
            return Err(OemError::Overlap { line, start: segment.start, stop: before.stop });
        }
        segments.push(segment);
    }
    if segments.is_empty() { Err(OemError::NoSegment) } else { Ok(segments) }
}

fn track(segment: &Segment<'_>) -> Result<OemSegment, OemError> {
    let line = segment.line;
    let meta = Meta::read(&segment.meta)?;
    let (mut nodes, mut states): (Vec<Instant>, Vec<PosVel>) = (Vec::new(), Vec::new());
    for record in &segment.records {
        let (epoch, at, state) = read_state(record, &meta)?;
        if nodes.last().is_some_and(|before| at <= *before) {
            return Err(OemError::Order { line: record.line, epoch: epoch.to_owned() });
        }
        nodes.push(at);
        states.push(state);
    }
    let few = OemError::Few { line, count: nodes.len() };
    let [first, .., last] = nodes[..] else { return Err(few) };
    let (start, stop) = (meta.start.max(first), meta.stop.min(last));
    if start >= stop {
        return Err(OemError::EmptySpan { line, start, stop });
    }
    let times = nodes.iter().map(|at| tdb_seconds(*at)).collect();
    let series = StateSeries::new(times, states, meta.method, meta.window).ok_or(few)?;
    Ok(OemSegment { start, stop, center: meta.center, series })
}

/// A record's epoch as text and instant, and its state in ICRF axes.
fn read_state<'d>(
    record: &Record<'d>,
    meta: &Meta,
) -> Result<(&'d str, Instant, PosVel), CcsdsError> {
    let refuse = || record.refused(STATE);
    let fields = record.fields(&COLUMNS, &MORE)?.ok_or_else(refuse)?;
    let [text, numbers @ ..] = &fields[..] else { return Err(refuse()) };
    let numbers: Vec<f64> = numbers
        .iter()
        .map(|field| field.parse().map_err(|_| refuse()))
        .collect::<Result<_, _>>()?;
    let [x, y, z, vx, vy, vz, ..] = numbers[..] else { return Err(refuse()) };
    let at = epoch(record.line, "epoch", text, meta.scale)?;
    let state = (Vector3::new(x, y, z), Vector3::new(vx, vy, vz));
    // NaN fails both comparisons.
    let plausible = state.0.norm() <= LARGEST_KM && state.1.norm() <= LARGEST_KM_S;
    if !plausible {
        return Err(record.refused(PLAUSIBLE));
    }
    let state = match meta.axes {
        Axes::Icrf => state,
        Axes::Ecliptic => (icrf_from_ecliptic(state.0), icrf_from_ecliptic(state.1)),
    };
    Ok((text, at, state))
}
