//! The sky that an effect acts on: coefficients of T, E and B, and the fields made of them.
//!
//! Coefficients are those of [`crate::harmonics`], in the frame of the map and in its units, uK here;
//! `P = Q + iU` in the COSMO sense has those of spin 2, `-(E + iB)`.
//!
//! The solar dipole is that of \[`Planck2018I`\]: 3362.08 uK towards galactic (264.021, 48.253) deg.
//!
//! Limits: a monopole is not part of any sky made here.

use super::signal::SkyField;
use crate::harmonics::{Alm, Complex64, MAX_DEGREE, Rings, SpinAlm, TransformError, gaussian_beam};
use crate::survey::MapFrame;
use onboard_core::direction::Direction;
use std::f64::consts::PI;
use thiserror::Error;

/// Amplitude of the solar dipole in uK.
pub const DIPOLE_UK: f64 = 3362.08;
/// Galactic longitude of its warm pole in degrees.
pub const DIPOLE_LONGITUDE_DEG: f64 = 264.021;
/// Galactic latitude of its warm pole in degrees.
pub const DIPOLE_LATITUDE_DEG: f64 = 48.253;

/// Iterations of the transform of a sky's maps.
const ITERATIONS: usize = 3;

/// A line that is no coefficient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("line {line}: field,l,m,real,imaginary, such as E,3,2,1.0,0.5, is needed")]
pub struct AlmTableError {
    /// Its number from 1.
    pub line: usize,
}

/// A sky by its coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct SkyAlms {
    /// Temperature.
    pub t: Alm,
    /// Gradient polarisation.
    pub e: Alm,
    /// Curl polarisation.
    pub b: Alm,
}

impl SkyAlms {
    /// No sky, to degree `l_max`.
    #[must_use]
    pub fn zero(l_max: usize) -> Self {
        let none = Alm::zero(l_max);
        Self { t: none.clone(), e: none.clone(), b: none }
    }

    /// The unpolarised dipole of a vector in the map's frame.
    #[must_use]
    pub fn dipole([x, y, z]: [f64; 3]) -> Self {
        let mut sky = Self::zero(1);
        // z cos(theta) = z sqrt(4 pi / 3) Y_10; a_11 = -sqrt(2 pi / 3) (x - i y)
        sky.t.set(1, 0, (z * (4.0 * PI / 3.0).sqrt()).into());
        sky.t.set(1, 1, Complex64::new(-x, y) * (2.0 * PI / 3.0).sqrt());
        sky
    }

    /// From lines `field,l,m,real,imaginary`, field T, E or B, m not negative; those of `#` left out.
    ///
    /// # Errors
    /// [`AlmTableError`], the line that is none.
    pub fn from_csv(text: &str) -> Result<Self, AlmTableError> {
        let mut rows = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') || line.starts_with("field") {
                continue;
            }
            let wrong = AlmTableError { line: number + 1 };
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            let &[field, l, m, re, im] = cells.as_slice() else { return Err(wrong) };
            let whole = |text: &str| text.parse::<usize>().map_err(|_| wrong);
            let part = |text: &str| {
                text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or(wrong)
            };
            let (l, m, value) = (whole(l)?, whole(m)?, Complex64::new(part(re)?, part(im)?));
            let least = if field == "T" { 0 } else { 2 };
            let real = m > 0 || value.im.abs() < f64::MIN_POSITIVE;
            let known = ["T", "E", "B"].contains(&field);
            if !known || m > l || l < least || l > MAX_DEGREE || !real {
                return Err(wrong);
            }
            rows.push((field, l, m, value));
        }
        let l_max = rows.iter().map(|row| row.1).max().unwrap_or(0);
        let mut sky = Self::zero(l_max);
        for (field, l, m, value) in rows {
            match field {
                "T" => sky.t.set(l, m, value),
                "E" => sky.e.set(l, m, value),
                _ => sky.b.set(l, m, value),
            }
        }
        Ok(sky)
    }

    /// From maps of I and of P, RING order, as far as a transform with three iterations has them.
    ///
    /// # Errors
    /// [`TransformError`] for maps of another resolution, or a degree that is too large.
    pub fn of_maps(
        rings: &Rings,
        intensity: &[f64],
        polarisation: &[Complex64],
        l_max: usize,
    ) -> Result<Self, TransformError> {
        let t = rings.scalar_alm(intensity, l_max, ITERATIONS)?;
        let SpinAlm { e, b, .. } = rings.alm(2, polarisation, l_max, ITERATIONS)?;
        Ok(Self { t, e, b })
    }

    /// Seen through a Gaussian beam, that of T for all three, as
    /// [`CmbSpectra::through_beam`](super::CmbSpectra::through_beam) has it.
    #[must_use]
    pub fn through_beam(&self, fwhm_rad: f64) -> Self {
        let through = |alm: &Alm| {
            let beam = gaussian_beam(fwhm_rad, 0, alm.l_max());
            alm.weighted(|l| beam[l])
        };
        Self { t: through(&self.t), e: through(&self.e), b: through(&self.b) }
    }

    /// A field of it; none for a polarisation lowered beyond spin 0.
    #[must_use]
    pub fn field(&self, field: SkyField) -> Option<SpinAlm> {
        let raised = |mut alm: SpinAlm, times: u32| {
            for _ in 0..times {
                alm = alm.raised();
            }
            alm
        };
        match field {
            SkyField::Temperature(times) => {
                Some(raised(SpinAlm::scalar(&self.t), u32::from(times)))
            }
            SkyField::Polarisation(times) => {
                let polarisation = SpinAlm { spin: 2, e: self.e.clone(), b: self.b.clone() };
                if times >= 0 {
                    return Some(raised(polarisation, times.unsigned_abs().into()));
                }
                (0..times.unsigned_abs()).try_fold(polarisation, |alm, _| alm.lowered())
            }
        }
    }

    /// The map of a field, RING order.
    ///
    /// # Errors
    /// [`TransformError`] for degrees and spins that are too large.
    pub fn map(&self, rings: &Rings, field: SkyField) -> Result<Vec<Complex64>, TransformError> {
        match self.field(field) {
            Some(alm) => rings.map(&alm),
            None => Err(TransformError::Spin(usize::MAX)),
        }
    }
}

/// A dipole of the temperature by its size and the galactic place of its warm pole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dipole {
    /// Amplitude in uK.
    pub amplitude_uk: f64,
    /// Galactic longitude in degrees.
    pub longitude_deg: f64,
    /// Galactic latitude in degrees.
    pub latitude_deg: f64,
}

impl Dipole {
    /// The solar dipole of \[`Planck2018I`\].
    pub const SOLAR: Self = Self {
        amplitude_uk: DIPOLE_UK,
        longitude_deg: DIPOLE_LONGITUDE_DEG,
        latitude_deg: DIPOLE_LATITUDE_DEG,
    };

    /// Its vector in uK in a map's frame.
    #[must_use]
    pub fn vector_uk(&self, frame: MapFrame) -> [f64; 3] {
        let (sin_l, cos_l) = self.longitude_deg.to_radians().sin_cos();
        let (sin_b, cos_b) = self.latitude_deg.to_radians().sin_cos();
        let galactic = [cos_b * cos_l, cos_b * sin_l, sin_b];
        let back = MapFrame::Galactic.from_ecliptic().inverse();
        let to = match Direction::new(galactic[0], galactic[1], galactic[2]) {
            Some(warm) if frame != MapFrame::Galactic => {
                frame.from_ecliptic().apply(back.apply(warm)).xyz()
            }
            _ => galactic,
        };
        to.map(|x| self.amplitude_uk * x)
    }
}

/// The solar dipole's vector in uK in a map's frame.
#[must_use]
pub fn solar_dipole_uk(frame: MapFrame) -> [f64; 3] {
    Dipole::SOLAR.vector_uk(frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::{Nside, unit_vector};

    #[test]
    fn the_solar_dipole_points_where_it_does() {
        // (-3263.7804, 477.9744, -650.2747) uK from another program's galactic axes, which are tied
        // to FK5 and 0.02 arcsec off.
        let found = solar_dipole_uk(MapFrame::Ecliptic);
        for (a, b) in found.iter().zip([-3_263.780_427, 477.974_367, -650.274_686]) {
            assert!((a - b).abs() < 1e-3, "{found:?}");
        }
        let length = found.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((length - DIPOLE_UK).abs() < 1e-9);
    }

    #[test]
    fn a_dipole_of_ones_own_has_its_size_and_place() {
        let pole = Dipole { amplitude_uk: 2.0, longitude_deg: 0.0, latitude_deg: 90.0 };
        assert!((pole.vector_uk(MapFrame::Galactic)[2] - 2.0).abs() < 1e-15);
        // The galactic pole has ecliptic latitude 29.81 deg.
        let ecliptic = pole.vector_uk(MapFrame::Ecliptic);
        assert!((ecliptic[2] - 2.0 * 29.811_4_f64.to_radians().sin()).abs() < 1e-4);
    }

    #[test]
    fn a_dipole_is_a_projection() {
        let nside = Nside::new(4).unwrap();
        let vector = [0.3, -2.0, 0.7];
        let map = SkyAlms::dipole(vector).map(&Rings::new(nside), SkyField::I).unwrap();
        for (ring, value) in (0..).zip(map) {
            let (lon, lat) = nside.center(nside.nested_of_ring(ring));
            let expected: f64 = unit_vector(lon, lat).iter().zip(vector).map(|(a, b)| a * b).sum();
            assert!((value - expected).norm() < 1e-14);
        }
    }

    #[test]
    fn coefficients_are_read_from_lines() {
        let text = "# a sky\nfield,l,m,real,imaginary\nT, 2,1, 3,-4\nE,3,2,1,0.5\n\nB,4,0,0.3,0\n";
        let sky = SkyAlms::from_csv(text).unwrap();
        assert_eq!((sky.t.l_max(), sky.t.at(2, 1)), (4, Complex64::new(3.0, -4.0)));
        assert_eq!(sky.e.at(3, 2), Complex64::new(1.0, 0.5));
        assert_eq!(sky.b.at(4, 0), Complex64::new(0.3, 0.0));
        for bad in ["T,1,2,0,0", "T,2,0,1,1", "E,1,0,1,0", "V,2,0,1,0", "T,2,0,1", "T,2,0,nan,0"] {
            let text = format!("T,2,0,1,0\n{bad}\n");
            assert_eq!(SkyAlms::from_csv(&text), Err(AlmTableError { line: 2 }), "{bad}");
        }
    }

    #[test]
    fn a_sky_comes_back_from_its_maps() {
        let sky = SkyAlms::from_csv("T,2,1,3,-4\nE,3,2,1,0.5\nB,4,0,0.3,0\n").unwrap();
        let rings = Rings::new(Nside::new(8).unwrap());
        let intensity: Vec<f64> =
            sky.map(&rings, SkyField::I).unwrap().iter().map(|value| value.re).collect();
        let polarisation = sky.map(&rings, SkyField::P).unwrap();
        let back = SkyAlms::of_maps(&rings, &intensity, &polarisation, 10).unwrap();
        assert!((back.t.at(2, 1) - sky.t.at(2, 1)).norm() < 1e-6);
        assert!((back.e.at(3, 2) - sky.e.at(3, 2)).norm() < 1e-6);
        assert!((back.b.at(4, 0) - sky.b.at(4, 0)).norm() < 1e-6);
    }

    #[test]
    fn lowering_beyond_spin_zero_is_no_field() {
        let sky = SkyAlms::zero(3);
        assert_eq!(sky.field(SkyField::Polarisation(-2)).unwrap().spin, 0);
        assert_eq!(sky.field(SkyField::Polarisation(-3)), None);
        assert_eq!(sky.field(SkyField::Temperature(3)).unwrap().spin, 3);
    }
}
