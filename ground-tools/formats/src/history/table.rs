//! A CSV of quaternions, such as `pointing` writes.
//!
//! The header names `q_x`, `q_y`, `q_z`, `q_w` and a time: `tai_ns`, `elapsed_s`, `time_tdb`,
//! `time_utc`, `time_tt` or `time_tai`, the first of these where there are several. Other columns
//! are ignored; `#` begins a comment.

use super::error::HistoryError;
use super::row::{Row, number, rising, unit};
use ephem::time::parse_time;
use mission::number::Number;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use onboard_core::time::{Duration, Instant};

const QUATERNION: [&str; 4] = ["q_x", "q_y", "q_z", "q_w"];
const TIMES: [(&str, Clock); 6] = [
    ("tai_ns", Clock::Tai),
    ("elapsed_s", Clock::Elapsed),
    ("time_tdb", Clock::Civil("TDB")),
    ("time_utc", Clock::Civil("UTC")),
    ("time_tt", Clock::Civil("TT")),
    ("time_tai", Clock::Civil("TAI")),
];

/// What a time column counts.
#[derive(Clone, Copy)]
enum Clock {
    Tai,
    Elapsed,
    Civil(&'static str),
}

pub(super) fn read(text: &str, start: Instant) -> Result<Vec<Row>, HistoryError> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let refuse = |error: &csv::Error| HistoryError::Csv {
        line: error.position().map_or(0, line_of),
        reason: match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                format!("the row has {len} fields; the header has {expected_len}")
            }
            _ => error.to_string(),
        },
    };
    let header = reader.headers().map_err(|error| refuse(&error))?.clone();
    let place = |name: &str| header.iter().position(|column| column == name);
    let missing = |column, legal| HistoryError::Column {
        line: header.position().map_or(1, line_of),
        found: header.iter().collect::<Vec<_>>().join(","),
        column,
        legal,
    };
    let mut places = [0; 4];
    for (at, name) in places.iter_mut().zip(QUATERNION) {
        *at = place(name).ok_or_else(|| missing(name, "q_x, q_y, q_z, q_w are needed"))?;
    }
    let clock = TIMES.iter().find_map(|(name, clock)| Some((*name, place(name)?, *clock)));
    let (time_name, time_place, clock) = clock.ok_or_else(|| {
        missing(
            "tai_ns",
            "a time is needed: tai_ns, elapsed_s, time_tdb, time_utc, time_tt or time_tai",
        )
    })?;
    let mut rows: Vec<Row> = Vec::new();
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| refuse(&error))? {
        let line = record.position().map_or(0, line_of);
        let field = |place: usize| record.get(place).unwrap_or("");
        let time = field(time_place);
        let at = instant(clock, start, (line, time_name), time)?;
        rising(rows.last(), at, line, time)?;
        let mut quaternion = [0.0; 4];
        for ((component, place), name) in quaternion.iter_mut().zip(places).zip(QUATERNION) {
            *component = number(line, name, field(place))?;
        }
        rows.push(Row { line, at, quaternion: unit(line, quaternion)? });
    }
    Ok(rows)
}

fn line_of(position: &csv::Position) -> usize {
    usize::try_from(position.line()).unwrap_or(usize::MAX)
}

fn instant(
    clock: Clock,
    start: Instant,
    (line, key): (usize, &'static str),
    text: &str,
) -> Result<Instant, HistoryError> {
    let illegal = |legal| HistoryError::Value { line, key, value: text.to_owned(), legal };
    match clock {
        Clock::Tai => text
            .parse()
            .map(Instant::from_tai_ns)
            .map_err(|_| illegal("a whole number of ns of TAI since 2000-01-01T12:00:00 TAI")),
        Clock::Elapsed => {
            let legal = "seconds on the scan clock, such as 1234.5";
            let seconds = Number::parse(text).map_err(|_| illegal(legal))?;
            let ns = seconds.exact() * BigRational::from_integer(1_000_000_000.into());
            let ns = ns.round().numer().to_i64().ok_or_else(|| illegal(legal))?;
            Ok(start.plus(Duration::from_ns(ns)))
        }
        Clock::Civil(scale) => {
            let bare =
                if scale == "UTC" { text.strip_suffix(['Z', 'z']).unwrap_or(text) } else { text };
            parse_time(&format!("{bare} {scale}"))
                .map_err(|fault| HistoryError::Time { line, fault })
        }
    }
}
