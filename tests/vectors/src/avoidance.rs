//! Limits on bright bodies, and when they are violated.
//!
//! Block: a container (u32 bytes, then it), first and last instant of the search (i64), then limits
//! to the end: body i32, angle f64, then a field of view as in [`transits`](crate::transits):
//! telescope's index u32, and a circle's radius f64 or 0.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;
use crate::transits::{MAX_CHANNELS, field};
use heapless::Vec;
use onboard_core::attitude::attitude;
use onboard_core::avoidance::{
    AvoidanceFinder, AvoidanceLimit, AvoidanceStep, Violation, Zone, angle_to_field_rad,
};
use onboard_core::transit::Channel;

/// The angles at the first instant, then every violation.
///
/// # Errors
/// [`Malformed`] where something is illegal or has no answer.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let loaded = Loaded::read(block.sized()?)?;
    let times = (block.instant()?, block.instant()?);
    let (scan, sun) = (loaded.mission.strategy(), loaded.sun()?);
    let into_boresight = attitude(&scan, &sun, times.0).map_err(|_| Malformed)?.inverse();
    let mut channels = Vec::<Channel<'_>, MAX_CHANNELS>::new();
    while !block.is_empty() {
        let limit = AvoidanceLimit::new(block.i32()?, block.f64()?).map_err(|_| Malformed)?;
        let body = loaded.ephemeris.body(limit.body()).map_err(|_| Malformed)?;
        let field = field(block, &loaded)?;
        let seen = into_boresight.apply(body.state(times.0).map_err(|_| Malformed)?.direction);
        sink.number("angle to the field", angle_to_field_rad(&field, seen));
        sink.word("violated", limit.is_violated(&field, seen).into());
        match limit.zone(&field) {
            Zone::Everywhere => sink.word("hopeless limit", 1),
            Zone::Inside(zone) => {
                channels
                    .push(Channel::new(&scan, sun, body, &zone, times))
                    .map_err(|_| Malformed)?;
            }
        }
    }
    let mut finder = AvoidanceFinder::new(&mut channels);
    loop {
        match finder.step() {
            AvoidanceStep::Violation(violation) => write(&violation, sink),
            AvoidanceStep::Searched(_) => {}
            AvoidanceStep::Done => break,
            AvoidanceStep::Failed { .. } => return Err(Malformed),
        }
    }
    for channel in finder.channels() {
        sink.word("evaluations", channel.evaluations());
    }
    Ok(())
}

fn write(violation: &Violation, sink: &mut impl Sink) {
    sink.item(violation.start.tai_ns());
    sink.integer("violating channel", i64::try_from(violation.channel).unwrap_or(-1));
    sink.integer("violation's start", violation.start.tai_ns());
    sink.integer("violation's closest", violation.closest.tai_ns());
    sink.integer("violation's end", violation.end.tai_ns());
    sink.number("least angle", violation.least_angle_rad);
    sink.word("start clipped", violation.start_clipped.into());
    sink.word("end clipped", violation.end_clipped.into());
}
