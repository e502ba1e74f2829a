//! `survey --sky`: what a sky of I, Q, U looks like after the survey's detectors have seen it, binned
//! into the survey's pixels.

use super::products::beside;
use super::session::{Session, failed, seen_by};
use super::watch::Watch;
use crate::cli::{SharedArgs, SurveyArgs};
use crate::failure::Failure;
use crate::output::Sink;
use formats::fits::{
    Card, Column, FitsError, Frames, MapFrame, MapHeader, Polcconv, StokesMap, Values,
    provenance_cards, read_stokes, write_maps,
};
use formats::survey::{SkyReport, who};
use planner::healpix::Nside;
use planner::mapmaking::{
    CONDITION_LIMIT, MapMaker, PolarisationConvention, Sample, Sky, SkyMap, StokesMaps, map_bytes,
};
use planner::opportunities::SightLine;
use planner::survey::{MapFrame as SurveyFrame, Survey, SurveyError};
use std::path::Path;
use std::sync::Arc;

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

impl Session<'_> {
    /// Lets the survey's detectors look at `sky`, and writes what they make of it beside `--out`.
    pub(super) fn observe(
        &self,
        survey: Survey,
        (lines, sky, name): (&[SightLine], &Arc<Sky>, &str),
        watch: &Watch,
        files: &mut Vec<String>,
    ) -> Result<SkyReport, Failure> {
        let mut maker = MapMaker::new(survey, Arc::clone(sky), self.isa).map_err(failed)?;
        maker.collect(0..self.input.samples, self.threads, watch, &Sample::signal).map_err(
            |error| match error {
                SurveyError::Stopped => Failure::Check(format!(
                    "interrupted while the sky was observed; these are written: {}",
                    files.join(", ")
                )),
                other => failed(other),
            },
        )?;
        let maps = maker.finish();
        let solved = maps.stokes(CONDITION_LIMIT);
        let (telescope, detector) = seen_by(lines);
        if let Some(out) = &self.out {
            let path = beside(out, &format!("{name}-iqu"));
            let who = who(&telescope, &detector);
            self.write_stokes(&Sink::File(path.clone()), &solved, &who)?;
            files.push(path.display().to_string());
        }
        Ok(SkyReport { left_out_samples: maps.left_out(), unsolved_pixels: solved.unsolved() })
    }

    fn write_stokes(&self, sink: &Sink, maps: &StokesMaps, seen_by: &str) -> Result<(), Failure> {
        let nested = |pixel: u32| self.nside.nested(self.layout.ordering, pixel) as usize;
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
        let mut cards = provenance_cards(&self.provenance);
        cards.push(Card::text("DETECTOR", seen_by, "who looked"));
        let header = MapHeader {
            nside: self.nside,
            ordering: self.layout.ordering,
            frame: self.layout.frame.into(),
            name: "STOKES".to_owned(),
            polcconv: Some(Polcconv::Cosmo),
            cards,
        };
        sink.write_with(|out| write_maps(out, &header, &columns))
    }
}
