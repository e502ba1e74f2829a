//! What one effect does: spectra and bias, its parts, its closed form, its scatter, and the same signal
//! sample by sample.

use super::options::{Named, Setting};
use super::scan::Scan;
use super::sky::Skies;
use crate::cli::SystematicsArgs;
use crate::failure::Failure;
use planner::harmonics::{Complex64, Rings, Spectra};
use planner::progress::Quietly;
use planner::survey::Survey;
use planner::systematics::timestream::Timestream;
use planner::systematics::{Asked, DipoleLeak, Found, Residual, SkyAlms, StudySky};
use planner::world::World;

/// What an effect does.
pub(super) struct Outcome {
    /// The sky in a word or two.
    pub sky: &'static str,
    pub found: Found,
    /// delta r of the effect on T alone, and on E and B alone.
    pub parts: Option<[f64; 2]>,
    /// delta r of the scan without resonances.
    pub closed_form: Option<f64>,
    /// delta r of CMB skies one by one.
    pub skies: Vec<f64>,
    pub timestream: Option<Compared>,
}

/// How far the residual sample by sample is from that of the orientation functions.
pub(super) struct Compared {
    /// Largest difference of B, relative.
    pub bb: f64,
    /// Largest difference of P in uK.
    pub p_uk: f64,
}

/// What effects are studied with.
pub(super) struct Study<'s> {
    pub arguments: &'s SystematicsArgs,
    pub world: &'s World,
    pub setting: &'s Setting,
    pub scan: &'s Scan,
    pub skies: Skies<'s>,
    pub rings: Rings,
}

impl Study<'_> {
    pub(super) fn of(&self, named: &Named) -> Result<Outcome, Failure> {
        let refused = |error| Failure::Input(format!("--effect {}: {error}", named.text));
        let (sky, word) = self.skies.of(named);
        let asked = Asked { terms: named.terms.clone(), polarimeter: named.polarimeter, sky };
        let with = (&self.scan.orientations, &self.rings, &self.setting.likelihood);
        let study = |asked: &Asked| {
            asked.study(with.0, with.1, with.2, self.arguments.iterations).map_err(refused)
        };
        let found = study(&asked)?;
        let parts = match asked.parts().filter(|_| self.arguments.parts) {
            Some([t, p]) => Some([study(&t)?.bias.delta_r, study(&p)?.bias.delta_r]),
            None => None,
        };
        let first = self.arguments.seed.unwrap_or(0);
        let last = first.saturating_add(self.arguments.realisations.unwrap_or(0).into());
        let skies = asked.scatter(with.0, with.1, with.2, first..last).map_err(refused)?;
        let timestream = match &self.scan.survey {
            Some((survey, samples)) if self.arguments.tod && !named.polarimeter.pair => {
                let sky = match &asked.sky {
                    StudySky::Given(sky) => sky.clone(),
                    StudySky::Mean(_) => self.skies.drawn(first),
                };
                Some(self.compared(&asked, sky, (survey, *samples))?)
            }
            _ => None,
        };
        let closed_form = self.closed_form(named, word)?;
        Ok(Outcome { sky: word, found, parts, closed_form, skies, timestream })
    }

    /// The same effect on a sky by both ways.
    fn compared(
        &self,
        asked: &Asked,
        sky: SkyAlms,
        (survey, count): (&Survey, u64),
    ) -> Result<Compared, Failure> {
        let angle_rad = asked.polarimeter.polarisation_rad;
        let timestream = Timestream::new(&self.rings, &asked.terms, &sky, angle_rad)
            .map_err(Failure::internal)?;
        let maps = timestream.maps(survey, 0..count, &Quietly).map_err(Failure::internal)?;
        let [_, q, u] = maps.iqu();
        let map: Vec<Complex64> = (0..survey.nside.pixels())
            .map(|ring| survey.nside.nested_of_ring(ring) as usize)
            .map(|at| Complex64::new(q[at], u[at]))
            .collect();
        let sky = StudySky::Given(sky);
        let one = Asked { sky, terms: asked.terms.clone(), polarimeter: asked.polarimeter };
        let found = one.study(
            &self.scan.orientations,
            &self.rings,
            &self.setting.likelihood,
            self.arguments.iterations,
        );
        let found = found.map_err(Failure::internal)?;
        let coupled = found.residual.iter().flat_map(|it| &it.polarisation);
        let off = map.iter().zip(coupled).map(|(a, b)| (a - b).norm());
        let p_uk = off.filter(|off| off.is_finite()).fold(0.0, f64::max);
        let whole = |p: Complex64| if p.is_nan() { Complex64::ZERO } else { p };
        let map: Vec<Complex64> = map.into_iter().map(whole).collect();
        let [from, to] = self.setting.likelihood.degrees;
        let alm = self.rings.alm(2, &map, to, self.arguments.iterations);
        let bb = Spectra::of(None, &alm.map_err(Failure::internal)?).bb;
        let relative = (from..=to).map(|l| (bb[l] / found.bb[l] - 1.0).abs());
        Ok(Compared { bb: relative.filter(|off| off.is_finite()).fold(0.0, f64::max), p_uk })
    }

    /// delta r in closed form, of the mission boresight.
    fn closed_form(&self, named: &Named, sky: &str) -> Result<Option<f64>, Failure> {
        let (Some([epsilon, phi_qi_rad]), "dipole") = (named.leak, sky) else { return Ok(None) };
        let scan = &self.world.mission.scan;
        if self.arguments.sight.detector.is_some() {
            return Ok(None);
        }
        let leak = DipoleLeak {
            alpha_rad: scan.alpha_rad,
            beta_rad: scan.beta_rad,
            epsilon,
            phi_qi_rad,
            dipole: self.setting.dipole.vector_uk(planner::survey::MapFrame::Ecliptic),
        };
        let [_, bb] = leak.spectra(self.setting.likelihood.degrees[1]);
        let bias = self.setting.likelihood.bias(&bb).map_err(Failure::internal)?;
        Ok(Some(bias.delta_r))
    }
}

/// The maps of an effect, where it has any.
pub(super) fn residuals<'o>(
    outcomes: &'o [Outcome],
) -> impl Iterator<Item = (usize, &'o Residual)> + 'o {
    let number = |(index, outcome): (usize, &'o Outcome)| {
        Some((index + 1, outcome.found.residual.as_ref()?))
    };
    outcomes.iter().enumerate().filter_map(number)
}
