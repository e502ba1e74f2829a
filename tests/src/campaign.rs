//! A small campaign: LiteBIRD's strategy, the circular Sun, one slow target, one wide telescope, and
//! a plan made of the transits that the finder predicts.

use crate::uplink::{container, mission, plan};
use crate::{Plain, table, transits, turn_rate};
use onboard_core::clock::ClockCorrelation;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::field_of_view::{FieldOfView, FieldShape};
use onboard_core::frame::{Boresight, Telescope};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sequencer::Settings;
use onboard_core::sun::SunModel;
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, Transit};
use onboard_core::uplink::{Header, SectionKind, SessionRecord, TelescopeRecord};
use std::collections::BTreeMap;

/// A second in ns.
pub const SECOND: i64 = 1_000_000_000;
/// A day in ns.
pub const DAY: i64 = 86_400 * SECOND;
/// The target's body number.
pub const BODY: i32 = 5;
const RADIUS_RAD: f64 = 0.1;

/// The circular Sun.
#[must_use]
pub fn sun() -> Rotor {
    Rotor { rate: turn_rate(31_557_600_000_000_000, 1), start: Phase::from_radians(0.3) }
}

/// The telescope.
#[must_use]
pub fn telescope() -> TelescopeRecord {
    let rotation = Rotation::<Telescope, Boresight>::IDENTITY;
    TelescopeRecord { rotation, hwp: None, field: FieldShape::Circle(RADIUS_RAD) }
}

/// A target that moves a little, for 40 days.
#[must_use]
pub fn ephemeris() -> Vec<u8> {
    table(BODY, -DAY, 41 * 86_400_000_000_000, &[vec![[0.2, 0.9, 0.05], [0.004, 0.0, 0.002]]])
}

/// One session per precession turn with passes, over so many days, 600 s of setup and 300 s of
/// cooldown.
///
/// # Panics
/// When the campaign is not what this module says.
#[must_use]
pub fn sessions(days: i64) -> Vec<SessionRecord> {
    let bytes = ephemeris();
    let target = EphemerisTable::parse(&bytes).and_then(|it| it.body(BODY)).expect("a target");
    let scan = Plain::LITEBIRD.strategy();
    let field = FieldOfView::new(telescope().rotation, telescope().field).expect("a field of view");
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(days * DAY));
    let found =
        transits(&mut [Channel::new(&scan, SunModel::Circular(sun()), target, &field, span)]);
    let mut turns: BTreeMap<u64, Vec<Transit>> = BTreeMap::new();
    for transit in found.iter().filter(|it| !it.entry_clipped && !it.exit_clipped) {
        turns.entry(scan.turns(transit.closest).0).or_default().push(*transit);
    }
    let session = |(turn, passes): (&u64, &Vec<Transit>)| {
        let first_entry = passes.iter().map(|it| it.entry).min().expect("a pass");
        let last_exit = passes.iter().map(|it| it.exit).max().expect("a pass");
        SessionRecord {
            start: first_entry.plus(Duration::from_ns(-600 * SECOND)),
            end: last_exit.plus(Duration::from_ns(300 * SECOND)),
            first_entry,
            last_exit,
            body: BODY,
            turn: u32::try_from(*turn).expect("few turns"),
            telescope: 0,
            passes: u16::try_from(passes.len()).expect("few passes"),
        }
    };
    turns.iter().map(session).filter(|it| it.start >= Instant::from_tai_ns(0)).collect()
}

/// The campaign's container with these sessions, valid for 21 days.
#[must_use]
pub fn uplink(sequence: u32, sessions: &[SessionRecord]) -> Vec<u8> {
    let header = Header {
        sequence,
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(21 * DAY),
        mission_digest: [0; 16],
        spacecraft: 1,
    };
    container(
        &header,
        &[
            (SectionKind::Ephemeris, &ephemeris()),
            (SectionKind::Mission, &mission(&Plain::LITEBIRD, sun(), &[telescope()])),
            (SectionKind::Plan, &plan(sessions)),
        ],
    )
}

/// A tick of one microsecond, counted from 1000 at the mission's start.
pub const CLOCK: ClockCorrelation = ClockCorrelation {
    sequence: 1,
    spacecraft: 1,
    uncertainty_ns: 0,
    ticks: 1000,
    at: Instant::from_tai_ns(0),
    tick_bits: ClockCorrelation::tick_of(1000, 0),
    valid_from: Instant::from_tai_ns(0),
    valid_until: Instant::from_tai_ns(30 * DAY),
};

/// Sessions are checked an hour ahead; ticks come at least every 20 s.
pub const SETTINGS: Settings = Settings {
    telescope: 0,
    tolerance: Duration::from_ns(SECOND),
    passes_tolerance: 0,
    longest_gap: Duration::from_ns(20 * SECOND),
    check_ahead: Duration::from_ns(3600 * SECOND),
    recheck_rad: 1e-3,
    steps_per_tick: 8,
};

/// The counter at `ns` of TAI by [`CLOCK`].
#[must_use]
pub const fn ticks_at(ns: i64) -> u64 {
    (ns / 1000 + 1000).cast_unsigned()
}
