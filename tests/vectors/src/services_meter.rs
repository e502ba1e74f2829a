//! How much work is a tick of the sequencer and an update of the tracker, in ticks of the clock.
//!
//! Block: the sequencer's settings as in [`mod@sequencer`], one clock correlation (72
//! bytes), a container (u32 bytes, then it), ticks (counter u64, step u64, count u32); then a
//! container (u32 bytes, then it), a tracker's settings, epoch and measurements as in
//! [`tracking`].
//!
//! Three measurements leave as in [`crate::meter`]: ticks that made no evaluation, ticks that
//! did, and updates accepted.
//!
//! Limits: each is timed alone, so that one tick of the clock is the error of each; the means are
//! over many.

use crate::Malformed;
use crate::meter::Measured;
use crate::reader::Reader;
use crate::sequencer;
use crate::sink::Sink;
use crate::tables::Loaded;
use crate::tracking;
use core::hint::black_box;
use onboard_core::sequencer::{EventQueue, ScanEstimate, Situation};
use onboard_core::uplink::Tables;

/// Takes the three measurements.
///
/// # Errors
/// [`Malformed`] where something does not load, or a measurement is refused.
pub fn run(
    block: &mut Reader<'_>,
    clock: &impl Fn() -> u32,
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let (idle, checking) = sequencer(block, clock)?;
    idle.write(sink);
    checking.write(sink);

    let loaded = Loaded::read(block.sized()?)?;
    let sun = loaded.sun()?;
    let mut tracker = tracking::tracker(block, &loaded.mission.strategy())?;
    let mut measurements = Reader::new(block.sized()?);
    let mut updates = Measured::default();
    while !measurements.is_empty() {
        let (measurement, now) = tracking::measurement(&mut measurements)?;
        let before = clock();
        let taken = tracker.update(black_box(&sun), black_box(&measurement), black_box(now));
        updates.add(1, before, clock());
        black_box(taken).map_err(|_| Malformed)?;
    }
    updates.write(sink);
    Ok(())
}

fn sequencer(
    block: &mut Reader<'_>,
    clock: &impl Fn() -> u32,
) -> Result<(Measured, Measured), Malformed> {
    let mut sequencer = sequencer::sequencer(block)?;
    let correlation = sequencer::clock(block)?;
    let tables = Tables::load(block.sized()?).map_err(|_| Malformed)?;
    let (mut ticks, step) = (block.u64()?, block.u64()?);
    sequencer.resume();
    let mut events = EventQueue::<4>::new();
    let (mut idle, mut checking) = (Measured::default(), Measured::default());
    for _ in 0..block.u32()? {
        let situation = Situation {
            ticks,
            clock: Some(&correlation),
            tables: Some(&tables),
            tables_damaged: false,
            scan: ScanEstimate::Mission,
        };
        let before = clock();
        let tick = sequencer.tick(black_box(&situation), black_box(&mut events));
        let after = clock();
        let measured = if tick.evaluations == 0 { &mut idle } else { &mut checking };
        measured.add(1, before, after);
        ticks = ticks.wrapping_add(step);
        while events.pop().is_some() {}
    }
    Ok((idle, checking))
}
