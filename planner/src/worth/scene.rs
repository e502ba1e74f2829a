//! A mission, what it offers, and where its targets are: what sessions are judged by.

use crate::opportunities::Offers;
use crate::world::{TableFault, Tables, World};
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::sun::SunModel;

/// A mission with its opportunities and its tables, parsed once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene<'s> {
    /// The mission among the planets.
    pub(crate) world: &'s World,
    /// What it offers: lines of sight, passes, opportunities.
    pub(crate) offers: &'s Offers,
    /// The Sun model that attitudes follow.
    pub(crate) sun: SunModel<'s>,
    /// The directions of its targets.
    pub(crate) table: EphemerisTable<'s>,
}

impl<'s> Scene<'s> {
    pub(crate) fn new(
        world: &'s World,
        tables: &'s Tables,
        offers: &'s Offers,
    ) -> Result<Self, TableFault> {
        let table = tables.parse()?;
        Ok(Self { world, offers, sun: world.sun(table)?, table })
    }
}
