//! The sequencer: one telescope's sessions of the plan, carried out, and the queue of its events.

use crate::clock::gyr_clock_t;
use crate::error::gyr_error_t;
use crate::memory::{
    State as Kept, answer, content, content_mut, content_or_none, fill, input, output, writable,
};
use crate::tables::{gyr_session_t, gyr_tables_t};
use crate::tracker::gyr_tracker_t;
use onboard_core::sequencer::{
    AbortReason, Event, EventQueue, Progress, SafeReason, ScanEstimate, Sequencer, Settings,
    Situation, SkipReason, Stamped, State, Tick,
};
use onboard_core::time::Duration;

/// Events that a sequencer holds until they are popped; a tick emits at most 37.
pub const GYR_EVENTS: usize = 64;

/// 64-bit words of a gyr_sequencer_t.
pub const GYR_SEQUENCER_WORDS: usize = 704;

/// One telescope's sessions, carried out, and the events that wait; holds no pointer.
#[repr(C)]
pub struct gyr_sequencer_t {
    opaque: [u64; GYR_SEQUENCER_WORDS],
}

/// A sequencer and its queue.
pub(crate) struct Carried {
    sequencer: Sequencer,
    pub(crate) events: EventQueue<GYR_EVENTS>,
    pub(crate) telescope: u16,
    /// What the last tick brought.
    pub(crate) last: Tick,
}

impl Kept for gyr_sequencer_t {
    type Content = Carried;
    const KIND: [u8; 8] = *b"gyrseque";
}

const _: () = assert!(<gyr_sequencer_t as Kept>::FITS);

/// How a sequencer behaves.
#[repr(C)]
pub struct gyr_sequencer_settings_t {
    /// How far predicted and planned first entry and last exit may differ, and how uncertain the
    /// predicted ones may be, ns.
    pub tolerance_ns: i64,
    /// Longest time between two ticks, and latest start of a session after its planned one, ns.
    pub longest_gap_ns: i64,
    /// How long before its start a session is checked, ns.
    pub check_ahead_ns: i64,
    /// Where the strategy's change turns the attitude predicted for a session's start or end by more
    /// than this, the session is checked again, rad.
    pub recheck_rad: f64,
    /// Index of its telescope in the mission.
    pub telescope: u16,
    /// How far predicted and planned number of passes may differ.
    pub passes_tolerance: u16,
    /// Search steps per tick, 1 to 8.
    pub steps_per_tick: u16,
}

/// What a tick is given; each pointer may be null where there is none.
#[repr(C)]
pub struct gyr_situation_t {
    /// The on-board counter.
    pub ticks: u64,
    /// The clock correlation.
    pub clock: *const gyr_clock_t,
    /// The active tables.
    pub tables: *const gyr_tables_t,
    /// The strategy as measured attitudes have corrected it, and as well as the tracker knows it;
    /// without it the mission's strategy counts, as exact.
    pub tracker: *const gyr_tracker_t,
    /// Not 0 where the tables' bytes were found damaged after they had been loaded.
    pub tables_damaged: u32,
}

/// Surveying; no session runs.
pub const GYR_STATE_IDLE: u32 = 1;
/// Before the target's first entry.
pub const GYR_STATE_SETUP: u32 = 2;
/// Between first entry and last exit.
pub const GYR_STATE_CALIBRATING: u32 = 3;
/// After the last exit.
pub const GYR_STATE_COOLDOWN: u32 = 4;
/// Nothing is done until gyr_sequencer_resume.
pub const GYR_STATE_SAFE: u32 = 5;

/// What the spacecraft does now.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct gyr_state_t {
    /// One of GYR_STATE_IDLE to GYR_STATE_SAFE.
    pub kind: u32,
    /// The running session's index in the plan; 0 in GYR_STATE_IDLE and GYR_STATE_SAFE.
    pub session: u32,
    /// Why it is safe, else GYR_OK.
    pub reason: gyr_error_t,
    /// As the reason says, else 0.
    pub value: i64,
}

/// No session is near enough to be checked.
pub const GYR_CHECK_WAITING: u32 = 1;
/// The check goes on at the next tick.
pub const GYR_CHECK_UNDER_WAY: u32 = 2;
/// The check's outcome is known.
pub const GYR_CHECK_DONE: u32 = 3;

/// What a tick brought.
#[repr(C)]
pub struct gyr_tick_t {
    /// The state now.
    pub state: gyr_state_t,
    /// Evaluations made: at most 108.
    pub evaluations: u32,
    /// How far the check of the next session has come: one of GYR_CHECK_WAITING to GYR_CHECK_DONE.
    pub check: u32,
}

/// The state changed to `state`.
pub const GYR_EVENT_ENTERED: u32 = 1;
/// The session `session`, whose record is `record`, begins.
pub const GYR_EVENT_STARTED: u32 = 2;
/// The session `session` is over, cooldown included.
pub const GYR_EVENT_ENDED: u32 = 3;
/// The session `session` is not begun; `reason`, `value`.
pub const GYR_EVENT_SKIPPED: u32 = 4;
/// The running session `session` is given up; `reason`, `value`.
pub const GYR_EVENT_ABORTED: u32 = 5;
/// The state is left for safe, or is safe from the first tick on; `reason`, `value`.
pub const GYR_EVENT_SAFE: u32 = 6;
/// Other tables are in use; `value` is their sequence number.
pub const GYR_EVENT_TABLES: u32 = 7;
/// Time moved on by more than the longest gap, from `value` to `to_tai_ns`.
pub const GYR_EVENT_TIME_JUMPED: u32 = 8;

/// Something that happened. What its kind does not name is 0.
#[repr(C)]
pub struct gyr_event_t {
    /// The on-board counter then.
    pub ticks: u64,
    /// One of GYR_EVENT_ENTERED to GYR_EVENT_TIME_JUMPED.
    pub kind: u32,
    /// A session's index in the plan.
    pub session: u32,
    /// Why, else GYR_OK.
    pub reason: gyr_error_t,
    /// As the kind or the reason says.
    pub value: i64,
    /// Where time jumped to, ns of TAI.
    pub to_tai_ns: i64,
    /// The state entered.
    pub state: gyr_state_t,
    /// The record of a session that begins.
    pub record: gyr_session_t,
}

/// How many events of each kind were lost; each number stays at its largest value.
#[repr(C)]
pub struct gyr_lost_t {
    /// GYR_EVENT_ENTERED.
    pub entered: u32,
    /// GYR_EVENT_STARTED.
    pub started: u32,
    /// GYR_EVENT_ENDED.
    pub ended: u32,
    /// GYR_EVENT_SKIPPED.
    pub skipped: u32,
    /// GYR_EVENT_ABORTED.
    pub aborted: u32,
    /// GYR_EVENT_SAFE.
    pub safe: u32,
    /// GYR_EVENT_TABLES.
    pub tables: u32,
    /// GYR_EVENT_TIME_JUMPED.
    pub time_jumped: u32,
}

impl gyr_state_t {
    const NONE: Self = Self { kind: 0, session: 0, reason: gyr_error_t::GYR_OK, value: 0 };
}

impl From<State> for gyr_state_t {
    fn from(state: State) -> Self {
        let (kind, session) = match state {
            State::Idle => (GYR_STATE_IDLE, 0),
            State::Setup(session) => (GYR_STATE_SETUP, session),
            State::Calibrating(session) => (GYR_STATE_CALIBRATING, session),
            State::Cooldown(session) => (GYR_STATE_COOLDOWN, session),
            State::Safe(why) => {
                let (reason, value) = safe(why);
                return Self { kind: GYR_STATE_SAFE, session: 0, reason, value };
            }
        };
        Self { kind, session, ..Self::NONE }
    }
}

/// A reason's code, and the value that goes with it.
fn safe(reason: SafeReason) -> (gyr_error_t, i64) {
    match reason {
        SafeReason::Boot => (gyr_error_t::GYR_SAFE_BOOT, 0),
        SafeReason::TablesDamaged => (gyr_error_t::GYR_SAFE_TABLES_DAMAGED, 0),
        SafeReason::Commanded => (gyr_error_t::GYR_SAFE_COMMANDED, 0),
        SafeReason::NoClock => (gyr_error_t::GYR_SAFE_NO_CLOCK, 0),
        SafeReason::Clock(error) => (error.into(), 0),
        SafeReason::NoTables => (gyr_error_t::GYR_SAFE_NO_TABLES, 0),
        SafeReason::TablesNotYetValid(from) => {
            (gyr_error_t::GYR_SAFE_TABLES_NOT_YET_VALID, from.tai_ns())
        }
        SafeReason::TablesExpired(until) => (gyr_error_t::GYR_SAFE_TABLES_EXPIRED, until.tai_ns()),
        SafeReason::NoSuchTelescope => (gyr_error_t::GYR_SAFE_NO_SUCH_TELESCOPE, 0),
        SafeReason::TimeReversed(by) => (gyr_error_t::GYR_SAFE_TIME_REVERSED, by.ns()),
        _ => (gyr_error_t::GYR_UNNAMED, 0),
    }
}

fn skip(reason: SkipReason) -> (gyr_error_t, i64) {
    match reason {
        SkipReason::Missed => (gyr_error_t::GYR_SKIP_MISSED, 0),
        SkipReason::Overlap => (gyr_error_t::GYR_SKIP_OVERLAP, 0),
        SkipReason::NotChecked => (gyr_error_t::GYR_SKIP_NOT_CHECKED, 0),
        SkipReason::NoPass => (gyr_error_t::GYR_SKIP_NO_PASS, 0),
        SkipReason::Entry(by) => (gyr_error_t::GYR_SKIP_ENTRY, by.ns()),
        SkipReason::Exit(by) => (gyr_error_t::GYR_SKIP_EXIT, by.ns()),
        SkipReason::Passes(number) => (gyr_error_t::GYR_SKIP_PASSES, number.into()),
        SkipReason::Avoidance(body) => (gyr_error_t::GYR_SKIP_AVOIDANCE, body.into()),
        SkipReason::Uncertain(by) => (gyr_error_t::GYR_SKIP_UNCERTAIN, by.ns()),
        SkipReason::Ephemeris(error) => (error.into(), 0),
        _ => (gyr_error_t::GYR_UNNAMED, 0),
    }
}

fn abort(reason: AbortReason) -> (gyr_error_t, i64) {
    match reason {
        AbortReason::Safe => (gyr_error_t::GYR_ABORT_SAFE, 0),
        AbortReason::Tables => (gyr_error_t::GYR_ABORT_TABLES, 0),
        AbortReason::TimeJumped => (gyr_error_t::GYR_ABORT_TIME_JUMPED, 0),
        AbortReason::Avoidance(body) => (gyr_error_t::GYR_ABORT_AVOIDANCE, body.into()),
        AbortReason::Ephemeris(error) => (error.into(), 0),
        _ => (gyr_error_t::GYR_UNNAMED, 0),
    }
}

impl From<Stamped> for gyr_event_t {
    fn from(stamped: Stamped) -> Self {
        let empty = Self {
            ticks: stamped.ticks,
            kind: 0,
            session: 0,
            reason: gyr_error_t::GYR_OK,
            value: 0,
            to_tai_ns: 0,
            state: gyr_state_t::NONE,
            record: gyr_session_t::NONE,
        };
        match stamped.event {
            Event::Entered(state) => Self { kind: GYR_EVENT_ENTERED, state: state.into(), ..empty },
            Event::Started(session, record) => {
                Self { kind: GYR_EVENT_STARTED, session, record: record.into(), ..empty }
            }
            Event::Ended(session) => Self { kind: GYR_EVENT_ENDED, session, ..empty },
            Event::Skipped(session, why) => {
                let (reason, value) = skip(why);
                Self { kind: GYR_EVENT_SKIPPED, session, reason, value, ..empty }
            }
            Event::Aborted(session, why) => {
                let (reason, value) = abort(why);
                Self { kind: GYR_EVENT_ABORTED, session, reason, value, ..empty }
            }
            Event::Safe(why) => {
                let (reason, value) = safe(why);
                Self { kind: GYR_EVENT_SAFE, reason, value, ..empty }
            }
            Event::Tables(sequence) => {
                Self { kind: GYR_EVENT_TABLES, value: sequence.into(), ..empty }
            }
            Event::TimeJumped { from, to } => Self {
                kind: GYR_EVENT_TIME_JUMPED,
                value: from.tai_ns(),
                to_tai_ns: to.tai_ns(),
                ..empty
            },
        }
    }
}

/// Makes a sequencer with an empty queue. It is safe until gyr_sequencer_resume.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sequencer_init(
    sequencer: *mut gyr_sequencer_t,
    settings: *const gyr_sequencer_settings_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let given = unsafe { input(settings) }?;
        let made = Sequencer::new(Settings {
            telescope: given.telescope,
            tolerance: Duration::from_ns(given.tolerance_ns),
            passes_tolerance: given.passes_tolerance,
            longest_gap: Duration::from_ns(given.longest_gap_ns),
            check_ahead: Duration::from_ns(given.check_ahead_ns),
            recheck_rad: given.recheck_rad,
            steps_per_tick: given.steps_per_tick,
        })?;
        let last = Tick { state: made.state(), evaluations: 0, check: Progress::Waiting };
        let (events, telescope) = (EventQueue::new(), given.telescope);
        // SAFETY: as above.
        unsafe { fill(sequencer, Carried { sequencer: made, events, telescope, last }) }
    })
}

/// Moves on to the time of the on-board counter. Call it every cycle, without clock or tables too:
/// the missing input makes it safe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sequencer_tick(
    sequencer: *mut gyr_sequencer_t,
    situation: *const gyr_situation_t,
    result: *mut gyr_tick_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let given = unsafe { input(situation) }?;
        // SAFETY: as above.
        let clock = unsafe { content_or_none(given.clock) }?;
        // SAFETY: as above.
        let tables = unsafe { content_or_none(given.tables) }?.map(|loaded| &loaded.tables);
        // SAFETY: as above.
        let tracker = unsafe { content_or_none(given.tracker) }?;
        let situation = Situation {
            ticks: given.ticks,
            clock,
            tables,
            tables_damaged: given.tables_damaged != 0,
            scan: tracker.map_or(ScanEstimate::Mission, ScanEstimate::Tracked),
        };
        writable(result)?;
        // SAFETY: as above.
        let own = unsafe { content_mut(sequencer) }?;
        let tick = own.sequencer.tick(&situation, &mut own.events);
        own.last = tick;
        let check = match tick.check {
            Progress::Waiting => GYR_CHECK_WAITING,
            Progress::UnderWay => GYR_CHECK_UNDER_WAY,
            Progress::Done => GYR_CHECK_DONE,
        };
        let answer = gyr_tick_t { state: tick.state.into(), evaluations: tick.evaluations, check };
        // SAFETY: as above.
        unsafe { output(result, answer) }
    })
}

/// The oldest event, taken out; GYR_NOTHING when none waits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sequencer_pop(
    sequencer: *mut gyr_sequencer_t,
    event: *mut gyr_event_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content_mut(sequencer) }?;
        // Before the event is taken out, so that it cannot be lost.
        writable(event)?;
        let oldest = own.events.pop().ok_or(gyr_error_t::GYR_NOTHING)?;
        // SAFETY: as above.
        unsafe { output(event, oldest.into()) }
    })
}

/// Events lost so far because the queue was full: a full queue keeps what matters most.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sequencer_lost(
    sequencer: *const gyr_sequencer_t,
    lost: *mut gyr_lost_t,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content(sequencer) }?.events.lost();
        let answer = gyr_lost_t {
            entered: own.entered,
            started: own.started,
            ended: own.ended,
            skipped: own.skipped,
            aborted: own.aborted,
            safe: own.safe,
            tables: own.tables,
            time_jumped: own.time_jumped,
        };
        // SAFETY: as above.
        unsafe { output(lost, answer) }
    })
}

/// Orders safe at the next tick.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sequencer_stop(sequencer: *mut gyr_sequencer_t) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        unsafe { content_mut(sequencer) }?.sequencer.stop();
        Ok(())
    })
}

/// Orders safe to be left at the next tick that has a valid clock and valid tables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_sequencer_resume(sequencer: *mut gyr_sequencer_t) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        unsafe { content_mut(sequencer) }?.sequencer.resume();
        Ok(())
    })
}
