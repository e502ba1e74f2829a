//! How does the mission scan: angles, periods, senses, phases, sampling.
//!
//! Periods and phases are rounded once from the file's decimals ([`crate::number`]); angles are the
//! nearest f64 in radians.
//!
//! Signs: `precession_sign` and `spin_sign` give the senses; periods are positive.
//!
//! Limits: alpha and beta from 0 to 180 deg with a sum of at most 180 deg, exactly. A sum that does
//! not exceed 90 deg by the margin, or a difference above 90 deg, is legal and warned about.

use crate::fault::{Problem, Warning};
use crate::number::Number;
use crate::reading::document::Place;
use crate::reading::range::Range;
use crate::reading::section::Section;
use crate::rounding;
use num_rational::BigRational;
use num_traits::Signed;
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::time::Duration;

/// The scanning strategy and how it is sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// Angle from the anti-Sun axis to the spin axis.
    pub alpha_deg: Number,
    /// The same in radians.
    pub alpha_rad: f64,
    /// Angle from the spin axis to the boresight.
    pub beta_deg: Number,
    /// The same in radians.
    pub beta_rad: f64,
    /// Time of one precession turn.
    pub precession_period_min: Number,
    /// Precession with its sign and start phase.
    pub precession: Rotor,
    /// Time of one spin turn.
    pub spin_period_min: Number,
    /// Spin with its sign and start phase.
    pub spin: Rotor,
    /// Samples per second of every detector.
    pub sampling_rate_hz: Number,
    /// Half-wave plate turns needed while the beam crosses its width.
    pub n_mod: Number,
    /// Margin of the sampling condition.
    pub n_margin: Number,
    /// What alpha + beta - 90 deg must exceed.
    pub full_sky_margin_deg: Number,
}

const ANGLE: Range = Range::closed("an angle", 0.0, 180.0, "deg");
const PRECESSION: Range = Range::closed("a period", 1e-6, 1e12, "min")
    .if_negative("; precession_sign = -1 reverses the precession");
const SPIN: Range =
    Range::closed("a period", 1e-6, 1e12, "min").if_negative("; spin_sign = -1 reverses the spin");
/// Any phase.
pub(crate) const PHASE: Range = Range::closed("an angle", -360.0, 360.0, "deg");
const SAMPLING: Range = Range::positive("a rate", 1e9, "Hz");
const FACTOR: Range = Range::positive("a number", 1000.0, "");
const MARGIN: Range = Range::closed("an angle", 0.0, 90.0, "deg");

impl Scan {
    pub(crate) fn read(section: &mut Section<'_>) -> Self {
        let alpha_deg = section.number("alpha_deg", &ANGLE, None);
        let beta_deg = section.number("beta_deg", &ANGLE, None);
        let precession_period_min = section.number("precession_period_min", &PRECESSION, None);
        let spin_period_min = section.number("spin_period_min", &SPIN, None);
        let precession_sign = section.sign("precession_sign");
        let spin_sign = section.sign("spin_sign");
        let precession_phase = section.number("precession_phase_deg", &PHASE, Some("0.0"));
        let spin_phase = section.number("spin_phase_deg", &PHASE, Some("0.0"));
        let scan = Self {
            alpha_rad: rounding::radians(alpha_deg.exact()),
            beta_rad: rounding::radians(beta_deg.exact()),
            precession: rotor(&precession_period_min, precession_sign, &precession_phase),
            spin: rotor(&spin_period_min, spin_sign, &spin_phase),
            alpha_deg,
            beta_deg,
            precession_period_min,
            spin_period_min,
            sampling_rate_hz: section.number("sampling_rate_hz", &SAMPLING, Some("19.0")),
            n_mod: section.number("n_mod", &FACTOR, Some("1.0")),
            n_margin: section.number("n_margin", &FACTOR, Some("1.0")),
            full_sky_margin_deg: section.number("full_sky_margin_deg", &MARGIN, Some("0.0")),
        };
        let sum = scan.alpha_deg.exact() + scan.beta_deg.exact();
        if sum > BigRational::from_integer(180.into()) {
            let (alpha, beta) = (section.place_of("alpha_deg"), section.place_of("beta_deg"));
            let problem = Problem::OutOfRange {
                key: "scan.alpha_deg + scan.beta_deg".to_owned(),
                value: Number::from_exact(sum).text().to_owned(),
                need: "a sum from 0 to 180 deg".to_owned(),
                hint: "",
            };
            section.fault(later(&alpha, &beta), problem);
        }
        scan
    }

    /// Whether the boresight's circle reaches every ecliptic latitude, the margin left over.
    #[must_use]
    pub fn covers_full_sky(&self) -> bool {
        self.warnings().is_empty()
    }

    /// A precession turn, rounded to nanoseconds.
    #[must_use]
    pub fn precession_period(&self) -> Duration {
        rounding::duration(&self.precession_period_min.times(60, 1)).unwrap_or(Duration::ZERO)
    }

    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let (alpha, beta) = (self.alpha_deg.exact(), self.beta_deg.exact());
        let quarter = BigRational::from_integer(90.into());
        let excess = alpha + beta - &quarter;
        let difference = (alpha - beta).abs();
        let mut warnings = Vec::new();
        if excess <= *self.full_sky_margin_deg.exact() {
            warnings.push(Warning::PolesUnseen {
                excess: Number::from_exact(excess).text().to_owned(),
                margin: self.full_sky_margin_deg.text().to_owned(),
            });
        }
        if difference > quarter {
            let difference = Number::from_exact(difference).text().to_owned();
            warnings.push(Warning::PolesPassedBy { difference });
        }
        warnings
    }

    /// Whether the boresight comes near the Sun: at the far side of its circle it is `alpha + beta`
    /// from the anti-Sun direction.
    pub(crate) fn near_sun(&self) -> Option<Warning> {
        let half_turn = BigRational::from_integer(180.into());
        let closest = half_turn - self.alpha_deg.exact() - self.beta_deg.exact();
        (closest < BigRational::from_integer(NEAR_SUN_DEG.into())).then(|| Warning::NearSun {
            closest: Number::from_exact(closest).text().to_owned(),
            limit: NEAR_SUN_DEG,
        })
    }
}

/// A boresight that comes nearer to the Sun is warned of: no baffle of a telescope in use allows it.
const NEAR_SUN_DEG: u32 = 45;

/// A rotor of a period in minutes and a start phase in degrees; still for a period of zero, which
/// only the stand-in of a fault is.
fn rotor(period_min: &Number, sign: i8, phase_deg: &Number) -> Rotor {
    let rate = rounding::turn_rate_of_period(&period_min.times(60, 1), sign);
    Rotor { rate: rate.unwrap_or(TurnRate::from_bits(0)), start: phase_of_degrees(phase_deg) }
}

pub(crate) fn phase_of_degrees(degrees: &Number) -> Phase {
    rounding::phase(&degrees.times(1, 360))
}

/// The place that was written last: an option, else a file over its base.
fn later<'a>(first: &'a Place, second: &'a Place) -> &'a Place {
    let rank = |place: &Place| place.source.rank;
    if rank(second) >= rank(first) { second } else { first }
}

/// How well the actuators hold the periods.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tolerance {
    /// Half-width of the precession period.
    pub precession_period_s: Number,
    /// Half-width of the spin period.
    pub spin_period_s: Number,
}

const TOLERANCE: Range = Range::closed("a tolerance", 0.0, 1e9, "s");

impl Tolerance {
    pub(crate) fn read(section: &mut Section<'_>) -> Self {
        Self {
            precession_period_s: section.number("precession_period_s", &TOLERANCE, Some("0.6")),
            spin_period_s: section.number("spin_period_s", &TOLERANCE, Some("0.06")),
        }
    }
}
