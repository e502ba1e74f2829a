//! Flights of the sequencer: what `plan` uplinks, undisturbed for its whole validity, then disturbed.

use crate::input::{Input, NS_PER_DAY, sized};
use clap::Parser;
use ground_tools::cli::Cli;
use onboard_core::clock::ClockCorrelation;
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{Container, Header, SectionKind, SessionRecord, Tables};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use tests::uplink::{container, plan};

const SECOND: i64 = 1_000_000_000;
/// Time between ticks.
const STEP_S: i64 = 60;
const HOUR_S: i64 = 3600;
/// A tick of the on-board counter is 1 us and a quarter.
const TICK_NS: f64 = 1250.0;

/// The uplink of 20 days of `LiteBIRD` as `plan` writes it.
pub fn uplink() -> &'static [u8] {
    static UPLINK: OnceLock<Vec<u8>> = OnceLock::new();
    UPLINK.get_or_init(|| {
        let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cortex-m/plan");
        let out = out.to_str().expect("a path of letters");
        let arguments =
            ["gyrfalcon", "plan", "--quiet", "--force", "--duration", "20d", "--out", out];
        ground_tools::verb::run(&Cli::parse_from(arguments)).expect("a plan");
        std::fs::read(Path::new(out).join("uplink.tbl")).expect("the plan's uplink")
    })
}

/// The uplink's tables with other sessions, under another sequence number.
fn replanned(sequence: u32, sessions: &[SessionRecord]) -> Vec<u8> {
    let own = Container::parse(uplink()).expect("a good container");
    let section = |kind| own.section(kind).expect("the section is there");
    let contents: [(SectionKind, &[u8]); 3] = [
        (SectionKind::Ephemeris, section(SectionKind::Ephemeris)),
        (SectionKind::Mission, section(SectionKind::Mission)),
        (SectionKind::Plan, &plan(sessions)),
    ];
    container(&Header { sequence, ..own.header() }, &contents)
}

/// The telescope with most sessions, and its sessions.
fn busiest(tables: &Tables<'_>) -> (u16, Vec<SessionRecord>) {
    let mut by_telescope: BTreeMap<u16, Vec<SessionRecord>> = BTreeMap::new();
    for session in tables.plan().sessions() {
        by_telescope.entry(session.telescope).or_default().push(session);
    }
    by_telescope.into_iter().max_by_key(|(_, sessions)| sessions.len()).expect("a session")
}

fn clock(tables: &Tables<'_>) -> ClockCorrelation {
    ClockCorrelation {
        sequence: 1,
        spacecraft: tables.header().spacecraft,
        uncertainty_ns: 0,
        ticks: u64::MAX - 1000,
        at: tables.header().valid_from,
        tick_bits: ClockCorrelation::tick_of(TICK_NS as u64, 0),
        valid_from: tables.header().valid_from,
        valid_until: tables.header().valid_until,
    }
}

/// The counter, wrapped once near the start, so many seconds after the validity's start.
fn counter(seconds: i64) -> u64 {
    let ticks = (seconds as f64 * (SECOND as f64 / TICK_NS)) as i64;
    (u64::MAX - 1000).wrapping_add_signed(ticks)
}

fn settings(telescope: u16, tolerance_ns: i64) -> Vec<u8> {
    [
        &u32::from(telescope).to_le_bytes()[..],
        &tolerance_ns.to_le_bytes(),
        &0_u32.to_le_bytes(),
        &(STEP_S * SECOND).to_le_bytes(),
        &(4 * HOUR_S * SECOND).to_le_bytes(),
        &1e-3_f64.to_le_bytes(),
        &8_u32.to_le_bytes(),
    ]
    .concat()
}

/// Orders, and where time stands.
#[derive(Debug, Default)]
struct Flight {
    orders: Vec<u8>,
    seconds: i64,
}

impl Flight {
    fn order(&mut self, kind: u32, operands: &[u8]) {
        self.orders.extend(kind.to_le_bytes());
        self.orders.extend(operands);
    }

    fn ticks(&mut self, step_s: i64, count: i64) {
        let count_bytes = u32::try_from(count).expect("few ticks").to_le_bytes();
        let step = counter(step_s).wrapping_sub(counter(0)).to_le_bytes();
        let first = counter(self.seconds).to_le_bytes();
        self.order(0, &[&first[..], &step, &count_bytes].concat());
        self.seconds += step_s * count;
    }

    fn until(&mut self, seconds: i64) {
        self.ticks(STEP_S, (seconds - self.seconds).max(0) / STEP_S);
    }

    fn clock(&mut self, index: u32) {
        self.order(1, &index.to_le_bytes());
    }

    fn tables(&mut self, index: u32) {
        self.order(2, &index.to_le_bytes());
    }

    fn stop(&mut self) {
        self.order(3, &[]);
    }

    fn resume(&mut self) {
        self.order(4, &[]);
    }

    fn damaged(&mut self, damaged: u32) {
        self.order(6, &damaged.to_le_bytes());
    }

    fn strategy(&mut self, alpha_rad: f64) {
        self.order(5, &alpha_rad.to_le_bytes());
    }
}

const NOTHING: u32 = 7;

/// Two flights on the busiest telescope.
pub fn blocks(input: &mut Input) {
    let tables = Tables::load(uplink()).expect("a good uplink");
    let start = tables.header().valid_from;
    let (telescope, sessions) = busiest(&tables);
    let own = clock(&tables);
    let days = tables.header().valid_until.since(start).ns() / NS_PER_DAY;

    let mut flight = Flight::default();
    flight.clock(0);
    flight.tables(0);
    flight.resume();
    flight.until(days * NS_PER_DAY / SECOND);
    let calm = [
        settings(telescope, 1_000_000),
        1_u32.to_le_bytes().to_vec(),
        own.to_le_bytes().to_vec(),
        1_u32.to_le_bytes().to_vec(),
        sized(uplink()),
        flight.orders,
    ];
    input.block(6, "a flight as planned", &calm.concat());

    let early = |session: &SessionRecord| SessionRecord {
        first_entry: session.first_entry.plus(Duration::from_ns(-5 * SECOND)),
        ..*session
    };
    let counted =
        |session: &SessionRecord| SessionRecord { passes: session.passes + 7, ..*session };
    let wrong: Vec<SessionRecord> = sessions
        .iter()
        .enumerate()
        .map(|(index, session)| if index % 2 == 0 { early(session) } else { counted(session) })
        .collect();
    let twice: Vec<SessionRecord> = sessions.iter().flat_map(|it| [*it, *it]).collect();
    let expired = ClockCorrelation {
        sequence: 2,
        valid_until: Instant::from_tai_ns(start.tai_ns() + SECOND),
        ..own
    };
    let drifting = ClockCorrelation {
        sequence: 3,
        tick_bits: ClockCorrelation::tick_of(TICK_NS as u64, 1 << 40),
        ..own
    };
    let disturbed = [
        settings(telescope, SECOND),
        3_u32.to_le_bytes().to_vec(),
        own.to_le_bytes().to_vec(),
        expired.to_le_bytes().to_vec(),
        drifting.to_le_bytes().to_vec(),
        3_u32.to_le_bytes().to_vec(),
        sized(uplink()),
        sized(&replanned(2, &wrong)),
        sized(&replanned(3, &twice)),
        disturbances(&sessions, start).orders,
    ];
    input.block(6, "a disturbed flight", &disturbed.concat());
}

/// Something befalls every session in turn.
fn disturbances(sessions: &[SessionRecord], start: Instant) -> Flight {
    let mut flight = Flight::default();
    flight.ticks(STEP_S, 2);
    flight.clock(0);
    flight.ticks(STEP_S, 2);
    flight.tables(0);
    flight.ticks(STEP_S, 2);
    flight.resume();
    let second = |at: Instant| at.since(start).ns() / SECOND;
    let ahead = sessions.iter().filter(|it| second(it.start) > 5 * HOUR_S).take(12);
    for (index, session) in ahead.enumerate() {
        // Days without sessions pass at once; the clock's jump is reported.
        // One session is jumped into and so missed.
        let arrival = if index == 11 { 600 } else { -4 * HOUR_S - 600 };
        flight.seconds = flight.seconds.max(second(session.start) + arrival);
        flight.until(i64::midpoint(second(session.first_entry), second(session.last_exit)));
        match index {
            0 => {
                flight.clock(NOTHING);
                flight.ticks(20, 3);
                flight.clock(0);
            }
            1 => {
                flight.tables(NOTHING);
                flight.ticks(20, 3);
                flight.tables(0);
            }
            2 => flight.stop(),
            3 => flight.seconds += 2 * HOUR_S,
            4 => flight.seconds -= 2 * HOUR_S,
            5 => flight.seconds -= 45,
            6 => flight.tables(1),
            7 => {
                flight.damaged(1);
                flight.ticks(20, 3);
                flight.damaged(0);
            }
            8 => flight.tables(2),
            9 => {
                flight.clock(1);
                flight.ticks(20, 3);
                flight.clock(2);
            }
            10 => flight.strategy(1e-3),
            11 => flight.strategy(0.0),
            _ => {}
        }
        flight.ticks(30, 3);
        flight.resume();
        flight.until(second(session.end) + 120);
    }
    flight.seconds = -HOUR_S;
    flight.ticks(STEP_S, 3);
    flight.seconds = 365 * 24 * HOUR_S;
    flight.ticks(STEP_S, 3);
    flight
}

/// What the ticks are counted on: the first ten days as planned.
pub fn metered() -> Vec<u8> {
    let tables = Tables::load(uplink()).expect("a good uplink");
    let (telescope, _) = busiest(&tables);
    let count = 10 * 24 * 60_u32;
    [
        settings(telescope, 1_000_000),
        clock(&tables).to_le_bytes().to_vec(),
        sized(uplink()),
        counter(0).to_le_bytes().to_vec(),
        counter(STEP_S).wrapping_sub(counter(0)).to_le_bytes().to_vec(),
        count.to_le_bytes().to_vec(),
    ]
    .concat()
}
