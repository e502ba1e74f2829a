//! How often, and at which angles, is each pixel of the sky seen.
//!
//! A [`Survey`] is a strategy sampled at a constant rate, the detectors that look, the map's
//! resolution and frame, and the averages to take; [`Collector`] runs it and gives [`SurveyMaps`].
//!
//! Angles: crossing angle psi zero at east, half-wave plate phi, as in the conventions; in galactic
//! maps psi is counted from galactic east.
//!
//! Method: `kernel` (fast, any instruction set, one pass over blocks of samples with nothing stored
//! per sample) and [`plain`] (the flight core, sample by sample), which agree on every pixel and, to
//! 1e-10, on every h.
//!
//! Limits: nside up to 2048; the memory is that of the maps, once per thread.

#![expect(
    clippy::inline_always,
    reason = "one function per instruction set holds all that it calls"
)]
#![expect(
    clippy::similar_names,
    clippy::many_single_char_names,
    reason = "sines and cosines, components"
)]

pub mod clock;
pub mod sun;
pub mod frame;
pub mod detector;
pub mod input;
pub mod moment;
pub mod map;
pub mod isa;
pub mod statistics;
pub mod scan_beam;
pub mod plain;
mod lanes;
mod axes;
mod sight;
mod pixel;
mod level;
mod powers;
mod pending;
mod kernel;
mod smooth;
mod each;
pub(crate) mod stream;

pub use clock::SampledScan;
pub use detector::SurveyDetector;
pub use frame::MapFrame;
pub use isa::Isa;
pub use map::{SurveyMaps, map_bytes};
pub use moment::{Moment, MomentError};
pub use scan_beam::Sweeping;
pub use statistics::{MomentStatistics, SurveyStatistics};
pub use sun::{SunSource, SurveySun};

use crate::healpix::Nside;
use kernel::{Kernel, Scratch};
use onboard_core::ephemeris::EphemerisError;
use pulp::NullaryFnOnce;
use rayon::ThreadPool;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

/// What to survey.
#[derive(Debug, Clone, Copy)]
pub struct Survey<'a> {
    /// The strategy on the clock of samples.
    pub scan: SampledScan,
    /// Where the anti-Sun axis points.
    pub sun: SurveySun<'a>,
    /// Who looks; all are collected in one map.
    pub detectors: &'a [SurveyDetector],
    /// Resolution of the map.
    pub nside: Nside,
    /// Frame of the map.
    pub frame: MapFrame,
    /// Averages to take.
    pub moments: &'a [Moment],
}

/// Consecutive samples, over which the Sun's direction is one arc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    first: u64,
    end: u64,
}

/// How far a survey has come, and whether to stop; shared with whoever shows progress.
#[derive(Debug, Default)]
pub struct Progress {
    samples: AtomicU64,
    stop: AtomicBool,
}

impl Progress {
    /// Samples of all detectors collected.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }

    pub(crate) fn add(&self, samples: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
    }

    /// Asks for an early end.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether an early end was asked for.
    #[must_use]
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl<'a> Survey<'a> {
    /// The moments that are collected: the first [`MOST_MOMENTS`].
    #[must_use]
    pub fn collected(&self) -> &'a [Moment] {
        &self.moments[..self.moments.len().min(MOST_MOMENTS)]
    }
}

/// Collects a survey, one span of samples after the other.
#[derive(Debug)]
pub struct Collector<'a> {
    survey: &'a Survey<'a>,
    isa: Isa,
    shares: Vec<SurveyMaps>,
}

/// Samples that a thread takes at a time, about.
const TASK_SAMPLES: u64 = 1 << 19;
/// Most moments of a survey; its maps do not have those beyond.
pub const MOST_MOMENTS: usize = 64;

impl<'a> Collector<'a> {
    /// Empty maps.
    #[must_use]
    pub const fn new(survey: &'a Survey<'a>, isa: Isa) -> Self {
        Self { survey, isa, shares: Vec::new() }
    }

    /// Collects samples `first` to `end`, `end` not included, on the threads of `pool`; returns
    /// whether it came to the end.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
    pub fn collect(
        &mut self,
        span: std::ops::Range<u64>,
        pool: &ThreadPool,
        progress: &Progress,
    ) -> Result<bool, EphemerisError> {
        match self.survey.collected().len() {
            0 => self.collect_lanes::<0>(span, pool, progress),
            1..=8 => self.collect_lanes::<8>(span, pool, progress),
            9..=16 => self.collect_lanes::<16>(span, pool, progress),
            _ => self.collect_lanes::<MOST_MOMENTS>(span, pool, progress),
        }
    }

    fn collect_lanes<const LANES: usize>(
        &mut self,
        span: std::ops::Range<u64>,
        pool: &ThreadPool,
        progress: &Progress,
    ) -> Result<bool, EphemerisError> {
        let survey = self.survey;
        let isa = self.isa;
        let kernel: Kernel<'_, LANES> = Kernel::new(survey, survey.collected());
        let tasks = tasks(survey, span, Kernel::<LANES>::run_samples(&survey.scan));
        self.shares.resize_with(self.shares.len().max(pool.current_num_threads()), || {
            SurveyMaps::new(survey.nside, survey.collected())
        });
        let next = AtomicUsize::new(0);
        let shares: Vec<std::sync::Mutex<&mut SurveyMaps>> =
            self.shares.iter_mut().map(std::sync::Mutex::new).collect();
        let work = |thread: usize| -> Result<(), EphemerisError> {
            let Ok(mut map) = shares[thread].lock() else { return Ok(()) };
            let mut scratch = kernel.scratch();
            while !progress.stopped() {
                let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                let samples = run_task(&kernel, task, isa, &mut scratch, &mut map)?;
                progress.add(samples);
            }
            Ok(())
        };
        let done = pool.broadcast(|context| work(context.index()));
        done.into_iter().collect::<Result<Vec<()>, _>>()?;
        Ok(!progress.stopped())
    }

    /// The maps so far, all threads' shares merged into one.
    pub fn merged(&mut self) -> &SurveyMaps {
        if self.shares.is_empty() {
            self.shares.push(SurveyMaps::new(self.survey.nside, self.survey.collected()));
        }
        let (first, others) = self.shares.split_at_mut(1);
        for other in others {
            first[0].take(other);
        }
        first[0].settle();
        &self.shares[0]
    }

    /// The maps, merged.
    #[must_use]
    pub fn finish(mut self) -> SurveyMaps {
        self.merged();
        self.shares.swap_remove(0)
    }
}

/// Consecutive runs for the kernel.
struct Task<'t, 's, const FUSED: bool, const LANES: usize> {
    kernel: &'t Kernel<'s, LANES>,
    runs: &'t [Run],
    scratch: &'t mut Scratch<LANES>,
    map: &'t mut SurveyMaps,
}

impl<const FUSED: bool, const LANES: usize> NullaryFnOnce for Task<'_, '_, FUSED, LANES> {
    type Output = Result<(), EphemerisError>;

    /// Inlined, with all that it calls, into a function with the instruction set's features.
    #[inline(always)]
    fn call(self) -> Self::Output {
        for &run in self.runs {
            self.kernel.collect::<FUSED>(run, self.scratch, self.map)?;
        }
        Ok(())
    }
}

fn run_task<const LANES: usize>(
    kernel: &Kernel<'_, LANES>,
    runs: &[Run],
    isa: Isa,
    scratch: &mut Scratch<LANES>,
    map: &mut SurveyMaps,
) -> Result<u64, EphemerisError> {
    let survey = kernel.survey();
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512(it) => it.vectorize(Task::<true, LANES> { kernel, runs, scratch, map }),
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2(it) => it.vectorize(Task::<true, LANES> { kernel, runs, scratch, map }),
        Isa::Portable => Task::<false, LANES> { kernel, runs, scratch, map }.call(),
        Isa::Plain => runs.iter().try_for_each(|&run| plain::collect(survey, run, map)),
    }?;
    let samples: u64 = runs.iter().map(|run| run.end - run.first).sum();
    Ok(samples * survey.detectors.len() as u64)
}

/// Runs that end at multiples of `longest` samples and at the Sun's steps, grouped into tasks.
fn tasks(survey: &Survey<'_>, span: std::ops::Range<u64>, longest: u64) -> Vec<Vec<Run>> {
    let per_task = (TASK_SAMPLES / survey.detectors.len().max(1) as u64).max(longest);
    let mut tasks = Vec::new();
    let mut task = Vec::new();
    let mut samples = 0;
    let mut first = span.start;
    while first < span.end {
        let grid = (first / longest + 1).saturating_mul(longest);
        let step = survey.sun.next_step(&survey.scan, first);
        let end = grid.min(step).min(span.end).max(first + 1);
        task.push(Run { first, end });
        samples += end - first;
        if samples >= per_task {
            tasks.push(std::mem::take(&mut task));
            samples = 0;
        }
        first = end;
    }
    if !task.is_empty() {
        tasks.push(task);
    }
    tasks
}
