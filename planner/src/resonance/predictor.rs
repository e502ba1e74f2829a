//! What is known of the pairs of precession and spin frequencies at given angles and window.
//!
//! A [`Predictor`] keeps what depends on nothing but the angles and the window, for all motions: each
//! pair's degrees and powers, and what two of them add to the variance together.
//!
//! Method: a pair (k, j) has `sqrt(2l + 1) w_l d_kj(alpha) d_j0(beta)` at each degree. Its power at m and
//! the products with other pairs' amplitudes at the same m depend on nothing but the angles and the
//! window, and are kept.
//!
//! Limits: pairs whose power cannot exceed [`NEGLIGIBLE_PAIR`] at any m are left out.

use super::motion::Motion;
use super::window::Window;
use crate::harmonics::wigner::{LANES, MAX_L, RightAngle, fill_wigner_d, wigner_d};
use pulp::{Arch, NullaryFnOnce};
use std::collections::BTreeMap;

/// A pair that is left out, by its largest possible power.
const NEGLIGIBLE_PAIR: f64 = 1e-13;
/// Rows that are kept.
const MOST_ROWS: usize = 4096;

/// A pair's degrees.
#[derive(Debug, Clone)]
pub(super) struct Pair {
    pub(super) k: i32,
    pub(super) j: i32,
    /// `sqrt(2l + 1) w_l d_kj(alpha) d_j0(beta)` from l = 0; zero at l = 0.
    pub(super) amplitudes: Vec<f64>,
    squares: Vec<f64>,
    /// Sum of squares: no P(m) exceeds it.
    pub(super) ceiling: f64,
    /// P(m) in blocks of [`LANES`] from m = 0; not a number where not known yet.
    powers: Vec<f64>,
}

impl Pair {
    /// P(m), m not negative.
    fn power(&mut self, m: usize, right_angle: &mut RightAngle) -> f64 {
        match self.powers.get(m) {
            None => 0.0,
            Some(power) if power.is_nan() => {
                let sums = right_angle.sums(m / LANES, self.k, &self.squares);
                for (power, sum) in self.powers.iter_mut().skip(m - m % LANES).zip(sums) {
                    *power = sum;
                }
                self.powers.get(m).copied().unwrap_or(0.0)
            }
            Some(power) => *power,
        }
    }
}

/// Predicts surveys at given angles and window.
#[derive(Debug, Clone)]
pub struct Predictor {
    pub(super) alpha_rad: f64,
    pub(super) beta_rad: f64,
    pub(super) window: Window,
    /// `d^l_j0(beta)` by j, not negative.
    pub(super) spins: BTreeMap<i32, Vec<f64>>,
    pub(super) pairs: Vec<Pair>,
    pub(super) right_angle: RightAngle,
    /// Index of each pair, or that it is negligible; k not negative.
    pub(super) index: BTreeMap<(i32, i32), Option<usize>>,
    /// Products of two pairs by m, over even and odd l.
    pub(super) products: BTreeMap<(i32, usize, usize), [f64; 2]>,
    /// Amplitudes by m and pair.
    pub(super) rows: BTreeMap<(i32, usize), Vec<f64>>,
}

/// Index of the smooth pair.
pub(super) const SMOOTH: usize = 0;

impl Predictor {
    /// No pairs known yet but the smooth one.
    #[must_use]
    pub fn new(alpha_rad: f64, beta_rad: f64, window: Window) -> Self {
        let mut predictor = Self {
            alpha_rad,
            beta_rad,
            window,
            spins: BTreeMap::new(),
            pairs: Vec::new(),
            right_angle: RightAngle::default(),
            index: BTreeMap::new(),
            products: BTreeMap::new(),
            rows: BTreeMap::new(),
        };
        let smooth = predictor.make_pair(0, 0);
        predictor.pairs.push(smooth);
        predictor.index.insert((0, 0), Some(SMOOTH));
        predictor
    }

    /// The window.
    #[must_use]
    pub const fn window(&self) -> &Window {
        &self.window
    }

    /// Largest degree as a signed number.
    pub(super) fn l_max(&self) -> i32 {
        i32::try_from(self.window.l_max().min(MAX_L)).unwrap_or(0)
    }

    /// `sqrt(2l + 1) w_l d_kj(alpha) d_j0(beta)`, k not negative.
    pub(super) fn make_pair(&mut self, k: i32, j: i32) -> Pair {
        let size = self.window.weights().len();
        let beta_rad = self.beta_rad;
        let spin = self
            .spins
            .entry(j.abs())
            .or_insert_with(|| wigner_d(j.abs(), 0, beta_rad, size.saturating_sub(1)));
        // d_(-j)0 = (-1)^j d_j0
        let sign = if j < 0 && j % 2 != 0 { -1.0 } else { 1.0 };
        let mut amplitudes = vec![0.0; size];
        fill_wigner_d(k, j, self.alpha_rad, &mut amplitudes);
        let mut l = 0.0_f64;
        for ((value, w), spin) in amplitudes.iter_mut().zip(self.window.weights()).zip(&*spin) {
            *value *= if l > 0.0 { sign * (2.0 * l + 1.0).sqrt() * w * spin } else { 0.0 };
            l += 1.0;
        }
        let squares: Vec<f64> = amplitudes.iter().map(|a| a * a).collect();
        let ceiling = squares.iter().sum();
        Pair { k, j, amplitudes, squares, ceiling, powers: vec![f64::NAN; size] }
    }

    /// The pair of (k, j), k not negative; `None` where it is negligible at any m.
    pub(super) fn pair(&mut self, k: i32, j: i32) -> Option<usize> {
        if let Some(&known) = self.index.get(&(k, j)) {
            return known;
        }
        let pair = self.make_pair(k, j);
        let at = (pair.ceiling >= NEGLIGIBLE_PAIR).then_some(self.pairs.len());
        if at.is_some() {
            self.pairs.push(pair);
        }
        self.index.insert((k, j), at);
        at
    }

    /// Pairs, one of each (k, j) and (-k, -j), with `|m*|` below `limit` anywhere between the least
    /// and the largest of `standing`.
    pub(super) fn pairs_standing(
        &mut self,
        motion: &Motion,
        limit: f64,
        spread: impl Fn(i32, i32) -> f64,
    ) -> Vec<usize> {
        let l_max = self.l_max();
        let mut found = Vec::new();
        // m* per turn of precession.
        let slope = motion.standing(1, 0);
        for j in -l_max..=l_max {
            let at_zero = motion.standing(0, j);
            // |at_zero + slope k| <= limit + spread, k >= 0
            let reach = limit + spread(l_max, j);
            let bounds = [(-reach - at_zero) / slope, (reach - at_zero) / slope];
            let low = bounds[0].min(bounds[1]).ceil().max(0.0);
            let high = bounds[0].max(bounds[1]).floor().min(f64::from(l_max));
            if low > high || (low - high).is_nan() {
                continue;
            }
            #[expect(clippy::cast_possible_truncation, reason = "within 0 to l_max")]
            let (low, high) = (low as i32, high as i32);
            for k in low..=high {
                if (k == 0 && j <= 0)
                    || motion.standing(k, j).abs() > limit + spread(k, j)
                    || !visible(self.alpha_rad, self.beta_rad, [k, j, l_max])
                {
                    continue;
                }
                found.extend(self.pair(k, j));
            }
        }
        found
    }

    /// How many pairs of frequencies stand so close to each other that they interfere, counted to
    /// `most`.
    pub(super) fn meetings(&self, motion: &Motion, width: f64, most: usize) -> usize {
        let l_max = self.l_max();
        let limit = f64::from(l_max) + width;
        let slope = motion.standing(1, 0);
        let mut standing = Vec::new();
        for j in -l_max..=l_max {
            let at_zero = motion.standing(0, j);
            let ends = [(-limit - at_zero) / slope, (limit - at_zero) / slope];
            let low = ends[0].min(ends[1]).ceil().max(0.0);
            let high = ends[0].max(ends[1]).floor().min(f64::from(l_max));
            if low > high || (low - high).is_nan() {
                continue;
            }
            #[expect(clippy::cast_possible_truncation, reason = "within 0 to l_max")]
            let (low, high) = (low as i32, high as i32);
            let seen = |k: &i32| visible(self.alpha_rad, self.beta_rad, [*k, j, l_max]);
            standing.extend((low..=high).filter(seen).map(|k| motion.standing(k, j)));
        }
        standing.sort_by(f64::total_cmp);
        let (mut first, mut found) = (0, 0_usize);
        for (index, at) in standing.iter().enumerate() {
            while standing[first] < at - width {
                first += 1;
            }
            found = found.saturating_add(index - first);
            if found > most {
                break;
            }
        }
        found
    }

    /// P(|m|) of a pair.
    pub(super) fn pair_power(&mut self, pair: usize, m: i32) -> f64 {
        self.pairs[pair].power(m.unsigned_abs() as usize, &mut self.right_angle)
    }

    /// `sum_l` of the product of two pairs' amplitudes at m, over even and over odd l.
    pub(super) fn products(&mut self, m: i32, a: usize, b: usize) -> [f64; 2] {
        let key = (m, a.min(b), a.max(b));
        if let Some(&known) = self.products.get(&key) {
            return known;
        }
        if self.rows.len() > MOST_ROWS {
            self.rows.clear();
        }
        for pair in [a, b] {
            if !self.rows.contains_key(&(m, pair)) {
                let Pair { k, amplitudes, .. } = &self.pairs[pair];
                let orders = [m, *k].map(|it| it.unsigned_abs() as usize);
                let row = self.right_angle.row(orders, amplitudes);
                self.rows.insert((m, pair), row);
            }
        }
        let row = |pair| self.rows.get(&(m, pair)).map_or(&[][..], Vec::as_slice);
        let parts = Arch::new().dispatch(Parities { a: row(a), b: row(b) });
        self.products.insert(key, parts);
        parts
    }
}

/// The sums of products over even and over odd places.
struct Parities<'r> {
    a: &'r [f64],
    b: &'r [f64],
}

impl NullaryFnOnce for Parities<'_> {
    type Output = [f64; 2];

    /// Sums in the same order on every instruction set.
    #[expect(clippy::inline_always, reason = "compiled for each instruction set")]
    #[inline(always)]
    fn call(self) -> [f64; 2] {
        let (whole, rest) = self.a.as_chunks::<16>();
        let (other, other_rest) = self.b.as_chunks::<16>();
        let mut sums = [0.0; 16];
        for (a, b) in whole.iter().zip(other) {
            for i in 0..16 {
                sums[i] += a[i] * b[i];
            }
        }
        for (sum, (a, b)) in sums.iter_mut().zip(rest.iter().zip(other_rest)) {
            *sum += a * b;
        }
        [0, 1].map(|odd| sums.iter().skip(odd).step_by(2).sum())
    }
}

/// Whether degrees to `l_max` see a pair: beyond the turning points of all three functions, with
/// room for what leaks below them.
pub(super) fn visible(alpha_rad: f64, beta_rad: f64, [k, j, l_max]: [i32; 3]) -> bool {
    let (k, j, l) = (f64::from(k), f64::from(j), f64::from(l_max));
    let turning = (k * k + j * j - 2.0 * k * j * alpha_rad.cos()).max(0.0).sqrt();
    // Below its turning point a function falls over a range of about l^(1/3).
    let room = 1.0 + 12.0 / l.powf(2.0 / 3.0).max(1.0);
    turning <= room * l * alpha_rad.sin() + 8.0 && j.abs() <= room * l * beta_rad.sin() + 8.0
}

/// The greatest common divisor, not negative.
pub(super) fn gcd(a: i32, b: i32) -> i32 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}
