//! The variance of hits north and south of the ecliptic.
//!
//! Even and odd degrees interfere with opposite signs in the two halves. With
//! `a_lm = sqrt(2l + 1) w_l A_lm`, the mean square of `hits / mean - 1` over the north is
//! `V + D`, over the south `V - D`, V that over the sphere and
//!
//! `D = 4 pi sum_m sum_uv 2 Re(a_um a_vm*) int_0^1 lambda_um lambda_vm dx`, `u + m` even, `v + m` odd.
//!
//! Method: both functions solve Legendre's equation, so that the integral is their Wronskian at the
//! equator, `lambda_u(0) lambda_v'(0) / [v (v + 1) - u (u + 1)]`, with
//! `lambda_v'(0) = sqrt((2v + 1)(v^2 - m^2) / (2v - 1)) lambda_(v-1)(0)`.
//!
//! Limits: those of [`super::power`].

use super::motion::Motion;
use super::power::Term;
use super::predictor::Predictor;
use crate::harmonics::wigner::wigner_d;
use std::f64::consts::{FRAC_PI_2, PI};

/// `sigma_hits / mean` of each half of the sky, relative to the half's own mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hemispheres {
    /// Ecliptic latitudes above zero.
    pub north: f64,
    /// Ecliptic latitudes below zero.
    pub south: f64,
}

/// Terms below it are left out of the difference of the halves.
const NEGLIGIBLE_TERM: f64 = 1e-10;

impl Predictor {
    /// The two halves of a motion's map.
    pub fn hemispheres(&mut self, motion: &Motion) -> Hemispheres {
        let variance = self.predict(motion).variance;
        let terms = self.terms(motion);
        let (mut difference, mut shift) = (0.0, 0.0);
        for same_m in terms.chunk_by(|a, b| a.m == b.m) {
            let kept: Vec<Term> = same_m
                .iter()
                .filter(|term| {
                    let [re, im] = term.factor;
                    (re * re + im * im) * self.pair_power(term.pair, term.m) > NEGLIGIBLE_TERM
                })
                .copied()
                .collect();
            let Some(m) = kept.first().map(|it| it.m) else { continue };
            let mut sum = vec![[0.0; 2]; self.window().weights().len()];
            for term in &kept {
                for (cell, a) in sum.iter_mut().zip(self.amplitudes(term)) {
                    cell[0] += a * term.factor[0];
                    cell[1] += a * term.factor[1];
                }
            }
            let sides = if m == 0 { 1.0 } else { 2.0 };
            let [d, mean] = halves(m, &sum);
            difference += sides * d;
            shift += if m == 0 { mean } else { 0.0 };
        }
        let side = |sign: f64| {
            let shift = sign * shift;
            (variance + sign * difference - shift * shift).max(0.0).sqrt() / (1.0 + shift)
        };
        Hemispheres { north: side(1.0), south: side(-1.0) }
    }

    /// Share of the north in the power of one pair at m, from 0 to 1; not negative m.
    pub(super) fn northern_share(&self, pair: usize, conjugate: bool, m: i32) -> f64 {
        let term = Term { m, pair, conjugate, factor: [1.0, 0.0] };
        let row: Vec<[f64; 2]> = self.amplitudes(&term).into_iter().map(|a| [a, 0.0]).collect();
        let total: f64 = row.iter().map(|a| a[0] * a[0]).sum();
        if total > 0.0 { (0.5 + 0.5 * halves(m, &row)[0] / total).clamp(0.0, 1.0) } else { 0.5 }
    }
}

/// Half of north less south, and the mean of the north, of amplitudes at one m.
fn halves(m: i32, amplitudes: &[[f64; 2]]) -> [f64; 2] {
    let equator = wigner_d(m, 0, FRAC_PI_2, amplitudes.len().saturating_sub(1));
    let lambda = |l: f64, d: f64| ((2.0 * l + 1.0) / (4.0 * PI)).sqrt() * d;
    // (l (l + 1), value or slope at the equator times the amplitude).
    let (mut even, mut odd) = (Vec::new(), Vec::new());
    let mut below = 0.0;
    let mut l = 0.0_f64;
    let mut parity_even = m % 2 == 0;
    let mm = f64::from(m) * f64::from(m);
    for (&[re, im], d) in amplitudes.iter().zip(equator) {
        let value = lambda(l, d);
        if parity_even {
            even.push((l * (l + 1.0), value * re, value * im, value));
        } else if l * l > mm {
            let slope = ((2.0 * l + 1.0) * (l * l - mm) / (2.0 * l - 1.0)).sqrt() * below;
            odd.push((l * (l + 1.0), slope * re, slope * im));
        }
        below = value;
        parity_even = !parity_even;
        l += 1.0;
    }
    let mut difference = 0.0;
    for &(u, re, im, _) in even.iter().filter(|it| it.1 != 0.0 || it.2 != 0.0) {
        difference += odd.iter().map(|v| (re * v.1 + im * v.2) / (v.0 - u)).sum::<f64>();
    }
    // The mean of a half is its product with l = 0, whose lambda is 1 / sqrt(4 pi).
    let mean = if m == 0 {
        let one = 1.0 / (4.0 * PI).sqrt();
        odd.iter().map(|v| one * v.1 / v.0).sum::<f64>()
    } else {
        0.0
    };
    [8.0 * PI * difference, 4.0 * PI * mean]
}
