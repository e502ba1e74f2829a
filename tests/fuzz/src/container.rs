//! Whole containers: parsed, loaded, searched for transits, and carried out by a sequencer.

use crate::ephemeris::instants;
use crate::{ephemeris, mission, plan, repair};
use onboard_core::attitude::attitude;
use onboard_core::clock::ClockCorrelation;
use onboard_core::sequencer::{
    EventQueue, MAX_EVALUATIONS_PER_TICK, ScanEstimate, Sequencer, Settings, Situation,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::transit::{Channel, MAX_EVALUATIONS_PER_STEP, Step, TransitFinder};
use onboard_core::uplink::{Container, ENTRY_BYTES, HEADER_BYTES, SectionKind, Tables};
use tests::Noise;
use tests::campaign::SETTINGS;

const STEPS: usize = 12;
const CHANNELS: usize = 3;
const TICKS: i64 = 4;
const KINDS: [SectionKind; 3] = [SectionKind::Ephemeris, SectionKind::Mission, SectionKind::Plan];

/// Reads the bytes as a container, as they are and repaired.
pub fn run(data: &[u8]) {
    check(data);
    check(&repair::container(data));
}

fn check(data: &[u8]) {
    let Ok(container) = Container::parse(data) else {
        assert!(Tables::load(data).is_err());
        return;
    };
    check_bytes(&container, data);
    let seed = container.set_digest();
    let bit = (seed % (data.len() as u64 * 8)) as usize;
    let mut flipped = data.to_vec();
    flipped[bit / 8] ^= 1 << (bit % 8);
    assert!(Container::parse(&flipped).is_err(), "bit {bit} flipped unseen");
    if let Ok(tables) = Tables::load(data) {
        ephemeris::check(tables.ephemeris(), seed);
        mission::check(tables.mission(), seed);
        plan::check(tables.plan(), seed);
        look(&tables, seed);
        search(&tables);
        carry_out(&tables, seed);
    }
}

/// A container of sections that are known comes back from the encoder.
fn check_bytes(container: &Container<'_>, data: &[u8]) {
    let sections = usize::from(data[10]);
    let directory = data[HEADER_BYTES..].chunks(ENTRY_BYTES).take(sections);
    let kinds = directory.map(|entry| u16::from_le_bytes([entry[0], entry[1]]));
    let known = |kind: u16| KINDS.into_iter().find(|it| it.number() == kind);
    let contents: Option<Vec<(SectionKind, &[u8])>> = kinds
        .map(|kind| known(kind).and_then(|it| Some((it, container.section(it).ok()?))))
        .collect();
    if let Some(contents) = contents {
        assert_eq!(tests::uplink::container(&container.header(), &contents), data);
    }
}

fn look(tables: &Tables<'_>, seed: u64) {
    let header = tables.header();
    let scan = tables.mission().strategy();
    let sun = tables.sun().expect("ruled out by loading");
    for at in instants(&[header.valid_from, header.valid_until], seed) {
        if let Ok(look) = attitude(&scan, &sun, at) {
            assert!(look.to_xyzw().iter().all(|it| it.is_finite()), "no attitude at {at:?}");
        }
    }
}

/// Some steps of a search for every session's target, or for the first bodies without a plan.
fn search(tables: &Tables<'_>) {
    let header = tables.header();
    let planned = tables.plan().sessions().map(|it| (it.body, it.telescope, it.first_entry));
    let bodies = tables.ephemeris().spans().map(|it| (it.body, 0, header.valid_from));
    let mut channels = Vec::new();
    for (number, telescope, from) in planned.chain(bodies).take(CHANNELS) {
        let Some(field) = tables.mission().calibration_field(telescope, 0) else { continue };
        let Ok(body) = tables.ephemeris().body(number) else { continue };
        let scan = tables.mission().strategy();
        let Ok(sun) = tables.sun() else { continue };
        let span = (from, header.valid_until);
        channels.push(Channel::new(&scan, sun, body, &field, span));
    }
    let mut finder = TransitFinder::new(&mut channels);
    let mut before = 0;
    for _ in 0..STEPS {
        let step = finder.step();
        let after: u64 = finder.channels().iter().map(Channel::evaluations).sum();
        assert!(after - before <= u64::from(MAX_EVALUATIONS_PER_STEP));
        before = after;
        match step {
            Step::Transit(it) => {
                assert!(it.entry <= it.closest && it.closest <= it.exit, "{it:?}");
            }
            Step::Searched(_) => {}
            Step::Done | Step::Failed { .. } => break,
        }
    }
}

/// Some ticks of a sequencer about the first session, or anywhere in the validity.
fn carry_out(tables: &Tables<'_>, seed: u64) {
    let first = tables.plan().session(0);
    let at = first.map_or(tables.header().valid_from, |session| session.start);
    let clock = ClockCorrelation {
        sequence: 1,
        spacecraft: tables.header().spacecraft,
        uncertainty_ns: 0,
        ticks: 0,
        at,
        tick_bits: ClockCorrelation::tick_of(1_000_000_000, 0),
        valid_from: Instant::from_tai_ns(i64::MIN),
        valid_until: Instant::from_tai_ns(i64::MAX),
    };
    let telescope = first.map_or(0, |session| session.telescope);
    let check_ahead = Duration::from_ns(i64::MAX);
    let settings = Settings { telescope, check_ahead, ..SETTINGS };
    let Ok(mut sequencer) = Sequencer::new(settings) else { return };
    sequencer.resume();
    let mut events = EventQueue::<8>::new();
    let mut noise = Noise::new(seed);
    for tick in -TICKS / 2..TICKS / 2 {
        let jump = if noise.bits().is_multiple_of(4) { noise.bits() as i64 >> 20 } else { 0 };
        let situation = Situation {
            ticks: (tick * 10 + jump).cast_unsigned(),
            clock: Some(&clock),
            tables: Some(tables),
            tables_damaged: false,
            scan: ScanEstimate::Mission,
        };
        let told = sequencer.tick(&situation, &mut events);
        assert!(told.evaluations <= MAX_EVALUATIONS_PER_TICK);
    }
}
