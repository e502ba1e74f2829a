//! One effect from a survey's orientation functions to r.
//!
//! [`Asked`] names a signal, what measures it and the sky it acts on; [`Asked::study`] gives spectra, bias
//! and, where the sky is one, the residual's maps.
//!
//! Limits: the spectra go to the likelihood's last degree.

use super::cmb::CmbSpectra;
use super::expectation::mean_spectra;
use super::likelihood::{Bias, Likelihood, LikelihoodError};
use super::orientation::{Orientations, Polarimeter};
use super::residual::{Coupling, Residual, SystematicsError};
use super::signal::Term;
use super::sky::SkyAlms;
use crate::harmonics::{Rings, TransformError};
use thiserror::Error;

/// The sky that an effect acts on.
#[derive(Debug, Clone, PartialEq)]
pub enum StudySky {
    /// A sky by its coefficients.
    Given(SkyAlms),
    /// The mean over all CMB skies of these spectra, to their last degree.
    Mean(CmbSpectra),
}

/// An effect on a sky.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Its signal.
    pub terms: Vec<Term>,
    /// What measures it.
    pub polarimeter: Polarimeter,
    /// The sky.
    pub sky: StudySky,
}

/// What an effect does.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// E of the residual by l from 0.
    pub ee: Vec<f64>,
    /// B of the residual by l from 0.
    pub bb: Vec<f64>,
    /// What it does to r.
    pub bias: Bias,
    /// Pixels without samples.
    pub unobserved: usize,
    /// Observed pixels without a solution.
    pub singular: usize,
    /// The maps, of a given sky.
    pub residual: Option<Residual>,
}

/// Why an effect has no answer.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum StudyError {
    /// No residual.
    #[error(transparent)]
    Systematics(#[from] SystematicsError),
    /// No estimate of r.
    #[error(transparent)]
    Likelihood(#[from] LikelihoodError),
}

impl From<TransformError> for StudyError {
    fn from(error: TransformError) -> Self {
        Self::Systematics(error.into())
    }
}

impl Asked {
    /// What the effect does in a survey; `iterations` of the transform of a given sky's residual.
    ///
    /// # Errors
    /// [`StudyError`] for orientation functions that are missing, and for spectra that do not fit.
    pub fn study(
        &self,
        orientations: &Orientations,
        rings: &Rings,
        likelihood: &Likelihood,
        iterations: usize,
    ) -> Result<Found, StudyError> {
        let coupling = Coupling::new(orientations, &self.terms, &self.polarimeter)
            .map_err(SystematicsError::from)?;
        let l_max = likelihood.degrees[1];
        let (ee, bb, residual) = match &self.sky {
            StudySky::Given(sky) => {
                let residual = coupling.residual(rings, sky)?;
                let alm = residual.polarisation_alm(rings, l_max, iterations)?;
                let found = crate::harmonics::Spectra::of(None, &alm);
                (found.ee, found.bb, Some(residual))
            }
            StudySky::Mean(spectra) => {
                let found = mean_spectra(&coupling, rings, spectra, l_max)?;
                // A difference of two sums: where B is zero, rounding may leave it below.
                let least = 1e-12 * found.bb.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let zeroed = |x: f64| if x < 0.0 && x >= -least { 0.0 } else { x };
                (found.ee, found.bb.into_iter().map(zeroed).collect(), None)
            }
        };
        let bias = likelihood.bias(&bb)?;
        let [unobserved, singular] = coupling.unsolved();
        Ok(Found { ee, bb, bias, unobserved, singular, residual })
    }
}
