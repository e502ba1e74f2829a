//! A small campaign for the tests of the sequencer's rules: `LiteBIRD`'s strategy, the circular Sun,
//! fixed bodies, one telescope, and the sessions that the transit finder predicts.

extern crate std;

use super::{
    Event, EventQueue, MAX_EVALUATIONS_PER_TICK, ScanEstimate, Sequencer, Settings, Situation,
    SkipReason, State, Tick,
};
use crate::attitude::attitude;
use crate::clock::ClockCorrelation;
use crate::direction::{Direction, MotionBounds};
use crate::ephemeris::{BodyRecord, EphemerisTable, Span, table_header};
use crate::field_of_view::{FieldOfView, FieldShape};
use crate::frame::{Boresight, Detector, Ecliptic, Telescope};
use crate::phase::{Phase, Rotor, TurnRate};
use crate::rotation::Rotation;
use crate::scan::{ScanParameters, ScanStrategy};
use crate::sun::SunModel;
use crate::time::{Duration, Instant};
use crate::transit::{Channel, Step, TransitFinder};
use crate::uplink::{
    AvoidanceRecord, Counts, DetectorRecord, ENTRY_BYTES, HEADER_BYTES, Header, MissionTable,
    SectionKind, SessionRecord, SetDigest, SunRecord, Tables, TelescopeRecord, checksum,
    entry_to_le_bytes,
};
use core::num::NonZeroU64;
use std::vec;
use std::vec::Vec;

pub(super) const SECOND: i64 = 1_000_000_000;
pub(super) const DAY: i64 = 86_400 * SECOND;
/// The target.
pub(super) const BODY: i32 = 5;
pub(super) const RADIUS_RAD: f64 = 0.1;
/// The second detector's tilt about x, away from all targets of the sessions chosen.
pub(super) const TILT_RAD: f64 = 0.9;
const TARGET: [f64; 3] = [0.2, 0.9, 0.05];
const VALID_DAYS: i64 = 4;

/// Counter and nanoseconds agree.
pub(super) const CLOCK: ClockCorrelation = ClockCorrelation {
    spacecraft: 1,
    sequence: 1,
    uncertainty_ns: 0,
    ticks: 0,
    at: Instant::from_tai_ns(0),
    tick_bits: ClockCorrelation::tick_of(1, 0),
    valid_from: Instant::from_tai_ns(-DAY),
    valid_until: Instant::from_tai_ns(30 * DAY),
};

pub(super) const SETTINGS: Settings = Settings {
    telescope: 0,
    tolerance: Duration::from_ns(SECOND),
    passes_tolerance: 0,
    longest_gap: Duration::from_ns(20 * SECOND),
    check_ahead: Duration::from_ns(3600 * SECOND),
    recheck_rad: 1e-3,
    steps_per_tick: 8,
};

/// What the mission has beside its telescope.
#[derive(Debug, Clone, Default)]
pub(super) struct Board {
    /// Bodies that stand still, by number, from 6 on.
    pub(super) bodies: Vec<Direction<Ecliptic>>,
    /// Index of the body, and the angle.
    pub(super) limits: Vec<(usize, f64)>,
    /// Whether two detectors are listed, along the telescope and tilted.
    pub(super) detectors: bool,
    /// Whether the telescope's field is a rectangle inside the circle.
    pub(super) rectangle: bool,
}

pub(super) fn strategy() -> ScanStrategy {
    let turn = |period: u128| TurnRate::from_bits(u128::MAX / period);
    let rotor = |rate, start| Rotor { rate, start: Phase::from_radians(start) };
    ScanStrategy::new(ScanParameters {
        start: Instant::from_tai_ns(0),
        alpha_rad: 45.0_f64.to_radians(),
        beta_rad: 50.0_f64.to_radians(),
        precession: rotor(turn(11_540_880_000_000), 0.0),
        spin: rotor(turn(1_200_000_000_000), core::f64::consts::PI),
    })
    .unwrap()
}

/// The strategy with its spin phase off.
pub(super) fn turned(by_rad: f64) -> ScanStrategy {
    let mut parameters = *strategy().parameters();
    parameters.spin.start = parameters.spin.start.plus(Phase::from_radians(by_rad));
    ScanStrategy::new(parameters).unwrap()
}

fn sun() -> Rotor {
    let rate = TurnRate::from_bits(u128::MAX / 31_557_600_000_000_000);
    Rotor { rate, start: Phase::from_radians(0.3) }
}

fn table(bodies: &[(i32, [f64; 3])]) -> Vec<u8> {
    let count = u32::try_from(bodies.len()).unwrap();
    let bounds = MotionBounds { rate_rad_s: 0.0, acceleration_per_s2: 0.0, max_abs_z: 1.0 };
    let mut bytes = table_header(count, count, 3 * count).to_vec();
    for (first, &(body, _)) in (0..count).zip(bodies) {
        bytes.extend(BodyRecord { body, spans: 1, first, bounds }.to_le_bytes());
    }
    for (place, &(body, _)) in (0..count).zip(bodies) {
        let span = Span {
            body,
            coefficients: 1,
            granules: 1,
            first: 3 * place,
            start: Instant::from_tai_ns(-DAY),
            granule_ns: NonZeroU64::new(41 * 86_400_000_000_000).unwrap(),
            bounds,
        };
        bytes.extend(span.to_le_bytes());
    }
    for number in bodies.iter().flat_map(|it| it.1) {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

impl Board {
    pub(super) fn number(index: usize) -> i32 {
        6 + i32::try_from(index).unwrap()
    }

    fn ephemeris(&self) -> Vec<u8> {
        let fixed = self.bodies.iter().enumerate().map(|(it, at)| (Self::number(it), at.xyz()));
        table(&[vec![(BODY, TARGET)], fixed.collect()].concat())
    }

    fn mission(&self) -> Vec<u8> {
        let rotation = Rotation::<Telescope, Boresight>::IDENTITY;
        let field = if self.rectangle {
            FieldShape::Rectangle { width_rad: 1.5 * RADIUS_RAD, height_rad: 1.2 * RADIUS_RAD }
        } else {
            FieldShape::Circle(RADIUS_RAD)
        };
        let telescope = TelescopeRecord { rotation, hwp: None, field };
        let counts = Counts {
            telescopes: 1,
            detectors: if self.detectors { 2 } else { 0 },
            avoidance: u16::try_from(self.limits.len()).unwrap(),
        };
        let scan = strategy();
        let mut bytes = MissionTable::fixed_to_le_bytes(
            scan.parameters(),
            SunRecord::Circular(sun()),
            counts,
            RADIUS_RAD,
        )
        .to_vec();
        bytes.extend(telescope.to_le_bytes());
        if self.detectors {
            for tilt in [0.0, TILT_RAD] {
                let rotation = Rotation::<Detector, Boresight>::about_x(tilt);
                bytes.extend(DetectorRecord { rotation, telescope: 0 }.to_le_bytes());
            }
        }
        for &(body, angle_rad) in &self.limits {
            bytes.extend(AvoidanceRecord { body: Self::number(body), angle_rad }.to_le_bytes());
        }
        bytes
    }

    /// The container with these sessions.
    pub(super) fn uplink(&self, sequence: u32, sessions: &[SessionRecord]) -> Vec<u8> {
        let validity = (Instant::from_tai_ns(0), Instant::from_tai_ns(VALID_DAYS * DAY));
        self.uplink_valid(sequence, sessions, validity)
    }

    pub(super) fn uplink_valid(
        &self,
        sequence: u32,
        sessions: &[SessionRecord],
        (valid_from, valid_until): (Instant, Instant),
    ) -> Vec<u8> {
        let count = u32::try_from(sessions.len()).unwrap();
        let mut plan = [count.to_le_bytes(), [0; 4]].concat();
        for it in sessions {
            plan.extend(it.to_le_bytes());
        }
        let sections = [
            (SectionKind::Ephemeris, self.ephemeris()),
            (SectionKind::Mission, self.mission()),
            (SectionKind::Plan, plan),
        ];
        let mut digest = SetDigest::new();
        for it in &sections {
            digest.update(&it.1);
        }
        let carried = digest.value().to_le_bytes();
        let (mut directory, mut contents) = (Vec::new(), Vec::new());
        let first = HEADER_BYTES + ENTRY_BYTES * sections.len();
        let short = |length: usize| u32::try_from(length).unwrap();
        for (kind, bytes) in &sections {
            let section = [&carried[..], bytes].concat();
            let offset = short(first + contents.len());
            let entry = entry_to_le_bytes(*kind, offset, short(section.len()), checksum(&section));
            directory.extend(entry);
            contents.extend(section);
        }
        let (mission_digest, spacecraft) = ([0; 16], 1);
        let header = Header { sequence, valid_from, valid_until, mission_digest, spacecraft };
        let length = short(first + contents.len());
        let head = header.to_le_bytes(length, 3, checksum(&directory));
        [&head[..], &directory, &contents].concat()
    }
}

/// A session about each pass that stands alone: 600 s of setup, 300 s of cooldown.
pub(super) fn sessions() -> Vec<SessionRecord> {
    let bytes = table(&[(BODY, TARGET)]);
    let target = EphemerisTable::parse(&bytes).unwrap().body(BODY).unwrap();
    let rotation = Rotation::<Telescope, Boresight>::IDENTITY;
    let field = FieldOfView::circle(rotation, RADIUS_RAD).unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(VALID_DAYS * DAY));
    let mut channels = [Channel::new(&strategy(), SunModel::Circular(sun()), target, &field, span)];
    let mut finder = TransitFinder::new(&mut channels);
    let mut found = Vec::new();
    loop {
        match finder.step() {
            Step::Transit(transit) => found.push(transit),
            Step::Searched(_) => {}
            Step::Done => break,
            Step::Failed { error, .. } => panic!("{error:?}"),
        }
    }
    let apart = |index: usize| {
        let own = &found[index];
        let before = index.checked_sub(1).map(|it| own.entry.since(found[it].exit));
        let after = found.get(index + 1).map(|it| it.entry.since(own.exit));
        [before, after].into_iter().flatten().all(|it| it.ns() > 950 * SECOND)
    };
    let session = |index: usize| {
        let own = &found[index];
        SessionRecord {
            start: own.entry.plus(Duration::from_ns(-600 * SECOND)),
            end: own.exit.plus(Duration::from_ns(300 * SECOND)),
            first_entry: own.entry,
            last_exit: own.exit,
            body: BODY,
            turn: 0,
            telescope: 0,
            passes: 1,
        }
    };
    let all = (0..found.len()).filter(|it| apart(*it)).map(session);
    let mut sessions: Vec<SessionRecord> =
        all.filter(|it| it.start.tai_ns() > 2 * 3600 * SECOND).collect();
    // None begins before the one before it is over.
    sessions.dedup_by(|later, earlier| later.start < earlier.end);
    sessions
}

/// Least angles in radians between a fixed direction and the field along the telescope, tilted, in
/// setup, between first entry and last exit, and in cooldown.
pub(super) fn least_angles_rad(
    session: &SessionRecord,
    direction: Direction<Ecliptic>,
    tilt_rad: f64,
) -> [f64; 3] {
    let tilt = Rotation::<Detector, Boresight>::about_x(tilt_rad);
    let field = FieldOfView::circle(tilt, RADIUS_RAD).unwrap();
    let scan = strategy();
    let least = |from: Instant, until: Instant| {
        let seconds = until.since(from).ns() / SECOND;
        let angle = |second: i64| {
            let at = from.plus(Duration::from_ns(second * SECOND));
            let look = attitude(&scan, &SunModel::Circular(sun()), at).unwrap();
            field.angle_to_rad(look.inverse().apply(direction))
        };
        (0..=seconds).map(angle).fold(f64::INFINITY, f64::min)
    };
    [
        least(session.start, session.first_entry),
        least(session.first_entry, session.last_exit),
        least(session.last_exit, session.end),
    ]
}

/// Directions beside the track of the field of this tilt, every 10 s of the session.
pub(super) fn beside_track(session: &SessionRecord, tilt_rad: f64) -> Vec<Direction<Ecliptic>> {
    let tilt = Rotation::<Detector, Boresight>::about_x(tilt_rad);
    let scan = strategy();
    let seconds = session.end.since(session.start).ns() / SECOND;
    let at = |tenth: i64| {
        let at = later(session.start, 10 * tenth);
        let look = attitude(&scan, &SunModel::Circular(sun()), at).unwrap();
        [-0.25_f64, -0.15, 0.15, 0.25].map(|off: f64| {
            let beside = Direction::<Detector>::new(off.sin(), 0.0, off.cos()).unwrap();
            look.apply(tilt.apply(beside))
        })
    };
    (0..=seconds / 10).flat_map(at).collect()
}

/// Directions all over the sky.
pub(super) fn all_over() -> Vec<Direction<Ecliptic>> {
    let longitudes = (0..36_u8).map(|it| f64::from(it) * 10.0_f64.to_radians());
    let all = longitudes.flat_map(|longitude| {
        (-8..9_i8).map(move |latitude| {
            let latitude = f64::from(latitude) * 10.0_f64.to_radians();
            Direction::from_longitude_latitude(longitude, latitude)
        })
    });
    all.collect()
}

/// A sequencer in flight.
pub(super) struct Flight<'a> {
    pub(super) sequencer: Sequencer,
    pub(super) events: EventQueue<64>,
    pub(super) tables: Option<Tables<'a>>,
    pub(super) damaged: bool,
    pub(super) clock: Option<ClockCorrelation>,
    pub(super) scan: ScanEstimate<'a>,
    pub(super) log: Vec<Event>,
}

impl<'a> Flight<'a> {
    /// Resumed, with a clock and tables.
    pub(super) fn new(uplink: &'a [u8]) -> Self {
        Self::with(SETTINGS, uplink)
    }

    pub(super) fn with(settings: Settings, uplink: &'a [u8]) -> Self {
        let mut sequencer = Sequencer::new(settings).unwrap();
        sequencer.resume();
        Self {
            sequencer,
            events: EventQueue::new(),
            tables: Some(Tables::load(uplink).unwrap()),
            damaged: false,
            clock: Some(CLOCK),
            scan: ScanEstimate::Mission,
            log: Vec::new(),
        }
    }

    pub(super) fn told(&mut self, ns: i64) -> Tick {
        let situation = Situation {
            ticks: ns.cast_unsigned(),
            clock: self.clock.as_ref(),
            tables: self.tables.as_ref(),
            tables_damaged: self.damaged,
            scan: self.scan,
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        assert!(tick.evaluations <= MAX_EVALUATIONS_PER_TICK, "{}", tick.evaluations);
        assert_eq!(tick.state, self.sequencer.state());
        while let Some(stamped) = self.events.pop() {
            self.log.push(stamped.event);
        }
        tick
    }

    pub(super) fn tick(&mut self, at: Instant) -> State {
        self.told(at.tai_ns()).state
    }

    /// Ticks of 10 s from one instant until before another.
    pub(super) fn run(&mut self, from: Instant, until: Instant) {
        let mut at = from;
        while at < until {
            self.tick(at);
            at = at.plus(Duration::from_ns(10 * SECOND));
        }
    }

    pub(super) fn started(&self) -> usize {
        self.log.iter().filter(|it| matches!(it, Event::Started(..))).count()
    }

    pub(super) fn skips(&self) -> Vec<SkipReason> {
        let reason = |event: &Event| match event {
            Event::Skipped(_, reason) => Some(*reason),
            _ => None,
        };
        self.log.iter().filter_map(reason).collect()
    }

    pub(super) fn aborts(&self) -> Vec<super::AbortReason> {
        let reason = |event: &Event| match event {
            Event::Aborted(_, reason) => Some(*reason),
            _ => None,
        };
        self.log.iter().filter_map(reason).collect()
    }
}

pub(super) fn later(at: Instant, seconds: i64) -> Instant {
    at.plus(Duration::from_ns(seconds * SECOND))
}
