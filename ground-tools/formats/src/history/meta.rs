//! What an AEM segment says about its quaternions.
//!
//! Version 2 \[CCSDS504\]: the quaternion takes components in `REF_FRAME_B` to components in
//! `REF_FRAME_A`, as B turned by +90 deg about A's z is (0, 0, 0.7071, 0.7071). Version 1 says the
//! sense with `ATTITUDE_DIR` (`A2B` as version 2, `B2A` the conjugate) and the scalar's place with
//! `QUATERNION_TYPE`. One of the frames must be inertial, the other the spacecraft's.

use super::{HistoryError, Reference, Row, conjugate, number, rising, unit};
use ephem::time::parse_time;

/// A keyword with its line and value.
pub(super) type Entry = (usize, String, String);

const KEYS: [&str; 19] = [
    "ANGVEL_FRAME",
    "ATTITUDE_DIR",
    "ATTITUDE_TYPE",
    "CENTER_NAME",
    "COMMENT",
    "EULER_ROT_SEQ",
    "INTERPOLATION_DEGREE",
    "INTERPOLATION_METHOD",
    "OBJECT_ID",
    "OBJECT_NAME",
    "QUATERNION_TYPE",
    "RATE_FRAME",
    "REF_FRAME_A",
    "REF_FRAME_B",
    "START_TIME",
    "STOP_TIME",
    "TIME_SYSTEM",
    "USEABLE_START_TIME",
    "USEABLE_STOP_TIME",
];
const INERTIAL: [&str; 4] = ["ICRF", "EME2000", "J2000", "ECLIPJ2000"];
const SCALES: [&str; 4] = ["UTC", "TAI", "TT", "TDB"];
/// Attitude types with how many numbers a line holds.
const TYPES: [(&str, usize); 4] = [
    ("QUATERNION", 4),
    ("QUATERNION/ANGVEL", 7),
    ("QUATERNION/DERIVATIVE", 8),
    ("QUATERNION/RATE", 7),
];
/// Versions that this reads.
pub(super) const VERSIONS: [&str; 2] = ["1.0", "2.0"];

/// How a segment's lines are read.
pub(super) struct Meta {
    scale: String,
    inverse: bool,
    scalar_first: bool,
    pub(super) numbers: usize,
    pub(super) reference: Reference,
}

fn illegal(entry: &Entry, legal: &[&str]) -> HistoryError {
    let (line, key, value) = entry.clone();
    HistoryError::Value { line, key, value, legal: legal.join(", ") }
}

impl Meta {
    /// From a block's keywords; `end` is its last line.
    pub(super) fn new(entries: &[Entry], end: usize) -> Result<Self, HistoryError> {
        for (index, entry) in entries.iter().enumerate() {
            let (line, key, value) = entry;
            if !KEYS.contains(&key.as_str()) {
                let (line, key) = (*line, key.clone());
                return Err(HistoryError::Key { line, key, legal: KEYS.join(", ") });
            }
            let twice = entries[..index].iter().find(|(_, before, _)| before == key);
            if let Some((first, ..)) = twice.filter(|_| key != "COMMENT") {
                return Err(HistoryError::Value {
                    line: *line,
                    key: key.clone(),
                    value: value.clone(),
                    legal: format!("one value, and line {first} gives it already"),
                });
            }
        }
        let find = |key: &str| entries.iter().find(|(_, name, _)| name == key);
        let need = |key: &'static str| find(key).ok_or(HistoryError::Missing { line: end, key });
        let scale = need("TIME_SYSTEM")?;
        if !SCALES.contains(&scale.2.as_str()) {
            return Err(illegal(scale, &SCALES));
        }
        let kind = need("ATTITUDE_TYPE")?;
        let numbers = TYPES.iter().find(|(name, _)| *name == kind.2.to_uppercase());
        let (_, numbers) = numbers.ok_or_else(|| illegal(kind, &TYPES.map(|(name, _)| name)))?;
        let (a, b) = (need("REF_FRAME_A")?, need("REF_FRAME_B")?);
        let swapped = !INERTIAL.contains(&a.2.as_str()) && INERTIAL.contains(&b.2.as_str());
        let (inertial, body) = if swapped { (b, a) } else { (a, b) };
        if !INERTIAL.contains(&inertial.2.as_str()) {
            return Err(illegal(inertial, &INERTIAL));
        }
        if INERTIAL.contains(&body.2.as_str()) {
            return Err(illegal(body, &["a frame of the spacecraft, such as SC_BODY_1"]));
        }
        let conjugated = match find("ATTITUDE_DIR") {
            None => false,
            Some((.., value)) if value == "A2B" => false,
            Some((.., value)) if value == "B2A" => true,
            Some(other) => return Err(illegal(other, &["A2B", "B2A"])),
        };
        let scalar_first = match find("QUATERNION_TYPE") {
            None => false,
            Some((.., value)) if value == "LAST" => false,
            Some((.., value)) if value == "FIRST" => true,
            Some(other) => return Err(illegal(other, &["FIRST", "LAST"])),
        };
        Ok(Self {
            scale: scale.2.clone(),
            inverse: swapped != conjugated,
            scalar_first,
            numbers: *numbers,
            reference: if inertial.2 == "ECLIPJ2000" {
                Reference::Ecliptic
            } else {
                Reference::Icrf
            },
        })
    }

    /// The row of an epoch and its four numbers, in the file's order; those before it must be
    /// earlier.
    pub(super) fn row(
        &self,
        line: usize,
        epoch: &str,
        fields: [&str; 4],
        before: &[Row],
    ) -> Result<Row, HistoryError> {
        let bare = epoch.strip_suffix('Z').filter(|_| self.scale == "UTC").unwrap_or(epoch);
        let at = parse_time(&format!("{bare} {}", self.scale))
            .map_err(|fault| HistoryError::Time { line, fault })?;
        rising(before, at, line, epoch)?;
        let keys =
            if self.scalar_first { ["QC", "Q1", "Q2", "Q3"] } else { ["Q1", "Q2", "Q3", "QC"] };
        let mut values = [0.0; 4];
        for ((value, field), key) in values.iter_mut().zip(fields).zip(keys) {
            *value = number(line, key, field)?;
        }
        if self.scalar_first {
            values.rotate_left(1);
        }
        let quaternion = unit(line, values)?;
        let quaternion = if self.inverse { conjugate(quaternion) } else { quaternion };
        Ok(Row { line, at, quaternion })
    }

    /// The same with the scalar always last, as XML names it.
    pub(super) fn scalar_last(mut self) -> Self {
        self.scalar_first = false;
        self
    }
}
