//! The skies that effects act on: the CMB, the dipole, or one that is given.

use super::options::{Named, Setting};
use crate::cli::SystematicsArgs;
use crate::failure::Failure;
use formats::fits::{Frames, MapFrame as FitsFrame, read_stokes};
use planner::harmonics::{Complex64, Rings};
use planner::survey::MapFrame;
use planner::systematics::effects::ActsOn;
use planner::systematics::{SkyAlms, StudySky, realisation};
use std::path::Path;

/// The sky of an effect, and its name in a word or two.
pub(super) struct Skies<'s> {
    setting: &'s Setting,
    seed: Option<u64>,
    frame: MapFrame,
    given: Option<SkyAlms>,
}

impl<'s> Skies<'s> {
    pub(super) fn read(
        arguments: &SystematicsArgs,
        setting: &'s Setting,
        frame: MapFrame,
    ) -> Result<Self, Failure> {
        let read = |path| given(path, arguments.cmb_lmax, frame);
        // With --realisations the seed is that of the first of them.
        let seed = arguments.seed.filter(|_| arguments.realisations.is_none());
        let given = arguments.sky.as_deref().map(read).transpose()?;
        Ok(Self { setting, seed, frame, given })
    }

    pub(super) fn of(&self, named: &Named) -> (StudySky, &'static str) {
        if let Some(sky) = &self.given {
            return (StudySky::Given(sky.clone()), "given");
        }
        match (named.kind.acts_on, self.seed) {
            (ActsOn::Dipole, _) => {
                let vector = self.setting.dipole.vector_uk(self.frame);
                (StudySky::Given(SkyAlms::dipole(vector)), "dipole")
            }
            (ActsOn::Cmb, None) => (StudySky::Mean(self.setting.seen.clone()), "CMB, mean"),
            (ActsOn::Cmb, Some(seed)) => (StudySky::Given(self.drawn(seed)), "CMB, one"),
        }
    }

    /// The CMB sky of a seed.
    pub(super) fn drawn(&self, seed: u64) -> SkyAlms {
        realisation(&self.setting.seen, self.setting.seen.l_max(), seed)
    }
}

/// A sky by coefficients, or by maps to degree `l_max`.
fn given(path: &Path, l_max: usize, frame: MapFrame) -> Result<SkyAlms, Failure> {
    let wrong = |what: String| Failure::Input(format!("--sky {}: {what}", path.display()));
    if path.extension().is_some_and(|it| it.eq_ignore_ascii_case("csv")) {
        let text =
            std::fs::read_to_string(path).map_err(|error| Failure::file("read", path, &error))?;
        return SkyAlms::from_csv(&text).map_err(|error| wrong(error.to_string()));
    }
    let frame = FitsFrame::from(frame);
    let map = read_stokes(path, Frames { accepted: &[frame], unsaid: Some(frame) })?;
    let scale = match map.unit.trim().to_ascii_lowercase().trim_end_matches("_cmb") {
        "" | "uk" | "muk" | "microk" => 1.0,
        "mk" => 1e3,
        "k" | "kcmb" => 1e6,
        _ => {
            return Err(wrong(format!("in {}; uK, mK or K of the CMB is needed", map.unit.trim())));
        }
    };
    let nside = map.nside;
    let ring = |values: &[f64]| -> Vec<f64> {
        let at = |ring| nside.numbered(map.ordering, nside.nested_of_ring(ring)) as usize;
        (0..nside.pixels()).map(|pixel| scale * values[at(pixel)]).collect()
    };
    let [i, q, u] = [&map.i, &map.q, &map.u].map(|values| ring(values));
    let empty = [&i, &q, &u].into_iter().flatten().filter(|value| !value.is_finite()).count();
    if empty > 0 {
        return Err(wrong(format!("{empty} values are missing; a whole sky is needed")));
    }
    let p: Vec<Complex64> = q.iter().zip(&u).map(|(q, u)| Complex64::new(*q, *u)).collect();
    let l_max = l_max.min(3 * nside.get() as usize - 1);
    SkyAlms::of_maps(&Rings::new(nside), &i, &p, l_max).map_err(|error| wrong(error.to_string()))
}
