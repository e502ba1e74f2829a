//! How fast does the beam sweep, and what does the half-wave plate demand of the periods.
//!
//! Conventions: alpha from the anti-Sun axis to the spin axis, beta from the spin axis to the
//! boresight; "plus" where precession and spin turn the same way, "minus" where they oppose.
//!
//! Method: [Takase2024, sections 2.2, A.1.1 and B.3]. With `w_a`, `w_b` the rates of precession and
//! spin, `d` the beam's full width at half maximum and `f` the plate's rate,
//!
//! | quantity | formula |
//! |---|---|
//! | largest sweep speed | `w(+-) = w_a sin(alpha +- beta) + w_b sin beta` |
//! | time across a beam | `tau = d / w` |
//! | modulation | `n_mod / tau < f` |
//! | sampling | `f < f_s / (8 n_margin)` |
//! | shortest spin period | `2 pi n_mod T_a sin beta / (d f T_a - 2 pi n_mod sin(alpha +- beta))` |
//! | shortest precession period | `2 pi n_mod (sin beta + sin(alpha +- beta)) / (d f)` |
//!
//! The shortest precession period is the one that still modulates with a spin as fast.
//!
//! Limits: the sweep speed is the paper's, the speed where the line of sight lies in the plane of
//! the two axes. It is the true maximum unless the total rotation axis can stand at right angles to
//! the line of sight, as with beta = 90 deg; [`Scan::peak_sweep_rad_s`] is the maximum everywhere
//! (test `paper_speed_is_the_peak_unless_the_axis_meets_a_right_angle`). The formula is negative
//! where the precession outruns a spin that opposes it; then `tau` has no meaning. A shortest period
//! that is zero or negative binds nothing. The orbit (1 deg/day) is left out.
//!
//! # Example
//! LiteBIRD's scan seen by its high-frequency telescope:
//! ```
//! use planner::constraints::{Coherence, Optics, Scan, kinetic_constraints};
//!
//! let scan = Scan {
//!     alpha_rad: 45.0_f64.to_radians(),
//!     beta_rad: 50.0_f64.to_radians(),
//!     precession_period_s: 192.348 * 60.0,
//!     spin_period_s: 20.0 * 60.0,
//!     coherence: Coherence::Plus,
//! };
//! let (fwhm_rad, hwp_rate_hz) = ((17.9_f64 / 60.0).to_radians(), Some(61.0 / 60.0));
//! let optics = Optics { fwhm_rad, hwp_rate_hz, sampling_rate_hz: 19.0, n_mod: 1.0, n_margin: 1.0 };
//! let found = kinetic_constraints(&scan, &optics)?;
//! assert!((found.omega_max_plus_rad_s.to_degrees() - 0.260_89).abs() < 5e-6);
//! // The spin may be as short as 16.9 min.
//! assert!(found.t_beta_lower_plus_s.is_ok_and(|it| (it / 60.0 - 16.884).abs() < 5e-4));
//! assert_eq!((found.modulation_ok, found.sampling_ok), (Ok(true), Ok(true)));
//! # Ok::<(), planner::constraints::ConstraintError>(())
//! ```

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use thiserror::Error;

/// Slack in radians for sums of angles that were given in rounded degrees.
const ANGLE_SLACK_RAD: f64 = 1e-12;

/// Whether precession and spin turn the same way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coherence {
    /// The same way: the plus sign.
    Plus,
    /// Opposite ways: the minus sign.
    Minus,
}

impl Coherence {
    const fn sign(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

/// A scanning strategy as far as speeds are concerned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scan {
    /// Angle from the anti-Sun axis to the spin axis in radians.
    pub alpha_rad: f64,
    /// Angle from the spin axis to the boresight in radians.
    pub beta_rad: f64,
    /// Precession period in seconds, positive.
    pub precession_period_s: f64,
    /// Spin period in seconds, positive.
    pub spin_period_s: f64,
    /// Relative sense of the two rotations.
    pub coherence: Coherence,
}

/// A telescope as far as speeds are concerned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optics {
    /// Full width of the beam at half maximum in radians.
    pub fwhm_rad: f64,
    /// Rate of the half-wave plate in Hz; `None` without a plate.
    pub hwp_rate_hz: Option<f64>,
    /// Sampling rate in Hz.
    pub sampling_rate_hz: f64,
    /// Turns of the plate wanted while the beam moves by its width.
    pub n_mod: f64,
    /// Margin on the sampling of the modulated signal.
    pub n_margin: f64,
}

/// What was not legal in a [`Scan`] or an [`Optics`].
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ConstraintError {
    /// An angle out of range.
    #[error("{name} is {value_rad} rad, but must lie from 0 to pi")]
    Angle {
        /// Which angle.
        name: &'static str,
        /// Its value in radians.
        value_rad: f64,
    },
    /// Alpha + beta beyond pi.
    #[error("alpha + beta is {0} rad, but must not exceed pi")]
    AngleSum(f64),
    /// A quantity that must be positive and finite.
    #[error("{name} is {value}, but must be positive and finite")]
    NotPositive {
        /// Which quantity.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// Why a constraint has no value.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Undefined {
    /// The telescope has no half-wave plate.
    #[error("the telescope has no half-wave plate")]
    NoPlate,
    /// The formula for the sweep speed (rad/s) is not positive.
    #[error("the sweep speed by formula is {0} rad/s, not positive: no beam crossing time follows")]
    NoSweep(f64),
    /// The precession alone sweeps (rad/s) at least as fast as the plate allows (rad/s).
    #[error(
        "no spin period is slow enough: the precession alone sweeps {precession_rad_s} rad/s, and \
         the half-wave plate allows less than {allowed_rad_s} rad/s"
    )]
    PrecessionTooFast {
        /// Sweep by precession alone.
        precession_rad_s: f64,
        /// Sweep that the plate's rate allows.
        allowed_rad_s: f64,
    },
}

/// A number, or the reason why there is none.
pub type Defined<T> = Result<T, Undefined>;

/// The kinetic constraints of one telescope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KineticConstraints {
    /// Sweep speed in rad/s if both rotations turn the same way.
    pub omega_max_plus_rad_s: f64,
    /// Sweep speed in rad/s if they oppose.
    pub omega_max_minus_rad_s: f64,
    /// Time in seconds in which the beam moves by its width, with the scan's own senses.
    pub tau_s: Defined<f64>,
    /// Shortest spin period in seconds, same way.
    pub t_beta_lower_plus_s: Defined<f64>,
    /// Shortest spin period in seconds, opposite ways.
    pub t_beta_lower_minus_s: Defined<f64>,
    /// Shortest precession period in seconds, same way.
    pub t_alpha_lower_plus_s: Defined<f64>,
    /// Shortest precession period in seconds, opposite ways.
    pub t_alpha_lower_minus_s: Defined<f64>,
    /// The plate turns fast enough for the sweep.
    pub modulation_ok: Defined<bool>,
    /// The sampling is fast enough for the plate.
    pub sampling_ok: Defined<bool>,
}

fn positive(name: &'static str, value: f64) -> Result<(), ConstraintError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(ConstraintError::NotPositive { name, value })
    }
}

impl Scan {
    fn check(&self) -> Result<(), ConstraintError> {
        for (name, value_rad) in [("alpha", self.alpha_rad), ("beta", self.beta_rad)] {
            if !(0.0..=PI).contains(&value_rad) {
                return Err(ConstraintError::Angle { name, value_rad });
            }
        }
        let sum = self.alpha_rad + self.beta_rad;
        if sum > PI + ANGLE_SLACK_RAD {
            return Err(ConstraintError::AngleSum(sum));
        }
        positive("the precession period", self.precession_period_s)?;
        positive("the spin period", self.spin_period_s)
    }

    fn rates_rad_s(&self) -> (f64, f64) {
        (TAU / self.precession_period_s, TAU / self.spin_period_s)
    }

    /// Sweep speed in rad/s by the paper's formula, for either coherence.
    #[must_use]
    pub fn omega_max_rad_s(&self, coherence: Coherence) -> f64 {
        let (precession, spin) = self.rates_rad_s();
        // w = w_a sin(alpha +- beta) + w_b sin beta
        precession * (self.alpha_rad + coherence.sign() * self.beta_rad).sin()
            + spin * self.beta_rad.sin()
    }

    /// Largest speed in rad/s that the boresight reaches on the sky, for any angles and rates.
    #[must_use]
    pub fn peak_sweep_rad_s(&self) -> f64 {
        let (precession, spin) = self.rates_rad_s();
        let signed = self.coherence.sign() * precession;
        // The total rate omega stands at the angle epsilon from the spin axis, towards the anti-Sun
        // axis; the line of sight is at every angle from |epsilon - beta| to epsilon + beta from it
        // (or from pi beyond), and the speed is |omega| times the sine.
        let across = signed.abs() * self.alpha_rad.sin();
        let along = spin + signed * self.alpha_rad.cos();
        let epsilon = across.atan2(along);
        let nearest = (epsilon - self.beta_rad).abs();
        let farthest = (epsilon + self.beta_rad).min(TAU - epsilon - self.beta_rad);
        let sine = if nearest <= FRAC_PI_2 && farthest >= FRAC_PI_2 {
            1.0
        } else {
            nearest.sin().max(farthest.sin())
        };
        across.hypot(along) * sine
    }

    /// Whether the boresight reaches the whole sky in a year: alpha + beta - pi/2 > `margin_rad`.
    #[must_use]
    pub fn covers_full_sky(&self, margin_rad: f64) -> bool {
        self.alpha_rad + self.beta_rad - FRAC_PI_2 > margin_rad + ANGLE_SLACK_RAD
    }
}

/// The kinetic constraints of one telescope under one scanning strategy.
///
/// # Errors
/// [`ConstraintError`] names the quantity that is out of range.
pub fn kinetic_constraints(
    scan: &Scan,
    optics: &Optics,
) -> Result<KineticConstraints, ConstraintError> {
    scan.check()?;
    positive("the beam width", optics.fwhm_rad)?;
    positive("the sampling rate", optics.sampling_rate_hz)?;
    positive("n_mod", optics.n_mod)?;
    positive("n_margin", optics.n_margin)?;
    if let Some(rate) = optics.hwp_rate_hz {
        positive("the half-wave plate's rate", rate)?;
    }
    let plate = optics.hwp_rate_hz.ok_or(Undefined::NoPlate);
    let omega = scan.omega_max_rad_s(scan.coherence);
    let tau_s =
        if omega > 0.0 { Ok(optics.fwhm_rad / omega) } else { Err(Undefined::NoSweep(omega)) };
    Ok(KineticConstraints {
        omega_max_plus_rad_s: scan.omega_max_rad_s(Coherence::Plus),
        omega_max_minus_rad_s: scan.omega_max_rad_s(Coherence::Minus),
        tau_s,
        t_beta_lower_plus_s: shortest_spin_s(scan, optics, Coherence::Plus),
        t_beta_lower_minus_s: shortest_spin_s(scan, optics, Coherence::Minus),
        t_alpha_lower_plus_s: shortest_precession_s(scan, optics, Coherence::Plus),
        t_alpha_lower_minus_s: shortest_precession_s(scan, optics, Coherence::Minus),
        modulation_ok: plate.and_then(|rate| tau_s.map(|tau| optics.n_mod / tau < rate)),
        sampling_ok: plate.map(|rate| sampling_ok(rate, optics.sampling_rate_hz, optics.n_margin)),
    })
}

/// `d f / n_mod`: the sweep in rad/s at which the plate makes just enough turns per beam.
fn allowed_sweep_rad_s(optics: &Optics) -> Defined<f64> {
    let rate = optics.hwp_rate_hz.ok_or(Undefined::NoPlate)?;
    Ok(optics.fwhm_rad * rate / optics.n_mod)
}

fn shortest_spin_s(scan: &Scan, optics: &Optics, coherence: Coherence) -> Defined<f64> {
    let allowed_rad_s = allowed_sweep_rad_s(optics)?;
    let (precession, _) = scan.rates_rad_s();
    let precession_rad_s = precession * (scan.alpha_rad + coherence.sign() * scan.beta_rad).sin();
    // T_beta > 2 pi sin beta / (d f / n_mod - w_a sin(alpha +- beta))
    let left = allowed_rad_s - precession_rad_s;
    if left > 0.0 {
        Ok(TAU * scan.beta_rad.sin() / left)
    } else {
        Err(Undefined::PrecessionTooFast { precession_rad_s, allowed_rad_s })
    }
}

fn shortest_precession_s(scan: &Scan, optics: &Optics, coherence: Coherence) -> Defined<f64> {
    let allowed_rad_s = allowed_sweep_rad_s(optics)?;
    // T_alpha > 2 pi (sin beta + sin(alpha +- beta)) / (d f / n_mod)
    let sines = scan.beta_rad.sin() + (scan.alpha_rad + coherence.sign() * scan.beta_rad).sin();
    Ok(TAU * sines / allowed_rad_s)
}

/// Whether detectors sampled at `sampling_rate_hz` follow the modulation of a plate that turns
/// `plate_hz` times a second: `f < f_s / (8 n_margin)`.
#[must_use]
pub fn sampling_ok(plate_hz: f64, sampling_rate_hz: f64, n_margin: f64) -> bool {
    plate_hz < sampling_rate_hz / (8.0 * n_margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MINUTE_S: f64 = 60.0;

    fn scan(alpha_deg: f64, beta_deg: f64) -> Scan {
        Scan {
            alpha_rad: alpha_deg.to_radians(),
            beta_rad: beta_deg.to_radians(),
            precession_period_s: 192.348 * MINUTE_S,
            spin_period_s: 20.0 * MINUTE_S,
            coherence: Coherence::Plus,
        }
    }

    /// LiteBIRD's high-frequency telescope.
    fn optics() -> Optics {
        Optics {
            fwhm_rad: (17.9_f64 / 60.0).to_radians(),
            hwp_rate_hz: Some(61.0 / 60.0),
            sampling_rate_hz: 19.0,
            n_mod: 1.0,
            n_margin: 1.0,
        }
    }

    fn close(value: f64, expected: f64, tolerance: f64) -> bool {
        (value - expected).abs() <= tolerance
    }

    #[test]
    fn litebird_has_the_published_values() {
        let found = kinetic_constraints(&scan(45.0, 50.0), &optics()).unwrap();
        assert!(close(found.omega_max_plus_rad_s.to_degrees(), 0.260_89, 5e-6));
        assert!(close(found.omega_max_minus_rad_s.to_degrees(), 0.227_09, 5e-6));
        assert!(close(found.t_beta_lower_plus_s.unwrap() / MINUTE_S, 16.884, 5e-4));
        assert!(close(
            found.tau_s.unwrap(),
            17.9 / 60.0 / found.omega_max_plus_rad_s.to_degrees(),
            1e-12
        ));
        assert_eq!(found.modulation_ok, Ok(true));
        assert_eq!(found.sampling_ok, Ok(true));
        assert!(scan(45.0, 50.0).covers_full_sky(0.0));
        for (alpha, beta, minutes) in [(10.0, 85.0, 21.956), (85.0, 10.0, 3.827)] {
            let found = kinetic_constraints(&scan(alpha, beta), &optics()).unwrap();
            assert!(close(found.t_beta_lower_plus_s.unwrap() / MINUTE_S, minutes, 5e-4));
        }
    }

    #[test]
    fn shortest_periods_are_where_the_modulation_just_fails() {
        for coherence in [Coherence::Plus, Coherence::Minus] {
            let base = Scan { coherence, ..scan(45.0, 50.0) };
            let found = kinetic_constraints(&base, &optics()).unwrap();
            let (spin, precession) = match coherence {
                Coherence::Plus => (found.t_beta_lower_plus_s, found.t_alpha_lower_plus_s),
                Coherence::Minus => (found.t_beta_lower_minus_s, found.t_alpha_lower_minus_s),
            };
            for (factor, ok) in [(1.0 + 1e-9, true), (1.0 - 1e-9, false)] {
                let spin_period_s = spin.unwrap() * factor;
                let at = Scan { spin_period_s, ..base };
                assert_eq!(kinetic_constraints(&at, &optics()).unwrap().modulation_ok, Ok(ok));
                let both = precession.unwrap() * factor;
                let at = Scan { spin_period_s: both, precession_period_s: both, ..base };
                assert_eq!(kinetic_constraints(&at, &optics()).unwrap().modulation_ok, Ok(ok));
            }
        }
    }

    #[test]
    fn what_is_undefined_says_why() {
        let none = Optics { hwp_rate_hz: None, ..optics() };
        let found = kinetic_constraints(&scan(45.0, 50.0), &none).unwrap();
        assert_eq!(found.t_beta_lower_plus_s, Err(Undefined::NoPlate));
        assert_eq!(found.t_alpha_lower_minus_s, Err(Undefined::NoPlate));
        assert_eq!(found.modulation_ok, Err(Undefined::NoPlate));
        assert!(found.tau_s.is_ok());

        let fast = Scan { precession_period_s: MINUTE_S, ..scan(45.0, 50.0) };
        let found = kinetic_constraints(&fast, &optics()).unwrap();
        assert!(matches!(found.t_beta_lower_plus_s, Err(Undefined::PrecessionTooFast { .. })));
        assert!(found.t_beta_lower_minus_s.is_ok(), "sin(alpha - beta) < 0 never forbids");

        let outrun =
            Scan { coherence: Coherence::Minus, precession_period_s: MINUTE_S, ..scan(10.0, 60.0) };
        let found = kinetic_constraints(&outrun, &optics()).unwrap();
        assert!(found.omega_max_minus_rad_s < 0.0);
        assert!(matches!(found.tau_s, Err(Undefined::NoSweep(speed)) if speed < 0.0));
    }

    #[test]
    fn degenerate_angles_are_legal() {
        // alpha = 0: one axis, rates add. beta = 90 deg: the line of sight stands square to the spin.
        let found = kinetic_constraints(&scan(0.0, 50.0), &optics()).unwrap();
        let sum = TAU / (192.348 * MINUTE_S) + TAU / (20.0 * MINUTE_S);
        assert!(close(found.omega_max_plus_rad_s, sum * 50.0_f64.to_radians().sin(), 1e-15));
        assert!(close(found.t_alpha_lower_minus_s.unwrap(), 0.0, 1e-9));
        let found = kinetic_constraints(&scan(30.0, 90.0), &optics()).unwrap();
        assert!(found.t_beta_lower_plus_s.is_ok() && found.t_beta_lower_minus_s.is_ok());
        // beta = 0: the spin does not move the line of sight, so no spin is too fast.
        let found = kinetic_constraints(&scan(45.0, 0.0), &optics()).unwrap();
        assert!(close(found.t_beta_lower_plus_s.unwrap(), 0.0, 0.0));
        let still = kinetic_constraints(&scan(0.0, 0.0), &optics()).unwrap();
        assert!(matches!(still.tau_s, Err(Undefined::NoSweep(_))));
        assert!(!scan(40.0, 50.0).covers_full_sky(0.0));
        assert!(!scan(45.0, 50.0).covers_full_sky(0.1));
    }

    #[test]
    fn illegal_input_is_named() {
        let bad = Scan { spin_period_s: f64::NAN, ..scan(45.0, 50.0) };
        let error = kinetic_constraints(&bad, &optics()).unwrap_err();
        assert_eq!(error.to_string(), "the spin period is NaN, but must be positive and finite");
        let error = kinetic_constraints(&scan(100.0, 90.0), &optics()).unwrap_err();
        assert!(matches!(error, ConstraintError::AngleSum(_)));
        let error = kinetic_constraints(&scan(-1.0, 90.0), &optics()).unwrap_err();
        assert!(matches!(error, ConstraintError::Angle { name: "alpha", .. }));
        let bad = Optics { hwp_rate_hz: Some(0.0), ..optics() };
        assert!(kinetic_constraints(&scan(45.0, 50.0), &bad).is_err());
    }

    /// Speed by |omega x n| over the spin phase, maximum by dense sampling.
    fn sampled_peak(scan: &Scan) -> f64 {
        let (wa, wb) = scan.rates_rad_s();
        let wa = wa * scan.coherence.sign();
        let (sa, ca) = scan.alpha_rad.sin_cos();
        let (sb, cb) = scan.beta_rad.sin_cos();
        let omega = [wb * sa, 0.0, wa + wb * ca];
        (0..36_000_u32)
            .map(|step| {
                let (s, c) = (f64::from(step) * TAU / 36_000.0).sin_cos();
                let n = [ca * sb * c + sa * cb, sb * s, -sa * sb * c + ca * cb];
                let cross = [
                    omega[1] * n[2] - omega[2] * n[1],
                    omega[2] * n[0] - omega[0] * n[2],
                    omega[0] * n[1] - omega[1] * n[0],
                ];
                cross.iter().map(|c| c * c).sum::<f64>().sqrt()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn paper_speed_is_the_peak_unless_the_axis_meets_a_right_angle() {
        let mut below = 0;
        for coherence in [Coherence::Plus, Coherence::Minus] {
            for (alpha, beta) in
                [(45.0, 50.0), (26.0, 69.0), (7.5, 85.0), (30.0, 90.0), (10.0, 120.0)]
            {
                for spin_min in [1.0, 20.0, 150.0, 400.0] {
                    let spin_period_s = spin_min * MINUTE_S;
                    let scan = Scan { spin_period_s, coherence, ..scan(alpha, beta) };
                    let sampled = sampled_peak(&scan);
                    let peak = scan.peak_sweep_rad_s();
                    assert!((peak / sampled - 1.0).abs() < 1e-7, "{scan:?}: {peak} {sampled}");
                    let paper = scan.omega_max_rad_s(coherence);
                    assert!(paper <= peak * (1.0 + 1e-12));
                    below += u32::from(paper < peak * (1.0 - 1e-9));
                }
            }
        }
        assert!(below > 0, "some geometry exceeds the formula");
        for coherence in [Coherence::Plus, Coherence::Minus] {
            let litebird = Scan { coherence, ..scan(45.0, 50.0) };
            assert!(close(litebird.peak_sweep_rad_s(), litebird.omega_max_rad_s(coherence), 1e-15));
        }
    }
}
