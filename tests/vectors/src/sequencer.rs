//! A sequencer in flight, with clocks, tables and commands as they come.
//!
//! Block: settings (telescope u32, tolerance i64 ns, passes' tolerance u32, longest gap i64, check
//! ahead i64, angle of a new check f64 rad, steps per tick u32), clock correlations (u32 count, 72 bytes each), containers (u32
//! count, each u32 bytes, then it), then orders to the end:
//!
//! | order, u32 | operands | what it does |
//! |---|---|---|
//! | 0 | counter u64, step u64, count u32 | that many ticks, the counter a step apart |
//! | 1 | index u32 | takes that clock correlation; beyond the last: none |
//! | 2 | index u32 | takes that container's tables; beyond the last: none |
//! | 3 | | stop |
//! | 4 | | resume |
//! | 5 | f64 | takes the mission's strategy with alpha off by so much; 0: the mission's own |
//! | 6 | u32 | the tables' bytes are damaged from now on; 0: they are not |
//!
//! Every tick writes its state, its evaluations and its events; every order the sequencer itself.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use heapless::Vec;
use onboard_core::clock::ClockCorrelation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sequencer::{EventQueue, ScanEstimate, Sequencer, Settings, Situation};
use onboard_core::uplink::Tables;

/// Most clock correlations, and most containers, of a block.
pub const MAX_RECORDS: usize = 8;

/// A sequencer as a block's settings say.
///
/// # Errors
/// [`Malformed`] where they are illegal.
pub fn sequencer(block: &mut Reader<'_>) -> Result<Sequencer, Malformed> {
    let settings = Settings {
        telescope: block.u16()?,
        tolerance: block.duration()?,
        passes_tolerance: block.u16()?,
        longest_gap: block.duration()?,
        check_ahead: block.duration()?,
        recheck_rad: block.f64()?,
        steps_per_tick: block.u16()?,
    };
    Sequencer::new(settings).map_err(|_| Malformed)
}

/// A clock correlation that must be good.
///
/// # Errors
/// [`Malformed`] where it is refused.
pub fn clock(block: &mut Reader<'_>) -> Result<ClockCorrelation, Malformed> {
    ClockCorrelation::from_le_bytes(&block.field()?).map_err(|_| Malformed)
}

struct Flight<'a> {
    sequencer: Sequencer,
    events: EventQueue<4>,
    clock: Option<ClockCorrelation>,
    tables: Option<Tables<'a>>,
    damaged: bool,
    strategy: Option<ScanStrategy>,
}

impl Flight<'_> {
    fn tick(&mut self, ticks: u64, sink: &mut impl Sink) {
        let tick = self.sequencer.tick(
            &Situation {
                ticks,
                clock: self.clock.as_ref(),
                tables: self.tables.as_ref(),
                tables_damaged: self.damaged,
                scan: self.strategy.as_ref().map_or(ScanEstimate::Mission, ScanEstimate::Strategy),
            },
            &mut self.events,
        );
        sink.item(i64::from_le_bytes(ticks.to_le_bytes()));
        sink.text("sequencer's state", &tick.state);
        sink.word("tick's evaluations", tick.evaluations.into());
        while let Some(event) = self.events.pop() {
            sink.text("event", &event);
        }
        sink.word("events lost", self.events.lost().total().into());
    }

    fn correct(&mut self, alpha_rad: f64) -> Result<(), Malformed> {
        let mission = self.tables.as_ref().ok_or(Malformed)?.mission();
        let mut parameters = *mission.strategy().parameters();
        parameters.alpha_rad += alpha_rad;
        let corrected = ScanStrategy::new(parameters).map_err(|_| Malformed)?;
        self.strategy = (alpha_rad != 0.0).then_some(corrected);
        Ok(())
    }
}

/// Flies as the orders say.
///
/// # Errors
/// [`Malformed`] where settings, a record or an order is illegal.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let sequencer = sequencer(block)?;
    let mut clocks = Vec::<ClockCorrelation, MAX_RECORDS>::new();
    for _ in 0..block.u32()? {
        clocks.push(clock(block)?).map_err(|_| Malformed)?;
    }
    let mut containers = Vec::<&[u8], MAX_RECORDS>::new();
    for _ in 0..block.u32()? {
        containers.push(block.sized()?).map_err(|_| Malformed)?;
    }
    let mut flight = Flight {
        sequencer,
        events: EventQueue::new(),
        clock: None,
        tables: None,
        damaged: false,
        strategy: None,
    };
    while !block.is_empty() {
        match block.u32()? {
            0 => {
                let (mut ticks, step) = (block.u64()?, block.u64()?);
                for _ in 0..block.u32()? {
                    flight.tick(ticks, sink);
                    ticks = ticks.wrapping_add(step);
                }
            }
            1 => flight.clock = clocks.get(block.index()?).copied(),
            2 => {
                let tables = containers.get(block.index()?).map(|bytes| Tables::load(bytes));
                flight.tables = tables.transpose().map_err(|_| Malformed)?;
            }
            3 => flight.sequencer.stop(),
            4 => flight.sequencer.resume(),
            5 => flight.correct(block.f64()?)?,
            6 => flight.damaged = block.u32()? != 0,
            _ => return Err(Malformed),
        }
        sink.text("sequencer", &flight.sequencer);
    }
    Ok(())
}
