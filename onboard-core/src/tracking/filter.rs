//! How do the errors of five numbers grow with time, and shrink with a measured one.
//!
//! [`ErrorCovariance`] belongs to the errors (true minus modelled) of precession phase, alpha, spin
//! phase (rad), precession rate and spin rate (rad/s), in this order.
//!
//! Method: between measurements each phase error grows by its rate error times the time; angles and
//! rates may walk at random besides. One measured number `h . error + noise` is taken in by Kalman's
//! gain; the covariance follows in Joseph's form `(I - k h') P (I - k h')' + r k k'`, which stays
//! positive where the measurement is far better than what was known.
//!
//! Limits: a variance below 1e-16 of the largest is lost in rounding; the legal settings and noises
//! keep the first update within 1 % of its variance (the test below) and all others far closer.
//! `tests/tests/tracking.rs` holds estimates and covariances to a batch of least squares.

use crate::convert::uncounted;
use crate::uncertainty::ScanCovariance;

/// Precession phase, alpha, spin phase, precession rate, spin rate.
pub(super) type Errors = [f64; 5];

/// Standard deviations of random walks after one second.
#[derive(Debug, Clone, Copy)]
pub(super) struct Walks {
    /// Precession phase, alpha, spin phase in rad/s^(1/2).
    pub(super) angles: [f64; 3],
    /// Precession and spin rate in rad/s^(3/2).
    pub(super) rates: [f64; 2],
}

/// A symmetric covariance of [`Errors`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ErrorCovariance {
    rows: [Errors; 5],
}

impl ErrorCovariance {
    /// Independent errors.
    pub(super) fn diagonal([a, alpha, b, a_rate, b_rate]: Errors) -> Self {
        Self {
            rows: [
                [a, 0.0, 0.0, 0.0, 0.0],
                [0.0, alpha, 0.0, 0.0, 0.0],
                [0.0, 0.0, b, 0.0, 0.0],
                [0.0, 0.0, 0.0, a_rate, 0.0],
                [0.0, 0.0, 0.0, 0.0, b_rate],
            ],
        }
    }

    /// The upper half, row by row.
    pub(super) const fn upper(&self) -> [f64; 15] {
        let [[aa, ab, ac, ad, ae], [_, bb, bc, bd, be], [.., cc, cd, ce], [.., dd, de], [.., ee]] =
            self.rows;
        [aa, ab, ac, ad, ae, bb, bc, bd, be, cc, cd, ce, dd, de, ee]
    }

    /// The symmetric covariance of an upper half.
    pub(super) const fn of_upper(upper: [f64; 15]) -> Self {
        let [aa, ab, ac, ad, ae, bb, bc, bd, be, cc, cd, ce, dd, de, ee] = upper;
        let rows = [
            [aa, ab, ac, ad, ae],
            [ab, bb, bc, bd, be],
            [ac, bc, cc, cd, ce],
            [ad, bd, cd, dd, de],
            [ae, be, ce, de, ee],
        ];
        Self { rows }
    }

    /// The part that belongs to the angles.
    pub(super) const fn angles(&self) -> ScanCovariance {
        let [[aa, aalpha, ab, ..], [_, alphaalpha, alphab, ..], [_, _, bb, ..], ..] = self.rows;
        ScanCovariance { variances: [aa, alphaalpha, bb], covariances: [aalpha, ab, alphab] }
    }

    /// Variances of precession and spin rate.
    pub(super) const fn rate_variances(&self) -> [f64; 2] {
        let [.., [_, _, _, precession, _], [_, _, _, _, spin]] = self.rows;
        [precession, spin]
    }

    /// Finite, symmetric, no negative variance, no correlation beyond one.
    #[inline(never)]
    pub(super) fn is_legal(&self) -> bool {
        all_cells().all(|(i, j)| self.is_legal_at(i, j))
    }

    #[inline(never)]
    fn is_legal_at(&self, i: usize, j: usize) -> bool {
        let (here, own, other) = (self.cell(i, j), self.cell(i, i), self.cell(j, j));
        let most = libm::sqrt(own) * libm::sqrt(other);
        here.is_finite()
            && own >= 0.0
            && here.to_bits() == self.cell(j, i).to_bits()
            && libm::fabs(here) <= most * (1.0 + 1e-9)
    }

    /// `seconds` later: `F P F' + Q`.
    #[inline(never)]
    pub(super) fn propagate(&mut self, seconds: f64, walks: &Walks) {
        let [precession, _, spin, precession_rate, spin_rate] = &mut self.rows;
        add(precession, seconds, precession_rate);
        add(spin, seconds, spin_rate);
        for row in self.rows.iter_mut().take(uncounted(5)) {
            let [precession, _, spin, precession_rate, spin_rate] = row;
            *precession += seconds * *precession_rate;
            *spin += seconds * *spin_rate;
        }
        self.walk(seconds, walks);
        self.symmetrise();
    }

    /// Adds what the walks gather: q t to what walks; q t^2/2 and q t^3/3 from a rate to its phase.
    fn walk(&mut self, seconds: f64, walks: &Walks) {
        let time = libm::fabs(seconds);
        let [a, alpha, b] = walks.angles.map(|walk| walk * walk * time);
        let [a_rate, b_rate] = walks.rates.map(|walk| walk * walk * time);
        let half = 0.5 * seconds;
        let third = time * time / 3.0;
        let [
            [aa, _, _, ad, _],
            [_, bb, ..],
            [_, _, cc, _, ce],
            [da, _, _, dd, _],
            [_, _, ec, _, ee],
        ] = &mut self.rows;
        *aa += a + a_rate * third;
        *bb += alpha;
        *cc += b + b_rate * third;
        for cell in [ad, da] {
            *cell += a_rate * half;
        }
        for cell in [ce, ec] {
            *cell += b_rate * half;
        }
        *dd += a_rate;
        *ee += b_rate;
    }

    /// Takes in `value = h . errors + noise`: improves the estimated errors and the covariance.
    ///
    /// Answers the squared surprise over its variance, a chi^2 of one degree of freedom.
    #[inline(never)]
    pub(super) fn observe(
        &mut self,
        estimate: &mut Errors,
        h: &Errors,
        value: f64,
        variance: f64,
    ) -> f64 {
        let along = self.times(h);
        let spread = dot(h, &along) + variance;
        let gain = along.map(|p| p / spread);
        let surprise = value - dot(h, estimate);
        add(estimate, surprise, &gain);
        // (I - k h') P, then that times (I - h k'), and the noise.
        self.add_outer(-1.0, &gain, &along);
        let left = self.times(h);
        self.add_outer(-1.0, &left, &gain);
        self.add_outer(variance, &gain, &gain);
        self.symmetrise();
        surprise * surprise / spread
    }

    #[inline(never)]
    fn times(&self, h: &Errors) -> Errors {
        let [a, alpha, b, a_rate, b_rate] = &self.rows;
        [dot(a, h), dot(alpha, h), dot(b, h), dot(a_rate, h), dot(b_rate, h)]
    }

    #[inline(never)]
    fn add_outer(&mut self, factor: f64, column: &Errors, line: &Errors) {
        for (row, value) in self.rows.iter_mut().zip(column) {
            add(row, factor * value, line);
        }
    }

    #[inline(never)]
    fn symmetrise(&mut self) {
        for (i, j) in all_cells().filter(|(i, j)| i < j) {
            let mean = 0.5 * (self.cell(i, j) + self.cell(j, i));
            self.set(i, j, mean);
            self.set(j, i, mean);
        }
    }

    fn set(&mut self, i: usize, j: usize, value: f64) {
        if let Some(cell) = self.rows.get_mut(i).and_then(|row| row.get_mut(j)) {
            *cell = value;
        }
    }

    fn cell(&self, i: usize, j: usize) -> f64 {
        self.rows.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0)
    }
}

/// Row and column of every number, row by row.
fn all_cells() -> impl Iterator<Item = (usize, usize)> {
    (0..uncounted(5)).flat_map(|i| (0..uncounted(5)).map(move |j| (i, j)))
}

#[inline(never)]
fn dot(a: &Errors, b: &Errors) -> f64 {
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

#[inline(never)]
fn add(to: &mut Errors, factor: f64, other: &Errors) {
    for (to, other) in to.iter_mut().zip(other) {
        *to += factor * other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NO_WALKS: Walks = Walks { angles: [0.0; 3], rates: [0.0; 2] };

    fn close(p: &ErrorCovariance, variances: [f64; 3]) -> bool {
        p.angles().variances.iter().zip(variances).all(|(a, b)| (a - b).abs() < 1e-14)
    }

    #[test]
    fn a_rate_error_grows_into_the_phase() {
        let mut p = ErrorCovariance::diagonal([1.0, 2.0, 3.0, 0.01, 0.04]);
        p.propagate(10.0, &NO_WALKS);
        assert!(close(&p, [2.0, 2.0, 7.0]));
        assert!((p.cell(0, 3) - 0.1).abs() < 1e-16 && (p.cell(4, 2) - 0.4).abs() < 1e-16);
        let mut p = ErrorCovariance::diagonal([0.0; 5]);
        p.propagate(3.0, &Walks { angles: [0.0, 0.5, 0.0], rates: [2.0, 0.0] });
        // q t^3/3 = 4 * 9, q t = 0.25 * 3.
        assert!(close(&p, [36.0, 0.75, 0.0]));
    }

    #[test]
    fn a_far_better_measurement_leaves_a_legal_covariance() {
        let mut p = ErrorCovariance::diagonal([0.25, 0.01, 0.25, 1e-10, 1e-10]);
        let mut estimate = [0.0; 5];
        for h in [[1.0, 0.0, 1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0], [1.0, 0.0, -1.0, 0.0, 0.0]]
        {
            p.observe(&mut estimate, &h, 1e-3, 1e-14);
        }
        assert!(p.is_legal(), "{p:?}");
        // Sum and difference known to 1e-7: each phase to 1e-7 / sqrt 2.
        let [a, alpha, b] = p.angles().variances;
        assert!((a / 5e-15 - 1.0).abs() < 0.01, "{a:e}");
        assert!((b / 5e-15 - 1.0).abs() < 0.01, "{b:e}");
        assert!((alpha / 1e-14 - 1.0).abs() < 1e-6, "{alpha:e}");
    }

    #[test]
    fn the_upper_half_is_all_of_it() {
        let mut p = ErrorCovariance::diagonal([1.0, 2.0, 3.0, 0.01, 0.04]);
        p.propagate(10.0, &NO_WALKS);
        p.observe(&mut [0.0; 5], &[1.0, 0.5, 1.0, 0.25, 0.0], 0.0, 1.0);
        assert_eq!(ErrorCovariance::of_upper(p.upper()), p);
        let numbers = core::array::from_fn(|i| f64::from(u8::try_from(i).unwrap()));
        let back = ErrorCovariance::of_upper(numbers).upper();
        assert_eq!(back.map(f64::to_bits), numbers.map(f64::to_bits));
    }

    #[test]
    fn damage_is_seen() {
        let good = ErrorCovariance::diagonal([1.0; 5]);
        let with = |i: usize, j: usize, value: f64| {
            let mut bad = good;
            bad.rows[i][j] = value;
            bad.is_legal()
        };
        assert!(good.is_legal());
        assert!(!with(0, 0, -1.0) && !with(0, 1, 0.5) && !with(3, 3, f64::NAN));
        let mut beyond = good;
        (beyond.rows[0][2], beyond.rows[2][0]) = (1.5, 1.5);
        assert!(!beyond.is_legal());
    }

    proptest! {
        #[test]
        fn two_steps_are_one(first in 0.0..1e4_f64, second in 0.0..1e4_f64) {
            let walks = Walks { angles: [1e-3, 2e-3, 3e-3], rates: [1e-6, 2e-6] };
            let start = ErrorCovariance::diagonal([1e-4, 1e-5, 1e-4, 1e-10, 1e-12]);
            let (mut stepped, mut whole) = (start, start);
            stepped.propagate(first, &walks);
            stepped.propagate(second, &walks);
            whole.propagate(first + second, &walks);
            for (a, b) in stepped.rows.iter().flatten().zip(whole.rows.iter().flatten()) {
                prop_assert!((a - b).abs() <= 1e-13 * b.abs(), "{a:e} {b:e}");
            }
        }
    }

    #[test]
    fn correlations_and_variances_have_their_ends() {
        let with = |variances: [f64; 2], covariance: f64| {
            let mut p = ErrorCovariance::diagonal([variances[0], variances[1], 1.0, 1.0, 1.0]);
            (p.rows[0][1], p.rows[1][0]) = (covariance, covariance);
            p.is_legal()
        };
        assert!(with([4.0, 9.0], 5.99) && with([4.0, 9.0], -6.0) && with([0.0, 9.0], 0.0));
        assert!(!with([4.0, 9.0], 6.01) && !with([4.0, 9.0], -6.01) && !with([0.0, 9.0], 0.1));
        assert!(with([4.0, 9.0], 6.0 * (1.0 + 0.9e-9)) && !with([4.0, 9.0], 6.0 * (1.0 + 1.1e-9)));
        assert!(!with([f64::INFINITY, 9.0], 0.0) && !with([-4.0, -9.0], 0.0));
    }
}
