//! The maps of one `survey`: collected, with their snapshots, and written.

use super::pictures::Pictures;
use super::watch::{Watch, failed};
use crate::cli::SharedArgs;
use crate::failure::Failure;
use crate::output::Sink;
use crate::verb::told::{print_json, tell};
use formats::maps::{Layout, write_stokes, write_survey};
use formats::survey::{MapReport, SkyReport, Snapshot, Summary, SurveyReport, text, who};
use onboard_core::time::Duration;
use planner::healpix::Nside;
use planner::mapmaking::{CONDITION_LIMIT, MapMaker, Sample, Sky};
use planner::opportunities::{NONE, SightLine};
use planner::provenance::Provenance;
use planner::survey::input::SurveyInput;
use planner::survey::{
    Collector, Isa, Moment, Survey, SurveyDetector, SurveyError, SurveyMaps, SurveyStatistics,
    SurveySun, Sweeping,
};
use planner::world::World;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Mean orbital rate for the scan-beam angle: 360 deg in 365.25 d.
const ORBIT_RAD_S: f64 = TAU / 31_557_600.0;

/// All that does not change between the maps of one command.
pub(super) struct Session<'w> {
    pub world: &'w World,
    pub input: &'w SurveyInput,
    pub sun: SurveySun,
    pub nside: Nside,
    pub moments: &'w [Moment],
    pub layout: Layout,
    pub isa: Isa,
    pub threads: usize,
    pub snapshots: &'w [(String, Duration, u64)],
    pub pictures: Pictures<'w>,
    pub out: Option<PathBuf>,
    pub provenance: Provenance,
    pub rate_hz: f64,
    pub sky: Option<Arc<Sky>>,
}

impl Session<'_> {
    fn title(&self) -> String {
        let days = self.world.end.since(self.world.start).seconds() / 86_400.0;
        format!("{}: survey of {days} d at {} Hz", self.world.mission.name, self.rate_hz)
    }

    /// Tells the reports.
    pub(super) fn deliver(
        &self,
        shared: &SharedArgs,
        per_detector: bool,
        (reports, files): (&[SurveyReport], &[String]),
    ) -> Result<(), Failure> {
        let Some(first) = reports.first() else {
            return Err(Failure::internal("no line of sight"));
        };
        if shared.json {
            print_json(&Summary {
                first,
                per_detector: per_detector.then_some(reports),
                files,
                provenance: &self.provenance,
            })
        } else if self.out.as_deref().map(Sink::at) == Some(Sink::Stdout) {
            Ok(())
        } else {
            let mut told = text(&self.title(), reports);
            if !files.is_empty() {
                told.push_str("\nwritten: ");
                told.push_str(&files.join(", "));
                told.push('\n');
            }
            tell(&told)
        }
    }

    /// One map: collected, with its snapshots, and written.
    pub(super) fn group(
        &self,
        lines: &[SightLine],
        detectors: &[SurveyDetector],
        name: &str,
        watch: &Watch,
        files: &mut Vec<String>,
    ) -> Result<SurveyReport, Failure> {
        let survey = Survey {
            scan: self.input.scan.clone(),
            sun: self.sun.clone(),
            detectors: detectors.to_vec(),
            nside: self.nside,
            frame: self.layout.frame,
            moments: self.moments.to_vec(),
        };
        let (telescope, detector) = seen_by(lines);
        let mut collector = Collector::new(survey.clone(), self.isa).map_err(failed)?;
        let mut from = 0;
        let mut snapshots = Vec::new();
        for (after, elapsed, samples) in self.snapshots {
            self.collect(&mut collector, from..*samples, watch, files)?;
            from = *samples;
            let maps = collector.maps();
            let map = MapReport::new(self.nside.get(), &SurveyStatistics::of(&maps));
            self.write(&maps, (name, Some(after)), (&telescope, &detector), files)?;
            snapshots.push(Snapshot { after: after.clone(), elapsed_s: elapsed.seconds(), map });
        }
        self.collect(&mut collector, from..self.input.samples, watch, files)?;
        let maps = collector.finish();
        let map = MapReport::new(self.nside.get(), &SurveyStatistics::of(&maps));
        self.write(&maps, (name, None), (&telescope, &detector), files)?;
        let sky = self
            .sky
            .as_ref()
            .map(|sky| {
                let seen_by = who(&telescope, &detector);
                self.observe(survey, (sky, name, &seen_by), watch, files)
            })
            .transpose()?;
        let amplitude = detectors
            .par_iter()
            .map(|it| self.sweeping(it).amplitude_rad())
            .reduce(|| 0.0, f64::max);
        Ok(SurveyReport {
            telescope,
            detector,
            detectors: lines.len(),
            rate_hz: self.rate_hz,
            scan_beam_amplitude_deg: amplitude.to_degrees(),
            map,
            snapshots,
            sky,
        })
    }

    fn collect(
        &self,
        collector: &mut Collector,
        span: std::ops::Range<u64>,
        watch: &Watch,
        files: &[String],
    ) -> Result<(), Failure> {
        collector.collect(span, self.threads, watch).map_err(|error| match error {
            SurveyError::Stopped => {
                let kept = if files.is_empty() {
                    "nothing is written".to_owned()
                } else {
                    format!("what --snapshot asked for stays: {}", files.join(", "))
                };
                let done = watch.samples();
                Failure::Check(format!("interrupted after {done} samples: {kept}"))
            }
            other => failed(other),
        })
    }

    fn write(
        &self,
        maps: &SurveyMaps,
        (name, after): (&str, Option<&str>),
        (telescope, detector): (&str, &str),
        files: &mut Vec<String>,
    ) -> Result<(), Failure> {
        let suffix = after.map_or(name.to_owned(), |after| format!("{name}-{after}"));
        let suffix = suffix.as_str();
        let after = after.map_or(String::new(), |after| format!(", after {after}"));
        if let Some(path) = &self.out {
            let seen_by = who(telescope, detector);
            let sink = match Sink::at(path) {
                Sink::File(path) => Sink::File(beside(&path, suffix)),
                Sink::Stdout => Sink::Stdout,
            };
            // Standard output takes one map.
            if sink != Sink::Stdout || suffix.is_empty() {
                sink.write_with(|out| {
                    write_survey(out, maps, self.layout, (&self.provenance, &seen_by))
                })?;
            }
            if let Sink::File(path) = sink {
                files.push(path.display().to_string());
            }
        }
        let title = format!("{}, {}{}", self.title(), who(telescope, detector), after);
        files.extend(self.pictures.write(maps, self.layout.frame, (&title, suffix))?);
        Ok(())
    }

    /// Lets the survey's detectors look at `sky`, and writes what they make of it beside `--out`.
    fn observe(
        &self,
        survey: Survey,
        (sky, name, seen_by): (&Arc<Sky>, &str, &str),
        watch: &Watch,
        files: &mut Vec<String>,
    ) -> Result<SkyReport, Failure> {
        let mut maker = MapMaker::new(survey, Arc::clone(sky), self.isa).map_err(failed)?;
        let samples = 0..self.input.samples;
        maker.collect(samples, self.threads, watch, &Sample::signal).map_err(
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
        if let Some(out) = &self.out {
            let path = beside(out, &format!("{name}-iqu"));
            let origin = (&self.provenance, seen_by);
            Sink::File(path.clone())
                .write_with(|out| write_stokes(out, &solved, (self.nside, self.layout), origin))?;
            files.push(path.display().to_string());
        }
        Ok(SkyReport { left_out_samples: maps.left_out(), unsolved_pixels: solved.unsolved() })
    }

    fn sweeping(&self, detector: &SurveyDetector) -> Sweeping {
        let scan = &self.world.mission.scan;
        Sweeping {
            alpha_rad: scan.alpha_rad,
            polar_rad: detector.polar_rad(scan.beta_rad),
            orbit_rad_s: ORBIT_RAD_S,
            precession_rad_s: scan.precession.rate.radians_per_second(),
            spin_rad_s: scan.spin.rate.radians_per_second(),
        }
    }
}

/// Telescope and detector of a map.
pub(super) fn seen_by(lines: &[SightLine]) -> (String, String) {
    match lines {
        [only] => (only.telescope_name.clone(), only.detector_name.clone()),
        [first, rest @ ..] => {
            let one = rest.iter().all(|it| it.telescope_name == first.telescope_name);
            let telescope = if one { first.telescope_name.clone() } else { "all".to_owned() };
            (telescope, "all".to_owned())
        }
        [] => (NONE.to_owned(), NONE.to_owned()),
    }
}

/// `maps.fits` with a part before its extension: `maps-1d.fits`.
fn beside(path: &Path, suffix: &str) -> PathBuf {
    let stem = path.file_stem().map_or(String::new(), |it| it.to_string_lossy().into_owned());
    let extension =
        path.extension().map_or(String::new(), |it| format!(".{}", it.to_string_lossy()));
    path.with_file_name(format!("{stem}{suffix}{extension}"))
}
