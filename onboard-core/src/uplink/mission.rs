//! The mission as the spacecraft needs it: strategy, Sun model, telescopes.
//!
//! | bytes | field |
//! |---|---|
//! | 0..8 | start, i64 ns of TAI |
//! | 8..24 | alpha, beta, f64 rad |
//! | 24..40, 40..48 | precession rate u128 (2^-128 turn/ns), start phase u64 (2^-64 turn) |
//! | 48..64, 64..72 | spin rate, start phase |
//! | 72..88, 88..96 | circular Sun: rate, start longitude; zero with the table's Sun |
//! | 96..98 | Sun model, u16: 0 table, 1 circular |
//! | 98..100 | number of telescopes, u16 |
//! | 100..104 | zero |
//! | 104.. | telescopes, 80 bytes each |
//!
//! | bytes of a telescope | field |
//! |---|---|
//! | 0..32 | rotation into the boresight frame, x y z w, f64 |
//! | 32..48, 48..56 | half-wave plate: rate, start phase; rate zero without a plate |
//! | 56..72 | field of view: radius and zero, or width and height, f64 rad |
//! | 72..74 | 1 circle, 2 rectangle, u16 |
//! | 74..80 | zero |

use crate::bytes::{f64_at, field, i64_at, put, u16_at, u64_at, u128_at};
use crate::ephemeris::{EphemerisError, EphemerisTable, SUN};
use crate::field_of_view::{FieldOfView, FieldOfViewError, FieldShape};
use crate::frame::{Boresight, Telescope};
use crate::phase::{Phase, Rotor, TurnRate};
use crate::rotation::{Rotation, RotationError};
use crate::scan::{ScanError, ScanParameters, ScanStrategy};
use crate::sun::SunModel;
use crate::time::Instant;

const FIXED_BYTES: usize = 104;
const TELESCOPE_BYTES: usize = 80;

/// Why a mission section is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MissionError {
    /// Fewer or more bytes than the number of telescopes says.
    WrongLength,
    /// An unknown Sun model (its number).
    SunModel(u16),
    /// A telescope's (its index) field of view has an unknown shape, or spare bytes are not zero.
    Telescope(u16),
    /// The scanning strategy is illegal.
    Scan(ScanError),
    /// A telescope's rotation is illegal.
    Rotation(RotationError),
    /// A telescope's field of view is illegal.
    FieldOfView(FieldOfViewError),
}

/// Which Sun model the mission uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SunRecord {
    /// Body [`SUN`] of the ephemeris section.
    Table,
    /// Uniform motion in longitude.
    Circular(Rotor),
}

/// One telescope.
#[derive(Debug, Clone, Copy)]
pub struct TelescopeRecord {
    /// Its frame in the mission boresight frame.
    pub rotation: Rotation<Telescope, Boresight>,
    /// Its half-wave plate, if it has one.
    pub hwp: Option<Rotor>,
    /// What it sees.
    pub field: FieldShape,
}

/// A checked mission section in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct MissionTable<'a> {
    strategy: ScanStrategy,
    sun: SunRecord,
    telescopes: &'a [[u8; TELESCOPE_BYTES]],
}

impl<'a> MissionTable<'a> {
    /// Checks and borrows a section.
    ///
    /// # Errors
    /// [`MissionError`], the first thing found wrong.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, MissionError> {
        let (fixed, rest) = bytes.split_at_checked(FIXED_BYTES).ok_or(MissionError::WrongLength)?;
        let (parameters, sun, count) = read_fixed(fixed)?;
        let (telescopes, spare) = rest.as_chunks::<TELESCOPE_BYTES>();
        if telescopes.len() != usize::from(count) || !spare.is_empty() {
            return Err(MissionError::WrongLength);
        }
        let strategy = ScanStrategy::new(parameters).map_err(MissionError::Scan)?;
        let mut index = 0_u16;
        for record in telescopes {
            let telescope = read_telescope(record, index)?;
            telescope.field_of_view().map_err(MissionError::FieldOfView)?;
            index = index.wrapping_add(1);
        }
        Ok(Self { strategy, sun, telescopes })
    }

    /// The scanning strategy.
    #[must_use]
    pub const fn strategy(&self) -> ScanStrategy {
        self.strategy
    }

    /// The Sun model, on the ephemeris of the same container.
    ///
    /// # Errors
    /// [`EphemerisError::NoSuchBody`] when the model needs the table and it has no Sun.
    pub fn sun(&self, table: EphemerisTable<'a>) -> Result<SunModel<'a>, EphemerisError> {
        match self.sun {
            SunRecord::Table => table.body(SUN).map(SunModel::Table),
            SunRecord::Circular(longitude) => Ok(SunModel::Circular(longitude)),
        }
    }

    /// The telescopes in the mission's order.
    pub fn telescopes(&self) -> impl Iterator<Item = TelescopeRecord> + 'a {
        self.telescopes.iter().filter_map(|record| read_telescope(record, 0).ok())
    }

    /// The bytes before the telescopes.
    #[must_use]
    pub fn fixed_to_le_bytes(
        parameters: &ScanParameters,
        sun: SunRecord,
        telescopes: u16,
    ) -> [u8; FIXED_BYTES] {
        let mut bytes = [0; FIXED_BYTES];
        put(&mut bytes, 0, parameters.start.tai_ns().to_le_bytes());
        put(&mut bytes, 8, parameters.alpha_rad.to_le_bytes());
        put(&mut bytes, 16, parameters.beta_rad.to_le_bytes());
        put_rotor(&mut bytes, 24, parameters.precession);
        put_rotor(&mut bytes, 48, parameters.spin);
        if let SunRecord::Circular(longitude) = sun {
            put_rotor(&mut bytes, 72, longitude);
            put(&mut bytes, 96, 1_u16.to_le_bytes());
        }
        put(&mut bytes, 98, telescopes.to_le_bytes());
        bytes
    }
}

impl TelescopeRecord {
    /// The telescope's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; TELESCOPE_BYTES] {
        let mut bytes = [0; TELESCOPE_BYTES];
        let [x, y, z, w] = self.rotation.to_xyzw();
        put(&mut bytes, 0, x.to_le_bytes());
        put(&mut bytes, 8, y.to_le_bytes());
        put(&mut bytes, 16, z.to_le_bytes());
        put(&mut bytes, 24, w.to_le_bytes());
        if let Some(plate) = self.hwp {
            put_rotor(&mut bytes, 32, plate);
        }
        let (first, second, shape) = match self.field {
            FieldShape::Circle(radius) => (radius, 0.0, 1_u16),
            FieldShape::Rectangle(width, height) => (width, height, 2_u16),
        };
        put(&mut bytes, 56, first.to_le_bytes());
        put(&mut bytes, 64, second.to_le_bytes());
        put(&mut bytes, 72, shape.to_le_bytes());
        bytes
    }

    /// What the telescope sees.
    ///
    /// # Errors
    /// [`FieldOfViewError`] when a size is out of range.
    pub fn field_of_view(&self) -> Result<FieldOfView, FieldOfViewError> {
        FieldOfView::new(self.rotation, self.field)
    }
}

fn put_rotor(bytes: &mut [u8], offset: usize, rotor: Rotor) {
    put(bytes, offset, rotor.rate.bits().to_le_bytes());
    put(bytes, offset.wrapping_add(16), rotor.start.bits().to_le_bytes());
}

fn rotor_at(bytes: &[u8], offset: usize) -> Option<Rotor> {
    Some(Rotor {
        rate: TurnRate::from_bits(u128_at(bytes, offset)?),
        start: Phase::from_bits(u64_at(bytes, offset.wrapping_add(16))?),
    })
}

fn read_fixed(bytes: &[u8]) -> Result<(ScanParameters, SunRecord, u16), MissionError> {
    let read = || {
        let parameters = ScanParameters {
            start: Instant::from_tai_ns(i64_at(bytes, 0)?),
            alpha_rad: f64_at(bytes, 8)?,
            beta_rad: f64_at(bytes, 16)?,
            precession: rotor_at(bytes, 24)?,
            spin: rotor_at(bytes, 48)?,
        };
        Some((parameters, rotor_at(bytes, 72)?, u16_at(bytes, 96)?, u16_at(bytes, 98)?))
    };
    let (parameters, longitude, model, count) = read().ok_or(MissionError::WrongLength)?;
    let sun = match model {
        0 => SunRecord::Table,
        1 => SunRecord::Circular(longitude),
        other => return Err(MissionError::SunModel(other)),
    };
    Ok((parameters, sun, count))
}

fn read_telescope(
    record: &[u8; TELESCOPE_BYTES],
    index: u16,
) -> Result<TelescopeRecord, MissionError> {
    let bad = MissionError::Telescope(index);
    let number = |offset| f64_at(record, offset).ok_or(bad);
    let xyzw = [number(0)?, number(8)?, number(16)?, number(24)?];
    let plate = rotor_at(record, 32).ok_or(bad)?;
    let (first, second) = (number(56)?, number(64)?);
    let shape_record = match u16_at(record, 72) {
        Some(1) => FieldShape::Circle(first),
        Some(2) => FieldShape::Rectangle(first, second),
        _ => return Err(bad),
    };
    if field(record, 74) != Some([0_u8; 6]) {
        return Err(bad);
    }
    Ok(TelescopeRecord {
        rotation: Rotation::from_xyzw(xyzw).map_err(MissionError::Rotation)?,
        hwp: (plate.rate.bits() != 0).then_some(plate),
        field: shape_record,
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn section() -> (ScanParameters, Vec<u8>) {
        let rotor = |rate: u128, start| Rotor {
            rate: TurnRate::from_bits(rate),
            start: Phase::from_bits(start),
        };
        let parameters = ScanParameters {
            start: Instant::from_tai_ns(42),
            alpha_rad: 0.7,
            beta_rad: 0.8,
            precession: rotor(1 << 90, 3),
            spin: rotor((1_u128 << 91).wrapping_neg(), 4),
        };
        let sun = SunRecord::Circular(rotor(1 << 70, 5));
        let mut bytes = MissionTable::fixed_to_le_bytes(&parameters, sun, 2).to_vec();
        for (hwp, field) in [
            (Some(rotor(1 << 95, 6)), FieldShape::Circle(0.2)),
            (None, FieldShape::Rectangle(0.3, 0.1)),
        ] {
            let telescope = TelescopeRecord { rotation: Rotation::about_z(0.5), hwp, field };
            bytes.extend(telescope.to_le_bytes());
        }
        (parameters, bytes)
    }

    #[test]
    fn a_mission_comes_back() {
        let (parameters, bytes) = section();
        let mission = MissionTable::parse(&bytes).unwrap();
        assert_eq!(*mission.strategy().parameters(), parameters);
        let telescopes: Vec<_> = mission.telescopes().collect();
        assert_eq!(telescopes.len(), 2);
        assert_eq!(telescopes[0].field, FieldShape::Circle(0.2));
        assert!(telescopes[0].hwp.is_some() && telescopes[1].hwp.is_none());
        assert_eq!(telescopes[1].field, FieldShape::Rectangle(0.3, 0.1));
    }

    #[test]
    fn illegal_fields_are_named() {
        let (_, good) = section();
        let with = |offset: usize, new: &[u8]| {
            let mut bytes = good.clone();
            bytes[offset..offset + new.len()].copy_from_slice(new);
            MissionTable::parse(&bytes).map(|_| ()).unwrap_err()
        };
        assert_eq!(with(96, &[7, 0]), MissionError::SunModel(7));
        assert_eq!(with(98, &[3, 0]), MissionError::WrongLength);
        assert_eq!(with(104 + 72, &[9, 0]), MissionError::Telescope(0));
        assert_eq!(with(184 + 74, &[1]), MissionError::Telescope(1));
        assert_eq!(with(8, &4.0_f64.to_le_bytes()), MissionError::Scan(ScanError::Alpha(4.0)));
        assert_eq!(
            with(104 + 56, &0.0_f64.to_le_bytes()),
            MissionError::FieldOfView(FieldOfViewError::Radius(0.0))
        );
    }
}
