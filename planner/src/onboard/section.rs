//! The mission as the spacecraft has it: the bytes of its section in the container.
//!
//! The layout is the flight core's (`onboard_core::uplink::MissionTable`). The plan decides on these
//! bytes which sessions are allowed, so that it sees the strategy, the fields and the limits that the
//! spacecraft sees, to the bit.

use crate::world::World;
use onboard_core::field_of_view::FieldShape;
use onboard_core::uplink::{
    AvoidanceRecord, Counts, DetectorRecord, MissionTable, SunRecord, TelescopeRecord,
};
use thiserror::Error;

/// More of something than the container's counts can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the uplink table cannot hold {number} {what}: it holds 65535")]
pub struct TooMany {
    /// What there is too much of.
    pub what: &'static str,
    /// How many.
    pub number: usize,
}

impl TooMany {
    /// A count as the container holds it.
    ///
    /// # Errors
    /// [`TooMany`] above 65535.
    pub fn checked(what: &'static str, number: usize) -> Result<u16, Self> {
        u16::try_from(number).map_err(|_| Self { what, number })
    }
}

/// The mission section of the container, as `onboard_core::uplink` reads it.
///
/// # Errors
/// [`TooMany`] where a count exceeds the format.
pub fn mission_section(world: &World) -> Result<Vec<u8>, TooMany> {
    let mission = &world.mission;
    let detectors = mission.telescopes.iter().map(|telescope| telescope.detectors.len()).sum();
    let counts = Counts {
        telescopes: TooMany::checked("telescopes", mission.telescopes.len())?,
        detectors: TooMany::checked("detectors", detectors)?,
        avoidance: TooMany::checked("avoidance limits", world.avoided.len())?,
    };
    let sun = world.circular_sun.map_or(SunRecord::Table, SunRecord::Circular);
    let radius = mission.calibration.radius_rad();
    let fixed = MissionTable::fixed_to_le_bytes(world.scan.parameters(), sun, counts, radius);
    let mut bytes = fixed.to_vec();
    for telescope in &mission.telescopes {
        let circle = FieldShape::Circle(radius);
        let record = TelescopeRecord {
            rotation: telescope.rotation,
            hwp: telescope.hwp,
            field: telescope.field_of_view.map_or(circle, |field| field.shape()),
        };
        bytes.extend(record.to_le_bytes());
    }
    for (telescope, it) in (0_u16..).zip(&mission.telescopes) {
        for named in &it.detectors {
            let record = DetectorRecord { rotation: named.rotation, telescope };
            bytes.extend(record.to_le_bytes());
        }
    }
    for (source, angle_rad) in &world.avoided {
        let record = AvoidanceRecord { body: source.body(), angle_rad: *angle_rad };
        bytes.extend(record.to_le_bytes());
    }
    Ok(bytes)
}
