//! How large a pair's coefficients can be anywhere in a box of tolerances.
//!
//! The coefficient of m is a function of `m* - m` alone on a circle, and of m too on other orbits;
//! what all slices of a box share of them is kept in [`BoxCoefficients`].
//!
//! Method: squares are tabulated at points, so many between whole `m*`; between points they exceed the
//! tabulated ones by at most `h^2 / 8` times [`CURVATURE`]. Overlaps of two pairs are tabulated by the
//! distance of their `m*`, with the margin that their slope asks for.
//!
//! Limits: tests `powers_bend_less_than_stated` and `overlaps_fall_with_distance`.

use super::coefficients::{all_of_sinc, reach, sinc};
use super::motion::Motion;
use super::orbit::Orbit;
use std::f64::consts::PI;

/// Whole m in which two pairs meet that are looked at one by one, on a circle.
const MOST_MEETINGS: f64 = 24.0;
/// Products of two pairs below it are bounded by Cauchy and Schwarz; off the circle, where a point
/// already exceeds the allowance, those below the second.
const FINE_OVERLAP: f64 = 2e-6;
const COARSE_OVERLAP: f64 = 2e-5;
/// Largest change of an amplitude by the orbit's latitude that is bounded as a change.
pub(super) const SMALL_TILT: f64 = 0.05;
/// Where the smooth term is looked at off the circle: its coefficients fall as the eccentricity's
/// powers.
pub(super) const SMOOTH_M: i32 = 4;
/// Points between whole m*, for one orbit.
const POINTS: f64 = 12.0;
/// Bound of the second derivative of N over its largest value, for one orbit.
///
/// `w = |c|^2`, `w'' = 2 |c'|^2 + 2 Re(c'' c*)`, and the sum over m of w'' vanishes, so that weights P
/// from 0 to 1 leave at most half the sum of `|w''|`. With the time from the middle of the survey,
/// Parseval bounds it by `(2 pi)^2 (1/12 + 1/sqrt 80) = 7.7`, on the Earth's ellipse by 1 / (1 - r) more.
pub(super) const CURVATURE: f64 = 8.5;

/// What does not change from slice to slice of a box.
#[derive(Debug, Clone)]
pub(super) struct BoxCoefficients<'o> {
    pub(super) motion: Motion,
    pub(super) orbit: &'o Orbit,
    pub(super) orbits: f64,
    pub(super) smooth: f64,
    /// Largest sum of squares of one pair's coefficients.
    pub(super) coefficients: f64,
    /// How far a pair's terms may be from its `m*`, on a circle.
    pub(super) room: f64,
    /// Largest change of an amplitude by the orbit's latitude, in parts of the pair's largest.
    pub(super) tilt: f64,
    /// Bounds of the sum of products of two pairs' coefficients relative to the geometric mean of
    /// their sums of squares, by the distance of their `m*` in cells of [`CELL`]; on a circle.
    overlaps: Vec<f64>,
    /// Most whole m in which two pairs meet that are looked at one by one.
    pub(super) meetings: f64,
    /// Products of two pairs below it are bounded by Cauchy and Schwarz.
    pub(super) fine_overlap: f64,
    /// Points between whole m*.
    pub(super) points: f64,
    /// Squares of the coefficients at m, for `m* - m` at the points; on a circle at 0 only.
    squares: Vec<Option<Squares>>,
}

/// Squares of the coefficients of one m.
#[derive(Debug, Clone)]
pub(super) struct Squares {
    /// `m* - m` of the first, in points.
    first: f64,
    values: Vec<f64>,
}

impl Squares {
    /// Where `m* - m` is a number of points.
    pub(super) fn at(&self, points: f64) -> f64 {
        let index = points - self.first;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let found = if index >= 0.0 { self.values.get(index as usize) } else { None };
        found.copied().unwrap_or(0.0)
    }
}

impl<'o> BoxCoefficients<'o> {
    /// What holds for all slices; `smooth` is the variance without resonances.
    pub(super) fn new(motion: Motion, orbit: &'o Orbit, smooth: f64, l_max: f64) -> Self {
        let (orbits, reach) = (motion.orbits(), reach(&motion));
        let tilt = orbit.latitude_rad() * l_max;
        let room = reach.ceil() + 0.5 + if tilt > SMALL_TILT { tilt } else { 0.0 };
        Self {
            motion,
            orbit,
            orbits,
            smooth,
            coefficients: all_of_sinc(0.0, orbits) * orbit.slowness().max(1.0),
            room,
            tilt,
            overlaps: if orbit.is_circular() { overlaps(orbits, reach) } else { Vec::new() },
            meetings: if orbit.is_circular() { MOST_MEETINGS } else { f64::INFINITY },
            fine_overlap: FINE_OVERLAP,
            points: (POINTS * orbits.abs()).ceil(),
            squares: Vec::new(),
        }
    }

    /// A point exceeds the allowance: no finer bound could pass.
    pub(super) fn refuted(&mut self) {
        if !self.orbit.is_circular() {
            self.fine_overlap = COARSE_OVERLAP;
        }
    }

    /// Where the terms of a pair can lie whose `m*` lies in a range.
    pub(super) fn widened(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let rate = self.orbit.rate();
        let least = (low / (1.0 - rate)).min(low / (1.0 + rate));
        let most = (high / (1.0 - rate)).max(high / (1.0 + rate));
        [least - self.room, most + self.room]
    }

    /// How much two pairs whose `m*` are at least `apart` from each other can overlap, from 0 to 1.
    pub(super) fn overlap_share(&self, apart: f64) -> f64 {
        if !self.orbit.is_circular() {
            1.0
        } else if apart > 2.0 * self.room {
            0.0
        } else {
            self.overlaps.get(cell(apart, self.orbits)).copied().unwrap_or(0.0)
        }
    }

    /// The square of the smooth term's coefficient at m, where `m* = 0`; m to [`SMOOTH_M`].
    pub(super) fn still(&mut self, m: i32) -> f64 {
        let points = self.points;
        self.squares(m).at(-f64::from(m) * points)
    }

    /// The squares of the coefficients of m, not negative.
    pub(super) fn squares(&mut self, m: i32) -> &Squares {
        let m = if self.orbit.is_circular() { 0 } else { m };
        let at = m.unsigned_abs() as usize;
        if self.squares.len() <= at {
            self.squares.resize_with(at + 1, || None);
        }
        let Self { orbit, orbits, room, points, .. } = *self;
        self.squares[at].get_or_insert_with(|| {
            let rate = orbit.rate();
            let half = points * (room * (1.0 + rate) + f64::from(m) * rate + 1.0);
            let first = -half.ceil();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
            let count = (1.0 - 2.0 * first) as usize;
            let at = (f64::from(m), orbits);
            Squares { first, values: orbit.squares(at, points.recip(), (first, count)) }
        })
    }
}

/// Points between whole m* at which overlaps are taken, for one orbit.
const OVERLAP_POINTS: f64 = 32.0;
/// Points of a cell of distances of `m*`.
const CELL: f64 = 4.0;

/// The cell of a distance, not negative.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, positive")]
fn cell(apart: f64, orbits: f64) -> usize {
    (apart * OVERLAP_POINTS * orbits.abs() / CELL) as usize
}

/// For each cell of distances, the largest sum of products of coefficients there or beyond.
fn overlaps(orbits: f64, reach: f64) -> Vec<f64> {
    let orbits = orbits.abs();
    let fine = OVERLAP_POINTS * orbits;
    let room = reach.ceil() + 0.5;
    let steps = |length: f64| (length * fine).ceil();
    let largest = all_of_sinc(0.0, orbits);
    // How much the tail's correction raises amplitudes.
    let mut kept = f64::INFINITY;
    let mut sums = vec![0.0_f64; 1 + cell((2.0 * room).ceil(), orbits)];
    let mut x = 0.0;
    while x < steps(1.0) {
        let at = x / fine - 0.5;
        let weight = |m: f64, y: f64| {
            if (m - y).abs() <= room + 1.0 / fine { sinc(PI * orbits * (m - y)).abs() } else { 0.0 }
        };
        let window = |y: f64| {
            let mut m = (y - room - 1.0).ceil();
            std::iter::from_fn(move || {
                m += 1.0;
                (m <= y + room + 1.0).then_some(m)
            })
        };
        let squares: f64 = window(at).map(|m| weight(m, at).powi(2)).sum();
        kept = kept.min(squares);
        let mut apart = 0.0;
        while apart < steps(2.0 * room) {
            let other = at + apart / fine;
            let sum: f64 = window(at).map(|m| weight(m, at) * weight(m, other)).sum();
            if let Some(most) = sums.get_mut(cell(apart / fine, orbits)) {
                *most = most.max(sum);
            }
            apart += 1.0;
        }
        x += 1.0;
    }
    // Between points the sum changes by at most its slope, pi N_o / sqrt 3 of the norms, in each
    // argument, half a step away in x and one in distance.
    let margin = largest * 1.5 * PI * orbits / 3.0_f64.sqrt() / fine;
    let raise = (largest / kept.max(1e-3)).max(1.0);
    let mut beyond = 0.0_f64;
    for sum in sums.iter_mut().rev() {
        beyond = beyond.max(*sum);
        *sum = ((beyond + margin) * raise / largest).min(1.0);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resonance::motion::YEAR_S;
    use crate::resonance::orbit::ellipse;

    /// Half the sum over m of the second derivatives' moduli, relative to `coefficients`.
    fn bend(common: &mut BoxCoefficients<'_>, m_star: f64) -> f64 {
        let h = common.points.recip();
        let [low, high] = common.widened([m_star, m_star]);
        let mut sums = 0.0;
        #[expect(clippy::cast_possible_truncation, reason = "degrees")]
        for m in low.ceil() as i32..=high.floor() as i32 {
            let apart = (m_star - f64::from(m)) * common.points;
            let squares = common.squares(m);
            let w = [-1.0, 0.0, 1.0].map(|off| squares.at((apart + off).round()));
            sums += (w[0] - 2.0 * w[1] + w[2]).abs();
        }
        0.5 * sums / (h * h) / common.coefficients
    }

    #[test]
    fn powers_bend_less_than_stated() {
        for (years, orbit) in [
            (0.7, Orbit::CIRCULAR),
            (1.0, Orbit::CIRCULAR),
            (1.5, Orbit::CIRCULAR),
            (3.0, Orbit::CIRCULAR),
            (1.0, ellipse(1.0)),
            (3.0, ellipse(3.0)),
        ] {
            let motion = Motion { duration_s: years * YEAR_S, ..Motion::year(11_541.0, 1200.0) };
            let mut common = BoxCoefficients::new(motion, &orbit, 0.05, 768.0);
            common.points *= 8.0;
            let mut most = 0.0_f64;
            for i in 0..200 {
                let m_star = (40.0 + f64::from(i) * 0.53 * common.points).round() / common.points;
                most = most.max(bend(&mut common, m_star));
            }
            assert!(most < CURVATURE * years * years, "{years}: {most}");
        }
    }

    #[test]
    fn overlaps_fall_with_distance() {
        for orbits in [0.7, 1.0, 3.0] {
            let found = overlaps(orbits, 3.0 / f64::min(orbits, 1.0));
            assert!((found[0] - 1.0).abs() < 1e-12);
            assert!(found.windows(2).all(|it| it[0] >= it[1]), "{found:?}");
        }
        let found = overlaps(1.0, 3.0);
        assert!(found[cell(6.0, 1.0)] < 0.35, "{found:?}");
    }
}
