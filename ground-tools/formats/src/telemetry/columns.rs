//! The columns of decoded telemetry.

use super::row::Row;
use crate::rows::Column;
use crate::rows::Field::{Count, MaybeTdb, MaybeUtc, Number, Whole, Word};
use crate::uplink::body_told;
use crate::visits::clipped;
use onboard_core::sequencer::{Lost, Progress};
use onboard_core::telemetry::{
    ClockInUse, Housekeeping, Payload, TablesInUse, TrackerHealth, VisitToCome,
};
use onboard_core::time::Instant;
use onboard_core::uplink::ScrubProgress;

/// Which payloads become rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// All of them.
    All,
    /// Events.
    Events,
    /// Housekeeping.
    Housekeeping,
}

impl Part {
    /// Whether a payload belongs to it.
    #[must_use]
    pub const fn has(self, payload: &Payload) -> bool {
        match self {
            Self::All => true,
            Self::Events => matches!(payload, Payload::Event(_)),
            Self::Housekeeping => matches!(payload, Payload::Housekeeping(_)),
        }
    }
}

/// The columns of that part: those of every payload, of events, of housekeeping.
#[must_use]
pub fn columns(part: Part) -> Vec<Column<Row>> {
    let mut columns = common();
    if part != Part::Housekeeping {
        columns.extend(events());
    }
    if part != Part::Events {
        columns.extend(sequencer());
        columns.extend(tracker());
        columns.extend(visit());
    }
    columns
}

fn common() -> Vec<Column<Row>> {
    vec![
        Column::new("byte", Count(|it| Some(it.offset))),
        Column::new("apid", Count(|it| it.packet.map(|it| it.apid.into()))),
        Column::new("packet", Count(|it| it.packet.map(|it| it.count.into()))),
        Column::new("kind", Word(|it| Some(it.kind().into()))),
        Column::new("telescope", Word(|it| it.telescope().map(Into::into))),
        Column::new("telescope_index", Count(|it| Some(it.payload.origin().telescope.into()))),
        Column::new("counter", Word(|it| Some(it.payload.origin().ticks.to_string().into()))),
        Column::new("time_utc", MaybeUtc(|it| it.payload.origin().at)),
        Column::new("time_tdb", MaybeTdb(|it| it.payload.origin().at)),
        Column::new("tai_ns", Whole(|it| it.payload.origin().at.map(Instant::tai_ns))),
        Column::new("state", Word(|it| it.state().map(Into::into))),
        Column::new("session", Count(|it| it.session().map(u64::from))),
        Column::new("reason", Word(|it| it.reason().map(Into::into))),
        Column::new("value", Whole(|it| it.value(0))),
        Column::new("second_value", Whole(|it| it.value(1))),
        Column::new("value_utc", MaybeUtc(|it| it.instant(0))),
        Column::new("second_value_utc", MaybeUtc(|it| it.instant(1))),
    ]
}

fn events() -> [Column<Row>; 9] {
    [
        Column::new("target", Word(|it| it.record().map(|it| body_told(it.body).into()))),
        Column::new("body", Whole(|it| it.record().map(|it| it.body.into()))),
        Column::new("turn", Count(|it| it.record().map(|it| it.turn.into()))),
        Column::new("passes", Count(|it| it.record().map(|it| it.passes.into()))),
        Column::new("start_utc", MaybeUtc(|it| it.record().map(|it| it.start))),
        Column::new("first_entry_utc", MaybeUtc(|it| it.record().map(|it| it.first_entry))),
        Column::new("last_exit_utc", MaybeUtc(|it| it.record().map(|it| it.last_exit))),
        Column::new("end_utc", MaybeUtc(|it| it.record().map(|it| it.end))),
        Column::new("start_tai_ns", Whole(|it| it.record().map(|it| it.start.tai_ns()))),
    ]
}

fn tables(row: &Row) -> Option<TablesInUse> {
    row.housekeeping()?.tables
}

fn clock(row: &Row) -> Option<ClockInUse> {
    row.housekeeping()?.clock
}

fn scrub(row: &Row) -> Option<ScrubProgress> {
    row.housekeeping()?.scrub
}

fn lost(row: &Row, of: fn(&Lost) -> u32) -> Option<u64> {
    row.housekeeping().map(|it| of(&it.lost).into())
}

const fn check(report: &Housekeeping) -> &'static str {
    match report.tick.check {
        Progress::Waiting => "waiting",
        Progress::UnderWay => "under-way",
        Progress::Done => "done",
    }
}

const fn damaged(report: &Housekeeping) -> &'static str {
    if report.tables_damaged { "yes" } else { "no" }
}

fn sequencer() -> [Column<Row>; 20] {
    [
        Column::new("check", Word(|it| it.housekeeping().map(|it| check(it).into()))),
        Column::new("evaluations", Count(|it| Some(it.housekeeping()?.tick.evaluations.into()))),
        Column::new("tables_sequence", Count(|it| Some(tables(it)?.sequence.into()))),
        Column::new(
            "tables_digest",
            Word(|it| Some(format!("{:016x}", tables(it)?.set_digest).into())),
        ),
        Column::new("tables_until_utc", MaybeUtc(|it| Some(tables(it)?.valid_until))),
        Column::new("tables_damaged", Word(|it| it.housekeeping().map(|it| damaged(it).into()))),
        Column::new("clock_sequence", Count(|it| Some(clock(it)?.sequence.into()))),
        Column::new("clock_uncertainty_ns", Count(|it| Some(clock(it)?.uncertainty_ns.into()))),
        Column::new("clock_until_utc", MaybeUtc(|it| Some(clock(it)?.valid_until))),
        Column::new("lost_entered", Count(|it| lost(it, |it| it.entered))),
        Column::new("lost_started", Count(|it| lost(it, |it| it.started))),
        Column::new("lost_ended", Count(|it| lost(it, |it| it.ended))),
        Column::new("lost_skipped", Count(|it| lost(it, |it| it.skipped))),
        Column::new("lost_aborted", Count(|it| lost(it, |it| it.aborted))),
        Column::new("lost_safe", Count(|it| lost(it, |it| it.safe))),
        Column::new("lost_tables", Count(|it| lost(it, |it| it.tables))),
        Column::new("lost_time_jumped", Count(|it| lost(it, |it| it.time_jumped))),
        Column::new("lost", Count(|it| lost(it, Lost::total))),
        Column::new("scrub_byte", Count(|it| Some(scrub(it)?.at.into()))),
        Column::new("scrub_bytes", Count(|it| Some(scrub(it)?.length.into()))),
    ]
}

fn health(row: &Row) -> Option<TrackerHealth> {
    row.housekeeping()?.tracker
}

fn variance(row: &Row, index: usize) -> Option<f64> {
    health(row)?.covariance.variances.get(index).copied()
}

fn covariance(row: &Row, index: usize) -> Option<f64> {
    health(row)?.covariance.covariances.get(index).copied()
}

fn rate(row: &Row, index: usize) -> Option<f64> {
    health(row)?.rate_sigmas_rad_s.get(index).copied()
}

fn tracker() -> [Column<Row>; 11] {
    [
        Column::new("measured_utc", MaybeUtc(|it| Some(health(it)?.epoch))),
        Column::new("accepted", Count(|it| Some(health(it)?.accepted.into()))),
        Column::new("refused_in_a_row", Count(|it| Some(health(it)?.refused_in_a_row.into()))),
        Column::new("precession_variance_rad2", Number(|it| variance(it, 0))),
        Column::new("alpha_variance_rad2", Number(|it| variance(it, 1))),
        Column::new("spin_variance_rad2", Number(|it| variance(it, 2))),
        Column::new("precession_alpha_covariance_rad2", Number(|it| covariance(it, 0))),
        Column::new("precession_spin_covariance_rad2", Number(|it| covariance(it, 1))),
        Column::new("alpha_spin_covariance_rad2", Number(|it| covariance(it, 2))),
        Column::new("precession_rate_sigma_rad_s", Number(|it| rate(it, 0))),
        Column::new("spin_rate_sigma_rad_s", Number(|it| rate(it, 1))),
    ]
}

fn to_come(row: &Row) -> Option<VisitToCome> {
    row.housekeeping()?.visit
}

const fn ends(visit: &VisitToCome) -> &'static str {
    clipped(visit.entry_clipped, visit.exit_clipped)
}

fn visit() -> [Column<Row>; 9] {
    [
        Column::new("visit_target", Word(|it| to_come(it).map(|it| body_told(it.body).into()))),
        Column::new("visit_body", Whole(|it| Some(to_come(it)?.body.into()))),
        Column::new("visit_entry_utc", MaybeUtc(|it| Some(to_come(it)?.entry))),
        Column::new("visit_exit_utc", MaybeUtc(|it| Some(to_come(it)?.exit))),
        Column::new("visit_earliest_entry_utc", MaybeUtc(|it| Some(to_come(it)?.earliest_entry))),
        Column::new("visit_latest_exit_utc", MaybeUtc(|it| Some(to_come(it)?.latest_exit))),
        Column::new("visit_probability", Number(|it| Some(to_come(it)?.probability))),
        Column::new("visit_entry_sigma_s", Number(|it| Some(to_come(it)?.entry_sigma_s))),
        Column::new("visit_clipped", Word(|it| to_come(it).map(|it| ends(&it).into()))),
    ]
}
