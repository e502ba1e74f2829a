//! How a telescope's sequencer and what it works with are, as a payload of 268 bytes.
//!
//! What is not there (no tables, no clock, no tracker, ...) is `None`, its words are zero, and its
//! bit is not set.

use super::code;
use super::report::{HEAD_SIZES, Origin, instant};
use super::words::{group, seal};
use crate::clock::ClockCorrelation;
use crate::forecast::NextVisit;
use crate::sequencer::{Lost, Tick};
use crate::time::Instant;
use crate::tracking::Tracker;
use crate::uncertainty::ScanCovariance;
use crate::uplink::{ScrubProgress, Tables};

/// Bytes of housekeeping's payload.
pub const HOUSEKEEPING_BYTES: usize = 268;
/// The kind that stands for it.
pub const HOUSEKEEPING_KIND: u8 = 16;

/// Evaluations of the tick, and its check.
pub(super) const TICK_SIZES: [u8; 2] = [2, 2];
/// Sequence number, digest, end of validity.
pub(super) const TABLES_SIZES: [u8; 3] = [4, 8, 8];
/// Sequence number, uncertainty, end of validity.
pub(super) const CLOCK_SIZES: [u8; 3] = [4, 4, 8];
/// Events lost, by kind.
pub(super) const LOST_SIZES: [u8; 8] = [4; 8];
/// Epoch, accepted, refused.
pub(super) const TRACKER_SIZES: [u8; 3] = [8, 4, 4];
/// Variances, and once more covariances.
pub(super) const COVARIANCE_SIZES: [u8; 3] = [8; 3];
/// Standard deviations of the rates.
pub(super) const RATE_SIZES: [u8; 2] = [8; 2];
/// How far, of how many.
pub(super) const SCRUB_SIZES: [u8; 2] = [4, 4];
/// Body, clipped edges, entry, exit, earliest entry, latest exit, probability, sigma.
pub(super) const VISIT_SIZES: [u8; 8] = [4, 4, 8, 8, 8, 8, 8, 8];

/// What is there, by its bit; the first is the instant's.
pub(super) const TABLES: u8 = 2;
pub(super) const TABLES_DAMAGED: u8 = 4;
pub(super) const CLOCK: u8 = 8;
pub(super) const TRACKER: u8 = 16;
pub(super) const SCRUB: u8 = 32;
pub(super) const VISIT: u8 = 64;
/// Which edge of the visit to come is the search's own.
pub(super) const ENTRY_CLIPPED: u8 = 1;
pub(super) const EXIT_CLIPPED: u8 = 2;

/// The tables in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TablesInUse {
    /// Their sequence number.
    pub sequence: u32,
    /// The digest of their contents.
    pub set_digest: u64,
    /// Last instant that they serve.
    pub valid_until: Instant,
}

/// The clock correlation in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClockInUse {
    /// Its sequence number.
    pub sequence: u32,
    /// Standard uncertainty at its reference in ns.
    pub uncertainty_ns: u32,
    /// Last instant at which it may be used.
    pub valid_until: Instant,
}

/// How well the tracker knows the scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackerHealth {
    /// Instant of the last accepted measurement, or the tracker's epoch.
    pub epoch: Instant,
    /// Accepted measurements since its start.
    pub accepted: u32,
    /// Refused ones since the last accepted.
    pub refused_in_a_row: u32,
    /// Covariance of precession phase, alpha and spin phase now.
    pub covariance: ScanCovariance,
    /// Standard deviations of precession and spin rate in rad/s, at the epoch.
    pub rate_sigmas_rad_s: [f64; 2],
}

/// A target's next visit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisitToCome {
    /// The target's number in the tables.
    pub body: i32,
    /// First instant inside, or the search's start.
    pub entry: Instant,
    /// Last instant inside, or the search's end.
    pub exit: Instant,
    /// The target was inside already at the search's start.
    pub entry_clipped: bool,
    /// The target was still inside at the search's end.
    pub exit_clipped: bool,
    /// Entry less 1.96 standard deviations.
    pub earliest_entry: Instant,
    /// Exit plus 1.96 standard deviations.
    pub latest_exit: Instant,
    /// Probability that the target enters the field at all.
    pub probability: f64,
    /// Standard deviation of the entry in seconds.
    pub entry_sigma_s: f64,
}

/// How a telescope's sequencer and what it works with are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Housekeeping {
    /// Whose and of when.
    pub origin: Origin,
    /// What the last tick brought: state, evaluations, the next session's check.
    pub tick: Tick,
    /// The tables in use.
    pub tables: Option<TablesInUse>,
    /// Their bytes were found damaged after they had been loaded.
    pub tables_damaged: bool,
    /// The clock correlation in use.
    pub clock: Option<ClockInUse>,
    /// Events lost so far.
    pub lost: Lost,
    /// How well the tracker knows the scan.
    pub tracker: Option<TrackerHealth>,
    /// How far the scrub has come in this round.
    pub scrub: Option<ScrubProgress>,
    /// The visit to come that the forecast has found.
    pub visit: Option<VisitToCome>,
}

impl TablesInUse {
    /// Of these tables.
    #[must_use]
    pub const fn of(tables: &Tables<'_>) -> Self {
        let header = tables.header();
        Self {
            sequence: header.sequence,
            set_digest: tables.set_digest(),
            valid_until: header.valid_until,
        }
    }
}

impl ClockInUse {
    /// Of this correlation.
    #[must_use]
    pub const fn of(clock: &ClockCorrelation) -> Self {
        Self {
            sequence: clock.sequence,
            uncertainty_ns: clock.uncertainty_ns,
            valid_until: clock.valid_until,
        }
    }
}

impl TrackerHealth {
    const NONE: Self = Self {
        epoch: Instant::from_tai_ns(0),
        accepted: 0,
        refused_in_a_row: 0,
        covariance: ScanCovariance::ZERO,
        rate_sigmas_rad_s: [0.0; 2],
    };

    /// Of this tracker, its covariance carried on to `at`.
    #[must_use]
    pub fn of(tracker: &Tracker, at: Instant) -> Self {
        Self {
            epoch: tracker.epoch(),
            accepted: tracker.accepted(),
            refused_in_a_row: tracker.refused_in_a_row(),
            covariance: tracker.covariance_at(at),
            rate_sigmas_rad_s: tracker.rate_sigmas_rad_s(),
        }
    }
}

impl VisitToCome {
    /// Of what a forecast found for the body of this number.
    #[must_use]
    pub const fn of(next: &NextVisit, body: i32) -> Self {
        let NextVisit { transit, confidence } = next;
        Self {
            body,
            entry: transit.entry,
            exit: transit.exit,
            entry_clipped: transit.entry_clipped,
            exit_clipped: transit.exit_clipped,
            earliest_entry: confidence.earliest_entry,
            latest_exit: confidence.latest_exit,
            probability: confidence.probability,
            entry_sigma_s: confidence.entry_sigma_s,
        }
    }
}

impl Housekeeping {
    /// The payload.
    #[must_use]
    #[inline(never)]
    // REQ-TLM-1.
    pub fn to_be_bytes(&self) -> [u8; HOUSEKEEPING_BYTES] {
        let there = bit(self.tables.is_some(), TABLES)
            | bit(self.tables_damaged, TABLES_DAMAGED)
            | bit(self.clock.is_some(), CLOCK)
            | bit(self.tracker.is_some(), TRACKER)
            | bit(self.scrub.is_some(), SCRUB)
            | bit(self.visit.is_some(), VISIT);
        let head = self.origin.head((HOUSEKEEPING_KIND, there), code::state(self.tick.state));
        let evaluations = self.tick.evaluations.min(u16::MAX.into());
        let tick = [evaluations.into(), code::progress(self.tick.check).into()];
        let tables = self
            .tables
            .map_or([0; 3], |it| [it.sequence.into(), it.set_digest, instant(it.valid_until)]);
        let clock = self.clock.map_or([0; 3], |it| {
            [it.sequence.into(), it.uncertainty_ns.into(), instant(it.valid_until)]
        });
        let scrub = self.scrub.map_or([0; 2], |it| [it.at.into(), it.length.into()]);
        let tracker = self.tracker.unwrap_or(TrackerHealth::NONE);
        let covariance = tracker.covariance;
        let mut payload = [0; HOUSEKEEPING_BYTES];
        seal(
            &mut payload,
            &[
                group(&HEAD_SIZES, &head),
                group(&TICK_SIZES, &tick),
                group(&TABLES_SIZES, &tables),
                group(&CLOCK_SIZES, &clock),
                group(&LOST_SIZES, &lost(&self.lost)),
                group(&TRACKER_SIZES, &counts(&tracker)),
                group(&COVARIANCE_SIZES, &covariance.variances.map(f64::to_bits)),
                group(&COVARIANCE_SIZES, &covariance.covariances.map(f64::to_bits)),
                group(&RATE_SIZES, &tracker.rate_sigmas_rad_s.map(f64::to_bits)),
                group(&SCRUB_SIZES, &scrub),
                group(&VISIT_SIZES, &self.visit.as_ref().map_or([0; 8], visit)),
            ],
        );
        payload
    }
}

const fn bit(is_there: bool, bit: u8) -> u8 {
    if is_there { bit } else { 0 }
}

fn lost(lost: &Lost) -> [u64; 8] {
    let Lost { entered, started, ended, skipped, aborted, safe, tables, time_jumped } = *lost;
    [entered, started, ended, skipped, aborted, safe, tables, time_jumped].map(u64::from)
}

fn counts(tracker: &TrackerHealth) -> [u64; 3] {
    [instant(tracker.epoch), tracker.accepted.into(), tracker.refused_in_a_row.into()]
}

fn visit(visit: &VisitToCome) -> [u64; 8] {
    let clipped = bit(visit.entry_clipped, ENTRY_CLIPPED) | bit(visit.exit_clipped, EXIT_CLIPPED);
    [
        visit.body.cast_unsigned().into(),
        clipped.into(),
        instant(visit.entry),
        instant(visit.exit),
        instant(visit.earliest_entry),
        instant(visit.latest_exit),
        visit.probability.to_bits(),
        visit.entry_sigma_s.to_bits(),
    ]
}
