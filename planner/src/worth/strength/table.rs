//! Published brightness of calibrators: discs of planets, and fluxes of fixed sources.
//!
//! | what | numbers | source |
//! |---|---|---|
//! | radii | equatorial and polar, km | IAU 2015, [Archinal2018, tables] |
//! | 28.4, 44.1, 70.4 GHz | Jupiter, Saturn's disc, Uranus, Neptune: band-averaged Planck temperature, K | Planck/LFI, [Maris2021, abstract] |
//! | 100 to 545 GHz | Mars, Jupiter, Saturn, Uranus, Neptune: thermodynamic temperature, K | Planck/HFI, [Planck2017, tables] |
//! | Tau A | S = 1010.2 (nu/GHz)^-0.323 Jy, polarised 78.98 (nu/GHz)^-0.347 Jy, 30 to 353 GHz | [Ritacco2018, fit] |
//!
//! Method: the temperature is interpolated linearly in frequency and there is none outside the table.
//!
//! What each number was compared with stands in `docs/scheduling.md`; Tau A's amplitudes are not
//! verified.
//!
//! Limits: Mars varies by some 10 % with season and distance from the Sun, and Saturn's rings and
//! tilt change its flux by as much; the table holds means. Tau A is 7' x 5' wide and fades by about
//! 0.2 % a year, which is left out. Mercury, Venus, the Moon, Cas A and Cen A are not in the table.
//!
//! # Example
//! ```
//! use planner::worth::strength::table::{Calibrator, calibrator};
//!
//! let Some(Calibrator::Disc(jupiter)) = calibrator("jupiter") else { panic!("not in the table") };
//! assert_eq!(jupiter.brightness_k(143.0), Some(174.1));
//! assert_eq!(jupiter.brightness_k(857.0), None);
//! assert!(calibrator("moon").is_none());
//! ```

/// A planet as a uniform disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Equatorial radius in km.
    pub equatorial_km: f64,
    /// Polar radius in km.
    pub polar_km: f64,
    /// Frequency in GHz and the temperature of a black body as bright, in K, by frequency.
    pub brightness: &'static [(f64, f64)],
}

/// A flux that is a power law of frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Flux at 1 GHz in Jy.
    pub at_1_ghz_jy: f64,
    /// Spectral index.
    pub index: f64,
    /// Polarised flux at 1 GHz in Jy.
    pub polarised_at_1_ghz_jy: f64,
    /// Its spectral index.
    pub polarised_index: f64,
    /// First and last frequency of the fit in GHz.
    pub range_ghz: (f64, f64),
}

/// What the table says of a source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Calibrator {
    /// A planet.
    Disc(Disc),
    /// A fixed source.
    PowerLaw(PowerLaw),
}

const fn disc(radii_km: (f64, f64), brightness: &'static [(f64, f64)]) -> Calibrator {
    Calibrator::Disc(Disc { equatorial_km: radii_km.0, polar_km: radii_km.1, brightness })
}

const CALIBRATORS: [(&str, Calibrator); 6] = [
    (
        "mars",
        disc(
            (3396.19, 3376.20),
            &[(100.0, 194.3), (143.0, 198.4), (217.0, 201.9), (353.0, 209.9), (545.0, 209.2)],
        ),
    ),
    ("jupiter", disc((71_492.0, 66_854.0), &JUPITER)),
    (
        "saturn",
        disc(
            (60_268.0, 54_364.0),
            &[
                (28.4, 139.7),
                (44.1, 147.8),
                (70.4, 151.0),
                (100.0, 145.7),
                (143.0, 147.1),
                (217.0, 145.1),
                (353.0, 141.6),
                (545.0, 102.5),
            ],
        ),
    ),
    (
        "uranus",
        disc(
            (25_559.0, 24_973.0),
            &[
                (28.4, 152.0),
                (44.1, 145.0),
                (70.4, 133.0),
                (100.0, 120.5),
                (143.0, 108.4),
                (217.0, 98.5),
                (353.0, 86.2),
                (545.0, 73.9),
            ],
        ),
    ),
    (
        "neptune",
        disc(
            (24_764.0, 24_341.0),
            &[
                (28.4, 154.0),
                (44.1, 149.0),
                (70.4, 128.0),
                (100.0, 117.4),
                (143.0, 106.4),
                (217.0, 97.4),
                (353.0, 82.6),
                (545.0, 72.3),
            ],
        ),
    ),
    (
        "tau_a",
        Calibrator::PowerLaw(PowerLaw {
            at_1_ghz_jy: 1010.2,
            index: -0.323,
            polarised_at_1_ghz_jy: 78.98,
            polarised_index: -0.347,
            range_ghz: (30.0, 353.0),
        }),
    ),
];

const JUPITER: [(f64, f64); 8] = [
    (28.4, 144.7),
    (44.1, 160.3),
    (70.4, 171.2),
    (100.0, 172.6),
    (143.0, 174.1),
    (217.0, 175.8),
    (353.0, 167.4),
    (545.0, 137.4),
];

/// What the table says of a target, by its name in mission files.
#[must_use]
pub fn calibrator(name: &str) -> Option<Calibrator> {
    CALIBRATORS.iter().find(|entry| entry.0 == name).map(|entry| entry.1)
}

impl Disc {
    /// Temperature of a black body as bright in K; `None` outside the table's frequencies.
    #[must_use]
    pub fn brightness_k(&self, frequency_ghz: f64) -> Option<f64> {
        self.brightness.windows(2).find_map(|pair| {
            let [(low, from), (high, to)] = *pair else { return None };
            let inside = low <= frequency_ghz && frequency_ghz <= high;
            inside.then(|| from + (to - from) * ((frequency_ghz - low) / (high - low)))
        })
    }

    /// Radius of the circle with the area that is seen from the plane of the equator, in km.
    #[must_use]
    pub fn radius_km(&self) -> f64 {
        (self.equatorial_km * self.polar_km).sqrt()
    }
}

impl PowerLaw {
    /// Flux and polarised flux in Jy; `None` outside the frequencies of the fit.
    #[must_use]
    pub fn flux_jy(&self, frequency_ghz: f64) -> Option<(f64, f64)> {
        let inside = self.range_ghz.0 <= frequency_ghz && frequency_ghz <= self.range_ghz.1;
        inside.then(|| {
            (
                self.at_1_ghz_jy * frequency_ghz.powf(self.index),
                self.polarised_at_1_ghz_jy * frequency_ghz.powf(self.polarised_index),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn temperatures_are_the_tables_at_its_bands_and_none_outside() {
        let Some(Calibrator::Disc(jupiter)) = calibrator("jupiter") else { panic!("no Jupiter") };
        for (frequency, temperature) in JUPITER {
            assert_eq!(jupiter.brightness_k(frequency), Some(temperature));
        }
        // 143 GHz + 52/74 of the way to 217 GHz.
        let between = jupiter.brightness_k(195.0).unwrap();
        assert!((between - (174.1 + 1.7 * 52.0 / 74.0)).abs() < 1e-12);
        for outside in [0.0, 28.3, 545.1, f64::NAN, f64::INFINITY] {
            assert_eq!(jupiter.brightness_k(outside), None);
        }
        assert_eq!(calibrator("moon"), None);
    }

    #[test]
    fn bands_ascend_and_temperatures_are_possible() {
        for (name, it) in CALIBRATORS {
            let Calibrator::Disc(disc) = it else { continue };
            assert!(disc.brightness.windows(2).all(|pair| pair[0].0 < pair[1].0), "{name}");
            assert!(disc.brightness.iter().all(|it| (50.0..300.0).contains(&it.1)), "{name}");
            assert!(disc.polar_km < disc.equatorial_km, "{name}");
        }
    }

    #[test]
    fn the_crab_is_seven_percent_polarised() {
        let Some(Calibrator::PowerLaw(crab)) = calibrator("tau_a") else { panic!("no Tau A") };
        let (flux, polarised) = crab.flux_jy(150.0).unwrap();
        assert!((0.065..0.075).contains(&(polarised / flux)));
        assert_eq!(crab.flux_jy(402.0), None);
    }
}
