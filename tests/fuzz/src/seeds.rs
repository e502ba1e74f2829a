//! The seed corpus: real tables and records, and streams of operations that get somewhere.

use crate::{sequencer as fly, slots as store};
use onboard_core::clock::ClockError;
use onboard_core::ephemeris::{BODY_BYTES, HEADER_BYTES, SPAN_BYTES, table_header};
use onboard_core::field_of_view::FieldShape;
use onboard_core::frame::{Boresight, Detector, Telescope};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sequencer::{
    AbortReason, Event, Lost, Progress, SafeReason, SkipReason, State, Tick,
};
use onboard_core::telemetry::{
    ClockInUse, EventReport, Housekeeping, Origin, TablesInUse, TrackerHealth, VisitToCome,
};
use onboard_core::time::Instant;
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::uplink::{
    AvoidanceRecord, Counts, DetectorRecord, Header, MissionTable, RollbackOrder, ScrubProgress,
    SectionKind, SunRecord, TelescopeRecord,
};
use tests::campaign::{BODY, CLOCK, DAY, SECOND, ephemeris, sessions, sun, telescope, uplink};
use tests::uplink::{container, plan};
use tests::{Plain, table, turn_rate};

/// A file of the corpus.
#[derive(Debug)]
pub struct Seed {
    /// The target.
    pub target: &'static str,
    /// The file's name.
    pub name: &'static str,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// A year's Sun and two more bodies, in granules of eight coefficients.
fn moving() -> Vec<u8> {
    let granule = |turn: f64, rate: f64| {
        // cos(w + a x) and sin(w + a x) by the first terms of their series.
        let (sin, cos) = turn.sin_cos();
        vec![[cos, sin, 0.0], [-rate * sin, rate * cos, 1e-4], [0.0, 1e-6, -1e-6]]
    };
    let orbit = |rate: f64| (0..4).map(|it| granule(2.0 * rate * f64::from(it), rate)).collect();
    let one = |body, rate: f64| -> Vec<u8> {
        let granules: Vec<Vec<[f64; 3]>> = orbit(rate);
        table(body, -DAY, 10 * 86_400_000_000_000, &granules)
    };
    let tables = [one(4, 0.02), one(5, 0.01), one(10, 0.086)];
    let (body, span) = (HEADER_BYTES, HEADER_BYTES + BODY_BYTES);
    let data = span + SPAN_BYTES;
    let numbers = u32::try_from((tables[0].len() - data) / 8).expect("few numbers");
    let mut bytes = table_header(3, 3, 3 * numbers).to_vec();
    for (index, one) in (0_u32..).zip(&tables) {
        let mut record = one[body..span].to_vec();
        record[8..12].copy_from_slice(&index.to_le_bytes());
        bytes.extend(record);
    }
    for (index, one) in (0_u32..).zip(&tables) {
        let mut record = one[span..data].to_vec();
        record[12..16].copy_from_slice(&(index * numbers).to_le_bytes());
        bytes.extend(record);
    }
    for one in &tables {
        bytes.extend(&one[data..]);
    }
    bytes
}

/// A mission with everything in it: plates, both shapes, listed detectors, avoidance limits.
fn full_mission(sun: SunRecord) -> Vec<u8> {
    let counts = Counts { telescopes: 2, detectors: 3, avoidance: 2 };
    let plain = Plain { signs: (-1, 1), ..Plain::PICO };
    let scan = plain.strategy();
    let mut bytes = MissionTable::fixed_to_le_bytes(scan.parameters(), sun, counts, 0.01).to_vec();
    let plate = Rotor { rate: turn_rate(1_304_347_826, 1), start: Phase::from_radians(0.5) };
    let rectangle = TelescopeRecord {
        rotation: Rotation::<Telescope, Boresight>::about_y(0.1),
        hwp: Some(plate),
        field: FieldShape::Rectangle { width_rad: 0.3, height_rad: 0.15 },
    };
    bytes.extend(telescope().to_le_bytes());
    bytes.extend(rectangle.to_le_bytes());
    for (telescope, angle) in [(0, 0.01), (0, -0.02), (1, 0.03)] {
        let rotation = Rotation::<Detector, Boresight>::about_x(angle);
        bytes.extend(DetectorRecord { rotation, telescope }.to_le_bytes());
    }
    for (body, angle_rad) in [(BODY, 0.2), (10, 1.0)] {
        bytes.extend(AvoidanceRecord { body, angle_rad }.to_le_bytes());
    }
    bytes
}

fn full_container() -> Vec<u8> {
    let header = Header {
        sequence: 9,
        valid_from: Instant::from_tai_ns(0),
        valid_until: Instant::from_tai_ns(21 * DAY),
        mission_digest: *b"first sixteen by",
        spacecraft: 1,
    };
    let mut planned = sessions(2);
    for session in &mut planned {
        session.telescope = 1;
    }
    container(
        &header,
        &[
            (SectionKind::Ephemeris, &moving()),
            (SectionKind::Mission, &full_mission(SunRecord::Table)),
            (SectionKind::Plan, &plan(&planned)),
        ],
    )
}

fn records() -> Vec<u8> {
    let mut bytes = CLOCK.to_le_bytes().to_vec();
    for ticks in [0_u64, 1000, 1_000_000_000, u64::MAX / 3, 1 << 63] {
        bytes.extend(ticks.to_le_bytes());
    }
    bytes
}

fn order() -> Vec<u8> {
    let until = Instant::from_tai_ns(20 * DAY);
    RollbackOrder { from: 9, to: 8, to_digest: 0x0123_4567_89ab_cdef, until }
        .to_le_bytes()
        .repeat(2)
}

/// Up, up, back, and up again; the same with damage, cuts and wrong orders between; uploads over a
/// revoked container, cut short.
fn slot_streams() -> [Vec<u8>; 3] {
    let up = |sequence| [store::UPLINK, sequence];
    let plain = [
        &up(1)[..],
        &up(2),
        &[store::ROLL_BACK],
        &up(2),
        &up(3),
        &[store::EXCHANGE],
        &up(4),
        &[store::OTHER_ORDER, 4, 3, 99],
        &up(200),
    ];
    let rough = [
        &up(4)[..],
        &[store::CUT_UPLINK, 5, 9, 0],
        &[store::MIXED_UPLINK, 6, 120, 0],
        &[store::DAMAGED_UPLINK, 6, 70, 1, 8],
        &up(5),
        &[store::TIME, 200],
        &up(7),
        &[store::TIME, 10],
        &[store::DAMAGE, 1, 100, 0, 77],
        &[store::ROLL_BACK],
        &up(6),
        &[store::OTHER_ORDER, 6, 4, 99],
    ];
    let over_revoked = [
        &up(1)[..],
        &up(2),
        &[store::ROLL_BACK],
        &[store::CUT_UPLINK, 4, 1, 0],
        &[store::CUT_UPLINK, 4, 5, 0],
        &up(4),
    ];
    [plain.concat(), rough.concat(), over_revoked.concat()]
}

/// A session carried out; the clock, the tables and the orders changed in the middle of one; other
/// tables, strategies and clocks.
fn flights() -> [Vec<u8>; 3] {
    // An hour ahead of a session, then up to its start and on in steps of 10 s.
    let to = |session| [fly::NEAR, session, 0, 0, fly::RUN, 255, fly::RUN, 110];
    let jump = (-30 * SECOND).to_le_bytes();
    let carried_out = [&to(0)[..], &[fly::RUN, 255], &[fly::POP, 7]];
    let disturbed = [
        &to(1)[..],
        &[fly::RUN, 70, fly::STEP, 0xf8, 0xff, fly::LATER, 7],
        &[fly::NO_CLOCK, fly::LATER, 1, fly::CLOCK_BACK, fly::LATER, 1, fly::RESUME],
        &[fly::LATER, 1, fly::NO_TABLES, fly::LATER, 2, fly::TABLES, 1, fly::RESUME],
        &[fly::LATER, 1, fly::RESUME, fly::NO_CLOCK, fly::LATER, 1, fly::CLOCK_BACK, fly::LATER, 1],
        &[fly::RESUME, fly::LATER, 3, fly::JUMP],
        &jump,
        &[fly::RESUME, fly::STOP, fly::LATER, 1, fly::RESUME, fly::LATER, 1],
        &[fly::NEAR, 2, 1, 3, fly::RUN, 9],
    ];
    let clock = [&1000_u64.to_le_bytes()[..], &DAY.to_le_bytes(), &(1_u128 << 74).to_le_bytes()];
    let others = [
        &[fly::TABLES, 2][..],
        &to(0),
        &[fly::TABLES, 3, fly::STRATEGY, 100, 0, fly::NEAR, 1, 1, 250, fly::RUN, 20],
        &[fly::TABLES, 4, fly::LATER, 9, fly::OTHER_CLOCK],
        &clock.concat(),
        &[fly::LATER, 9, fly::RESUME, fly::LATER, 9, fly::COUNTER],
        &77_u64.to_le_bytes(),
        &[fly::STRATEGY, 0, 0, fly::POP, 3],
    ];
    [carried_out.concat(), disturbed.concat(), others.concat()]
}

const EXPIRED: SafeReason = SafeReason::Clock(ClockError::Expired(Instant::from_tai_ns(-DAY)));
const JUMPED: Event =
    Event::TimeJumped { from: Instant::from_tai_ns(0), to: Instant::from_tai_ns(DAY) };

fn event(event: Event) -> Vec<u8> {
    let origin = Origin::new(1, 0, 2000, Some(&CLOCK));
    EventReport { origin, event }.to_be_bytes().to_vec()
}

/// With all that there can be, or of a sequencer that has just begun.
fn housekeeping(all: bool) -> Vec<u8> {
    let at = Instant::from_tai_ns(DAY);
    let covariance = ScanCovariance { variances: [1e-10; 3], covariances: [-1e-11; 3] };
    let state = if all { State::Cooldown(3) } else { State::Safe(SafeReason::Boot) };
    let report = Housekeeping {
        origin: Origin::new(1, 0, 2000, all.then_some(&CLOCK)),
        tick: Tick { state, evaluations: 104, check: Progress::UnderWay },
        tables: all.then_some(TablesInUse { sequence: 9, set_digest: 7, valid_until: at }),
        tables_damaged: all,
        clock: all.then_some(ClockInUse::of(&CLOCK)),
        lost: Lost { skipped: 2, ..Lost::NONE },
        tracker: all.then_some(TrackerHealth {
            epoch: at,
            accepted: 40,
            refused_in_a_row: 1,
            covariance,
            rate_sigmas_rad_s: [1e-12; 2],
        }),
        scrub: all.then_some(ScrubProgress { at: 512, length: 16_384 }),
        visit: all.then_some(VisitToCome {
            body: BODY,
            entry: at,
            exit: at,
            entry_clipped: true,
            exit_clipped: true,
            earliest_entry: at,
            latest_exit: at,
            probability: 0.75,
            entry_sigma_s: 0.5,
        }),
    };
    report.to_be_bytes().to_vec()
}

/// Every seed.
#[must_use]
pub fn seeds() -> Vec<Seed> {
    let seed = |target, name, bytes| Seed { target, name, bytes };
    let [up_and_back, rough, over_revoked] = slot_streams();
    let [carried_out, disturbed, others] = flights();
    let circular = full_mission(SunRecord::Circular(sun()));
    vec![
        seed("container", "campaign", uplink(1, &sessions(2))),
        seed("container", "everything", full_container()),
        seed("container", "no_sections", container_without_sections()),
        seed("ephemeris", "one_body", ephemeris()),
        seed("ephemeris", "three_bodies", moving()),
        seed("mission", "table_sun", full_mission(SunRecord::Table)),
        seed("mission", "circular_sun", circular),
        seed("plan", "two_days", plan(&sessions(2))),
        seed("plan", "empty", plan(&[])),
        seed("records", "clock", records()),
        seed("records", "order", order()),
        seed("slots", "up_and_back", up_and_back),
        seed("slots", "rough", rough),
        seed("slots", "over_revoked", over_revoked),
        seed("sequencer", "carried_out", carried_out),
        seed("sequencer", "disturbed", disturbed),
        seed("sequencer", "others", others),
        seed("telemetry", "started", event(Event::Started(4, sessions(1)[0]))),
        seed("telemetry", "safe", event(Event::Entered(State::Safe(EXPIRED)))),
        seed("telemetry", "skipped", event(Event::Skipped(4, SkipReason::Passes(3)))),
        seed("telemetry", "aborted", event(Event::Aborted(4, AbortReason::Avoidance(BODY)))),
        seed("telemetry", "jumped", event(JUMPED)),
        seed("telemetry", "housekeeping", housekeeping(true)),
        seed("telemetry", "boot", housekeeping(false)),
    ]
}

fn container_without_sections() -> Vec<u8> {
    let at = Instant::from_tai_ns(0);
    let header = Header {
        sequence: 1,
        valid_from: at,
        valid_until: at,
        mission_digest: [0; 16],
        spacecraft: 1,
    };
    container(&header, &[])
}
