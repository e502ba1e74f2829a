//! A random CMB sky of given spectra, named by its seed.
//!
//! Coefficients are Gaussian: by l from 2, by m from 0, of T, of E as far as it is not correlated with T,
//! and of B, real part before imaginary part. `a^T = sqrt(TT) x`, `a^E = TE / sqrt(TT) x + sqrt(EE - TE^2 / TT) y`.
//!
//! Method: splitmix64 \[Steele2014\] and the polar method \[Marsaglia1964\] with a logarithm that is software,
//! so that a seed is the same sky on every machine.

use super::cmb::CmbSpectra;
use super::sky::SkyAlms;
use crate::harmonics::Complex64;
use ephem::random::SplitMix64;

/// Pairs of standard normal numbers.
struct Normal(SplitMix64);

impl Normal {
    fn pair(&mut self) -> [f64; 2] {
        loop {
            let [x, y] = [(); 2].map(|()| 2.0 * self.0.unit() - 1.0);
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                let size = (-2.0 * libm::log(square) / square).sqrt();
                return [size * x, size * y];
            }
        }
    }

    /// A coefficient of unit power; real for m = 0.
    fn coefficient(&mut self, m: usize) -> Complex64 {
        let [x, y] = self.pair();
        if m == 0 { x.into() } else { Complex64::new(x, y) * 0.5_f64.sqrt() }
    }
}

/// The sky of a seed to degree `l_max`, or that of the spectra if it is lower.
#[must_use]
pub fn realisation(spectra: &CmbSpectra, l_max: usize, seed: u64) -> SkyAlms {
    let l_max = l_max.min(spectra.l_max());
    let mut normal = Normal(SplitMix64(seed));
    let mut sky = SkyAlms::zero(l_max);
    for l in 2..=l_max {
        let [tt, ee, bb, te] = [&spectra.tt, &spectra.ee, &spectra.bb, &spectra.te].map(|it| it[l]);
        let correlated = if tt > 0.0 { te / tt.sqrt() } else { 0.0 };
        let rest = (ee - correlated * correlated).max(0.0).sqrt();
        for m in 0..=l {
            let [x, y, w] = [(); 3].map(|()| normal.coefficient(m));
            sky.t.set(l, m, x * tt.sqrt());
            sky.e.set(l, m, x * correlated + y * rest);
            sky.b.set(l, m, w * bb.sqrt());
        }
    }
    sky
}

#[cfg(test)]
mod tests {
    use super::super::cmb::TensorTilt;
    use super::*;
    use crate::harmonics::{Spectra, SpinAlm};

    #[test]
    fn spectra_come_back_within_their_scatter() {
        let spectra = CmbSpectra::embedded(TensorTilt::Scaleless).unwrap();
        let sky = realisation(&spectra, 400, 7);
        let polarisation = SpinAlm { spin: 2, e: sky.e.clone(), b: sky.b.clone() };
        let found = Spectra::of(Some(&sky.t), &polarisation);
        // Over l the ratio scatters by sqrt(2 / sum (2l + 1)) = 3.5e-3.
        let ratio = |found: &[f64], given: &[f64]| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for l in 2..=400 {
                let modes = 2.0 * f64::from(u32::try_from(l).unwrap()) + 1.0;
                sum += modes * found[l] / given[l];
                weight += modes;
            }
            sum / weight
        };
        for (found, given) in
            [(&found.tt, &spectra.tt), (&found.ee, &spectra.ee), (&found.bb, &spectra.bb)]
        {
            assert!((ratio(found, given) - 1.0).abs() < 0.012);
        }
        let (mut te, mut expected) = (0.0, 0.0);
        for l in 2..=400 {
            te += found.te[l] * spectra.te[l];
            expected += spectra.te[l] * spectra.te[l];
        }
        assert!((te / expected - 1.0).abs() < 0.3, "{}", te / expected);
        assert!(found.eb.iter().all(|x| x.abs() < 1e-2));
    }

    #[test]
    fn a_seed_is_one_sky() {
        let spectra = CmbSpectra::embedded(TensorTilt::Scaleless).unwrap();
        assert_eq!(realisation(&spectra, 9, 5), realisation(&spectra, 9, 5));
        assert_ne!(realisation(&spectra, 9, 5), realisation(&spectra, 9, 6));
        // A higher degree continues the same sky.
        assert_eq!(realisation(&spectra, 20, 5).t.to_degree(9), realisation(&spectra, 9, 5).t);
    }
}
