//! The flight: what the control cycle does, and what runs in the background.
//!
//! Host and target run the same cycles, so that what they print is the same.

use core::fmt::{self, Write};
use onboard_core::clock::ClockCorrelation;
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::sequencer::{EventQueue, ScanEstimate, Sequencer, Settings, Situation, State};
use onboard_core::time::Duration;
use onboard_core::transit::Channel;
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::uplink::Tables;

/// Seconds of the mission's time from cycle to cycle.
const CYCLE_S: u64 = 10;
/// Cycles of the flight: a day.
const CYCLES: u64 = 8640;
const SECOND_NS: i64 = 1_000_000_000;

/// The control cycle's own: clock, tables, sequencer.
pub struct Cycle {
    clock: ClockCorrelation,
    tables: Tables<'static>,
    sequencer: Sequencer,
    events: EventQueue<64>,
    ticks: u64,
}

impl Cycle {
    /// On a container's tables, for the telescope of its first session; the counter counts seconds.
    pub fn new(tables: Tables<'static>) -> Option<Self> {
        let header = tables.header();
        let clock = ClockCorrelation {
            sequence: 1,
            spacecraft: header.spacecraft,
            uncertainty_ns: 0,
            ticks: 0,
            at: header.valid_from,
            tick_bits: ClockCorrelation::tick_of(1_000_000_000, 0),
            valid_from: header.valid_from,
            valid_until: header.valid_until,
        };
        let mut sequencer = Sequencer::new(Settings {
            telescope: tables.plan().session(0)?.telescope,
            tolerance: Duration::from_ns(SECOND_NS),
            passes_tolerance: 0,
            longest_gap: Duration::from_ns(20 * SECOND_NS),
            check_ahead: Duration::from_ns(3600 * SECOND_NS),
            recheck_rad: 1e-3,
            steps_per_tick: 8,
        })
        .ok()?;
        sequencer.resume();
        Some(Self { clock, tables, sequencer, events: EventQueue::new(), ticks: 0 })
    }

    /// One cycle; writes its events. None when the day is over.
    pub fn run(&mut self, out: &mut impl Write) -> Option<Result<State, fmt::Error>> {
        if self.ticks >= CYCLES * CYCLE_S {
            return None;
        }
        let situation = Situation {
            ticks: self.ticks,
            clock: Some(&self.clock),
            tables: Some(&self.tables),
            tables_damaged: false,
            scan: ScanEstimate::Mission,
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        while let Some(stamped) = self.events.pop() {
            if let Err(error) = writeln!(out, "{} {:?}", stamped.ticks, stamped.event) {
                return Some(Err(error));
            }
        }
        self.ticks += CYCLE_S;
        Some(Ok(tick.state))
    }
}

/// The channel of the background's forecast: the first session's target through its telescope.
pub fn channel(tables: &Tables<'static>) -> Option<Channel<'static>> {
    let session = tables.plan().session(0)?;
    let field = tables.mission().calibration_field(session.telescope, 0)?;
    let target = tables.ephemeris().body(session.body).ok()?;
    let ends = (tables.header().valid_from, tables.header().valid_until);
    let scan = tables.mission().strategy();
    Some(Channel::new(&scan, tables.sun().ok()?, target, &field, ends))
}

/// The next visit, found step by step: between two steps the control cycle may run.
pub fn forecast(channel: &Channel<'static>) -> Option<NextVisit> {
    let (mut channels, mut next) = ([*channel], [None]);
    let mut forecast = Forecast::new(&mut channels, &mut next);
    loop {
        match forecast.step(|_| ScanCovariance::ZERO) {
            ForecastStep::Found(_) | ForecastStep::Searched(_) => {}
            ForecastStep::Done => break,
            ForecastStep::Failed { .. } => return None,
        }
    }
    let [next] = next;
    next
}
