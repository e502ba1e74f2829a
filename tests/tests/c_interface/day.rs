//! The day of `onboard-core/c/examples/day.c`, flown with the flight core itself.
//!
//! It follows the C program function by function, in the same order and with the same numbers, and
//! tells the same lines.

use clap::Parser;
use ground_tools::cli::Cli;
use onboard_core::attitude::{attitude, sweep};
use onboard_core::clock::{CLOCK_BYTES, ClockCorrelation};
use onboard_core::forecast::{Forecast, ForecastStep};
use onboard_core::frame::{Boresight, Detector};
use onboard_core::hwp::hwp_phase;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::sequencer::{
    Event, EventQueue, SafeReason, Sequencer, Settings, Situation, SkipReason, State,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::tracking::{Measurement, Tracker, TrackerSettings};
use onboard_core::transit::{Channel, Step, Transit, TransitFinder};
use onboard_core::uplink::{Slot, Slots, Tables};
use onboard_core::visits::{Bins, Divisions, Spacing, TargetVisits, VisitLog};
use std::fmt::Write;

const SECOND: i64 = 1_000_000_000;
const CYCLE_S: i64 = 10;
const DAY_S: i64 = 86_400;
const FIRST_TICK: u64 = 1000;
const TICKS_PER_S: u64 = 1_000_000;
const CHANNELS: usize = 8;
const BINS: usize = 20;

/// A day: what it is flown with, and what it tells.
pub struct Flown {
    pub container: Vec<u8>,
    pub clock_record: [u8; CLOCK_BYTES],
    pub told: String,
}

#[derive(Default)]
struct Teller(String);

impl Teller {
    fn word(&mut self, name: &str, word: u64) {
        writeln!(self.0, "{name} {word:016x}").expect("a String takes everything");
    }

    fn integer(&mut self, name: &str, value: i64) {
        self.word(name, value as u64);
    }

    fn real(&mut self, name: &str, value: f64) {
        self.word(name, value.to_bits());
    }

    fn reals(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.real(name, value));
    }

    fn transit(&mut self, transit: &Transit) {
        self.word("channel", transit.channel as u64);
        self.integer("entry", transit.entry.tai_ns());
        self.integer("closest", transit.closest.tai_ns());
        self.integer("exit", transit.exit.tai_ns());
        self.real("separation", transit.min_separation_rad);
        let clipped = u64::from(transit.entry_clipped) * 2 + u64::from(transit.exit_clipped);
        self.word("clipped", clipped);
    }

    fn state(&mut self, state: State) {
        let (kind, session, reason, value) = match state {
            State::Idle => (1, 0, 0, 0),
            State::Setup(session) => (2, session, 0, 0),
            State::Calibrating(session) => (3, session, 0, 0),
            State::Cooldown(session) => (4, session, 0, 0),
            State::Safe(why) => {
                let (reason, value) = safe(why);
                (5, 0, reason, value)
            }
        };
        self.word("state", kind);
        self.word("state's session", session.into());
        self.word("state's reason", reason);
        self.integer("state's value", value);
    }
}

/// The code and the value of a reason; the flight meets few of them.
fn safe(reason: SafeReason) -> (u64, i64) {
    match reason {
        SafeReason::Commanded => (160, 0),
        SafeReason::NoClock => (161, 0),
        SafeReason::NoTables => (162, 0),
        SafeReason::TablesNotYetValid(from) => (163, from.tai_ns()),
        SafeReason::TablesExpired(until) => (164, until.tai_ns()),
        other => panic!("not on this flight: {other:?}"),
    }
}

fn skip(reason: SkipReason) -> (u64, i64) {
    match reason {
        SkipReason::Missed => (180, 0),
        SkipReason::Overlap => (181, 0),
        SkipReason::NotChecked => (182, 0),
        SkipReason::NoPass => (183, 0),
        SkipReason::Entry(by) => (184, by.ns()),
        SkipReason::Exit(by) => (185, by.ns()),
        SkipReason::Passes(number) => (186, number.into()),
        SkipReason::Avoidance(body) => (187, body.into()),
        SkipReason::Ephemeris(error) => panic!("not on this flight: {error:?}"),
    }
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
        uncertainty_ns: 0,
        ticks: FIRST_TICK,
        at: header.valid_from,
        tick_bits: ClockCorrelation::tick_of(SECOND as u64 / TICKS_PER_S, 0),
        valid_from: header.valid_from,
        valid_until: header.valid_until,
    };
    let mut tell = Teller::default();
    take_tables(&container, &mut tell);
    // Null twice, memory that is no state twice, beyond the tables.
    for (refused, code) in
        [("null", 1), ("no place", 1), ("never made", 4), ("copied", 4), ("out of span", 44)]
    {
        tell.word(refused, code);
    }
    show_attitudes(&tables, &mut tell);
    find_transits(&tables, &mut tell);
    Day::prepare(&tables, clock).fly(&mut tell);
    tell.word("unloaded", 4);
    let told = tell.0;
    Ok(Flown { clock_record: clock.to_le_bytes(), told, container })
}

fn take_tables(container: &[u8], tell: &mut Teller) {
    let slots = Slots { a: container, b: &[] };
    let active = slots.active().expect("tables");
    let tables = active.tables;
    let header = tables.header();
    tell.word("slot", u64::from(active.slot == Slot::B));
    tell.word("sequence", header.sequence.into());
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
    let mut channels = channels(tables, &tables.mission().strategy());
    let mut memory = vec![TargetVisits::<BINS>::EMPTY; channels.len()];
    let mut log = VisitLog::new(&divisions, &mut memory);
    let mut finder = TransitFinder::new(&mut channels);
    let mut found = 0;
    loop {
        match finder.step() {
            Step::Transit(transit) => {
                tell.transit(&transit);
                log.record(transit.channel, &transit).expect("in order");
                found += 1;
            }
            Step::Searched(_) => {}
            Step::Done => break,
            Step::Failed { error, .. } => panic!("{error:?}"),
        }
    }
    assert!(found > 10, "{found}");
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

struct Day<'a> {
    tables: Tables<'a>,
    clock: ClockCorrelation,
    mission: ScanStrategy,
    believed: ScanStrategy,
    tracker: Tracker,
    sequencer: Sequencer,
    events: EventQueue<64>,
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
        }
    }

    fn fly(mut self, tell: &mut Teller) {
        let mut channels = channels(&self.tables, &self.believed);
        let mut next = vec![None; channels.len()];
        let mut forecast = Forecast::new(&mut channels, &mut next);
        let mut going = true;
        let (mut started, mut forecasts) = (0, 0);
        for second in (0..DAY_S).step_by(CYCLE_S as usize) {
            let ticks = FIRST_TICK + second as u64 * TICKS_PER_S;
            let now = self.clock.instant(ticks).expect("the clock is valid");
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
            started += self.tick(ticks, tell);
        }
        tell.word("dropped", self.events.dropped().into());
        assert!(started > 0 && forecasts > 0 && !going, "{started} {forecasts} {going}");
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
    fn tick(&mut self, ticks: u64, tell: &mut Teller) -> u32 {
        let situation = Situation {
            ticks,
            clock: Some(&self.clock),
            tables: Some(&self.tables),
            strategy: Some(self.tracker.strategy()),
        };
        let tick = self.sequencer.tick(&situation, &mut self.events);
        tell.state(tick.state);
        tell.word("evaluations", tick.evaluations.into());
        let mut started = 0;
        while let Some(stamped) = self.events.pop() {
            let (kind, session, (reason, value)) = match stamped.event {
                Event::Entered(_) => (1, 0, (0, 0)),
                Event::Started(session, _) => (2, session, (0, 0)),
                Event::Ended(session) => (3, session, (0, 0)),
                Event::Skipped(session, why) => (4, session, skip(why)),
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
