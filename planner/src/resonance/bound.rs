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

use super::certificate::Tolerance;
use super::motion::Motion;
use super::orbit::Orbit;
use super::power::{Predictor, SMOOTH, all_of_sinc, sinc};
use std::f64::consts::PI;

/// Slices of a box to begin with.
const FIRST_SLICES: u32 = 10;
/// Whole m in which two pairs meet that are looked at one by one, on a circle.
const MOST_MEETINGS: f64 = 24.0;
/// Products of two pairs below it are bounded without a look at where they meet.
const NEGLIGIBLE_OVERLAP: f64 = 1e-9;
/// Products of two pairs below it are bounded by Cauchy and Schwarz; off the circle, where a point
/// already exceeds the allowance, those below the second.
const FINE_OVERLAP: f64 = 2e-6;
const COARSE_OVERLAP: f64 = 2e-5;
/// Powers below it are bounded by their largest P(m) alone.
const FINE_POWER: f64 = 1e-5;
/// Largest change of an amplitude by the orbit's latitude that is bounded as a change.
const SMALL_TILT: f64 = 0.05;
/// Where the smooth term is looked at off the circle: its coefficients fall as the eccentricity's
/// powers.
const SMOOTH_M: i32 = 4;
/// Points between whole m*, for one orbit.
const POINTS: f64 = 12.0;
/// Bound of the second derivative of N over its largest value, for one orbit.
///
/// `w = |c|^2`, `w'' = 2 |c'|^2 + 2 Re(c'' c*)`, and the sum over m of w'' vanishes, so that weights P
/// from 0 to 1 leave at most half the sum of `|w''|`. With the time from the middle of the survey,
/// Parseval bounds it by `(2 pi)^2 (1/12 + 1/sqrt 80) = 7.7`, on the Earth's ellipse by 1 / (1 - r) more.
const CURVATURE: f64 = 8.5;

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
pub(super) struct Survey<'o> {
    pub(super) motion: Motion,
    pub(super) orbit: &'o Orbit,
    orbits: f64,
    pub(super) smooth: f64,
    /// Largest sum of squares of one pair's coefficients.
    coefficients: f64,
    /// How far a pair's terms may be from its `m*`, on a circle.
    room: f64,
    /// Largest change of an amplitude by the orbit's latitude, in parts of the pair's largest.
    tilt: f64,
    /// Bounds of the sum of products of two pairs' coefficients relative to the geometric mean of
    /// their sums of squares, by the distance of their `m*` in cells of [`CELL`]; on a circle.
    overlaps: Vec<f64>,
    /// Most whole m in which two pairs meet that are looked at one by one.
    meetings: f64,
    /// Products of two pairs below it are bounded by Cauchy and Schwarz.
    fine_overlap: f64,
    /// Points between whole m*.
    points: f64,
    /// Squares of the coefficients at m, for `m* - m` at the points; on a circle at 0 only.
    squares: Vec<Option<Squares>>,
}

/// Squares of the coefficients of one m.
#[derive(Debug, Clone)]
struct Squares {
    /// `m* - m` of the first, in points.
    first: f64,
    values: Vec<f64>,
}

impl Squares {
    /// Where `m* - m` is a number of points.
    fn at(&self, points: f64) -> f64 {
        let index = points - self.first;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
        let found = if index >= 0.0 { self.values.get(index as usize) } else { None };
        found.copied().unwrap_or(0.0)
    }
}

impl<'o> Survey<'o> {
    /// What holds for all slices; `smooth` is the variance without resonances.
    pub(super) fn new(motion: Motion, orbit: &'o Orbit, smooth: f64, l_max: f64) -> Self {
        let (orbits, reach) = (motion.orbits(), Predictor::reach(&motion));
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
    fn widened(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let rate = self.orbit.rate();
        let least = (low / (1.0 - rate)).min(low / (1.0 + rate));
        let most = (high / (1.0 - rate)).max(high / (1.0 + rate));
        [least - self.room, most + self.room]
    }

    /// The square of the smooth term's coefficient at m, where `m* = 0`; m to [`SMOOTH_M`].
    fn still(&mut self, m: i32) -> f64 {
        let points = self.points;
        self.squares(m).at(-f64::from(m) * points)
    }

    /// The squares of the coefficients of m, not negative.
    fn squares(&mut self, m: i32) -> &Squares {
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

impl Predictor {
    /// The bound over a slice with the variance in its middle.
    pub(super) fn bound(
        &mut self,
        survey: &mut Survey<'_>,
        (slice, middle): (Slice, f64),
    ) -> Bounded {
        let Survey { motion, orbit, room, .. } = *survey;
        let limit = (f64::from(self.l_max()) + room) * (1.0 + orbit.rate());
        let eta = f64::midpoint(slice.eta[0], slice.eta[1]);
        let precession_period_s = f64::midpoint(slice.precession_s[0], slice.precession_s[1]);
        let centre =
            Motion { precession_period_s, spin_period_s: precession_period_s / eta, ..motion };
        let pairs = self.pairs_standing(&centre, limit, |k, j| {
            let [low, high] = standing(survey, &slice, [k, j]);
            let at = centre.standing(k, j);
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
        Bounded { slice, variance, middle, worst }
    }

    /// The variance at a point of the box in the middle of a slice.
    pub(super) fn middle(
        &mut self,
        survey: &Survey<'_>,
        tolerance: Tolerance,
        slice: Slice,
    ) -> f64 {
        let eta = f64::midpoint(slice.eta[0], slice.eta[1]);
        self.predict(&at_eta(&survey.motion, tolerance, eta)).variance
    }

    /// Bound of the product of a pair with another, or (sign -1) with another's conjugate.
    fn overlap(
        &mut self,
        survey: &Survey<'_>,
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
        let share = if survey.orbit.is_circular() {
            if apart > 2.0 * room {
                return 0.0;
            }
            survey.overlaps.get(cell(apart, survey.orbits)).copied().unwrap_or(0.0)
        } else {
            1.0
        };
        if crude * share < survey.fine_overlap || high - low > survey.meetings {
            return crude * share;
        }
        let l_max = f64::from(self.l_max());
        // By Cauchy and Schwarz at each m, the largest first.
        let mut bounds: Vec<(f64, i32)> = whole(low.max(-l_max), high.min(l_max))
            .map(|m| ((self.pair_power(a.pair, m) * self.pair_power(b.pair, m)).sqrt(), m.abs()))
            .collect();
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        let bound = |largest: f64| share * crude.min(survey.coefficients * largest);
        let mut largest = 0.0_f64;
        for (most, m) in bounds {
            if largest >= most || bound(largest) >= crude * share {
                break;
            }
            if bound(most) < survey.fine_overlap {
                largest = most;
                break;
            }
            let [even, odd] = self.products(m, a.pair, b.pair);
            largest = largest.max((even + f64::from(sign) * odd).abs());
        }
        bound(largest)
    }

    /// Largest power of one conjugate where its `m*` lies in a range.
    fn supremum(&mut self, survey: &mut Survey<'_>, pair: usize, range: [f64; 2]) -> f64 {
        let Survey { orbits, coefficients, tilt, points, .. } = *survey;
        let l_max = f64::from(self.l_max());
        let [low, high] = survey.widened(range);
        let mut largest = 0.0_f64;
        for m in whole(low.max(-l_max), high.min(l_max)) {
            largest = largest.max(self.pair_power(pair, m));
        }
        let crude = coefficients * largest;
        if tilt > SMALL_TILT || crude < FINE_POWER {
            return crude;
        }
        let mut fine = 0.0_f64;
        let edge = l_max * (1.0 + survey.orbit.rate()) + survey.room;
        let mut at = (range[0].max(-edge) * points - 0.5).ceil();
        let last = (range[1].min(edge) * points + 0.5).floor();
        while at <= last {
            fine = fine.max(self.power_at(survey, pair, at / points));
            at += 1.0;
        }
        let bend = CURVATURE * orbits * orbits * crude / (8.0 * points * points);
        let shifted = (fine + bend).max(0.0).sqrt() + tilt * crude.sqrt();
        crude.min(shifted * shifted)
    }

    /// Power of one conjugate at an `m*`, a whole number of points.
    fn power_at(&mut self, survey: &mut Survey<'_>, pair: usize, m_star: f64) -> f64 {
        let Survey { orbits, points, .. } = *survey;
        let [low, high] = survey.widened([m_star, m_star]);
        let (mut sum, mut kept) = (0.0, 0.0);
        for m in whole(low, high) {
            let apart = (m_star - f64::from(m)) * points;
            // c_m(m*) and c_-m(-m*) are conjugate.
            let apart = if m < 0 { -apart } else { apart };
            let square = survey.squares(m.abs()).at(apart);
            kept += square;
            sum += square * self.pair_power(pair, m);
        }
        let all = all_of_sinc(m_star, orbits) * survey.orbit.slowness();
        if kept < 1e-6 { sum } else { sum * all / kept }
    }

    /// What the smooth term has at m near 0 because the orbit is no circle; nothing on one.
    pub(super) fn smooth_beside(&mut self, survey: &mut Survey<'_>) -> f64 {
        if survey.orbit.is_circular() {
            return 0.0;
        }
        (1..=SMOOTH_M).map(|m| 2.0 * survey.still(m) * self.pair_power(SMOOTH, m)).sum()
    }

    /// Bound of a pair's product with the smooth term, one conjugate.
    fn overlap_with_smooth(&mut self, survey: &mut Survey<'_>, band: &Band) -> f64 {
        let [low, high] = survey.widened(band.range);
        let l_max = f64::from(self.l_max());
        let mut m = low.max(-l_max).ceil();
        let mut sum = 0.0;
        while m <= high.min(l_max) {
            #[expect(clippy::cast_possible_truncation, reason = "to l_max")]
            let whole = m.abs() as i32;
            let mut share = sinc(PI * m * survey.orbits).abs();
            if !survey.orbit.is_circular() && whole <= SMOOTH_M {
                share = share.max(survey.still(whole).sqrt());
            }
            if share > 1e-12 {
                let [even, odd] = self.products(whole, SMOOTH, band.pair);
                sum += share * (even + odd).abs().max((even - odd).abs());
            }
            m += 1.0;
        }
        sum * survey.coefficients.sqrt()
    }
}

/// Least and largest `m*` of a pair in a slice.
fn standing(survey: &Survey<'_>, slice: &Slice, [k, j]: [i32; 2]) -> [f64; 2] {
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

/// The whole numbers from `low` to `high`.
fn whole(low: f64, high: f64) -> std::ops::RangeInclusive<i32> {
    #[expect(clippy::cast_possible_truncation, reason = "degrees")]
    let (low, high) = (low.ceil() as i32, high.floor() as i32);
    low..=high
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
    use crate::resonance::motion::YEAR_S;
    use crate::resonance::orbit::ellipse;

    /// Half the sum over m of the second derivatives' moduli, relative to `coefficients`.
    fn bend(survey: &mut Survey<'_>, m_star: f64) -> f64 {
        let h = survey.points.recip();
        let [low, high] = survey.widened([m_star, m_star]);
        let mut sums = 0.0;
        for m in whole(low, high) {
            let apart = (m_star - f64::from(m)) * survey.points;
            let squares = survey.squares(m);
            let w = [-1.0, 0.0, 1.0].map(|off| squares.at((apart + off).round()));
            sums += (w[0] - 2.0 * w[1] + w[2]).abs();
        }
        0.5 * sums / (h * h) / survey.coefficients
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
            let mut survey = Survey::new(motion, &orbit, 0.05, 768.0);
            survey.points *= 8.0;
            let mut most = 0.0_f64;
            for i in 0..200 {
                let m_star = (40.0 + f64::from(i) * 0.53 * survey.points).round() / survey.points;
                most = most.max(bend(&mut survey, m_star));
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
