//! How sure is a predicted transit, given how well the scan's angles are known.
//!
//! [`Channel::confidence`] turns the covariance of the errors in precession phase, alpha and spin
//! phase into standard deviations of a transit's entry, exit and closest approach, and into the
//! probability that it happens.
//!
//! Frames: [`Spin`](crate::frame::Spin), w the target's direction in it. An error dx turns w about
//! an axis k, `dw/dx = -k x w`: the spin axis z for the spin phase b; `R_z(-b) y` for alpha;
//! `R_z(-b) (-sin alpha, 0, cos alpha)`, the anti-Sun axis, for the precession phase.
//!
//! Method: first order. An edge f(t, x) = 0 moves by `dt = -(df/dx . dx) / f'`, the closest approach
//! by the same rule on `f'`. The target circles the axis A of the total rotation at angle theta,
//! so it meets the field while theta lies between the field's nearest and farthest angle from A:
//! the probability is the normal distribution's share between the two.
//!
//! Limits: good while an edge's standard deviation stays far below the dwell; a grazing transit's
//! edges are worse known than stated. A is taken as fixed in the field during the transit. Errors of
//! rates must be in the covariance of the transit's time; the target's own error is not counted.
//! `tests/tests/visits.rs` compares with searches repeated under perturbed angles.

use super::reach::{Edges, Reach};
use super::search::{Lookup, Search};
use super::sight::{Motion, Sight};
use super::{Channel, Transit};
use crate::ephemeris::EphemerisError;
use crate::time::{Duration, Instant};
use crate::uncertainty::ScanCovariance;
use crate::vector::{cross, dot, minus, negated, over, plus, times, vector};
use core::f64::consts::{FRAC_1_SQRT_2, PI};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Evaluations of one [`Channel::confidence`].
pub const EVALUATIONS_PER_CONFIDENCE: u32 = 3;

/// Standard deviations that hold 95 % of a normal distribution between them.
const TWO_SIDED_95: f64 = 1.959_963_984_540_054;

/// A closest approach this near to an edge is the edge's: the search's last correction is shorter.
const AT_THE_EDGE: Duration = Duration::from_ns(1_000_000);

/// The spin axis.
const Z: Vector3<f64> = vector(0.0, 0.0, 1.0);

/// How well a predicted transit is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Confidence {
    /// Standard deviation of the entry in seconds; 0 where the search's start is the entry.
    pub entry_sigma_s: f64,
    /// Standard deviation of the exit in seconds; 0 where the search's end is the exit.
    pub exit_sigma_s: f64,
    /// Standard deviation of the closest approach in seconds: an edge's, where it lies there.
    pub closest_sigma_s: f64,
    /// Standard deviation of the track's offset across the scan in radians: of the smallest
    /// separation, where that is large against it.
    pub separation_sigma_rad: f64,
    /// Probability that the target enters the field of view at all in this passage.
    pub probability: f64,
    /// Entry less 1.96 standard deviations.
    pub earliest_entry: Instant,
    /// Exit plus 1.96 standard deviations.
    pub latest_exit: Instant,
}

/// The axes about which the scan's angles turn the target, in the spin frame.
#[derive(Debug, Clone, Copy)]
struct Axes {
    precession: Vector3<f64>,
    alpha: Vector3<f64>,
}

impl Axes {
    #[cfg_attr(target_os = "none", inline(never))]
    fn new(motion: &Motion, at: Instant) -> Self {
        let (sin, cos) = motion.scan.phases(at).1.sin_cos();
        // R_z(-b) applied to (-sin alpha, 0, cos alpha) and to y.
        let s = motion.sin_alpha;
        Self {
            precession: Vector3::new(-s * cos, s * sin, motion.cos_alpha),
            alpha: Vector3::new(sin, cos, 0.0),
        }
    }

    /// `g . dw/dx` for the three angles, for a gradient g in w: `-g . (k x w) = k . (g x w)`.
    #[cfg_attr(target_os = "none", inline(never))]
    fn gradient(&self, g: &Vector3<f64>, w: &Vector3<f64>) -> [f64; 3] {
        let turned = cross(*g, *w);
        [dot(self.precession, turned), dot(self.alpha, turned), turned.z]
    }
}

impl Channel<'_> {
    /// How well a transit that this channel found is known, for the covariance at its time.
    ///
    /// Makes [`EVALUATIONS_PER_CONFIDENCE`] evaluations, not counted as the search's.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the tables.
    // REQ-FORECAST-2.
    pub fn confidence(
        &self,
        transit: &Transit,
        covariance: &ScanCovariance,
    ) -> Result<Confidence, EphemerisError> {
        let entry_sigma_s =
            if transit.entry_clipped { 0.0 } else { self.edge(transit.entry, covariance, 1.0)? };
        let exit_sigma_s =
            if transit.exit_clipped { 0.0 } else { self.edge(transit.exit, covariance, -1.0)? };
        let closest = self.passage(transit.closest, covariance)?;
        Ok(Confidence {
            entry_sigma_s,
            exit_sigma_s,
            closest_sigma_s: if transit.closest.since(transit.entry) <= AT_THE_EDGE {
                entry_sigma_s
            } else if transit.exit.since(transit.closest) <= AT_THE_EDGE {
                exit_sigma_s
            } else {
                closest.sigma_s
            },
            separation_sigma_rad: closest.sigma_rad,
            probability: closest.probability,
            earliest_entry: transit
                .entry
                .plus(Duration::from_seconds(-TWO_SIDED_95 * entry_sigma_s)),
            latest_exit: transit.exit.plus(Duration::from_seconds(TWO_SIDED_95 * exit_sigma_s)),
        })
    }

    /// Standard deviation in seconds of an edge; `sense` is the sign of f' there.
    #[cfg_attr(target_os = "none", inline(never))]
    fn edge(
        &self,
        at: Instant,
        covariance: &ScanCovariance,
        sense: f64,
    ) -> Result<f64, EphemerisError> {
        let sight = self.sight_at(at)?;
        let (gradient, rate) = edge_gradient(self.motion(), self.reach(), at, (&sight, sense));
        Ok(ratio(libm::sqrt(covariance.along(gradient)), rate))
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn passage(&self, at: Instant, covariance: &ScanCovariance) -> Result<Passage, EphemerisError> {
        let sight = self.sight_at(at)?;
        let (motion, reach) = (self.motion(), self.reach());
        let axes = Axes::new(motion, at);
        let turning = plus(times(axes.precession, motion.precession), times(Z, motion.spin));
        Ok(Passage {
            sigma_s: closest_sigma_s(&sight, &axes, motion, (reach.nearest(&sight), covariance)),
            ..Passage::new(&axes, &turning, &sight, (reach, covariance))
        })
    }
}

impl Search {
    /// By how many seconds an edge moves per radian of error in precession phase, alpha and spin
    /// phase; `sense` is the sign of f' there. Makes an evaluation, which counts as the search's.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn edge_slopes_s(
        &mut self,
        at: Instant,
        lookup: &Lookup<'_, '_>,
        sense: f64,
    ) -> Result<[f64; 3], EphemerisError> {
        self.count();
        let sight = self.sight_at(at, lookup)?;
        let (gradient, rate) = edge_gradient(self.motion(), self.reach(), at, (&sight, sense));
        let slope = |moved: f64| if libm::fabs(moved) > 0.0 { moved / rate } else { 0.0 };
        Ok(gradient.map(slope))
    }
}

/// How the edge that is crossed in this sense moves in f with each angle, and |f'| there.
#[cfg_attr(target_os = "none", inline(never))]
fn edge_gradient(
    motion: &Motion,
    reach: &Reach,
    at: Instant,
    (sight, sense): (&Sight, f64),
) -> ([f64; 3], f64) {
    let gradient = reach.crossed(sight, sense);
    let rate = libm::fabs(dot(gradient, sight.rate));
    (Axes::new(motion, at).gradient(&gradient, &sight.direction), rate)
}

/// What the closest approach says.
#[derive(Debug, Clone, Copy)]
struct Passage {
    sigma_s: f64,
    sigma_rad: f64,
    probability: f64,
}

impl Passage {
    /// The target circles the axis of `turning`; its own motion is negligible against that.
    #[cfg_attr(target_os = "none", inline(never))]
    fn new(
        axes: &Axes,
        turning: &Vector3<f64>,
        sight: &Sight,
        (reach, covariance): (&Reach, &ScanCovariance),
    ) -> Self {
        let speed = libm::sqrt(dot(*turning, *turning));
        let pole = over(*turning, libm::fmax(speed, f64::MIN_POSITIVE));
        let w = sight.direction;
        let across = cross(pole, w);
        let sin = libm::sqrt(dot(across, across));
        let cos = dot(pole, w);
        let theta = libm::atan2(sin, cos);
        // Across the track, away from the pole.
        let track = cross(w, sight.rate);
        let length = libm::sqrt(dot(track, track));
        let sense = libm::copysign(libm::fmax(length, f64::MIN_POSITIVE), -dot(track, pole));
        let away = over(track, sense);
        let sigma = libm::sqrt(covariance.along(axes.gradient(&away, &w)));
        let Edges { near, far } = reach.edges_from(&pole);
        let below = |limit: f64| {
            let ahead = limit - theta;
            if sigma > 0.0 {
                0.5 * (1.0 + libm::erf(ahead / sigma * FRAC_1_SQRT_2))
            } else if ahead >= 0.0 {
                1.0
            } else {
                0.0
            }
        };
        let up_to = if far >= PI { 1.0 } else { below(far) };
        let short_of = if near <= 0.0 { 0.0 } else { below(near) };
        Self {
            sigma_s: 0.0,
            sigma_rad: sigma,
            probability: libm::fmin(libm::fmax(up_to - short_of, 0.0), 1.0),
        }
    }
}

/// Standard deviation in seconds of the instant where `g = e . w` is largest: g'(t, x) = 0.
///
/// With `w' = q - Omega x w`, q the target's own motion, and an axis k that turns at k':
/// `dw'/dx = -k' x w - k x w'` and `w'' = -Omega' x w - Omega x (w' + q)`, q' negligible. Fixed in
/// space, the precession's and alpha's axes turn at `-spin z x k` in the spin frame.
#[cfg_attr(target_os = "none", inline(never))]
fn closest_sigma_s(
    sight: &Sight,
    axes: &Axes,
    motion: &Motion,
    (e, covariance): (Vector3<f64>, &ScanCovariance),
) -> f64 {
    let (w, rate) = (sight.direction, sight.rate);
    let drift = |k: Vector3<f64>| times(cross(Z, k), -motion.spin);
    let turning = plus(times(axes.precession, motion.precession), times(Z, motion.spin));
    let turning_rate = times(drift(axes.precession), motion.precession);
    let own = plus(rate, cross(turning, w));
    let second = minus(cross(negated(turning_rate), w), cross(turning, plus(rate, own)));
    let (with_w, with_rate) = (cross(e, w), cross(e, rate));
    let along = |k: Vector3<f64>, k_rate: Vector3<f64>| dot(k_rate, with_w) + dot(k, with_rate);
    let gradient = [
        along(axes.precession, drift(axes.precession)),
        along(axes.alpha, drift(axes.alpha)),
        along(Z, vector(0.0, 0.0, 0.0)),
    ];
    ratio(libm::sqrt(covariance.along(gradient)), libm::fabs(dot(e, second)))
}

/// `a / b`, and 0 for 0 / 0.
fn ratio(a: f64, b: f64) -> f64 {
    if a > 0.0 { a / b } else { 0.0 }
}
