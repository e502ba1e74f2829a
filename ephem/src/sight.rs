//! What the bodies of a table stand for.
//!
//! A [`Sight`] is the geometric Sun-to-spacecraft direction or a source as the observer sees it;
//! fitting and verification ask it for unit vectors in the ecliptic of J2000.

use crate::apparent::{Sky, SkyError};
use crate::kernel::SUN;
use crate::source::{Place, Source};
use nalgebra::Vector3;
use onboard_core::time::{Duration, Instant};

/// What a body's directions are.
#[derive(Clone, Copy)]
pub(crate) enum Sight<'a> {
    SunToSpacecraft,
    Source(&'a Source),
}

impl<'a> Sight<'a> {
    /// The Sun's and the sources' sights, by body number.
    pub(crate) fn all(sources: &'a [Source]) -> Vec<Self> {
        let mut sights: Vec<Self> = core::iter::once(Self::SunToSpacecraft)
            .chain(sources.iter().map(Self::Source))
            .collect();
        sights.sort_by_key(|sight| sight.body());
        sights
    }

    pub(crate) fn body(self) -> i32 {
        match self {
            Self::SunToSpacecraft => SUN,
            Self::Source(source) => source.body(),
        }
    }

    pub(crate) fn name(self) -> &'a str {
        match self {
            Self::SunToSpacecraft => "sun_to_spacecraft",
            Self::Source(source) => source.name(),
        }
    }

    /// The unit vector that the table stands for.
    pub(crate) fn vector(self, sky: &Sky, at: Instant) -> Result<Vector3<f64>, SkyError> {
        let direction = match self {
            Self::SunToSpacecraft => sky.sun_to_spacecraft(at),
            Self::Source(source) => sky.direction(source, at),
        };
        direction.map(|direction| direction.xyz().into())
    }

    /// Instants where the interpolation of tabulated data changes, which can serve as breaks.
    pub(crate) fn joints(self, sky: &Sky) -> Vec<Instant> {
        match self {
            Self::Source(source) => match source.place() {
                Place::Table(table) => table
                    .nodes_ns()
                    .iter()
                    .map(|ns| sky.mission_start.plus(Duration::from_ns(*ns)))
                    .collect(),
                Place::Fixed(_) | Place::SolarSystem(_) => sky.trajectory.joints(),
            },
            Self::SunToSpacecraft => sky.trajectory.joints(),
        }
    }
}
