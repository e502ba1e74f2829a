//! Do the mission's periods beat on the sky: one check, as the verb, `plan` and `verify` make it.
//!
//! The hits of a year, also where the mission is shorter or longer, on the mission boresight are predicted in closed
//! form, and bounded over all periods within tolerance while the anti-Sun direction goes round as it
//! does: see [`planner::resonance`].
//!
//! Limits: one detector on the boresight; pixels to `N_side` 512.

use crate::failure::Failure;
use crate::number::{Number, nearest};
use crate::world::World;
use ephem::apparent::Sky;
use ephem::trajectory::Trajectory;
use onboard_core::phase::Rotor;
use onboard_core::time::Duration;
use planner::healpix::Nside;
use planner::resonance::{
    Certificate, CertificateError, Choice, Crosslink, Demand, Motion, Orbit, Predictor,
    Recommendation, Tolerance, Window, Worst, YEAR_S,
};
use serde_json::{Value, json};
use std::fmt::Write;

/// Pixels at which `plan` and `verify` look.
pub const NSIDE: u32 = 128;
/// Excess over the floor that passes.
pub const ALLOWED: f64 = 0.01;
/// Candidates for a recommendation lie within this share of the precession period.
const NEARBY: f64 = 0.0025;
/// Steps from the least candidate to the largest.
const STEPS: u32 = 50;

/// A check to be made.
#[derive(Debug, Clone)]
pub struct ResonanceCheck {
    predictor: Predictor,
    /// The periods and what else decides where the boresight looks.
    pub motion: Motion,
    /// What must be met.
    pub demand: Demand,
}

/// Its outcome.
#[derive(Debug, Clone, Copy)]
pub struct Checked {
    /// At which periods.
    pub motion: Motion,
    /// Within which tolerance.
    pub tolerance: Tolerance,
    /// The bound and what decides it.
    pub certificate: Certificate,
    /// Allowed excess.
    pub allowed: f64,
}

impl ResonanceCheck {
    /// The check of a mission over `duration_s` from its start, without one over a year, at the
    /// scale of a window.
    ///
    /// # Errors
    /// [`Failure::Input`] where the kernel does not cover it.
    pub fn new(world: &World, window: Window, duration_s: Option<f64>) -> Result<Self, Failure> {
        let duration_s = duration_s.unwrap_or(YEAR_S);
        let scan = world.scan.parameters();
        let signed = |period: &Number, rotor: Rotor| {
            let sign = if rotor.rate.is_negative() { -60 } else { 60 };
            nearest(&period.times(sign, 1))
        };
        let beyond = Sky { trajectory: Trajectory::l2(), ..world.sky.clone() };
        let direction = |share: f64| -> Result<[f64; 2], Failure> {
            let at = world.start.plus(Duration::from_seconds(share * duration_s));
            // Beyond the mission a trajectory may end; L2 has its longitude.
            let sky = if at <= world.end { &world.sky } else { &beyond };
            let direction = sky.sun_to_spacecraft(at).map_err(Failure::input)?;
            Ok([direction.longitude_rad(), direction.latitude_rad()])
        };
        let longitude_rad = match world.circular_sun {
            Some(sun) => sun.start.radians(),
            None => direction(0.0)?[0],
        };
        let motion = Motion {
            precession_period_s: signed(&world.mission.scan.precession_period_min, scan.precession),
            spin_period_s: signed(&world.mission.scan.spin_period_min, scan.spin),
            orbit_period_s: YEAR_S,
            duration_s,
            precession_phase_rad: scan.precession.start.radians(),
            spin_phase_rad: scan.spin.start.radians(),
            longitude_rad,
        };
        let orbit = match world.circular_sun {
            Some(_) => Orbit::CIRCULAR,
            None => Orbit::follow(&motion, window.l_max(), direction)?,
        };
        let mission = &world.mission;
        let tolerance = Tolerance {
            precession_s: mission.tolerance.precession_period_s.to_f64(),
            spin_s: mission.tolerance.spin_period_s.to_f64(),
        };
        Ok(Self {
            predictor: Predictor::new(mission.scan.alpha_rad, mission.scan.beta_rad, window),
            motion,
            demand: Demand { tolerance, orbit, allowed: ALLOWED },
        })
    }

    /// The check that `plan` and `verify` make.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_mission(world: &World) -> Result<Self, Failure> {
        let window = Nside::new(NSIDE).map_err(Failure::internal)?;
        Self::new(world, Window::pixel(window).map_err(Failure::internal)?, None)
    }

    /// Bounds the variance within tolerance.
    ///
    /// # Errors
    /// [`CertificateError`] where periods or tolerances are not legal.
    pub fn certify(&mut self) -> Result<Checked, CertificateError> {
        let Self { predictor, motion, demand } = self;
        let motion = motion.checked()?;
        let floor = predictor.floor(&motion);
        let limit = [floor, demand.allowed];
        let certificate = predictor.certify(&motion, demand.tolerance, &demand.orbit, limit)?;
        Ok(Checked { motion, tolerance: demand.tolerance, certificate, allowed: demand.allowed })
    }

    /// Whether another tolerance passes at the same periods.
    ///
    /// # Errors
    /// As [`Self::certify`].
    pub fn passes(&mut self, tolerance: Tolerance, floor: f64) -> Result<bool, CertificateError> {
        let Self { predictor, motion, demand } = self;
        let limit = [floor, demand.allowed];
        Ok(predictor.certify(motion, tolerance, &demand.orbit, limit)?.passes)
    }

    /// The best of candidate pairs of periods in seconds, unsigned.
    ///
    /// # Errors
    /// As [`Self::certify`].
    pub fn recommend(
        &mut self,
        candidates: &[[f64; 2]],
    ) -> Result<Option<Recommendation>, CertificateError> {
        let signs = [self.motion.precession_period_s, self.motion.spin_period_s].map(f64::signum);
        let signed: Vec<[f64; 2]> =
            candidates.iter().map(|&[a, b]| [a * signs[0], b * signs[1]]).collect();
        self.predictor.recommend(&self.motion, &signed, &self.demand)
    }

    /// The sky's means of `|h_n|^2` at the mission's periods; none where pixels stay unobserved.
    pub fn crosslinks(&mut self, orders: &[u32]) -> Option<Vec<Crosslink>> {
        if orders.is_empty() {
            return Some(Vec::new());
        }
        self.predictor.crosslinks(&self.motion, orders)
    }

    /// Precession periods close to the mission's, at its spin period.
    #[must_use]
    pub fn nearby(&self) -> Vec<[f64; 2]> {
        let (a, b) = (self.motion.precession_period_s.abs(), self.motion.spin_period_s.abs());
        let share = |i: u32| NEARBY * (2.0 * f64::from(i) / f64::from(STEPS) - 1.0);
        (0..=STEPS).map(|i| [a * (1.0 + share(i)), b]).collect()
    }

    /// What a precession period in seconds, unsigned, would make of the hits: `sigma_hits / mean` and
    /// the strongest resonance as p, q, m.
    #[must_use]
    pub fn predict(&mut self, precession_period_s: f64) -> (f64, Option<[i32; 3]>) {
        let precession_period_s = precession_period_s.copysign(self.motion.precession_period_s);
        let found = self.predictor.predict(&Motion { precession_period_s, ..self.motion });
        let strongest = found.resonances.first().map(|it| {
            let [p, q] = it.fraction();
            #[expect(clippy::cast_possible_truncation, reason = "at most the largest degree")]
            let m = it.m_star.abs().round() as i32;
            [p, q, m]
        });
        (found.sigma(), strongest)
    }
}

impl Checked {
    /// `pass` or `fail`.
    #[must_use]
    pub const fn verdict(&self) -> &'static str {
        if self.certificate.passes { "pass" } else { "fail" }
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self, recommended: Option<&Recommendation>) -> Value {
        let Self { motion, tolerance, certificate, allowed } = self;
        json!({
            "verdict": self.verdict(),
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
    pub fn sentence(&self) -> String {
        let Certificate { excess, sigma_bound, sigma_floor, .. } = self.certificate;
        let (verb, sign) =
            if self.certificate.passes { ("pass", "within") } else { ("FAIL", "beyond") };
        let rounded = |seconds: f64| (seconds * 1e6).round() / 1e6;
        let mut text = format!(
            "{verb}: within {} s and {} s of {} min and {} min sigma_hits / mean stays below {:.5}, \
             {:.2} % above the floor {:.5}, {sign} the allowed {} %",
            rounded(self.tolerance.precession_s),
            rounded(self.tolerance.spin_s),
            minutes(self.motion.precession_period_s),
            minutes(self.motion.spin_period_s),
            sigma_bound,
            100.0 * excess,
            sigma_floor,
            100.0 * self.allowed
        );
        if let Some(worst) = &self.certificate.worst {
            let _ = write!(text, "; {}", worst_text(worst));
        }
        text
    }
}

/// A resonance in words.
fn worst_text(worst: &Worst) -> String {
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
