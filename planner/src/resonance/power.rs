//! The variance of the hit map, term by term.
//!
//! With `nu = m N_o + k N_a + j N_b` (turns during the survey) and `phi` the start phases,
//!
//! `A_lm = sum_kj d^l_mk(90 deg) d^l_kj(alpha) d^l_j0(beta) sinc(pi nu) exp(-i [pi nu + m phi_o + k phi_a + j phi_b])`,
//!
//! `(sigma_hits / mean)^2 = sum_(l >= 1) (2l + 1) w_l^2 [|A_l0|^2 + 2 sum_(m >= 1) |A_lm|^2]`.
//!
//! Method: only terms near `nu = 0` count, `m` within 3 (of a survey
//! shorter than an orbit, 3 over its share of one) of `m* = -(k N_a + j N_b) / N_o`. The power of one pair (k, j) at m,
//! `P(m) = sum_l (2l + 1) w_l^2 [d_mk d_kj d_j0]^2`, depends on nothing but the angles: it is kept for
//! all motions. Pairs that meet at the same m interfere; their products are summed where Cauchy and
//! Schwarz do not already show them negligible. Amplitudes of each (k, j) are scaled by
//! `sqrt(S / S_kept)` for what lies outside the reach, with
//! `S = (1 / N_o) sum_r (1 - |r| / N_o)_+ cos(2 pi r m*)`. The smooth term (0, 0) is complete.
//!
//! Degrees beyond the window's last add what independent crossings do ([`Prediction::beyond_variance`]).
//!
//! Limits: terms dropped add less than [`NEGLIGIBLE`] each to the variance.

use super::coefficients::{coefficients, from_polar, reach, sinc, times};
use super::motion::Motion;
use super::predictor::{Pair, Predictor, SMOOTH, gcd};
use crate::harmonics::wigner::wigner_d;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

/// A product of two terms in the variance that is left out.
pub const NEGLIGIBLE: f64 = 1e-7;

/// What a survey's hits look like.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// `(sigma_hits / mean)^2`.
    pub variance: f64,
    /// The same without any (k, j) but (0, 0).
    pub smooth_variance: f64,
    /// What degrees beyond the window's last add, where a pixel's crossings are independent.
    pub beyond_variance: f64,
    /// The pairs that contribute, the strongest first; one of each (k, j), (-k, -j).
    pub resonances: Vec<Resonance>,
}

impl Prediction {
    /// `sigma_hits / mean`.
    #[must_use]
    pub fn sigma(&self) -> f64 {
        self.variance.max(0.0).sqrt()
    }

    /// `sigma_hits / mean` without resonances.
    #[must_use]
    pub fn smooth_sigma(&self) -> f64 {
        self.smooth_variance.max(0.0).sqrt()
    }
}

/// A pair of frequencies that nearly stands still on the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// Multiple of the precession, not negative.
    pub k: i32,
    /// Multiple of the spin.
    pub j: i32,
    /// Where it stands still.
    pub m_star: f64,
    /// What it and its conjugate add to the variance, interference aside.
    pub power: f64,
}

impl Resonance {
    /// `p / q` in lowest terms, not negative: p precessions beat with q spins.
    #[must_use]
    pub fn fraction(&self) -> [i32; 2] {
        let common = gcd(self.k, self.j).max(1);
        [self.k / common, self.j.abs() / common]
    }
}

/// A term at one m: the pair, whether its conjugate, and the factor at the survey's rates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    pub(super) m: i32,
    pub(super) pair: usize,
    pub(super) conjugate: bool,
    pub(super) factor: [f64; 2],
}

impl Predictor {
    /// The terms at m >= 0 of a motion.
    pub(super) fn terms(&mut self, motion: &Motion) -> Vec<Term> {
        let (reach, orbits) = (reach(motion), motion.orbits());
        let l_max = self.l_max();
        let [phi_o, phi_a, phi_b] = motion.phases();
        let mut terms = Vec::new();
        for m in 0..=l_max {
            let nu = f64::from(m) * orbits;
            let factor = sinc(PI * nu);
            if factor.abs() > 1e-12 {
                let (sin, cos) = (-PI * nu - f64::from(m) * phi_o).sin_cos();
                let factor = [factor * cos, factor * sin];
                terms.push(Term { m, pair: SMOOTH, conjugate: false, factor });
            }
        }
        let step = from_polar(-PI * orbits - phi_o);
        let mut sizes = Vec::new();
        for pair in self.pairs_standing(motion, f64::from(l_max) + reach, |_, _| 0.0) {
            let (k, j) = (self.pairs[pair].k, self.pairs[pair].j);
            let m_star = motion.standing(k, j);
            let phase = f64::from(k) * phi_a + f64::from(j) * phi_b;
            coefficients(&mut sizes, m_star, orbits, reach);
            let first = m_star.round() - reach.ceil();
            let start = -PI * orbits * (first - m_star) - phi_o * first - phase;
            let mut factor = from_polar(start);
            for (m, size) in whole_from(first).zip(&sizes) {
                // A conjugate's term at -m is the conjugate.
                if (0..=l_max).contains(&m) {
                    let factor = factor.map(|it| it * size);
                    terms.push(Term { m, pair, conjugate: false, factor });
                }
                if (-l_max..=0).contains(&m) {
                    let factor = [factor[0] * size, -factor[1] * size];
                    terms.push(Term { m: -m, pair, conjugate: true, factor });
                }
                factor = times(factor, step);
            }
        }
        terms.sort_by_key(|term| (term.m, term.pair, term.conjugate));
        terms
    }

    /// What a motion's hits look like.
    pub fn predict(&mut self, motion: &Motion) -> Prediction {
        let terms = self.terms(motion);
        let mut powers: BTreeMap<usize, f64> = BTreeMap::new();
        let mut interference = 0.0;
        for same_m in terms.chunk_by(|a, b| a.m == b.m) {
            let Some(m) = same_m.first().map(|it| it.m) else { continue };
            let sides = if m == 0 { 1.0 } else { 2.0 };
            let mut strengths = Vec::with_capacity(same_m.len());
            for term in same_m {
                let [re, im] = term.factor;
                let power = (re * re + im * im) * self.pair_power(term.pair, m);
                *powers.entry(term.pair).or_default() += sides * power;
                strengths.push(power);
            }
            for (i, a) in same_m.iter().enumerate() {
                for (b, strength) in same_m.iter().zip(&strengths).skip(i + 1) {
                    if 4.0 * (strengths[i] * strength).sqrt() < NEGLIGIBLE {
                        continue;
                    }
                    let coherent = a.factor[0] * b.factor[0] + a.factor[1] * b.factor[1];
                    interference += 2.0 * sides * coherent * self.product(a, b);
                }
            }
        }
        let smooth_variance = powers.remove(&SMOOTH).unwrap_or(0.0);
        let mut resonances: Vec<Resonance> = powers
            .iter()
            .map(|(&at, &power)| {
                let Pair { k, j, .. } = self.pairs[at];
                Resonance { k, j, m_star: motion.standing(k, j), power }
            })
            .collect();
        resonances.sort_by(|a, b| b.power.total_cmp(&a.power));
        let resonant: f64 = powers.values().sum();
        let beyond_variance = self.beyond(motion);
        Prediction {
            variance: smooth_variance + resonant + interference + beyond_variance,
            smooth_variance,
            beyond_variance,
            resonances,
        }
    }

    /// Variance at degrees beyond the last: a line that is scanned at angular speed v has at high l the
    /// power `2 / (l v T)`.
    pub(super) fn beyond(&self, motion: &Motion) -> f64 {
        let slowness = motion.mean_slowness(self.alpha_rad, self.beta_rad);
        4.0 * slowness / motion.duration_s * self.window.powers_beyond()
    }

    /// `sum_l` of the product of two terms' real amplitudes at the same m.
    fn product(&mut self, a: &Term, b: &Term) -> f64 {
        let [even, odd] = self.products(a.m, a.pair, b.pair);
        let flips = [a, b]
            .iter()
            .filter(|it| it.conjugate && (it.m + self.pairs[it.pair].k) % 2 != 0)
            .count();
        let product = if a.conjugate == b.conjugate { even + odd } else { even - odd };
        if flips % 2 == 0 { product } else { -product }
    }

    /// `sqrt(2l + 1) w_l d_mk(90 deg) d_kj(alpha) d_j0(beta)` of a term.
    pub(super) fn amplitudes(&self, term: &Term) -> Vec<f64> {
        let pair = &self.pairs[term.pair];
        let mut row = wigner_d(term.m, pair.k, FRAC_PI_2, self.window.l_max());
        // d_m(-k)(90) = (-1)^(l+m) d_mk(90), d_(-k)(-j) = (-1)^(k-j) d_kj, d_(-j)0 = (-1)^j d_j0
        let mut negative = term.conjugate && (term.m + pair.k) % 2 != 0;
        for (value, amplitude) in row.iter_mut().zip(&pair.amplitudes) {
            *value *= if negative { -amplitude } else { *amplitude };
            negative ^= term.conjugate;
        }
        row
    }
}

/// Whole numbers upwards.
fn whole_from(first: f64) -> impl Iterator<Item = i32> {
    #[expect(clippy::cast_possible_truncation, reason = "a few degrees beyond l_max")]
    let first = first as i32;
    first..
}

#[cfg(test)]
mod tests {
    use super::super::predictor::visible;
    use super::super::window::Window;
    use super::*;
    use crate::healpix::Nside;

    fn litebird() -> Predictor {
        let window = Window::pixel(Nside::new(128).unwrap()).unwrap();
        Predictor::new(45_f64.to_radians(), 50_f64.to_radians(), window)
    }

    /// The paper's scan of 401 precession periods, in minutes with `sigma_hits / mean`.
    fn scan() -> Vec<(f64, f64)> {
        let mut predictor = litebird();
        (0..401)
            .map(|i| 192.0 + 0.0025 * f64::from(i))
            .map(|minutes| {
                (minutes, predictor.predict(&Motion::year(minutes * 60.0, 1200.0)).sigma())
            })
            .collect()
    }

    #[test]
    fn resonances_stand_where_simulations_find_them() {
        let scan = scan();
        let within = |low: f64, high: f64| {
            scan.iter()
                .filter(|(minutes, _)| (low - 1e-9..=high + 1e-9).contains(minutes))
                .fold((0.0, 0.0), |best, &it| if it.1 > best.1 { it } else { best })
        };
        let global = within(192.0, 193.0);
        assert!((global.0 - 192.0825).abs() < 0.0026, "{global:?}");
        for expected in [192.0825, 192.225, 192.3025, 192.39, 192.4175, 192.5825, 192.645, 192.81] {
            let found = within(expected - 0.015, expected + 0.015);
            assert!((found.0 - expected).abs() < 0.0076, "{expected}: {found:?}");
        }
        let worst_of = |window: &[(f64, f64)]| window.iter().fold(0.0_f64, |a, it| a.max(it.1));
        let best = scan
            .windows(21)
            .min_by(|a, b| worst_of(a).total_cmp(&worst_of(b)))
            .map(|it| it[0].0)
            .unwrap();
        assert!((192.31 - 1e-9..=192.325 + 1e-9).contains(&best), "{best}");
    }

    #[test]
    fn commensurability_depends_on_the_start() {
        let mut predictor = litebird();
        let motion = Motion::year(192.0 * 60.0, 1200.0);
        for (precession_phase_rad, expected) in [(0.0, 0.27645), (0.032_724_9, 0.25389)] {
            let sigma = predictor.predict(&Motion { precession_phase_rad, ..motion }).sigma();
            // Simulated at 19 Hz.
            assert!((sigma / expected - 1.0).abs() < 5e-3, "{sigma} {expected}");
        }
    }

    #[test]
    fn halves_sum_to_the_whole() {
        let mut predictor = litebird();
        for minutes in [192.0, 192.0825, 192.348] {
            let motion = Motion::year(minutes * 60.0, 1200.0);
            let variance = predictor.predict(&motion).variance;
            let halves = predictor.hemispheres(&motion);
            let mean = f64::midpoint(halves.north.powi(2), halves.south.powi(2));
            assert!((mean / variance - 1.0).abs() < 2e-3, "{halves:?} {variance}");
        }
    }

    #[test]
    fn right_angles_and_zeros_are_legal() {
        let window = Window::pixel(Nside::new(16).unwrap()).unwrap();
        for (alpha, beta) in [(0.0, 90.0), (45.0, 90.0), (0.0, 50.0), (90.0, 0.0)] {
            let mut predictor =
                Predictor::new(f64::to_radians(alpha), f64::to_radians(beta), window.clone());
            let found = predictor.predict(&Motion::year(11_541.0, 1200.0));
            assert!(found.variance.is_finite() && found.variance > 0.0, "{found:?}");
        }
    }

    /// All `p / q` in lowest terms with p and q to `most`, by descent of the Stern-Brocot tree.
    fn stern_brocot(most: i32) -> Vec<[i32; 2]> {
        let mut found = Vec::new();
        let mut open = vec![([0, 1], [1, 0])];
        while let Some((low, high)) = open.pop() {
            let middle: [i32; 2] = [low[0] + high[0], low[1] + high[1]];
            if middle[0] <= most && middle[1] <= most {
                found.push(middle);
                open.extend([(low, middle), (middle, high)]);
            }
        }
        found
    }

    #[test]
    fn pairs_are_the_trees_fractions_and_their_multiples() {
        let mut predictor = litebird();
        let l_max = predictor.l_max();
        let motion = Motion::year(192.348 * 60.0, 1200.0);
        let limit = f64::from(l_max) + 3.0;
        let mut expected: Vec<[i32; 2]> = Vec::new();
        for [p, q] in stern_brocot(l_max) {
            let multiples = (1..=l_max / p.max(q)).map(|n| [n * p, -n * q]);
            expected.extend(multiples.filter(|&[k, j]| motion.standing(k, j).abs() <= limit));
        }
        expected.retain(|&[k, j]| {
            visible(predictor.alpha_rad, predictor.beta_rad, [k, j, l_max])
                && predictor.pair(k, j).is_some()
        });
        expected.sort_unstable();
        let mut found: Vec<[i32; 2]> = predictor
            .pairs_standing(&motion, limit, |_, _| 0.0)
            .into_iter()
            .map(|pair| [predictor.pairs[pair].k, predictor.pairs[pair].j])
            .collect();
        found.sort_unstable();
        assert_eq!(found, expected);
        assert!(found.len() > 20, "{}", found.len());
    }
}
