//! The largest variance of hits over a slice of period ratios.
//!
//! In a slice of `eta = T_a / T_b` each pair's `m* = -(T_o / T_a)(k + j eta)` lies in an interval, and
//! whatever the start phases
//!
//! `variance <= smooth + sum_a sup N_a + sum_(a != b) |a b|`.
//!
//! Method: `N(m*) = sum_m P(m) c_m^2` is evaluated at points h apart and exceeds its values there by at
//! most `h^2 / 8` times a bound of its second derivative. A product `|a b|` is at most
//! `sqrt(N_a N_b)` and at most the largest `|sum_l|` of both amplitudes where the two can meet, both
//! times the largest `sum_m |c_m c'_m|` at the distance of their `m*`.
//!
//! Limits: rigorous for the terms of [`super::power`]; curvature and overlaps of the coefficients are
//! bounded numerically, with the margin that their slope asks for (test
//! `no_point_in_a_passing_box_exceeds_its_bound` of the certificate).

use super::certificate::{OrbitSpread, Tolerance};
use super::motion::Motion;
use super::power::{Predictor, SMOOTH, all_of_sinc, sinc};
use std::f64::consts::PI;

/// Slices of a box to begin with.
const FIRST_SLICES: u32 = 10;
/// Whole m in which two pairs meet that are looked at one by one, on a circle.
const MOST_MEETINGS: f64 = 24.0;
/// Products of two pairs below it are bounded without a look at where they meet.
const NEGLIGIBLE_OVERLAP: f64 = 1e-9;
/// Products of two pairs below it are bounded by Cauchy and Schwarz.
const FINE_OVERLAP: f64 = 1e-6;
/// Powers below it are bounded by their largest P(m) alone.
const FINE_POWER: f64 = 1e-5;
/// Points between whole m*, for one orbit.
const POINTS: f64 = 16.0;
/// Bound of the sum of `|w''|` over the terms' weights, for one orbit.
const CURVATURE: f64 = 20.0;

/// Ranges of eta and of the precession period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slice {
    pub(super) eta: [f64; 2],
    pub(super) precession_s: [f64; 2],
}

impl Slice {
    /// [`FIRST_SLICES`] equal parts, or itself where it is a point.
    pub(super) fn parts(self) -> impl Iterator<Item = Self> {
        let [low, high] = self.eta;
        let count = if low < high { FIRST_SLICES } else { 1 };
        let edge = move |i: u32| low + (high - low) * f64::from(i) / f64::from(count);
        (0..count).map(move |i| Self { eta: [edge(i), edge(i + 1).max(edge(i))], ..self })
    }
}

/// A pair's share of a slice's bound, one conjugate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Band {
    pub(super) pair: usize,
    pub(super) frequencies: [i32; 2],
    /// Of `m*`.
    pub(super) range: [f64; 2],
    pub(super) power: f64,
}

/// A slice with its bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounded {
    pub(super) slice: Slice,
    pub(super) variance: f64,
    /// The variance at a point of its middle.
    pub(super) middle: f64,
    /// The strongest pair.
    pub(super) worst: Option<Band>,
}

/// What does not change from slice to slice.
#[derive(Debug, Clone)]
pub(super) struct Survey {
    pub(super) motion: Motion,
    pub(super) spread: OrbitSpread,
    pub(super) orbits: f64,
    pub(super) reach: f64,
    pub(super) smooth: f64,
    /// Largest sum of squares of one pair's coefficients.
    pub(super) coefficients: f64,
    /// How far a pair's terms may be from its `m*`, on a circle.
    pub(super) room: f64,
    /// Bounds of the sum of products of two pairs' coefficients relative to the geometric mean of
    /// their sums of squares, by the distance of their `m*` in cells of [`CELL`].
    pub(super) overlaps: Vec<f64>,
    /// Most whole m in which two pairs meet that are looked at one by one.
    pub(super) meetings: f64,
    /// Points between whole m*.
    pub(super) points: f64,
    /// Shares of the terms about a whole m where `m*` is beyond it by an offset.
    pub(super) weights: Vec<(f64, Vec<f64>)>,
}

impl Survey {
    /// What holds for all slices; `smooth` is the variance without resonances.
    pub(super) fn new(motion: Motion, spread: OrbitSpread, smooth: f64, l_max: f64) -> Self {
        let (orbits, reach) = (motion.orbits(), Predictor::reach(&motion));
        let points = POINTS * orbits.abs().ceil().max(1.0);
        Self {
            motion,
            spread,
            orbits,
            reach,
            smooth,
            coefficients: all_of_sinc(0.0, orbits) / (1.0 - spread.rate),
            room: reach.ceil() + 0.5 + spread.latitude_rad * l_max,
            overlaps: overlaps(orbits, reach),
            meetings: if spread == OrbitSpread::CIRCULAR { MOST_MEETINGS } else { f64::INFINITY },
            points,
            weights: weights(orbits, reach, points),
        }
    }

    /// Where the terms of a pair can lie whose `m*` lies in a range.
    fn widened(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let rate = self.spread.rate;
        let least = (low / (1.0 - rate)).min(low / (1.0 + rate));
        let most = (high / (1.0 - rate)).max(high / (1.0 + rate));
        [least - self.room, most + self.room]
    }
}

/// For offsets of `m*` from -1/2 to 1/2, the squares of the terms' coefficients.
fn weights(orbits: f64, reach: f64, points: f64) -> Vec<(f64, Vec<f64>)> {
    let mut sets = Vec::new();
    let mut point = 0.0;
    while point <= points {
        let offset = point / points - 0.5;
        let mut squares = Vec::new();
        let mut m = -reach.ceil();
        while m <= reach.ceil() {
            squares.push(sinc(PI * (m - offset) * orbits).powi(2));
            m += 1.0;
        }
        let kept: f64 = squares.iter().sum();
        if kept >= 1e-6 {
            let scale = all_of_sinc(offset, orbits) / kept;
            for square in &mut squares {
                *square *= scale;
            }
        }
        sets.push((offset, squares));
        point += 1.0;
    }
    sets
}

/// Width of a cell of distances of `m*`.
const CELL: f64 = 0.125;

/// The cell of a distance, not negative.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small, positive")]
fn cell(apart: f64) -> usize {
    (apart / CELL) as usize
}

/// For each cell of distances, the largest sum of products of coefficients there or beyond.
fn overlaps(orbits: f64, reach: f64) -> Vec<f64> {
    let orbits = orbits.abs();
    let fine = 32.0 * orbits.max(1.0);
    let room = reach.ceil() + 0.5;
    let steps = |length: f64| (length * fine).ceil();
    let largest = all_of_sinc(0.0, orbits);
    // How much the tail's correction raises amplitudes.
    let mut kept = f64::INFINITY;
    let mut sums = vec![0.0_f64; 1 + cell((2.0 * room).ceil())];
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
            if let Some(most) = sums.get_mut(cell(apart / fine)) {
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

impl Predictor {
    /// The bound over a slice, and the variance at a point of the box in its middle.
    pub(super) fn bound(&mut self, survey: &Survey, tolerance: Tolerance, slice: Slice) -> Bounded {
        let Survey { motion, spread, room, .. } = *survey;
        let limit = (f64::from(self.l_max()) + room) * (1.0 + spread.rate);
        let eta = f64::midpoint(slice.eta[0], slice.eta[1]);
        let precession_period_s = f64::midpoint(slice.precession_s[0], slice.precession_s[1]);
        let middle =
            Motion { precession_period_s, spin_period_s: precession_period_s / eta, ..motion };
        let pairs = self.pairs_standing(&middle, limit, |k, j| {
            let [low, high] = standing(survey, &slice, [k, j]);
            let at = middle.standing(k, j);
            (high - at).abs().max((low - at).abs())
        });
        let mut bands = Vec::with_capacity(pairs.len());
        for pair in pairs {
            let frequencies = [self.pairs[pair].k, self.pairs[pair].j];
            let range = standing(survey, &slice, frequencies);
            let power = self.supremum(survey, pair, range);
            if power > 0.0 {
                bands.push(Band { pair, frequencies, range, power });
            }
        }
        // One conjugate of each pair is listed; both count.
        let mut variance = survey.smooth;
        for (i, a) in bands.iter().enumerate() {
            variance += 2.0 * a.power + 4.0 * self.overlap_with_smooth(survey, a);
            variance += 2.0 * self.overlap(survey, &slice, a, (a, -1));
            for b in bands.iter().skip(i + 1) {
                for sign in [1, -1] {
                    variance += 4.0 * self.overlap(survey, &slice, a, (b, sign));
                }
            }
        }
        let worst = bands.iter().copied().max_by(|a, b| a.power.total_cmp(&b.power));
        let middle = self.predict(&at_eta(&motion, tolerance, eta)).variance;
        Bounded { slice, variance, middle, worst }
    }

    /// Bound of the product of a pair with another, or (sign -1) with another's conjugate.
    fn overlap(
        &mut self,
        survey: &Survey,
        slice: &Slice,
        a: &Band,
        (b, sign): (&Band, i32),
    ) -> f64 {
        let crude = (a.power * b.power).sqrt();
        if crude < NEGLIGIBLE_OVERLAP {
            return crude;
        }
        let other = if sign < 0 { [-b.range[1], -b.range[0]] } else { b.range };
        let room = survey.room;
        let widened = [a.range, other].map(|range| survey.widened(range));
        let low = widened[0][0].max(widened[1][0]);
        let high = widened[0][1].min(widened[1][1]);
        if low > high {
            return 0.0;
        }
        let frequencies = [0, 1].map(|i| a.frequencies[i] - sign * b.frequencies[i]);
        let [least, most] = standing(survey, slice, frequencies);
        let apart = least.max(-most).max(0.0);
        let share = if survey.spread == OrbitSpread::CIRCULAR {
            if apart > 2.0 * room {
                return 0.0;
            }
            survey.overlaps.get(cell(apart)).copied().unwrap_or(0.0)
        } else {
            1.0
        };
        if crude * share < FINE_OVERLAP || high - low > survey.meetings {
            return crude * share;
        }
        let mut largest = 0.0_f64;
        let l_max = f64::from(self.l_max());
        let mut m = low.max(-l_max).ceil();
        while m <= high.min(l_max) {
            #[expect(clippy::cast_possible_truncation, reason = "to l_max")]
            let [even, odd] = self.products(m.abs() as i32, a.pair, b.pair);
            largest = largest.max((even + f64::from(sign) * odd).abs());
            if survey.coefficients * largest >= crude {
                break;
            }
            m += 1.0;
        }
        share * crude.min(survey.coefficients * largest)
    }

    /// Largest power of one conjugate where its `m*` lies in a range.
    fn supremum(&mut self, survey: &Survey, pair: usize, range: [f64; 2]) -> f64 {
        let Survey { spread, orbits, reach, coefficients, room, .. } = *survey;
        let l_max = f64::from(self.l_max());
        let [low, high] = survey.widened(range);
        let mut largest = 0.0_f64;
        let mut m = low.max(-l_max).ceil();
        while m <= high.min(l_max) {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "to l_max")]
            let at = m.abs() as usize;
            largest = largest.max(self.pairs[pair].power(at));
            m += 1.0;
        }
        let crude = coefficients * largest;
        if spread != OrbitSpread::CIRCULAR || crude < FINE_POWER {
            return crude;
        }
        let mut fine = 0.0_f64;
        let half_step = 0.5 / survey.points;
        let last = range[1].min(l_max + room).round();
        let mut whole = range[0].max(-l_max - room).round();
        while whole <= last {
            for (offset, weights) in &survey.weights {
                let m_star = whole + offset;
                if m_star < range[0] - half_step || m_star > range[1] + half_step {
                    continue;
                }
                let mut sum = 0.0;
                let mut m = whole - reach.ceil();
                for weight in weights {
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "near l_max at most"
                    )]
                    let at = m.abs() as usize;
                    sum += weight * self.pairs[pair].power(at);
                    m += 1.0;
                }
                fine = fine.max(sum);
            }
            whole += 1.0;
        }
        let bend = CURVATURE * orbits * orbits * coefficients * largest
            / (8.0 * survey.points * survey.points);
        crude.min(fine + bend)
    }

    /// Bound of a pair's product with the smooth term, one conjugate.
    fn overlap_with_smooth(&mut self, survey: &Survey, band: &Band) -> f64 {
        let [low, high] = survey.widened(band.range);
        let l_max = f64::from(self.l_max());
        let mut m = low.max(-l_max).ceil();
        let mut sum = 0.0;
        while m <= high.min(l_max) {
            let share = sinc(PI * m * survey.orbits).abs();
            if share > 1e-12 {
                #[expect(clippy::cast_possible_truncation, reason = "to l_max")]
                let [even, odd] = self.products(m.abs() as i32, SMOOTH, band.pair);
                sum += share * (even + odd).abs().max((even - odd).abs());
            }
            m += 1.0;
        }
        sum * survey.coefficients.sqrt()
    }
}

/// Least and largest `m*` of a pair in a slice.
fn standing(survey: &Survey, slice: &Slice, [k, j]: [i32; 2]) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for eta in slice.eta {
        for precession_s in slice.precession_s {
            let turns = f64::from(j).mul_add(eta, f64::from(k));
            let m = -survey.motion.orbit_period_s / precession_s * turns;
            range = [range[0].min(m), range[1].max(m)];
        }
    }
    // Room for rounding.
    let slack = 1e-9 * (1.0 + range[0].abs().max(range[1].abs()));
    [range[0] - slack, range[1] + slack]
}

/// A point of the box with a given eta.
pub(super) fn at_eta(motion: &Motion, tolerance: Tolerance, eta: f64) -> Motion {
    let (a, b) = (motion.precession_period_s, motion.spin_period_s);
    let width = tolerance.precession_s + eta * tolerance.spin_s;
    if width.abs() < f64::MIN_POSITIVE {
        return *motion;
    }
    // Both periods move in proportion to their tolerances: (a + x da) = eta (b - x db).
    let x = (eta * b - a) / width;
    let x = x.clamp(-1.0, 1.0);
    Motion {
        precession_period_s: a + x * tolerance.precession_s,
        spin_period_s: b - x * tolerance.spin_s,
        ..*motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_bend_less_than_stated() {
        for orbits in [0.7, 1.0, 1.5, 3.0] {
            let reach = 3.0 / f64::min(orbits, 1.0);
            let points = 512.0 * f64::ceil(orbits);
            let sets = weights(orbits, reach, points);
            // Relative to the largest sum of squares, as the bound's term is.
            let scale = all_of_sinc(0.0, orbits) * orbits * orbits;
            for three in sets.windows(3) {
                let bends = (0..three[0].1.len())
                    .map(|i| (three[0].1[i] - 2.0 * three[1].1[i] + three[2].1[i]).abs());
                let bend = bends.sum::<f64>() * points * points;
                assert!(bend < CURVATURE * scale, "{orbits}: {bend} {scale}");
            }
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
        assert!(found[cell(6.0)] < 0.35, "{found:?}");
    }
}
