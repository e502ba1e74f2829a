//! A sequencer under any clock, tables and commands.
//!
//! The bytes are a stream of operations, one byte each and its operands. A second sequencer with a
//! queue that overflows runs beside it: it must do the same and lose only what it counts.

use crate::input::Input;
use onboard_core::clock::ClockCorrelation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sequencer::{
    Event, EventQueue, MAX_EVALUATIONS_PER_TICK, MAX_OTHER_EVENTS_PER_TICK, MAX_SESSIONS_PER_TICK,
    ScanEstimate, Sequencer, Situation, Stamped, State,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{SessionRecord, Tables};
use std::collections::VecDeque;
use std::sync::OnceLock;
use tests::campaign::{CLOCK, DAY, SECOND, SETTINGS, sessions, ticks_at, uplink};

/// Most ticks of one run.
const TICKS: u32 = 700;
const ROOM: usize = 4;

/// First byte of an operation: a tick up to 25 s later.
pub const LATER: u8 = 0;
/// So many ticks, 10 s apart.
pub const RUN: u8 = 1;
/// A tick some seconds earlier or later.
pub const STEP: u8 = 2;
/// A tick any time earlier or later.
pub const JUMP: u8 = 3;
/// A tick near a time of a session.
pub const NEAR: u8 = 4;
/// No clock correlation.
pub const NO_CLOCK: u8 = 5;
/// The clock correlation.
pub const CLOCK_BACK: u8 = 6;
/// Any other clock correlation.
pub const OTHER_CLOCK: u8 = 7;
/// No tables.
pub const NO_TABLES: u8 = 8;
/// One of the containers.
pub const TABLES: u8 = 9;
/// Safe by command.
pub const STOP: u8 = 10;
/// Back from safe.
pub const RESUME: u8 = 11;
/// A strategy corrected by measured attitudes.
pub const STRATEGY: u8 = 12;
/// Events taken out of the small queue.
pub const POP: u8 = 13;
/// A tick at any count of the counter.
pub const COUNTER: u8 = 14;
/// The tables' bytes are damaged, or not.
pub const DAMAGED: u8 = 15;
const KINDS: u8 = 16;

/// The container whose sessions all disagree with the prediction.
const WRONG: u32 = 3;

fn containers() -> &'static [Vec<u8>] {
    static CONTAINERS: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    CONTAINERS.get_or_init(|| {
        let all = sessions(3);
        assert!(all.len() >= 3, "{}", all.len());
        let early = |session: &SessionRecord| SessionRecord {
            first_entry: session.first_entry.plus(Duration::from_ns(-5 * SECOND)),
            ..*session
        };
        let wrong: Vec<SessionRecord> = all.iter().map(early).collect();
        let crowded: Vec<SessionRecord> =
            all.iter().flat_map(|session| std::iter::repeat_n(*session, 40)).collect();
        vec![
            uplink(1, &all),
            uplink(2, &all[1..]),
            uplink(WRONG, &wrong),
            uplink(4, &crowded),
            uplink(5, &[]),
        ]
    })
}

struct Flight<'a> {
    sequencer: Sequencer,
    events: EventQueue<64>,
    shadow: Sequencer,
    small: EventQueue<ROOM>,
    /// What the small queue should hold, and how much it should have lost.
    held: VecDeque<Stamped>,
    lost: u32,
    tables: Option<Tables<'a>>,
    damaged: bool,
    clock: Option<ClockCorrelation>,
    strategy: Option<ScanStrategy>,
    strategy_changed: bool,
    /// Whether safe may be left: resumed since it was entered.
    resumed: bool,
    under_way: Option<u32>,
    ns: i64,
    left: u32,
}

impl Flight<'_> {
    fn tick_to(&mut self, ns: i64) {
        self.ns = ns.clamp(-DAY, 25 * DAY);
        self.tick(ticks_at(self.ns));
    }

    fn tick(&mut self, ticks: u64) {
        self.left = self.left.saturating_sub(1);
        let before = self.sequencer.state();
        let situation = Situation {
            ticks,
            clock: self.clock.as_ref(),
            tables: self.tables.as_ref(),
            tables_damaged: self.damaged,
            scan: self.strategy.as_ref().map_or(ScanEstimate::Mission, ScanEstimate::Strategy),
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        assert!(tick.evaluations <= MAX_EVALUATIONS_PER_TICK, "{}", tick.evaluations);
        assert_eq!(tick.state, self.sequencer.state());
        assert_eq!(self.shadow.tick(&situation, &mut self.small), tick, "the queue matters");
        let now = self.clock.and_then(|clock| clock.instant(ticks).ok());
        self.take_events(ticks, now);
        self.check_safe(before, tick.state, now);
        self.check_session(tick.state, now);
    }

    fn take_events(&mut self, ticks: u64, now: Option<Instant>) {
        let mut count = 0;
        assert_eq!(self.events.lost().total(), 0);
        while let Some(stamped) = self.events.pop() {
            count += 1;
            assert_eq!(stamped.ticks, ticks);
            self.hold(stamped);
            match stamped.event {
                Event::Started(index, session) => {
                    assert_eq!(self.under_way.replace(index), None, "two at once");
                    self.check_start(index, &session, now.expect("a clock"));
                }
                Event::Ended(index) | Event::Aborted(index, _) => {
                    assert_eq!(self.under_way.take(), Some(index));
                }
                _ => {}
            }
        }
        assert!(count <= MAX_SESSIONS_PER_TICK + MAX_OTHER_EVENTS_PER_TICK, "{count} events");
        assert_eq!(self.small.lost().total(), self.lost);
    }

    /// What the small queue should do: in a full one the newest of the least rank goes.
    fn hold(&mut self, stamped: Stamped) {
        self.held.push_back(stamped);
        if self.held.len() > ROOM {
            let rank = |it: &Stamped| it.event.kind().rank();
            let least = self.held.iter().map(rank).min().expect("events");
            let newest = self.held.iter().rposition(|it| rank(it) == least).expect("one");
            self.held.remove(newest);
            self.lost += 1;
        }
    }

    fn check_start(&self, index: u32, session: &SessionRecord, now: Instant) {
        let tables = self.tables.expect("tables");
        assert_eq!(tables.plan().session(index), Some(*session));
        let gap = SETTINGS.longest_gap;
        assert!(session.start <= now.plus(gap) && now <= session.start.plus(gap));
        let known_wrong = tables.header().sequence == WRONG && !self.strategy_changed;
        assert!(!known_wrong, "a session that disagrees was begun");
    }

    /// Without a valid clock and valid tables the state is safe; it is left only after a resume.
    fn check_safe(&mut self, before: State, after: State, now: Option<Instant>) {
        let valid = |tables: Tables<'_>, now| {
            tables.header().valid_from <= now && now <= tables.header().valid_until
        };
        let sound = self.tables.filter(|_| !self.damaged);
        let usable = now.zip(sound).is_some_and(|(now, tables)| valid(tables, now));
        let was_safe = matches!(before, State::Safe(_));
        let is_safe = matches!(after, State::Safe(_));
        assert!(usable || is_safe, "{after:?} without a valid clock and tables");
        if was_safe && !is_safe {
            assert!(self.resumed, "safe was left without a resume");
        }
        if is_safe && !was_safe || was_safe && !is_safe {
            self.resumed = false;
        }
    }

    fn check_session(&self, state: State, now: Option<Instant>) {
        let (State::Setup(index) | State::Calibrating(index) | State::Cooldown(index)) = state
        else {
            assert_eq!(self.under_way, None);
            return;
        };
        assert_eq!(self.under_way, Some(index));
        let now = now.expect("a clock");
        let session = self.tables.and_then(|it| it.plan().session(index)).expect("a session");
        // A small step back lets time stand still, so the session may be ahead of the counter.
        let ahead = now.plus(SETTINGS.longest_gap);
        assert!(session.start <= ahead && now < session.end);
        match state {
            State::Setup(_) => assert!(now < session.first_entry),
            State::Calibrating(_) => {
                assert!(session.first_entry <= ahead && now < session.last_exit);
            }
            _ => assert!(session.last_exit <= ahead),
        }
    }

    fn pop(&mut self, count: u8) {
        for _ in 0..count {
            assert_eq!(self.small.pop(), self.held.pop_front());
        }
    }

    fn operate(&mut self, input: &mut Input<'_>) -> Option<()> {
        match input.byte()? % KINDS {
            LATER => self.tick_to(self.ns + i64::from(input.byte()? % 26) * SECOND),
            RUN => {
                for _ in 0..input.byte()? {
                    if self.left == 0 {
                        break;
                    }
                    self.tick_to(self.ns + 10 * SECOND);
                }
            }
            STEP => {
                let seconds = input.short()?.cast_signed();
                self.tick_to(self.ns + i64::from(seconds) * SECOND);
            }
            JUMP => self.tick_to(self.ns.saturating_add(input.long()?)),
            NEAR => {
                let all = Tables::load(&containers()[0]).expect("sound tables").plan();
                let count = all.sessions().count() as u32;
                let session = all.session(u32::from(input.byte()?) % count)?;
                let ahead = session.start.plus(Duration::from_ns(-3599 * SECOND));
                let times =
                    [ahead, session.start, session.first_entry, session.last_exit, session.end];
                let at = input.choice(&times)?.tai_ns();
                self.tick_to(at + i64::from(input.byte()?.cast_signed()) * SECOND);
            }
            NO_CLOCK => self.clock = None,
            DAMAGED => self.damaged = input.byte()?.is_multiple_of(2),
            CLOCK_BACK => self.clock = Some(CLOCK),
            OTHER_CLOCK => {
                self.clock = Some(ClockCorrelation {
                    ticks: input.array().map(u64::from_le_bytes)?,
                    at: Instant::from_tai_ns(input.long()?),
                    tick_bits: input.array().map(u128::from_le_bytes)?.max(1),
                    ..CLOCK
                });
            }
            NO_TABLES => self.tables = None,
            TABLES => {
                let bytes = input.choice(containers())?;
                self.tables = Some(Tables::load(bytes).expect("sound tables"));
            }
            STOP => {
                self.sequencer.stop();
                self.shadow.stop();
                self.resumed = false;
            }
            RESUME => {
                self.sequencer.resume();
                self.shadow.resume();
                self.resumed = true;
            }
            STRATEGY => {
                let shift = f64::from(input.short()?.cast_signed());
                let tables = Tables::load(&containers()[0]).expect("sound tables");
                let mut parameters = *tables.mission().strategy().parameters();
                parameters.alpha_rad += shift * 1e-8;
                self.strategy = ScanStrategy::new(parameters).ok().filter(|_| shift != 0.0);
                self.strategy_changed = true;
            }
            POP => {
                let count = input.byte()? % 8;
                self.pop(count);
            }
            _ => self.tick(input.array().map(u64::from_le_bytes)?),
        }
        Some(())
    }
}

/// Carries out the operations in the bytes.
///
/// # Panics
/// When a rule is broken.
pub fn run(data: &[u8]) {
    let mut sequencer = Sequencer::new(SETTINGS).expect("legal settings");
    // Safe from the first tick on, unless the first byte says so.
    let resumed = data.first().is_none_or(|byte| byte & 0x80 == 0);
    if resumed {
        sequencer.resume();
    }
    let mut flight = Flight {
        shadow: sequencer.clone(),
        sequencer,
        events: EventQueue::new(),
        small: EventQueue::new(),
        held: VecDeque::new(),
        lost: 0,
        tables: Some(Tables::load(&containers()[0]).expect("sound tables")),
        damaged: false,
        clock: Some(CLOCK),
        strategy: None,
        strategy_changed: false,
        resumed,
        under_way: None,
        ns: 0,
        left: TICKS,
    };
    let mut input = Input(data);
    while flight.left > 0 && flight.operate(&mut input).is_some() {}
    flight.pop(ROOM as u8 + 1);
}
