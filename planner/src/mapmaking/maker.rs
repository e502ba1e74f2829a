//! How a survey of a sky becomes maps: what every sample measures, added up pixel by pixel.
//!
//! Angles: a [`Sample`] has those of the sky's frame, the normal matrix those of the map's.
//!
//! Method: threads bin jobs of consecutive samples by crossings of a pixel; crossings are added to the
//! map one job after the other, so that the number of threads does not change a bit.
//!
//! Limits: the memory is that of the map (64 bytes per pixel) and of a few jobs per thread.

use super::binned::{BinnedMaps, Crossing};
use super::sample::Sample;
use super::sky::Sky;
use crate::progress::Progress;
use crate::survey::{BLOCK, Block, Isa, Job, Phasors, Pixels, Sampled, Stream, pool};
use crate::survey::{Survey, SurveyError};
use onboard_core::ephemeris::EphemerisError;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use std::sync::Arc;

/// Makes maps from a survey of a sky, one span of samples after the other.
#[derive(Debug)]
pub struct MapMaker {
    survey: Survey,
    sky: Arc<Sky>,
    isa: Isa,
    maps: BinnedMaps,
}

/// Jobs of a thread that wait to be added to the map.
const JOBS_PER_THREAD: usize = 4;

impl MapMaker {
    /// Empty maps of `survey`'s resolution and frame; its moments are not used.
    ///
    /// # Errors
    /// [`SurveyError::Sampling`] where the strategy cannot be sampled at its rate.
    pub fn new(survey: Survey, sky: Arc<Sky>, isa: Isa) -> Result<Self, SurveyError> {
        survey.scan.check()?;
        let maps = BinnedMaps::new(Pixels { nside: survey.nside, frame: survey.frame });
        Ok(Self { survey, sky, isa, maps })
    }

    /// Adds samples `span`, its end not included, on that many threads (0 takes one for each core),
    /// `signal` telling what each of them measures. Samples on sky pixels without a value, and those
    /// whose signal is not finite, are left out and counted.
    ///
    /// # Errors
    /// [`SurveyError::Ephemeris`] beyond the Sun's table, [`SurveyError::Stopped`] where `progress`
    /// asks for an early end: part of the span is added then.
    pub fn collect<F>(
        &mut self,
        span: Range<u64>,
        threads: usize,
        progress: &dyn Progress,
        signal: &F,
    ) -> Result<(), SurveyError>
    where
        F: Fn(&Sample) -> f64 + Sync,
    {
        let Self { survey, sky, isa, maps } = self;
        let pool = pool(threads)?;
        let sampled = Sampled::of(survey)?;
        let binner = Binner::new(&sampled, survey, sky, *isa);
        let detectors = survey.detectors.len() as u64;
        progress.begin("map-making", span.end.saturating_sub(span.start) * detectors);
        let mut jobs = binner.stream.jobs(span);
        let batch = pool.current_num_threads() * JOBS_PER_THREAD;
        while !progress.stopped() {
            let next: Vec<Job> = jobs.by_ref().take(batch).collect();
            if next.is_empty() {
                return Ok(());
            }
            let work = |job: &Job| {
                let share = binner.bin(job, signal)?;
                progress.advance(job.samples());
                Ok(share)
            };
            let shares: Result<Vec<Share>, EphemerisError> =
                pool.install(|| next.par_iter().map(work).collect());
            // One after the other, so that threads cannot change the order of additions.
            for share in shares? {
                maps.add(&share.crossings, share.left_out);
            }
        }
        Err(SurveyError::Stopped)
    }

    /// The maps so far.
    #[must_use]
    pub const fn maps(&self) -> &BinnedMaps {
        &self.maps
    }

    /// The maps.
    #[must_use]
    pub fn finish(self) -> BinnedMaps {
        self.maps
    }
}

/// Bins what the samples of a survey measure of a sky.
struct Binner<'s> {
    stream: Stream<'s>,
    sky: &'s Sky,
    /// The sky has the map's resolution and frame.
    alike: bool,
}

impl<'s> Binner<'s> {
    fn new(sampled: &'s Sampled<'s>, survey: &Survey, sky: &'s Sky, isa: Isa) -> Self {
        let map = Pixels { nside: survey.nside, frame: survey.frame };
        let of_sky = Pixels { nside: sky.nside(), frame: sky.frame() };
        let alike = map == of_sky;
        // psi_pol = psi + 90 deg + the polarisation angle.
        let turns_rad: Vec<f64> =
            survey.detectors.iter().map(|it| FRAC_PI_2 + it.polarisation_rad).collect();
        let views = [map, of_sky];
        let views = if alike { &views[..1] } else { &views };
        Self { stream: Stream::new(sampled, views, &turns_rad, isa), sky, alike }
    }

    /// What a job adds to the map.
    fn bin<F: Fn(&Sample) -> f64>(&self, job: &Job, signal: &F) -> Result<Share, EphemerisError> {
        let mut share = Share::default();
        let mut open: Vec<Crossing> = Vec::new();
        self.stream.run(job, |block| {
            let slot = block.detector - job.first_detector();
            if slot == open.len() {
                open.push(Crossing::new(block.seen[0].pixel[0]));
            }
            self.bin_block(block, &mut open[slot], &mut share, signal);
        })?;
        share.crossings.extend(open.iter().filter(|it| !it.is_empty()));
        Ok(share)
    }

    #[inline]
    fn bin_block<F: Fn(&Sample) -> f64>(
        &self,
        block: &Block,
        open: &mut Crossing,
        share: &mut Share,
        signal: &F,
    ) {
        let map = &block.seen[0];
        let modulation = modulation(&map.psi, &block.plate);
        let sky = if self.alike { map } else { &block.seen[1] };
        let from_sky =
            if self.alike { modulation } else { self::modulation(&sky.psi, &block.plate) };
        for k in 0..block.count {
            if map.pixel[k] != open.pixel() {
                if !open.is_empty() {
                    share.crossings.push(*open);
                }
                *open = Crossing::new(map.pixel[k]);
            }
            let measured = self.sky.at(sky.pixel[k]).map(|stokes| {
                signal(&Sample {
                    detector: block.detector,
                    number: block.first + k as u64,
                    pixel: sky.pixel[k],
                    stokes,
                    polarisation: (sky.psi[0][k], sky.psi[1][k]),
                    plate: (block.plate[0][k], block.plate[1][k]),
                    modulation: (from_sky[0][k], from_sky[1][k]),
                })
            });
            match measured {
                Some(d) if d.is_finite() => open.add((modulation[0][k], modulation[1][k]), d),
                _ => share.left_out += 1,
            }
        }
    }
}

/// What a job adds to the map.
#[derive(Debug, Default)]
struct Share {
    crossings: Vec<Crossing>,
    left_out: u64,
}

/// Cosine and sine of `4 phi - 2 psi_pol`.
fn modulation(psi: &Phasors, plate: &Phasors) -> Phasors {
    let mut to = [[0.0; BLOCK]; 2];
    for k in 0..BLOCK {
        let square = |(cos, sin): (f64, f64)| (cos * cos - sin * sin, 2.0 * cos * sin);
        let (cos2, sin2) = square((psi[0][k], psi[1][k]));
        let (cos4, sin4) = square(square((plate[0][k], plate[1][k])));
        to[0][k] = cos4 * cos2 + sin4 * sin2;
        to[1][k] = sin4 * cos2 - cos4 * sin2;
    }
    to
}
