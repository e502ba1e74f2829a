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

use super::box_coefficients::{BoxCoefficients, CURVATURE, SMALL_TILT, SMOOTH_M};
use super::coefficients::{all_of_sinc, sinc};
use super::motion::{Motion, Tolerance};
use super::predictor::{Predictor, SMOOTH};
use std::f64::consts::PI;

/// Slices of a box to begin with.
const FIRST_SLICES: u32 = 10;
/// Products of two pairs below it are bounded without a look at where they meet.
const NEGLIGIBLE_OVERLAP: f64 = 1e-9;
/// Powers below it are bounded by their largest P(m) alone.
const FINE_POWER: f64 = 1e-5;
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

impl Predictor {
    /// The bound over a slice with the variance in its middle.
    pub(super) fn bound(
        &mut self,
        common: &mut BoxCoefficients<'_>,
        (slice, middle): (Slice, f64),
    ) -> Bounded {
        let BoxCoefficients { motion, orbit, room, .. } = *common;
        let limit = (f64::from(self.l_max()) + room) * (1.0 + orbit.rate());
        let eta = f64::midpoint(slice.eta[0], slice.eta[1]);
        let precession_period_s = f64::midpoint(slice.precession_s[0], slice.precession_s[1]);
        let centre =
            Motion { precession_period_s, spin_period_s: precession_period_s / eta, ..motion };
        let pairs = self.pairs_standing(&centre, limit, |k, j| {
            let [low, high] = standing(common, &slice, [k, j]);
            let at = centre.standing(k, j);
            (high - at).abs().max((low - at).abs())
        });
        let mut bands = Vec::with_capacity(pairs.len());
        for pair in pairs {
            let frequencies = [self.pairs[pair].k, self.pairs[pair].j];
            let range = standing(common, &slice, frequencies);
            let power = self.supremum(common, pair, range);
            if power > 0.0 {
                bands.push(Band { pair, frequencies, range, power });
            }
        }
        // One conjugate of each pair is listed; both count.
        let mut variance = common.smooth;
        for (i, a) in bands.iter().enumerate() {
            variance += 2.0 * a.power + 4.0 * self.overlap_with_smooth(common, a);
            variance += 2.0 * self.overlap(common, &slice, a, (a, -1));
            for b in bands.iter().skip(i + 1) {
                for sign in [1, -1] {
                    variance += 4.0 * self.overlap(common, &slice, a, (b, sign));
                }
            }
        }
        let worst = bands.iter().copied().max_by(|a, b| a.power.total_cmp(&b.power));
        Bounded { slice, variance, middle, worst }
    }

    /// The variance at a point of the box in the middle of a slice.
    pub(super) fn middle(
        &mut self,
        common: &BoxCoefficients<'_>,
        tolerance: Tolerance,
        slice: Slice,
    ) -> f64 {
        let eta = f64::midpoint(slice.eta[0], slice.eta[1]);
        self.predict(&at_eta(&common.motion, tolerance, eta)).variance
    }

    /// Bound of the product of a pair with another, or (sign -1) with another's conjugate.
    fn overlap(
        &mut self,
        common: &BoxCoefficients<'_>,
        slice: &Slice,
        a: &Band,
        (b, sign): (&Band, i32),
    ) -> f64 {
        let crude = (a.power * b.power).sqrt();
        if crude < NEGLIGIBLE_OVERLAP {
            return crude;
        }
        let other = if sign < 0 { [-b.range[1], -b.range[0]] } else { b.range };
        let widened = [a.range, other].map(|range| common.widened(range));
        let low = widened[0][0].max(widened[1][0]);
        let high = widened[0][1].min(widened[1][1]);
        if low > high {
            return 0.0;
        }
        let frequencies = [0, 1].map(|i| a.frequencies[i] - sign * b.frequencies[i]);
        let [least, most] = standing(common, slice, frequencies);
        let apart = least.max(-most).max(0.0);
        let share = common.overlap_share(apart);
        if crude * share < common.fine_overlap || high - low > common.meetings {
            return crude * share;
        }
        let l_max = f64::from(self.l_max());
        // By Cauchy and Schwarz at each m, the largest first.
        let mut bounds: Vec<(f64, i32)> = whole(low.max(-l_max), high.min(l_max))
            .map(|m| ((self.pair_power(a.pair, m) * self.pair_power(b.pair, m)).sqrt(), m.abs()))
            .collect();
        bounds.sort_by(|a, b| b.0.total_cmp(&a.0));
        let bound = |largest: f64| share * crude.min(common.coefficients * largest);
        let mut largest = 0.0_f64;
        for (most, m) in bounds {
            if largest >= most || bound(largest) >= crude * share {
                break;
            }
            if bound(most) < common.fine_overlap {
                largest = most;
                break;
            }
            let [even, odd] = self.products(m, a.pair, b.pair);
            largest = largest.max((even + f64::from(sign) * odd).abs());
        }
        bound(largest)
    }

    /// Largest power of one conjugate where its `m*` lies in a range.
    fn supremum(&mut self, common: &mut BoxCoefficients<'_>, pair: usize, range: [f64; 2]) -> f64 {
        let BoxCoefficients { orbits, coefficients, tilt, points, .. } = *common;
        let l_max = f64::from(self.l_max());
        let [low, high] = common.widened(range);
        let mut largest = 0.0_f64;
        for m in whole(low.max(-l_max), high.min(l_max)) {
            largest = largest.max(self.pair_power(pair, m));
        }
        let crude = coefficients * largest;
        if tilt > SMALL_TILT || crude < FINE_POWER {
            return crude;
        }
        let mut fine = 0.0_f64;
        let edge = l_max * (1.0 + common.orbit.rate()) + common.room;
        let mut at = (range[0].max(-edge) * points - 0.5).ceil();
        let last = (range[1].min(edge) * points + 0.5).floor();
        while at <= last {
            fine = fine.max(self.power_at(common, pair, at / points));
            at += 1.0;
        }
        let bend = CURVATURE * orbits * orbits * crude / (8.0 * points * points);
        let shifted = (fine + bend).max(0.0).sqrt() + tilt * crude.sqrt();
        crude.min(shifted * shifted)
    }

    /// Power of one conjugate at an `m*`, a whole number of points.
    fn power_at(&mut self, common: &mut BoxCoefficients<'_>, pair: usize, m_star: f64) -> f64 {
        let BoxCoefficients { orbits, points, .. } = *common;
        let [low, high] = common.widened([m_star, m_star]);
        let (mut sum, mut kept) = (0.0, 0.0);
        for m in whole(low, high) {
            let apart = (m_star - f64::from(m)) * points;
            // c_m(m*) and c_-m(-m*) are conjugate.
            let apart = if m < 0 { -apart } else { apart };
            let square = common.squares(m.abs()).at(apart);
            kept += square;
            sum += square * self.pair_power(pair, m);
        }
        let all = all_of_sinc(m_star, orbits) * common.orbit.slowness();
        if kept < 1e-6 { sum } else { sum * all / kept }
    }

    /// What the smooth term has at m near 0 because the orbit is no circle; nothing on one.
    pub(super) fn smooth_beside(&mut self, common: &mut BoxCoefficients<'_>) -> f64 {
        if common.orbit.is_circular() {
            return 0.0;
        }
        (1..=SMOOTH_M).map(|m| 2.0 * common.still(m) * self.pair_power(SMOOTH, m)).sum()
    }

    /// Bound of a pair's product with the smooth term, one conjugate.
    fn overlap_with_smooth(&mut self, common: &mut BoxCoefficients<'_>, band: &Band) -> f64 {
        let [low, high] = common.widened(band.range);
        let l_max = f64::from(self.l_max());
        let mut m = low.max(-l_max).ceil();
        let mut sum = 0.0;
        while m <= high.min(l_max) {
            #[expect(clippy::cast_possible_truncation, reason = "to l_max")]
            let whole = m.abs() as i32;
            let mut share = sinc(PI * m * common.orbits).abs();
            if !common.orbit.is_circular() && whole <= SMOOTH_M {
                share = share.max(common.still(whole).sqrt());
            }
            if share > 1e-12 {
                let [even, odd] = self.products(whole, SMOOTH, band.pair);
                sum += share * (even + odd).abs().max((even - odd).abs());
            }
            m += 1.0;
        }
        sum * common.coefficients.sqrt()
    }
}

/// Least and largest `m*` of a pair in a slice.
fn standing(common: &BoxCoefficients<'_>, slice: &Slice, [k, j]: [i32; 2]) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for eta in slice.eta {
        for precession_s in slice.precession_s {
            let turns = f64::from(j).mul_add(eta, f64::from(k));
            let m = -common.motion.orbit_period_s / precession_s * turns;
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
