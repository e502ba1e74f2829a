//! Telemetry: events and housekeeping as payloads of CCSDS space packets, and the packets' header.

use crate::clock::gyr_clock_t;
use crate::error::gyr_error_t;
use crate::forecast::gyr_next_visit_t;
use crate::memory::{
    answer, content, content_mut, content_or_none, input, output, record_mut, writable,
};
use crate::scrub::gyr_scrub_t;
use crate::sequencer::{gyr_event_t, gyr_sequencer_t};
use crate::tables::gyr_tables_t;
use crate::tracker::gyr_tracker_t;
use onboard_core::telemetry::{
    ClockInUse, EVENT_BYTES, EventReport, HOUSEKEEPING_BYTES, Housekeeping, MAX_APID, Origin,
    PACKET_HEADER_BYTES, PacketHeader, TablesInUse, TrackerHealth, VisitToCome,
};
use onboard_core::time::Instant;

/// Bytes of an event's payload.
pub const GYR_EVENT_BYTES: usize = 96;
/// Bytes of housekeeping's payload.
pub const GYR_HOUSEKEEPING_BYTES: usize = 268;
/// Bytes of a space packet's primary header.
pub const GYR_PACKET_HEADER_BYTES: usize = 6;
const _: () = assert!(
    GYR_EVENT_BYTES == EVENT_BYTES
        && GYR_HOUSEKEEPING_BYTES == HOUSEKEEPING_BYTES
        && GYR_PACKET_HEADER_BYTES == PACKET_HEADER_BYTES
);

/// What housekeeping tells of; each pointer but the sequencer's may be null where there is none.
#[repr(C)]
pub struct gyr_housekeeping_t {
    /// The on-board counter.
    pub ticks: u64,
    /// The sequencer: state, last tick, events lost.
    pub sequencer: *const gyr_sequencer_t,
    /// The clock correlation in use.
    pub clock: *const gyr_clock_t,
    /// The tables in use.
    pub tables: *const gyr_tables_t,
    /// The tracker.
    pub tracker: *const gyr_tracker_t,
    /// The scrub of the tables in use.
    pub scrub: *const gyr_scrub_t,
    /// The visit to come that the forecast has found, and with it `body`.
    pub visit: *const gyr_next_visit_t,
    /// The number of that visit's target.
    pub body: i32,
    /// Identity of the spacecraft (gyr_header_t).
    pub spacecraft: u32,
    /// Not 0 where the tables' bytes were found damaged after they had been loaded.
    pub tables_damaged: u32,
}

/// The oldest event, taken out, as a payload of GYR_EVENT_BYTES bytes and as gyr_sequencer_pop gives
/// it; GYR_NOTHING when none waits. The clock (null where there is none) tells the event's instant.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_telemetry_pop(
    sequencer: *mut gyr_sequencer_t,
    clock: *const gyr_clock_t,
    spacecraft: u32,
    event: *mut gyr_event_t,
    payload: *mut u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let own = unsafe { content_mut(sequencer) }?;
        // SAFETY: as above.
        let clock = unsafe { content_or_none(clock) }?;
        // Before the event is taken out, so that it cannot be lost.
        writable(event)?;
        // SAFETY: as above.
        let place = unsafe { record_mut::<EVENT_BYTES>(payload, length) }?;
        let oldest = own.events.pop().ok_or(gyr_error_t::GYR_NOTHING)?;
        *place = EventReport::new(&oldest, spacecraft, own.telescope, clock).to_be_bytes();
        // SAFETY: as above.
        unsafe { output(event, oldest.into()) }
    })
}

/// Housekeeping as a payload of GYR_HOUSEKEEPING_BYTES bytes. The tracker's covariance is that of the
/// counter's instant, or of its last measurement where the clock does not tell it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_telemetry_housekeeping(
    housekeeping: *const gyr_housekeeping_t,
    payload: *mut u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        // SAFETY: what every caller must hold.
        let given = unsafe { input(housekeeping) }?;
        // SAFETY: as above.
        let own = unsafe { content(given.sequencer) }?;
        // SAFETY: as above.
        let clock = unsafe { content_or_none(given.clock) }?;
        // SAFETY: as above.
        let tables = unsafe { content_or_none(given.tables) }?;
        // SAFETY: as above.
        let tracker = unsafe { content_or_none(given.tracker) }?;
        // SAFETY: as above.
        let scrub = unsafe { content_or_none(given.scrub) }?;
        let visit = if given.visit.is_null() {
            None
        } else {
            // SAFETY: as above.
            Some(unsafe { input(given.visit) }?)
        };
        // SAFETY: as above.
        let place = unsafe { record_mut::<HOUSEKEEPING_BYTES>(payload, length) }?;
        let origin = Origin::new(given.spacecraft, own.telescope, given.ticks, clock);
        *place = Housekeeping {
            origin,
            tick: own.last,
            tables: tables.map(|loaded| TablesInUse::of(&loaded.tables)),
            tables_damaged: given.tables_damaged != 0,
            clock: clock.map(ClockInUse::of),
            lost: own.events.lost(),
            tracker: tracker
                .map(|it| TrackerHealth::of(it, origin.at.unwrap_or_else(|| it.epoch()))),
            scrub: scrub.map(|watched| watched.scrub.progress()),
            visit: visit.map(|visit| of(visit, given.body)),
        }
        .to_be_bytes();
        Ok(())
    })
}

fn of(visit: &gyr_next_visit_t, body: i32) -> VisitToCome {
    VisitToCome {
        body,
        entry: Instant::from_tai_ns(visit.transit.entry_tai_ns),
        exit: Instant::from_tai_ns(visit.transit.exit_tai_ns),
        entry_clipped: visit.transit.entry_clipped != 0,
        exit_clipped: visit.transit.exit_clipped != 0,
        earliest_entry: Instant::from_tai_ns(visit.earliest_entry_tai_ns),
        latest_exit: Instant::from_tai_ns(visit.latest_exit_tai_ns),
        probability: visit.probability,
        entry_sigma_s: visit.entry_sigma_s,
    }
}

/// The primary header, GYR_PACKET_HEADER_BYTES bytes, of a telemetry packet without secondary header
/// around a payload of `payload_length` bytes, 1 to 65536; the lower 14 bits of `count` count.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gyr_packet_header(
    apid: u16,
    count: u16,
    payload_length: usize,
    header: *mut u8,
    length: usize,
) -> gyr_error_t {
    answer(|| {
        let last = payload_length.checked_sub(1).and_then(|last| u16::try_from(last).ok());
        let data_bytes_less_one = last.ok_or(gyr_error_t::GYR_ARGUMENT_LENGTH)?;
        if apid > MAX_APID {
            return Err(gyr_error_t::GYR_ARGUMENT_RANGE);
        }
        // SAFETY: what every caller must hold.
        let place = unsafe { record_mut::<PACKET_HEADER_BYTES>(header, length) }?;
        let made = PacketHeader { apid, secondary_header: false, count, data_bytes_less_one };
        *place = made.to_be_bytes();
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use onboard_core::sequencer::{Event, SafeReason, Stamped, State};
    use onboard_core::telemetry::Payload;
    use onboard_core::uplink::checksum;

    /// The event of that kind whose payload has this reason, where there is one.
    fn event(kind: u8, state: u8, reason: u16) -> Option<Event> {
        let origin = Origin { spacecraft: 1, telescope: 0, ticks: 0, at: None };
        let mut payload = EventReport { origin, event: Event::Ended(0) }.to_be_bytes();
        payload[1] = kind;
        payload[25] = state;
        payload[26..28].copy_from_slice(&reason.to_be_bytes());
        let crc = checksum(&payload[..92]);
        payload[92..].copy_from_slice(&crc.to_be_bytes());
        match Payload::from_be_bytes(&payload) {
            Ok(Payload::Event(report)) => Some(report.event),
            _ => None,
        }
    }

    /// Kinds and reasons of payloads are the numbers that C is given with the same event.
    #[test]
    fn payloads_and_the_header_have_the_same_codes() {
        let mut reasons = 0;
        for (kind, state) in (1..=8).flat_map(|kind| (0..=5).map(move |state| (kind, state))) {
            for reason in 0..=999 {
                let Some(found) = event(kind, state, reason) else { continue };
                let given: gyr_event_t = Stamped { ticks: 0, event: found }.into();
                assert_eq!(given.kind, u32::from(kind));
                let inner = if kind == 1 { given.state.reason } else { given.reason };
                assert_eq!(inner as i32, i32::from(reason), "{found:?}");
                if kind == 1 {
                    assert_eq!(given.state.kind, u32::from(state));
                }
                reasons += 1;
            }
        }
        // 4 states and 18 reasons to be safe; 1; 1; 15; 10; 18; 1; 1.
        assert_eq!(reasons, 69);
        let boot = Event::Entered(State::Safe(SafeReason::Boot));
        assert_eq!(event(1, 5, 167), Some(boot));
    }
}
