//! The frames, as types of no size.
//!
//! A [`Direction`](crate::direction::Direction) or [`Rotation`](crate::rotation::Rotation) carries
//! its frames in its type, so that a mix-up does not compile. `docs/conventions.md` defines each.

/// Obliquity of the ecliptic of J2000 in arcsec (SPICE ECLIPJ2000).
pub const OBLIQUITY_ARCSEC: f64 = 84_381.448;

/// Axes of the International Celestial Reference Frame, as DE440 uses them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Icrf {}

/// Ecliptic of J2000: ICRF rotated about x by [`OBLIQUITY_ARCSEC`] (ECLIPJ2000).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ecliptic {}

/// z along Sun to spacecraft, x ecliptic north made perpendicular to z, y = z cross x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AntiSun {}

/// Turns with precession and spin; z is the spin axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spin {}

/// z the mission's line of sight, x away from the spin axis, y along the nominal scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Boresight {}

/// A telescope's own frame, fixed in [`Boresight`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Telescope {}

/// A detector's own frame; z its line of sight, x its sensitive direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detector {}
