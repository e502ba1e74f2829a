//! Every sample of a survey, some side by side: the pixel on each of several maps, the polarisation
//! angle in the map's frame, the plate's angle.
//!
//! Angles are cosines and sines: of the crossing angle plus a constant turn per detector, and of the
//! plate's angle (1, 0 without a plate). Pixels are NESTED.
//!
//! Method: the survey kernel's axes and sights, evaluated for each sample; phases at the start of each
//! block are the flight core's.
//!
//! Limits: the pixel is the flight core's for every sample (test `blocks_are_the_flight_cores`);
//! angles are within 1e-11 rad of its, save where the sine of the colatitude underflows.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays side by side")]

use super::arc::Arc;
use super::axes::{Axes, BlockStart, Geometry, Offsets};
use super::lanes::{offset, times};
use super::level::FINE;
use super::pixel::Grid;
use super::sight::Sights;
use crate::survey::clock::{phase_at, radians_per_sample};
use crate::survey::isa::{Isa, Set};
use crate::survey::mount::Mount;
use crate::survey::plain;
use crate::survey::runs::{Run, tasks};
use crate::survey::sampled::{Pixels, Sampled};
use onboard_core::ephemeris::EphemerisError;
use onboard_core::phase::Rotor;
use pulp::NullaryFnOnce;
use std::ops::Range;

/// Samples of a block.
pub(crate) const BLOCK: usize = FINE;

/// Cosines and sines at the samples of a block.
pub(crate) type Phasors = [[f64; BLOCK]; 2];

/// Where one detector's samples fall on one map.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    /// NESTED pixels.
    pub(crate) pixel: [u32; BLOCK],
    /// Crossing angle plus the detector's turn.
    pub(crate) psi: Phasors,
}

/// Consecutive samples of one detector.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub(crate) detector: usize,
    /// Number of the first sample.
    pub(crate) first: u64,
    /// How many of the arrays' places are samples.
    pub(crate) count: usize,
    /// Per map.
    pub(crate) seen: Vec<Seen>,
    pub(crate) plate: Phasors,
}

/// One of the maps.
#[derive(Debug)]
struct View {
    /// The map's pixels, for the flight core.
    on: Pixels,
    geometry: Geometry,
    grid: Grid,
    /// The same frame as the view before, whose sights serve again.
    again: bool,
}

/// A survey whose samples are looked at one by one.
#[derive(Debug)]
pub(crate) struct Stream<'s> {
    isa: Isa,
    sampled: &'s Sampled<'s>,
    views: Vec<View>,
    mounts: Vec<Mount>,
    /// Per detector: what is added to its crossing angle.
    turns: Vec<(f64, f64)>,
    plates: Vec<Rotor>,
    offsets: Offsets<BLOCK>,
    /// Per plate: its turn since the block's first sample.
    plate_offsets: Vec<Phasors>,
}

/// Working space of one job.
#[derive(Debug)]
struct Scratch {
    axes: Vec<Axes<BLOCK>>,
    sights: Sights<BLOCK>,
    blocks: Vec<Block>,
    /// Per plate, at the block's first sample.
    plates: Vec<(f64, f64)>,
}

/// Some samples of some detectors.
#[derive(Debug, Clone)]
pub(crate) struct Job {
    run: Run,
    detectors: Range<usize>,
}

impl Job {
    pub(crate) const fn first_detector(&self) -> usize {
        self.detectors.start
    }

    pub(crate) fn samples(&self) -> u64 {
        self.run.samples() * self.detectors.len() as u64
    }
}

/// Detectors of a job, which share the axes.
const JOB_DETECTORS: usize = 4;

impl<'s> Stream<'s> {
    /// A stream of samples on `maps`; to the crossing angle of each detector its place in `turns_rad`
    /// is added.
    pub(crate) fn new(
        sampled: &'s Sampled<'s>,
        maps: &[Pixels],
        turns_rad: &[f64],
        isa: Isa,
    ) -> Self {
        let scan = &sampled.clock;
        let pair = |angle: &f64| {
            let (sin, cos) = angle.sin_cos();
            (cos, sin)
        };
        let turns: Vec<(f64, f64)> = turns_rad.iter().map(pair).collect();
        let (mut mounts, plates) = sampled.mounts();
        for (mount, &turn) in mounts.iter_mut().zip(&turns) {
            mount.turn = times::<false>(mount.turn, turn);
        }
        let views = (0..maps.len())
            .map(|index| {
                let on = maps[index];
                View {
                    on,
                    geometry: Geometry {
                        alpha: (scan.alpha_rad.cos(), scan.alpha_rad.sin()),
                        map_axes: on.frame.map_axes(),
                    },
                    grid: Grid::new(on.nside),
                    again: index > 0 && maps[index - 1].frame == on.frame,
                }
            })
            .collect();
        let samples: [f64; BLOCK] = std::array::from_fn(|k| offset(k as u64));
        let plate_offsets = plates
            .iter()
            .map(|plate| {
                let angles = samples.map(|k| radians_per_sample(plate.rate) * k);
                [angles.map(f64::cos), angles.map(f64::sin)]
            })
            .collect();
        let rate = |rotor: Rotor| radians_per_sample(rotor.rate);
        let offsets = Offsets::new(samples, rate(scan.precession), rate(scan.spin));
        Self { isa, sampled, views, mounts, turns, plates, offsets, plate_offsets }
    }

    /// The jobs that samples `span` fall into, in time; they do not depend on the number of threads.
    pub(crate) fn jobs(&self, span: Range<u64>) -> impl Iterator<Item = Job> + use<> {
        let detectors = self.mounts.len();
        tasks(self.sampled, span).into_iter().flatten().flat_map(move |run| {
            (0..detectors).step_by(JOB_DETECTORS).map(move |first| Job {
                run,
                detectors: first..(first + JOB_DETECTORS).min(detectors),
            })
        })
    }

    /// Shows the blocks of a job: in time, then by detector.
    ///
    /// # Errors
    /// [`EphemerisError::OutOfSpan`] beyond the Sun's table.
    pub(crate) fn run(&self, job: &Job, mut see: impl FnMut(&Block)) -> Result<(), EphemerisError> {
        let Job { run, detectors } = job;
        let scan = &self.sampled.clock;
        let arc = Arc::new(&self.sampled.sun, scan, (run.first, run.end - 1))?;
        let zero = [[0.0; BLOCK]; 2];
        let seen = Seen { pixel: [0; BLOCK], psi: zero };
        let mut scratch = Scratch {
            axes: vec![Axes::zero(); self.views.len()],
            sights: Sights::zero(),
            blocks: detectors
                .clone()
                .map(|detector| Block {
                    detector,
                    first: run.first,
                    count: 0,
                    seen: vec![seen.clone(); self.views.len()],
                    plate: zero,
                })
                .collect(),
            plates: vec![(1.0, 0.0); self.plates.len()],
        };
        let mut first = run.first;
        while first < run.end {
            let count = usize::try_from(run.end - first).unwrap_or(BLOCK).min(BLOCK);
            for block in &mut scratch.blocks {
                block.first = first;
                block.count = count;
            }
            self.fill(&arc, (run.first, first), &mut scratch)?;
            for block in &scratch.blocks {
                see(block);
            }
            first += count as u64;
        }
        Ok(())
    }

    /// Fills all blocks from sample `first` on, in a run that starts at `origin`.
    fn fill(
        &self,
        arc: &Arc,
        (origin, first): (u64, u64),
        scratch: &mut Scratch,
    ) -> Result<(), EphemerisError> {
        let scan = &self.sampled.clock;
        let at = |rotor: Rotor| {
            let (sin, cos) = phase_at(rotor, first).sin_cos();
            (cos, sin)
        };
        let start = BlockStart {
            samples: offset(first - origin),
            precession: at(scan.precession),
            spin: at(scan.spin),
        };
        for (to, plate) in scratch.plates.iter_mut().zip(&self.plates) {
            *to = at(*plate);
        }
        match self.isa.set() {
            #[cfg(target_arch = "x86_64")]
            Set::Avx512(it) => {
                it.vectorize(Fill::<true> { stream: self, arc, start: &start, scratch });
            }
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(it) => {
                it.vectorize(Fill::<true> { stream: self, arc, start: &start, scratch });
            }
            Set::Portable => Fill::<false> { stream: self, arc, start: &start, scratch }.call(),
            Set::Plain => return self.fill_plainly(scratch),
        }
        Ok(())
    }

    fn fill_plainly(&self, scratch: &mut Scratch) -> Result<(), EphemerisError> {
        for block in &mut scratch.blocks {
            for k in 0..block.count {
                for (view, seen) in self.views.iter().zip(&mut block.seen) {
                    let j = block.first + k as u64;
                    let sample = plain::sample(self.sampled, view.on, (block.detector, j))?;
                    let (sin, cos) = sample.crossing_angle_rad.sin_cos();
                    let (cos, sin) = times::<false>((cos, sin), self.turns[block.detector]);
                    seen.pixel[k] = sample.pixel;
                    seen.psi[0][k] = cos;
                    seen.psi[1][k] = sin;
                    let (sin, cos) = sample.plate_angle_rad.sin_cos();
                    block.plate[0][k] = cos;
                    block.plate[1][k] = sin;
                }
            }
        }
        Ok(())
    }

    /// The pixels that the flight core decides on.
    #[cold]
    #[inline(never)]
    fn decide(&self, view: &View, detector: usize, j: u64) -> u32 {
        plain::pixel(self.sampled, view.on, (detector, j))
    }
}

/// Fills all blocks of a job.
struct Fill<'t, 's, const FUSED: bool> {
    stream: &'t Stream<'s>,
    arc: &'t Arc,
    start: &'t BlockStart,
    scratch: &'t mut Scratch,
}

impl<const FUSED: bool> NullaryFnOnce for Fill<'_, '_, FUSED> {
    type Output = ();

    /// Inlined, with all that it calls, into a function with the instruction set's features.
    #[inline(always)]
    fn call(self) {
        let Self { stream, arc, start, scratch } = self;
        for (view, axes) in stream.views.iter().zip(&mut scratch.axes) {
            if !view.again {
                axes.set::<FUSED>(&view.geometry, arc, &stream.offsets, start);
            }
        }
        for block in &mut scratch.blocks {
            let mount = &stream.mounts[block.detector];
            let offsets = &stream.plate_offsets[mount.plate];
            for k in 0..BLOCK {
                let turned = (offsets[0][k], offsets[1][k]);
                let (cos, sin) = times::<FUSED>(turned, scratch.plates[mount.plate]);
                block.plate[0][k] = cos;
                block.plate[1][k] = sin;
            }
            for (index, view) in stream.views.iter().enumerate() {
                if !view.again {
                    scratch.sights.set::<FUSED, true>(&scratch.axes[index], mount);
                }
                let sights = &scratch.sights;
                let seen = &mut block.seen[index];
                seen.psi = sights.psi;
                let mut keys = [0.0; BLOCK];
                for k in 0..BLOCK {
                    keys[k] = view.grid.key_at::<FUSED>(
                        sights.z[k],
                        sights.sin_theta[k],
                        sights.quarters[k],
                    );
                }
                for k in 0..BLOCK {
                    seen.pixel[k] = view.grid.nested(keys[k]);
                }
                for k in 0..block.count {
                    if keys[k] < 0.0 {
                        let j = block.first + k as u64;
                        seen.pixel[k] = stream.decide(view, block.detector, j);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::healpix::Nside;
    use crate::survey::{
        BigRational, ExactRotor, MapFrame, SampledScan, SunSource, Survey, SurveyDetector,
        SurveySun,
    };
    use onboard_core::detector::detector_at;
    use onboard_core::phase::Phase;
    use onboard_core::rotation::Rotation;
    use onboard_core::time::Instant;

    /// A rotation of so many seconds, and so samples, per turn.
    fn rotor(seconds: i64, start_rad: f64) -> ExactRotor {
        let period_s = BigRational::from_integer(seconds.into());
        ExactRotor::with_period(&period_s, Phase::from_radians(start_rad)).unwrap()
    }

    #[test]
    fn blocks_are_the_flight_cores() {
        let turn_rad = [0.0, 0.7, 0.0, -2.0, 1.0];
        let detectors = [
            (Rotation::IDENTITY, Some(rotor(19, 0.1))),
            (detector_at(0.2, 1.0, 0.4), None),
            (detector_at(0.87, 3.2, 0.1), Some(rotor(7, 0.0))),
            (detector_at(0.1, 4.0, -2.0), None),
            (detector_at(0.01, 0.3, 0.2), Some(rotor(19, 0.1))),
        ]
        .map(|(rotation, plate)| SurveyDetector { rotation, plate, polarisation_rad: 0.0 });
        let nside = |n: u32| Nside::new(n).unwrap();
        let survey = Survey {
            scan: SampledScan {
                start: Instant::from_tai_ns(0),
                sampling_hz: BigRational::from_integer(1.into()),
                alpha_rad: 0.8,
                beta_rad: 0.9,
                precession: rotor(11_541, 1.0),
                spin: rotor(1201, 2.0),
            },
            sun: SurveySun { source: SunSource::Circular(rotor(31_557_600, 0.3)), step: None },
            detectors: detectors.to_vec(),
            nside: nside(32),
            frame: MapFrame::Galactic,
            moments: Vec::new(),
        };
        let maps = [
            Pixels { frame: MapFrame::Galactic, nside: nside(32) },
            Pixels { frame: MapFrame::Galactic, nside: nside(2048) },
            Pixels { frame: MapFrame::Ecliptic, nside: nside(64) },
        ];
        let sampled = Sampled::of(&survey).unwrap();
        let span = 1_000_000_007..1_000_020_000;
        for isa in ["auto", "avx2", "portable", "plain"] {
            let Ok(isa) = Isa::named(isa) else { continue };
            let stream = Stream::new(&sampled, &maps, &turn_rad, isa);
            let mut seen = 0;
            let near = |(cos, sin): (f64, f64), angle: f64| {
                assert!(
                    (cos - angle.cos()).hypot(sin - angle.sin()) < 1e-11,
                    "{cos} {sin} {angle}"
                );
            };
            for job in stream.jobs(span.clone()) {
                let run = stream.run(&job, |block| {
                    for k in 0..block.count {
                        seen += 1;
                        let j = block.first + k as u64;
                        for (&on, found) in maps.iter().zip(&block.seen) {
                            let expected =
                                plain::sample(&sampled, on, (block.detector, j)).unwrap();
                            assert_eq!(found.pixel[k], expected.pixel);
                            let psi = expected.crossing_angle_rad + turn_rad[block.detector];
                            near((found.psi[0][k], found.psi[1][k]), psi);
                            near((block.plate[0][k], block.plate[1][k]), expected.plate_angle_rad);
                        }
                    }
                });
                run.unwrap();
            }
            assert_eq!(seen, 5 * (span.end - span.start));
        }
    }
}
