//! The tables of `docs/telemetry.md` against the code: the page's offsets and types read back what was
//! written, its tables name every kind, state and reason that there is and no other, and the ground's
//! words are the page's.
//!
//! Requirements: REQ-TLM-1, REQ-TLM-3.

use formats::telemetry::{KINDS, REASONS, STATES, Value};
use onboard_core::sequencer::{Event, Lost, Progress, SafeReason, SkipReason, State, Tick};
use onboard_core::telemetry::{
    ClockInUse, EVENT_BYTES, EventReport, HOUSEKEEPING_BYTES, Housekeeping, Origin, Payload,
    TablesInUse, TelemetryError, TrackerHealth, VisitToCome,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::uncertainty::ScanCovariance;
use onboard_core::uplink::{ScrubProgress, SessionRecord, checksum};
use std::collections::BTreeMap;
use std::path::Path;

/// A field of the page.
#[derive(Debug)]
struct Field {
    name: String,
    bytes: std::ops::Range<usize>,
    kind: String,
}

fn page() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(root.join("../docs/telemetry.md")).unwrap()
}

/// The cells of the tables below a heading, without their heads.
fn rows(heading: &str) -> Vec<Vec<String>> {
    let page = page();
    let (_, behind) = page.split_once(&format!("\n## {heading}")).expect("the heading");
    let section = behind.split_once("\n## ").map_or(behind, |it| it.0);
    let lines: Vec<&str> = section.lines().collect();
    let is_head = |index: usize| lines.get(index + 1).is_some_and(|next| next.starts_with("|---"));
    let cells = |line: &str| {
        let inner = line.trim_start_matches('|').trim_end_matches('|');
        inner.split('|').map(|cell| cell.trim().replace('`', "")).collect()
    };
    (0..lines.len())
        .filter(|index| lines[*index].starts_with("| ") && !is_head(*index))
        .map(|index| cells(lines[index]))
        .collect()
}

/// The fields below these headings, which follow one another without gaps.
fn fields(headings: [&str; 2], length: usize) -> Vec<Field> {
    let mut at = 0;
    let rows = headings.into_iter().flat_map(rows);
    let found: Vec<Field> = rows
        .map(|row| {
            let (from, to) = row[0].split_once("..").expect("a range");
            let bytes = from.parse().unwrap()..to.parse().unwrap();
            assert_eq!(bytes.start, at, "{row:?}");
            at = bytes.end;
            let width = match row[2].as_str() {
                "u8" => 1,
                "u16" => 2,
                "u32" | "i32" => 4,
                "u64" | "i64" | "f64" => 8,
                other => panic!("{other} is no type"),
            };
            assert_eq!(bytes.len(), width, "{row:?}");
            Field { name: row[1].clone(), bytes, kind: row[2].clone() }
        })
        .collect();
    assert_eq!(at, length);
    found
}

/// What a field holds: a number by its sign, or the bits of an f64.
fn value(field: &Field, payload: &[u8]) -> i128 {
    let bytes = &payload[field.bytes.clone()];
    let word = bytes.iter().fold(0_u64, |word, byte| word << 8 | u64::from(*byte));
    match field.kind.as_str() {
        "i32" => i128::from((word as u32).cast_signed()),
        "i64" => i128::from(word.cast_signed()),
        _ => i128::from(word),
    }
}

fn check(fields: &[Field], payload: &[u8], expected: &[(&str, i128)]) {
    let expected: BTreeMap<&str, i128> = expected.iter().copied().collect();
    for field in fields {
        let held = value(field, payload);
        if field.name == "crc" {
            assert_eq!(held, i128::from(checksum(&payload[..field.bytes.start])));
        } else {
            let should = expected.get(field.name.as_str()).copied().unwrap_or(0);
            assert_eq!(held, should, "{field:?}");
        }
    }
    let names: Vec<_> = fields.iter().map(|it| it.name.as_str()).collect();
    assert!(expected.keys().all(|name| names.contains(name)), "{names:?}");
}

const AT: Instant = Instant::from_tai_ns(-7);
const ORIGIN: Origin =
    Origin { spacecraft: 0x8765_4321, telescope: 513, ticks: u64::MAX - 4, at: Some(AT) };
const HEAD: [(&str, i128); 5] = [
    ("version", 0xa1),
    ("telescope", 513),
    ("spacecraft", 0x8765_4321),
    ("counter", u64::MAX as i128 - 4),
    ("instant", -7),
];

fn at(ns: i64) -> Instant {
    Instant::from_tai_ns(ns)
}

#[test]
// REQ-TLM-1.
fn an_event_lies_where_the_page_says() {
    let fields = fields(["The head, of every payload", "An event, from byte 48"], EVENT_BYTES);
    let holds = |event, own: &[(&str, i128)]| {
        let payload = EventReport { origin: ORIGIN, event }.to_be_bytes();
        check(&fields, &payload, &[&HEAD[..], &[("there", 1)], own].concat());
    };
    let record = SessionRecord {
        start: at(-11),
        end: at(i64::MAX),
        first_entry: at(13),
        last_exit: at(14),
        body: -15,
        turn: 16,
        telescope: 17,
        passes: 18,
    };
    let session = [
        ("start", -11),
        ("end", i128::from(i64::MAX)),
        ("first-entry", 13),
        ("last-exit", 14),
        ("body", -15),
        ("turn", 16),
        ("session-telescope", 17),
        ("passes", 18),
    ];
    let began = [&[("kind", 2), ("session", 9)][..], &session].concat();
    holds(Event::Started(9, record), &began);
    let expired = SafeReason::TablesExpired(at(-21));
    let entered = [("kind", 1), ("state", 5), ("reason", 164), ("value", -21)];
    holds(Event::Entered(State::Safe(expired)), &entered);
    let off = SkipReason::Entry(Duration::from_ns(-31));
    let skipped = [("kind", 4), ("session", 30), ("reason", 184), ("value", -31)];
    holds(Event::Skipped(30, off), &skipped);
    holds(Event::Tables(u32::MAX), &[("kind", 7), ("value", i128::from(u32::MAX))]);
    let jumped = [("kind", 8), ("value", -41), ("second", 42)];
    holds(Event::TimeJumped { from: at(-41), to: at(42) }, &jumped);
}

/// Variances, covariances, rates, probability and sigma of a report.
const NUMBERS: [f64; 10] = [0.5, -0.25, 1e-300, 4.0, f64::MAX, -0.0, 7.0, 8.0, 0.875, 1e9];

/// Every field another number.
fn full() -> Housekeeping {
    let [_, _, _, _, _, _, rates @ .., probability, sigma] = NUMBERS;
    let (variances, covariances) = NUMBERS[..6].split_at(3);
    Housekeeping {
        origin: ORIGIN,
        tick: Tick { state: State::Cooldown(3), evaluations: 104, check: Progress::Done },
        tables: Some(TablesInUse { sequence: 50, set_digest: 51, valid_until: at(-52) }),
        tables_damaged: true,
        clock: Some(ClockInUse { sequence: 60, uncertainty_ns: 61, valid_until: at(-62) }),
        lost: Lost {
            entered: 70,
            started: 71,
            ended: 72,
            skipped: 73,
            aborted: 74,
            safe: 75,
            tables: 76,
            time_jumped: 77,
        },
        tracker: Some(TrackerHealth {
            epoch: at(-80),
            accepted: 81,
            refused_in_a_row: 82,
            covariance: ScanCovariance {
                variances: variances.try_into().unwrap(),
                covariances: covariances.try_into().unwrap(),
            },
            rate_sigmas_rad_s: rates,
        }),
        scrub: Some(ScrubProgress { at: 90, length: 91 }),
        visit: Some(VisitToCome {
            body: -100,
            entry: at(-101),
            exit: at(102),
            entry_clipped: false,
            exit_clipped: true,
            earliest_entry: at(-103),
            latest_exit: at(104),
            probability,
            entry_sigma_s: sigma,
        }),
    }
}

#[test]
// REQ-TLM-1.
fn housekeeping_lies_where_the_page_says() {
    let headings = ["The head, of every payload", "Housekeeping, from byte 48"];
    let fields = fields(headings, HOUSEKEEPING_BYTES);
    let report = full();
    let words = [
        ("kind", 16),
        ("there", 127),
        ("state", 4),
        ("session", 3),
        ("evaluations", 104),
        ("check", 3),
        ("tables-sequence", 50),
        ("tables-digest", 51),
        ("tables-until", -52),
        ("clock-sequence", 60),
        ("clock-uncertainty", 61),
        ("clock-until", -62),
        ("lost-entered", 70),
        ("lost-started", 71),
        ("lost-ended", 72),
        ("lost-skipped", 73),
        ("lost-aborted", 74),
        ("lost-safe", 75),
        ("lost-tables", 76),
        ("lost-time-jumped", 77),
        ("tracker-epoch", -80),
        ("accepted", 81),
        ("refused", 82),
        ("scrub-at", 90),
        ("scrub-length", 91),
        ("visit-body", -100),
        ("visit-clipped", 2),
        ("visit-entry", -101),
        ("visit-exit", 102),
        ("visit-earliest", -103),
        ("visit-latest", 104),
    ];
    let names = [
        "variance-precession",
        "variance-alpha",
        "variance-spin",
        "covariance-precession-alpha",
        "covariance-precession-spin",
        "covariance-alpha-spin",
        "precession-rate-sigma",
        "spin-rate-sigma",
        "visit-probability",
        "visit-entry-sigma",
    ];
    let bits = NUMBERS.map(|number| i128::from(number.to_bits()));
    let real: Vec<(&str, i128)> = names.into_iter().zip(bits).collect();
    check(&fields, &report.to_be_bytes(), &[&HEAD[..], &words, &real].concat());
    // Nothing there: nothing but the head, the tick and what was lost.
    let bare = Housekeeping {
        origin: Origin { at: None, ..ORIGIN },
        tables: None,
        tables_damaged: false,
        clock: None,
        lost: Lost::NONE,
        tracker: None,
        scrub: None,
        visit: None,
        ..report
    };
    let head = [&HEAD[..4], &words[..1], &words[2..6]].concat();
    check(&fields, &bare.to_be_bytes(), &head);
}

/// What the core answers to a payload with these numbers, its CRC made right.
fn answer(kind: u8, state: u8, reason: u16) -> Result<Payload, TelemetryError> {
    let mut payload = EventReport { origin: ORIGIN, event: Event::Ended(0) }.to_be_bytes();
    payload[1] = kind;
    payload[25] = state;
    payload[26..28].copy_from_slice(&reason.to_be_bytes());
    let crc = checksum(&payload[..EVENT_BYTES - 4]);
    payload[EVENT_BYTES - 4..].copy_from_slice(&crc.to_be_bytes());
    Payload::from_be_bytes(&payload)
}

#[test]
// REQ-TLM-3.
fn kinds_and_states_are_those_of_the_page() {
    let tables = rows("Kinds and states");
    let named: Vec<(u8, &str)> =
        tables.iter().map(|row| (row[1].parse().unwrap(), row[0].as_str())).collect();
    assert_eq!(named, [&KINDS[..], &STATES].concat());
    for state in 0..=u8::MAX {
        let reason = if state == 5 { 167 } else { 0 };
        let known = STATES.iter().any(|it| it.0 == state);
        let expected = (!known).then_some(TelemetryError::State(state));
        assert_eq!(answer(1, state, reason).err(), expected);
    }
    for kind in 0..=u8::MAX {
        let known = KINDS.iter().any(|it| it.0 == kind);
        let unknown = answer(kind, 0, 0).err() == Some(TelemetryError::Kind(kind));
        assert_eq!(known, !unknown, "{kind}");
    }
}

#[test]
// REQ-TLM-3.
fn reasons_are_those_of_the_page() {
    let table = rows("Reasons");
    let value = |cell: &str| match cell {
        "" => Value::None,
        "instant" => Value::Instant,
        text if text.contains("instant of") => Value::Instant,
        _ => Value::Number,
    };
    let named: Vec<_> = table
        .iter()
        .map(|row| (row[0].parse().unwrap(), row[1].as_str(), value(&row[3]), value(&row[4])))
        .collect();
    assert_eq!(named, REASONS);
    for (kind, word) in [(4, "skipped"), (5, "aborted"), (6, "safe")] {
        let own: Vec<u16> = table
            .iter()
            .filter(|row| row[2].split(", ").any(|it| it == word))
            .map(|row| row[0].parse().unwrap())
            .collect();
        for reason in 0..=u16::MAX {
            let expected = (!own.contains(&reason)).then_some(TelemetryError::Reason(reason));
            assert_eq!(answer(kind, 0, reason).err(), expected, "{word}");
        }
    }
}
