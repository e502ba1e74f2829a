//! What an AEM segment says about its quaternions.
//!
//! Version 2 \[CCSDS504\]: the quaternion takes components in `REF_FRAME_B` to components in
//! `REF_FRAME_A`, as B turned by +90 deg about A's z is (0, 0, 0.7071, 0.7071). Version 1 says the
//! sense with `ATTITUDE_DIR` (`A2B` as version 2, `B2A` the conjugate) and the scalar's place in a
//! line of KVN with `QUATERNION_TYPE`. One of the frames must be inertial, the other the
//! spacecraft's.

use super::error::HistoryError;
use super::row::{Row, conjugate, number, rising, unit};
use ephem::ccsds::{Axes, Block, CcsdsError, Column, Expected, Legal, Record, epoch};
use ephem::time::Scale;

/// Names of inertial frames; those of ICRF's realisations too.
const INERTIAL: [&str; 5] = ["ICRF", "EME2000", "J2000", "GCRF", "ECLIPJ2000"];
const TYPES: [&str; 4] =
    ["QUATERNION", "QUATERNION/ANGVEL", "QUATERNION/DERIVATIVE", "QUATERNION/RATE"];
const SCALAR_LAST: [&str; 4] = ["Q1", "Q2", "Q3", "QC"];
const SCALAR_FIRST: [&str; 4] = ["QC", "Q1", "Q2", "Q3"];

/// How a segment's records are read.
pub(super) struct Meta {
    scale: Scale,
    inverse: bool,
    /// Names of the quaternion's components in the order of a line.
    components: [&'static str; 4],
    /// Numbers of a line after the quaternion.
    more: usize,
    /// The inertial frame's.
    pub(super) axes: Axes,
}

impl Meta {
    /// From a segment's metadata.
    pub(super) fn read(block: &Block<'_>) -> Result<Self, CcsdsError> {
        let scale = block.time_system()?;
        let more = match block.need("ATTITUDE_TYPE")?.one_of(&TYPES)? {
            "QUATERNION" => 0,
            "QUATERNION/DERIVATIVE" => 4,
            _ => 3,
        };
        let (a, b) = (block.need("REF_FRAME_A")?, block.need("REF_FRAME_B")?);
        let (axes, swapped) = match (Axes::from_name(a.value), Axes::from_name(b.value)) {
            (Some(axes), None) => (axes, false),
            (None, Some(axes)) => (axes, true),
            (None, None) => return Err(a.illegal(Legal::OneOf(INERTIAL.to_vec()))),
            (Some(_), Some(_)) => {
                let body = "a frame of the spacecraft, such as SC_BODY_1";
                return Err(b.illegal(Legal::OneOf(vec![body])));
            }
        };
        let one_of = |key, legal: &[&'static str]| {
            block.find(key).map(|entry| entry.one_of(legal)).transpose()
        };
        let conjugated = one_of("ATTITUDE_DIR", &["A2B", "B2A"])? == Some("B2A");
        let scalar_first = one_of("QUATERNION_TYPE", &["FIRST", "LAST"])? == Some("FIRST");
        Ok(Self {
            scale,
            inverse: swapped != conjugated,
            components: if scalar_first { SCALAR_FIRST } else { SCALAR_LAST },
            more,
            axes,
        })
    }

    /// The row of a record; the one before it must be earlier.
    pub(super) fn row(
        &self,
        record: &Record<'_>,
        before: Option<&Row>,
    ) -> Result<Row, HistoryError> {
        let line = record.line;
        let [q0, q1, q2, q3] = self.components.map(Column::of);
        let columns = [Column::of("EPOCH"), q0, q1, q2, q3];
        let refuse = || record.refused(Expected::Numbers(self.components.len() + self.more));
        let fields = record.fields(&columns, &[self.more])?.ok_or_else(refuse)?;
        let [text, ref numbers @ ..] = fields[..] else { return Err(refuse().into()) };
        let at = epoch(line, "epoch", text, self.scale)?;
        rising(before, at, line, text)?;
        let mut values = [0.0; 4];
        for ((value, field), key) in values.iter_mut().zip(numbers).zip(self.components) {
            *value = number(line, key, field)?;
        }
        if self.components == SCALAR_FIRST {
            values.rotate_left(1);
        }
        let quaternion = unit(line, values)?;
        let quaternion = if self.inverse { conjugate(quaternion) } else { quaternion };
        Ok(Row { line, at, quaternion })
    }
}
