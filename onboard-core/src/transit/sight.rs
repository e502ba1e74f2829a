//! The target as the spinning spacecraft sees it: one evaluation of the search.

use crate::direction::DirectionState;
use crate::ephemeris::{BodyTable, EphemerisError};
use crate::frame::AntiSun;
use crate::scan::ScanStrategy;
use crate::sun::{AntiSunAxes, SunModel};
use crate::time::Instant;
use nalgebra::Vector3;

/// The scanning strategy with its trigonometry done once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) scan: ScanStrategy,
    pub(super) sin_alpha: f64,
    pub(super) cos_alpha: f64,
    /// Signed precession rate in rad/s.
    pub(super) precession: f64,
    /// Signed spin rate in rad/s.
    pub(super) spin: f64,
}

impl Motion {
    pub(super) fn new(scan: &ScanStrategy) -> Self {
        let parameters = scan.parameters();
        let (sin_alpha, cos_alpha) = libm::sincos(parameters.alpha_rad);
        Self {
            scan: *scan,
            sin_alpha,
            cos_alpha,
            precession: parameters.precession.rate.radians_per_second(),
            spin: parameters.spin.rate.radians_per_second(),
        }
    }
}

/// The target's direction at one instant, in the frames of the search.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub(super) cos_gamma: f64,
    pub(super) sin_gamma: f64,
    /// In the anti-Sun frame turned by the precession phase: its azimuth is minus x.
    pub(super) precessed: (f64, f64),
    pub(super) cos_delta: f64,
    pub(super) sin_delta: f64,
    /// In [`crate::frame::Spin`].
    pub(super) direction: Vector3<f64>,
    /// Its derivative there, 1/s.
    pub(super) rate: Vector3<f64>,
}

impl Sight {
    /// Evaluates Sun, target and phases at `at`.
    pub(super) fn new(
        motion: &Motion,
        sun: &SunModel<'_>,
        target: BodyTable<'_>,
        at: Instant,
    ) -> Result<Self, EphemerisError> {
        let seen = in_anti_sun(motion.scan.parameters().start, sun, target, at)?;
        Ok(Self::turned(motion, &seen, &sines(&motion.scan, at)))
    }

    /// The target in the anti-Sun frame, taken to the spinning spacecraft.
    #[inline(never)]
    fn turned(
        motion: &Motion,
        seen: &DirectionState<AntiSun>,
        &[(sin_a, cos_a), (sin_b, cos_b)]: &[(f64, f64); 2],
    ) -> Self {
        let p = seen.direction.vector();
        let [vx, vy, vz] = seen.rate_per_s;

        // R_z(-a), then R_y(-alpha); the turning frame adds -w_a z x p.
        let turned = back_about_z(p, sin_a, cos_a);
        let turned_rate = back_about_z(
            Vector3::new(vx + motion.precession * p.y, vy - motion.precession * p.x, vz),
            sin_a,
            cos_a,
        );
        let tilted = back_about_y(turned, motion);
        let tilted_rate = back_about_y(turned_rate, motion);
        // R_z(-b); the spinning frame adds -w_b z x u.
        let direction = back_about_z(tilted, sin_b, cos_b);
        let rate = back_about_z(
            Vector3::new(
                tilted_rate.x + motion.spin * tilted.y,
                tilted_rate.y - motion.spin * tilted.x,
                tilted_rate.z,
            ),
            sin_b,
            cos_b,
        );
        Self {
            cos_gamma: p.z,
            sin_gamma: libm::sqrt(p.x * p.x + p.y * p.y),
            precessed: (turned.x, turned.y),
            cos_delta: tilted.z,
            sin_delta: libm::sqrt(tilted.x * tilted.x + tilted.y * tilted.y),
            direction,
            rate,
        }
    }
}

/// The target's direction and rate in the anti-Sun frame.
#[inline(never)]
fn in_anti_sun(
    start: Instant,
    sun: &SunModel<'_>,
    target: BodyTable<'_>,
    at: Instant,
) -> Result<DirectionState<AntiSun>, EphemerisError> {
    let axes = axes(start, sun, at)?;
    Ok(axes.view(&target.state(at)?))
}

#[inline(never)]
fn axes(start: Instant, sun: &SunModel<'_>, at: Instant) -> Result<AntiSunAxes, EphemerisError> {
    Ok(AntiSunAxes::new(&sun.state(start, at)?))
}

/// Sine and cosine of the precession phase, then of the spin phase.
#[inline(never)]
fn sines(scan: &ScanStrategy, at: Instant) -> [(f64, f64); 2] {
    let (precession, spin) = scan.phases(at);
    [precession.sin_cos(), spin.sin_cos()]
}

fn back_about_z(v: Vector3<f64>, sin: f64, cos: f64) -> Vector3<f64> {
    Vector3::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin, v.z)
}

fn back_about_y(v: Vector3<f64>, motion: &Motion) -> Vector3<f64> {
    let (sin, cos) = (motion.sin_alpha, motion.cos_alpha);
    Vector3::new(v.x * cos - v.z * sin, v.y, v.x * sin + v.z * cos)
}
