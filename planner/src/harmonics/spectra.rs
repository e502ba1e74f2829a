//! Angular power spectra, and what a beam leaves of them.
//!
//! `C_l = sum_m a_lm conj b_lm / (2l + 1)` over m of both signs; TT, EE, BB, TE, EB as CMB codes have
//! them.
//!
//! A Gaussian beam multiplies the coefficients of spin s by `exp(-(l (l + 1) - s^2) sigma^2 / 2)`,
//! `sigma = FWHM / sqrt(8 ln 2)` \[Challinor2000\].

use super::alm::Alm;
use super::spin::SpinAlm;

/// Spectra by l from 0.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectra {
    /// Temperature.
    pub tt: Vec<f64>,
    /// Gradient polarisation.
    pub ee: Vec<f64>,
    /// Curl polarisation.
    pub bb: Vec<f64>,
    /// Temperature with E.
    pub te: Vec<f64>,
    /// E with B.
    pub eb: Vec<f64>,
}

impl Spectra {
    /// Of a temperature field, if there is one, and of a polarised one.
    #[must_use]
    pub fn of(temperature: Option<&Alm>, polarisation: &SpinAlm) -> Self {
        let SpinAlm { e, b, .. } = polarisation;
        let with = |other: &Alm| temperature.map(|t| cross_spectrum(t, other)).unwrap_or_default();
        Self {
            tt: temperature.map(|t| cross_spectrum(t, t)).unwrap_or_default(),
            ee: cross_spectrum(e, e),
            bb: cross_spectrum(b, b),
            te: with(e),
            eb: cross_spectrum(e, b),
        }
    }
}

/// The spectrum of two real fields, by l from 0 to the lower of their degrees.
#[must_use]
pub fn cross_spectrum(a: &Alm, b: &Alm) -> Vec<f64> {
    let l_max = a.l_max().min(b.l_max());
    let mut sums = vec![0.0; l_max + 1];
    for m in 0..=l_max {
        let twice = if m == 0 { 1.0 } else { 2.0 };
        for ((sum, a), b) in sums[m..].iter_mut().zip(a.row(m)).zip(b.row(m)) {
            *sum += twice * (a.re * b.re + a.im * b.im);
        }
    }
    let mut orders = 1.0;
    for sum in &mut sums {
        *sum /= orders;
        orders += 2.0;
    }
    sums
}

/// What a Gaussian beam leaves of coefficients of a spin, by l from 0 to `l_max`; 0 below the spin.
#[must_use]
pub fn gaussian_beam(fwhm_rad: f64, spin: u32, l_max: usize) -> Vec<f64> {
    // sigma^2 / 2
    let half_variance = fwhm_rad * fwhm_rad / (16.0 * std::f64::consts::LN_2);
    let s = f64::from(spin);
    let mut l = 0.0;
    let mut next = || {
        // exp(-(l (l + 1) - s^2) sigma^2 / 2)
        let beam = if l < s { 0.0 } else { (-(l * (l + 1.0) - s * s) * half_variance).exp() };
        l += 1.0;
        beam
    };
    (0..=l_max).map(|_| next()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::Complex64;
    use super::*;

    #[test]
    fn spectra_count_orders_of_both_signs() {
        let mut e = Alm::zero(3);
        e.set(2, 0, Complex64::new(3.0, 0.0));
        e.set(2, 1, Complex64::new(1.0, 2.0));
        let mut b = Alm::zero(3);
        b.set(2, 1, Complex64::new(0.0, 1.0));
        let found = Spectra::of(Some(&e), &SpinAlm { spin: 2, e: e.clone(), b });
        for (spectrum, expected) in
            [(&found.tt, 19.0), (&found.ee, 19.0), (&found.bb, 2.0), (&found.eb, 4.0)]
        {
            assert!((spectrum[2] - expected / 5.0).abs() < 1e-15);
            assert!(spectrum[3].abs() < 1e-300);
        }
    }

    #[test]
    fn a_beam_halves_at_its_width() {
        // In the flat limit: exp(-l^2 sigma^2 / 2) with l sigma = sqrt(2 ln 2) is a half.
        let fwhm_rad = 0.01_f64;
        let l = 4.0 * std::f64::consts::LN_2 / fwhm_rad;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "277")]
        let at = l as usize;
        let beam = gaussian_beam(fwhm_rad, 0, at);
        assert!((beam[at] - 0.5).abs() < 2e-3, "{}", beam[at]);
        let polarised = gaussian_beam(fwhm_rad, 2, 9);
        assert!(polarised[1].abs() < 1e-300 && polarised[9] > beam[9]);
    }
}
