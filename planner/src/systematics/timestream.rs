//! The same systematic signal sample by sample, and the maps that map-making gives back.
//!
//! A sample in pixel p measures `sum over terms of 2 Re[f X(p) exp(i (n psi + m phi))]`, with X at the
//! pixel's centre, as the coupling of spins has it: both are the same up to rounding.
//!
//! Method: [`MapMaker`] with a sky of zeros that is only there to tell pixels.
//!
//! Limits: detectors that share one polarisation angle, plates or not; no pairs. True re-pointing, with
//! samples where they fall within pixels, is another signal (`docs/systematics.md`).

use super::signal::SkyField;
use super::signal::Term;
use super::sky::SkyAlms;
use crate::harmonics::{Complex64, Rings, TransformError};
use crate::healpix::Ordering;
use crate::mapmaking::{
    CONDITION_LIMIT, MapMaker, PolarisationConvention, Sample, Sky, SkyError, SkyMap, StokesMaps,
};
use crate::progress::Progress;
use crate::survey::{Isa, Survey, SurveyError};
use std::ops::Range;
use thiserror::Error;

/// Why there are no maps.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum TimestreamError {
    /// Fields that cannot be transformed.
    #[error(transparent)]
    Transform(#[from] TransformError),
    /// The sky of zeros.
    #[error(transparent)]
    Sky(#[from] SkyError),
    /// The survey.
    #[error(transparent)]
    Survey(#[from] SurveyError),
}

/// The fields of a signal by NESTED pixel.
#[derive(Debug)]
pub struct Timestream {
    terms: Vec<(Term, usize)>,
    fields: Vec<Vec<Complex64>>,
    /// `exp(i (psi - psi_pol))`.
    back: Complex64,
}

impl Timestream {
    /// Of terms on a sky, measured by a detector with this polarisation angle from its x axis.
    ///
    /// # Errors
    /// [`TransformError`] for fields that cannot be transformed.
    pub fn new(
        rings: &Rings,
        terms: &[Term],
        sky: &SkyAlms,
        polarisation_rad: f64,
    ) -> Result<Self, TransformError> {
        let nside = rings.nside();
        let mut names: Vec<SkyField> = Vec::new();
        let mut fields = Vec::new();
        let mut placed = Vec::new();
        for term in terms {
            let at = if let Some(at) = names.iter().position(|&name| name == term.field) {
                at
            } else {
                let ring = sky.map(rings, term.field)?;
                let by_nested =
                    (0..nside.pixels()).map(|nested| ring[nside.ring_of_nested(nested) as usize]);
                fields.push(by_nested.collect());
                names.push(term.field);
                names.len() - 1
            };
            placed.push((*term, at));
        }
        // psi_pol = psi + 90 deg + the detector's own angle
        let back = -Complex64::I * Complex64::from_polar(1.0, -polarisation_rad);
        Ok(Self { terms: placed, fields, back })
    }

    /// What a sample measures.
    #[must_use]
    pub fn signal(&self, sample: &Sample) -> f64 {
        let complex = |(re, im): (f64, f64)| Complex64::new(re, im);
        let psi = complex(sample.polarisation) * self.back;
        let phi = complex(sample.plate);
        let of = |(term, field): &(Term, usize)| {
            let x = self.fields[*field][sample.pixel as usize];
            2.0 * (term.factor * x * psi.powi(term.n) * phi.powi(term.m)).re
        };
        self.terms.iter().map(of).sum()
    }

    /// The maps of a survey's samples `span`.
    ///
    /// # Errors
    /// [`TimestreamError`] of the survey, or where the signal is of another resolution.
    pub fn maps(
        &self,
        survey: &Survey,
        span: Range<u64>,
        progress: &dyn Progress,
    ) -> Result<StokesMaps, TimestreamError> {
        let zeros = vec![0.0; survey.nside.pixels() as usize];
        let needed = zeros.len();
        if let Some(found) = self.fields.iter().map(Vec::len).find(|&found| found != needed) {
            return Err(TransformError::Pixels { found, needed }.into());
        }
        let sky = Sky::new(&SkyMap {
            nside: survey.nside,
            ordering: Ordering::Nested,
            frame: survey.frame,
            convention: PolarisationConvention::Cosmo,
            stokes: [&zeros; 3],
        })?;
        let mut maker = MapMaker::new(survey.clone(), sky.into(), Isa::best())?;
        maker.collect(span, 0, progress, &|sample: &Sample| self.signal(sample))?;
        Ok(maker.finish().stokes(CONDITION_LIMIT))
    }
}
