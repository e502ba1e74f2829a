//! The META block of an OEM segment.

use super::{Lines, OemError, illegal, key_value, read_time, unknown_key};
use crate::interpolation::Method;
use crate::kernel::{EARTH, EARTH_MOON_BARYCENTER, SOLAR_SYSTEM_BARYCENTER, SUN};
use crate::time::Scale;
use onboard_core::time::Instant;

const KEYS: [&str; 14] = [
    "CENTER_NAME",
    "COMMENT",
    "INTERPOLATION",
    "INTERPOLATION_DEGREE",
    "META_STOP",
    "OBJECT_ID",
    "OBJECT_NAME",
    "REF_FRAME",
    "REF_FRAME_EPOCH",
    "START_TIME",
    "STOP_TIME",
    "TIME_SYSTEM",
    "USEABLE_START_TIME",
    "USEABLE_STOP_TIME",
];
const FRAMES: [&str; 4] = ["ICRF", "GCRF", "EME2000", "J2000"];
const SCALES: [&str; 4] = ["UTC", "TDB", "TAI", "TT"];
const METHODS: [&str; 3] = ["HERMITE", "LAGRANGE", "LINEAR"];
const CENTERS: [(&str, i32); 6] = [
    ("SUN", SUN),
    ("EARTH", EARTH),
    ("EARTH BARYCENTER", EARTH_MOON_BARYCENTER),
    ("EARTH-MOON BARYCENTER", EARTH_MOON_BARYCENTER),
    ("SOLAR SYSTEM BARYCENTER", SOLAR_SYSTEM_BARYCENTER),
    ("SSB", SOLAR_SYSTEM_BARYCENTER),
];
/// Degree without `INTERPOLATION_DEGREE`.
const HERMITE_DEGREE: usize = 7;
const LAGRANGE_DEGREE: usize = 7;
/// Largest degree accepted.
const LARGEST_DEGREE: usize = 27;

/// What a META block says.
pub(super) struct Meta {
    pub(super) center: i32,
    pub(super) scale: Scale,
    /// Useable span.
    pub(super) start: Instant,
    pub(super) stop: Instant,
    pub(super) method: Method,
    /// States per interpolation.
    pub(super) window: usize,
}

/// Keywords of a block with their lines and values.
struct Block<'a> {
    entries: Vec<(usize, &'a str, &'a str)>,
    stop_line: usize,
}

impl<'a> Block<'a> {
    fn read(lines: &mut Lines<'a>) -> Result<Self, OemError> {
        let (line, text) = lines.take().ok_or(OemError::Ended("before META_START"))?;
        if text != "META_START" {
            return Err(OemError::Line { line, text: text.to_owned(), expected: "META_START" });
        }
        let mut entries: Vec<(usize, &str, &str)> = Vec::new();
        while let Some((line, text)) = lines.take() {
            if text == "META_STOP" {
                return Ok(Self { entries, stop_line: line });
            }
            let (key, value) = key_value(line, text)?;
            if !KEYS.contains(&key) {
                return Err(unknown_key(line, key, &KEYS));
            }
            if let Some((first, ..)) = entries.iter().find(|(_, known, _)| *known == key) {
                return Err(OemError::Value {
                    line,
                    key: key.to_owned(),
                    value: value.to_owned(),
                    legal: format!("one value, and line {first} gives it already"),
                });
            }
            entries.push((line, key, value));
        }
        Err(OemError::Ended("inside a META block, without META_STOP"))
    }

    fn find(&self, key: &str) -> Option<(usize, &'a str)> {
        self.entries.iter().find(|(_, known, _)| *known == key).map(|(line, _, v)| (*line, *v))
    }

    fn need(&self, key: &'static str) -> Result<(usize, &'a str), OemError> {
        self.find(key).ok_or(OemError::Missing { line: self.stop_line, key })
    }

    fn time(&self, key: &'static str, scale: Scale) -> Result<Option<Instant>, OemError> {
        self.find(key).map(|(line, text)| read_time(line, key, text, scale)).transpose()
    }
}

/// Reads from `META_START` through `META_STOP`.
pub(super) fn read(lines: &mut Lines<'_>) -> Result<Meta, OemError> {
    let block = Block::read(lines)?;
    let (line, frame) = block.need("REF_FRAME")?;
    if !FRAMES.contains(&frame.to_ascii_uppercase().as_str()) {
        return Err(illegal(line, "REF_FRAME", frame, &FRAMES));
    }
    let (line, name) = block.need("TIME_SYSTEM")?;
    let scale = Scale::from_name(&name.to_ascii_uppercase())
        .ok_or_else(|| illegal(line, "TIME_SYSTEM", name, &SCALES))?;
    let (method, window) = interpolation(&block)?;
    let missing = |key| OemError::Missing { line: block.stop_line, key };
    let start = block.time("START_TIME", scale)?.ok_or_else(|| missing("START_TIME"))?;
    let stop = block.time("STOP_TIME", scale)?.ok_or_else(|| missing("STOP_TIME"))?;
    Ok(Meta {
        center: center(&block)?,
        scale,
        start: block.time("USEABLE_START_TIME", scale)?.unwrap_or(start).max(start),
        stop: block.time("USEABLE_STOP_TIME", scale)?.unwrap_or(stop).min(stop),
        method,
        window,
    })
}

fn center(block: &Block<'_>) -> Result<i32, OemError> {
    let (line, name) = block.need("CENTER_NAME")?;
    let plain = name.to_ascii_uppercase().replace('_', " ");
    let words = plain.split_whitespace().collect::<Vec<_>>().join(" ");
    CENTERS.iter().find(|(known, _)| *known == words).map(|(_, body)| *body).ok_or_else(|| {
        let legal: Vec<&str> = CENTERS.iter().map(|(known, _)| *known).collect();
        illegal(line, "CENTER_NAME", name, &legal)
    })
}

fn interpolation(block: &Block<'_>) -> Result<(Method, usize), OemError> {
    let degree = match block.find("INTERPOLATION_DEGREE") {
        None => None,
        Some((line, text)) => {
            let degree = text.parse().ok().filter(|degree| (1..=LARGEST_DEGREE).contains(degree));
            let legal = format!("a whole number from 1 to {LARGEST_DEGREE}");
            Some(degree.ok_or_else(|| OemError::Value {
                line,
                key: "INTERPOLATION_DEGREE".to_owned(),
                value: text.to_owned(),
                legal,
            })?)
        }
    };
    // Hermite of n states has degree 2 n - 1, Lagrange of n states n - 1.
    let hermite = |degree: usize| (Method::Hermite, (degree + 1).div_ceil(2));
    let lagrange = |degree: usize| (Method::Lagrange, degree + 1);
    let Some((line, name)) = block.find("INTERPOLATION") else {
        return Ok(hermite(degree.unwrap_or(HERMITE_DEGREE)));
    };
    match name.to_ascii_uppercase().as_str() {
        "HERMITE" => Ok(hermite(degree.unwrap_or(HERMITE_DEGREE))),
        "LAGRANGE" => Ok(lagrange(degree.unwrap_or(LAGRANGE_DEGREE))),
        "LINEAR" => Ok(lagrange(1)),
        _ => Err(illegal(line, "INTERPOLATION", name, &METHODS)),
    }
}
