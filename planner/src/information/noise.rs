//! How strong is a receiver's noise against a source: thermodynamic and antenna temperature, and 1/f.
//!
//! Noise of CMB detectors is quoted as a change of the background's temperature. In antenna temperature,
//! which [`worth::strength`](mod@crate::worth::strength) has sources in, it is less:
//!
//! ```text
//! dT_RJ / dT_CMB = x^2 e^x / (e^x - 1)^2,  x = h f / (k T), T = 2.7255 K [Fixsen2009],
//! ```
//!
//! averaged over a band that is flat about its frequency.
//!
//! **1/f noise** is white noise times `1 + f_knee / f`. A pass lasts a few times s / v, short beside
//! `1 / f_knee`; with `e = f_knee 2 pi s / v` the information on the gain is
//!
//! ```text
//! R(e) = (2 / sqrt(pi)) int_0^inf exp(-y^2) y / (y + e) dy
//! ```
//!
//! of that under white noise, since G's spectrum is a Gaussian of frequency. This share is taken of all
//! parameters.
//!
//! Limits: R is the gain's. To first order the width loses 4/3 of what the gain does, offsets and
//! ellipticities less, and what a plate modulates nothing (`other_parameters_lose_about_as_much`).
//! [`SHORT`] says where passes are no longer short.

use std::f64::consts::{FRAC_2_SQRT_PI, TAU};
use std::sync::LazyLock;

/// Temperature of the background in K \[Fixsen2009\].
pub const BACKGROUND_K: f64 = 2.7255;
/// h / k in K per GHz, exact constants.
const KELVIN_PER_GHZ: f64 = 6.626_070_15e-34 / 1.380_649e-23 * 1e9;
/// Share of the information below which passes are not short beside 1 / `f_knee`.
pub const SHORT: f64 = 0.75;

/// Antenna over thermodynamic temperature at one frequency.
fn ratio_at(frequency_ghz: f64) -> f64 {
    let x = KELVIN_PER_GHZ * frequency_ghz / BACKGROUND_K;
    // x^2 e^x / (e^x - 1)^2 = (x / (2 sinh(x/2)))^2.
    let half = 0.5 * x;
    let ratio = if half < 1e-4 { 1.0 } else { half / half.sinh() };
    ratio * ratio
}

/// Antenna over thermodynamic temperature, averaged over a flat band.
///
/// Simpson's rule over 64 steps, which is exact to 1e-10 up to bands as wide as their frequency.
#[must_use]
pub fn antenna_per_thermodynamic(frequency_ghz: f64, bandwidth_ghz: Option<f64>) -> f64 {
    let Some(width) = bandwidth_ghz else { return ratio_at(frequency_ghz) };
    let steps = 64_u8;
    let low = frequency_ghz - 0.5 * width;
    let sum: f64 = (0..=steps)
        .map(|step| {
            let weight = if step == 0 || step == steps {
                1.0
            } else if step % 2 == 1 {
                4.0
            } else {
                2.0
            };
            weight * ratio_at(low + width * f64::from(step) / f64::from(steps))
        })
        .sum();
    sum / (3.0 * f64::from(steps))
}

/// Logarithms of e at the ends of the table, and its intervals.
const FIRST: f64 = -16.0;
const LAST: f64 = 8.0;
const INTERVALS: u16 = 480;

static SHARES: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let step = (LAST - FIRST) / f64::from(INTERVALS);
    (0..=INTERVALS).map(|at| share_of((FIRST + f64::from(at) * step).exp())).collect()
});

/// R(e) by the trapezium rule in ln y.
fn share_of(ratio: f64) -> f64 {
    let step = 0.02;
    // y from e^-30 to e^2.
    let sum: f64 = (-1500..=100)
        .map(|n| {
            let y = (f64::from(n) * step).exp();
            (-y * y).exp() * y * y / (y + ratio)
        })
        .sum();
    FRAC_2_SQRT_PI * sum * step
}

/// Part of a pass's information that 1/f noise leaves: `knee_hz` of the noise, `beam_sigma_rad` over
/// `speed_rad_s` of the pass.
///
/// From a table of R, linear in ln e between entries: exact to 1e-4.
#[must_use]
pub fn share_left(knee_hz: f64, beam_sigma_rad: f64, speed_rad_s: f64) -> f64 {
    let ratio = knee_hz * TAU * beam_sigma_rad / speed_rad_s;
    if ratio <= 0.0 {
        return 1.0;
    }
    let shares = &*SHARES;
    let at = (ratio.ln() - FIRST) / (LAST - FIRST) * f64::from(INTERVALS);
    let at = at.clamp(0.0, f64::from(INTERVALS) - 1e-9);
    let index = whole(at);
    let part = at - at.floor();
    shares[index] * (1.0 - part) + shares[index + 1] * part
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to below the table's length after the clamp"
)]
fn whole(at: f64) -> usize {
    at as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn antenna_temperature_agrees_with_an_integral() {
        // From a program of its own (scipy's quadrature, CODATA 2018): centre, width, mean.
        for (centre, width, mean) in EXPECTED {
            let found = antenna_per_thermodynamic(centre, Some(width));
            assert!((found / mean - 1.0).abs() < 1e-9, "{centre} GHz: {found} is not {mean}");
        }
        assert!((antenna_per_thermodynamic(1e-6, None) - 1.0).abs() < 1e-12);
        let narrow = antenna_per_thermodynamic(140.0, Some(1e-3));
        assert!((narrow / antenna_per_thermodynamic(140.0, None) - 1.0).abs() < 1e-9);
    }

    const EXPECTED: [(f64, f64, f64); 3] = [
        (40.0, 12.0, 0.959_397_577_206_670_8),
        (140.0, 42.0, 0.617_112_634_992_566_6),
        (402.0, 92.0, 0.044_540_314_784_721_9),
    ];

    #[test]
    fn a_knee_takes_what_its_integral_says() {
        assert!((share_of(1e-9) - 1.0).abs() < 1e-6);
        for (ratio, share) in SHARES_EXPECTED {
            assert!((share_of(ratio) - share).abs() < 1e-9, "{ratio}: {}", share_of(ratio));
            let left = share_left(ratio / TAU, 1.0, 1.0);
            assert!((left - share).abs() < 1e-4, "{ratio}: {left}");
        }
        assert!((share_left(0.0, 1.0, 1.0) - 1.0).abs() < 1e-15);
    }

    const SHARES_EXPECTED: [(f64, f64); 3] = [
        (0.01, 0.951_098_257_623_573_5),
        (0.1, 0.755_700_983_607_128_5),
        (1.0, 0.317_179_793_206_810_7),
    ];

    /// What is left of the information on a signal whose spectrum is |`of`(y)|^2 exp(-y^2).
    fn left(of: impl Fn(f64) -> f64, ratio: f64) -> f64 {
        let sum = |knee: f64| -> f64 {
            (1..200_000)
                .map(|n| {
                    let y = f64::from(n) * 5e-5;
                    of(y).powi(2) * (-y * y).exp() * y / (y + knee)
                })
                .sum()
        };
        sum(ratio) / sum(0.0)
    }

    #[test]
    fn other_parameters_lose_about_as_much() {
        // Spectra of x exp(-x^2/2) (offset along the scan) and (x^2 + b^2) exp(-x^2/2) (width).
        let ratio = 1e-3;
        let gain = 1.0 - left(|_| 1.0, ratio);
        let offset = 1.0 - left(|y| y, ratio);
        let width = 1.0 - left(|y| 1.0 - y * y, ratio);
        assert!(offset < gain && gain < width && width < 1.4 * gain, "{gain} {offset} {width}");
    }
}
