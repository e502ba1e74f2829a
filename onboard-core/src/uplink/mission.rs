//! The mission as the spacecraft needs it: strategy, Sun model, telescopes, detectors, avoidance.
//!
//! | bytes | field |
//! |---|---|
//! | 0..8 | start, i64 ns of TAI |
//! | 8..24 | alpha, beta, f64 rad |
//! | 24..40, 40..48 | precession rate u128 (2^-128 turn/ns), start phase u64 (2^-64 turn) |
//! | 48..64, 64..72 | spin rate, start phase |
//! | 72..88, 88..96 | circular Sun: rate, start longitude; zero with the table's Sun |
//! | 96..98 | Sun model, u16: 0 table, 1 circular |
//! | 98..100, 100..102, 102..104 | numbers of telescopes, listed detectors, avoidance limits, u16 |
//! | 104..112 | radius about a listed detector's line of sight, f64 rad |
//! | 112.. | telescopes, 80 bytes each |
//! | then | listed detectors, 40 bytes each, by telescope |
//! | then | avoidance limits, 16 bytes each |
//!
//! | bytes of a telescope | field |
//! |---|---|
//! | 0..32 | rotation into the boresight frame, x y z w, f64 |
//! | 32..48, 48..56 | half-wave plate: rate, start phase; rate zero without a plate |
//! | 56..72 | field of view: radius and zero, or width and height, f64 rad |
//! | 72..74 | 1 circle, 2 rectangle, u16 |
//! | 74..80 | zero |
//!
//! | bytes of a detector | field |
//! |---|---|
//! | 0..32 | rotation into the boresight frame, x y z w, f64 |
//! | 32..34 | its telescope's index, u16 |
//! | 34..40 | zero |
//!
//! | bytes of an avoidance limit | field |
//! |---|---|
//! | 0..8 | smallest angle between the body and a field of view, f64 rad |
//! | 8..12 | body number, i32 |
//! | 12..16 | zero |

use crate::bytes::{f64_at, field, i32_at, put, put_rotor, rotor_at, u16_at, u32_at};
use crate::ephemeris::{EphemerisError, EphemerisTable, SUN};
use crate::field_of_view::{FieldOfView, FieldOfViewError, FieldShape};
use crate::frame::{Boresight, Detector, Telescope};
use crate::phase::{Phase, Rotor};
use crate::rotation::{Rotation, RotationError};
use crate::scan::{ScanError, ScanParameters, ScanStrategy};
use crate::sun::SunModel;
use core::f64::consts::PI;

const FIXED_BYTES: usize = 112;
const TELESCOPE_BYTES: usize = 80;
const DETECTOR_BYTES: usize = 40;
const AVOIDANCE_BYTES: usize = 16;

/// Why a mission section is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum MissionError {
    /// Fewer or more bytes than the numbers of records say.
    WrongLength,
    /// An unknown Sun model (its number), or a circular Sun beside the table's.
    SunModel(u16),
    /// A telescope's (its index) field of view has an unknown shape, its half-wave plate a phase
    /// but no rate, or spare bytes are not zero.
    Telescope(u16),
    /// A detector (its index) names a telescope that is not there, breaks their order, or has spare
    /// bytes that are not zero.
    Detector(u16),
    /// An avoidance limit (its index) is not an angle in (0, pi], or has spare bytes that are not
    /// zero.
    Avoidance(u16),
    /// The scanning strategy is illegal.
    Scan(ScanError),
    /// A telescope's or detector's rotation is illegal.
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

/// One listed detector.
#[derive(Debug, Clone, Copy)]
pub struct DetectorRecord {
    /// Its frame in the mission boresight frame.
    pub rotation: Rotation<Detector, Boresight>,
    /// Its telescope's index.
    pub telescope: u16,
}

/// A body that fields of view must keep away from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoidanceRecord {
    /// Body number of its apparent direction in the ephemeris section.
    pub body: i32,
    /// Smallest angle between the body and the nearest point of a field of view, rad.
    pub angle_rad: f64,
}

/// How many records of each kind a mission section has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Telescopes.
    pub telescopes: u16,
    /// Listed detectors, of all telescopes.
    pub detectors: u16,
    /// Avoidance limits.
    pub avoidance: u16,
}

/// A checked mission section in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct MissionTable<'a> {
    fixed: &'a [u8; FIXED_BYTES],
    telescopes: &'a [[u8; TELESCOPE_BYTES]],
    detectors: &'a [[u8; DETECTOR_BYTES]],
    avoidance: &'a [[u8; AVOIDANCE_BYTES]],
}

impl<'a> MissionTable<'a> {
    /// Checks and borrows a section.
    ///
    /// # Errors
    /// [`MissionError`], the first thing found wrong.
    #[inline(never)]
    pub fn parse(bytes: &'a [u8]) -> Result<Self, MissionError> {
        let short = MissionError::WrongLength;
        let (fixed, rest) = bytes.split_first_chunk::<FIXED_BYTES>().ok_or(short)?;
        let count = |offset| u16_at(fixed, offset).ok_or(short);
        let (telescopes, rest) = records::<TELESCOPE_BYTES>(rest, count(98)?)?;
        let (detectors, rest) = records::<DETECTOR_BYTES>(rest, count(100)?)?;
        let (avoidance, rest) = records::<AVOIDANCE_BYTES>(rest, count(102)?)?;
        if !rest.is_empty() {
            return Err(short);
        }
        let table = Self { fixed, telescopes, detectors, avoidance };
        table.check_fixed()?;
        table.check_records(count(98)?)?;
        Ok(table)
    }

    /// The bytes before the telescopes are legal.
    #[inline(never)]
    fn check_fixed(&self) -> Result<(), MissionError> {
        match u16_at(self.fixed, 96) {
            Some(0) if field(self.fixed, 72) == Some([0_u8; 24]) => {}
            Some(1) => {}
            model => return Err(MissionError::SunModel(model.unwrap_or(0))),
        }
        let parameters = self.parameters().ok_or(MissionError::WrongLength)?;
        ScanStrategy::check(&parameters).map_err(MissionError::Scan)
    }

    /// Every record is legal.
    #[inline(never)]
    fn check_records(&self, telescopes: u16) -> Result<(), MissionError> {
        let mut index = 0_u16;
        for record in self.telescopes {
            let telescope = read_telescope(record, index)?;
            telescope.field.check().map_err(MissionError::FieldOfView)?;
            index = index.wrapping_add(1);
        }
        let mut index = 0_u16;
        let mut before = 0_u16;
        for record in self.detectors {
            let detector = read_detector(record, index)?;
            if detector.telescope < before || detector.telescope >= telescopes {
                return Err(MissionError::Detector(index));
            }
            before = detector.telescope;
            index = index.wrapping_add(1);
        }
        if !self.detectors.is_empty() {
            let field = FieldShape::Circle(self.detector_radius_rad());
            field.check().map_err(MissionError::FieldOfView)?;
        }
        let mut index = 0_u16;
        for record in self.avoidance {
            read_avoidance(record).ok_or(MissionError::Avoidance(index))?;
            index = index.wrapping_add(1);
        }
        Ok(())
    }

    fn parameters(&self) -> Option<ScanParameters> {
        ScanParameters::from_le_bytes(self.fixed)
    }

    /// The scanning strategy, made from the bytes at each call: keep it.
    #[must_use]
    #[inline(never)]
    pub fn strategy(&self) -> ScanStrategy {
        // The bytes are there and were checked; the still strategy stands for what cannot be.
        ScanStrategy::of_checked(self.parameters().unwrap_or(ScanParameters::STILL))
    }

    /// Which Sun model the mission uses.
    #[must_use]
    #[inline(never)]
    pub fn sun_record(&self) -> SunRecord {
        match (u16_at(self.fixed, 96), rotor_at(self.fixed, 72)) {
            (Some(1), Some(longitude)) => SunRecord::Circular(longitude),
            _ => SunRecord::Table,
        }
    }

    /// Radius about a listed detector's line of sight, rad.
    #[must_use]
    pub fn detector_radius_rad(&self) -> f64 {
        f64_at(self.fixed, 104).unwrap_or(0.0)
    }

    /// The Sun model, on the ephemeris of the same container.
    ///
    /// # Errors
    /// [`EphemerisError::NoSuchBody`] when the model needs the table and it has no Sun.
    #[inline(never)]
    pub fn sun(&self, table: EphemerisTable<'a>) -> Result<SunModel<'a>, EphemerisError> {
        match self.sun_record() {
            SunRecord::Table => table.body(SUN).map(SunModel::Table),
            SunRecord::Circular(longitude) => Ok(SunModel::Circular(longitude)),
        }
    }

    /// The telescopes in the mission's order.
    pub fn telescopes(&self) -> impl Iterator<Item = TelescopeRecord> + 'a {
        self.telescopes.iter().filter_map(|record| read_telescope(record, 0).ok())
    }

    /// The telescope at `index` in the mission's order.
    #[must_use]
    #[inline(never)]
    pub fn telescope(&self, index: u16) -> Option<TelescopeRecord> {
        read_telescope(self.telescopes.get(usize::from(index))?, index).ok()
    }

    /// The listed detectors, by telescope.
    pub fn detectors(&self) -> impl Iterator<Item = DetectorRecord> + 'a {
        self.detectors.iter().filter_map(|record| read_detector(record, 0).ok())
    }

    /// How many detectors belong to telescopes before this number.
    #[inline(never)]
    fn detectors_before(&self, telescope: u32) -> usize {
        self.detectors
            .partition_point(|record| u32::from(u16_at(record, 32).unwrap_or(u16::MAX)) < telescope)
    }

    /// What a telescope is calibrated through: the `index`-th of its listed detectors' circles, or
    /// its field of view alone when none is listed.
    #[must_use]
    #[inline(never)]
    pub fn calibration_field(&self, telescope: u16, index: u16) -> Option<FieldOfView> {
        let telescope_number = u32::from(telescope);
        let first = self.detectors_before(telescope_number);
        let own =
            self.detectors.get(first..self.detectors_before(telescope_number.wrapping_add(1)))?;
        if own.is_empty() {
            return match index {
                0 => self.telescope(telescope).as_ref()?.field_of_view().ok(),
                _ => None,
            };
        }
        let detector = read_detector(own.get(usize::from(index))?, index).ok()?;
        FieldOfView::circle(detector.rotation, self.detector_radius_rad()).ok()
    }

    /// The avoidance limits.
    pub fn avoidance(&self) -> impl Iterator<Item = AvoidanceRecord> + 'a {
        self.avoidance.iter().filter_map(read_avoidance)
    }

    /// The avoidance limit at `index`.
    #[must_use]
    #[inline(never)]
    pub fn avoidance_limit(&self, index: u16) -> Option<AvoidanceRecord> {
        read_avoidance(self.avoidance.get(usize::from(index))?)
    }

    /// The bytes before the telescopes.
    #[must_use]
    pub fn fixed_to_le_bytes(
        parameters: &ScanParameters,
        sun: SunRecord,
        counts: Counts,
        detector_radius_rad: f64,
    ) -> [u8; FIXED_BYTES] {
        let mut bytes = [0; FIXED_BYTES];
        put(&mut bytes, 0, parameters.to_le_bytes());
        if let SunRecord::Circular(longitude) = sun {
            put_rotor(&mut bytes, 72, longitude);
            put(&mut bytes, 96, 1_u16.to_le_bytes());
        }
        put(&mut bytes, 98, counts.telescopes.to_le_bytes());
        put(&mut bytes, 100, counts.detectors.to_le_bytes());
        put(&mut bytes, 102, counts.avoidance.to_le_bytes());
        put(&mut bytes, 104, detector_radius_rad.to_le_bytes());
        bytes
    }
}

impl TelescopeRecord {
    /// The telescope's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; TELESCOPE_BYTES] {
        let mut bytes = [0; TELESCOPE_BYTES];
        put_rotation(&mut bytes, self.rotation);
        if let Some(plate) = self.hwp {
            put_rotor(&mut bytes, 32, plate);
        }
        let (first, second, shape) = match self.field {
            FieldShape::Circle(radius) => (radius, 0.0, 1_u16),
            FieldShape::Rectangle { width_rad, height_rad } => (width_rad, height_rad, 2_u16),
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
    #[inline(never)]
    pub fn field_of_view(&self) -> Result<FieldOfView, FieldOfViewError> {
        FieldOfView::new(self.rotation, self.field)
    }
}

impl DetectorRecord {
    /// The detector's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; DETECTOR_BYTES] {
        let mut bytes = [0; DETECTOR_BYTES];
        put_rotation(&mut bytes, self.rotation);
        put(&mut bytes, 32, self.telescope.to_le_bytes());
        bytes
    }
}

impl AvoidanceRecord {
    /// The limit's bytes.
    #[must_use]
    pub fn to_le_bytes(&self) -> [u8; AVOIDANCE_BYTES] {
        let mut bytes = [0; AVOIDANCE_BYTES];
        put(&mut bytes, 0, self.angle_rad.to_le_bytes());
        put(&mut bytes, 8, self.body.to_le_bytes());
        bytes
    }
}

/// The next `count` records, and what follows them.
fn records<const N: usize>(bytes: &[u8], count: u16) -> Result<(&[[u8; N]], &[u8]), MissionError> {
    let size = usize::from(count).wrapping_mul(N);
    let (own, rest) = bytes.split_at_checked(size).ok_or(MissionError::WrongLength)?;
    Ok((own.as_chunks::<N>().0, rest))
}

fn put_rotation<F>(bytes: &mut [u8], rotation: Rotation<F, Boresight>) {
    let [x, y, z, w] = rotation.to_xyzw();
    put(bytes, 0, x.to_le_bytes());
    put(bytes, 8, y.to_le_bytes());
    put(bytes, 16, z.to_le_bytes());
    put(bytes, 24, w.to_le_bytes());
}

fn rotation_at<F>(bytes: &[u8], bad: MissionError) -> Result<Rotation<F, Boresight>, MissionError> {
    let number = |offset| f64_at(bytes, offset).ok_or(bad);
    let xyzw = [number(0)?, number(8)?, number(16)?, number(24)?];
    Rotation::from_xyzw(xyzw).map_err(MissionError::Rotation)
}

#[inline(never)]
fn read_detector(
    record: &[u8; DETECTOR_BYTES],
    index: u16,
) -> Result<DetectorRecord, MissionError> {
    let bad = MissionError::Detector(index);
    if field(record, 34) != Some([0_u8; 6]) {
        return Err(bad);
    }
    Ok(DetectorRecord {
        rotation: rotation_at(record, bad)?,
        telescope: u16_at(record, 32).ok_or(bad)?,
    })
}

#[inline(never)]
fn read_avoidance(record: &[u8; AVOIDANCE_BYTES]) -> Option<AvoidanceRecord> {
    let limit = AvoidanceRecord { body: i32_at(record, 8)?, angle_rad: f64_at(record, 0)? };
    let legal = limit.angle_rad > 0.0 && limit.angle_rad <= PI;
    (legal && u32_at(record, 12)? == 0).then_some(limit)
}

#[inline(never)]
fn read_telescope(
    record: &[u8; TELESCOPE_BYTES],
    index: u16,
) -> Result<TelescopeRecord, MissionError> {
    let bad = MissionError::Telescope(index);
    let number = |offset| f64_at(record, offset).ok_or(bad);
    let plate = rotor_at(record, 32).ok_or(bad)?;
    let (first, second) = (number(56)?, number(64)?);
    let shape_record = match u16_at(record, 72) {
        Some(1) if second.to_bits() == 0 => FieldShape::Circle(first),
        Some(2) => FieldShape::Rectangle { width_rad: first, height_rad: second },
        _ => return Err(bad),
    };
    let turning = plate.rate.bits() != 0;
    if field(record, 74) != Some([0_u8; 6]) || (!turning && plate.start != Phase::ZERO) {
        return Err(bad);
    }
    Ok(TelescopeRecord {
        rotation: rotation_at(record, bad)?,
        hwp: turning.then_some(plate),
        field: shape_record,
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::phase::TurnRate;
    use crate::time::Instant;
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
        let counts = Counts { telescopes: 2, detectors: 3, avoidance: 1 };
        let mut bytes = MissionTable::fixed_to_le_bytes(&parameters, sun, counts, 0.01).to_vec();
        for (hwp, field) in [
            (Some(rotor(1 << 95, 6)), FieldShape::Circle(0.2)),
            (None, FieldShape::Rectangle { width_rad: 0.3, height_rad: 0.1 }),
        ] {
            let telescope = TelescopeRecord { rotation: Rotation::about_z(0.5), hwp, field };
            bytes.extend(telescope.to_le_bytes());
        }
        for angle in [0.1, 0.2, 0.3] {
            let rotation = Rotation::about_x(angle);
            bytes.extend(DetectorRecord { rotation, telescope: 1 }.to_le_bytes());
        }
        bytes.extend(AvoidanceRecord { body: 399, angle_rad: 0.5 }.to_le_bytes());
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
        assert_eq!(telescopes[1].field, FieldShape::Rectangle { width_rad: 0.3, height_rad: 0.1 });
        assert_eq!(mission.detectors().count(), 3);
        let limits: Vec<_> = mission.avoidance().collect();
        assert_eq!(limits, [AvoidanceRecord { body: 399, angle_rad: 0.5 }]);
        assert_eq!(mission.avoidance_limit(0), Some(limits[0]));
        assert_eq!(mission.avoidance_limit(1), None);
    }

    #[test]
    fn a_telescope_is_calibrated_through_its_detectors_or_its_field() {
        let (_, bytes) = section();
        let mission = MissionTable::parse(&bytes).unwrap();
        let reach = |telescope, index| {
            mission.calibration_field(telescope, index).map(|field| field.reach_rad())
        };
        assert_eq!(reach(0, 0), Some(0.2));
        assert_eq!(reach(0, 1), None);
        assert_eq!([reach(1, 0), reach(1, 2), reach(1, 3)], [Some(0.01), Some(0.01), None]);
        assert_eq!(reach(2, 0), None);
        let second = mission.calibration_field(1, 1).unwrap().centre();
        let tilt = Rotation::<Detector, Boresight>::about_x(0.2);
        assert!(second.separation_rad(tilt.apply(crate::direction::Direction::Z)) < 1e-15);
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
        assert_eq!(with(96, &[0, 0]), MissionError::SunModel(0));
        assert_eq!(with(98, &[9, 0]), MissionError::WrongLength);
        assert_eq!(with(102, &[0, 0]), MissionError::WrongLength);
        assert_eq!(with(112 + 72, &[9, 0]), MissionError::Telescope(0));
        assert_eq!(with(112 + 64, &[1]), MissionError::Telescope(0));
        assert_eq!(with(192 + 48, &[1]), MissionError::Telescope(1));
        assert_eq!(with(192 + 74, &[1]), MissionError::Telescope(1));
        assert_eq!(with(272 + 32, &[2, 0]), MissionError::Detector(0));
        assert_eq!(with(312 + 32, &[0, 0]), MissionError::Detector(1));
        assert_eq!(with(312 + 39, &[1]), MissionError::Detector(1));
        assert_eq!(with(392, &0.0_f64.to_le_bytes()), MissionError::Avoidance(0));
        assert_eq!(with(392 + 12, &[1]), MissionError::Avoidance(0));
        assert_eq!(with(8, &4.0_f64.to_le_bytes()), MissionError::Scan(ScanError::Alpha(4.0)));
        assert_eq!(
            with(112 + 56, &0.0_f64.to_le_bytes()),
            MissionError::FieldOfView(FieldOfViewError::Radius(0.0))
        );
    }

    #[test]
    fn the_suns_table_and_no_detector_ask_for_no_number() {
        let (parameters, _) = section();
        let parse = |counts: Counts, radius_rad: f64, records: &[u8]| {
            let fixed =
                MissionTable::fixed_to_le_bytes(&parameters, SunRecord::Table, counts, radius_rad);
            MissionTable::parse(&[&fixed[..], records].concat()).map(|_| ())
        };
        assert_eq!(parse(Counts::default(), 0.0, &[]), Ok(()));
        let field = FieldShape::Circle(0.2);
        let telescope = TelescopeRecord { rotation: Rotation::about_z(0.5), hwp: None, field };
        let detector = DetectorRecord { rotation: Rotation::about_x(0.1), telescope: 0 };
        let records = [&telescope.to_le_bytes()[..], &detector.to_le_bytes()].concat();
        let counts = Counts { telescopes: 1, detectors: 1, avoidance: 0 };
        assert_eq!(parse(counts, 0.01, &records), Ok(()));
        let radius = MissionError::FieldOfView(FieldOfViewError::Radius(0.0));
        assert_eq!(parse(counts, 0.0, &records), Err(radius));
    }
}
