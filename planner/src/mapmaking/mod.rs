//! Which sky does a survey give back: I, Q and U per pixel from a timestream of a given sky.
//!
//! Data model, for a sample with the polarisation angle `psi_pol` and the plate's angle `phi`:
//!
//! `d = I + Q cos(4 phi - 2 psi_pol) - U sin(4 phi - 2 psi_pol)`
//!
//! with Q and U in the COSMO sense and `psi_pol = psi + 90 deg +` the angle from the detector's x axis
//! to its sensitive direction; without a plate phi = 0. This is [Takase2024, section 3.2], whose U is
//! the IAU's: `-psi_pol` grows from north to east. It is what makes a sky the same sky in every frame.
//!
//! Method: [`MapMaker`] adds up the normal matrix `A^T A` and `A^T d` of each pixel; [`BinnedMaps`]
//! solves. What a sample measures is a function of [`Sample`]: [`Sample::signal`] is the plain sky, and
//! systematic effects are other functions. The angle in a `Sample` is that of the sky's frame, the one
//! in the normal matrix that of the map's, so Q and U turn with the frame as they should.
//!
//! Limits: the sky is constant within each of its pixels, its beam a point; the memory is that of the
//! map (64 bytes per pixel) and of a few jobs per thread.

mod sky;
mod sample;
mod binned;

pub use binned::{BinnedMaps, CONDITION_LIMIT, Solution, map_bytes};
pub use sample::Sample;
pub use sky::{PolarisationConvention, Sky, SkyError, SkyMap};

use crate::survey::stream::{BLOCK, Block, Job, Phasors, Stream};
use crate::survey::{Isa, Progress, Survey};
use binned::Crossing;
use onboard_core::ephemeris::EphemerisError;
use rayon::ThreadPool;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::f64::consts::FRAC_PI_2;

/// Makes maps from a survey, one span of samples after the other.
#[derive(Debug)]
pub struct MapMaker<'a> {
    stream: Stream<'a>,
    sky: &'a Sky,
    maps: BinnedMaps,
    /// The sky has the map's resolution and frame.
    alike: bool,
}

/// Jobs of a thread that wait to be added to the map.
const JOBS_PER_THREAD: usize = 4;

impl<'a> MapMaker<'a> {
    /// Empty maps of `survey`'s resolution and frame; its moments are not used. Per detector
    /// `polarisation_rad` is the angle from its x axis to its sensitive direction in the sense of psi;
    /// 0 for detectors beyond its end.
    #[must_use]
    pub fn new(survey: &'a Survey<'a>, polarisation_rad: &[f64], sky: &'a Sky, isa: Isa) -> Self {
        let alike = sky.nside() == survey.nside && sky.frame() == survey.frame;
        let maps = [(survey.frame, survey.nside), (sky.frame(), sky.nside())];
        let turn = |index: usize| FRAC_PI_2 + polarisation_rad.get(index).unwrap_or(&0.0);
        Self {
            stream: Stream::new(survey, if alike { &maps[..1] } else { &maps }, turn, isa),
            sky,
            maps: BinnedMaps::new(survey.nside),
            alike,
        }
    }

    /// Adds samples `span` on the threads of `pool`, `signal` telling what each of them measures;
    /// returns whether it came to the end. Samples on sky pixels without a value, and those whose
    /// signal is not finite, are left out and counted.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
    pub fn collect<F>(
        &mut self,
        span: std::ops::Range<u64>,
        pool: &ThreadPool,
        progress: &Progress,
        signal: &F,
    ) -> Result<bool, EphemerisError>
    where
        F: Fn(&Sample) -> f64 + Sync,
    {
        let mut jobs = self.stream.jobs(span);
        let batch = pool.current_num_threads() * JOBS_PER_THREAD;
        while !progress.stopped() {
            let next: Vec<Job> = jobs.by_ref().take(batch).collect();
            if next.is_empty() {
                return Ok(true);
            }
            let work = |job: &Job| {
                let share = self.bin(job, signal)?;
                progress.add(job.samples());
                Ok(share)
            };
            let shares: Result<Vec<Share>, EphemerisError> =
                pool.install(|| next.par_iter().map(work).collect());
            // One after the other, so that threads cannot change the order of additions.
            for share in shares? {
                self.maps.add(&share.crossings, share.left_out);
            }
        }
        Ok(false)
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
