//! `survey --sky`: a sky of I, Q, U as it is read, and as the survey's detectors make a map of it,
//! binned into the survey's pixels.

use super::files::Layout;
use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use formats::fits::{
    Column, FitsError, Frames, MapFrame, MapHeader, Polcconv, StokesMap, Values, read_stokes,
    write_maps,
};
use planner::healpix::Nside;
use planner::mapmaking::{PolarisationConvention, Sky, SkyMap, StokesMaps, map_bytes};
use planner::provenance::Provenance;
use planner::survey::MapFrame as SurveyFrame;
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
    let frames = Frames { accepted: &[MapFrame::Ecliptic, MapFrame::Galactic], unsaid };
    let map: StokesMap = read_stokes(path, frames).map_err(|failure| match &failure.error {
        FitsError::Frame { found, .. } if unsaid.is_none() && found == "nothing" => {
            Failure::Input(format!("{failure}; --sky-frame says it for a file that does not"))
        }
        _ => failure.into(),
    })?;
    let frame = match map.frame {
        MapFrame::Galactic => SurveyFrame::Galactic,
        MapFrame::Ecliptic | MapFrame::Equatorial => SurveyFrame::Ecliptic,
    };
    Sky::new(&SkyMap {
        nside: map.nside,
        ordering: map.ordering,
        frame,
        convention: PolarisationConvention::Cosmo,
        stokes: [&map.i, &map.q, &map.u],
    })
    .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}

/// Bytes that observing a sky takes beside the survey's maps.
pub(super) fn bytes(nside: Nside) -> u64 {
    map_bytes(nside) + u64::from(nside.pixels()) * size_of::<[f64; 5]>() as u64
}

/// Writes I, Q and U with the condition and the hits of each pixel.
pub(super) fn write(
    sink: &Sink,
    maps: &StokesMaps,
    (nside, layout): (Nside, Layout),
    origin: (&Provenance, &str),
) -> Result<(), Failure> {
    let nested = |pixel: u32| nside.nested(layout.ordering, pixel) as usize;
    let ([i, q, u], condition) = (maps.iqu(), maps.condition());
    let i = |pixel: u32| i[nested(pixel)];
    let q = |pixel: u32| q[nested(pixel)];
    let u = |pixel: u32| u[nested(pixel)];
    let condition = |pixel: u32| condition[nested(pixel)];
    let hits = |pixel: u32| i64::try_from(maps.hits()[nested(pixel)]).unwrap_or(i64::MAX);
    let columns = [
        Column { name: "I_STOKES", unit: "", values: Values::Double(&i) },
        Column { name: "Q_STOKES", unit: "", values: Values::Double(&q) },
        Column { name: "U_STOKES", unit: "", values: Values::Double(&u) },
        Column { name: "CONDITION", unit: "", values: Values::Double(&condition) },
        Column { name: "HITS", unit: "samples", values: Values::Integer(&hits) },
    ];
    let header = layout.header((nside, "STOKES"), origin);
    let header = MapHeader { polcconv: Some(Polcconv::Cosmo), ..header };
    sink.write_with(|out| write_maps(out, &header, &columns))
}
