//! What an AEM segment says about its attitudes.
//!
//! Version 2 \[CCSDS504\]: the quaternion takes components in `REF_FRAME_B` to components in
//! `REF_FRAME_A`, as B turned by +90 deg about A's z is (0, 0, 0.7071, 0.7071). Euler angles turn A
//! into B about B's own axes in the order of `EULER_ROT_SEQ`: `q = q_1(a_1) q_2(a_2) q_3(a_3)`. A
//! spin's axis is B's z, at `SPIN_ALPHA` and `SPIN_DELTA` in A, B's x `SPIN_ANGLE` from the ascending
//! node: `q = q_z(90 deg + alpha) q_x(90 deg - delta) q_z(angle)`.
//!
//! Version 1 says the sense with `ATTITUDE_DIR` (`A2B` as version 2, `B2A` the conjugate) and the
//! scalar's place in a line of KVN with `QUATERNION_TYPE`. One of the frames must be inertial, the
//! other the spacecraft's. Rates and nutation are passed over: the attitude at its epoch needs none.

use super::error::HistoryError;
use super::row::{Row, conjugate, number, rising, unit};
use ephem::ccsds::{Axes, Block, CcsdsError, Column, Expected, Legal, Record, epoch};
use ephem::time::Scale;

/// Names of inertial frames; those of ICRF's realisations too.
const INERTIAL: [&str; 5] = ["ICRF", "EME2000", "J2000", "GCRF", "ECLIPJ2000"];
/// Types of attitudes, and the numbers of a line that are passed over.
const TYPES: [(&str, usize); 11] = [
    ("QUATERNION", 0),
    ("QUATERNION/ANGVEL", 3),
    ("QUATERNION/DERIVATIVE", 4),
    ("QUATERNION/RATE", 3),
    ("EULER_ANGLE", 0),
    ("EULER_ANGLE/ANGVEL", 3),
    ("EULER_ANGLE/DERIVATIVE", 3),
    ("EULER_ANGLE/RATE", 3),
    ("SPIN", 1),
    ("SPIN/NUTATION", 4),
    ("SPIN/NUTATION_MOM", 4),
];
const SCALAR_LAST: [&str; 4] = ["Q1", "Q2", "Q3", "QC"];
const SCALAR_FIRST: [&str; 4] = ["QC", "Q1", "Q2", "Q3"];
const ANGLES: [&str; 3] = ["ANGLE_1", "ANGLE_2", "ANGLE_3"];
const SPIN: [&str; 3] = ["SPIN_ALPHA", "SPIN_DELTA", "SPIN_ANGLE"];
const SEQUENCES: &str = "three of X, Y, Z (or of 1, 2, 3), such as ZXZ, no two alike side by side";

/// What the numbers of a record are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Numbers {
    ScalarLast,
    ScalarFirst,
    /// Angles about these axes, 0 to 2.
    Euler([usize; 3]),
    Spin,
}

impl Numbers {
    /// Their names in the order of a line.
    const fn names(self) -> &'static [&'static str] {
        match self {
            Self::ScalarLast => &SCALAR_LAST,
            Self::ScalarFirst => &SCALAR_FIRST,
            Self::Euler(_) => &ANGLES,
            Self::Spin => &SPIN,
        }
    }

    const fn unit(self) -> Option<&'static str> {
        match self {
            Self::ScalarLast | Self::ScalarFirst => None,
            Self::Euler(_) | Self::Spin => Some("deg"),
        }
    }

    /// The quaternion, B to A.
    fn quaternion(self, line: usize, values: &[f64]) -> Result<[f64; 4], HistoryError> {
        let turned = |turns: [(usize, f64); 3]| {
            turns
                .map(|(axis, degrees)| about(axis, degrees.to_radians()))
                .into_iter()
                .fold([0.0, 0.0, 0.0, 1.0], product)
        };
        match (self, values) {
            (Self::ScalarLast, &[x, y, z, w]) | (Self::ScalarFirst, &[w, x, y, z]) => {
                unit(line, [x, y, z, w])
            }
            (Self::Euler([first, second, third]), &[a, b, c]) => {
                Ok(turned([(first, a), (second, b), (third, c)]))
            }
            (Self::Spin, &[alpha, delta, angle]) => {
                Ok(turned([(2, 90.0 + alpha), (0, 90.0 - delta), (2, angle)]))
            }
            _ => Err(HistoryError::NoRows),
        }
    }
}

/// A turn about an axis, 0 to 2.
fn about(axis: usize, angle_rad: f64) -> [f64; 4] {
    let (sin, cos) = (angle_rad / 2.0).sin_cos();
    let part = |of: usize| if of == axis { sin } else { 0.0 };
    [part(0), part(1), part(2), cos]
}

/// The Hamilton product.
fn product(left: [f64; 4], right: [f64; 4]) -> [f64; 4] {
    let dot = left[0] * right[0] + left[1] * right[1] + left[2] * right[2];
    let part = |of: usize| {
        let (next, last) = ((of + 1) % 3, (of + 2) % 3);
        let cross = left[next] * right[last] - left[last] * right[next];
        left[3] * right[of] + right[3] * left[of] + cross
    };
    [part(0), part(1), part(2), left[3] * right[3] - dot]
}

/// The axes of an `EULER_ROT_SEQ`.
fn sequence(text: &str) -> Option<[usize; 3]> {
    let place = |name: char| "XYZ".find(name.to_ascii_uppercase()).or_else(|| "123".find(name));
    let places: Vec<usize> = text.chars().map(place).collect::<Option<_>>()?;
    let axes: [usize; 3] = places.try_into().ok()?;
    (axes[0] != axes[1] && axes[1] != axes[2]).then_some(axes)
}

/// How a segment's records are read.
pub(super) struct Meta {
    scale: Scale,
    inverse: bool,
    numbers: Numbers,
    /// Numbers of a line after those.
    more: usize,
    /// The inertial frame's.
    pub(super) axes: Axes,
}

impl Meta {
    /// From a segment's metadata.
    pub(super) fn read(block: &Block<'_>) -> Result<Self, CcsdsError> {
        let scale = block.time_system()?;
        let name = block.need("ATTITUDE_TYPE")?.one_of(&TYPES.map(|it| it.0))?;
        let more = TYPES.iter().find(|it| it.0 == name).map_or(0, |it| it.1);
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
        let numbers = if name.starts_with("EULER") {
            let order = block.need("EULER_ROT_SEQ")?;
            let axes = sequence(order.value);
            Numbers::Euler(axes.ok_or_else(|| order.illegal(Legal::OneOf(vec![SEQUENCES])))?)
        } else if name.starts_with("SPIN") {
            Numbers::Spin
        } else if scalar_first {
            Numbers::ScalarFirst
        } else {
            Numbers::ScalarLast
        };
        Ok(Self { scale, inverse: swapped != conjugated, numbers, more, axes })
    }

    /// The row of a record; the one before it must be earlier.
    pub(super) fn row(
        &self,
        record: &Record<'_>,
        before: Option<&Row>,
    ) -> Result<Row, HistoryError> {
        let line = record.line;
        let names = self.numbers.names();
        let column = |&key: &&'static str| Column { key, unit: self.numbers.unit() };
        let columns: Vec<Column> =
            std::iter::once(Column::of("EPOCH")).chain(names.iter().map(column)).collect();
        let refuse = || record.refused(Expected::Numbers(names.len() + self.more));
        let fields = record.fields(&columns, &[self.more])?.ok_or_else(refuse)?;
        let [text, ref numbers @ ..] = fields[..] else { return Err(refuse().into()) };
        let at = epoch(line, "epoch", text, self.scale)?;
        rising(before, at, line, text)?;
        let values: Vec<f64> = numbers
            .iter()
            .zip(names)
            .map(|(field, &key)| number(line, key, field))
            .collect::<Result<_, _>>()?;
        let quaternion = self.numbers.quaternion(line, &values)?;
        let quaternion = if self.inverse { conjugate(quaternion) } else { quaternion };
        Ok(Row { line, at, quaternion })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B's axes in A.
    fn axes(quaternion: [f64; 4]) -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|[x, y, z]| {
            let turned = product(product(quaternion, [x, y, z, 0.0]), conjugate(quaternion));
            [turned[0], turned[1], turned[2]]
        })
    }

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn angles_turn_about_axes_that_have_turned() {
        let zxz = Numbers::Euler(sequence("zxz").unwrap());
        assert_eq!(zxz, Numbers::Euler(sequence("313").unwrap()));
        // 90 deg about z, then 90 deg about the new x, which is A's y: z goes to A's x.
        let [x, y, z] = axes(zxz.quaternion(1, &[90.0, 90.0, 0.0]).unwrap());
        assert!(near(x, [0.0, 1.0, 0.0]) && near(y, [0.0, 0.0, 1.0]) && near(z, [1.0, 0.0, 0.0]));
        for bad in ["ZZX", "XY", "ABC", "1234", ""] {
            assert_eq!(sequence(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_spin_axis_has_its_right_ascension_and_declination() {
        let [x, _, z] = axes(Numbers::Spin.quaternion(1, &[30.0, 40.0, 0.0]).unwrap());
        let (alpha, delta) = (30.0_f64.to_radians(), 40.0_f64.to_radians());
        let pole = [delta.cos() * alpha.cos(), delta.cos() * alpha.sin(), delta.sin()];
        // The ascending node is 90 deg from the axis's right ascension, on the equator.
        assert!(near(z, pole) && near(x, [-alpha.sin(), alpha.cos(), 0.0]));
        let [x, y, _] = axes(Numbers::Spin.quaternion(1, &[30.0, 40.0, 90.0]).unwrap());
        let [node, other, _] = axes(Numbers::Spin.quaternion(1, &[30.0, 40.0, 0.0]).unwrap());
        assert!(near(x, other) && near(y, node.map(|it| -it)));
    }
}
