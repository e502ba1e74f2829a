//! Sums of Wigner functions on circles of latitude, and along them.
//!
//! For one m, not negative, and one spin n: `sum_l c_l w_l d^l_mn(theta)` on all [`Rings`], for
//! several `c_l` at once; then, ring by ring, `sum_m c_m exp(i m phi)` at equal steps of phi from zero.
//!
//! Method: the recurrence of [`crate::harmonics`] for several rings side by side, compiled for the
//! instruction set that is there; values that f64 does not hold carry a scale and count once they
//! are above 1e-77. The rings lie in equal steps of theta and mirror each other, since
//! `d^l_(-m)n(theta) = (-1)^(l + n) d^l_mn(pi - theta)`: a sum for -m on a ring is one for m on its
//! mirror. Along the rings a fast Fourier transform of a power of two, decimating in time
//! \[Cooley1965\].
//!
//! Limits: rings far beyond the turning point of the last degree are taken for zero.

use super::local_window::fill;
use super::window::Window;
use crate::harmonics::wigner::{LARGE, Scaled, UNIT, log2_factorial};
use pulp::Arch;
use std::f64::consts::{PI, TAU};

/// Rings side by side.
const LANES: usize = 8;
/// Coefficients at each degree.
pub(super) const COLUMNS: usize = 4;
/// Coefficients, or sums, of one degree or ring.
pub(super) type Columns = [f64; COLUMNS];

/// Circles of latitude in equal steps of theta, from north to south.
#[derive(Debug, Clone)]
pub(super) struct Rings {
    rings: Vec<Ring>,
}

#[derive(Debug, Clone, Copy)]
struct Ring {
    cos: f64,
    sin: f64,
    /// Binary logarithms of the cosine and sine of theta / 2.
    log2_half: [f64; 2],
    /// Of the sphere.
    share: f64,
}

impl Rings {
    /// At least `count`, rounded up to whole blocks.
    pub(super) fn new(count: usize) -> Self {
        let count = count.max(1).next_multiple_of(LANES);
        let step = PI / to_f64(count);
        let ring = |i: usize| {
            let theta = step * (to_f64(i) + 0.5);
            let (sin_half, cos_half) = (0.5 * theta).sin_cos();
            let edges = [step * to_f64(i), step * to_f64(i + 1)].map(f64::cos);
            Ring {
                cos: theta.cos(),
                sin: theta.sin(),
                log2_half: [cos_half.log2(), sin_half.log2()],
                share: 0.5 * (edges[0] - edges[1]),
            }
        };
        Self { rings: (0..count).map(ring).collect() }
    }

    /// How many.
    pub(super) fn count(&self) -> usize {
        self.rings.len()
    }

    /// Each ring's share of the sphere.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> + '_ {
        self.rings.iter().map(|ring| ring.share)
    }

    /// `sum_l spectra[l] w_l d^l_mn(theta)` on each ring, for spins n and their spectra; neither m
    /// nor n is negative, w are the window's weights on that ring.
    pub(super) fn sums(
        &self,
        window: &Window,
        m: i32,
        spins: &[i32],
        spectra: &[Vec<Columns>],
    ) -> Vec<Vec<Columns>> {
        let size = window.weights().len();
        let recurrences: Vec<(usize, Vec<Step>, First)> = spins
            .iter()
            .map(|&n| {
                let start = usize::try_from(m.max(n)).unwrap_or(usize::MAX).min(size);
                (start, steps(m, n, size - start), First::new(m, n))
            })
            .collect();
        let arch = Arch::new();
        let mut weights = vec![[0.0; LANES]; size];
        let mut sums = vec![Vec::with_capacity(self.count()); spins.len()];
        for block in self.rings.as_chunks::<LANES>().0 {
            let mut known = false;
            for ((sums, recurrence), (&n, spectrum)) in
                sums.iter_mut().zip(&recurrences).zip(spins.iter().zip(spectra))
            {
                if !block.iter().any(|ring| ring.sees(m, n, window.l_max())) {
                    sums.extend([[0.0; COLUMNS]; LANES]);
                    continue;
                }
                if !known {
                    fill(window, m, &block.map(|ring| [ring.cos, ring.sin]), &mut weights);
                    known = true;
                }
                let (start, steps, first) = recurrence;
                let degrees = (
                    steps.as_slice(),
                    spectrum.get(*start..).unwrap_or_default(),
                    weights.get(*start..).unwrap_or_default(),
                );
                let first = block.map(|ring| first.on(&ring));
                let cos = block.map(|ring| ring.cos);
                let columns = arch.dispatch(|| block_sums(degrees, cos, first));
                sums.extend((0..LANES).map(|lane| columns.map(|column| column[lane])));
            }
        }
        sums
    }
}

impl Ring {
    /// Whether `d^l_mn` at the last degree is past its turning point, with room for what leaks.
    fn sees(&self, m: i32, n: i32, l: usize) -> bool {
        let (m, n, l) = (f64::from(m), f64::from(n), to_f64(l));
        let turning = (m * m + n * n - 2.0 * m * n * self.cos).max(0.0).sqrt();
        let room = 1.0 + 12.0 / l.powf(2.0 / 3.0).max(1.0);
        turning <= room * l * self.sin + 8.0
    }
}

/// `d^l_mn` at its lowest degree, `l = max(m, n)`, without the cosine and sine.
#[derive(Debug, Clone, Copy)]
struct First {
    log2: f64,
    /// Of the cosine and sine of theta / 2.
    exponents: [f64; 2],
    negative: bool,
}

impl First {
    fn new(m: i32, n: i32) -> Self {
        let (l, other) = (m.max(n), m.min(n));
        let choose = log2_factorial(2 * l) - log2_factorial(l + other) - log2_factorial(l - other);
        Self {
            log2: 0.5 * choose,
            exponents: [f64::from(l + other), f64::from(l - other)],
            negative: m == l && (l - other) % 2 != 0,
        }
    }

    fn on(&self, ring: &Ring) -> Scaled {
        let [cos, sin] = ring.log2_half;
        let log2 = self.log2 + self.exponents[0] * cos + self.exponents[1] * sin;
        Scaled::of_log2(log2, self.negative)
    }
}

/// Factors of one degree's step upwards: of the cosine, the constant, of the degree below.
type Step = [f64; 3];

/// The steps from `l = max(m, n)`.
fn steps(m: i32, n: i32, count: usize) -> Vec<Step> {
    let (mm, nn) = (f64::from(m).powi(2), f64::from(n).powi(2));
    let product = f64::from(m) * f64::from(n);
    let mut l = f64::from(m.max(n));
    let mut below = 0.0;
    let mut step = || {
        let next = l + 1.0;
        let size = ((next * next - mm) * (next * next - nn)).sqrt() / next;
        let slope = (2.0 * l + 1.0) / size;
        let coupling = if product == 0.0 { 0.0 } else { product / (l * next) };
        let step = [slope, slope * coupling, below / size];
        (l, below) = (next, size);
        step
    };
    (0..count).map(|_| step()).collect()
}

/// The sums of one block of rings.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
fn block_sums(
    (steps, coefficients, weights): (&[Step], &[Columns], &[[f64; LANES]]),
    cos: [f64; LANES],
    first: [Scaled; LANES],
) -> [[f64; LANES]; COLUMNS] {
    let mut now = first.map(|it| it.x);
    let mut units = first.map(|it| it.units);
    let mut before = [0.0; LANES];
    let mut sums = [[0.0; LANES]; COLUMNS];
    let mut degrees = steps.iter().zip(coefficients).zip(weights);
    while units != [0; LANES] {
        let Some(((step, columns), weights)) = degrees.next() else { return sums };
        for lane in 0..LANES {
            if units[lane] == 0 {
                let value = weights[lane] * now[lane];
                for (sum, column) in sums.iter_mut().zip(columns) {
                    sum[lane] += column * value;
                }
            }
            let above = (step[0] * cos[lane] - step[1]) * now[lane] - step[2] * before[lane];
            (before[lane], now[lane]) = (now[lane], above);
            if units[lane] > 0 && above.abs() > LARGE {
                before[lane] *= UNIT;
                now[lane] *= UNIT;
                units[lane] -= 1;
            }
        }
    }
    for ((step, columns), weights) in degrees {
        for lane in 0..LANES {
            let value = weights[lane] * now[lane];
            for column in 0..COLUMNS {
                sums[column][lane] += columns[column] * value;
            }
            let above = (step[0] * cos[lane] - step[1]) * now[lane] - step[2] * before[lane];
            before[lane] = now[lane];
            now[lane] = above;
        }
    }
    sums
}

/// A complex number.
pub(super) type Complex = [f64; 2];

/// `sum_m c_m exp(i m phi)` at as many phi as there are m; their number a power of two.
#[derive(Debug, Clone)]
pub(super) struct Longitudes {
    /// `exp(i phi)` of the first half of all phi.
    roots: Vec<Complex>,
}

impl Longitudes {
    /// At least `count`, rounded up to a power of two.
    pub(super) fn new(count: usize) -> Self {
        let count = count.max(2).next_power_of_two();
        let root = |i: usize| {
            let (sin, cos) = (TAU * to_f64(i) / to_f64(count)).sin_cos();
            [cos, sin]
        };
        Self { roots: (0..count / 2).map(root).collect() }
    }

    /// How many.
    pub(super) fn count(&self) -> usize {
        2 * self.roots.len()
    }

    /// Which of the coefficients m is.
    pub(super) fn bin(&self, m: i32) -> usize {
        let count = i32::try_from(self.count()).unwrap_or(i32::MAX);
        usize::try_from(m.rem_euclid(count)).unwrap_or(0)
    }

    /// Coefficients to values, in place; as many as [`Longitudes::count`].
    pub(super) fn transform(&self, values: &mut [Complex]) {
        let count = self.count();
        let shift = usize::BITS - count.trailing_zeros();
        for i in 0..count {
            let mirrored = i.reverse_bits() >> shift;
            if i < mirrored {
                values.swap(i, mirrored);
            }
        }
        let mut half = 1;
        while half < count {
            let stride = count / (2 * half);
            for group in values.chunks_exact_mut(2 * half) {
                let (low, high) = group.split_at_mut(half);
                let roots = self.roots.iter().step_by(stride);
                for ((a, b), [cos, sin]) in low.iter_mut().zip(high).zip(roots) {
                    let turned = [b[0] * cos - b[1] * sin, b[0] * sin + b[1] * cos];
                    *b = [a[0] - turned[0], a[1] - turned[1]];
                    *a = [a[0] + turned[0], a[1] + turned[1]];
                }
            }
            half *= 2;
        }
    }
}

pub(super) fn to_f64(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::harmonics::wigner::wigner_d;

    #[test]
    fn rings_meet_the_functions_one_by_one() {
        let window = Window::beam(0.009).unwrap();
        let l_max = window.l_max();
        assert!(l_max > 690);
        let weight = |l: usize, column: usize| to_f64(l * (column + 3)).sin();
        let coefficients: Vec<Columns> =
            (0..=l_max).map(|l| std::array::from_fn(|column| weight(l, column))).collect();
        let rings = Rings::new(100);
        assert!((rings.shares().sum::<f64>() - 1.0).abs() < 1e-14);
        for (m, n) in [(0, 0), (0, 3), (1, 6), (56, 0), (56, 4), (410, 2), (690, 6)] {
            let sums = rings.sums(&window, m, &[n], std::slice::from_ref(&coefficients));
            for (i, sums) in sums[0].iter().enumerate() {
                let theta = PI * (to_f64(i) + 0.5) / to_f64(rings.count());
                let row = wigner_d(m, n, theta, l_max);
                for column in 0..COLUMNS {
                    let terms = row.iter().zip(&coefficients).zip(window.weights());
                    let expected: f64 = terms.map(|((d, c), w)| w * d * c[column]).sum();
                    let off = (sums[column] - expected).abs();
                    assert!(off < 1e-9, "{m} {n} {theta}: {off:e}");
                }
            }
        }
    }

    #[test]
    fn longitudes_meet_the_sum() {
        let longitudes = Longitudes::new(13);
        let mut values = vec![[0.0; 2]; longitudes.count()];
        let terms = [(0, 1.0, 0.0), (3, 0.2, -0.7), (-5, 0.4, 0.9), (21, -0.3, 0.1)];
        for (m, re, im) in terms {
            let bin = &mut values[longitudes.bin(m)];
            *bin = [bin[0] + re, bin[1] + im];
        }
        longitudes.transform(&mut values);
        assert_eq!(values.len(), 16);
        for (i, value) in values.iter().enumerate() {
            let expected = terms.iter().fold([0.0; 2], |sum, (m, re, im)| {
                let (s, c) = (TAU * f64::from(*m) * to_f64(i) / 16.0).sin_cos();
                [sum[0] + re * c - im * s, sum[1] + re * s + im * c]
            });
            assert!((value[0] - expected[0]).abs() < 1e-13);
            assert!((value[1] - expected[1]).abs() < 1e-13);
        }
    }
}
