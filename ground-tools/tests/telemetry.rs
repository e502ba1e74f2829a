//! `gyrfalcon telemetry decode`: a plan flown by the flight core is what its telemetry tells, as
//! payloads and as packets, in every form; damage is named or passed over; nothing is half-written.

#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use onboard_core::clock::ClockCorrelation;
use onboard_core::sequencer::{EventQueue, ScanEstimate, Sequencer, Settings, Situation, Tick};
use onboard_core::telemetry::{
    ClockInUse, EVENT_BYTES, EventReport, HOUSEKEEPING_BYTES, Housekeeping, IDLE_APID, Origin,
    PacketHeader, TablesInUse,
};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{Scrub, Tables};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SECOND: i64 = 1_000_000_000;
const DURATION: [&str; 2] = ["--duration", "2d"];

fn gyrfalcon(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gyrfalcon"));
    command.args(arguments).current_dir(folder).output().unwrap()
}

fn decoded(folder: &Path, arguments: &[&str]) -> String {
    let out = gyrfalcon(folder, &[&["telemetry", "decode"], arguments, &DURATION].concat());
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

/// Rows of a CSV by column.
fn rows(csv: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(csv.as_bytes());
    reader.deserialize().map(|row| row.unwrap()).collect()
}

/// A plan's flight as its telescope reports it.
struct Flight {
    folder: tempfile::TempDir,
    /// The uplink.
    bytes: Vec<u8>,
    telescope: u16,
    events: Vec<EventReport>,
    /// One at the end of each hour.
    housekeeping: Vec<Housekeeping>,
}

/// Two days, by the telescope with most sessions.
fn flight() -> Flight {
    let folder = tempfile::tempdir().unwrap();
    let planned = ["plan", "--quiet", "--force", "--out", "plan", "--duration", "2d"];
    assert!(gyrfalcon(folder.path(), &planned).status.success());
    let bytes = std::fs::read(folder.path().join("plan/uplink.tbl")).unwrap();
    let tables = Tables::load(&bytes).unwrap();
    let of = |telescope| tables.plan().sessions().filter(|it| it.telescope == telescope).count();
    let count = u16::try_from(tables.mission().telescopes().count()).unwrap();
    let telescope = (0..count).max_by_key(|it| of(*it)).unwrap();
    assert!(of(telescope) > 3);
    let (events, housekeeping) = fly(&tables, telescope);
    Flight { folder, bytes, telescope, events, housekeeping }
}

fn fly(tables: &Tables<'_>, telescope: u16) -> (Vec<EventReport>, Vec<Housekeeping>) {
    let header = tables.header();
    let clock = ClockCorrelation {
        sequence: 4,
        spacecraft: header.spacecraft,
        uncertainty_ns: 50,
        ticks: u64::MAX - 7,
        at: header.valid_from,
        tick_bits: ClockCorrelation::tick_of(1, 0),
        valid_from: header.valid_from,
        valid_until: header.valid_until,
    };
    let settings = Settings {
        telescope,
        tolerance: Duration::from_ns(1_000_000),
        passes_tolerance: 0,
        longest_gap: Duration::from_ns(20 * SECOND),
        check_ahead: Duration::from_ns(3600 * SECOND),
        recheck_rad: 1e-6,
        steps_per_tick: 8,
    };
    let mut sequencer = Sequencer::new(settings).unwrap();
    let mut queue = EventQueue::<16>::new();
    let mut scrub = Scrub::new(tables);
    let (mut events, mut housekeeping) = (Vec::new(), Vec::new());
    let mut second = 0;
    while header.valid_from.plus(Duration::from_ns(second * SECOND)) <= header.valid_until {
        let ticks = clock.ticks.wrapping_add_signed(second * SECOND);
        // Without a clock first, and then by order.
        let clock = (second >= 10).then_some(&clock);
        if second == 20 {
            sequencer.resume();
        }
        let scan = ScanEstimate::Mission;
        let tables = Some(tables);
        let situation = Situation { ticks, clock, tables, tables_damaged: false, scan };
        let tick = sequencer.tick(&situation, &mut queue);
        let _ = scrub.step();
        let popped = std::iter::from_fn(|| queue.pop());
        events.extend(popped.map(|it| EventReport::new(&it, header.spacecraft, telescope, clock)));
        if second % 3600 == 0 {
            let origin = Origin::new(header.spacecraft, telescope, ticks, clock);
            housekeeping.push(report(origin, tick, (tables, clock), &scrub));
        }
        second += 10;
    }
    (events, housekeeping)
}

fn report(
    origin: Origin,
    tick: Tick,
    (tables, clock): (Option<&Tables<'_>>, Option<&ClockCorrelation>),
    scrub: &Scrub<'_>,
) -> Housekeeping {
    Housekeeping {
        origin,
        tick,
        tables: tables.map(TablesInUse::of),
        tables_damaged: false,
        clock: clock.map(ClockInUse::of),
        lost: onboard_core::sequencer::Lost::NONE,
        tracker: None,
        scrub: Some(scrub.progress()),
        visit: None,
    }
}

impl Flight {
    /// Events and then housekeeping, payload after payload.
    fn payloads(&self) -> Vec<Vec<u8>> {
        let events = self.events.iter().map(|it| it.to_be_bytes().to_vec());
        events.chain(self.housekeeping.iter().map(|it| it.to_be_bytes().to_vec())).collect()
    }

    /// Events in packets of APID 5, housekeeping in packets of APID 6 with a secondary header of 10
    /// bytes; an idle packet after each.
    fn packets(&self) -> Vec<u8> {
        let mut file = Vec::new();
        for (count, payload) in (0..).zip(self.payloads()) {
            let is_event = payload.len() == EVENT_BYTES;
            let data = if is_event { payload } else { [&[0xa1; 10], &payload[..]].concat() };
            file.extend(packet(if is_event { 5 } else { 6 }, !is_event, count, &data));
            file.extend(packet(IDLE_APID, false, count, &[0xa1; 3]));
        }
        file
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn decoded(&self, arguments: &[&str]) -> String {
        decoded(self.folder.path(), arguments)
    }

    /// Exit code 2, a sentence with all parts, and nothing written.
    fn refused(&self, bytes: &[u8], parts: &[&str]) {
        self.write("bad.tm", bytes);
        for out in [&["--out", "rows.csv"][..], &[]] {
            let run = [&["telemetry", "decode", "bad.tm"], out, &DURATION].concat();
            let done = gyrfalcon(self.folder.path(), &run);
            let error = String::from_utf8(done.stderr).unwrap();
            assert_eq!(done.status.code(), Some(2), "{error}");
            assert!(done.stdout.is_empty() && !self.folder.path().join("rows.csv").exists());
            for part in parts.iter().chain(&["bad.tm: byte "]) {
                assert!(error.contains(part), "{part:?}: {error}");
            }
        }
    }
}

fn packet(apid: u16, secondary_header: bool, count: u16, data: &[u8]) -> Vec<u8> {
    let data_bytes_less_one = u16::try_from(data.len() - 1).unwrap();
    let header = PacketHeader { apid, secondary_header, count, data_bytes_less_one };
    [&header.to_be_bytes(), data].concat()
}

#[test]
fn what_was_flown_is_what_was_planned() {
    let flight = flight();
    flight.write("events.tm", &flight.payloads().concat());
    let csv = flight.decoded(&["events.tm", "--only", "events"]);
    assert!(csv.starts_with("# mission: LiteBIRD\n"));
    let rows = rows(&csv);
    assert_eq!(rows.len(), flight.events.len());
    // Safe from the start, without a clock and so without an instant.
    let [boot, idle, tables] = [&rows[0], &rows[1], &rows[2]];
    assert_eq!((&*boot["kind"], &*boot["reason"], &*boot["time_utc"]), ("safe", "boot", ""));
    assert_eq!(boot["counter"], (u64::MAX - 7).to_string());
    assert_eq!((&*idle["kind"], &*idle["state"]), ("entered", "idle"));
    assert_eq!((&*tables["kind"], &*tables["value"]), ("tables", "1"));
    // Every session of the telescope in the uplink's order, with the uplink's times.
    let loaded = Tables::load(&flight.bytes).unwrap();
    let planned: Vec<_> = (0_u32..)
        .zip(loaded.plan().sessions())
        .filter(|(_, it)| it.telescope == flight.telescope)
        .collect();
    let started: Vec<_> = rows.iter().filter(|it| it["kind"] == "started").collect();
    assert_eq!(started.len(), planned.len());
    for (row, (index, session)) in started.iter().zip(&planned) {
        assert_eq!(row["session"], index.to_string());
        assert_eq!(row["body"], session.body.to_string());
        assert_eq!(row["passes"], session.passes.to_string());
        assert_eq!(row["start_tai_ns"], session.start.tai_ns().to_string());
        let utc = |at: Instant| ephem::time::format_utc(at);
        assert_eq!(row["first_entry_utc"], utc(session.first_entry));
        assert_eq!(row["last_exit_utc"], utc(session.last_exit));
        assert_eq!(row["end_utc"], utc(session.end));
        let at: i64 = row["tai_ns"].parse().unwrap();
        assert!((0..10 * SECOND).contains(&(at - session.start.tai_ns())), "within a tick");
    }
    assert!(rows.iter().all(|it| it["kind"] != "skipped" && it["kind"] != "aborted"));
    assert!(rows.iter().all(|it| !it["telescope"].is_empty() && !it.contains_key("check")));
}

#[test]
fn payloads_and_packets_give_the_same_rows_in_every_form() {
    let flight = flight();
    flight.write("bare.tm", &flight.payloads().concat());
    flight.write("packets.tm", &flight.packets());
    let without = |csv: &str| {
        let mut rows = rows(csv);
        for row in &mut rows {
            row.retain(|name, _| !["byte", "apid", "packet"].contains(&name.as_str()));
        }
        rows
    };
    let bare = flight.decoded(&["bare.tm"]);
    let packets = flight.decoded(&["packets.tm"]);
    assert_eq!(without(&bare), without(&packets));
    assert_eq!(rows(&bare).len(), flight.events.len() + flight.housekeeping.len());
    let six = rows(&flight.decoded(&["packets.tm", "--apid", "6"]));
    assert_eq!(six.len(), flight.housekeeping.len());
    assert_eq!(
        (&*six[0]["apid"], &*six[0]["state"], &*six[0]["clock_sequence"]),
        ("6", "safe", "")
    );
    assert_eq!((&*six[1]["clock_sequence"], &*six[1]["tables_sequence"]), ("4", "1"));
    assert_eq!(six[1]["scrub_bytes"], flight.bytes.len().to_string());

    let lines = flight.decoded(&["packets.tm", "--only", "housekeeping", "--format", "jsonl"]);
    let lines: Vec<Value> = lines.lines().map(|it| serde_json::from_str(it).unwrap()).collect();
    assert_eq!(lines.len(), flight.housekeeping.len());
    assert_eq!(lines[0]["provenance"]["mission"], "LiteBIRD");
    assert_eq!((&lines[1]["check"], &lines[1]["accepted"]), (&"waiting".into(), &Value::Null));
    flight.decoded(&["packets.tm", "--format", "parquet", "--out", "rows.parquet"]);
    let parquet = std::fs::read(flight.folder.path().join("rows.parquet")).unwrap();
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));

    let summary: Value = serde_json::from_str(&flight.decoded(&["packets.tm", "--json"])).unwrap();
    assert_eq!(summary["events"], flight.events.len());
    assert_eq!(summary["housekeeping"], flight.housekeeping.len());
    assert_eq!(summary["other_packets"], flight.events.len() + flight.housekeeping.len());
}

#[test]
fn damage_is_named_with_its_place_and_nothing_is_written() {
    let flight = flight();
    let good = flight.payloads().concat();
    let changed = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    flight.refused(&changed(2 * EVENT_BYTES + 40, 9), &["byte 192: ", "its CRC does not match"]);
    flight.refused(&changed(EVENT_BYTES + 1, 77), &["byte 96: ", "no kind", "77", "1 to 8 and 16"]);
    flight.refused(&changed(0, 0x47), &["byte 0: 0x47 begins neither", "0xa1", "space packet"]);
    let cut = &good[..good.len() - 1];
    let (last, left) = (good.len() - HOUSEKEEPING_BYTES, HOUSEKEEPING_BYTES - 1);
    let (last, left) =
        (format!("byte {last}: "), format!("268 bytes are needed, {left} are there"));
    flight.refused(cut, &[&last, "the file ends in the middle", &left]);
    let packets = flight.packets();
    flight.refused(&[&packets[..], &[0x18; 9]].concat(), &["the packet is a telecommand"]);
    flight.refused(&packet(5, false, 0, &[0xa1, 3, 0]), &["byte 0: ", "data field has 3 bytes"]);
    let other = Origin { spacecraft: 0xfeed, ..flight.events[0].origin };
    let other = EventReport { origin: other, ..flight.events[0] };
    let sentence = ["spacecraft 0000feed", "--mission names another"];
    flight.refused(&other.to_be_bytes(), &sentence);
    let missing = gyrfalcon(flight.folder.path(), &["telemetry", "decode", "nothing.tm"]);
    assert_eq!(missing.status.code(), Some(2));
}

#[test]
fn damage_can_be_passed_over_and_is_counted() {
    let flight = flight();
    let payloads = flight.payloads();
    let all = payloads.len();
    // A payload damaged, bytes of something else, a payload cut short, and the rest whole.
    let mut bytes = payloads[0].clone();
    bytes.extend(&payloads[1]);
    bytes[EVENT_BYTES + 50] ^= 4;
    bytes.extend(&payloads[2]);
    bytes.extend([0xa1, 0x00, 0x08, 0xff, 0x47]);
    bytes.extend(payloads[3..all - 1].concat());
    bytes.extend(&payloads[all - 1][..100]);
    flight.write("damaged.tm", &bytes);
    let run = ["telemetry", "decode", "damaged.tm", "--skip-damaged", "--duration", "2d"];
    let done = gyrfalcon(flight.folder.path(), &run);
    let told = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{told}");
    let rows = rows(&String::from_utf8(done.stdout).unwrap());
    assert_eq!(rows.len(), all - 2);
    assert_eq!(rows[1]["byte"], (2 * EVENT_BYTES).to_string());
    let parts = ["warning: damaged.tm: 3 damaged places, 201 bytes", "first at byte 96: "];
    assert!(parts.iter().all(|part| told.contains(part)), "{told}");
    // In packets, by the headers.
    let mut packets = flight.packets();
    packets[3 * (EVENT_BYTES + 6 + 9) + 30] ^= 1;
    flight.write("packets.tm", &packets);
    let text = flight.decoded(&["packets.tm", "--skip-damaged", "--json", "--quiet"]);
    let summary: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["events"], flight.events.len() - 1);
    assert_eq!(
        (&summary["damaged"], &summary["housekeeping"]),
        (&1.into(), &flight.housekeeping.len().into())
    );
}
