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
use super::realisation::realisation;
use super::residual::{Coupling, Residual, SystematicsError};
use super::signal::{SkyField, Term};
use super::sky::SkyAlms;
use crate::harmonics::{Rings, TransformError};
use std::ops::Range;
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
    /// No pixel has a solution.
    #[error(
        "no pixel has I, Q and U: {unobserved} without samples, {singular} whose angles do not tell \
         them apart"
    )]
    Unsolved {
        /// Pixels without samples.
        unobserved: usize,
        /// Observed pixels without a solution.
        singular: usize,
    },
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
        let [unobserved, singular] = coupling.unsolved();
        if unobserved + singular == orientations.hits().len() {
            return Err(StudyError::Unsolved { unobserved, singular });
        }
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
        Ok(Found { ee, bb, bias, unobserved, singular, residual })
    }

    /// The effect on T alone and on E and B alone, where it acts on both.
    #[must_use]
    pub fn parts(&self) -> Option<[Self; 2]> {
        let on_temperature = |term: &Term| matches!(term.field, SkyField::Temperature(_));
        let (temperature, polarisation): (Vec<Term>, Vec<Term>) =
            self.terms.iter().partition(|term| on_temperature(term));
        if temperature.is_empty() || polarisation.is_empty() {
            return None;
        }
        Some([temperature, polarisation].map(|terms| Self { terms, ..self.clone() }))
    }

    /// The bias on one CMB sky per seed, where the mean over all is asked for; empty otherwise.
    ///
    /// # Errors
    /// As [`Asked::study`].
    pub fn scatter(
        &self,
        orientations: &Orientations,
        rings: &Rings,
        likelihood: &Likelihood,
        seeds: Range<u64>,
    ) -> Result<Vec<f64>, StudyError> {
        let StudySky::Mean(spectra) = &self.sky else { return Ok(Vec::new()) };
        seeds
            .map(|seed| {
                let sky = StudySky::Given(realisation(spectra, spectra.l_max(), seed));
                let one = Self { sky, terms: self.terms.clone(), polarimeter: self.polarimeter };
                Ok(one.study(orientations, rings, likelihood, 0)?.bias.delta_r)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::cmb::TensorTilt;
    use super::super::effects::{HwpIp, IpForm, Pointing};
    use super::super::signal::Effect;
    use super::*;
    use crate::harmonics::Complex64;
    use crate::healpix::Nside;

    /// Angles spread evenly but for `h_20 = 0.4` and `h_10 = 0.2`, in all pixels or in none.
    fn orientations(terms: &[Term], hits: u64, z: f64) -> Orientations {
        let nside = Nside::new(8).unwrap();
        let functions = super::super::orientation::moments(terms, &Polarimeter::PLATE).unwrap();
        let functions = functions.into_iter().map(|moment| {
            #[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
            let spin = [moment.n() as i32, moment.m() as i32];
            let value = match spin {
                [2, 0] => 0.4,
                [1, 0] => 0.2,
                [2, -4] | [4, -8] => z,
                _ => 0.0,
            };
            (spin, vec![Complex64::new(value, 0.0); 768])
        });
        Orientations::new(nside, vec![hits; 768], functions.collect()).unwrap()
    }

    fn asked() -> (Asked, Likelihood) {
        let cmb = CmbSpectra::embedded(TensorTilt::Scaleless).unwrap();
        let likelihood =
            Likelihood { degrees: [2, 16], ..Likelihood::new(&cmb.tensor_bb, &cmb.bb) };
        let terms = Pointing { rho_rad: 1e-3, chi_rad: 0.3 }.terms();
        let sky = StudySky::Mean(cmb.through_beam(0.1, 20));
        (Asked { terms, polarimeter: Polarimeter::PLATE, sky }, likelihood)
    }

    #[test]
    fn skies_scatter_about_their_mean() {
        let (asked, likelihood) = asked();
        let orientations = orientations(&asked.terms, 5, 0.0);
        let rings = Rings::new(Nside::new(8).unwrap());
        let mean = asked.study(&orientations, &rings, &likelihood, 0).unwrap();
        assert!(mean.residual.is_none() && mean.bias.delta_r > 0.0);
        let skies = asked.scatter(&orientations, &rings, &likelihood, 3..27).unwrap();
        let average = skies.iter().sum::<f64>() / 24.0;
        assert_eq!(skies.len(), 24);
        assert!((average / mean.bias.delta_r - 1.0).abs() < 0.3, "{average} {mean:?}");
        assert_eq!(skies[4..6], asked.scatter(&orientations, &rings, &likelihood, 7..9).unwrap());
        let given = Asked { sky: StudySky::Given(SkyAlms::zero(2)), ..asked };
        assert!(given.scatter(&orientations, &rings, &likelihood, 0..9).unwrap().is_empty());
    }

    #[test]
    fn parts_are_temperature_and_polarisation() {
        let (asked, _) = asked();
        let [temperature, polarisation] = asked.parts().unwrap();
        assert_eq!((temperature.terms.len(), polarisation.terms.len()), (1, 2));
        assert_eq!(temperature.terms[0].field, SkyField::Temperature(1));
        let ip = HwpIp { epsilon: 1.0, phi_qi_rad: 0.0, form: IpForm::Physical };
        assert_eq!(Asked { terms: ip.terms(), ..asked }.parts(), None);
    }

    #[test]
    fn a_sky_without_solutions_has_no_bias() {
        let (asked, likelihood) = asked();
        let rings = Rings::new(Nside::new(8).unwrap());
        let refused = |hits, z| {
            let orientations = orientations(&asked.terms, hits, z);
            asked.study(&orientations, &rings, &likelihood, 0).unwrap_err()
        };
        let unsolved = |unobserved, singular| StudyError::Unsolved { unobserved, singular };
        assert_eq!(refused(0, 0.0), unsolved(768, 0));
        // One angle in all samples: <z> = -1, <z^2> = 1.
        assert_eq!(refused(5, 1.0), unsolved(0, 768));
    }
}
