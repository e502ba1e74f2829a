//! How much of each degree l survives the averaging over a pixel or a beam.
//!
//! A [`Window`] is `w_l` from l = 0: an average over all pixels of a HEALPix map, in the sense that
//! `w_l^2` is the share of an isotropic field's variance at l that pixel averages keep, or a Gaussian
//! beam.
//!
//! Method: a pixel is, in coordinates along its two edges, a square of equal areas \[Gorski2005\];
//! where it is small it is the parallelogram of edges e1, e2, and its transform is
//! `sinc(q.e1 / 2) sinc(q.e2 / 2)`, q of length `sqrt(l (l + 1))`. `w_l^2` is the mean of its square
//! over the directions of q and over all pixels, an even, entire function of `l / nside` alone:
//! computed at 20 Chebyshev nodes and interpolated. With `s = sin(theta)`, the edges times
//! nside are
//!
//! | region | e1, e2 (east, south) |
//! |---|---|
//! | equatorial | `(pi s / 4, +-2 / (3 s))` |
//! | polar, at share t of its quarter turn | `(pi p (1 - t) / 2, 2 / (3 p))`, `(-pi p t / 2, 2 / (3 p))` |
//!
//! with `p^2 = (2 - u^2 / 3) / 3`, `u^2 = 3 (1 - |z|)`. The beam is `exp(-l (l + 1) sigma^2 / 2)`.
//!
//! Limits: pixels of large nside as if flat, polar corners included; against pair averages over the
//! true pixels `w_l` is off by less than 0.02 at nside 1 and 2e-3 at 8, falling with nside (test
//! `meets_pair_averages_over_true_pixels`).

use super::coefficients::sinc;
use crate::harmonics::quadrature::gauss_legendre;
use crate::harmonics::wigner::MAX_L;
use crate::healpix::Nside;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LN_2, PI};
use thiserror::Error;

/// Largest l over nside.
pub const DEGREES_PER_NSIDE: usize = 6;
/// Chebyshev nodes in `(l / nside)^2`.
const NODES: usize = 20;
/// Directions of q over half a turn.
const DIRECTIONS: u32 = 48;
/// A beam's degrees end where `w_l^2` is below it.
const LEAST_BEAM_POWER: f64 = 1e-6;

/// `x = l / nside` and the integral of `w^2` over x beyond it, which falls about as `x^-2`.
const TAILS: [(f64, f64); 2] = [(6.0, 0.0888), (12.0, 0.0250)];

/// Weights of degrees l = 0 to `l_max`.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    weights: Vec<f64>,
    /// Of a HEALPix map's pixels.
    nside: Option<Nside>,
}

/// Why there is no window.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum WindowError {
    /// Finer than the degrees that are supported.
    #[error("nside {0} needs degrees beyond {MAX_L}; up to 512 is supported")]
    Nside(u32),
    /// A beam that is not positive, or too fine or too wide.
    #[error(
        "a beam of {} arcmin has no window within the degrees that are supported; a full width from 14.7 arcmin to 200 deg is needed", fwhm_rad.to_degrees() * 60.0
    )]
    Beam {
        /// Full width at half maximum in radians.
        fwhm_rad: f64,
    },
}

impl Window {
    /// The window of a HEALPix map's pixels, to 6 nside; at nside 512 to 4 nside, which leaves out
    /// about 1e-3 of the variance.
    ///
    /// # Errors
    /// [`WindowError::Nside`] above nside 512.
    pub fn pixel(nside: Nside) -> Result<Self, WindowError> {
        if nside.get() > 512 {
            return Err(WindowError::Nside(nside.get()));
        }
        let l_max = (DEGREES_PER_NSIDE * nside.get() as usize).min(MAX_L);
        let series = pixel_series();
        let per = 1.0 / f64::from(nside.get());
        let weight = |l: u32| {
            let l = f64::from(l);
            chebyshev(&series, l * (l + 1.0) * per * per).max(0.0).sqrt()
        };
        Ok(Self { weights: (0..).take(l_max + 1).map(weight).collect(), nside: Some(nside) })
    }

    /// The window of a Gaussian beam, to where it keeps 1e-6 of the power.
    ///
    /// # Errors
    /// [`WindowError::Beam`] where its width is not positive, or that degree not within 2 to
    /// [`MAX_L`].
    pub fn beam(fwhm_rad: f64) -> Result<Self, WindowError> {
        let variance = fwhm_rad * fwhm_rad / (8.0 * LN_2);
        let refused = WindowError::Beam { fwhm_rad };
        if !(fwhm_rad > 0.0 && variance > 0.0) {
            return Err(refused);
        }
        let power = |l: u32| (-f64::from(l) * (f64::from(l) + 1.0) * variance).exp();
        let weights: Vec<f64> = (0..)
            .take(MAX_L + 2)
            .map(power)
            .take_while(|&power| power >= LEAST_BEAM_POWER)
            .map(f64::sqrt)
            .collect();
        if weights.len() < 3 || weights.len() > MAX_L + 1 {
            return Err(refused);
        }
        Ok(Self { weights, nside: None })
    }

    /// `w_l` from l = 0.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The map whose pixels it stands for, if not a beam.
    pub(super) const fn nside(&self) -> Option<Nside> {
        self.nside
    }

    /// The same with twice as many degrees, as far as they are supported; those beyond have the last
    /// weight. `None` for a beam, which has all that count.
    pub(super) fn doubled(&self) -> Option<Self> {
        self.nside?;
        let mut doubled = self.clone();
        let last = self.weights.last().copied().unwrap_or(0.0);
        doubled.weights.resize((2 * self.l_max()).min(MAX_L) + 1, last);
        Some(doubled)
    }

    /// Sum of `w_l^2` over the degrees beyond the last; none for a beam.
    pub(super) fn powers_beyond(&self) -> f64 {
        self.nside.map_or(0.0, |nside| {
            let nside = f64::from(nside.get());
            let last = f64::from(u32::try_from(self.l_max()).unwrap_or(u32::MAX)) / nside;
            let (x, from_x) = if last < 9.0 { TAILS[0] } else { TAILS[1] };
            nside * from_x * (x / last).powi(2)
        })
    }

    /// The largest degree.
    #[must_use]
    pub const fn l_max(&self) -> usize {
        self.weights.len().saturating_sub(1)
    }
}

/// A share of the sky and the edges of its pixels, times nside.
type Shape = (f64, [f64; 2], [f64; 2]);

fn shapes() -> Vec<Shape> {
    let mut shapes = Vec::new();
    let gauss = gauss_legendre(8);
    for &(x, share) in &gauss {
        let z = x * 2.0 / 3.0;
        let s = (1.0 - z * z).sqrt();
        let (east, south) = (FRAC_PI_4 * s, 2.0 / (3.0 * s));
        shapes.push((share * 2.0 / 3.0, [east, south], [east, -south]));
        for &(t, share_t) in &gauss {
            // Areas of the polar region grow with u.
            let p = ((2.0 - x * x / 3.0) / 3.0).sqrt();
            let south = 2.0 / (3.0 * p);
            let edges = ([FRAC_PI_2 * p * (1.0 - t), south], [-FRAC_PI_2 * p * t, south]);
            shapes.push((share * share_t * x * 2.0 / 3.0, edges.0, edges.1));
        }
    }
    shapes
}

/// `w^2` at `x = l / nside`.
fn pixel_power(shapes: &[Shape], x: f64) -> f64 {
    let share = |&(share, e1, e2): &Shape| {
        let directions = (0..DIRECTIONS).map(|i| {
            let (sin, cos) = (PI * (f64::from(i) + 0.5) / f64::from(DIRECTIONS)).sin_cos();
            let along = |e: [f64; 2]| sinc(0.5 * x * (cos * e[0] + sin * e[1]));
            (along(e1) * along(e2)).powi(2)
        });
        share * directions.sum::<f64>() / f64::from(DIRECTIONS)
    };
    shapes.iter().map(share).sum()
}

/// Largest square of `l / nside` of the series: `l (l + 1)` at nside 1.
const LARGEST_SQUARE: f64 = 42.0;

/// Chebyshev coefficients of `w^2` over `(l / nside)^2`.
fn pixel_series() -> [f64; NODES] {
    let shapes = shapes();
    let count = f64::from(u32::try_from(NODES).unwrap_or(0));
    let angle: [f64; NODES] =
        std::array::from_fn(|i| PI * (f64::from(u32::try_from(i).unwrap_or(0)) + 0.5) / count);
    let values =
        angle.map(|a| pixel_power(&shapes, (LARGEST_SQUARE * f64::midpoint(1.0, a.cos())).sqrt()));
    let mut series = [0.0; NODES];
    let mut order = 0.0;
    for coefficient in &mut series {
        let sum: f64 = angle.iter().zip(values).map(|(a, v)| v * (order * a).cos()).sum();
        *coefficient = if order > 0.0 { 2.0 * sum / count } else { sum / count };
        order += 1.0;
    }
    series
}

/// The series at a square.
fn chebyshev(series: &[f64], square: f64) -> f64 {
    let x = 2.0 * square / LARGEST_SQUARE - 1.0;
    let (mut now, mut above) = (0.0, 0.0);
    for &c in series.iter().skip(1).rev() {
        (now, above) = (c + 2.0 * x * now - above, now);
    }
    series.first().copied().unwrap_or(0.0) + x * now - above
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::unit_vector;

    /// `w_l` from pairs of `side^2` points in each pixel.
    fn pair_averages(nside: u32, side: u32) -> Vec<f64> {
        let fine = Nside::new(nside * side).unwrap();
        let each = side * side;
        let l_max = DEGREES_PER_NSIDE * nside as usize;
        let mut sums = vec![0.0; l_max + 1];
        let mut total = 0.0;
        // Quarter turns and reflection: one polar and one equatorial base pixel.
        for (base, share) in [(0, 2.0), (4, 1.0)] {
            for pixel in base * nside * nside..(base + 1) * nside * nside {
                let points: Vec<[f64; 3]> = (0..each)
                    .map(|i| fine.center(pixel * each + i))
                    .map(|(lon, lat)| unit_vector(lon, lat))
                    .collect();
                for (i, a) in points.iter().enumerate() {
                    for (j, b) in points.iter().enumerate().skip(i) {
                        let share = if i == j { share } else { 2.0 * share };
                        let x: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                        let (mut now, mut above) = (1.0, x);
                        let mut n = 0.0;
                        for sum in &mut sums {
                            *sum += share * now;
                            n += 1.0;
                            let next = ((2.0 * n + 1.0) * x * above - n * now) / (n + 1.0);
                            (now, above) = (above, next);
                        }
                        total += share;
                    }
                }
            }
        }
        sums.iter().map(|sum| sum / total).collect()
    }

    #[test]
    fn meets_pair_averages_over_true_pixels() {
        for (nside, bound_below_4, bound) in [(1, 0.02, 0.035), (4, 1.5e-3, 5e-3), (8, 6e-4, 2e-3)]
        {
            let window = Window::pixel(Nside::new(nside).unwrap()).unwrap();
            // Centres of parts stand for the parts; the error falls with their size squared.
            let (coarse, fine) = (pair_averages(nside, 4), pair_averages(nside, 8));
            let mut worst = [0.0_f64; 2];
            for (l, w) in window.weights().iter().enumerate() {
                let expected = ((4.0 * fine[l] - coarse[l]) / 3.0).max(0.0).sqrt();
                let off = (w - expected).abs();
                worst[usize::from(l > 4 * nside as usize)] =
                    worst[usize::from(l > 4 * nside as usize)].max(off);
            }
            assert!(worst[0] < bound_below_4 && worst[1] < bound, "{nside}: {worst:?}");
        }
    }

    #[test]
    fn series_meets_the_integral() {
        let (shapes, series) = (shapes(), pixel_series());
        assert!((shapes.iter().map(|it| it.0).sum::<f64>() - 1.0).abs() < 1e-14);
        for shape in &shapes {
            // All pixels have the same area.
            let area = (shape.1[0] * shape.2[1] - shape.1[1] * shape.2[0]).abs();
            assert!((area - PI / 3.0).abs() < 1e-12);
        }
        for i in 0..=60 {
            let x = f64::from(i) / 10.0;
            let off = chebyshev(&series, x * x) - pixel_power(&shapes, x);
            assert!(off.abs() < 1e-9, "{x}: {off:e}");
        }
    }

    #[test]
    fn tails_are_integrals() {
        let shapes = shapes();
        for (from, expected) in TAILS {
            let count = ((48.0 - from) * 4.0_f64).round();
            let (mut sum, mut i) = (0.0, 0.5);
            while i < count {
                sum += 0.25 * pixel_power(&shapes, from + 0.25 * i);
                i += 1.0;
            }
            // w^2 falls about as x^-3: half of x w^2 is left, w^2 from 6e-5 to 1e-4.
            let left = 24.0 * 8e-5;
            assert!((sum + left - expected).abs() < 1e-3, "{from}: {sum} {expected}");
        }
    }

    #[test]
    fn beams_fall_to_half() {
        let fwhm = 0.01;
        let beam = Window::beam(fwhm).unwrap();
        let variance = fwhm * fwhm / (8.0 * LN_2);
        assert!((beam.weights()[100].ln() + 100.0 * 101.0 * variance / 2.0).abs() < 1e-12);
        assert!(beam.l_max() > 500 && beam.l_max() < MAX_L);
        for fwhm_rad in [0.0, -1.0, f64::NAN, 1e-4, 10.0] {
            assert!(Window::beam(fwhm_rad).is_err());
        }
        assert!(Window::pixel(Nside::new(1024).unwrap()).is_err());
    }
}
