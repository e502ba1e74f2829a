//! How much of one rotation's harmonic is in another: Wigner small d functions along l.
//!
//! Convention: `d^1_10(beta) = -sin(beta) / sqrt 2`, so that `d^l_m0(beta)` is, times
//! `sqrt((2l + 1) / 4 pi)`, the theta part of `Y_lm` with the Condon-Shortley phase, and
//! `D^l_mn(a, b, c) = exp(-i m a) d^l_mn(b) exp(-i n c)`.
//!
//! Method: the three-term recurrence in l \[Varshalovich1988, chapter 4\], upwards from
//! `l_0 = max(|m|, |n|)`. With `S_l = sqrt((l^2 - m^2)(l^2 - n^2)) / l`,
//!
//! `S_(l+1) d^(l+1) = (2l + 1) [cos beta - m n / (l (l + 1))] d^l - S_l d^(l-1)`.
//!
//! Upwards the wanted solution grows until it oscillates, so errors do not. Its first value is
//! closed, `sqrt(C(2l, l + n)) cos^(l+n)(beta/2) sin^(l-n)(beta/2)`, and may be 1e-600: values carry
//! a number of halvings by 2^512 until they are of a size that f64 holds.
//!
//! Limits: relative error below 1e-11 where |d| exceeds 1e-6, l to [`MAX_L`] (test
//! `meets_values_of_high_precision`).

use pulp::{Arch, NullaryFnOnce};
use std::f64::consts::{FRAC_PI_2, LN_2};

/// Largest l.
pub const MAX_L: usize = 2048;

/// Binary logarithm of one unit of scale.
const UNIT_LOG2: f64 = 512.0;
/// `2^-512`.
pub(crate) const UNIT: f64 = f64::from_bits((1023 - 512) << 52);
/// `2^256`: a scaled value beyond it is taken one unit down.
pub(crate) const LARGE: f64 = f64::from_bits((1023 + 256) << 52);

/// A value `x 2^(-512 units)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scaled {
    pub(crate) x: f64,
    pub(crate) units: u32,
}

impl Scaled {
    const ZERO: Self = Self { x: 0.0, units: 0 };

    pub(crate) fn of_log2(log2: f64, negative: bool) -> Self {
        let units = (-log2 / UNIT_LOG2).floor().max(0.0);
        let x = (log2 + units * UNIT_LOG2).exp2();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 100")]
        let units = units as u32;
        Self { x: if negative { -x } else { x }, units }
    }
}

/// `log2(n!)`.
pub(crate) fn log2_factorial(n: i32) -> f64 {
    if n < 20 {
        return (2..=n).map(f64::from).product::<f64>().log2();
    }
    // Stirling's series about n + 1; the first term left out is below 1e-17.
    let x = f64::from(n) + 1.0;
    let r = 1.0 / (x * x);
    let tail = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r * (1.0 / 1680.0)))) / x;
    ((x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + tail) / LN_2
}

/// `d^l_mn(beta)` at its lowest degree, `l = max(|m|, |n|)`.
pub(crate) fn first_value(m: i32, n: i32, beta_rad: f64) -> Scaled {
    let l = m.abs().max(n.abs());
    // Which of the four corners, the power of the cosine less l, and whether odd powers change sign.
    let (other, alternates) = if m == l {
        (n, true)
    } else if n == l {
        (m, false)
    } else if m == -l {
        (-n, false)
    } else {
        (-m, true)
    };
    let (sin, cos) = (beta_rad / 2.0).sin_cos();
    let power = |base: f64, exponent: i32| match exponent {
        0 => 0.0,
        _ => f64::from(exponent) * base.abs().log2(),
    };
    let choose = log2_factorial(2 * l) - log2_factorial(l + other) - log2_factorial(l - other);
    let log2 = 0.5 * choose + power(cos, l + other) + power(sin, l - other);
    if log2 == f64::NEG_INFINITY {
        return Scaled::ZERO;
    }
    Scaled::of_log2(log2, alternates && (l - other) % 2 != 0)
}

/// `d^l_mn(beta)` for l from 0 to `l_max`, zero below `max(|m|, |n|)`.
#[must_use]
pub fn wigner_d(m: i32, n: i32, beta_rad: f64, l_max: usize) -> Vec<f64> {
    let mut row = vec![0.0; l_max + 1];
    fill_wigner_d(m, n, beta_rad, &mut row);
    row
}

/// [`wigner_d`] into a row that starts at l = 0.
pub(crate) fn fill_wigner_d(m: i32, n: i32, beta_rad: f64, row: &mut [f64]) {
    row.fill(0.0);
    let start = m.abs().max(n.abs());
    let first = usize::try_from(start).unwrap_or(usize::MAX);
    if first >= row.len() {
        return;
    }
    let mut now = first_value(m, n, beta_rad);
    let mut before = 0.0;
    let cos = beta_rad.cos();
    let (mm, nn) = (f64::from(m) * f64::from(m), f64::from(n) * f64::from(n));
    let product = f64::from(m) * f64::from(n);
    let mut l = f64::from(start);
    // S_l, zero at the first degree.
    let mut step_below = 0.0;
    for value in row.iter_mut().skip(first) {
        *value = (0..now.units).fold(now.x, |x, _| x * UNIT);
        let next = l + 1.0;
        let root = ((next * next - mm) * (next * next - nn)).sqrt();
        let (step, inverse) = (root / next, next / root);
        let coupling = if product == 0.0 { 0.0 } else { product / (l * next) };
        let above = ((2.0 * l + 1.0) * (cos - coupling) * now.x - step_below * before) * inverse;
        (before, now.x) = (now.x, above);
        if now.units > 0 && now.x.abs() > LARGE {
            before *= UNIT;
            now.x *= UNIT;
            now.units -= 1;
        }
        (l, step_below) = (next, step);
    }
}

/// Values of m that [`RightAngle`] takes at a time.
pub(crate) const LANES: usize = 16;

/// `1 / sqrt((l + 1)^2 - m^2)` for [`LANES`] consecutive m, by l; 0 where m exceeds l.
type InverseRoots = Vec<[f64; LANES]>;

/// Sums of squares of `d^l_mk(90 deg)` over l.
#[derive(Debug, Clone, Default)]
pub(crate) struct RightAngle {
    /// By the first m over [`LANES`], once known.
    roots: Vec<Option<InverseRoots>>,
}

impl RightAngle {
    /// `sum_l weights[l] d^l_mk(90 deg)^2` for [`LANES`] consecutive m from `LANES block`, those
    /// beyond the last l zero; k not negative.
    pub(crate) fn sums(&mut self, block: usize, k: i32, weights: &[f64]) -> [f64; LANES] {
        self.prepare(block, weights.len());
        let first_m = i32::try_from(LANES * block).unwrap_or(i32::MAX);
        let roots = self.roots[block].as_deref().unwrap_or(&[]);
        Arch::new().dispatch(Squares { first_m, k, weights, roots })
    }

    /// The inverse roots of a block to `size` degrees.
    fn prepare(&mut self, block: usize, size: usize) {
        if self.roots.len() <= block {
            self.roots.resize(block + 1, None);
        }
        let first_m = u32::try_from(LANES * block).map_or(f64::NAN, f64::from);
        let roots = self.roots[block].get_or_insert_with(|| Vec::with_capacity(size));
        while roots.len() < size {
            let next = u32::try_from(roots.len() + 1).map_or(f64::NAN, f64::from);
            roots.push(std::array::from_fn(|lane| {
                let m = first_m + f64::from(u8::try_from(lane).unwrap_or(0));
                if m < next { (next * next - m * m).sqrt().recip() } else { 0.0 }
            }));
        }
    }

    /// `weights[l] d^l_mk(90 deg)` from l = 0, m and k not negative.
    pub(crate) fn row(&mut self, [m, k]: [usize; 2], weights: &[f64]) -> Vec<f64> {
        let mut row = vec![0.0; weights.len()];
        let start = m.max(k);
        let (Ok(m_i), Ok(k_i)) = (i32::try_from(m), i32::try_from(k)) else { return row };
        self.prepare(m / LANES, weights.len());
        self.prepare(k / LANES, weights.len());
        let roots = |at: usize| self.roots[at / LANES].as_deref().unwrap_or(&[]);
        let mut now = first_value(m_i, k_i, FRAC_PI_2);
        let product = -f64::from(m_i) * f64::from(k_i);
        let squares = [m_i, k_i].map(|it| f64::from(it) * f64::from(it));
        // The value before times S_l.
        let mut below = 0.0;
        let mut l = f64::from(m_i.max(k_i));
        let inverses = roots(m).iter().zip(roots(k)).map(|(a, b)| (a[m % LANES], b[k % LANES]));
        let cells = row.iter_mut().zip(weights).zip(inverses).skip(start);
        for ((cell, weight), (inverse_m, inverse_k)) in cells {
            *cell = weight * (0..now.units).fold(now.x, |x, _| x * UNIT);
            let next = l + 1.0;
            let common = (2.0 * l + 1.0) / (l * next).max(1.0) * product;
            let inverse = inverse_m * inverse_k;
            let step = (next * next - squares[0]) * (next * next - squares[1]) * inverse / next;
            let above = (common * now.x - below) * (next * inverse);
            below = step * now.x;
            now.x = above;
            if now.units > 0 && now.x.abs() > LARGE {
                below *= UNIT;
                now.x *= UNIT;
                now.units -= 1;
            }
            l = next;
        }
        row
    }
}

struct Squares<'r> {
    first_m: i32,
    k: i32,
    weights: &'r [f64],
    roots: &'r [[f64; LANES]],
}

impl NullaryFnOnce for Squares<'_> {
    type Output = [f64; LANES];

    /// All operations on all lanes alike, so that results are the same on every instruction set.
    #[expect(clippy::inline_always, reason = "compiled for each instruction set")]
    #[inline(always)]
    fn call(self) -> [f64; LANES] {
        let Self { first_m, k, weights, roots } = self;
        let lane_m: [i32; LANES] =
            std::array::from_fn(|lane| first_m + i32::try_from(lane).unwrap_or(0));
        let mut lanes = Lanes::default();
        let starts = lane_m.map(|m| m.max(k));
        let (first, last) = (starts[0], starts[LANES - 1]);
        let mm = lane_m.map(|m| f64::from(m) * f64::from(m));
        let product = lane_m.map(|m| -f64::from(m) * f64::from(k));
        let kk = f64::from(k) * f64::from(k);
        let mut at = first;
        let mut rows = weights.iter().zip(roots).skip(usize::try_from(first).unwrap_or(usize::MAX));
        // Some lanes have not started, or are scaled.
        for (&weight, inverse) in rows.by_ref() {
            for lane in 0..LANES {
                if at == starts[lane] {
                    lanes.start(lane, first_value(lane_m[lane], k, FRAC_PI_2));
                }
            }
            lanes.weigh(weight);
            lanes.step(at, &mm, kk, &product, inverse);
            at += 1;
            if at > last && lanes.scaled == 0 {
                break;
            }
        }
        for (&weight, inverse) in rows {
            for lane in 0..LANES {
                lanes.sums[lane] += weight * (lanes.now[lane] * lanes.now[lane]);
            }
            lanes.step(at, &mm, kk, &product, inverse);
            at += 1;
        }
        lanes.sums
    }
}

#[derive(Default)]
struct Lanes {
    now: [f64; LANES],
    /// The value before times `S_l`.
    below: [f64; LANES],
    sums: [f64; LANES],
    units: [u32; LANES],
    /// Lanes whose units are not zero.
    scaled: u32,
}

impl Lanes {
    fn start(&mut self, lane: usize, value: Scaled) {
        (self.now[lane], self.units[lane]) = (value.x, value.units);
        self.below[lane] = 0.0;
        self.scaled += u32::from(value.units > 0);
    }

    #[expect(clippy::inline_always, reason = "compiled for each instruction set")]
    #[inline(always)]
    fn weigh(&mut self, weight: f64) {
        for lane in 0..LANES {
            if self.units[lane] > 0 && self.now[lane].abs() > LARGE {
                self.now[lane] *= UNIT;
                self.below[lane] *= UNIT;
                self.units[lane] -= 1;
                self.scaled -= u32::from(self.units[lane] == 0);
            }
            if self.units[lane] == 0 {
                self.sums[lane] += weight * (self.now[lane] * self.now[lane]);
            }
        }
    }

    /// From l to l + 1. Lanes that have not started hold zeros.
    #[expect(clippy::inline_always, reason = "compiled for each instruction set")]
    #[inline(always)]
    fn step(
        &mut self,
        l: i32,
        mm: &[f64; LANES],
        kk: f64,
        product: &[f64; LANES],
        inverse: &[f64; LANES],
    ) {
        let l = f64::from(l);
        let next = l + 1.0;
        let common = (2.0 * l + 1.0) / (l * next).max(1.0);
        let squares = next * next;
        let root_k = (squares - kk).sqrt();
        let (up, down) = (next / root_k, root_k / next);
        for lane in 0..LANES {
            let now = self.now[lane];
            let above = (common * product[lane] * now - self.below[lane]) * (up * inverse[lane]);
            // S_(l+1) = sqrt((l+1)^2 - m^2) sqrt((l+1)^2 - k^2) / (l+1)
            self.below[lane] = (squares - mm[lane]) * inverse[lane] * down * now;
            self.now[lane] = above;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(l: usize, m: i32, n: i32, deg: f64) -> f64 {
        wigner_d(m, n, deg.to_radians(), l)[l]
    }

    /// Sums over factorials in 1,200 decimal digits.
    const VALUES: [(usize, i32, i32, f64, f64); 12] = [
        (1, 1, 0, 30.0, -3.535_533_905_932_7e-1),
        (2, 1, -1, 45.0, 3.535_533_905_932_7e-1),
        (10, 3, -7, 45.0, 5.037_638_024_414_9e-2),
        (60, 48, -5, 45.0, -3.395_237_508_757_9e-4),
        (200, 125, -13, 45.0, 4.034_306_000_013_4e-2),
        (700, 500, -50, 45.0, 6.651_758_519_555_5e-9),
        (700, -500, 50, 135.0, -6.082_834_324_737_3e-2),
        (900, 40, 500, 90.0, -1.974_138_256_606_2e-4),
        (800, 700, 3, 90.0, -2.077_620_098_422_3e-3),
        (1000, 13, 0, 50.0, 2.387_977_126_572_6e-2),
        (500, 0, 0, 7.5, -3.155_350_990_750_4e-2),
        (2048, 1000, -100, 45.0, 4.506_765_414_052_5e-3),
    ];

    #[test]
    fn meets_values_of_high_precision() {
        for (l, m, n, deg, expected) in VALUES {
            let found = at(l, m, n, deg);
            let off = (found / expected - 1.0).abs();
            assert!(off < 1e-11, "{l} {m} {n} {deg}: {found:e} {expected:e} {off:e}");
        }
    }

    #[test]
    fn low_degrees_are_closed() {
        for deg in [0.0, 20.0, 90.0, 133.0, 180.0] {
            let (s, c) = f64::to_radians(deg).sin_cos();
            let root = 0.5_f64.sqrt();
            for (m, n, expected) in [
                (0, 0, c),
                (1, 0, -s * root),
                (0, 1, s * root),
                (-1, 0, s * root),
                (0, -1, -s * root),
                (1, 1, f64::midpoint(1.0, c)),
                (1, -1, f64::midpoint(1.0, -c)),
                (-1, -1, f64::midpoint(1.0, c)),
            ] {
                assert!((at(1, m, n, deg) - expected).abs() < 1e-15, "{m} {n} {deg}");
            }
            assert!((at(2, 0, 0, deg) - (1.5 * c * c - 0.5)).abs() < 1e-15);
        }
    }

    #[test]
    fn rows_are_complete_and_symmetric() {
        for (l, n, deg) in [(40, 3, 45.0), (300, -120, 50.0), (700, 500, 45.0), (2048, 1000, 77.0)]
        {
            let size = i32::try_from(l).unwrap();
            let sum: f64 = (-size..=size).map(|m| at(l, m, n, deg).powi(2)).sum();
            assert!((sum - 1.0).abs() < 1e-10, "{l} {n}: {}", sum - 1.0);
            for m in [0, 7, -33, size / 2, -size] {
                let value = at(l, m, n, deg);
                let sign = if (m - n) % 2 == 0 { 1.0 } else { -1.0 };
                let close = |other: f64| (value - other).abs() < 1e-11;
                assert!(close(sign * at(l, n, m, deg)) && close(at(l, -n, -m, deg)));
                let turned = if (size + m) % 2 == 0 { 1.0 } else { -1.0 };
                assert!(close(turned * at(l, m, -n, 180.0 - deg)));
            }
        }
    }

    #[test]
    fn lanes_sum_the_squares_of_rows() {
        for (block, k, l_max) in [(0, 0, 90), (0, 48, 300), (3, 48, 300), (75, 1100, 2048)] {
            let weights: Vec<f64> = (0_u32..=l_max).map(|l| 1.0 / (1.0 + f64::from(l))).collect();
            let mut right_angle = RightAngle::default();
            let sums = right_angle.sums(block, k, &weights);
            let first = i32::try_from(block * LANES).unwrap();
            for (m, sum) in (first..).zip(sums) {
                let row = wigner_d(m, k, FRAC_PI_2, l_max as usize);
                let quick =
                    right_angle.row([m, k].map(|it| usize::try_from(it).unwrap()), &weights);
                for ((d, w), weighed) in row.iter().zip(&weights).zip(quick) {
                    assert!((d * w - weighed).abs() < 1e-12, "{m} {k}");
                }
                let expected: f64 = row.iter().zip(&weights).map(|(d, w)| w * d * d).sum();
                assert!((sum - expected).abs() < 1e-12, "{m} {k}: {sum:e} {expected:e}");
            }
        }
    }
}
