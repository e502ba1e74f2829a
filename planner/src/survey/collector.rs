//! How a survey becomes maps: on several threads, one span of samples after the other.
//!
//! Method: threads take tasks of consecutive samples from one list, each into sums of its own; these
//! are integers, so that neither their order nor the number of threads changes a bit.
//!
//! Limits: the memory is that of the sums, once per thread, and of one set of maps.

use super::definition::{Survey, SurveyError};
use super::isa::{Isa, Set};
use super::kernel::{Kernel, Scratch};
use super::maps::SurveyMaps;
use super::moment::MOST_MOMENTS;
use super::plain;
use super::runs::{Run, tasks};
use super::sampled::{Pixels, Sampled};
use super::sums::Sums;
use super::threads::pool;
use crate::progress::Progress;
use onboard_core::ephemeris::EphemerisError;
use pulp::NullaryFnOnce;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

impl Survey {
    /// The maps of samples `span`, its end not included, on that many threads; 0 takes one for each
    /// core.
    ///
    /// # Errors
    /// [`SurveyError`], among them [`SurveyError::Stopped`] where `progress` asks for an early end.
    pub fn run(
        &self,
        span: Range<u64>,
        threads: usize,
        progress: &dyn Progress,
    ) -> Result<SurveyMaps, SurveyError> {
        let mut collector = Collector::new(self.clone(), Isa::best())?;
        collector.collect(span, threads, progress)?;
        Ok(collector.finish())
    }
}

/// Collects a survey span by span, so that its maps can be looked at on the way.
#[derive(Debug)]
pub struct Collector {
    survey: Survey,
    isa: Isa,
    shares: Vec<Sums>,
}

impl Collector {
    /// Empty maps.
    ///
    /// # Errors
    /// [`SurveyError::Sampling`] where the strategy cannot be sampled at its rate.
    pub fn new(survey: Survey, isa: Isa) -> Result<Self, SurveyError> {
        survey.scan.check()?;
        Ok(Self { survey, isa, shares: Vec::new() })
    }

    /// What is surveyed.
    #[must_use]
    pub const fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Collects samples `span`, its end not included, on that many threads; 0 takes one for each core.
    ///
    /// # Errors
    /// [`SurveyError::Ephemeris`] beyond the Sun's table, [`SurveyError::Stopped`] where `progress`
    /// asks for an early end: part of the span is collected then.
    pub fn collect(
        &mut self,
        span: Range<u64>,
        threads: usize,
        progress: &dyn Progress,
    ) -> Result<(), SurveyError> {
        match self.survey.collected().len() {
            0 => self.collect_lanes::<0>(span, threads, progress),
            1..=8 => self.collect_lanes::<8>(span, threads, progress),
            9..=16 => self.collect_lanes::<16>(span, threads, progress),
            _ => self.collect_lanes::<MOST_MOMENTS>(span, threads, progress),
        }
    }

    fn collect_lanes<const LANES: usize>(
        &mut self,
        span: Range<u64>,
        threads: usize,
        progress: &dyn Progress,
    ) -> Result<(), SurveyError> {
        let Self { survey, isa, shares } = self;
        let pool = pool(threads)?;
        let sampled = Sampled::of(survey)?;
        let (on, moments) = (pixels(survey), survey.collected());
        let kernel: Kernel<'_, LANES> = Kernel::new(&sampled, on, moments);
        let detectors = survey.detectors.len() as u64;
        progress.begin("survey", span.end.saturating_sub(span.start) * detectors);
        let tasks = tasks(&sampled, span);
        shares.resize_with(shares.len().max(pool.current_num_threads()), || Sums::new(on, moments));
        let next = AtomicUsize::new(0);
        let shares: Vec<Mutex<&mut Sums>> = shares.iter_mut().map(Mutex::new).collect();
        let work = |thread: usize| -> Result<(), EphemerisError> {
            let Ok(mut sums) = shares[thread].lock() else { return Ok(()) };
            let mut scratch = kernel.scratch();
            while !progress.stopped() {
                let Some(runs) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                match isa.set() {
                    Set::Plain => runs.iter().try_for_each(|&run| {
                        plain::collect(&sampled, (on, moments), run, &mut sums)
                    }),
                    set => run_task(&kernel, (runs, set), &mut scratch, &mut sums),
                }?;
                progress.advance(runs.iter().map(Run::samples).sum::<u64>() * detectors);
            }
            Ok(())
        };
        let done = pool.broadcast(|context| work(context.index()));
        done.into_iter().collect::<Result<Vec<()>, _>>()?;
        if progress.stopped() { Err(SurveyError::Stopped) } else { Ok(()) }
    }

    /// The maps so far.
    pub fn maps(&mut self) -> SurveyMaps {
        self.merged().maps()
    }

    /// The maps; the memory of the sums is given back while they are made.
    #[must_use]
    pub fn finish(mut self) -> SurveyMaps {
        self.merged();
        self.shares.truncate(1);
        self.shares.swap_remove(0).into_maps()
    }

    /// All threads' shares, merged into the first.
    fn merged(&mut self) -> &Sums {
        if self.shares.is_empty() {
            self.shares.push(Sums::new(pixels(&self.survey), self.survey.collected()));
        }
        let (first, others) = self.shares.split_at_mut(1);
        for other in others {
            first[0].take(other);
        }
        first[0].settle();
        &self.shares[0]
    }
}

const fn pixels(survey: &Survey) -> Pixels {
    Pixels { nside: survey.nside, frame: survey.frame }
}

/// Consecutive runs for the kernel.
struct Task<'t, 's, const FUSED: bool, const LANES: usize> {
    kernel: &'t Kernel<'s, LANES>,
    runs: &'t [Run],
    scratch: &'t mut Scratch<LANES>,
    sums: &'t mut Sums,
}

impl<const FUSED: bool, const LANES: usize> NullaryFnOnce for Task<'_, '_, FUSED, LANES> {
    type Output = Result<(), EphemerisError>;

    /// Inlined, with all that it calls, into a function with the instruction set's features.
    #[inline(always)]
    fn call(self) -> Self::Output {
        for &run in self.runs {
            self.kernel.collect::<FUSED>(run, self.scratch, self.sums)?;
        }
        Ok(())
    }
}

fn run_task<const LANES: usize>(
    kernel: &Kernel<'_, LANES>,
    (runs, set): (&[Run], Set),
    scratch: &mut Scratch<LANES>,
    sums: &mut Sums,
) -> Result<(), EphemerisError> {
    match set {
        #[cfg(target_arch = "x86_64")]
        Set::Avx512(it) => it.vectorize(Task::<true, LANES> { kernel, runs, scratch, sums }),
        #[cfg(target_arch = "x86_64")]
        Set::Avx2(it) => it.vectorize(Task::<true, LANES> { kernel, runs, scratch, sums }),
        Set::Portable | Set::Plain => Task::<false, LANES> { kernel, runs, scratch, sums }.call(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::Nside;
    use crate::progress::Quietly;
    use crate::survey::{
        BigRational, ExactRotor, MapFrame, Moment, SampledScan, SamplingError, SurveyDetector,
        SurveySun,
    };
    use onboard_core::phase::Phase;
    use onboard_core::time::Instant;
    use std::sync::atomic::AtomicU64;

    fn survey(hz: i64) -> Survey {
        let period = |seconds: i64| {
            let period_s = BigRational::from_integer(seconds.into());
            ExactRotor::with_period(&period_s, Phase::ZERO).unwrap()
        };
        Survey {
            scan: SampledScan {
                start: Instant::from_tai_ns(0),
                sampling_hz: BigRational::from_integer(hz.into()),
                alpha_rad: 0.8,
                beta_rad: 0.9,
                precession: period(11_541),
                spin: period(1201),
            },
            sun: SurveySun::circular(Phase::ZERO),
            detectors: vec![SurveyDetector::BORESIGHT; 2],
            nside: Nside::new(4).unwrap(),
            frame: MapFrame::Galactic,
            moments: vec![Moment::new(2.0, 0.0).unwrap()],
        }
    }

    /// Hits and bits of all pixels.
    fn bits(maps: &SurveyMaps) -> (Vec<u64>, Vec<u64>) {
        let parts = maps.moment_maps().iter().map(|part| part.to_bits());
        (maps.hits_map().to_vec(), parts.collect())
    }

    #[test]
    fn maps_on_the_way_are_those_of_their_span() {
        let survey = survey(1);
        let mut collector = Collector::new(survey.clone(), Isa::best()).unwrap();
        collector.collect(0..50_000, 2, &Quietly).unwrap();
        let half = survey.run(0..50_000, 0, &Quietly).unwrap();
        assert_eq!(bits(&collector.maps()), bits(&half));
        collector.collect(50_000..100_000, 3, &Quietly).unwrap();
        let whole = survey.run(0..100_000, 1, &Quietly).unwrap();
        // Another division into blocks: the same hits, and h to what the kernel promises.
        let parts = collector.finish();
        assert_eq!(parts.hits_map(), whole.hits_map());
        for (a, b) in parts.moment_maps().iter().zip(whole.moment_maps()) {
            assert!((a - b).abs() < 1e-10 || (a.is_nan() && b.is_nan()), "{a} {b}");
        }
        assert_eq!(whole.hits_map().iter().sum::<u64>(), 200_000);
        assert_eq!((whole.frame(), whole.nside().get()), (MapFrame::Galactic, 4));
    }

    /// Asks for an end once some samples are done, and keeps what it was told.
    #[derive(Default)]
    struct Impatient {
        begun: AtomicU64,
        done: AtomicU64,
    }

    impl Progress for Impatient {
        fn begin(&self, _step: &str, units: u64) {
            self.begun.store(units, Ordering::Relaxed);
        }

        fn advance(&self, units: u64) {
            self.done.fetch_add(units, Ordering::Relaxed);
        }

        fn stopped(&self) -> bool {
            self.done.load(Ordering::Relaxed) > 0
        }
    }

    #[test]
    fn an_early_end_is_told_and_keeps_what_was_collected() {
        let watch = Impatient::default();
        let mut collector = Collector::new(survey(1), Isa::best()).unwrap();
        let ended = collector.collect(0..10_000_000, 2, &watch);
        assert_eq!(ended, Err(SurveyError::Stopped));
        assert_eq!(watch.begun.into_inner(), 20_000_000);
        let collected: u64 = collector.finish().hits_map().iter().sum();
        assert_eq!(collected, watch.done.into_inner());
        assert!(collected < 20_000_000);
    }

    #[test]
    fn what_cannot_be_sampled_is_refused_at_once() {
        let refused = Collector::new(survey(0), Isa::PLAIN).unwrap_err();
        assert_eq!(refused, SurveyError::Sampling(SamplingError::NotPositive { hz: 0.0 }));
        assert_eq!(survey(0).run(0..1, 1, &Quietly).unwrap_err(), refused);
    }
}
