//! The uniform motion whose hits are predicted, and how far its periods may be off.
//!
//! `n(t) = R_z(w_o t + phi_o) R_y(90 deg) R_z(w_a t + phi_a) R_y(alpha) R_z(w_b t + phi_b) R_y(beta) z`
//! in ecliptic coordinates. Against the conventions: `phi_o` is the anti-Sun longitude at the start,
//! `phi_a = a0 + 180 deg`, `phi_b = b0`.
//!
//! Limits: periods and durations that are finite and not zero.

use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Days of a year, the orbit's period, in seconds.
pub const YEAR_S: f64 = 365.25 * 86_400.0;

/// Spin phases over which speeds are averaged.
const SPEEDS: u32 = 64;

/// Periods, phases and duration. A negative period turns the other way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Precession period in seconds.
    pub precession_period_s: f64,
    /// Spin period in seconds.
    pub spin_period_s: f64,
    /// Orbital period in seconds.
    pub orbit_period_s: f64,
    /// Length of the survey in seconds.
    pub duration_s: f64,
    /// Precession phase a0 at the start in radians.
    pub precession_phase_rad: f64,
    /// Spin phase b0 at the start in radians.
    pub spin_phase_rad: f64,
    /// Anti-Sun longitude at the start in radians.
    pub longitude_rad: f64,
}

/// How far the periods may be from their nominal values, either way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Of the precession period, in seconds.
    pub precession_s: f64,
    /// Of the spin period, in seconds.
    pub spin_s: f64,
}

/// What was not legal in a [`Motion`].
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum MotionError {
    /// A period of zero, or not finite.
    #[error("{name} is {value_s} s, but must be finite and not zero")]
    Period {
        /// Which period.
        name: &'static str,
        /// Its value in seconds.
        value_s: f64,
    },
    /// A duration that is not positive.
    #[error("the duration is {0} s, but must be positive and finite")]
    Duration(f64),
    /// A phase that is not finite.
    #[error("a phase is {0} rad, but must be finite")]
    Phase(f64),
}

impl Motion {
    /// A year of forward rotations, all phases zero.
    #[must_use]
    pub const fn year(precession_period_s: f64, spin_period_s: f64) -> Self {
        Self {
            precession_period_s,
            spin_period_s,
            orbit_period_s: YEAR_S,
            duration_s: YEAR_S,
            precession_phase_rad: 0.0,
            spin_phase_rad: 0.0,
            longitude_rad: 0.0,
        }
    }

    /// Itself, if legal.
    ///
    /// # Errors
    /// [`MotionError`] naming the value.
    pub fn checked(self) -> Result<Self, MotionError> {
        for (name, value_s) in [
            ("the precession period", self.precession_period_s),
            ("the spin period", self.spin_period_s),
            ("the orbital period", self.orbit_period_s),
        ] {
            if !(value_s.is_finite() && value_s != 0.0) {
                return Err(MotionError::Period { name, value_s });
            }
        }
        if !(self.duration_s.is_finite() && self.duration_s > 0.0) {
            return Err(MotionError::Duration(self.duration_s));
        }
        for phase in [self.precession_phase_rad, self.spin_phase_rad, self.longitude_rad] {
            if !phase.is_finite() {
                return Err(MotionError::Phase(phase));
            }
        }
        Ok(self)
    }

    /// Turns of the orbit during the survey, signed.
    #[must_use]
    pub fn orbits(&self) -> f64 {
        self.duration_s / self.orbit_period_s
    }

    /// The azimuthal number at which `k` precessions and `j` spins stand still,
    /// `m* = -(k f_a + j f_b) / f_o`.
    #[must_use]
    pub fn standing(&self, k: i32, j: i32) -> f64 {
        // With k / T_a + j / T_b on one denominator, little is lost where the two cancel.
        let (a, b) = (self.precession_period_s, self.spin_period_s);
        let beat = f64::from(k).mul_add(b, f64::from(j) * a) / (a * b);
        -beat * self.orbit_period_s
    }

    /// Mean of the inverse of the line of sight's angular speed at angles alpha and beta, in s/rad;
    /// the orbit counts where nothing else turns.
    pub(super) fn mean_slowness(&self, alpha_rad: f64, beta_rad: f64) -> f64 {
        let (across, along) = alpha_rad.sin_cos();
        let precession = TAU / self.precession_period_s;
        // Both rates' vector in the frame of the spin axis.
        let [x, z] = [-precession * across, TAU / self.spin_period_s + precession * along];
        let least = (TAU / self.orbit_period_s).abs();
        let slowness = |i: u32| {
            let (sin, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(SPEEDS)).sin_cos();
            let n = [beta_rad.sin() * cos, beta_rad.sin() * sin, beta_rad.cos()];
            let speed = [-z * n[1], z * n[0] - x * n[2], x * n[1]];
            speed.iter().map(|v| v * v).sum::<f64>().sqrt().max(least).recip()
        };
        (0..SPEEDS).map(slowness).sum::<f64>() / f64::from(SPEEDS)
    }

    /// Start phases in the order m, k, j.
    pub(super) fn phases(&self) -> [f64; 3] {
        [self.longitude_rad, self.precession_phase_rad + PI, self.spin_phase_rad]
    }
}
