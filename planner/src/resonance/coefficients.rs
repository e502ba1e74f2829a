//! How much of a pair of frequencies is in each azimuthal number m.
//!
//! A pair that stands still at `m*` turns by `nu = N_o (m - m*)` during the survey; its coefficient at
//! m is `sinc(pi nu)`, and only m near `m*` count.
//!
//! Method: coefficients within a reach of `m*` are scaled by `sqrt(S / S_kept)` for what lies outside,
//! with `S = (1 / N_o) sum_r (1 - |r| / N_o)_+ cos(2 pi r m*)`.
//!
//! Limits: a circular orbit; [`super::orbit`] has the others.

use super::motion::Motion;
use std::f64::consts::{PI, TAU};

/// Reach in m for one orbit or more.
pub(super) const REACH: f64 = 3.0;

/// How far from `m*` terms are taken.
pub(super) fn reach(motion: &Motion) -> f64 {
    REACH / motion.orbits().abs().min(1.0)
}

/// `exp(i phase)`.
pub(super) fn from_polar(phase: f64) -> [f64; 2] {
    let (sin, cos) = phase.sin_cos();
    [cos, sin]
}

pub(super) fn times([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

/// `sqrt(S / S_kept) sinc(pi N_o (m - m*))` for m from `round(m*) - reach` to `round(m*) + reach`.
pub(super) fn coefficients(sizes: &mut Vec<f64>, m_star: f64, orbits: f64, reach: f64) {
    sizes.clear();
    let reach = reach.ceil();
    let mut x = PI * orbits * (m_star.round() - reach - m_star);
    let mut phasor = from_polar(x);
    let turn = from_polar(PI * orbits);
    let mut kept = 0.0;
    let mut m = -reach;
    while m <= reach {
        let size = if x.abs() < 1e-3 { sinc(x) } else { phasor[1] / x };
        kept += size * size;
        sizes.push(size);
        phasor = times(phasor, turn);
        x += PI * orbits;
        m += 1.0;
    }
    // Where nothing is kept, at the sinc's zeros, nothing is scaled.
    if kept >= 1e-6 {
        let scale = (all_of_sinc(m_star, orbits) / kept).max(0.0).sqrt();
        for size in sizes {
            *size *= scale;
        }
    }
}

/// `S`, the sum over all m of `sinc^2(pi N_o (m - m*))`.
pub(super) fn all_of_sinc(m_star: f64, orbits: f64) -> f64 {
    let orbits = orbits.abs();
    let mut sum = 1.0;
    let mut r = 1.0;
    while r < orbits {
        sum += 2.0 * (1.0 - r / orbits) * (TAU * r * m_star).cos();
        r += 1.0;
    }
    sum / orbits
}

pub(super) fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-8 { 1.0 } else { x.sin() / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sinc_squares_sum_as_stated() {
        for orbits in [0.3, 1.0, 1.5, 3.0] {
            for m_star in [0.0, 0.25, 0.5, 7.9] {
                let sum: f64 = (-200_000..=200_000)
                    .map(|m| sinc(PI * orbits * (f64::from(m) - m_star)).powi(2))
                    .sum();
                let found = all_of_sinc(m_star, orbits);
                assert!((sum - found).abs() < 1e-5, "{orbits} {m_star}: {sum} {found}");
            }
        }
    }
}
