//! Where the Sun stands during a survey: on a circle, or from a table that the survey owns.
//!
//! Directions are Sun to spacecraft, in the ecliptic. The circular Sun's longitude turns uniformly
//! and its latitude is 0. In steps, the direction stands still until the next step's first sample
//! (Falcons.jl's thruster mode).
//!
//! Method: a [`SunTable`] is the flight core's table, its bytes shared, checked when it is made.
//!
//! Limits: a survey beyond the table's span ends with an error.

use super::rates::ExactRotor;
use num_rational::BigRational;
use onboard_core::ephemeris::{BodyTable, EphemerisError, EphemerisTable, SUN};
use onboard_core::phase::Phase;
use onboard_core::sun::SunModel;
use onboard_core::time::Duration;
use std::sync::Arc;

/// The Sun-to-spacecraft direction of a survey.
#[derive(Debug, Clone)]
pub struct SurveySun {
    /// Where the direction comes from.
    pub source: SunSource,
    /// Time between steps of the direction; none moves it with every sample.
    pub step: Option<Duration>,
}

/// Where the Sun-to-spacecraft direction comes from.
#[derive(Debug, Clone)]
pub enum SunSource {
    /// Uniform longitude, latitude 0.
    Circular(ExactRotor),
    /// From a table.
    Table(SunTable),
}

/// A table of directions with the Sun in it, owned: clones share its bytes.
#[derive(Debug, Clone)]
pub struct SunTable {
    bytes: Arc<[u8]>,
}

/// Seconds in which the circular Sun goes round: 365.25 days.
const YEAR_S: i64 = 31_557_600;

impl SurveySun {
    /// The circular Sun, which goes round in 365.25 days from an anti-Sun longitude at sample 0.
    #[must_use]
    pub fn circular(longitude: Phase) -> Self {
        let turns_per_s = BigRational::new(1.into(), YEAR_S.into());
        Self {
            source: SunSource::Circular(ExactRotor { turns_per_s, start: longitude }),
            step: None,
        }
    }
}

impl SunTable {
    /// The table in these bytes.
    ///
    /// # Errors
    /// [`EphemerisError`] where they are no table, or one without the Sun.
    pub fn new(bytes: impl Into<Arc<[u8]>>) -> Result<Self, EphemerisError> {
        let table = Self { bytes: bytes.into() };
        table.sun()?;
        Ok(table)
    }

    /// The Sun as the flight core evaluates it.
    ///
    /// # Errors
    /// Those of [`SunTable::new`], which has excluded them.
    pub fn model(&self) -> Result<SunModel<'_>, EphemerisError> {
        self.sun().map(SunModel::Table)
    }

    fn sun(&self) -> Result<BodyTable<'_>, EphemerisError> {
        EphemerisTable::parse(&self.bytes)?.body(SUN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_without_the_sun_is_refused() {
        assert_eq!(SunTable::new(vec![0; 5]).unwrap_err(), EphemerisError::WrongLength);
        // No bodies, no spans, no coefficients.
        assert_eq!(SunTable::new(vec![0; 16]).unwrap_err(), EphemerisError::NoSuchBody(SUN));
    }
}
