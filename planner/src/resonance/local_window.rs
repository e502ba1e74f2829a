//! How much of a wave along latitude and longitude survives a pixel's averaging, ring by ring.
//!
//! Where a pattern has a direction, as rings along latitude have, its share depends on the pixels' shape
//! at that latitude. A wave of degree l and azimuthal number m has there the wave numbers
//! `q_E = m / sin(theta)` and `q_S = sqrt(l (l + 1) - q_E^2)`; with [`super::window`]'s edges
//!
//! `W = sinc(A + B) sinc(A - B) = (sin^2 A - sin^2 B) / (A^2 - B^2)`,
//!
//! | region | A nside | B nside |
//! |---|---|---|
//! | equatorial | `m pi / 8` | `q_S / (3 sin(theta))` |
//! | polar | `q_E pi p / (4 sqrt 3)` | `q_S / (3 p)` |
//!
//! Method: polar pixels lean differently along a ring; theirs has the mean of A^2 over them.
//! `sin^2 B` is a power series in B^2.
//!
//! Limits: pixels as if flat; W to 1e-4 (test `meets_the_product_of_sincs`).

use super::window::{DEGREES_PER_NSIDE, Window};
use crate::healpix::Nside;
use std::f64::consts::PI;

/// A ring's averaging at one m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    /// `q_E^2`, `A^2` and `sin^2 A`.
    east_squared: f64,
    a_squared: f64,
    sin_squared: f64,
    /// `B^2 / q_S^2`.
    per_south: f64,
}

impl Wave {
    /// On the ring of that cosine and sine.
    pub(super) fn new(nside: Nside, m: i32, [cos, sin]: [f64; 2]) -> Self {
        let (m, nside) = (f64::from(m), f64::from(nside.get()));
        let east = m / sin;
        let (a, size) = if cos.abs() <= 2.0 / 3.0 {
            (m * PI / (8.0 * nside), sin)
        } else {
            let p = ((1.0 + cos.abs()) / 3.0).sqrt();
            (east * PI * p / (4.0 * 3.0_f64.sqrt() * nside), p)
        };
        Self {
            east_squared: east * east,
            a_squared: a * a,
            sin_squared: a.sin().powi(2),
            per_south: (3.0 * size * nside).powi(-2),
        }
    }
}

/// Differences of `A^2 - B^2` below it are taken for it.
const LEAST_DIFFERENCE: f64 = 1e-4;
/// Terms of the series of `sin^2` for squares to 29, l of 12 nside; and to 7.5, 6 nside.
const TERMS: usize = 40;
const FEWER_TERMS: usize = 15;

/// Coefficients of `sin^2 x = sum_i c_i (x^2)^(i + 1)`.
const SERIES: [f64; TERMS] = {
    // 2^(2i - 1) / (2i)!, of alternating sign.
    let mut series = [0.0; TERMS];
    let (mut term, mut n, mut i) = (1.0, 2.0, 0);
    while i < TERMS {
        series[i] = term;
        term *= -4.0 / ((n + 1.0) * (n + 2.0));
        n += 2.0;
        i += 1;
    }
    series
};

/// W of several rings at `l (l + 1)`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "compiled for the instruction set of its caller")]
fn weights<const N: usize>(waves: &[Wave; N], degree: f64, series: &[f64]) -> [f64; N] {
    let mut weights = [0.0; N];
    for (weight, wave) in weights.iter_mut().zip(waves) {
        let b = (degree - wave.east_squared).max(0.0) * wave.per_south;
        let near = (wave.a_squared - b).abs() < LEAST_DIFFERENCE;
        let b = if near { wave.a_squared - LEAST_DIFFERENCE } else { b };
        let mut sum = 0.0;
        for c in series.iter().rev() {
            sum = sum * b + c;
        }
        *weight = (wave.sin_squared - sum * b) / (wave.a_squared - b);
    }
    weights
}

/// Weights of each degree on several rings at one m.
pub(super) fn fill<const N: usize>(
    window: &Window,
    m: i32,
    rings: &[[f64; 2]; N],
    weights_by_degree: &mut [[f64; N]],
) {
    let Some(nside) = window.nside() else {
        for (weights, w) in weights_by_degree.iter_mut().zip(window.weights()) {
            *weights = [*w; N];
        }
        return;
    };
    let waves = rings.map(|ring| Wave::new(nside, m, ring));
    let few = window.l_max() <= DEGREES_PER_NSIDE * nside.get() as usize;
    let series = if few { SERIES.split_at(FEWER_TERMS).0 } else { &SERIES[..] };
    pulp::Arch::new().dispatch(|| {
        let mut l = 0.0;
        for cells in weights_by_degree.iter_mut() {
            *cells = weights(&waves, l * (l + 1.0), series);
            l += 1.0;
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_the_product_of_sincs() {
        let nside = Nside::new(64).unwrap();
        let window = Window::pixel(nside).unwrap();
        let windows = [window.doubled().unwrap(), window];
        let sinc = |x: f64| if x.abs() < 1e-9 { 1.0 } else { x.sin() / x };
        for m in [0, 1, 40, 150, 300] {
            for (theta, window) in [(0.3_f64, 0), (0.8, 1), (0.9, 0), (1.5, 1)] {
                let (sin, cos) = theta.sin_cos();
                let window = &windows[window];
                let mut found = vec![[0.0]; window.l_max() + 1];
                fill(window, m, &[[cos, sin]], &mut found);
                let (east, polar) = (f64::from(m) / sin, ((1.0 + cos) / 3.0).sqrt());
                let equatorial = cos < 2.0 / 3.0;
                let edge = if equatorial { sin / 8.0 } else { polar / 48.0_f64.sqrt() };
                let a = east * PI * edge / 64.0;
                for (l, [w]) in (0_u32..).zip(&found).skip(1) {
                    let l = f64::from(l);
                    let south = (l * (l + 1.0) - east * east).max(0.0).sqrt();
                    let b = south / (3.0 * 64.0 * if equatorial { sin } else { polar });
                    if a < 3.0 {
                        let expected = sinc(a + b) * sinc(a - b);
                        assert!((w - expected).abs() < 1e-4, "{m} {theta} {l}: {w} {expected}");
                    }
                }
            }
        }
    }
}
