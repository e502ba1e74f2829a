//! A container whose sections fit together: what the flight services run on.
//!
//! Beyond each section's own checks: the Sun model and every body of the plan and of the avoidance
//! limits are in the ephemeris and cover the container's validity; each session lies inside the
//! validity, and its telescope is in the mission. A container without a plan has no sessions.

use super::{
    Container, Header, MissionError, MissionTable, PlanError, PlanTable, SectionKind, SunRecord,
    UplinkError,
};
use crate::ephemeris::{BodyTable, EphemerisError, EphemerisTable, SUN};
use crate::sun::SunModel;

/// Why a container's contents are refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// The container itself.
    Container(UplinkError),
    /// The ephemeris section, or a body that the mission needs.
    Ephemeris(EphemerisError),
    /// The mission section.
    Mission(MissionError),
    /// The plan section.
    Plan(PlanError),
    /// A body (its number) does not cover the container's validity.
    Coverage(i32),
    /// A session (its index) lies outside the container's validity.
    SessionOutside(u32),
    /// A session (its index) names a telescope that the mission does not have.
    SessionTelescope(u32),
}

/// The sections of a container, checked against each other, in borrowed bytes.
#[derive(Debug, Clone, Copy)]
pub struct Tables<'a> {
    container: Container<'a>,
    ephemeris: EphemerisTable<'a>,
    mission: MissionTable<'a>,
    plan: PlanTable<'a>,
}

impl<'a> Tables<'a> {
    /// Checks and borrows all of a container.
    ///
    /// # Errors
    /// [`TableError`], the first thing found wrong.
    // REQ-CONT-2.
    #[inline(never)]
    pub fn load(bytes: &'a [u8]) -> Result<Self, TableError> {
        Self::from_container(&Container::parse(bytes).map_err(TableError::Container)?)
    }

    #[inline(never)]
    pub(super) fn from_container(container: &Container<'a>) -> Result<Self, TableError> {
        let section = |kind| container.section(kind).map_err(TableError::Container);
        let ephemeris = EphemerisTable::parse(section(SectionKind::Ephemeris)?)
            .map_err(TableError::Ephemeris)?;
        let mission =
            MissionTable::parse(section(SectionKind::Mission)?).map_err(TableError::Mission)?;
        let plan = match container.section(SectionKind::Plan) {
            Ok(bytes) => PlanTable::parse(bytes).map_err(TableError::Plan)?,
            Err(_) => PlanTable::EMPTY,
        };
        let tables = Self { container: *container, ephemeris, mission, plan };
        tables.check()?;
        Ok(tables)
    }

    #[inline(never)]
    fn check(&self) -> Result<(), TableError> {
        if self.mission.sun_record() == SunRecord::Table {
            self.check_body(SUN)?;
        }
        for limit in self.mission.avoidance() {
            self.check_body(limit.body)?;
        }
        let mut index = 0_u32;
        for session in self.plan.sessions() {
            if session.start < self.header().valid_from || session.end > self.header().valid_until {
                return Err(TableError::SessionOutside(index));
            }
            if self.mission.telescope(session.telescope).is_none() {
                return Err(TableError::SessionTelescope(index));
            }
            self.check_body(session.body)?;
            index = index.wrapping_add(1);
        }
        Ok(())
    }

    #[inline(never)]
    fn check_body(&self, number: i32) -> Result<(), TableError> {
        self.check_coverage(number, self.ephemeris.body(number).map_err(TableError::Ephemeris)?)
    }

    #[inline(never)]
    fn check_coverage(&self, number: i32, body: BodyTable<'a>) -> Result<(), TableError> {
        match body.coverage() {
            Some((from, until))
                if from <= self.header().valid_from && self.header().valid_until <= until =>
            {
                Ok(())
            }
            _ => Err(TableError::Coverage(number)),
        }
    }

    /// What the container says about itself.
    #[must_use]
    pub const fn header(&self) -> &Header {
        &self.container.header
    }

    /// The container that they are read from.
    pub(super) const fn container(&self) -> &Container<'a> {
        &self.container
    }

    /// The digest of the set's contents.
    #[must_use]
    pub const fn set_digest(&self) -> u64 {
        self.container.set_digest
    }

    /// The directions of Sun and targets.
    #[must_use]
    pub const fn ephemeris(&self) -> EphemerisTable<'a> {
        self.ephemeris
    }

    /// Strategy, telescopes, detectors and limits.
    #[must_use]
    pub const fn mission(&self) -> &MissionTable<'a> {
        &self.mission
    }

    /// The sessions; none without a plan.
    #[must_use]
    pub const fn plan(&self) -> PlanTable<'a> {
        self.plan
    }

    /// The Sun model on this ephemeris.
    ///
    /// # Errors
    /// None on loaded tables: [`EphemerisError::NoSuchBody`] was ruled out.
    pub fn sun(&self) -> Result<SunModel<'a>, EphemerisError> {
        self.mission.sun(self.ephemeris)
    }
}
