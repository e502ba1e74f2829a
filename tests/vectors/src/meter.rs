//! How much work is an operation, in ticks of the target's clock.
//!
//! Block: a container (u32 bytes, then it), a detector (x y z w, f64), instants (u32 bytes, then
//! i64 each), then a transit search as in [`transits`](crate::transits).
//!
//! Four measurements leave, three words each: operations done, ticks in all, ticks of the longest
//! where each was timed alone (else 0). They are, in order: attitude, one detector's direction and
//! half-wave plate; the same with crossing and scan-beam angle; steps of the transit search; KiB of
//! containers checked.
//!
//! Method: inputs are opaque to the compiler, instants distinct, the Sun evaluated afresh; the loop
//! around them is counted too. Work too short for the clock is counted over all its repetitions.
//!
//! Limits: ticks count modulo 2^24, so the operations are timed in batches below that.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;
use crate::transits::channels;
use core::hint::black_box;
use onboard_core::attitude::{attitude, sweep};
use onboard_core::direction::Direction;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::hwp::hwp_phase;
use onboard_core::time::Instant;
use onboard_core::transit::{Step, TransitFinder};
use onboard_core::uplink::Container;

/// Instants timed together.
const BATCH: usize = 64;
/// The clock counts modulo this.
const WRAP: u32 = 1 << 24;

/// One measurement.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Measured {
    count: u64,
    ticks: u64,
    longest: u64,
}

impl Measured {
    pub(crate) fn add(&mut self, count: u64, before: u32, after: u32) {
        let ticks = u64::from(after.wrapping_sub(before) % WRAP);
        self.count += count;
        self.ticks += ticks;
        self.longest = self.longest.max(ticks);
    }

    pub(crate) fn write(self, sink: &mut impl Sink) {
        sink.word("operations", self.count);
        sink.word("ticks", self.ticks);
        sink.word("longest", self.longest);
    }
}

/// Takes the four measurements.
///
/// # Errors
/// [`Malformed`] where something does not load or has no answer.
pub fn run(
    block: &mut Reader<'_>,
    clock: &impl Fn() -> u32,
    sink: &mut impl Sink,
) -> Result<(), Malformed> {
    let bytes = block.sized()?;
    let loaded = Loaded::read(bytes)?;
    let (scan, sun) = (loaded.mission.strategy(), loaded.sun()?);
    let detector = block.rotation::<Detector, Boresight>()?;
    let plate = loaded.mission.telescopes().find_map(|it| it.hwp).ok_or(Malformed)?;
    let instants = block.sized()?;

    let pointing = over_instants(instants, clock, |at| {
        let scan = black_box(&scan);
        let attitude = attitude(scan, black_box(&sun), at).map_err(|_| Malformed)?;
        let detector = black_box(detector).then(attitude);
        black_box((attitude, detector.apply(Direction::Z), hwp_phase(scan, black_box(plate), at)));
        Ok(())
    })?;
    pointing.write(sink);

    let sweeping = over_instants(instants, clock, |at| {
        let scan = black_box(&scan);
        let swept = sweep(scan, black_box(&sun), black_box(detector), at).map_err(|_| Malformed)?;
        black_box((swept, hwp_phase(scan, black_box(plate), at)));
        Ok(())
    })?;
    sweeping.write(sink);

    let mut channels = channels(block, &loaded)?;
    let mut finder = TransitFinder::new(&mut channels);
    let mut steps = Measured::default();
    loop {
        let before = clock();
        let step = black_box(&mut finder).step();
        steps.add(1, before, clock());
        match black_box(step) {
            Step::Done => break,
            Step::Failed { .. } => return Err(Malformed),
            Step::Transit(_) | Step::Searched(_) => {}
        }
    }
    steps.write(sink);

    let mut parse = Measured::default();
    for _ in 0..8 {
        let before = clock();
        black_box(Container::parse(black_box(bytes)).is_ok());
        parse.add(u64::try_from(bytes.len()).map_err(|_| Malformed)? / 1024, before, clock());
    }
    parse.write(sink);
    Ok(())
}

fn over_instants(
    instants: &[u8],
    clock: &impl Fn() -> u32,
    operation: impl Fn(Instant) -> Result<(), Malformed>,
) -> Result<Measured, Malformed> {
    let mut measured = Measured::default();
    for batch in instants.as_chunks::<8>().0.chunks(BATCH) {
        let before = clock();
        for ns in batch {
            operation(Instant::from_tai_ns(black_box(i64::from_le_bytes(*ns))))?;
        }
        measured.add(u64::try_from(batch.len()).map_err(|_| Malformed)?, before, clock());
    }
    Ok(Measured { longest: 0, ..measured })
}
