//! The scanning strategy: precession about the anti-Sun axis, spin about the spin axis.
//!
//! Chain [Takase2024, A.1]: `n(t) = R_z(a) R_y(alpha) R_z(b) R_y(beta) z` in [`AntiSun`], with exact
//! phases a and b; the signs of the two rates give the four combinations of rotation directions.
//!
//! | paper | here |
//! |---|---|
//! | alpha | angle from the anti-Sun axis to the spin axis |
//! | beta | angle from the spin axis to the boresight |
//! | `omega_alpha t` | precession phase a |
//! | `omega_beta t` | spin phase b |
//!
//! Limits: alpha, beta in [0, pi] and alpha + beta at most pi; rates must not be zero.

use crate::bytes::{f64_at, instant_at, put, put_rotor, rotor_at};
use crate::frame::{AntiSun, Boresight, Spin};
use crate::phase::{Phase, Rotor, TurnRate};
use crate::rotation::Rotation;
use crate::time::{Duration, Instant};
use crate::trigonometry;
use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

/// What defines a scanning strategy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScanParameters {
    /// Instant at which both phases have their start values.
    pub start: Instant,
    /// Angle from the anti-Sun axis to the spin axis in radians.
    pub alpha_rad: f64,
    /// Angle from the spin axis to the boresight in radians.
    pub beta_rad: f64,
    /// Precession: signed rate and phase at the start.
    pub precession: Rotor,
    /// Spin: signed rate and phase at the start.
    pub spin: Rotor,
}

/// Why parameters are not a scanning strategy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ScanError {
    /// Alpha (radians) is not in [0, pi].
    Alpha(f64),
    /// Beta (radians) is not in [0, pi].
    Beta(f64),
    /// Alpha + beta (radians) exceeds pi.
    AlphaPlusBeta(f64),
    /// The precession rate is zero, or half a turn per ns or faster.
    PrecessionRate,
    /// The spin rate is zero, or half a turn per ns or faster.
    SpinRate,
}

/// A legal scanning strategy.
#[derive(Debug, Clone, Copy)]
pub struct ScanStrategy {
    parameters: ScanParameters,
    /// Sine and cosine of alpha / 2.
    half_alpha: (f64, f64),
    half_beta: (f64, f64),
    /// Signed precession and spin rates in rad/s.
    rates_rad_s: (f64, f64),
}

/// Bytes of [`ScanParameters`] in tables and records.
pub(crate) const SCAN_BYTES: usize = 72;

impl ScanParameters {
    /// The parameters' bytes: start, i64 ns of TAI; alpha, beta, f64; precession and spin, rotors.
    #[inline(never)]
    pub(crate) fn to_le_bytes(self) -> [u8; SCAN_BYTES] {
        let mut bytes = [0; SCAN_BYTES];
        put(&mut bytes, 0, self.start.tai_ns().to_le_bytes());
        put(&mut bytes, 8, self.alpha_rad.to_le_bytes());
        put(&mut bytes, 16, self.beta_rad.to_le_bytes());
        put_rotor(&mut bytes, 24, self.precession);
        put_rotor(&mut bytes, 48, self.spin);
        bytes
    }

    /// The parameters in the first bytes, legal or not.
    #[inline(never)]
    pub(crate) fn from_le_bytes(bytes: &[u8]) -> Option<Self> {
        Some(Self {
            start: instant_at(bytes, 0)?,
            alpha_rad: f64_at(bytes, 8)?,
            beta_rad: f64_at(bytes, 16)?,
            precession: rotor_at(bytes, 24)?,
            spin: rotor_at(bytes, 48)?,
        })
    }

    /// No motion; not a legal strategy.
    pub(crate) const STILL: Self = {
        let still = Rotor { rate: TurnRate::from_bits(0), start: Phase::ZERO };
        Self {
            start: Instant::from_tai_ns(0),
            alpha_rad: 0.0,
            beta_rad: 0.0,
            precession: still,
            spin: still,
        }
    };
}

/// Slack for alpha + beta = pi given in rounded radians.
const SUM_SLACK: f64 = 1e-12;

impl ScanStrategy {
    /// No motion; not a legal strategy.
    pub(crate) const STILL: Self = Self {
        parameters: ScanParameters::STILL,
        half_alpha: (0.0, 0.0),
        half_beta: (0.0, 0.0),
        rates_rad_s: (0.0, 0.0),
    };

    /// Checks the parameters.
    ///
    /// # Errors
    /// [`ScanError`] names the parameter that is out of range.
    pub fn new(parameters: ScanParameters) -> Result<Self, ScanError> {
        Self::check(&parameters)?;
        Ok(Self::of_checked(parameters))
    }

    #[inline(never)]
    pub(crate) fn check(parameters: &ScanParameters) -> Result<(), ScanError> {
        let (alpha, beta) = (parameters.alpha_rad, parameters.beta_rad);
        if !(0.0..=PI).contains(&alpha) {
            return Err(ScanError::Alpha(alpha));
        }
        if !(0.0..=PI).contains(&beta) {
            return Err(ScanError::Beta(beta));
        }
        if alpha + beta > PI + SUM_SLACK {
            return Err(ScanError::AlphaPlusBeta(alpha + beta));
        }
        let usable = |rotor: Rotor| {
            let bits = rotor.rate.bits();
            bits != 0 && bits != 1 << 127_u32
        };
        if !usable(parameters.precession) {
            return Err(ScanError::PrecessionRate);
        }
        if !usable(parameters.spin) {
            return Err(ScanError::SpinRate);
        }
        Ok(())
    }

    /// The strategy of parameters that were checked before.
    #[inline(never)]
    pub(crate) fn of_checked(parameters: ScanParameters) -> Self {
        Self {
            half_alpha: trigonometry::sin_cos(0.5 * parameters.alpha_rad),
            half_beta: trigonometry::sin_cos(0.5 * parameters.beta_rad),
            rates_rad_s: (
                parameters.precession.rate.radians_per_second(),
                parameters.spin.rate.radians_per_second(),
            ),
            parameters,
        }
    }

    /// The parameters as given.
    #[must_use]
    pub const fn parameters(&self) -> &ScanParameters {
        &self.parameters
    }

    /// Time from the mission's start to `at`.
    #[must_use]
    pub const fn elapsed(&self, at: Instant) -> Duration {
        at.since(self.parameters.start)
    }

    /// Precession and spin phases at `at`.
    #[must_use]
    pub const fn phases(&self, at: Instant) -> (Phase, Phase) {
        let elapsed = self.elapsed(at);
        (self.parameters.precession.phase(elapsed), self.parameters.spin.phase(elapsed))
    }

    /// Completed precession and spin turns since the start.
    #[must_use]
    pub const fn turns(&self, at: Instant) -> (u64, u64) {
        let elapsed = self.elapsed(at);
        (
            self.parameters.precession.rate.completed_turns(elapsed),
            self.parameters.spin.rate.completed_turns(elapsed),
        )
    }

    /// The fixed rotation from [`Boresight`] to [`Spin`]: `R_y(beta)`.
    #[must_use]
    pub const fn boresight_in_spin(&self) -> Rotation<Boresight, Spin> {
        let (sin, cos) = self.half_beta;
        Rotation::from_parts(0.0, sin, 0.0, cos)
    }

    /// Sine and cosine of half of beta.
    pub(crate) const fn half_beta(&self) -> (f64, f64) {
        self.half_beta
    }

    /// Signed precession and spin rates in rad/s.
    pub(crate) const fn rates_rad_s(&self) -> (f64, f64) {
        self.rates_rad_s
    }

    /// The rotation from [`Spin`] to [`AntiSun`] at `at`: `R_z(a) R_y(alpha) R_z(b)`.
    #[must_use]
    #[inline(never)]
    pub fn spin_in_anti_sun(&self, at: Instant) -> Rotation<Spin, AntiSun> {
        let (precession, spin) = self.phases(at);
        let (half_a, half_b) = (precession.half(), spin.half());
        let (sin_sum, cos_sum) = half_a.plus(half_b).sin_cos();
        let (sin_difference, cos_difference) = half_a.plus(half_b.negated()).sin_cos();
        let (sin_tilt, cos_tilt) = self.half_alpha;
        // The product multiplied out.
        Rotation::from_parts(
            -sin_tilt * sin_difference,
            sin_tilt * cos_difference,
            cos_tilt * sin_sum,
            cos_tilt * cos_sum,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parameters(alpha_deg: f64, beta_deg: f64) -> ScanParameters {
        let rotor = Rotor { rate: TurnRate::from_bits(1 << 80), start: Phase::ZERO };
        ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad: alpha_deg.to_radians(),
            beta_rad: beta_deg.to_radians(),
            precession: rotor,
            spin: rotor,
        }
    }

    #[test]
    fn angles_have_a_legal_range() {
        assert!(ScanStrategy::new(parameters(45.0, 50.0)).is_ok());
        assert!(ScanStrategy::new(parameters(0.0, 180.0)).is_ok());
        assert!(ScanStrategy::new(parameters(90.0, 90.0)).is_ok());
        assert!(matches!(ScanStrategy::new(parameters(-1.0, 50.0)), Err(ScanError::Alpha(_))));
        assert!(matches!(ScanStrategy::new(parameters(f64::NAN, 50.0)), Err(ScanError::Alpha(_))));
        assert!(matches!(ScanStrategy::new(parameters(1.0, 181.0)), Err(ScanError::Beta(_))));
        assert!(matches!(
            ScanStrategy::new(parameters(100.0, 81.0)),
            Err(ScanError::AlphaPlusBeta(_))
        ));
    }

    proptest! {
        #[test]
        fn the_chain_is_its_product(alpha in 0.0..90.0_f64, a: u64, b: u64, ns: i64) {
            let mut chain = parameters(alpha, 20.0);
            chain.precession.start = Phase::from_bits(a);
            chain.spin.start = Phase::from_bits(b);
            let scan = ScanStrategy::new(chain).unwrap();
            let at = Instant::from_tai_ns(ns);
            let (precession, spin) = scan.phases(at);
            let product = Rotation::<Spin, Spin>::about_z_by(spin)
                .then(Rotation::<Spin, Spin>::about_y(alpha.to_radians()))
                .then(Rotation::<Spin, AntiSun>::about_z_by(precession));
            let [x, y, z, w] = scan.spin_in_anti_sun(at).then(product.inverse()).to_xyzw();
            prop_assert!(x.abs() < 1e-15 && y.abs() < 1e-15 && z.abs() < 1e-15);
            prop_assert!((w - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn rates_must_turn() {
        let mut still = parameters(45.0, 50.0);
        still.spin.rate = TurnRate::from_bits(0);
        assert!(matches!(ScanStrategy::new(still), Err(ScanError::SpinRate)));
        let mut still = parameters(45.0, 50.0);
        still.precession.rate = TurnRate::from_bits(0);
        assert!(matches!(ScanStrategy::new(still), Err(ScanError::PrecessionRate)));
    }
}
