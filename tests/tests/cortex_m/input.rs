//! The vector file: presets, rotation directions, instants over ten years, transits, damaged tables.
//!
//! Missions, containers and the ephemeris are the ground's own; the layout is in `tests/firmware`.

use crate::{comparison, sequencer, services, slots};
use ephem::fit::FitOptions;
use formats::uplink::Contents;
use libtest_mimic::Failed;
use mission::presets;
use mission::{Mission, Override};
use onboard_core::detector::detector_at;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::rotation::Rotation;
use onboard_core::time::Instant;
use onboard_core::uplink::{Container, SectionKind, SessionRecord};
use planner::world::World;
use tests::Noise;

/// A day in ns.
pub const NS_PER_DAY: i64 = 86_400_000_000_000;
const TEN_YEARS: &str = "span.duration_days=3652.5";
/// A month of a mission.
pub const ONE_MONTH: &str = "span.duration_days=30";
/// Senses of precession and spin.
const SENSES: [(i8, i8); 4] = [(1, 1), (1, -1), (-1, 1), (-1, -1)];

/// A vector file, and the names of its blocks.
#[derive(Debug, Default)]
pub struct Input {
    /// The file.
    pub bytes: Vec<u8>,
    /// A name per block.
    pub names: Vec<String>,
}

impl Input {
    /// Adds a block.
    pub fn block(&mut self, kind: u32, name: &str, payload: &[u8]) {
        self.bytes.extend(kind.to_le_bytes());
        self.bytes.extend(sized(payload));
        self.names.push(name.to_owned());
    }
}

/// The bytes behind their number.
pub fn sized(bytes: &[u8]) -> Vec<u8> {
    let length = u32::try_from(bytes.len()).expect("a block of less than 4 GiB");
    [&length.to_le_bytes()[..], bytes].concat()
}

/// Tables fitted once: presets have the same sky, start and targets.
#[derive(Debug)]
pub struct Tables {
    /// Sun and five planets over ten years, 1 mas.
    decade: Vec<u8>,
    /// The same over a month.
    pub month: Vec<u8>,
}

impl Tables {
    /// Fits them.
    pub fn fit() -> Self {
        let fitted = |span| {
            let tables = world("litebird", &[span]).tables(&FitOptions::UPLINK);
            tables.expect("the embedded kernel covers the span").fitted.bytes
        };
        Self { decade: fitted(TEN_YEARS), month: fitted(ONE_MONTH) }
    }
}

/// A preset with settings, among the planets.
pub fn world(preset: &str, settings: &[&str]) -> World {
    let set = |text: &&str| Override::set(text).expect("a key and a value");
    let overrides: Vec<Override> = settings.iter().map(set).collect();
    let mission = Mission::load(preset, &overrides).expect("a preset");
    World::open(mission, None).expect("the embedded kernel covers the span")
}

/// The container of a world.
pub fn container(world: &World, ephemeris: &[u8], sessions: Option<&[SessionRecord]>) -> Vec<u8> {
    let contents = Contents { world, ephemeris, sessions, sequence: 1 };
    contents.to_bytes().expect("small enough for the format")
}

fn detector_bytes(detector: Rotation<Detector, Boresight>) -> Vec<u8> {
    detector.to_xyzw().iter().flat_map(|component| component.to_le_bytes()).collect()
}

/// `count` distinct instants: both ends of the span, and one in each part between.
fn instants(world: &World, count: usize, noise: &mut Noise) -> Vec<u8> {
    let (start, end) = (world.start.tai_ns(), world.end.tai_ns());
    let part = (end - start) / count as i64;
    let inner = (1..count as i64 - 1)
        .map(|index| start + part * index + (noise.bits() % part as u64) as i64);
    [start].into_iter().chain(inner).chain([end]).flat_map(i64::to_le_bytes).collect()
}

fn attitude_block(world: &World, ephemeris: &[u8], count: usize, noise: &mut Noise) -> Vec<u8> {
    let detector = detector_at(0.25 * noise.unit(), 6.0 * noise.unit(), 6.0 * noise.unit());
    let container = sized(&container(world, ephemeris, None));
    [container, detector_bytes(detector), instants(world, count, noise)].concat()
}

/// Everything that runs on the targets; `per_case` instants for each preset and senses.
pub fn vectors(tables: &Tables, per_case: usize) -> Input {
    let mut input = Input::default();
    let mut noise = Noise::new(3);
    for preset in presets::NAMES {
        for (precession, spin) in SENSES {
            let senses =
                [format!("scan.precession_sign={precession}"), format!("scan.spin_sign={spin}")];
            let world = world(preset, &[TEN_YEARS, &senses[0], &senses[1]]);
            let name = format!("{preset}, precession {precession:+}, spin {spin:+}");
            let block = attitude_block(&world, &tables.decade, per_case, &mut noise);
            input.block(1, &name, &block);
        }
    }
    let circular = world("litebird", &[TEN_YEARS, "orbit.sun=circular"]);
    let block = attitude_block(&circular, &tables.decade, 1_000, &mut noise);
    input.block(1, "litebird, circular Sun", &block);
    ephemeris_blocks(tables, &mut noise, &mut input);
    transit_blocks(tables, &mut input);
    table_blocks(tables, &mut input);
    sequencer::blocks(&mut input);
    slots::block(&mut input);
    services::blocks(tables, &mut input);
    input
}

fn ephemeris_blocks(tables: &Tables, noise: &mut Noise, input: &mut Input) {
    let world = world("litebird", &[TEN_YEARS]);
    let mut block = sized(&container(&world, &tables.decade, None));
    block.extend(instants(&world, 1_000, noise));
    for outside in [i64::MIN, world.start.tai_ns() - 1, world.end.tai_ns() + NS_PER_DAY, i64::MAX] {
        block.extend(outside.to_le_bytes());
    }
    input.block(2, "every body", &block);
}

fn transit_blocks(tables: &Tables, input: &mut Input) {
    for (preset, senses) in [("litebird", "1"), ("pico", "-1")] {
        let world = world(preset, &[ONE_MONTH, &format!("scan.spin_sign={senses}")]);
        let mut block = sized(&container(&world, &tables.month, None));
        block.extend(world.start.tai_ns().to_le_bytes());
        block.extend(world.end.tai_ns().to_le_bytes());
        // Half a degree about the line of sight for every planet; the whole field for two.
        for body in [4, 5, 6, 7, 8] {
            channel(body, 0.5_f64.to_radians(), &mut block);
        }
        for body in [5, 6] {
            channel(body, 0.0, &mut block);
        }
        input.block(3, &format!("transits of {preset}"), &block);
    }
}

/// A channel of a search on the first telescope.
pub fn channel(body: i32, radius_rad: f64, block: &mut Vec<u8>) {
    block.extend(body.to_le_bytes());
    block.extend(0_u32.to_le_bytes());
    block.extend(radius_rad.to_le_bytes());
}

fn table_blocks(tables: &Tables, input: &mut Input) {
    let world = world("litebird", &[ONE_MONTH]);
    let sessions: Vec<SessionRecord> = (0..4)
        .map(|index| {
            let at = |days: i64| Instant::from_tai_ns(world.start.tai_ns() + days * NS_PER_DAY);
            SessionRecord {
                start: at(index),
                end: at(index + 4),
                first_entry: at(index + 1),
                last_exit: at(index + 3),
                body: 5,
                turn: 7,
                telescope: 1,
                passes: 9,
            }
        })
        .collect();
    let whole = container(&world, &tables.month, Some(&sessions));
    input.block(4, "damaged containers", &[sized(&whole), damage(&whole, 101)].concat());
    let parsed = Container::parse(&whole).expect("a good container");
    for (kind, name) in [
        (SectionKind::Ephemeris, "damaged ephemeris"),
        (SectionKind::Mission, "damaged mission"),
        (SectionKind::Plan, "damaged plan"),
    ] {
        let section = parsed.section(kind).expect("the section is there");
        let number = u32::from(kind.number()).to_le_bytes();
        let stride = if kind == SectionKind::Ephemeris { 13 } else { 1 };
        let block = [&number[..], &sized(section), &damage(section, stride)].concat();
        input.block(5, name, &block);
    }
}

/// Edits that damage `whole`: every bit of the first 160 bytes, every `stride`th bit behind them, and
/// cuts at every 37th byte.
fn damage(whole: &[u8], stride: usize) -> Vec<u8> {
    let length = u32::try_from(whole.len()).expect("a short table");
    let mut edits = Vec::new();
    let mut edit = |keep: u32, offset: u32, flip: u32| {
        for number in [keep, offset, flip] {
            edits.extend(number.to_le_bytes());
        }
    };
    let bits = length * 8;
    for bit in (0..bits.min(1280)).chain((1280..bits).step_by(stride)) {
        edit(length, bit / 8, 1 << (bit % 8));
    }
    for keep in (0..length).step_by(37) {
        edit(keep, 0, 0);
    }
    edits
}

/// A file of one block with three instants.
pub fn small() -> Input {
    let mut input = Input::default();
    let world = world("litebird", &[ONE_MONTH]);
    let ephemeris = world.tables(&FitOptions::UPLINK).expect("a table").fitted.bytes;
    let block = attitude_block(&world, &ephemeris, 3, &mut Noise::new(1));
    input.block(1, "litebird", &block);
    input
}

/// What the instructions are counted on: `LiteBIRD` over ten years, then ten days of transits.
pub fn metered(tables: &Tables) -> Input {
    let world = world("litebird", &[TEN_YEARS]);
    let detector = detector_at(0.1, 0.7, 0.3);
    let mut block = sized(&container(&world, &tables.decade, None));
    block.extend(detector_bytes(detector));
    block.extend(sized(&instants(&world, 1_024, &mut Noise::new(5))));
    let until = world.start.tai_ns() + 10 * NS_PER_DAY;
    block.extend(world.start.tai_ns().to_le_bytes());
    block.extend(until.to_le_bytes());
    // The field of view of a telescope, 18 by 8 deg, meets planets that half a degree misses.
    for body in [4, 5, 6, 7, 8] {
        channel(body, 0.0, &mut block);
    }
    let mut input = Input::default();
    input.block(16, "instructions", &block);
    let services = [sequencer::metered(), services::metered(tables)].concat();
    input.block(17, "instructions of services", &services);
    input
}

/// Fields, and what must be told in them.
const TOLD: [(&[&str], &[&str]); 6] = [
    (
        &["event"],
        &[
            "Started(",
            "Ended(",
            "Setup(",
            "Calibrating(",
            "Cooldown(",
            "Idle",
            "Missed",
            "Overlap",
            "Entry(",
            "Passes(",
            "Aborted(",
            "NoClock",
            "Expired",
            "NoTables",
            "Commanded",
            "TimeReversed",
            "TimeJumped",
            "Tables(3)",
        ],
    ),
    (&["admitted"], &["A", "B"]),
    (
        &["not admitted", "no tables", "slot refused"],
        &["Unsound", "Older", "Expired", "NotYetValid", "TooLong", "Revoked"],
    ),
    (&["rolled back"], &["B"]),
    (
        &["order", "not rolled back"],
        &["NotAnOrder", "Damaged", "NotBack", "OrderExpired", "NotActive", "NothingToReturnTo"],
    ),
    (&["measurement refused"], &["Outlier", "Stale", "NotAfter", "Future", "Sigma"]),
];

/// Every preset and pair of senses is there with distinct instants over ten years, and the tables
/// that are refused are refused for many reasons.
pub fn covers_what_it_must() -> Result<(), Failed> {
    let tables = Tables::fit();
    let input = vectors(&tables, 100);
    for preset in presets::NAMES {
        for (precession, spin) in SENSES {
            let name = format!("{preset}, precession {precession:+}, spin {spin:+}");
            if !input.names.contains(&name) {
                return Err(format!("no vectors of {name}").into());
            }
        }
    }
    let fields = comparison::fields(&input)?;
    for (field, least) in [
        ("attitude.x", 2_500),
        ("hwp phase", 1_000),
        ("rate.x", 6_000),
        ("state refused", 20),
        ("entry", 100),
        ("container refused", 2_000),
        ("ephemeris refused", 100),
        ("mission refused", 100),
        ("plan refused", 100),
        ("sequencer's state", 20_000),
        ("event", 1_000),
        ("active slot", 20),
        ("slot refused", 10),
        ("admitted", 10),
        ("rolled back", 3),
        ("clock's instant", 5),
        ("clock refused", 3),
        ("chi^2", 150),
        ("measurement refused", 50),
        ("probability", 50),
        ("least angle", 50),
    ] {
        let found = fields.get(field).copied().unwrap_or(0);
        if found < least {
            return Err(format!("{found} words of '{field}', at least {least} wanted").into());
        }
    }
    for (fields, told) in TOLD {
        let texts = comparison::texts(&input, fields)?;
        if let Some(missing) = told.iter().find(|it| !texts.contains(**it)) {
            return Err(format!("no '{missing}' in {fields:?}").into());
        }
    }
    comparison::fields(&metered(&tables))?;
    let world = world("litebird", &[TEN_YEARS]);
    let times = instants(&world, 10_000, &mut Noise::new(3));
    let times: Vec<i64> =
        times.as_chunks::<8>().0.iter().map(|bytes| i64::from_le_bytes(*bytes)).collect();
    assert!(times.is_sorted_by(|a, b| a < b), "instants are distinct");
    assert_eq!(times.len(), 10_000);
    assert_eq!(times[9_999] - times[0], 36_525 * NS_PER_DAY / 10);
    Ok(())
}
