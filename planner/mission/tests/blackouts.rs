//! Calendars as the field has them, named by a mission as its blackouts.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use ephem::time::{format_utc, parse_time};
use mission::occasions::{Blackouts, blackouts, contacts};
use mission::{Mission, Override};
use onboard_core::time::Instant;
use std::path::Path;

fn mission(key: &str, file: &str) -> Mission {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/calendars");
    let named = Override::set(&format!("{key}={file}")).unwrap();
    let text = "base = \"litebird\"\n[span]\nstart = \"2032-04-01T00:00:00Z\"\nduration_days = 4\n";
    Mission::from_toml(text, "m.toml", &folder, &[named]).unwrap()
}

fn read(file: &str) -> Blackouts {
    let mission = mission("calibration.schedule.blackouts", file);
    let at = |text: &str| parse_time(text).unwrap();
    Blackouts::read(&mission, (at("2032-04-01T00:00:00Z"), at("2032-04-05T00:00:00Z"))).unwrap()
}

/// Starts and ends as DDThh:mm.
fn spans(found: &Blackouts) -> Vec<String> {
    let told = |at: Instant| format_utc(at)[8..16].to_owned();
    found.within.iter().map(|it| format!("{} {}", told(it.from), told(it.until))).collect()
}

#[test]
fn calendars_of_the_field_are_read() {
    for (file, expected) in [
        ("mixed_line_ends.ics", &["01T00:00 01T01:00", "02T00:00 02T23:59"][..]),
        (
            "mixed_line_ends_rule.ics",
            &["01T00:00 01T23:59", "02T00:00 02T23:59", "03T00:00 03T23:59"],
        ),
        ("lower_case_rule.ics", &["01T00:00 01T23:59", "02T00:00 02T23:59", "03T00:00 03T23:59"]),
        ("freebusy_only.ics", &["02T00:00 03T00:00"]),
        ("allday_no_end.ics", &["01T00:00 02T00:00"]),
        ("one_outside.ics", &["01T06:30 01T07:30"]),
        ("two_calendars.ics", &["01T06:30 01T07:30", "01T08:30 01T09:30"]),
    ] {
        let found = read(file);
        assert_eq!(spans(&found), expected, "{file}");
        let outside = usize::from(file == "one_outside.ics");
        assert_eq!((found.outside, found.left_out().len()), (outside, outside), "{file}");
    }
    let said = read("one_outside.ics").left_out();
    assert_eq!(said, ["blackouts left out because they lie outside the mission: 1"]);
}

#[test]
fn rules_without_an_end_are_followed_to_the_mission_s() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("daily.ics");
    let text = "BEGIN:VCALENDAR\nBEGIN:VEVENT\nDTSTART:20200101T120000Z\nDURATION:PT1H\n\
        RRULE:FREQ=DAILY\nEND:VEVENT\nX-BROKEN LINE\nEND:VCALENDAR\n";
    std::fs::write(&file, text).unwrap();
    let found = read(file.to_str().unwrap());
    assert_eq!(found.within.len(), 4);
    // From 2020-01-01 to 2032-03-31, and what a zone's clocks could still bring after the end.
    assert!(found.outside > 4473 && found.outside < 4478, "{}", found.outside);
    assert!(found.left_out()[1].contains("malformed lines of the calendar left out: 7"));
    std::fs::write(&file, format!("{}{text}", "BEGIN:VCALENDAR\n".repeat(10_000))).unwrap();
    let mission = mission("calibration.schedule.blackouts", file.to_str().unwrap());
    let at = |text: &str| parse_time(text).unwrap();
    let span = (at("2032-04-01T00:00:00Z"), at("2032-04-05T00:00:00Z"));
    let said = blackouts(&mission, span).unwrap_err().to_string();
    assert!(said.contains("daily.ics: line 17: components are nested more than 16 deep"), "{said}");
}

#[test]
fn contacts_may_overlap_but_must_be_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("contacts.csv");
    let read = |rows: &str| {
        std::fs::write(&file, format!("start_utc,end_utc,bit_s\n{rows}")).unwrap();
        let data =
            format!("{{ rate_bit_s = 1e6, memory_bit = 1e12, contacts = '{}' }}", file.display());
        let mission = mission("calibration.schedule.data", &data);
        let named = mission.calibration.schedule.data.as_ref().unwrap().contacts.clone();
        contacts(&mission, &named).map_err(|error| error.to_string())
    };
    let found = read(
        "2032-04-01T00:00:00Z,2032-04-01T02:00:00Z,5\n\
         2032-04-01T01:00:00Z,2032-04-01T04:00:00Z,7\n\
         2032-04-01T02:30:00Z,2032-04-01T03:00:00Z,6\n",
    )
    .unwrap();
    let told: Vec<String> = found
        .iter()
        .map(|it| {
            let hour = |at| format_utc(at)[11..16].to_owned();
            format!("{}-{} {}", hour(it.from), hour(it.until), it.bit_s)
        })
        .collect();
    assert_eq!(told, ["00:00-01:00 5", "01:00-04:00 7"]);
    for rows in ["", "2032-04-01T00:00:00Z,2032-04-01T02:00:00Z,0\n"] {
        assert!(read(rows).unwrap_err().contains("memory could never be emptied"));
    }
}
