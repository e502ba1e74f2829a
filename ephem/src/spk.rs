//! States from the segments of an SPK file.
//!
//! Answers: position and velocity of a body from its segment's centre, in km and km/s, ICRF axes,
//! at TDB seconds since J2000. Of segments that overlap, the last in the file counts.
//!
//! Method: Chebyshev segments (types 2 and 3) are evaluated by ANISE; discrete states (types 8, 9,
//! 12, 13, 18, 19) by the interpolation that OEM files share; modified differences (types 1 and 21)
//! here. NAIF's "SPK Required Reading".
//!
//! Limits: frame J2000 (number 1) only. Everything that is indexed is checked on loading: counts,
//! record times, finite and plausible numbers. A changed coefficient that keeps its size is caught
//! where neighbouring Chebyshev records no longer meet (`Spk::check_joints`).

mod error;
mod difference;
mod packets;
mod segment;

pub use error::{LegalNumber, SpkError};
pub(crate) use segment::Unsupported;

use crate::convert::count_from_f64;
use crate::daf::{Summary, doubles, summaries};
use crate::interpolation::PosVel;
use anise::naif::daf::NAIFDataSet;
use anise::naif::daf::datatypes::{Type2ChebyshevSet, Type3ChebyshevSet};
use anise::naif::spk::summary::SPKSummaryRecord;
use nalgebra::Vector3;
use segment::{Content, Reader};
use std::collections::BTreeMap;

#[derive(Debug, Clone)]
struct Segment {
    summary: Summary,
    content: Content,
}

/// The segments of one file.
#[derive(Clone)]
pub(crate) struct Spk {
    data: Vec<f64>,
    segments: Vec<Segment>,
    /// Indices into `segments` by body, in the order of the file.
    bodies: BTreeMap<i32, Vec<usize>>,
}

impl core::fmt::Debug for Spk {
    /// Names the bodies; the numbers would fill a book.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Spk").field("bodies", &self.bodies).finish_non_exhaustive()
    }
}

/// A body's state from its centre at one time, or why there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Link {
    State { state: PosVel, center: i32 },
    NoBody,
    OutOfSpan,
    Unsupported(Unsupported),
}

impl Spk {
    /// Reads a file and checks all that evaluation will index.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, SpkError> {
        let summaries = summaries(bytes)?;
        if summaries.is_empty() {
            return Err(SpkError::Empty);
        }
        let data = doubles(bytes);
        let mut segments = Vec::new();
        let mut bodies: BTreeMap<i32, Vec<usize>> = BTreeMap::new();
        for (index, summary) in summaries.into_iter().enumerate() {
            let numbers = data.get(summary.first..summary.end).unwrap_or_default();
            let content = Reader { number: index + 1, summary, numbers }.content()?;
            bodies.entry(summary.target).or_default().push(index);
            segments.push(Segment { summary, content });
        }
        Ok(Self { data, segments, bodies })
    }

    /// The bodies that have segments, in rising order.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = i32> {
        self.bodies.keys().copied()
    }

    /// State of `body` from the centre of the segment that counts at `tdb_s`.
    pub(crate) fn link(&self, body: i32, tdb_s: f64) -> Link {
        let Some(indices) = self.bodies.get(&body) else { return Link::NoBody };
        let segment = indices
            .iter()
            .rev()
            .filter_map(|index| self.segments.get(*index))
            .find(|s| (s.summary.start_s..=s.summary.end_s).contains(&tdb_s));
        let Some(segment) = segment else { return Link::OutOfSpan };
        match self.evaluate(segment, tdb_s) {
            Ok(state) => Link::State { state, center: segment.summary.center },
            Err(unsupported) => Link::Unsupported(unsupported),
        }
    }

    fn evaluate(&self, segment: &Segment, tdb_s: f64) -> Result<PosVel, Unsupported> {
        let summary = &segment.summary;
        let numbers = self.data.get(summary.first..summary.end).unwrap_or_default();
        let record = SPKSummaryRecord {
            start_epoch_et_s: summary.start_s,
            end_epoch_et_s: summary.end_s,
            ..Default::default()
        };
        let evaluated = match &segment.content {
            Content::Unsupported(why) => return Err(*why),
            Content::Discrete(series) => return Ok(series.at(tdb_s)),
            Content::Differences(lines) => return Ok(lines.at(tdb_s)),
            Content::Pieces(pieces) => return Ok(pieces.at(tdb_s)),
            Content::Chebyshev => Type2ChebyshevSet::from_f64_slice(numbers)
                .ok()
                .and_then(|set| set.evaluate(tdb_s, &record).ok()),
            Content::ChebyshevWithVelocity => Type3ChebyshevSet::from_f64_slice(numbers)
                .ok()
                .and_then(|set| set.evaluate(tdb_s, &record).ok()),
        };
        evaluated.ok_or(Unsupported::Type(summary.data_type))
    }

    /// First start and last end of a body's segments, in TDB seconds, and the first one's centre.
    pub(crate) fn span(&self, body: i32) -> Option<(f64, f64, i32)> {
        let indices = self.bodies.get(&body)?;
        let segments = indices.iter().filter_map(|index| self.segments.get(*index));
        let mut span: Option<(f64, f64, i32)> = None;
        for Segment { summary: s, .. } in segments {
            let (start, end, center) = span.unwrap_or((s.start_s, s.end_s, s.center));
            span = Some((start.min(s.start_s), end.max(s.end_s), center));
        }
        span
    }

    /// The centres of a body's segments.
    pub(crate) fn centers(&self, body: i32) -> impl Iterator<Item = i32> {
        let indices = self.bodies.get(&body).map(Vec::as_slice).unwrap_or_default();
        indices.iter().filter_map(|index| self.segments.get(*index)).map(|it| it.summary.center)
    }

    /// Starts and ends of a body's segments in TDB seconds, sorted.
    pub(crate) fn segment_edges(&self, body: i32) -> Vec<f64> {
        let indices = self.bodies.get(&body).map(Vec::as_slice).unwrap_or_default();
        let mut edges: Vec<f64> = indices
            .iter()
            .filter_map(|index| self.segments.get(*index))
            .flat_map(|s| [s.summary.start_s, s.summary.end_s])
            .collect();
        edges.sort_by(f64::total_cmp);
        edges
    }

    /// Times in TDB seconds at which a body's interpolation of states changes its window.
    pub(crate) fn joint_times(&self, body: i32) -> Vec<f64> {
        let indices = self.bodies.get(&body).map(Vec::as_slice).unwrap_or_default();
        let mut times = Vec::new();
        for segment in indices.iter().filter_map(|index| self.segments.get(*index)) {
            match &segment.content {
                Content::Discrete(series) => times.extend(series.joints_s()),
                Content::Differences(lines) => times.extend(lines.ends_s()),
                Content::Pieces(pieces) => times.extend(pieces.joints_s()),
                _ => {}
            }
        }
        times
    }

    /// Checks that the Chebyshev records of these bodies meet their neighbours.
    ///
    /// DE440 does so to 2 mm; 1e-10 of the distance plus 0.1 m is accepted.
    pub(crate) fn check_joints(&self, bodies: &[i32]) -> Result<(), SpkError> {
        for (index, segment) in self.segments.iter().enumerate() {
            let s = &segment.summary;
            let per_axis = match segment.content {
                Content::Chebyshev => 3,
                Content::ChebyshevWithVelocity => 6,
                _ => continue,
            };
            if !bodies.contains(&s.target) {
                continue;
            }
            let numbers = self.data.get(s.first..s.end).unwrap_or_default();
            let size = numbers.get(numbers.len().saturating_sub(2)).copied();
            let size = size.and_then(count_from_f64).unwrap_or(usize::MAX);
            let mut before: Option<Vector3<f64>> = None;
            for (record, content) in numbers.chunks_exact(size).enumerate() {
                let (start, end) = ends(content, (size - 2) / per_axis);
                if let Some(before) = before {
                    let jump_km = (start - before).norm();
                    let legal_km = 1e-4 + 1e-10 * start.norm();
                    if jump_km > legal_km {
                        let (segment, body) = (index + 1, s.target);
                        return Err(SpkError::Joint { segment, body, record, jump_km, legal_km });
                    }
                }
                before = Some(end);
            }
        }
        Ok(())
    }
}

/// Positions at both ends of a Chebyshev record: `T_k(-1) = (-1)^k`, `T_k(1) = 1`.
fn ends(record: &[f64], orders: usize) -> (Vector3<f64>, Vector3<f64>) {
    let axis = |axis: usize| {
        let from = 2 + axis * orders;
        record.get(from..from + orders).unwrap_or_default()
    };
    let sum = |sign: f64| {
        Vector3::from_fn(|row, _| {
            let alternate = |(order, c): (usize, &f64)| if order % 2 == 1 { sign * c } else { *c };
            axis(row).iter().enumerate().map(alternate).sum()
        })
    };
    (sum(-1.0), sum(1.0))
}
