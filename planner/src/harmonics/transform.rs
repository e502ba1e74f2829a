//! Maps from coefficients, and coefficients from maps.
//!
//! Maps are in RING order. `a_lm = (4 pi / N_pix) sum_p F_p conj sY_lm(p)` is the plain pixel sum;
//! iterations add the coefficients of what the map has and they do not.
//!
//! Method: for each order m, sums over degrees on blocks of rings ([`super::lanes`]); along the rings
//! Fourier transforms ([`super::fourier`]). Orders and rings run on all threads, whose number does
//! not change a bit.
//!
//! Limits: the pixel sum is off by what aliases, some 1e-3 at 2 `N_side`; memory beside the map is
//! that of its orders, `8 (l_max + 1) N_side` complex numbers.

use super::Complex64;
use super::alm::Alm;
use super::circle::Circle;
use super::fourier::Orders;
use super::ladder::Ladder;
use super::lanes::{self, Column, Gathered, OnRings, PAIRS, normalisation};
use super::ring::Rings;
use super::spin::SpinAlm;
use rayon::prelude::*;
use thiserror::Error;

/// Largest degree.
pub const MAX_DEGREE: usize = 8192;
/// Largest spin.
pub const MAX_SPIN: usize = 16;

/// Why a map or coefficients cannot be transformed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum TransformError {
    /// A degree above [`MAX_DEGREE`].
    #[error("degrees to {0}: {MAX_DEGREE} at most")]
    Degree(usize),
    /// A spin above [`MAX_SPIN`].
    #[error("spin {0}: {MAX_SPIN} at most")]
    Spin(usize),
    /// E and B of different degrees.
    #[error("E to degree {e} and B to degree {b}")]
    Parts {
        /// Of E.
        e: usize,
        /// Of B.
        b: usize,
    },
    /// A map of another resolution.
    #[error("{found} pixels where {needed} are needed")]
    Pixels {
        /// Values given.
        found: usize,
        /// Pixels of the resolution.
        needed: usize,
    },
}

/// By order m, by block of rings.
type Spread = Vec<Vec<OnRings>>;

impl Rings {
    /// The map of a field, in RING order.
    ///
    /// # Errors
    /// [`TransformError`] for a degree or spin that is too large.
    pub fn map(&self, field: &SpinAlm) -> Result<Vec<Complex64>, TransformError> {
        if field.e.l_max() != field.b.l_max() {
            return Err(TransformError::Parts { e: field.e.l_max(), b: field.b.l_max() });
        }
        check(field.spin, field.l_max())?;
        let blocks = self.blocks();
        let orders: Spread = (0..=field.l_max())
            .into_par_iter()
            .map(|m| {
                let ladder = Ladder::new(m, field.spin, field.l_max());
                let columns = columns(field, m, ladder.start);
                let block = |block: &[Circle; PAIRS]| {
                    if block.iter().any(|circle| ladder.reaches(circle, field.l_max())) {
                        lanes::to_rings(&ladder, block, &columns)
                    } else {
                        [[0.0; PAIRS]; 8]
                    }
                };
                blocks.iter().map(block).collect()
            })
            .collect();
        let rings: Vec<[Vec<Complex64>; 2]> = (0..self.circles.len())
            .into_par_iter()
            .map(|at| {
                let circle = &self.circles[at];
                let side = |mirrored: usize| {
                    let (block, pair) = (at / PAIRS, at % PAIRS);
                    let orders = orders.iter().map(|by_block| {
                        let parts = &by_block[block];
                        let number =
                            |part: usize| Complex64::new(parts[part][pair], parts[part + 1][pair]);
                        [number(4 * mirrored), number(4 * mirrored + 2)]
                    });
                    self.fourier.pixels(circle, orders)
                };
                [side(0), if circle.mirrored.is_some() { side(1) } else { Vec::new() }]
            })
            .collect();
        let mut map = vec![Complex64::ZERO; self.nside().pixels() as usize];
        for (circle, [north, south]) in self.circles.iter().zip(rings) {
            map[circle.first..circle.first + circle.count].copy_from_slice(&north);
            if let Some(first) = circle.mirrored {
                map[first..first + circle.count].copy_from_slice(&south);
            }
        }
        Ok(map)
    }

    /// The coefficients of a map in RING order: the pixel sum, iterated as often as asked for.
    ///
    /// # Errors
    /// [`TransformError`] for a degree or spin that is too large, or a map of another resolution.
    pub fn alm(
        &self,
        spin: usize,
        map: &[Complex64],
        l_max: usize,
        iterations: usize,
    ) -> Result<SpinAlm, TransformError> {
        let mut found = self.pixel_sum(spin, map, l_max)?;
        for _ in 0..iterations {
            let mut rest = self.map(&found)?;
            for (rest, value) in rest.iter_mut().zip(map) {
                *rest = value - *rest;
            }
            found = found.plus(&self.pixel_sum(spin, &rest, l_max)?);
        }
        Ok(found)
    }

    /// The map of a real field of spin 0, `sum_lm a_lm Y_lm`.
    ///
    /// # Errors
    /// Those of [`Rings::map`].
    pub fn scalar_map(&self, alm: &Alm) -> Result<Vec<f64>, TransformError> {
        Ok(self.map(&SpinAlm::scalar(alm))?.into_iter().map(|value| value.re).collect())
    }

    /// The coefficients of a real map, as [`Rings::alm`].
    ///
    /// # Errors
    /// Those of [`Rings::alm`].
    pub fn scalar_alm(
        &self,
        map: &[f64],
        l_max: usize,
        iterations: usize,
    ) -> Result<Alm, TransformError> {
        let map: Vec<Complex64> = map.iter().map(|&value| value.into()).collect();
        Ok(self.alm(0, &map, l_max, iterations)?.e.weighted(|_| -1.0))
    }

    fn pixel_sum(
        &self,
        spin: usize,
        map: &[Complex64],
        l_max: usize,
    ) -> Result<SpinAlm, TransformError> {
        let needed = self.nside().pixels() as usize;
        if map.len() != needed {
            return Err(TransformError::Pixels { found: map.len(), needed });
        }
        check(spin, l_max)?;
        let rings: Vec<[Vec<Orders>; 2]> = self
            .circles
            .par_iter()
            .map(|circle| {
                let side = |first: Option<usize>| {
                    first.map_or_else(Vec::new, |first| {
                        self.fourier.orders(circle, &map[first..first + circle.count], l_max)
                    })
                };
                [side(Some(circle.first)), side(circle.mirrored)]
            })
            .collect();
        let blocks = self.blocks();
        let area = self.nside().pixel_area_sr();
        let rows: Vec<[Vec<Complex64>; 2]> = (0..=l_max)
            .into_par_iter()
            .map(|m| {
                let ladder = Ladder::new(m, spin, l_max);
                let mut sums: Vec<Gathered> = vec![[[0.0; PAIRS]; 4]; ladder.steps.len()];
                for (block, circles) in blocks.iter().enumerate() {
                    if circles.iter().any(|circle| ladder.reaches(circle, l_max)) {
                        let rings = rings.get(PAIRS * block..).unwrap_or_default();
                        lanes::to_degrees(&ladder, circles, &fields(rings, m), &mut sums);
                    }
                }
                parts(&sums, (m, spin), ladder.start, area)
            })
            .collect();
        let (e, b): (Vec<_>, Vec<_>) = rows.into_iter().map(|[e, b]| (e, b)).unzip();
        let alm = |rows| Alm::from_rows(l_max, rows).unwrap_or_else(|| Alm::zero(l_max));
        Ok(SpinAlm { spin, e: alm(e), b: alm(b) })
    }

    /// Rings side by side, the last repeated to a whole block.
    fn blocks(&self) -> Vec<[Circle; PAIRS]> {
        let last = self.circles.len() - 1;
        let count = self.circles.len().div_ceil(PAIRS);
        (0..count)
            .map(|block| std::array::from_fn(|pair| self.circles[(block * PAIRS + pair).min(last)]))
            .collect()
    }
}

fn check(spin: usize, l_max: usize) -> Result<(), TransformError> {
    if l_max > MAX_DEGREE {
        return Err(TransformError::Degree(l_max));
    }
    if spin > MAX_SPIN { Err(TransformError::Spin(spin)) } else { Ok(()) }
}

/// Coefficients of an order from its lowest degree, with all factors but the Wigner functions.
fn columns(field: &SpinAlm, m: usize, start: usize) -> Vec<Column> {
    let by_spin = if field.spin.is_multiple_of(2) { 1.0 } else { -1.0 };
    (start..=field.l_max())
        .map(|l| {
            let [plus, minus] = field.pair(l, m);
            let by_order = if m.is_multiple_of(2) { 1.0 } else { -1.0 };
            let size = normalisation(l);
            // a_lm sY_lm = a_lm (-1)^s N_l d_(m,-s), and for -m with (-1)^m N_l d_(m,s)
            let plus = plus * (size * by_spin);
            let minus = if m == 0 { Complex64::ZERO } else { minus * (size * by_order) };
            let mirror = if (l + m).is_multiple_of(2) { 1.0 } else { -1.0 };
            let parts = [plus.re, plus.im, minus.re, minus.im];
            std::array::from_fn(|at| if at < 4 { parts[at] } else { mirror * parts[at - 4] })
        })
        .collect()
}

/// The fields of an order on a block of rings; zero beyond the last ring, and south of the equator's.
fn fields(rings: &[[Vec<Orders>; 2]], m: usize) -> OnRings {
    let mut to = [[0.0; PAIRS]; 8];
    for (pair, sides) in rings.iter().take(PAIRS).enumerate() {
        for (side, orders) in sides.iter().enumerate() {
            let Some([plus, minus]) = orders.get(m) else { continue };
            for (part, value) in [plus.re, plus.im, minus.re, minus.im].into_iter().enumerate() {
                to[4 * side + part][pair] = value;
            }
        }
    }
    to
}

/// E and B of an order from l = m.
fn parts(
    sums: &[Gathered],
    (m, spin): (usize, usize),
    start: usize,
    area: f64,
) -> [Vec<Complex64>; 2] {
    let by_spin = if spin % 2 == 0 { 1.0 } else { -1.0 };
    let mut to = [vec![Complex64::ZERO; start - m], vec![Complex64::ZERO; start - m]];
    for (l, sums) in (start..).zip(sums) {
        let [re, im, mirrored_re, mirrored_im] = sums.map(|lanes| lanes.iter().sum::<f64>());
        let size = area * normalisation(l);
        let plus = Complex64::new(re, im) * (size * by_spin);
        // (-1)^m a_(l,-m), for m = 0 the same as a_l0.
        let minus = if m == 0 { plus } else { Complex64::new(mirrored_re, mirrored_im) * size };
        // E = -(a_lm + (-1)^m conj a_(l,-m)) / 2, i B = -(a_lm - ...) / 2
        to[0].push((plus + minus.conj()) * -0.5);
        to[1].push(Complex64::I * (plus - minus.conj()) * 0.5);
    }
    to
}
