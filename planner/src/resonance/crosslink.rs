//! How evenly each pixel's crossing angles are spread, without a half-wave plate.
//!
//! The orientation function of spin n is `h_n = S_n / N`, S_n the sum over a pixel's samples of
//! `exp(-i n psi)` and N their number; of it the mean of `|h_n|^2` over the sky. Both sums are
//! fields on the sphere, their harmonics time averages of Wigner's D, [`mean_of_d`]:
//!
//! `S_n(theta, phi) = sum_lm (2l + 1) w_l A^(n)_lm d^l_mn(theta) exp(i m phi)`, `N = S_0`, mean 1.
//!
//! Method: the terms of [`super::power`] that matter are summed over l on rings and over m along
//! them; the other half of each spectrum is `A^(n)_(l,-m) = (-1)^(m - n) conj A^(-n)_lm`. What
//! `|S_n / N|^2` has in the mean is split: without resonances it depends on theta alone and is
//! averaged over fine rings, what resonances add over coarser ones.
//!
//! Limits: those of [`super::power`]; pixels are an isotropic window and keep a mean direction. No
//! prediction where pixels are unobserved, or nearly so (see [`Predictor::crosslinks`]). Means
//! within 2% of simulation (`tests/tests/crosslink.rs`).

use super::motion::Motion;
use super::power::{Predictor, SMOOTH, Term, sinc};
use super::ring_sums::{COLUMNS, Columns, Complex, Longitudes, Rings, to_f64};
use super::wigner::wigner_d;
use std::collections::BTreeMap;
use super::window::DEGREES_PER_NSIDE;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The mean over the sky of one orientation function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crosslink {
    /// The spin n.
    pub order: u32,
    /// Mean of `|h_n|^2`.
    pub mean: f64,
    /// The same without any (k, j) but (0, 0).
    pub smooth_mean: f64,
}

/// Hits over their mean below which a place counts as unobserved.
pub const LEAST_HITS: f64 = 0.05;
/// Largest order.
pub const MAX_ORDER: u32 = 64;
/// Terms whose power in the hits is below it are left out.
const NEGLIGIBLE_TERM: f64 = 1e-8;
/// Degrees of the window for each ring of the resonant part.
const DEGREES_PER_RING: usize = 3;
/// Where no more m than these count, twice as many degrees and a ring for each are taken.
const FEW_M: usize = 24;
/// Longitudes along a ring.
const LONGITUDES_PER_NSIDE: usize = 4;
/// Departure of angles from full coverage that is rounding, in radians.
const ROUNDING_RAD: f64 = 1e-9;

/// `A^(n)_lm`, the time average of `D^l_mn(R(t))` over the survey, all (k, j) of it: real and
/// imaginary part.
#[must_use]
pub fn mean_of_d(motion: &Motion, [alpha_rad, beta_rad]: [f64; 2], [l, m, n]: [i32; 3]) -> Complex {
    let Ok(at) = usize::try_from(l) else { return [0.0; 2] };
    let d = |m: i32, n: i32, angle_rad: f64| wigner_d(m, n, angle_rad, at).pop().unwrap_or(0.0);
    let [phi_o, phi_a, phi_b] = motion.phases();
    let mut sum = [0.0; 2];
    for k in -l..=l {
        let first = d(m, k, FRAC_PI_2);
        for j in -l..=l {
            let nu = (f64::from(m) - motion.standing(k, j)) * motion.orbits();
            let size = first * d(k, j, alpha_rad) * d(j, n, beta_rad) * sinc(PI * nu);
            let phase = f64::from(m) * phi_o + f64::from(k) * phi_a + f64::from(j) * phi_b;
            let (sin, cos) = (-PI * nu - phase).sin_cos();
            sum = [sum[0] + size * cos, sum[1] + size * sin];
        }
    }
    sum
}

/// Real and imaginary parts on rings, one after the other, of the fields of several spins.
type Fields = Vec<Vec<Complex>>;
/// Coefficients by l of the fields of several spins: of m real and imaginary, of -m likewise.
type Spectra = Vec<Vec<Columns>>;
/// `d^l_jn(beta)` by j and n.
type Spins = BTreeMap<(i32, i32), Vec<f64>>;

impl Predictor {
    /// The means of `|h_n|^2` of a motion, in the order asked for, each of 1 to [`MAX_ORDER`].
    ///
    /// `None` where some direction is not observed. The ecliptic's poles are not where
    /// `|alpha - beta| > 90 deg` or alpha + beta is not between 90 and 270 deg; and N falls below
    /// [`LEAST_HITS`] on surveys much shorter than a year and at strong resonances. Also for an order
    /// that is not legal.
    pub fn crosslinks(&mut self, motion: &Motion, orders: &[u32]) -> Option<Vec<Crosslink>> {
        let (sum, difference) = (self.alpha_rad + self.beta_rad, self.alpha_rad - self.beta_rad);
        let poles_seen = (FRAC_PI_2 - ROUNDING_RAD..=3.0 * FRAC_PI_2 + ROUNDING_RAD).contains(&sum)
            && difference.abs() <= FRAC_PI_2 + ROUNDING_RAD;
        if !poles_seen || orders.iter().any(|order| !(1..=MAX_ORDER).contains(order)) {
            return None;
        }
        let terms = self.kept_terms(motion);
        if terms.chunk_by(|a, b| a.m == b.m).count() <= FEW_M
            && let Some(window) = self.window().doubled()
        {
            let mut wide = Self::new(self.alpha_rad, self.beta_rad, window);
            let terms = wide.kept_terms(motion);
            let rings = Rings::new(wide.window().l_max());
            return wide.means(motion, orders, (&terms, &rings));
        }
        let rings = Rings::new(self.window().l_max() / DEGREES_PER_RING);
        self.means(motion, orders, (&terms, &rings))
    }

    /// The terms that count, sorted by m.
    fn kept_terms(&mut self, motion: &Motion) -> Vec<Term> {
        let mut terms = self.terms(motion);
        terms.retain(|term| {
            let [re, im] = term.factor;
            let power = (re * re + im * im) * self.pair_power(term.pair, term.m);
            (term.pair == SMOOTH && term.m == 0) || power > NEGLIGIBLE_TERM
        });
        terms
    }

    fn means(
        &self,
        motion: &Motion,
        orders: &[u32],
        (terms, rings): (&[Term], &Rings),
    ) -> Option<Vec<Crosslink>> {
        let orders_signed = orders.iter().filter_map(|&n| i32::try_from(n).ok());
        let spins: Vec<i32> = std::iter::once(0).chain(orders_signed).collect();
        let l_max = self.window().l_max();
        let fine = Rings::new(2 * l_max);
        let longitudes = Longitudes::new(LONGITUDES_PER_NSIDE * l_max / DEGREES_PER_NSIDE);
        let smooth_fields = self.smooth_fields(&spins, &fine);
        let smooth = mean_squares(&fine, &smooth_fields)?;
        let coarse = mean_squares(rings, &self.smooth_fields(&spins, rings))?;
        let total = mean_squares(rings, &self.fields(terms, &spins, (rings, &longitudes)))?;
        let beyond = self.beyond_last_degree(motion, &fine, &smooth_fields);
        let resonant = total.iter().zip(&coarse).zip(&beyond).map(|((a, b), c)| a - b + c);
        let means = orders.iter().zip(smooth).zip(resonant);
        Some(
            means
                .map(|((&order, smooth_mean), resonant)| Crosslink {
                    order,
                    mean: (smooth_mean + resonant).clamp(0.0, 1.0),
                    smooth_mean,
                })
                .collect(),
        )
    }

    /// What degrees beyond the last add to each mean: there the crossings of a pixel are independent.
    fn beyond_last_degree(&self, motion: &Motion, rings: &Rings, smooth: &Fields) -> Vec<f64> {
        let Some((hits, sums)) = smooth.split_first() else { return Vec::new() };
        let per_nside = self.window().nside().map_or(0.0, |nside| {
            let last = to_f64(self.window().l_max()) / f64::from(nside.get());
            tail(last) * f64::from(nside.get())
        });
        let speed = mean_slowness(motion, [self.alpha_rad, self.beta_rad]);
        let variance = 4.0 * speed / motion.duration_s * per_nside;
        let added = |sums: &Vec<Complex>| {
            let rings = rings.shares().zip(hits).zip(sums);
            rings
                .map(|((share, hits), sum)| {
                    share * variance / hits[0] * (1.0 - (sum[0] / hits[0]).powi(2))
                })
                .sum()
        };
        sums.iter().map(added).collect()
    }

    /// The fields without resonances, one value a ring.
    fn smooth_fields(&self, spins: &[i32], rings: &Rings) -> Fields {
        let term = Term { m: 0, pair: SMOOTH, conjugate: false, factor: [1.0, 0.0] };
        let mut spectra = self.empty_spectra(spins);
        self.add_term(&term, spins, &mut Spins::new(), &mut spectra);
        let sums = rings.sums(self.window(), 0, spins, &spectra);
        sums.iter().map(|sums| sums.iter().map(|it| [it[0], it[1]]).collect()).collect()
    }

    /// The fields of all terms, ring by ring at all longitudes.
    fn fields(
        &self,
        terms: &[Term],
        spins: &[i32],
        (rings, longitudes): (&Rings, &Longitudes),
    ) -> Fields {
        let mut fields = vec![vec![[0.0; 2]; rings.count() * longitudes.count()]; spins.len()];
        let mut rows = Spins::new();
        for same_m in terms.chunk_by(|a, b| a.m == b.m) {
            let Some(m) = same_m.first().map(|it| it.m) else { continue };
            let mut spectra = self.empty_spectra(spins);
            for term in same_m {
                self.add_term(term, spins, &mut rows, &mut spectra);
            }
            let sums = rings.sums(self.window(), m, spins, &spectra);
            for (sums, field) in sums.iter().zip(&mut fields) {
                for (row, sum) in field.chunks_exact_mut(longitudes.count()).zip(sums) {
                    add(row, longitudes.bin(m), [sum[0], sum[1]]);
                }
                // What counts at -m was summed on the mirrored rings.
                let mirrored = sums.iter().rev().filter(|_| m > 0);
                for (row, sum) in field.chunks_exact_mut(longitudes.count()).zip(mirrored) {
                    add(row, longitudes.bin(-m), [sum[2], sum[3]]);
                }
            }
        }
        for field in &mut fields {
            for row in field.chunks_exact_mut(longitudes.count()) {
                longitudes.transform(row);
            }
        }
        fields
    }

    fn empty_spectra(&self, spins: &[i32]) -> Spectra {
        vec![vec![[0.0; COLUMNS]; self.window().weights().len()]; spins.len()]
    }

    /// `2l + 1` times a term's share of `A^(n)_lm`, and of `A^(n)_(l,-m)` with the sign of the
    /// mirrored function, `(-1)^(l + n)`.
    fn add_term(&self, term: &Term, spins: &[i32], rows: &mut Spins, spectra: &mut Spectra) {
        let l_max = self.window().l_max();
        let [k, j] = self.frequencies(term);
        let mut common = wigner_d(term.m, k, FRAC_PI_2, l_max);
        let tilt = wigner_d(k, j, self.alpha_rad, l_max);
        let mut l = 0.0_f64;
        for (value, tilt) in common.iter_mut().zip(tilt) {
            *value *= (2.0 * l + 1.0) * tilt;
            l += 1.0;
        }
        let [re, im] = term.factor;
        for (spectrum, &n) in spectra.iter_mut().zip(spins) {
            for n in [n, -n] {
                rows.entry((j, n)).or_insert_with(|| wigner_d(j, n, self.beta_rad, l_max));
            }
            let row = |n| rows.get(&(j, n)).map_or(&[][..], Vec::as_slice);
            // (-1)^(l + n) (-1)^(m - n)
            let mut sign = if term.m % 2 == 0 { 1.0 } else { -1.0 };
            let degrees = common.iter().zip(row(n)).zip(row(-n));
            for (columns, ((common, d), mirrored)) in spectrum.iter_mut().zip(degrees) {
                let (plus, minus) = (common * d, sign * common * mirrored);
                columns[0] += plus * re;
                columns[1] += plus * im;
                columns[2] += minus * re;
                columns[3] -= minus * im;
                sign = -sign;
            }
        }
    }

    /// k and j of a term.
    fn frequencies(&self, term: &Term) -> [i32; 2] {
        let sign = if term.conjugate { -1 } else { 1 };
        self.pairs.get(term.pair).map_or([0; 2], |pair| [sign * pair.k, sign * pair.j])
    }
}

/// `int w^2(x) dx` over `x = l / nside` from 6, and from 12; in between and beyond `x^-2` of it.
const TAILS: [(f64, f64); 2] = [(6.0, 0.0888), (12.0, 0.0250)];

/// `int w^2(x) dx` from x.
fn tail(x: f64) -> f64 {
    let [(six, from_six), (twelve, from_twelve)] = TAILS;
    if x < f64::midpoint(six, twelve) {
        from_six * (six / x).powi(2)
    } else {
        from_twelve * (twelve / x).powi(2)
    }
}

/// Mean of the inverse of the line of sight's angular speed, in s/rad, the orbit aside.
fn mean_slowness(motion: &Motion, [alpha_rad, beta_rad]: [f64; 2]) -> f64 {
    let (sin, cos) = alpha_rad.sin_cos();
    let precession = TAU / motion.precession_period_s;
    let spin = TAU / motion.spin_period_s;
    // Both rates' vector in the frame of the spin axis.
    let [x, z] = [-precession * sin, spin + precession * cos];
    let slowness = |i: u32| {
        let (sin, cos) = (TAU * (f64::from(i) + 0.5) / f64::from(SPEEDS)).sin_cos();
        let n = [beta_rad.sin() * cos, beta_rad.sin() * sin, beta_rad.cos()];
        let speed = [-z * n[1], z * n[0] - x * n[2], x * n[1]];
        1.0 / speed.iter().map(|v| v * v).sum::<f64>().sqrt()
    };
    (0..SPEEDS).map(slowness).sum::<f64>() / f64::from(SPEEDS)
}

/// Spin phases over which speeds are averaged.
const SPEEDS: u32 = 64;

fn add(row: &mut [Complex], at: usize, value: Complex) {
    if let Some(cell) = row.get_mut(at) {
        *cell = [cell[0] + value[0], cell[1] + value[1]];
    }
}

/// The means over the sphere of `|S / N|^2`, N the first field and S each other; `None` where N is
/// too small somewhere.
fn mean_squares(rings: &Rings, fields: &Fields) -> Option<Vec<f64>> {
    let (hits, others) = fields.split_first()?;
    let along = hits.len() / rings.count();
    let shares: Vec<f64> = rings.shares().map(|share| share / to_f64(along)).collect();
    if hits.iter().any(|&[hits, _]| hits.is_nan() || hits < LEAST_HITS) {
        return None;
    }
    let mean = |field: &Vec<Complex>| {
        let rows = field.chunks_exact(along).zip(hits.chunks_exact(along)).zip(&shares);
        let row = |((sums, hits), share): ((&[Complex], &[Complex]), &f64)| {
            let squares = sums.iter().zip(hits).map(|(sum, hits)| {
                ((sum[0] * sum[0] + sum[1] * sum[1]) / (hits[0] * hits[0])).min(1.0)
            });
            share * squares.sum::<f64>()
        };
        rows.map(row).sum()
    };
    Some(others.iter().map(mean).collect())
}
