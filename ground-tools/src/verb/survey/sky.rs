//! `survey --sky`: the sky of I, Q, U that the survey's detectors look at.

use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use formats::fits::{FitsError, Frames, MapFrame, StokesMap, read_stokes};
use planner::healpix::Nside;
use planner::mapmaking::{PolarisationConvention, Sky, SkyMap, map_bytes};
use std::path::Path;

/// The sky asked for.
pub(super) fn asked(shared: &SharedArgs, arguments: &SurveyArgs) -> Result<Option<Sky>, Failure> {
    match (&arguments.sky, &shared.out) {
        (None, _) => Ok(None),
        (Some(path), Some(out)) if out.as_os_str() != "-" => {
            read(path, arguments.sky_frame.map(Into::into)).map(Some)
        }
        (Some(path), _) => Err(Failure::Input(format!(
            "--sky {}: --out with a file's name is needed, beside which the map of I, Q, U goes",
            path.display()
        ))),
    }
}

/// Reads a sky; a file that does not name its frame is taken to be in `unsaid`.
fn read(path: &Path, unsaid: Option<MapFrame>) -> Result<Sky, Failure> {
    let frames = Frames {
        accepted: &[MapFrame::Ecliptic, MapFrame::Galactic, MapFrame::Equatorial],
        unsaid,
    };
    let map: StokesMap = read_stokes(path, frames).map_err(|failure| match &failure.error {
        FitsError::Frame { found, .. } if unsaid.is_none() && found == "nothing" => {
            Failure::Input(format!("{failure}; --sky-frame says it for a file that does not"))
        }
        _ => failure.into(),
    })?;
    Sky::new(&SkyMap {
        nside: map.nside,
        ordering: map.ordering,
        frame: map.frame.into(),
        convention: PolarisationConvention::Cosmo,
        stokes: [&map.i, &map.q, &map.u],
    })
    .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}

/// Bytes that observing a sky takes beside the survey's maps.
pub(super) fn bytes(nside: Nside) -> u64 {
    map_bytes(nside) + u64::from(nside.pixels()) * size_of::<[f64; 5]>() as u64
}
