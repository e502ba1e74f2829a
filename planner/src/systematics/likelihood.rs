//! The bias of r that a systematic B spectrum makes.
//!
//! The likelihood of r where the observed spectrum is `L + S` [Takase2024, appendix A.3]:
//! `-2 ln L = f_sky sum_l (2l + 1) [(L + S)/(r T + L) + ln(r T + L)]`, T the tensors' at r = 1, L lensing and
//! noise, S systematic. Its maximum solves `sum_l (2l + 1) T (r T - S) / (r T + L)^2 = 0`, from l = 2 to 191.
//!
//! Method: bisection between 0 and the largest `S / T`, to the last bit.
//!
//! Limits: `delta_r` does not depend on `f_sky`, its error does. Not linear in S once `r T` is near L.

use crate::harmonics::gaussian_beam;
use thiserror::Error;

/// Default range of degrees.
pub const DEGREES: [usize; 2] = [2, 191];

/// What r is estimated with.
#[derive(Debug, Clone, PartialEq)]
pub struct Likelihood {
    /// B of the tensors of r = 1, by l from 0.
    pub tensor: Vec<f64>,
    /// B of lensing and, if there is any, noise, by l from 0.
    pub lensing: Vec<f64>,
    /// First and last degree.
    pub degrees: [usize; 2],
    /// Share of the sky.
    pub f_sky: f64,
}

/// r and its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bias {
    /// The r of the maximum: the bias.
    pub delta_r: f64,
    /// Standard deviation there, from the Fisher information.
    pub sigma_r: f64,
}

/// Why r has no estimate.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LikelihoodError {
    /// No degrees, or degrees below 2.
    #[error("degrees {0} to {1}: a range from 2 on is needed")]
    Degrees(usize, usize),
    /// A spectrum ends before the last degree.
    #[error("a spectrum ends at l = {end}, before {last}")]
    Short {
        /// Where it ends.
        end: usize,
        /// The last degree asked for.
        last: usize,
    },
    /// A systematic power that is negative or not finite.
    #[error("l = {l}: a systematic power of {value}")]
    Power {
        /// The degree.
        l: usize,
        /// The power.
        value: f64,
    },
    /// No tensors or no lensing at a degree.
    #[error("l = {0}: no power of tensors or of lensing")]
    Model(usize),
    /// A share of the sky outside 0 to 1.
    #[error("f_sky = {0}: above 0 and at most 1")]
    Sky(f64),
}

/// White noise of the polarisation seen through a Gaussian beam, the beam divided out: in uK^2 by l
/// from 0 to `l_max`, zero below 2.
#[must_use]
pub fn white_noise(uk_arcmin: f64, fwhm_rad: f64, l_max: usize) -> Vec<f64> {
    let density = (uk_arcmin * std::f64::consts::PI / 10_800.0).powi(2);
    // N_l = w^2 / b_l^2
    let of = |(l, beam): (usize, f64)| if l < 2 { 0.0 } else { density / (beam * beam) };
    gaussian_beam(fwhm_rad, 0, l_max).into_iter().enumerate().map(of).collect()
}

impl Likelihood {
    /// Over the default degrees of the full sky, without noise.
    #[must_use]
    pub fn new(tensor: &[f64], lensing: &[f64]) -> Self {
        let (tensor, lensing) = (tensor.to_vec(), lensing.to_vec());
        Self { tensor, lensing, degrees: DEGREES, f_sky: 1.0 }
    }

    /// With noise of B, by l from 0, beside lensing; degrees beyond its end have none.
    #[must_use]
    pub fn with_noise(mut self, noise: &[f64]) -> Self {
        for (power, noise) in self.lensing.iter_mut().zip(noise) {
            *power += noise;
        }
        self
    }

    /// The bias that a systematic spectrum makes, by l from 0.
    ///
    /// # Errors
    /// [`LikelihoodError`] for ranges and spectra that do not fit.
    pub fn bias(&self, systematic: &[f64]) -> Result<Bias, LikelihoodError> {
        let rows = self.rows(systematic)?;
        // The slope of ln L, rising with r from r = 0 on; zero at the maximum.
        let slope = |r: f64| {
            rows.iter().map(|[w, t, l, s]| w * t * (r * t - s) / (r * t + l).powi(2)).sum::<f64>()
        };
        let mut low = 0.0_f64;
        let mut high = rows.iter().map(|[_, t, _, s]| s / t).fold(0.0, f64::max);
        loop {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                break;
            }
            if slope(middle) < 0.0 { low = middle } else { high = middle }
        }
        let delta_r = f64::midpoint(low, high);
        // F = f_sky sum_l (2l + 1)/2 [T / (r T + L)]^2
        let information: f64 =
            rows.iter().map(|[w, t, l, _]| 0.5 * w * (t / (delta_r * t + l)).powi(2)).sum();
        Ok(Bias { delta_r, sigma_r: (self.f_sky * information).sqrt().recip() })
    }

    /// 2l + 1, T, L and S of each degree.
    fn rows(&self, systematic: &[f64]) -> Result<Vec<[f64; 4]>, LikelihoodError> {
        let [first, last] = self.degrees;
        if first < 2 || last < first {
            return Err(LikelihoodError::Degrees(first, last));
        }
        if !(self.f_sky > 0.0 && self.f_sky <= 1.0) {
            return Err(LikelihoodError::Sky(self.f_sky));
        }
        let spectra = [&self.tensor[..], &self.lensing, systematic];
        let shortest = spectra.iter().map(|it| it.len()).min().unwrap_or(0);
        if shortest <= last {
            return Err(LikelihoodError::Short { end: shortest.saturating_sub(1), last });
        }
        (first..=last)
            .map(|l| {
                let [t, lensing, s] = spectra.map(|it| it[l]);
                if !(s >= 0.0 && s.is_finite()) {
                    return Err(LikelihoodError::Power { l, value: s });
                }
                if !(t > 0.0 && lensing > 0.0) {
                    return Err(LikelihoodError::Model(l));
                }
                Ok([2.0 * f64::from(u32::try_from(l).unwrap_or(u32::MAX)) + 1.0, t, lensing, s])
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::cmb::{CmbSpectra, TensorTilt};
    use super::*;

    fn likelihood(tilt: TensorTilt) -> Likelihood {
        let spectra = CmbSpectra::embedded(tilt).unwrap();
        Likelihood::new(&spectra.tensor_bb, &spectra.bb)
    }

    /// Roots by another program's solver.
    #[test]
    fn roots_are_those_of_another_program() {
        let by_l = |of: &dyn Fn(f64) -> f64| (0..192_u8).map(|l| of(f64::from(l))).collect();
        let flat: Vec<f64> = by_l(&|_| 1e-7);
        let falling: Vec<f64> = by_l(&|l| 1e-5 / (l * (l + 1.0)).max(1.0));
        let quadrupole: Vec<f64> = by_l(&|l| if (l - 2.0).abs() < 0.5 { 1e-5 } else { 0.0 });
        let (scaleless, tilted) =
            (likelihood(TensorTilt::Scaleless), likelihood(TensorTilt::Consistency));
        for (likelihood, systematic, expected) in [
            (&scaleless, &flat, 0.000_336_207_263_126_271_25),
            (&tilted, &flat, 5.746_463_605_833_619e-5),
            (&scaleless, &falling, 0.000_113_231_587_682_832_26),
            (&tilted, &falling, 6.030_101_348_583_528e-5),
            (&scaleless, &quadrupole, 0.000_217_970_007_230_957_62),
        ] {
            let found = likelihood.bias(systematic).unwrap();
            assert!((found.delta_r / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
        }
        let tensors: Vec<f64> = scaleless.tensor.iter().map(|t| 1e-3 * t).collect();
        let found = scaleless.bias(&tensors).unwrap();
        assert!((found.delta_r - 1e-3).abs() < 1e-15);
        // Without noise r is known to 1e-4 or so, and half of the sky tells less.
        let half = Likelihood { f_sky: 0.5, ..scaleless.clone() }.bias(&tensors).unwrap();
        assert!((half.sigma_r / found.sigma_r - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!(scaleless.bias(&[0.0; 192]).unwrap().delta_r.abs() < 1e-300);
    }

    #[test]
    fn noise_stands_beside_lensing() {
        let noise = white_noise(2.0, 0.0, 191);
        // 2 uK arcmin: (2 * 2.908882e-4)^2
        assert!((noise[50] - 3.384_637e-7).abs() < 1e-12, "{}", noise[50]);
        // exp(l (l + 1) FWHM^2 / (8 ln 2))
        let wide = white_noise(2.0, 0.01, 191);
        let expected = (100.0 * 101.0 * 1e-4 / (8.0 * 2.0_f64.ln())).exp();
        assert!((wide[100] / noise[100] / expected - 1.0).abs() < 1e-12);
        let clean = likelihood(TensorTilt::Scaleless);
        let systematic: Vec<f64> = clean.tensor.iter().map(|t| 1e-3 * t).collect();
        let with = clean.clone().with_noise(&noise).bias(&systematic).unwrap();
        let without = clean.bias(&systematic).unwrap();
        // S = r T: the bias is r, whatever the noise; its error grows.
        assert!((with.delta_r - 1e-3).abs() < 1e-12 && with.sigma_r > 1.02 * without.sigma_r);
    }

    #[test]
    fn what_has_no_estimate_is_told() {
        let good = likelihood(TensorTilt::Scaleless);
        let with = |degrees| Likelihood { degrees, ..good.clone() };
        let short = LikelihoodError::Short { end: 99, last: 191 };
        assert_eq!(good.bias(&[0.0; 100]), Err(short));
        assert_eq!(with([5, 4]).bias(&[0.0; 192]), Err(LikelihoodError::Degrees(5, 4)));
        assert_eq!(with([1, 4]).bias(&[0.0; 192]), Err(LikelihoodError::Degrees(1, 4)));
        let mut negative = [0.0; 192];
        negative[7] = -1e-9;
        assert_eq!(good.bias(&negative), Err(LikelihoodError::Power { l: 7, value: -1e-9 }));
        let dark = Likelihood { f_sky: 0.0, ..good.clone() };
        assert_eq!(dark.bias(&[0.0; 192]), Err(LikelihoodError::Sky(0.0)));
        let empty = Likelihood { tensor: vec![0.0; 192], ..good };
        assert_eq!(empty.bias(&[0.0; 192]), Err(LikelihoodError::Model(2)));
    }
}
