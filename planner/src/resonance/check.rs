//! Do the mission's periods beat on the sky: one check, as the verb, `plan` and `verify` make it.
//!
//! The hits of a year, also where the mission is shorter or longer, on the mission boresight are predicted in closed
//! form, and bounded over all periods within tolerance while the anti-Sun direction goes round as it
//! does: see [`crate::resonance`].
//!
//! Limits: one detector on the boresight; pixels to `N_side` 512.
//!
//! # Example
//! LiteBIRD's periods pass; precessing in 192 min, 48/5 of the spin's 20 min, does not:
//! ```
//! use mission::{Mission, Override};
//! use planner::resonance::{Window, check::ResonanceCheck};
//! use planner::{healpix::Nside, world::World};
//!
//! let judged = |precession: &str| -> Result<_, Box<dyn std::error::Error>> {
//!     let mission = Mission::load("litebird", &[Override::set(precession)?])?;
//!     let world = World::open(mission, None)?;
//!     Ok(ResonanceCheck::new(&world, Window::pixel(Nside::new(64)?)?, None)?.certify()?)
//! };
//! let published = judged("scan.precession_period_min=192.348")?;
//! assert!(published.certificate.passes && published.certificate.excess < published.allowed);
//! let resonant = judged("scan.precession_period_min=192")?;
//! assert_eq!(resonant.certificate.worst.map(|it| (it.p, it.q)), Some((48, 5)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::certificate::{Certificate, CertificateError, MOST_MEETINGS, MOST_RECOMMENDED};
use super::coefficients::reach;
use super::crosslink::Crosslink;
use super::motion::Tolerance;
use super::motion::{Motion, YEAR_S};
use super::orbit::Orbit;
use super::predictor::Predictor;
use super::recommendation::{Demand, Recommendation};
use super::window::{Window, WindowError};
use crate::healpix::{Nside, NsideError};
use crate::world::World;
use ephem::apparent::{Sky, SkyError};
use ephem::trajectory::Trajectory;
use mission::number::{Number, nearest};
use onboard_core::phase::Rotor;
use onboard_core::time::Duration;
use thiserror::Error;

/// Pixels at which `plan` and `verify` look.
pub const NSIDE: u32 = 128;
/// Excess over the floor that passes.
pub const ALLOWED: f64 = 0.01;
/// Candidates for a recommendation lie within this share of the precession period.
const NEARBY: f64 = 0.0025;
/// Steps from the least candidate to the largest.
const STEPS: u32 = 50;

/// Why periods cannot be judged.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CheckError {
    /// The kernel does not cover the year.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// No such pixels.
    #[error(transparent)]
    Nside(#[from] NsideError),
    /// No such window.
    #[error(transparent)]
    Window(#[from] WindowError),
    /// Periods or tolerances that are not legal.
    #[error(transparent)]
    Certificate(#[from] CertificateError),
}

/// The check of a mission's periods, and where it fails what else to fly.
#[derive(Debug, Clone, Copy)]
pub struct Resonances {
    /// The check.
    pub checked: Checked,
    /// Periods nearby.
    pub recommended: Option<Recommendation>,
}

impl Resonances {
    /// The check that `plan` makes; where it fails, periods nearby are recommended.
    ///
    /// # Errors
    /// [`CheckError`] where it cannot be made.
    pub fn of_mission(world: &World) -> Result<Self, CheckError> {
        let mut check = ResonanceCheck::of_mission(world)?;
        let checked = check.certify()?;
        let candidates = if checked.certificate.passes { Vec::new() } else { check.nearby() };
        Ok(Self { checked, recommended: check.recommend(&candidates)? })
    }
}

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
    /// [`CheckError`] where the kernel does not cover it.
    pub fn new(world: &World, window: Window, duration_s: Option<f64>) -> Result<Self, CheckError> {
        let duration_s = duration_s.unwrap_or(YEAR_S);
        let scan = world.scan.parameters();
        let signed = |period: &Number, rotor: Rotor| {
            let sign = if rotor.rate.is_negative() { -60 } else { 60 };
            nearest(&period.times(sign, 1))
        };
        let beyond = Sky { trajectory: Trajectory::l2(), ..world.sky.clone() };
        let direction = |share: f64| -> Result<[f64; 2], CheckError> {
            let at = world.zero().plus(Duration::from_seconds(share * duration_s));
            // Beyond the mission a trajectory may end; L2 has its longitude.
            let sky = if at <= world.mission_span().1 { &world.sky } else { &beyond };
            let direction = sky.sun_to_spacecraft(at)?;
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
    pub fn of_mission(world: &World) -> Result<Self, CheckError> {
        let window = Nside::new(NSIDE)?;
        Self::new(world, Window::pixel(window)?, None)
    }

    /// Bounds the variance within tolerance.
    ///
    /// # Errors
    /// [`CertificateError`] where periods or tolerances are not legal.
    pub fn certify(&mut self) -> Result<Checked, CertificateError> {
        let Self { predictor, motion, demand } = self;
        let motion = motion.checked()?;
        let meetings = predictor.meetings(&motion, 2.0 * reach(&motion), MOST_MEETINGS);
        if meetings > MOST_MEETINGS {
            let (precession_period_s, spin_period_s) =
                (motion.precession_period_s, motion.spin_period_s);
            let error = CertificateError::Meetings { precession_period_s, spin_period_s, meetings };
            return Err(error);
        }
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

    /// The best of candidate pairs of periods in seconds, unsigned; none where so many frequencies beat that
    /// it would take minutes.
    ///
    /// # Errors
    /// As [`Self::certify`].
    pub fn recommend(
        &mut self,
        candidates: &[[f64; 2]],
    ) -> Result<Option<Recommendation>, CertificateError> {
        let width = 2.0 * reach(&self.motion);
        if self.predictor.meetings(&self.motion, width, MOST_RECOMMENDED) > MOST_RECOMMENDED {
            return Ok(None);
        }
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
}
