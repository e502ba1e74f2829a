//! Events of every kind that RFC 5545 knows.

use super::*;
use ephem::time::parse_time;

fn file(body: &str) -> String {
    let body = body.trim().replace('\n', "\r\n");
    format!("BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:x\r\n{body}\r\nEND:VCALENDAR\r\n")
}

fn calendar(lines: &[&str]) -> String {
    file(&format!("BEGIN:VEVENT\nUID:7\n{}\nEND:VEVENT", lines.join("\n")))
}

fn at(text: &str) -> Instant {
    parse_time(text).unwrap()
}

/// Starts as MM-DDThh:mm.
fn starts(text: &str) -> Vec<String> {
    let all = read_to(text.as_bytes(), at("2033-01-01T00:00:00Z")).unwrap();
    let start = |it: &Occasion| ephem::time::format_utc(it.from)[5..16].to_owned();
    all.occasions.iter().map(start).collect()
}

#[test]
fn events_are_read_in_utc_unfolded_and_unescaped() {
    let text = calendar(&[
        "DTSTART:20320401T063000Z",
        "DTEND;TZID=UTC:20320401T073000",
        "SUMMARY:Wheel unloading\\, orbit\\; man",
        " oeuvre: all \\\\ telescopes",
        "BEGIN:VALARM",
        "TRIGGER;RELATED=END:-PT5M",
        "END:VALARM",
    ]);
    let expected = Occasion {
        from: at("2032-04-01T06:30:00Z"),
        until: at("2032-04-01T07:30:00Z"),
        summary: "Wheel unloading, orbit; manoeuvre: all \\ telescopes".to_owned(),
    };
    assert_eq!(read(&text).unwrap(), read(text.replace("\r\n", "\n")).unwrap());
    assert_eq!(read(&text).unwrap(), [expected]);
    let days = calendar(&["DTSTART;VALUE=DATE:20320401", "DTEND;VALUE=DATE:20320403"]);
    let [days] = &read(&days).unwrap()[..] else { panic!() };
    assert_eq!(days.until.since(days.from).ns(), 2 * 86_400 * 1_000_000_000);
    assert_eq!(read("BEGIN:VCALENDAR\nEND:VCALENDAR\n").unwrap(), []);
}

#[test]
fn what_leaves_time_free_is_counted() {
    for status in ["STATUS:CANCELLED", "status:cancelled", "Status:Cancelled"] {
        let text = calendar(&["DTSTART:20320401T063000Z", "DTEND:20320401T073000Z", status]);
        let found = read_to(text.as_bytes(), at("2033-01-01T00:00:00Z")).unwrap();
        assert_eq!((found.occasions.len(), found.cancelled), (0, 1));
    }
    let text = calendar(&["DTSTART:20320401T063000Z", "DURATION:PT1H", "transp:transparent"]);
    let found = read_to(text.as_bytes(), at("2033-01-01T00:00:00Z")).unwrap();
    assert_eq!((found.occasions.len(), found.transparent), (0, 1));
    let text = calendar(&["DTSTART:20320401T063000Z"]);
    let found = read_to(text.as_bytes(), at("2033-01-01T00:00:00Z")).unwrap();
    assert_eq!((found.occasions.len(), found.momentary), (0, 1));
}

#[test]
fn an_event_lasts_as_it_says() {
    for (lines, hours) in [
        (&["DTSTART:20320401T000000Z", "DURATION:P1DT1H30M"][..], 25.5),
        (&["DTSTART;VALUE=DATE:20320401"], 24.0),
        (&["DTSTART;VALUE=DATE:20320401", "DURATION:P1W"], 168.0),
        // A day by the clock, on which an hour is skipped; 24 h are 24 h.
        (&["DTSTART;TZID=Europe/Paris:20320327T120000", "DURATION:P1D"], 23.0),
        (&["DTSTART;TZID=Europe/Paris:20320327T120000", "DURATION:PT24H"], 24.0),
    ] {
        let [it] = &read(calendar(lines)).unwrap()[..] else { panic!() };
        assert!((it.until.since(it.from).seconds() / 3600.0 - hours).abs() < 1e-9, "{lines:?}");
    }
}

#[test]
fn local_time_is_that_of_its_zone() {
    for (zone, start) in [
        ("Europe/Paris", "04-01T04:30"),
        ("\"Europe/Paris\"", "04-01T04:30"),
        ("europe/paris", "04-01T04:30"),
        ("/example.org/20320101_1/Europe/Paris", "04-01T04:30"),
        ("America/Argentina/Buenos_Aires", "04-01T09:30"),
        ("W. Europe Standard Time", "04-01T04:30"),
        ("Tokyo Standard Time", "03-31T21:30"),
        ("Etc/GMT", "04-01T06:30"),
    ] {
        let line = format!("DTSTART;TZID={zone}:20320401T063000");
        assert_eq!(starts(&calendar(&[&line, "DURATION:PT1H"])), [start], "{zone}");
    }
    let own = "X-WR-TIMEZONE:Asia/Tokyo\nBEGIN:VEVENT\nDTSTART:20320401T063000\nDURATION:PT1H\nEND:VEVENT";
    assert_eq!(starts(&file(own)), ["03-31T21:30"]);
}

/// Central Europe under another name, as calendars define it.
const OWN_ZONE: &str = "BEGIN:VTIMEZONE\nTZID:Base\nBEGIN:DAYLIGHT\nTZOFFSETFROM:+0100\n\
    TZOFFSETTO:+0200\nDTSTART:16010101T020000\nRRULE:FREQ=YEARLY;BYDAY=-1SU;BYMONTH=3\nEND:DAYLIGHT\n\
    BEGIN:STANDARD\nTZOFFSETFROM:+0200\nTZOFFSETTO:+0100\nDTSTART:16010101T030000\n\
    RRULE:FREQ=YEARLY;BYDAY=-1SU;BYMONTH=10\nEND:STANDARD\nEND:VTIMEZONE\n";

#[test]
fn a_zone_that_the_file_defines_is_that_of_its_name() {
    // Days of both seasons, the hour that is skipped, and the one that comes twice.
    for clock in [
        "20320115T120000",
        "20320715T120000",
        "20320328T015959",
        "20320328T023000",
        "20320328T030000",
        "20321031T015959",
        "20321031T023000",
        "20321031T030000",
    ] {
        let event = |zone: &str| {
            format!("BEGIN:VEVENT\nDTSTART;TZID={zone}:{clock}\nDURATION:PT1H\nEND:VEVENT")
        };
        let own = starts(&file(&format!("{OWN_ZONE}{}", event("Base"))));
        assert_eq!(own, starts(&file(&event("Europe/Paris"))), "{clock}");
    }
}

#[test]
fn rules_are_followed() {
    const START: &str = "DTSTART:20320401T063000Z";
    for (lines, expected) in [
        (&["RRULE:FREQ=DAILY;COUNT=3"][..], &["04-01T06:30", "04-02T06:30", "04-03T06:30"][..]),
        (&["rrule:freq=daily;interval=2;until=20320404T000000z"], &["04-01T06:30", "04-03T06:30"]),
        (&["RRULE:FREQ=DAILY;UNTIL=20320402"], &["04-01T06:30", "04-02T06:30"]),
        // 2032-04-01 is a Thursday.
        (
            &["RRULE:FREQ=WEEKLY;BYDAY=TH,MO;COUNT=4"],
            &["04-01T06:30", "04-05T06:30", "04-08T06:30", "04-12T06:30"],
        ),
        (&["RRULE:FREQ=MONTHLY;BYDAY=1TH;COUNT=2"], &["04-01T06:30", "05-06T06:30"]),
        (&["RRULE:FREQ=MONTHLY;INTERVAL=6"], &["04-01T06:30", "10-01T06:30"]),
        (&["RRULE:FREQ=YEARLY"], &["04-01T06:30"]),
        (
            &["RRULE:FREQ=DAILY;COUNT=4", "EXDATE:20320402T063000Z,20320403T063000Z"],
            &["04-01T06:30", "04-04T06:30"],
        ),
        (
            &["RRULE:FREQ=DAILY;COUNT=3", "EXDATE;VALUE=DATE:20320402"],
            &["04-01T06:30", "04-03T06:30"],
        ),
        (
            &["RDATE:20320405T100000Z,20320406T100000Z"],
            &["04-01T06:30", "04-05T10:00", "04-06T10:00"],
        ),
    ] {
        let lines: Vec<&str> = [START, "DURATION:PT1H"].iter().chain(lines).copied().collect();
        assert_eq!(starts(&calendar(&lines)), expected, "{lines:?}");
    }
    let days = calendar(&["DTSTART;VALUE=DATE:20320401", "RRULE:FREQ=DAILY;UNTIL=20320402"]);
    assert_eq!(starts(&days), ["04-01T00:00", "04-02T00:00"]);
}

#[test]
fn a_rule_keeps_its_hour_when_the_clocks_change() {
    let lines = [
        "DTSTART;TZID=Europe/Paris:20320327T063000",
        "DURATION:PT1H",
        "RRULE:FREQ=DAILY;UNTIL=20320329T043000Z",
    ];
    assert_eq!(starts(&calendar(&lines)), ["03-27T05:30", "03-28T04:30", "03-29T04:30"]);
}

#[test]
fn a_changed_instance_takes_its_place() {
    let event = |lines: &str| {
        format!("BEGIN:VEVENT\nUID:1\nDTEND:20320401T073000Z\n{lines}\nEND:VEVENT\n")
            .replace("DTEND:20320401T073000Z", "DURATION:PT1H")
    };
    let master = event("DTSTART:20320401T063000Z\nRRULE:FREQ=DAILY;COUNT=3");
    let moved = event("RECURRENCE-ID:20320402T063000Z\nDTSTART:20320402T200000Z");
    let dropped =
        event("RECURRENCE-ID:20320403T063000Z\nDTSTART:20320403T063000Z\nSTATUS:CANCELLED");
    let all = file(&format!("{master}{moved}{dropped}"));
    assert_eq!(starts(&all), ["04-01T06:30", "04-02T20:00"]);
}

#[test]
fn busy_times_are_occasions() {
    let body = "BEGIN:VFREEBUSY\nUID:1\nDTSTART:20320401T000000Z\nDTEND:20320405T000000Z\n\
        FREEBUSY;FBTYPE=BUSY:20320402T000000Z/20320403T000000Z,20320403T060000Z/PT2H\n\
        FREEBUSY;FBTYPE=FREE:20320403T100000Z/PT2H\nFREEBUSY:20320404T000000Z/P1D\nEND:VFREEBUSY";
    assert_eq!(starts(&file(body)), ["04-02T00:00", "04-03T06:00", "04-04T00:00"]);
}

#[test]
fn what_is_not_taken_is_named() {
    let start = "DTSTART:20320401T063000Z";
    let end = "DTEND:20320401T073000Z";
    for (lines, sentence) in [
        (&[start, end, "RRULE:FREQ=HOURLY"][..], "repeats more than 2"),
        (&[start, end, "RRULE:FREQ=FORTNIGHTLY;COUNT=2"], "RRULE:FREQ=FORTNIGHTLY;COUNT=2"),
        (&[start, end, "RECURRENCE-ID;RANGE=THISANDFUTURE:20320401T063000Z"], "has RECURRENCE-ID"),
        (&[start, "DURATION:1H"], "1H is not a duration"),
        (&[end], "has no DTSTART"),
        (
            &[start, "SUMMARY:Wheel", "DTEND:20320401T073000"],
            "event 'Wheel', DTEND: 20320401T073000",
        ),
        (&[start, "DTEND:20320401T073000"], "event 7, DTEND"),
        (&[start, "DTEND;TZID=Middle/Earth:20320401T073000"], "the zone Middle/Earth is not known"),
        (&[start, "DTEND:2032-04-01"], "is not a time in UTC"),
        (&[start, "DTEND:20321301"], "month 13"),
        (&[start, "DTEND:20320401T063000Z"], "does not end after its start"),
    ] {
        let error = read(calendar(lines)).unwrap_err().to_string();
        assert!(error.contains(sentence), "{error}");
    }
    for text in ["", "start_utc,end_utc,reason\n", "BEGIN:VEVENT\nEND:VEVENT\n"] {
        assert!(read(text).unwrap_err().to_string().contains("no iCalendar file"), "{text}");
    }
    let cut = calendar(&[start, end]).replace("END:VEVENT\r\nEND:VCALENDAR\r\n", "");
    assert_eq!(read(&cut).unwrap_err(), CalendarError::CutShort { begun: 2, ended: 0 });
}
