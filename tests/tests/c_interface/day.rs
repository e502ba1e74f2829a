//! The day of `onboard-core/c/examples/day.c`, flown with the flight core itself.
//!
//! It follows the C program function by function, in the same order and with the same numbers, and
//! tells the same lines.

use crate::flash::{Flash, go_and_return, number};
use crate::teller::{Teller, safe, skip};
use clap::Parser;
use ground_tools::cli::Cli;
use onboard_core::attitude::{attitude, sweep};
use onboard_core::clock::ClockCorrelation;
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::frame::{Boresight, Detector};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::saved_visits::visits_record_bytes;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sequencer::{
    AbortReason, Event, EventQueue, Progress, ScanEstimate, Sequencer, Settings, Situation, Tick,
};
use onboard_core::telemetry::{
    ClockInUse, EventReport, HOUSEKEEPING_BYTES, Housekeeping, Origin, PacketHeader, TablesInUse,
    TrackerHealth, VisitToCome,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::tracking::{Measurement, Tracker, TrackerSettings};
use onboard_core::transit::{Channel, SearchOrigin, SearchState, Step, TransitFinder};
use onboard_core::uplink::{RollbackOrder, Scrub, ScrubStep, Tables, checksum};
use onboard_core::visits::{Bins, Divisions, Spacing, TargetVisits, VisitLog};

const SECOND: i64 = 1_000_000_000;
const CYCLE_S: i64 = 10;
const DAY_S: i64 = 86_400;
const FIRST_TICK: u64 = 1000;
const TICKS_PER_S: u64 = 1_000_000;
const CHANNELS: usize = 8;
const BINS: usize = 20;
const SLOT_BYTES: usize = 1 << 18;

/// A day: what it is flown with, and what it tells.
pub struct Flown {
    /// As `build::FILES` names them.
    pub files: [Vec<u8>; 4],
    pub told: String,
}

/// Flies the first day of a short plan.
pub fn fly() -> Result<Flown, String> {
    let out = crate::build::folder("plan").map_err(|_| "no folder")?;
    let out_text = out.to_str().ok_or("a path of letters")?;
    let arguments =
        ["gyrfalcon", "plan", "--quiet", "--force", "--duration", "2d", "--out", out_text];
    ground_tools::verb::run(&Cli::parse_from(arguments)).map_err(|_| "no plan")?;
    let container = std::fs::read(out.join("uplink.tbl")).map_err(|error| error.to_string())?;
    let tables = Tables::load(&container).map_err(|error| format!("{error:?}"))?;
    let header = *tables.header();
    let clock = ClockCorrelation {
        sequence: 1,
        spacecraft: header.spacecraft,
        uncertainty_ns: 0,
        ticks: FIRST_TICK,
        at: header.valid_from,
        tick_bits: ClockCorrelation::tick_of(SECOND as u64 / TICKS_PER_S, 0),
        valid_from: header.valid_from,
        valid_until: header.valid_until,
    };
    let newer = with_the_next_number(&container, header.sequence);
    let order = RollbackOrder {
        from: header.sequence + 1,
        to: header.sequence,
        to_digest: tables.set_digest(),
        until: header.valid_until,
    };
    let mut tell = Teller::default();
    let mut flash = Flash([vec![0xff; SLOT_BYTES], vec![0xff; SLOT_BYTES]]);
    take_tables(&mut flash, &container, &mut tell);
    // Null twice, memory that is no state twice, beyond the tables.
    for (refused, code) in
        [("null", 1), ("no place", 1), ("never made", 4), ("copied", 4), ("out of span", 44)]
    {
        tell.word(refused, code);
    }
    show_attitudes(&tables, &mut tell);
    find_transits(&tables, &mut tell);
    Day::prepare(&tables, clock).fly(&mut tell);
    tell.word("scrub without", 4);
    go_and_return(&mut flash, &newer, &order, header.valid_from, &mut tell);
    tell.word("unloaded", 4);
    let told = tell.0;
    let (clock, order) = (clock.to_le_bytes().to_vec(), order.to_le_bytes().to_vec());
    Ok(Flown { files: [container, clock, newer, order], told })
}

/// The same container with the next sequence number.
fn with_the_next_number(container: &[u8], sequence: u32) -> Vec<u8> {
    let mut newer = container.to_vec();
    newer[16..20].copy_from_slice(&(sequence + 1).to_le_bytes());
    let crc = checksum(&newer[..60]);
    newer[60..64].copy_from_slice(&crc.to_le_bytes());
    newer
}

fn take_tables(flash: &mut Flash, container: &[u8], tell: &mut Teller) {
    flash.tell(tell);
    assert!(flash.slots().active().is_err());
    tell.word("none active", 91);
    let from = Tables::load(container).expect("tables").header().valid_from;
    flash.bring(container, from, tell);
    flash.tell(tell);
    let slots = flash.slots();
    let active = slots.active().expect("tables");
    let tables = active.tables;
    let header = tables.header();
    tell.word("slot", number(active.slot) as u64);
    tell.word("sequence", header.sequence.into());
    tell.word("spacecraft", header.spacecraft.into());
    tell.word("digest", tables.set_digest());
    tell.integer("valid from", header.valid_from.tai_ns());
    tell.integer("valid until", header.valid_until.tai_ns());
    tell.word("telescopes", tables.mission().telescopes().count() as u64);
    for session in tables.plan().sessions() {
        tell.integer("session's start", session.start.tai_ns());
        tell.integer("session's first entry", session.first_entry.tai_ns());
        tell.integer("session's last exit", session.last_exit.tai_ns());
        tell.integer("session's end", session.end.tai_ns());
        tell.integer("session's body", session.body.into());
        tell.word("session's telescope", session.telescope.into());
        tell.word("session's passes", session.passes.into());
    }
    assert!(slots.admit(container, header.valid_from).is_err());
    tell.word("admitted", 94);
}

fn show_attitudes(tables: &Tables<'_>, tell: &mut Teller) {
    let (scan, sun) = (tables.mission().strategy(), tables.sun().expect("a Sun"));
    for second in (0..DAY_S).step_by(60) {
        let at = tables.header().valid_from.plus(Duration::from_ns(second * SECOND));
        let (precession, spin) = scan.phases(at);
        tell.word("precession", precession.bits());
        tell.word("spin", spin.bits());
        tell.word("spin turns", scan.turns(at).1);
        tell.reals("boresight", attitude(&scan, &sun, at).expect("the Sun is known").to_xyzw());
        for telescope in tables.mission().telescopes().take(3) {
            let frame = Rotation::<Detector, Boresight>::from_xyzw(telescope.rotation.to_xyzw());
            let seen =
                sweep(&scan, &sun, frame.expect("a rotation"), at).expect("the Sun is known");
            tell.reals("telescope", seen.attitude.to_xyzw());
            tell.reals("line of sight", seen.direction.xyz());
            tell.real("crossing angle", seen.crossing_angle_rad);
            tell.real("speed", seen.speed_rad_s);
            tell.real("scan-beam angle", seen.scan_beam_angle_rad);
            if let Some(plate) = telescope.hwp {
                let phase = hwp_phase(&scan, plate, at);
                tell.word("half-wave plate", phase.bits());
                tell.real("half-wave plate", phase.radians());
            }
        }
    }
}

/// Body and telescope of the plan's first sessions.
fn targets(tables: &Tables<'_>) -> Vec<(i32, u16)> {
    let mut found = Vec::new();
    for session in tables.plan().sessions() {
        let own = (session.body, session.telescope);
        if !found.contains(&own) && found.len() < CHANNELS {
            found.push(own);
        }
    }
    assert!(found.len() > 1, "{found:?}");
    found
}

/// Which searches the channels are.
fn origins(tables: &Tables<'_>, scan: &ScanStrategy) -> Vec<SearchOrigin> {
    targets(tables)
        .into_iter()
        .map(|(body, telescope)| {
            let field = tables.mission().calibration_field(telescope, 0).expect("a field");
            SearchOrigin::new(tables.header(), tables.set_digest(), scan, &field, body)
        })
        .collect()
}

fn channels<'a>(tables: &Tables<'a>, scan: &ScanStrategy) -> Vec<Channel<'a>> {
    let from = tables.header().valid_from;
    let ends = (from, from.plus(Duration::from_ns(DAY_S * SECOND)));
    targets(tables)
        .into_iter()
        .map(|(body, telescope)| {
            let field = tables.mission().calibration_field(telescope, 0).expect("a field");
            let target = tables.ephemeris().body(body).expect("a body");
            Channel::new(scan, tables.sun().expect("a Sun"), target, &field, ends)
        })
        .collect()
}

fn find_transits(tables: &Tables<'_>, tell: &mut Teller) {
    let bins = |spacing, low, high| Bins::new(spacing, low, high).expect("legal bins");
    let divisions = Divisions {
        dwell: bins(Spacing::Linear, 0.0, 20.0),
        revisit: bins(Spacing::Logarithmic, 1.0, 1e6),
        gap: bins(Spacing::Logarithmic, 1.0, 1e6),
    };
    let mission = tables.mission().strategy();
    let origins = origins(tables, &mission);
    let mut channels = channels(tables, &mission);
    let mut memory = vec![TargetVisits::<BINS>::EMPTY; channels.len()];
    let mut log = VisitLog::new(&divisions, &mut memory);
    let mut finder = TransitFinder::new(&mut channels);
    let (mut found, mut steps) = (0, 0);
    loop {
        let step = finder.step();
        let done = step == Step::Done;
        match step {
            Step::Transit(transit) => {
                tell.transit(&transit);
                log.record(transit.channel, &transit).expect("in order");
                found += 1;
            }
            Step::Searched(_) | Step::Done => {}
            Step::Failed { error, .. } => panic!("{error:?}"),
        }
        steps += 1;
        if steps == 200 {
            for (channel, origin) in finder.channels().iter().zip(&origins) {
                tell.record("saved search", &channel.state().to_le_bytes(origin));
            }
            let first = finder.channels()[0].state().to_le_bytes(&origins[0]);
            let last = origins.last().expect("a channel");
            let taken = SearchState::from_le_bytes(&first, last).is_ok();
            tell.word("other search", if taken { 0 } else { 254 });
            tell_saved_visits(&log, tables.header().spacecraft, tell);
        }
        if done {
            break;
        }
    }
    tell.word("steps", steps);
    assert!(found > 10 && steps > 200, "{found} {steps}");
    for visits in log.targets() {
        tell.word("visits", visits.visits.into());
        tell.integer("dwell", visits.dwell_sum.ns());
        tell.integer("longest gap", visits.longest_gap.map_or(-1, Duration::ns));
        for (dwells, revisits) in visits.dwell.counts.into_iter().zip(visits.revisit.counts) {
            tell.word("dwells", dwells.into());
            tell.word("revisits", revisits.into());
        }
    }
}

fn tell_saved_visits(log: &VisitLog<'_, BINS>, spacecraft: u32, tell: &mut Teller) {
    for (target, visits) in (0_u32..).zip(log.targets()) {
        let mut record = vec![0; visits_record_bytes(BINS)];
        visits.to_record(log.divisions(), target, spacecraft, &mut record).expect("its length");
        tell.record("saved visits", &record);
    }
    tell.word("other spacecraft", 253);
}

struct Day<'a> {
    tables: Tables<'a>,
    clock: ClockCorrelation,
    mission: ScanStrategy,
    believed: ScanStrategy,
    tracker: Tracker,
    sequencer: Sequencer,
    events: EventQueue<64>,
    /// What the last tick brought.
    last: Option<Tick>,
}

impl<'a> Day<'a> {
    fn prepare(tables: &Tables<'a>, clock: ClockCorrelation) -> Self {
        let mission = tables.mission().strategy();
        let own = *mission.parameters();
        let spin = Rotor { start: own.spin.start.plus(Phase::from_bits(1 << 46)), ..own.spin };
        let believed = ScanStrategy::new(ScanParameters { spin, ..own }).expect("legal");
        let settings = TrackerSettings {
            angle_sigmas_rad: [1e-3, 1e-4, 1e-3],
            rate_sigmas: [1e-6; 2],
            angle_walks: [0.0; 3],
            rate_walks: [0.0; 2],
            max_age: Duration::from_ns(60 * SECOND),
            max_lead: Duration::from_ns(SECOND),
            gate: 100.0,
            limits_rad: [0.01; 3],
        };
        let from = tables.header().valid_from;
        let mut sequencer = Sequencer::new(Settings {
            telescope: targets(tables)[0].1,
            tolerance: Duration::from_ns(SECOND),
            passes_tolerance: 0,
            longest_gap: Duration::from_ns(2 * CYCLE_S * SECOND),
            check_ahead: Duration::from_ns(3600 * SECOND),
            recheck_rad: 1e-3,
            steps_per_tick: 8,
        })
        .expect("legal settings");
        sequencer.resume();
        Self {
            tables: *tables,
            clock,
            mission,
            believed,
            tracker: Tracker::new(&believed, &settings, from).expect("legal settings"),
            sequencer,
            events: EventQueue::new(),
            last: None,
        }
    }

    fn fly(mut self, tell: &mut Teller) {
        let mut channels = channels(&self.tables, &self.believed);
        let mut next = vec![None; channels.len()];
        let mut forecast = Forecast::new(&mut channels, &mut next);
        let mut scrub = Scrub::new(&self.tables);
        let mut going = true;
        let (mut started, mut forecasts) = (0, 0);
        for second in (0..DAY_S).step_by(CYCLE_S as usize) {
            let ticks = FIRST_TICK + second as u64 * TICKS_PER_S;
            let now = self.clock.instant(ticks).expect("the clock is valid");
            tell.word(
                "scrub",
                match scrub.step() {
                    ScrubStep::GoesOn => 1,
                    ScrubStep::RoundOver => 2,
                    ScrubStep::Damaged(error) => panic!("{error:?}"),
                },
            );
            if second == DAY_S / 2 {
                let spacecraft = self.tables.header().spacecraft;
                tell.record("saved tracker", &self.tracker.state().to_le_bytes(spacecraft));
                tell.word("damaged tracker", 251);
            }
            if second % 60 == 0 {
                self.measure(now, tell);
            }
            if going {
                match forecast.step(|at| self.tracker.covariance_at(at)) {
                    ForecastStep::Found(target) => {
                        let next = forecast.next()[target].expect("it was found");
                        tell.word("forecast of", target as u64);
                        tell.transit(&next.transit);
                        tell.real("entry's sigma", next.confidence.entry_sigma_s);
                        tell.real("probability", next.confidence.probability);
                        tell.integer("earliest entry", next.confidence.earliest_entry.tai_ns());
                        forecasts += 1;
                    }
                    ForecastStep::Searched(_) => {}
                    ForecastStep::Done => going = false,
                    ForecastStep::Failed { error, .. } => panic!("{error:?}"),
                }
            }
            started += self.tick(ticks, false, tell);
            if second % 3600 == 0 {
                let next = forecast.next()[0];
                self.report(ticks, next.as_ref(), (&scrub, (second / 3600) as u16), tell);
            }
        }
        // Damage to the last section, which the scrub must find.
        tell.word("longest", scrub.longest().into());
        tell.word("found", 3);
        tell.word("damage", 27);
        self.tick(FIRST_TICK + DAY_S as u64 * TICKS_PER_S, true, tell);
        tell.word("lost", self.events.lost().total().into());
        assert!(started > 0 && forecasts > 0 && !going, "{started} {forecasts} {going}");
    }

    /// Housekeeping in a packet.
    fn report(
        &self,
        ticks: u64,
        next: Option<&NextVisit>,
        (scrub, count): (&Scrub<'_>, u16),
        tell: &mut Teller,
    ) {
        let (telescope, spacecraft) = (targets(&self.tables)[0].1, self.tables.header().spacecraft);
        let origin = Origin::new(spacecraft, telescope, ticks, Some(&self.clock));
        let housekeeping = Housekeeping {
            origin,
            tick: self.last.expect("after a tick"),
            tables: Some(TablesInUse::of(&self.tables)),
            tables_damaged: false,
            clock: Some(ClockInUse::of(&self.clock)),
            lost: self.events.lost(),
            tracker: Some(TrackerHealth::of(&self.tracker, origin.at.expect("a valid clock"))),
            scrub: Some(scrub.progress()),
            visit: next.map(|next| VisitToCome::of(next, 0)),
        };
        let data_bytes_less_one = HOUSEKEEPING_BYTES as u16 - 1;
        let header =
            PacketHeader { apid: 291, secondary_header: false, count, data_bytes_less_one };
        let packet = [&header.to_be_bytes()[..], &housekeeping.to_be_bytes()].concat();
        tell.record("packet", &packet);
    }

    fn measure(&mut self, now: Instant, tell: &mut Teller) {
        let sun = self.tables.sun().expect("a Sun");
        let seen = attitude(&self.mission, &sun, now).expect("the Sun is known");
        let attitude = Rotation::from_xyzw(seen.to_xyzw()).expect("a rotation");
        let measurement = Measurement { at: now, attitude, sigma_rad: 1e-5 };
        let residuals = self.tracker.update(&sun, &measurement, now).expect("accepted");
        tell.reals("innovation", residuals.innovation_rad);
        tell.real("chi2", residuals.chi2);
        tell.reals("variance", self.tracker.covariance_at(now).variances);
    }

    /// Sessions that began.
    fn tick(&mut self, ticks: u64, tables_damaged: bool, tell: &mut Teller) -> u32 {
        let situation = Situation {
            ticks,
            clock: Some(&self.clock),
            tables: Some(&self.tables),
            tables_damaged,
            scan: ScanEstimate::Tracked(&self.tracker),
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        self.last = Some(tick);
        tell.state(tick.state);
        tell.word("evaluations", tick.evaluations.into());
        tell.word(
            "check",
            match tick.check {
                Progress::Waiting => 1,
                Progress::UnderWay => 2,
                Progress::Done => 3,
            },
        );
        let mut started = 0;
        let (telescope, spacecraft) = (targets(&self.tables)[0].1, self.tables.header().spacecraft);
        while let Some(stamped) = self.events.pop() {
            let report = EventReport::new(&stamped, spacecraft, telescope, Some(&self.clock));
            tell.record("telemetry", &report.to_be_bytes());
            let (kind, session, (reason, value)) = match stamped.event {
                Event::Entered(_) => (1, 0, (0, 0)),
                Event::Started(session, _) => (2, session, (0, 0)),
                Event::Ended(session) => (3, session, (0, 0)),
                Event::Skipped(session, why) => (4, session, skip(why)),
                Event::Aborted(session, AbortReason::Safe) => (5, session, (200, 0)),
                Event::Safe(why) => (6, 0, safe(why)),
                Event::Tables(sequence) => (7, 0, (0, sequence.into())),
                other => panic!("not on this flight: {other:?}"),
            };
            tell.word("event", kind);
            tell.word("event's ticks", stamped.ticks);
            tell.word("event's session", session.into());
            tell.word("event's reason", reason);
            tell.integer("event's value", value);
            match stamped.event {
                Event::Entered(state) => tell.state(state),
                Event::Started(_, record) => {
                    tell.integer("event's end", record.end.tai_ns());
                    started += 1;
                }
                _ => {}
            }
        }
        started
    }
}
