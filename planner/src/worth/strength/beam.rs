//! The peak antenna temperature of a source in a Gaussian beam.
//!
//! In the Rayleigh-Jeans sense: power per bandwidth over k. With F the full width of the beam at half
//! maximum, angles radians, temperatures K, fluxes Jy:
//!
//! Method:
//! - beam dilution of a uniform disc of angular radius r: 1 - exp(-4 ln 2 r^2 / F^2), the integral of
//!   the beam's Gaussian over the disc;
//! - antenna temperature of a disc: dilution times J(T), J(T) = x T / (e^x - 1), x = h f / (k T);
//! - of a source of flux S, small against the beam: S lambda^2 / (2 k Omega), Omega = pi F^2 / (4 ln 2).
//!
//! Limits: one frequency stands for the band; the beam is a circular Gaussian; the microwave
//! background that a planet hides (below 1.3 K of some 100 K) is not taken off.

use super::table::{Calibrator, Disc, calibrator};
use std::f64::consts::{LN_2, PI};

/// Planck's constant in J s, exact.
const PLANCK_J_S: f64 = 6.626_070_15e-34;
/// Boltzmann's constant in J/K, exact.
const BOLTZMANN_J_K: f64 = 1.380_649e-23;
/// Speed of light in m/s, exact.
const LIGHT_M_S: f64 = 299_792_458.0;
const JANSKY: f64 = 1e-26;

/// What a telescope sees with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Full width at half maximum in radians.
    pub fwhm_rad: f64,
    /// Frequency in GHz, where it is known.
    pub frequency_ghz: Option<f64>,
}

/// A flux that the user gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flux {
    /// Flux in Jy in the telescope's band.
    pub jy: f64,
    /// Its linearly polarised part, 0 to 1, where it is known.
    pub polarised_fraction: Option<f64>,
}

/// A source in a beam; `None` for what is not known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strength {
    /// Angular diameter of a disc.
    pub diameter_rad: Option<f64>,
    /// Part of the beam that a disc fills.
    pub dilution: Option<f64>,
    /// Temperature of a black body as bright as a disc.
    pub brightness_k: Option<f64>,
    /// Antenna temperature.
    pub antenna_k: Option<f64>,
    /// Its polarised part, where that is in the table or given.
    pub polarised_k: Option<f64>,
}

impl Beam {
    /// The strength of a target of the table; a planet needs its distance.
    #[must_use]
    pub fn strength_of(&self, name: &str, distance_km: Option<f64>) -> Strength {
        match (calibrator(name), distance_km) {
            (Some(Calibrator::Disc(disc)), Some(distance_km)) => self.disc(&disc, distance_km),
            (Some(Calibrator::PowerLaw(law)), _) => {
                let flux = self.frequency_ghz.and_then(|at| law.flux_jy(at));
                Strength {
                    antenna_k: flux.and_then(|(jy, _)| self.antenna_k(jy)),
                    polarised_k: flux.and_then(|(_, jy)| self.antenna_k(jy)),
                    ..Strength::default()
                }
            }
            _ => Strength::default(),
        }
    }

    /// The strength of a source of that flux.
    #[must_use]
    pub fn strength_of_flux(&self, flux: &Flux) -> Strength {
        let antenna_k = self.antenna_k(flux.jy);
        let polarised_k = antenna_k.zip(flux.polarised_fraction).map(|(all, part)| all * part);
        Strength { antenna_k, polarised_k, ..Strength::default() }
    }

    fn disc(&self, disc: &Disc, distance_km: f64) -> Strength {
        let radius_rad = (disc.radius_km() / distance_km).min(1.0).asin();
        let dilution = dilution(radius_rad, self.fwhm_rad);
        let brightness_k = self.frequency_ghz.and_then(|at| disc.brightness_k(at));
        Strength {
            diameter_rad: Some(2.0 * radius_rad),
            dilution: Some(dilution),
            brightness_k,
            antenna_k: brightness_k
                .zip(self.frequency_ghz)
                .map(|(kelvin, at)| dilution * rayleigh_jeans_k(kelvin, at)),
            polarised_k: None,
        }
    }

    /// `S lambda^2 / (2 k Omega)`.
    fn antenna_k(&self, jy: f64) -> Option<f64> {
        let wavelength_m = LIGHT_M_S / (self.frequency_ghz? * 1e9);
        let solid_angle = PI * self.fwhm_rad * self.fwhm_rad / (4.0 * LN_2);
        Some(jy * JANSKY * wavelength_m * wavelength_m / (2.0 * BOLTZMANN_J_K * solid_angle))
    }
}

/// Part of a Gaussian beam that a centred disc fills.
fn dilution(radius_rad: f64, fwhm_rad: f64) -> f64 {
    let ratio = radius_rad / fwhm_rad;
    -(-4.0 * LN_2 * ratio * ratio).exp_m1()
}

/// J(T) = x T / (e^x - 1), x = h f / (k T), in K.
fn rayleigh_jeans_k(temperature_k: f64, frequency_ghz: f64) -> f64 {
    let x = PLANCK_J_S * frequency_ghz * 1e9 / (BOLTZMANN_J_K * temperature_k);
    temperature_k * x / x.exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    const AU_KM: f64 = 149_597_870.7;
    /// The beam of LiteBIRD's LFT at 140 GHz.
    const LFT: Beam = Beam { fwhm_rad: 23.7 / 60.0 * PI / 180.0, frequency_ghz: Some(140.0) };

    /// Diameter in rad, dilution, brightness and antenna temperature in K.
    const JUPITER: (f64, f64, f64, f64) = (
        0.000_177_743_473_265_438_5,
        0.000_460_642_296_870_400_9,
        173.995_348_837_209_3,
        0.078_612_062_544_238_19,
    );
    /// Antenna temperature and its polarised part in K.
    const CRAB: (f64, f64) = (0.006_313_449_602_771_911, 0.000_438_398_854_216_9);

    fn near(value: Option<f64>, expected: f64, relative: f64) {
        let value = value.unwrap();
        assert!((value / expected - 1.0).abs() < relative, "{value} is not {expected}");
    }

    #[test]
    fn jupiter_in_a_beam_of_23_7_arcmin_agrees_with_numerical_integrals() {
        // From a program of its own: astropy's constants and BlackBody for J(T), the disc's integral
        // over the beam by scipy's quadrature.
        let it = LFT.strength_of("jupiter", Some(5.2 * AU_KM));
        near(it.diameter_rad, JUPITER.0, 1e-9);
        near(it.dilution, JUPITER.1, 1e-9);
        near(it.brightness_k, JUPITER.2, 1e-12);
        near(it.antenna_k, JUPITER.3, 1e-9);
        assert_eq!(it.polarised_k, None);
    }

    #[test]
    fn the_crab_in_a_beam_agrees_with_numerical_integrals() {
        // From the same program, the beam's solid angle by quadrature of its Gaussian on the plane.
        let it = LFT.strength_of("tau_a", None);
        near(it.antenna_k, CRAB.0, 1e-9);
        near(it.polarised_k, CRAB.1, 1e-9);
        assert_eq!(it.diameter_rad, None);
    }

    #[test]
    fn a_disc_fills_half_the_power_of_a_beam_as_wide_as_itself() {
        assert!((dilution(0.5, 1.0) - 0.5).abs() < 1e-15);
        assert!((dilution(1e-9, 1.0) / (4.0e-18 * LN_2) - 1.0).abs() < 1e-12);
        assert!((dilution(100.0, 1.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_small_disc_is_a_flux() {
        // S = 2 k J / lambda^2 times the disc's solid angle.
        let disc = LFT.strength_of("uranus", Some(500.0 * AU_KM));
        let radius = disc.diameter_rad.unwrap() / 2.0;
        let wavelength_m = LIGHT_M_S / 140e9;
        let j = rayleigh_jeans_k(disc.brightness_k.unwrap(), 140.0);
        let jy = 2.0 * BOLTZMANN_J_K * j / (wavelength_m * wavelength_m) * PI * radius * radius;
        let flux = Flux { jy: jy / JANSKY, polarised_fraction: Some(0.25) };
        let point = LFT.strength_of_flux(&flux);
        near(point.antenna_k, disc.antenna_k.unwrap(), 1e-6);
        near(point.polarised_k, 0.25 * disc.antenna_k.unwrap(), 1e-6);
    }

    #[test]
    fn what_is_not_known_is_not_told() {
        let blind = Beam { frequency_ghz: None, ..LFT };
        let it = blind.strength_of("mars", Some(AU_KM));
        assert!(it.diameter_rad.is_some() && it.dilution.is_some());
        assert_eq!((it.brightness_k, it.antenna_k), (None, None));
        assert_eq!(blind.strength_of("tau_a", None), Strength::default());
        assert_eq!(LFT.strength_of("mars", None), Strength::default());
        assert_eq!(LFT.strength_of("moon", Some(4e5)), Strength::default());
    }
}
