//! How well is the beam's response known at a distance from its centre.
//!
//! The response R(x, y) is normalised to its peak. A cell in which a source of antenna temperature A spends
//! the time t teaches R with an error sigma / (A sqrt(t)); cells are squares of an eighth of the beam's full
//! width, and R's level in dB is 10 log10 R.
//!
//! Method: the time that a straight chord at impact b spends between r and r' is
//! (sqrt(r'^2 - b^2) - sqrt(r^2 - b^2)) 2 / v. An annulus of the width of a cell has the information of its
//! chords, spread over its area; the error told is that of a cell with the annulus's mean. The beam is
//! **known to a level** out to the radius up to which no annulus has a larger error.
//!
//! Limits: an annulus may be unevenly covered, which the map over cells shows; white noise, less the
//! share that 1/f takes; sidelobes beyond the reach are not looked at.

use super::pass::Crossing;
use super::sight::REACH;
use std::f64::consts::PI;

/// Cells across the beam's full width.
pub const CELLS_PER_FWHM: u8 = 8;
/// Annuli out to the reach of [`REACH`] full widths.
pub const ANNULI: usize = 16;

/// Information on the response by annulus, 1 per squared response.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Profile {
    information: [f64; ANNULI],
    seconds: [f64; ANNULI],
}

/// The inner radius of an annulus in full widths of the beam, from 0 to [`ANNULI`].
#[must_use]
pub fn inner_radius_fwhm(annulus: usize) -> f64 {
    let whole = u8::try_from(annulus).unwrap_or(u8::MAX);
    REACH * f64::from(whole) / 16.0
}

impl Profile {
    /// Takes in a pass; `share` is the part of its information that 1/f noise leaves.
    pub(super) fn pass(&mut self, it: &Crossing, fwhm_rad: f64, share: f64) {
        let ratio = it.signal_k / it.noise_k_rts;
        let b = it.impact_rad / fwhm_rad;
        let half = |r: f64| (r * r - b * b).max(0.0).sqrt();
        let mut below = 0.0;
        for annulus in 0..ANNULI {
            let above = half(inner_radius_fwhm(annulus + 1));
            let seconds = 2.0 * (above - below) * fwhm_rad / it.speed_rad_s;
            self.seconds[annulus] += seconds;
            self.information[annulus] += seconds * ratio * ratio * share;
            below = above;
        }
    }

    /// Takes in what other passes teach.
    pub fn add(&mut self, other: &Self) {
        for annulus in 0..ANNULI {
            self.information[annulus] += other.information[annulus];
            self.seconds[annulus] += other.seconds[annulus];
        }
    }

    /// Seconds of source in an annulus.
    #[must_use]
    pub const fn seconds(&self, annulus: usize) -> f64 {
        self.seconds[annulus]
    }

    /// Error of the normalised response in a cell of an annulus; infinite where nothing passed.
    #[must_use]
    pub fn error(&self, annulus: usize) -> f64 {
        let (low, high) = (inner_radius_fwhm(annulus), inner_radius_fwhm(annulus + 1));
        let cells = PI * (high * high - low * low) * f64::from(CELLS_PER_FWHM).powi(2);
        (cells / self.information[annulus]).sqrt()
    }

    /// Radius in full widths up to which no annulus has a larger error; `None` where the first has.
    #[must_use]
    pub fn known_fwhm(&self, level: f64) -> Option<f64> {
        let known = (0..ANNULI).take_while(|&annulus| self.error(annulus) <= level).count();
        (known > 0).then(|| inner_radius_fwhm(known))
    }

    /// The largest error out to a radius in full widths; infinite beyond the reach.
    #[must_use]
    pub fn worst_to(&self, radius_fwhm: f64) -> f64 {
        if radius_fwhm > REACH * (1.0 + 1e-12) {
            return f64::INFINITY;
        }
        (0..ANNULI)
            .filter(|&annulus| inner_radius_fwhm(annulus) < radius_fwhm)
            .map(|annulus| self.error(annulus))
            .fold(0.0, f64::max)
    }

    /// Radius in full widths where a Gaussian beam's response falls to the error: first annulus's inner
    /// radius in which its middle is below it; the reach where there is none.
    #[must_use]
    pub fn seen_fwhm(&self) -> f64 {
        let lost = (0..ANNULI).find(|&annulus| {
            let middle = 0.5 * (inner_radius_fwhm(annulus) + inner_radius_fwhm(annulus + 1));
            gaussian(middle) < self.error(annulus)
        });
        lost.map_or(REACH, inner_radius_fwhm)
    }
}

/// The response of a Gaussian beam at a distance in full widths, exp(-4 ln 2 r^2).
#[must_use]
pub fn gaussian(radius_fwhm: f64) -> f64 {
    (-4.0 * std::f64::consts::LN_2 * radius_fwhm * radius_fwhm).exp()
}

/// A level in dB: 10 log10.
#[must_use]
pub fn decibel(response: f64) -> f64 {
    10.0 * response.log10()
}

#[cfg(test)]
mod tests {
    use super::super::pass::Modulation;
    use super::*;

    #[test]
    fn evenly_spaced_chords_give_every_cell_the_same_error() {
        let fwhm = 0.01;
        let spacing = fwhm / 400.0;
        let mut profile = Profile::default();
        let mut count = 0.0;
        for n in -900..=900 {
            count += 1.0;
            let crossing = Crossing {
                signal_k: 0.1,
                noise_k_rts: 1e-3,
                beam_sigma_rad: 0.4 * fwhm,
                speed_rad_s: 0.005,
                impact_rad: f64::from(n) * spacing,
                scan_beam_angle_rad: 0.0,
                modulation: Modulation::default(),
            };
            profile.pass(&crossing, fwhm, 1.0);
        }
        assert!(count > 1800.0);
        // A cell of area a^2 has a^2 / (spacing v) seconds.
        let cell = fwhm / 8.0;
        let seconds = cell * cell / (spacing * 0.005);
        let expected = 1e-3 / (0.1 * seconds.sqrt());
        for annulus in 0..ANNULI {
            let found = profile.error(annulus);
            assert!((found / expected - 1.0).abs() < 0.01, "{annulus}: {found} is not {expected}");
        }
        assert_eq!(profile.known_fwhm(1.1 * expected), Some(REACH));
        assert_eq!(profile.known_fwhm(0.9 * expected), None);
        assert!((profile.worst_to(1.0) / expected - 1.0).abs() < 0.01);
        assert!(profile.worst_to(2.1).is_infinite());
        let mut twice = profile;
        twice.add(&profile);
        assert!((twice.error(3) * 2.0_f64.sqrt() / profile.error(3) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_beam_is_seen_as_far_as_it_exceeds_the_error() {
        // Error 0.01 everywhere: the Gaussian falls to it at 1.29 full widths.
        let mut profile = Profile::default();
        for annulus in 0..ANNULI {
            let one = Profile { information: [1.0; ANNULI], ..profile }.error(annulus);
            profile.information[annulus] = (one / 0.01).powi(2);
        }
        assert!((profile.seen_fwhm() - 1.25).abs() < 1e-12);
        assert!((gaussian(1.289) - 0.01).abs() < 1e-4 && (decibel(0.01) + 20.0).abs() < 1e-12);
    }
}
