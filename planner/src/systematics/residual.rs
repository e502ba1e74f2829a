//! What a systematic effect leaves in the maps: the solution for its signal alone.
//!
//! A term `2 Re[f X exp(i (n psi + m phi))]` gives, with g the means of `exp(i (n psi + m phi))`,
//!
//! `<d> = f X g_(n,m) + c.c.`, `<d z> = t [f X g_(n+2,m-4) + conj(f X) g_(2-n,-m-4)]`, z = t exp(i (2 psi - 4 phi)),
//!
//! which the pixel's inverse turns into `dP = sum W X + W' conj X`, dI likewise: the system is linear,
//! so the sky itself need not be solved for. [`Coupling`] has the W of every pixel.
//!
//! Limits: pixels without samples, and singular ones, are NaN and counted. In spectra they are left
//! out of the pixel sum.

use super::orientation::{Mean, OrientationError, Orientations, Polarimeter};
use super::signal::{SkyField, Term};
use super::sky::SkyAlms;
use super::solve::{Inverse, Solver, Unsolved, turn};
use crate::harmonics::{Complex64, Rings, Spectra, SpinAlm, TransformError};
use crate::healpix::Nside;
use rayon::prelude::*;
use thiserror::Error;

/// Why there is no residual.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum SystematicsError {
    /// Orientation functions are missing.
    #[error(transparent)]
    Orientation(#[from] OrientationError),
    /// Fields that cannot be transformed.
    #[error(transparent)]
    Transform(#[from] TransformError),
}

/// How the fields of a signal enter the maps of a survey.
#[derive(Debug, Clone)]
pub struct Coupling<'h> {
    solver: Solver<'h>,
    terms: Vec<Coupled<'h>>,
    fields: Vec<SkyField>,
    turn: Complex64,
    nside: Nside,
}

#[derive(Debug, Clone, Copy)]
struct Coupled<'h> {
    factor: Complex64,
    means: [Mean<'h>; 3],
    /// Index of its field.
    field: usize,
}

/// What multiplies X, and conj X.
pub(super) type Weights = [Complex64; 2];

impl<'h> Coupling<'h> {
    /// Of a signal.
    ///
    /// # Errors
    /// [`OrientationError::Missing`] for an orientation function that the survey has not collected.
    pub fn new(
        orientations: &'h Orientations,
        terms: &[Term],
        polarimeter: &Polarimeter,
    ) -> Result<Self, OrientationError> {
        let mut fields: Vec<SkyField> = terms.iter().map(|term| term.field).collect();
        fields.sort_unstable();
        fields.dedup();
        let coupled = |term: &Term| -> Result<Coupled<'h>, OrientationError> {
            let [own, with_z, conjugate] = polarimeter.spins_of(term);
            let means = [
                orientations.mean(own)?,
                orientations.mean(with_z)?,
                orientations.mean(conjugate)?,
            ];
            let field = fields.iter().position(|&field| field == term.field).unwrap_or(0);
            Ok(Coupled { factor: term.factor, means, field })
        };
        let terms: Result<Vec<Coupled<'h>>, OrientationError> = terms.iter().map(coupled).collect();
        Ok(Self {
            solver: Solver::new(orientations, polarimeter)?,
            terms: terms?,
            turn: turn(polarimeter),
            nside: orientations.nside(),
            fields,
        })
    }

    /// The fields of the sky that enter.
    #[must_use]
    pub fn fields(&self) -> &[SkyField] {
        &self.fields
    }

    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.nside
    }

    /// Pixels without samples, and observed pixels without a solution.
    #[must_use]
    pub fn unsolved(&self) -> [usize; 2] {
        let count = |which: Unsolved| {
            let pixels = 0..self.nside.pixels() as usize;
            pixels.into_par_iter().filter(|&pixel| self.solver.at(pixel) == Err(which)).count()
        };
        [count(Unsolved::Unobserved), count(Unsolved::Singular)]
    }

    /// By field, what multiplies X and its conjugate in dI and in dP.
    pub(super) fn weights(
        &self,
        pixel: usize,
        add: &mut dyn FnMut(usize, [Weights; 2]),
    ) -> Result<(), Unsolved> {
        let inverse = self.solver.at(pixel)?;
        for term in &self.terms {
            let [own, with_z, conjugate] = term.means.map(|mean| mean.at(pixel));
            // <d> = f X own + ..., <d z> = f X straight + conj(f X) crossed
            let (straight, crossed) = (self.turn * with_z, self.turn * conjugate);
            let weigh = |[a, b, c]: [Complex64; 3]| {
                [
                    term.factor * (a * own + b * straight + c * crossed.conj()),
                    term.factor.conj() * (a * own.conj() + b * crossed + c * straight.conj()),
                ]
            };
            let Inverse { intensity, polarisation } = inverse;
            add(term.field, [weigh(intensity), weigh(polarisation)]);
        }
        Ok(())
    }

    /// The residual on a sky.
    ///
    /// # Errors
    /// [`TransformError`] for fields that cannot be transformed.
    pub fn residual(&self, rings: &Rings, sky: &SkyAlms) -> Result<Residual, TransformError> {
        let maps: Result<Vec<Vec<Complex64>>, TransformError> =
            self.fields.iter().map(|&field| sky.map(rings, field)).collect();
        self.residual_of(&maps?)
    }

    /// The residual on fields, in the order of [`Coupling::fields`], RING order.
    ///
    /// # Errors
    /// [`TransformError::Pixels`] where there are not as many maps as fields, each of this resolution.
    pub fn residual_of(&self, maps: &[Vec<Complex64>]) -> Result<Residual, TransformError> {
        let needed = self.nside.pixels() as usize;
        let lengths = maps.iter().map(Vec::len).find(|&length| length != needed);
        if let Some(found) = lengths.or((maps.len() != self.fields.len()).then_some(0)) {
            return Err(TransformError::Pixels { found, needed });
        }
        let pixel = |pixel: usize| {
            let mut to = [Complex64::ZERO; 2];
            let unsolved = self.weights(pixel, &mut |field, weights| {
                let x = maps[field][pixel];
                for (to, [plain, conjugate]) in to.iter_mut().zip(weights) {
                    *to += plain * x + conjugate * x.conj();
                }
            });
            unsolved.map(|()| to)
        };
        let solved: Vec<Result<[Complex64; 2], Unsolved>> =
            (0..needed).into_par_iter().map(pixel).collect();
        let count = |which| solved.iter().filter(|it| **it == Err(which)).count();
        let nan = Complex64::new(f64::NAN, f64::NAN);
        let part =
            |at: usize| solved.iter().map(move |it| it.as_ref().map_or(nan, |both| both[at]));
        Ok(Residual {
            nside: self.nside,
            intensity: part(0).map(|value| value.re).collect(),
            polarisation: part(1).collect(),
            unobserved: count(Unsolved::Unobserved),
            singular: count(Unsolved::Singular),
        })
    }
}

/// Residual maps, RING order, NaN where a pixel has no solution.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    nside: Nside,
    /// dI.
    pub intensity: Vec<f64>,
    /// dQ + i dU, COSMO sense.
    pub polarisation: Vec<Complex64>,
    /// Pixels without samples.
    pub unobserved: usize,
    /// Observed pixels whose angles do not tell I, Q and U apart.
    pub singular: usize,
}

impl Residual {
    /// Resolution.
    #[must_use]
    pub const fn nside(&self) -> Nside {
        self.nside
    }

    /// Root of the mean of `|dP|^2` over the solved pixels; 0 where there are none.
    #[must_use]
    pub fn rms_polarisation(&self) -> f64 {
        let solved = self.polarisation.iter().filter(|value| !value.is_nan());
        let (count, sum) = solved
            .fold((0.0_f64, 0.0), |(count, sum), value| (count + 1.0, sum + value.norm_sqr()));
        (sum / count.max(1.0)).sqrt()
    }

    /// E and B of the residual, pixels without a solution left out, iterated as often as asked for.
    ///
    /// # Errors
    /// [`TransformError`] for a degree that is too large.
    pub fn polarisation_alm(
        &self,
        rings: &Rings,
        l_max: usize,
        iterations: usize,
    ) -> Result<SpinAlm, TransformError> {
        let zeroed = |value: &Complex64| if value.is_nan() { Complex64::ZERO } else { *value };
        let map: Vec<Complex64> = self.polarisation.iter().map(zeroed).collect();
        rings.alm(2, &map, l_max, iterations)
    }

    /// Spectra of the residual, as [`Residual::polarisation_alm`].
    ///
    /// # Errors
    /// [`TransformError`] for a degree that is too large.
    pub fn spectra(
        &self,
        rings: &Rings,
        l_max: usize,
        iterations: usize,
    ) -> Result<Spectra, TransformError> {
        let zeroed: Vec<f64> =
            self.intensity.iter().map(|&value| if value.is_nan() { 0.0 } else { value }).collect();
        let temperature = rings.scalar_alm(&zeroed, l_max, iterations)?;
        let polarisation = self.polarisation_alm(rings, l_max, iterations)?;
        Ok(Spectra::of(Some(&temperature), &polarisation))
    }
}
