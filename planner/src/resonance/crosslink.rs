//! How evenly each pixel's crossing angles are spread, without a half-wave plate.
//!
//! The orientation function of spin n is `h_n = S_n / N`, `S_n` the sum over a pixel's samples of
//! `exp(-i n psi)` and N their number; of it the mean of `|h_n|^2` over the sky. Both sums are
//! fields on the sphere, their harmonics time averages of Wigner's D, [`mean_of_d`]:
//!
//! `S_n(theta, phi) = sum_lm (2l + 1) w_l A^(n)_lm d^l_mn(theta) exp(i m phi)`, `N = S_0`, mean 1.
//!
//! Method: the terms of [`super::power`] that matter are summed over l on rings and over m along
//! them; the other half of each spectrum is `A^(n)_(l,-m) = (-1)^(m - n) conj A^(-n)_lm`. What
//! `|S_n / N|^2` has in the mean is split: without resonances it depends on theta alone and is
//! averaged over fine rings, what resonances add over coarser ones. Weak terms, and degrees beyond
//! the window's last, are taken for independent crossings: a variance V of the hits adds
//! `V (1 - |h|^2) / N`. Where few m count, as at exact commensurability, degrees are doubled.
//!
//! Limits: those of [`super::power`]; a pixel keeps one meridian. No prediction where pixels are
//! unobserved, or nearly so (see [`Predictor::crosslinks`]). Means within 2% of simulation
//! (`tests/tests/crosslink.rs`).

use super::coefficients::sinc;
use super::motion::Motion;
use super::power::Term;
use super::predictor::{Predictor, SMOOTH};
use super::ring_sums::{COLUMNS, Columns, Complex, Longitudes, Rings, to_f64};
use crate::harmonics::wigner::wigner_d;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

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
pub const LEAST_HITS: f64 = 0.02;
/// Largest order.
pub const MAX_ORDER: u32 = 64;
/// Terms whose power in the hits is below it count as independent crossings.
const WEAK_TERM: f64 = 1e-6;
/// Degrees of the window for each ring of the resonant part.
const DEGREES_PER_RING: usize = 3;
/// Where no more m than these count, twice as many degrees and a ring for each are taken.
const FEW_M: usize = 12;
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

/// A motion's terms.
#[derive(Debug, Clone)]
struct Kept {
    terms: Vec<Term>,
    /// The hits' variance in the others.
    rest: f64,
}

/// Where fields are evaluated: without resonances on fine rings, with them on others.
#[derive(Debug, Clone)]
struct Grid {
    fine: Rings,
    rings: Rings,
    longitudes: Longitudes,
}

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
        let kept = self.kept_terms(motion);
        let l_max = self.window().l_max();
        let fine = Rings::new(2 * l_max);
        if kept.terms.chunk_by(|a, b| a.m == b.m).count() <= FEW_M
            && let Some(window) = self.window().doubled()
        {
            let mut wide = Self::new(self.alpha_rad, self.beta_rad, window);
            let kept = wide.kept_terms(motion);
            let grid =
                Grid { fine, rings: Rings::new(l_max), longitudes: Longitudes::new(l_max / 6) };
            return wide.means(motion, orders, (&kept, &grid));
        }
        let rings = Rings::new(l_max / DEGREES_PER_RING);
        let longitudes = Longitudes::new(2 * l_max / DEGREES_PER_RING);
        self.means(motion, orders, (&kept, &Grid { fine, rings, longitudes }))
    }

    /// The terms that count one by one, sorted by m.
    fn kept_terms(&mut self, motion: &Motion) -> Kept {
        let mut terms = self.terms(motion);
        let mut rest = 0.0;
        terms.retain(|term| {
            let [re, im] = term.factor;
            let power = (re * re + im * im) * self.pair_power(term.pair, term.m);
            let keep = (term.pair == SMOOTH && term.m == 0) || power > WEAK_TERM;
            if !keep {
                rest += if term.m == 0 { power } else { 2.0 * power };
            }
            keep
        });
        Kept { terms, rest }
    }

    fn means(
        &self,
        motion: &Motion,
        orders: &[u32],
        (kept, grid): (&Kept, &Grid),
    ) -> Option<Vec<Crosslink>> {
        let orders_signed = orders.iter().filter_map(|&n| i32::try_from(n).ok());
        let spins: Vec<i32> = std::iter::once(0).chain(orders_signed).collect();
        let patch = self.window().nside().map_or_else(
            || 4.0 / to_f64(self.window().l_max()).powi(2),
            |nside| 1.0 / f64::from(nside.pixels()),
        );
        let smooth_fields = self.smooth_fields(&spins, &grid.fine);
        let smooth = mean_squares(&grid.fine, &smooth_fields, patch)?;
        let coarse = mean_squares(&grid.rings, &self.smooth_fields(&spins, &grid.rings), patch)?;
        let total = mean_squares(&grid.rings, &self.fields(&kept.terms, &spins, grid), patch)?;
        let incoherent = kept.rest + self.beyond(motion);
        let others = independent(&grid.fine, &smooth_fields, incoherent);
        let resonant = total.iter().zip(&coarse).zip(&others).map(|((a, b), c)| a - b + c);
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

    /// The fields without resonances, one value a ring.
    fn smooth_fields(&self, spins: &[i32], rings: &Rings) -> Fields {
        let term = Term { m: 0, pair: SMOOTH, conjugate: false, factor: [1.0, 0.0] };
        let mut spectra = self.empty_spectra(spins);
        self.add_term(&term, spins, &mut Spins::new(), &mut spectra);
        let sums = rings.sums(self.window(), 0, spins, &spectra);
        sums.iter().map(|sums| sums.iter().map(|it| [it[0], it[1]]).collect()).collect()
    }

    /// The fields of all terms, ring by ring at all longitudes.
    fn fields(&self, terms: &[Term], spins: &[i32], grid: &Grid) -> Fields {
        let (rings, longitudes) = (&grid.rings, &grid.longitudes);
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

fn add(row: &mut [Complex], at: usize, value: Complex) {
    if let Some(cell) = row.get_mut(at) {
        *cell = [cell[0] + value[0], cell[1] + value[1]];
    }
}

/// The means over the sphere of `|S / N|^2`, N the first field and S each other; `None` where N is
/// too small over more than `patch` of the sphere.
fn mean_squares(rings: &Rings, fields: &Fields, patch: f64) -> Option<Vec<f64>> {
    let (hits, others) = fields.split_first()?;
    let along = hits.len() / rings.count();
    let shares: Vec<f64> = rings.shares().map(|share| share / to_f64(along)).collect();
    let seen = |hits: &Complex| hits[0] >= LEAST_HITS;
    let rows = hits.chunks_exact(along).zip(&shares);
    let unseen: f64 = rows
        .map(|(row, share)| row.iter().filter(|hits| !seen(hits)).map(|_| share).sum::<f64>())
        .sum();
    if unseen > patch {
        return None;
    }
    let mean = |field: &Vec<Complex>| {
        let rows = field.chunks_exact(along).zip(hits.chunks_exact(along)).zip(&shares);
        let row = |((sums, hits), share): ((&[Complex], &[Complex]), &f64)| {
            let squares =
                sums.iter().zip(hits).filter(|(_, hits)| seen(hits)).map(|(sum, hits)| {
                    ((sum[0] * sum[0] + sum[1] * sum[1]) / (hits[0] * hits[0])).min(1.0)
                });
            share * squares.sum::<f64>()
        };
        rows.map(row).sum()
    };
    Some(others.iter().map(mean).collect())
}

/// What a variance of the hits by independent crossings adds to the means of smooth fields.
fn independent(rings: &Rings, smooth: &Fields, variance: f64) -> Vec<f64> {
    let Some((hits, others)) = smooth.split_first() else { return Vec::new() };
    let added = |sums: &Vec<Complex>| {
        let rows =
            rings.shares().zip(hits).zip(sums).filter(|((_, hits), _)| hits[0] >= LEAST_HITS);
        let ring = |((share, hits), sum): ((f64, &Complex), &Complex)| {
            share * variance / hits[0] * (1.0 - (sum[0] / hits[0]).powi(2))
        };
        rows.map(ring).sum()
    };
    others.iter().map(added).collect()
}

#[cfg(test)]
mod tests {
    use super::super::window::Window;
    use super::*;
    use std::f64::consts::TAU;

    /// Whole numbers of turns: no term but those that stand still.
    fn whole_turns() -> Motion {
        Motion {
            precession_phase_rad: 0.4,
            spin_phase_rad: -1.1,
            longitude_rad: 2.0,
            ..Motion::year(
                super::super::motion::YEAR_S / 12.0,
                -super::super::motion::YEAR_S / 37.0,
            )
        }
    }

    #[test]
    fn fields_are_the_sums_of_their_harmonics() {
        let (motion, angles) = (whole_turns(), [0.8, 0.9]);
        let window = Window::beam(0.8).unwrap();
        let weights = window.weights().to_vec();
        let mut predictor = Predictor::new(angles[0], angles[1], window);
        let (rings, longitudes) = (Rings::new(8), Longitudes::new(32));
        let grid = Grid { fine: rings.clone(), rings, longitudes };
        let terms = predictor.terms(&motion);
        let fields = predictor.fields(&terms, &[0, 2, 3], &grid);
        for (n, field) in [0, 2, 3].into_iter().zip(&fields) {
            let mut harmonics = Vec::new();
            for (l, w) in (0..).zip(&weights) {
                for m in -l..=l {
                    let [re, im] = mean_of_d(&motion, angles, [l, m, n]);
                    let weight = (2.0 * f64::from(l) + 1.0) * w;
                    harmonics.push(([l, m], [weight * re, weight * im]));
                }
            }
            for (ring, at) in [(0_usize, 0_usize), (1, 5), (4, 17), (6, 30)] {
                let theta = PI * (to_f64(ring) + 0.5) / 8.0;
                let mut expected = [0.0; 2];
                for &([l, m], [re, im]) in &harmonics {
                    let d = wigner_d(m, n, theta, usize::try_from(l).unwrap()).pop().unwrap();
                    let (sin, cos) = (f64::from(m) * TAU * to_f64(at) / 32.0).sin_cos();
                    expected[0] += d * (re * cos - im * sin);
                    expected[1] += d * (re * sin + im * cos);
                }
                let [re, im] = field[ring * 32 + at];
                let off = (re - expected[0]).hypot(im - expected[1]);
                assert!(off < 1e-6, "{n} {ring} {at}: {re} {im} {expected:?}");
            }
        }
    }

    /// `4 pi S_n` without resonances, a direct quadrature over the height of the spin axis.
    fn smooth_sum(order: u32, [alpha, beta]: [f64; 2], theta: f64) -> f64 {
        let (sin, cos) = theta.sin_cos();
        let mut x = [(alpha + beta).cos(), (alpha - beta).cos(), -sin, sin];
        x.sort_by(f64::total_cmp);
        let order = f64::from(order);
        let nodes = 4000;
        let sum: f64 = (0..nodes)
            .map(|i| {
                let node = (PI * (f64::from(i) + 0.5) / f64::from(nodes)).cos();
                let u = f64::midpoint(x[1], x[2]) + 0.5 * (x[2] - x[1]) * node;
                let rest = (1.0 - u * u).sqrt();
                let chi = ((alpha.cos() - u * beta.cos()) / (beta.sin() * rest)).clamp(-1.0, 1.0);
                let epsilon = (-u * cos / (sin * rest)).clamp(-1.0, 1.0);
                let angles = (order * chi.acos()).cos() * (order * epsilon.acos()).cos();
                angles / ((x[3] - u) * (u - x[0])).sqrt()
            })
            .sum();
        2.0 / (PI * f64::from(nodes)) * sum
    }

    #[test]
    fn smooth_fields_meet_quadrature() {
        let angles = [45_f64.to_radians(), 50_f64.to_radians()];
        let predictor = Predictor::new(angles[0], angles[1], Window::beam(0.006).unwrap());
        let rings = Rings::new(96);
        let spins = [0, 1, 2, 3, 4, 5, 6];
        let fields = predictor.smooth_fields(&spins, &rings);
        let edges = [(angles[0] + angles[1]).cos().abs(), (angles[0] - angles[1]).cos()];
        let mut compared = 0;
        for ring in 0..rings.count() {
            let theta = PI * (to_f64(ring) + 0.5) / to_f64(rings.count());
            // The beam rounds off the singularities.
            if edges.iter().any(|edge| (theta.sin().min(1.0).asin() - edge.asin()).abs() < 0.06) {
                continue;
            }
            compared += 1;
            for (n, field) in (0..).zip(&fields) {
                let [re, im] = field[ring];
                let expected = smooth_sum(n, angles, theta);
                let off = (re.hypot(im) - expected.abs()).abs();
                assert!(off < 2e-3, "{n} {theta}: {re} {im} {expected}");
            }
        }
        assert!(compared > 60, "{compared}");
    }
}
