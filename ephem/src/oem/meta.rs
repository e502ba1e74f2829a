//! What the metadata of an OEM segment says.

use crate::ccsds::{Axes, Block, CcsdsError, Legal};
use crate::interpolation::Method;
use crate::kernel::{EARTH, EARTH_MOON_BARYCENTER, SOLAR_SYSTEM_BARYCENTER, SUN};
use crate::time::Scale;
use onboard_core::time::Instant;

/// Names of legal frames; those of ICRF's realisations too.
const FRAMES: [&str; 5] = ["ICRF", "GCRF", "EME2000", "J2000", "ECLIPJ2000"];
const METHODS: [&str; 3] = ["HERMITE", "LAGRANGE", "LINEAR"];
const CENTERS: [(&str, i32); 6] = [
    ("SUN", SUN),
    ("EARTH", EARTH),
    ("EARTH BARYCENTER", EARTH_MOON_BARYCENTER),
    ("EARTH-MOON BARYCENTER", EARTH_MOON_BARYCENTER),
    ("SOLAR SYSTEM BARYCENTER", SOLAR_SYSTEM_BARYCENTER),
    ("SSB", SOLAR_SYSTEM_BARYCENTER),
];
/// Degree without `INTERPOLATION_DEGREE`.
const HERMITE_DEGREE: usize = 7;
const LAGRANGE_DEGREE: usize = 7;
/// Largest degree accepted.
const LARGEST_DEGREE: usize = 27;

/// How a segment's states are read.
pub(super) struct Meta {
    pub(super) center: i32,
    pub(super) axes: Axes,
    pub(super) scale: Scale,
    /// Useable span.
    pub(super) start: Instant,
    pub(super) stop: Instant,
    pub(super) method: Method,
    /// States per interpolation.
    pub(super) window: usize,
}

impl Meta {
    /// From a segment's metadata.
    pub(super) fn read(block: &Block<'_>) -> Result<Self, CcsdsError> {
        let frame = block.need("REF_FRAME")?;
        let axes = Axes::from_name(frame.value)
            .ok_or_else(|| frame.illegal(Legal::OneOf(FRAMES.to_vec())))?;
        let scale = block.time_system()?;
        let (method, window) = interpolation(block)?;
        let need = |key| match block.time(key, scale)? {
            Some(at) => Ok(at),
            None => Err(block.missing(key)),
        };
        let (start, stop) = (need("START_TIME")?, need("STOP_TIME")?);
        Ok(Self {
            center: center(block)?,
            axes,
            scale,
            start: block.time("USEABLE_START_TIME", scale)?.unwrap_or(start).max(start),
            stop: block.time("USEABLE_STOP_TIME", scale)?.unwrap_or(stop).min(stop),
            method,
            window,
        })
    }
}

fn center(block: &Block<'_>) -> Result<i32, CcsdsError> {
    let name = block.need("CENTER_NAME")?;
    let plain = name.value.to_ascii_uppercase().replace('_', " ");
    let words = plain.split_whitespace().collect::<Vec<_>>().join(" ");
    CENTERS.iter().find(|(known, _)| *known == words).map(|(_, body)| *body).ok_or_else(|| {
        name.illegal(Legal::OneOf(CENTERS.iter().map(|(known, _)| *known).collect()))
    })
}

fn interpolation(block: &Block<'_>) -> Result<(Method, usize), CcsdsError> {
    let legal = Legal::Whole { first: 1, last: LARGEST_DEGREE };
    let degree = block
        .find("INTERPOLATION_DEGREE")
        .map(|entry| {
            let degree = entry.value.parse().ok();
            let degree = degree.filter(|degree| (1..=LARGEST_DEGREE).contains(degree));
            degree.ok_or_else(|| entry.illegal(legal))
        })
        .transpose()?;
    // Hermite of n states has degree 2 n - 1, Lagrange of n states n - 1.
    let hermite = |degree: usize| (Method::Hermite, (degree + 1).div_ceil(2));
    let lagrange = |degree: usize| (Method::Lagrange, degree + 1);
    let Some(name) = block.find("INTERPOLATION") else {
        return Ok(hermite(degree.unwrap_or(HERMITE_DEGREE)));
    };
    Ok(match name.one_of(&METHODS)? {
        "LAGRANGE" => lagrange(degree.unwrap_or(LAGRANGE_DEGREE)),
        "LINEAR" => lagrange(1),
        _ => hermite(degree.unwrap_or(HERMITE_DEGREE)),
    })
}
