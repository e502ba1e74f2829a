//! What is told of a survey: the numbers of its map, at its end and at each snapshot.
//!
//! # Example
//! The numbers of a day's map through a preset's boresight, at 1 Hz:
//! ```
//! use formats::survey::MapReport;
//! use mission::{Mission, Override, number::Number};
//! use planner::survey::*;
//! use planner::{healpix::Nside, opportunities::boresight, progress::Quietly, world::World};
//!
//! let set = ["span.duration_days=1", "orbit.sun=circular"].map(Override::set);
//! let set = set.into_iter().collect::<Result<Vec<_>, _>>()?;
//! let world = World::open(Mission::load("litebird", &set)?, None)?;
//! let lines = [boresight(&world.mission)?];
//! let asked = input::SurveyInput::new(&world, &lines, &Number::parse("1")?)?;
//! let source = SunSource::Circular(asked.circular_sun.ok_or("no circular Sun")?);
//! let (sun, nside, frame) = (SurveySun { source, step: None }, Nside::new(16)?, MapFrame::Ecliptic);
//! let (scan, detectors, moments) = (asked.scan, asked.detectors, vec![Moment::new(2.0, 0.0)?]);
//! let survey = Survey { scan, sun, detectors, nside, frame, moments };
//! let maps = survey.run(0..asked.samples, 0, &Quietly)?;
//! let report = MapReport::new(16, &SurveyStatistics::of(&maps));
//! assert_eq!((report.samples, report.crosslink[0].n), (86_400, 2.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use planner::opportunities::NONE;
use planner::provenance::Provenance;
use planner::survey::{Moment, MomentStatistics, SurveyStatistics};
use serde::{Serialize, Serializer};
use std::fmt::Write;

/// One map in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapReport {
    /// Pixels along the side of a base pixel.
    pub nside: u32,
    /// Samples in the map.
    pub samples: u64,
    /// Mean hits per pixel.
    pub mean_hits: f64,
    /// Standard deviation of hits, `N_pix - 1` in the denominator.
    pub sigma_hits: f64,
    /// The same over the mean.
    pub sigma_hits_normalised: f64,
    /// Fewest hits of a pixel.
    pub hits_min: u64,
    /// Most hits of a pixel.
    pub hits_max: u64,
    /// Pixels without a sample.
    pub unobserved_pixels: u64,
    /// Per moment.
    pub crosslink: Vec<Crosslink>,
}

/// `|h_nm|^2` in numbers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Crosslink {
    /// n.
    #[serde(serialize_with = "order")]
    pub n: f64,
    /// m.
    #[serde(serialize_with = "order")]
    pub m: f64,
    /// Mean over the sky, where all of it is observed.
    pub mean: Option<f64>,
    /// Mean over observed pixels.
    pub mean_observed: Option<f64>,
    /// Standard deviation over observed pixels.
    pub std: Option<f64>,
}

/// A whole order without a decimal point.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
fn order<S: Serializer>(order: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if order.fract() == 0.0 {
        #[expect(clippy::cast_possible_truncation, reason = "orders are at most 64")]
        serializer.serialize_i64(*order as i64)
    } else {
        serializer.serialize_f64(*order)
    }
}

/// A map at a time before the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Snapshot {
    /// As asked for.
    pub after: String,
    /// Time since the start.
    pub elapsed_s: f64,
    /// The map.
    #[serde(flatten)]
    pub map: MapReport,
}

/// One map from its start to its end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurveyReport {
    /// Telescope, or `-`.
    pub telescope: String,
    /// Detector, `all` for several in one map, or `-`.
    pub detector: String,
    /// Detectors in the map.
    pub detectors: usize,
    /// Sampling rate in Hz.
    pub rate_hz: f64,
    /// Half of the range of the scan-beam angle, the largest of the detectors.
    pub scan_beam_amplitude_deg: f64,
    /// The map at the end.
    #[serde(flatten)]
    pub map: MapReport,
    /// The map at earlier times.
    pub snapshots: Vec<Snapshot>,
    /// What was made of a given sky.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sky: Option<SkyReport>,
}

/// A sky seen by the survey's detectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SkyReport {
    /// Samples on pixels of the sky without a value.
    pub left_out_samples: u64,
    /// Pixels whose I, Q, U are not determined.
    pub unsolved_pixels: usize,
}

/// The JSON summary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary<'p> {
    /// The map, or the first of several.
    #[serde(flatten)]
    pub first: &'p SurveyReport,
    /// Each detector's, with `--per-detector`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub per_detector: Option<&'p [SurveyReport]>,
    /// Files written.
    pub files: &'p [String],
    /// Where it comes from.
    pub provenance: &'p Provenance,
}

impl MapReport {
    /// Of statistics at a resolution.
    #[must_use]
    pub fn new(nside: u32, statistics: &SurveyStatistics) -> Self {
        Self {
            nside,
            samples: statistics.samples,
            mean_hits: statistics.mean_hits,
            sigma_hits: statistics.sigma_hits,
            sigma_hits_normalised: statistics.sigma_hits_normalised,
            hits_min: statistics.range.0,
            hits_max: statistics.range.1,
            unobserved_pixels: statistics.unobserved_pixels,
            crosslink: statistics.moments.iter().map(Crosslink::new).collect(),
        }
    }
}

impl Crosslink {
    fn new(it: &MomentStatistics) -> Self {
        Self {
            n: it.moment.n(),
            m: it.moment.m(),
            mean: it.mean,
            mean_observed: it.mean_observed,
            std: it.std,
        }
    }
}

/// n and m for a person: `(2, 4)`, `(-0.5, 2)`.
#[must_use]
pub fn name(moment: Moment) -> String {
    format!("({}, {})", moment.n(), moment.m())
}

/// Who looks, for a person.
#[must_use]
pub fn who(telescope: &str, detector: &str) -> String {
    match (telescope == NONE, detector == NONE) {
        (true, true) => "mission boresight".to_owned(),
        (false, true) => telescope.to_owned(),
        _ => format!("{telescope}/{detector}"),
    }
}

/// A survey for a person.
#[must_use]
pub fn text(title: &str, reports: &[SurveyReport]) -> String {
    let mut text = format!("{title}\n");
    for report in reports {
        let map = &report.map;
        let _ = writeln!(text, "\n{}", who(&report.telescope, &report.detector));
        let _ = writeln!(
            text,
            "{} samples of {} detector(s) at {} Hz, nside {}, {} pixels unobserved",
            map.samples, report.detectors, report.rate_hz, map.nside, map.unobserved_pixels
        );
        let _ = writeln!(
            text,
            "hits: mean {:.3}, sigma {:.3} ({:.5} of the mean), from {} to {}",
            map.mean_hits, map.sigma_hits, map.sigma_hits_normalised, map.hits_min, map.hits_max
        );
        let _ =
            writeln!(text, "scan-beam angle: amplitude {:.4} deg", report.scan_beam_amplitude_deg);
        let mut columns = vec![("end".to_owned(), map)];
        for snapshot in report.snapshots.iter().rev() {
            columns.insert(0, (snapshot.after.clone(), &snapshot.map));
        }
        let cell =
            |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.6e}"));
        let _ = write!(text, "\n{:<22}", "");
        for (name, _) in &columns {
            let _ = write!(text, " {name:>14}");
        }
        text.push('\n');
        let mut line = |name: &str, value: &dyn Fn(&MapReport) -> String| {
            let _ = write!(text, "{name:<22}");
            for (_, map) in &columns {
                let _ = write!(text, " {:>14}", value(map));
            }
            text.push('\n');
        };
        line("unobserved pixels", &|map| map.unobserved_pixels.to_string());
        line("sigma_hits / mean", &|map| format!("{:.6}", map.sigma_hits_normalised));
        for (index, it) in map.crosslink.iter().enumerate() {
            let name = format!("<|h|^2> ({}, {})", it.n, it.m);
            line(&name, &|map| cell(map.crosslink[index].mean_observed));
        }
        if let Some(sky) = report.sky {
            let _ = writeln!(
                text,
                "\nI, Q, U of the sky: {} pixels not determined, {} samples left out",
                sky.unsolved_pixels, sky.left_out_samples
            );
        }
    }
    text
}
