//! A check of the mission's periods as JSON and in words.
//!
//! # Example
//! ```
//! use formats::resonance::{json, sentence};
//! use mission::Mission;
//! use planner::{resonance::check::Resonances, world::World};
//!
//! let world = World::open(Mission::load("litebird", &[])?, None)?;
//! let found = Resonances::of_mission(&world)?;
//! let told = sentence(&found.checked);
//! assert!(told.starts_with("pass: within 0.6 s and 0.06 s of 192.348 min and 20 min"));
//! assert_eq!(json(&found.checked, found.recommended.as_ref())["verdict"], "pass");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use planner::resonance::check::Checked;
use planner::resonance::{Certificate, Choice, Recommendation, Worst};
use serde_json::{Value, json};
use std::fmt::Write;

/// As JSON.
#[must_use]
pub fn json(checked: &Checked, recommended: Option<&Recommendation>) -> Value {
    let Checked { motion, tolerance, certificate, allowed } = checked;
    json!({
        "verdict": checked.verdict(),
        "eta": (motion.precession_period_s / motion.spin_period_s).abs(),
        "precession_period_min": minutes(motion.precession_period_s),
        "spin_period_min": minutes(motion.spin_period_s),
        "precession_tolerance_s": tolerance.precession_s,
        "spin_tolerance_s": tolerance.spin_s,
        "duration_days": motion.duration_s / 86_400.0,
        "sigma_smooth": certificate.sigma_smooth,
        "sigma_floor": certificate.sigma_floor,
        "sigma_predicted": certificate.sigma_predicted,
        "sigma_bound_in_box": certificate.sigma_bound,
        "excess": certificate.excess,
        "allowed_excess": allowed,
        "worst": certificate.worst.as_ref().map(worst_json),
        "recommended": recommended.map(|it| choice_json(&it.quietest)),
        "sturdiest": recommended.map(|it| choice_json(&it.sturdiest)),
        "golden_ratio": recommended.map(|it| choice_json(&it.golden)),
    })
}

/// One sentence: the verdict, the bound and the resonance that decides it.
#[must_use]
pub fn sentence(checked: &Checked) -> String {
    let Certificate { excess, sigma_bound, sigma_floor, .. } = checked.certificate;
    let (verb, sign) =
        if checked.certificate.passes { ("pass", "within") } else { ("FAIL", "beyond") };
    let rounded = |seconds: f64| (seconds * 1e6).round() / 1e6;
    let mut text = format!(
        "{verb}: within {} s and {} s of {} min and {} min sigma_hits / mean of the first {:.0} d stays \
         below {:.5}, {:.2} % above the floor {:.5}, {sign} the allowed {} %",
        rounded(checked.tolerance.precession_s),
        rounded(checked.tolerance.spin_s),
        minutes(checked.motion.precession_period_s),
        minutes(checked.motion.spin_period_s),
        checked.motion.duration_s / 86_400.0,
        sigma_bound,
        100.0 * excess,
        sigma_floor,
        100.0 * checked.allowed
    );
    if let Some(worst) = &checked.certificate.worst {
        let _ = write!(text, "; {}", worst_text(worst));
    }
    text
}

/// A resonance in words.
fn worst_text(worst: &Worst) -> String {
    if worst.q == 0 {
        return "what decides is the precession alone, whatever the spin period is".to_owned();
    }
    let mut text = format!(
        "the worst resonance is {} at {:.4} min, {}",
        fraction(worst),
        minutes(worst.precession_period_s),
        hemisphere(worst.northern_share)
    );
    let wavelength = worst.wavelength_rad.to_degrees();
    if wavelength < 360.0 {
        let _ = write!(
            text,
            ", {:.0} waves of {wavelength:.1} deg along the ecliptic, beating in {:.2} d",
            360.0 / wavelength,
            worst.beat_s / 86_400.0
        );
    } else {
        text.push_str(", standing still over the survey");
    }
    if worst.distance_in_tolerances.is_finite() {
        let _ = write!(text, ", {:.2} tolerances away", worst.distance_in_tolerances);
    }
    text
}

/// `p/q` with the sideband's sign, and the multiple where it is one.
fn fraction(worst: &Worst) -> String {
    let sign = if worst.sideband < 0 { '-' } else { '+' };
    let multiple =
        if worst.multiple > 1 { format!(" x {}", worst.multiple) } else { String::new() };
    format!("{}/{}{sign}{multiple}", worst.p, worst.q)
}

fn hemisphere(northern_share: f64) -> &'static str {
    if northern_share > 0.52 {
        "stronger in the north"
    } else if northern_share < 0.48 {
        "stronger in the south"
    } else {
        "equal in north and south"
    }
}

fn worst_json(worst: &Worst) -> Value {
    json!({
        "p": worst.p,
        "q": worst.q,
        "m": worst.m,
        "multiple": worst.multiple,
        "sideband": if worst.sideband < 0 { "-" } else { "+" },
        "precession_period_min": minutes(worst.precession_period_s),
        "wavelength_deg": finite(worst.wavelength_rad.to_degrees()),
        "beat_days": finite(worst.beat_s / 86_400.0),
        "northern_share": worst.northern_share,
        "hemisphere": hemisphere(worst.northern_share),
        "distance_in_tolerances": finite(worst.distance_in_tolerances),
    })
}

fn choice_json(choice: &Choice) -> Value {
    json!({
        "precession_period_min": minutes(choice.precession_period_s),
        "spin_period_min": minutes(choice.spin_period_s),
        "sigma_bound_in_box": choice.certificate.sigma_bound,
        "excess": choice.certificate.excess,
        "verdict": if choice.certificate.passes { "pass" } else { "fail" },
        "tolerances_survived": choice.tolerances_survived,
    })
}

/// A period in minutes without its sign, to the nearest nanominute.
#[must_use]
pub fn minutes(period_s: f64) -> f64 {
    (period_s.abs() / 60.0 * 1e9).round() / 1e9
}

/// JSON has no infinity.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
