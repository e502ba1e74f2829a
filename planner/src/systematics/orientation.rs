//! Orientation functions of all pixels, as the coupling of spins reads them.
//!
//! `h_nm = <exp(-i (n psi + m phi))>` per pixel, RING order; what enters is its conjugate, the mean of
//! `exp(i (n psi + m phi))`. Of (n, m) and (-n, -m) one is kept.
//!
//! They come from one pass of a survey that collects [`moments`], or from maps of an earlier one.

use super::signal::Term;
use crate::harmonics::Complex64;
use crate::healpix::Nside;
use crate::survey::{Moment, MomentError, SurveyMaps};
use std::collections::BTreeMap;
use thiserror::Error;

/// n and m.
pub type Spin = [i32; 2];

/// What a detector's samples tell of the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polarimeter {
    /// Multiple of the plate's angle that modulates the polarisation: 4 behind a plate, 0 without.
    pub plate_order: i32,
    /// Angle from the detector's x axis to its sensitive direction, in the sense of psi.
    pub polarisation_rad: f64,
    /// Whether half the difference of a pair is measured, in which I is not solved for.
    pub pair: bool,
}

impl Polarimeter {
    /// One detector behind a half-wave plate.
    pub const PLATE: Self = Self { plate_order: 4, polarisation_rad: 0.0, pair: false };
    /// The difference of a pair without a plate.
    pub const PAIR: Self = Self { plate_order: 0, polarisation_rad: 0.0, pair: true };

    /// The spins in which a term reaches `<d>` and `<d z>`: its own; with z; its conjugate with z.
    pub(super) const fn spins_of(&self, term: &Term) -> [Spin; 3] {
        let Term { n, m, .. } = *term;
        [[n, m], [n + 2, m - self.plate_order], [2 - n, -m - self.plate_order]]
    }

    /// The spins of `<z>` and `<z^2>`.
    pub(super) const fn own_spins(&self) -> [Spin; 2] {
        [[2, -self.plate_order], [4, -2 * self.plate_order]]
    }
}

/// The orientation functions that terms need, each once, of (n, m) and (-n, -m) one.
///
/// # Errors
/// [`MomentError`] for a spin that a survey does not collect.
pub fn moments(terms: &[Term], polarimeter: &Polarimeter) -> Result<Vec<Moment>, MomentError> {
    let own = polarimeter.own_spins();
    let all = terms.iter().flat_map(|term| polarimeter.spins_of(term)).chain(own);
    let mut spins: Vec<Spin> =
        all.map(|spin| canonical(spin).0).filter(|&spin| spin != [0, 0]).collect();
    spins.sort_unstable();
    spins.dedup();
    spins.into_iter().map(|[n, m]| Moment::new(f64::from(n), f64::from(m))).collect()
}

/// The one of (n, m) and (-n, -m) that is kept, and whether it is the other.
fn canonical([n, m]: Spin) -> (Spin, bool) {
    if n < 0 || (n == 0 && m < 0) { ([-n, -m], true) } else { ([n, m], false) }
}

/// Maps that are no orientation functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum OrientationError {
    /// One that is needed is missing.
    #[error("h of n = {}, m = {} is missing", .0[0], .0[1])]
    Missing(Spin),
    /// A map of another resolution.
    #[error("{found} values of h where {needed} are needed")]
    Pixels {
        /// Values given.
        found: usize,
        /// Pixels of the resolution.
        needed: usize,
    },
}

/// Orientation functions of all pixels.
#[derive(Debug, Clone)]
pub struct Orientations {
    nside: Nside,
    hits: Vec<u64>,
    h: BTreeMap<Spin, Vec<Complex64>>,
}

impl Orientations {
    /// Those of a survey, whose moments of half-integer orders are left out.
    #[must_use]
    pub fn of_survey(maps: &SurveyMaps) -> Self {
        let nside = maps.nside();
        let order: Vec<u32> = (0..nside.pixels()).map(|ring| nside.nested_of_ring(ring)).collect();
        let mut h = BTreeMap::new();
        for (index, moment) in maps.moments().iter().enumerate() {
            let Some(spin) = whole(*moment) else { continue };
            let (re, im) = (maps.real_map(index), maps.imaginary_map(index));
            let value = |&nested: &u32| Complex64::new(re[nested as usize], im[nested as usize]);
            insert(&mut h, spin, order.iter().map(value).collect());
        }
        Self { nside, hits: order.iter().map(|&nested| maps.hits(nested)).collect(), h }
    }

    /// From hits and h by RING pixel; of moments of half-integer orders none is taken.
    ///
    /// # Errors
    /// [`OrientationError::Pixels`] for a map of another length.
    pub fn of_moments(
        nside: Nside,
        hits: Vec<u64>,
        functions: impl Iterator<Item = (Moment, Vec<Complex64>)>,
    ) -> Result<Self, OrientationError> {
        let whole = functions.filter_map(|(moment, map)| Some((whole(moment)?, map)));
        Self::new(nside, hits, whole.collect())
    }

    /// From hits and h by RING pixel.
    ///
    /// # Errors
    /// [`OrientationError::Pixels`] for a map of another length.
    pub fn new(
        nside: Nside,
        hits: Vec<u64>,
        functions: Vec<(Spin, Vec<Complex64>)>,
    ) -> Result<Self, OrientationError> {
        let needed = nside.pixels() as usize;
        let lengths = functions.iter().map(|(_, map)| map.len()).chain([hits.len()]);
        if let Some(found) = lengths.into_iter().find(|&found| found != needed) {
            return Err(OrientationError::Pixels { found, needed });
        }
        let mut h = BTreeMap::new();
        for (spin, map) in functions {
            insert(&mut h, spin, map);
        }
        Ok(Self { nside, hits, h })
    }

    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.nside
    }

    /// Samples by RING pixel.
    #[must_use]
    pub fn hits(&self) -> &[u64] {
        &self.hits
    }

    /// Pixels without a sample.
    #[must_use]
    pub fn unobserved(&self) -> usize {
        self.hits.iter().filter(|&&hits| hits == 0).count()
    }

    /// Where the means of a spin are found.
    pub(super) fn mean(&self, spin: Spin) -> Result<Mean<'_>, OrientationError> {
        if spin == [0, 0] {
            return Ok(Mean::One);
        }
        let (kept, other) = canonical(spin);
        let map = self.h.get(&kept).ok_or(OrientationError::Missing(spin))?;
        // The mean of exp(i (n psi + m phi)) is conj h_nm = h_(-n,-m).
        Ok(if other { Mean::Plain(map) } else { Mean::Conjugate(map) })
    }
}

/// Means of `exp(i (n psi + m phi))` by RING pixel.
#[derive(Debug, Clone, Copy)]
pub(super) enum Mean<'h> {
    One,
    Plain(&'h [Complex64]),
    Conjugate(&'h [Complex64]),
}

impl Mean<'_> {
    pub(super) fn at(self, pixel: usize) -> Complex64 {
        match self {
            Self::One => Complex64::ONE,
            Self::Plain(map) => map[pixel],
            Self::Conjugate(map) => map[pixel].conj(),
        }
    }
}

fn insert(h: &mut BTreeMap<Spin, Vec<Complex64>>, spin: Spin, map: Vec<Complex64>) {
    let (kept, other) = canonical(spin);
    let map = if other { map.iter().map(Complex64::conj).collect() } else { map };
    h.insert(kept, map);
}

/// n and m of a moment, if they are whole.
fn whole(moment: Moment) -> Option<Spin> {
    let whole = |x: f64| {
        #[expect(clippy::cast_possible_truncation, reason = "whole, and 64 at most")]
        (x.fract() == 0.0).then_some(x as i32)
    };
    Some([whole(moment.n())?, whole(moment.m())?])
}

#[cfg(test)]
mod tests {
    use super::super::effects::{HwpIp, IpForm, Pointing};
    use super::super::signal::Effect;
    use super::*;

    #[test]
    fn each_function_is_asked_for_once() {
        let mut terms = Pointing { rho_rad: 1.0, chi_rad: 0.3 }.terms();
        let of = |terms: &[Term]| -> Vec<Spin> {
            let moments = moments(terms, &Polarimeter::PLATE).unwrap();
            moments.into_iter().filter_map(whole).collect()
        };
        assert_eq!(of(&terms), [[1, -4], [1, 0], [2, -4], [3, -8], [3, -4], [4, -8], [5, -8]]);
        let ip = HwpIp { epsilon: 1.0, phi_qi_rad: 0.0, form: IpForm::Literal };
        terms.extend(ip.terms());
        // (-4, 4), (-2, 0) and (6, -8) are added.
        assert_eq!(of(&terms).len(), 10);
    }

    #[test]
    fn conjugates_stand_for_negative_spins() {
        let nside = Nside::new(1).unwrap();
        let map: Vec<Complex64> = (0..12_u8).map(|p| Complex64::new(f64::from(p), 1.0)).collect();
        let h = Orientations::new(nside, vec![1; 12], vec![([-2, 4], map.clone())]).unwrap();
        assert_eq!(h.mean([2, -4]).unwrap().at(3), map[3]);
        assert_eq!(h.mean([-2, 4]).unwrap().at(3), map[3].conj());
        assert_eq!(h.mean([0, 0]).unwrap().at(3), Complex64::ONE);
        assert_eq!(h.mean([1, 0]).unwrap_err(), OrientationError::Missing([1, 0]));
        let short = Orientations::new(nside, vec![1; 11], Vec::new()).unwrap_err();
        assert_eq!(short, OrientationError::Pixels { found: 11, needed: 12 });
    }
}
