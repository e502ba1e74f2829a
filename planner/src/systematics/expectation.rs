//! The mean spectra of a residual over all CMB skies, without a random sky.
//!
//! `dP = sum_k W_k X_k`, W the couplings of the survey, X fields of the CMB of spin s with coefficients
//! `t T + e E + i b B`, their conjugates among them. W has spin `2 - s`. With `w_k` the pixel-sum coefficients
//! of W, `d^l_(2,2)` and its like of the angle beta between two pixels,
//!
//! `C^EE_l + C^BB_l = 1/2 int d cos(beta) d^l_22 sum_kk' xi_kk' omega_kk'`,
//! `xi = sum_L (2L + 1)/(4 pi) C_L^kk' d^L_ss'`, `omega = sum_l' (sum_m' w_k conj w_k') d^l'_(2-s,2-s')`,
//!
//! and `C^EE - C^BB` the same with the conjugate of dP as the second, `d^l_(2,-2)`.
//!
//! Method: windows to the last degree of the residual and the sky's together, where the sum ends; the
//! integral by as many nodes of Gauss and Legendre as make it exact.
//!
//! Limits: exact for the pixel sum but for rounding (test `means_are_those_over_all_modes`). Pixels without
//! a solution have W = 0.

use super::cmb::CmbSpectra;
use super::residual::Coupling;
use super::signal::SkyField;
use crate::harmonics::quadrature::gauss_legendre;
use crate::harmonics::wigner::wigner_d;
use crate::harmonics::{Alm, Complex64, Rings, SpinAlm, TransformError, cross_spectrum, raising};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Mean spectra by l from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanSpectra {
    /// E.
    pub ee: Vec<f64>,
    /// B.
    pub bb: Vec<f64>,
}

/// A field of the sky with its window: `W X`, X of spin s.
#[derive(Debug, Clone)]
struct Part {
    spin: i32,
    /// t, e, b by L: coefficients of X are `t T + e E + i b B`.
    sky: [Vec<f64>; 3],
    /// Coefficients of W, of spin `2 - s` or, of the conjugate, `-2 - s`: `-(E + i B)`.
    window: SpinAlm,
    window_spin: i32,
}

impl Part {
    /// The conjugate of `W X`.
    fn conjugate(&self) -> Self {
        let sign = if self.spin % 2 == 0 { 1.0 } else { -1.0 };
        let [t, e, b] = &self.sky;
        let times = |of: &[f64], sign: f64| of.iter().map(|x| sign * x).collect();
        let SpinAlm { spin, e: window_e, b: window_b } = &self.window;
        let window = SpinAlm {
            spin: *spin,
            e: window_e.weighted(|_| sign),
            b: window_b.weighted(|_| -sign),
        };
        Self {
            spin: -self.spin,
            sky: [times(t, sign), times(e, sign), times(b, -sign)],
            window,
            window_spin: -self.window_spin,
        }
    }
}

/// The mean spectra of a residual to degree `l_max` over skies of `spectra`, which end at their last l.
///
/// # Errors
/// [`TransformError`] for degrees that are too large.
pub fn mean_spectra(
    coupling: &Coupling<'_>,
    rings: &Rings,
    spectra: &CmbSpectra,
    l_max: usize,
) -> Result<MeanSpectra, TransformError> {
    let sky_l_max = spectra.l_max();
    let parts = parts(coupling, rings, (sky_l_max, l_max + sky_l_max))?;
    let conjugates: Vec<Part> = parts.iter().map(Part::conjugate).collect();
    let sum = correlated(&parts, &parts, spectra, (l_max, 2));
    let difference = correlated(&parts, &conjugates, spectra, (l_max, -2));
    let half = |sign: f64| {
        sum.iter().zip(&difference).map(|(sum, other)| 0.5 * (sum + sign * other)).collect()
    };
    Ok(MeanSpectra { ee: half(1.0), bb: half(-1.0) })
}

/// The parts of dP, with windows to degree `window_l_max`.
fn parts(
    coupling: &Coupling<'_>,
    rings: &Rings,
    (sky_l_max, window_l_max): (usize, usize),
) -> Result<Vec<Part>, TransformError> {
    let fields = coupling.fields();
    let pixels = coupling.nside().pixels() as usize;
    let rows: Vec<Vec<[Complex64; 2]>> = (0..pixels)
        .into_par_iter()
        .map(|pixel| {
            let mut row = vec![[Complex64::ZERO; 2]; fields.len()];
            let solved = coupling.weights(pixel, &mut |field, [_, polarisation]| {
                for (to, weight) in row[field].iter_mut().zip(polarisation) {
                    *to += weight;
                }
            });
            if solved.is_err() {
                row.fill([Complex64::ZERO; 2]);
            }
            row
        })
        .collect();
    let mut parts = Vec::new();
    for (index, &field) in fields.iter().enumerate() {
        let spin = field.spin();
        let sky = sky_coefficients(field, sky_l_max);
        for conjugated in [false, true] {
            let window: Vec<Complex64> =
                rows.iter().map(|row| row[index][usize::from(conjugated)]).collect();
            if window.iter().all(|weight| weight.norm_sqr() < f64::MIN_POSITIVE) {
                continue;
            }
            let sign = if spin % 2 == 0 { 1.0 } else { -1.0 };
            let [t, e, b] = &sky;
            let times = |of: &[f64], sign: f64| of.iter().map(|x| sign * x).collect::<Vec<f64>>();
            let (spin, sky) = if conjugated {
                (-spin, [times(t, sign), times(e, sign), times(b, -sign)])
            } else {
                (spin, sky.clone())
            };
            let window_spin = 2 - spin;
            let window = window_alm(rings, &window, window_spin, window_l_max)?;
            parts.push(Part { spin, sky, window, window_spin });
        }
    }
    Ok(parts)
}

/// Coefficients of a window of either spin, as `-(E + i B)`.
fn window_alm(
    rings: &Rings,
    window: &[Complex64],
    spin: i32,
    l_max: usize,
) -> Result<SpinAlm, TransformError> {
    let size = usize::try_from(spin.unsigned_abs()).unwrap_or(usize::MAX);
    if spin >= 0 {
        return rings.alm(size, window, l_max, 0);
    }
    // The conjugate has spin -s, and coefficients (-1)^s times those with B of the other sign.
    let conjugate: Vec<Complex64> = window.iter().map(Complex64::conj).collect();
    let SpinAlm { e, b, .. } = rings.alm(size, &conjugate, l_max, 0)?;
    let sign = if spin % 2 == 0 { 1.0 } else { -1.0 };
    Ok(SpinAlm { spin: size, e: e.weighted(|_| sign), b: b.weighted(|_| -sign) })
}

/// t, e and b of a field.
fn sky_coefficients(field: SkyField, l_max: usize) -> [Vec<f64>; 3] {
    let none = vec![0.0; l_max + 1];
    let ladder = |from: i32, to: i32| -> Vec<f64> {
        let spins = if to >= from { from..to } else { to..from };
        let sign = if to < from && (from - to) % 2 != 0 { -1.0 } else { 1.0 };
        (0..=l_max)
            .map(|l| {
                let factor = |spin: i32| raising(usize::try_from(spin).unwrap_or(usize::MAX))(l);
                sign * spins.clone().map(factor).product::<f64>()
            })
            .collect()
    };
    match field {
        SkyField::Temperature(_) => [ladder(0, field.spin()), none.clone(), none],
        SkyField::Polarisation(_) => {
            // -(E + i B)
            let minus: Vec<f64> = ladder(2, field.spin()).iter().map(|x| -x).collect();
            [none, minus.clone(), minus]
        }
    }
}

/// `1/2 int d cos(beta) d^l_(2,second) sum xi omega` by l.
fn correlated(
    firsts: &[Part],
    seconds: &[Part],
    spectra: &CmbSpectra,
    (l_max, second): (usize, i32),
) -> Vec<f64> {
    let (sky_l_max, window_l_max) = (spectra.l_max(), l_max + spectra.l_max());
    // Per pair: spins of the sky with (2L + 1)/(4 pi) C_L, spins of the windows with their sums over m.
    let mut xi = BTreeMap::<[i32; 2], Vec<Vec<f64>>>::new();
    let mut omega = BTreeMap::<[i32; 2], Vec<Vec<f64>>>::new();
    let mut places = Vec::new();
    for first in firsts {
        for other in seconds {
            let sky = xi.entry([first.spin, other.spin]).or_default();
            sky.push(sky_powers(first, other, spectra));
            let windows = omega.entry([first.window_spin, other.window_spin]).or_default();
            windows.push(window_powers(&first.window, &other.window));
            let at = [sky.len() - 1, windows.len() - 1];
            places.push(([first.spin, other.spin], [first.window_spin, other.window_spin], at));
        }
    }
    let order = u32::try_from((sky_l_max + window_l_max + l_max) / 2 + 1).unwrap_or(u32::MAX);
    let node = |(t, weight): (f64, f64)| {
        // t in 0 to 1 is (1 + cos beta) / 2; weights sum to 1, so that int d cos = 2 sum.
        let beta = 2.0 * (1.0 - t).sqrt().min(1.0).asin();
        let sums = |table: &BTreeMap<[i32; 2], Vec<Vec<f64>>>, l_max: usize| {
            let mut to = BTreeMap::new();
            for (&[a, b], powers) in table {
                let d = wigner_d(a, b, beta, l_max);
                let sum =
                    |powers: &Vec<f64>| -> f64 { powers.iter().zip(&d).map(|(p, d)| p * d).sum() };
                to.insert([a, b], powers.iter().map(sum).collect::<Vec<f64>>());
            }
            to
        };
        let (sky, windows) = (sums(&xi, sky_l_max), sums(&omega, window_l_max));
        let z: f64 = places
            .iter()
            .map(|(spins, window_spins, [at, window_at])| {
                sky[spins][*at] * windows[window_spins][*window_at]
            })
            .sum();
        wigner_d(2, second, beta, l_max).into_iter().map(|d| weight * z * d).collect::<Vec<f64>>()
    };
    // Summed in their order, so that the number of threads does not change a bit.
    let rows: Vec<Vec<f64>> = gauss_legendre(order).into_par_iter().map(node).collect();
    let mut to = vec![0.0; l_max + 1];
    for row in rows {
        for (to, value) in to.iter_mut().zip(row) {
            *to += value;
        }
    }
    to
}

/// `(2L + 1)/(4 pi) <x_k conj x_k'>`.
fn sky_powers(first: &Part, other: &Part, spectra: &CmbSpectra) -> Vec<f64> {
    let ([t, e, b], [t2, e2, b2]) = (&first.sky, &other.sky);
    let mut orders = -1.0;
    (0..t.len())
        .map(|l| {
            orders += 2.0;
            let power = t[l] * t2[l] * spectra.tt[l]
                + (t[l] * e2[l] + e[l] * t2[l]) * spectra.te[l]
                + e[l] * e2[l] * spectra.ee[l]
                + b[l] * b2[l] * spectra.bb[l];
            orders / (4.0 * PI) * power
        })
        .collect()
}

/// The real part of `sum_m w_k conj w_k'`, m of both signs.
fn window_powers(first: &SpinAlm, other: &SpinAlm) -> Vec<f64> {
    let both = |a: &Alm, b: &Alm| cross_spectrum(a, b);
    let mut orders = -1.0;
    let sums = both(&first.e, &other.e).into_iter().zip(both(&first.b, &other.b));
    sums.map(|(e, b)| {
        orders += 2.0;
        orders * (e + b)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::super::effects::{Ellipticity, Pointing};
    use super::super::orientation::{Orientations, Polarimeter, moments};
    use super::super::signal::Effect;
    use super::super::sky::SkyAlms;
    use super::*;
    use crate::harmonics::Spectra;
    use crate::healpix::Nside;

    /// Orientation functions of a few made-up samples per pixel, one pixel without any.
    fn orientations(nside: Nside, terms: &[super::super::signal::Term]) -> Orientations {
        let pixels = nside.pixels();
        let functions = moments(terms, &Polarimeter::PLATE)
            .unwrap()
            .into_iter()
            .map(|moment| {
                let map = (0..pixels)
                    .map(|p| {
                        let sample = |k: u32| {
                            let (p, k) = (f64::from(p), f64::from(k));
                            let (psi, phi) = (0.7 * p + 1.3 * k * k, 0.9 * k + 0.2 * p * k);
                            Complex64::from_polar(1.0, -(moment.n() * psi + moment.m() * phi))
                        };
                        (0..7).map(sample).sum::<Complex64>() / 7.0
                    })
                    .collect();
                #[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
                ([moment.n() as i32, moment.m() as i32], map)
            })
            .collect();
        let mut hits = vec![7; pixels as usize];
        hits[5] = 0;
        Orientations::new(nside, hits, functions).unwrap()
    }

    #[test]
    fn means_are_those_over_all_modes() {
        let nside = Nside::new(4).unwrap();
        let rings = Rings::new(nside);
        let mut terms = Pointing { rho_rad: 0.01, chi_rad: 0.3 }.terms();
        terms.extend(Ellipticity { difference_rad2: 0.003, major_rad: 0.4 }.terms());
        let orientations = orientations(nside, &terms);
        let coupling = Coupling::new(&orientations, &terms, &Polarimeter::PLATE).unwrap();
        let (sky_l_max, l_max) = (5, 6);
        let powers = |scale: f64| -> Vec<f64> {
            (0..=5_u8).map(|l| if l < 2 { 0.0 } else { scale / f64::from(l * l) }).collect()
        };
        let spectra = CmbSpectra {
            tt: powers(100.0),
            ee: powers(3.0),
            bb: powers(0.5),
            te: powers(7.0),
            tensor_bb: Vec::new(),
        };
        let found = mean_spectra(&coupling, &rings, &spectra, l_max).unwrap();
        // The sum over modes: T with its share of E, the rest of E, B; real and imaginary.
        let mut expected = [vec![0.0; l_max + 1], vec![0.0; l_max + 1]];
        for l in 2..=sky_l_max {
            let correlated = spectra.te[l] / spectra.tt[l].sqrt();
            let kinds = [
                [spectra.tt[l].sqrt(), correlated, 0.0],
                [0.0, (spectra.ee[l] - correlated * correlated).sqrt(), 0.0],
                [0.0, 0.0, spectra.bb[l].sqrt()],
            ];
            for m in 0..=l {
                for unit in [Complex64::ONE, Complex64::I] {
                    let size = if m == 0 { 1.0 } else { 0.5_f64.sqrt() };
                    if m == 0 && unit == Complex64::I {
                        continue;
                    }
                    for [t, e, b] in kinds {
                        let mut sky = SkyAlms::zero(sky_l_max);
                        sky.t.set(l, m, unit * (t * size));
                        sky.e.set(l, m, unit * (e * size));
                        sky.b.set(l, m, unit * (b * size));
                        let residual = coupling.residual(&rings, &sky).unwrap();
                        let alm = residual.polarisation_alm(&rings, l_max, 0).unwrap();
                        let one = Spectra::of(None, &alm);
                        for (sum, more) in expected.iter_mut().zip([one.ee, one.bb]) {
                            for (sum, more) in sum.iter_mut().zip(more) {
                                *sum += more;
                            }
                        }
                    }
                }
            }
        }
        for (found, expected) in [&found.ee, &found.bb].into_iter().zip(&expected) {
            for l in 2..=l_max {
                assert!((found[l] / expected[l] - 1.0).abs() < 1e-11, "{l} {found:?} {expected:?}");
            }
        }
    }
}
