//! NAIF's numbers of the bodies that a kernel is asked for, and their names.

/// NAIF's number of the Sun.
pub const SUN: i32 = 10;
/// NAIF's number of the barycentre of Earth and Moon.
pub const EARTH_MOON_BARYCENTER: i32 = 3;
/// NAIF's number of the Earth.
pub const EARTH: i32 = 399;
/// NAIF's number of the Moon.
pub const MOON: i32 = 301;
/// NAIF's number of the solar system barycentre.
pub const SOLAR_SYSTEM_BARYCENTER: i32 = 0;

/// Longest chain of segments from a body to the barycentre.
pub(super) const LONGEST_CHAIN: usize = 8;

/// A body's name in sentences.
#[must_use]
pub fn body_name(body: i32) -> &'static str {
    match body {
        0 => "the solar system barycentre",
        1 => "Mercury",
        2 => "Venus",
        EARTH_MOON_BARYCENTER => "the Earth-Moon barycentre",
        4 => "Mars",
        5 => "Jupiter",
        6 => "Saturn",
        7 => "Uranus",
        8 => "Neptune",
        9 => "Pluto",
        SUN => "the Sun",
        MOON => "the Moon",
        EARTH => "the Earth",
        ..0 => "spacecraft",
        _ => "body",
    }
}
