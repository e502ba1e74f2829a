//! The fast survey: many samples at a time, accumulated per crossing of a pixel.
//!
//! Samples are taken in blocks. Over a block pixel coordinates and crossing-angle phasors are smooth,
//! so they are evaluated at eight nodes and interpolated: pixel coordinates to each sample, where
//! whole parts tell the pixel, phasors only to where the pixel changes ([`super::level`]). A block in
//! which they are not smooth enough (near a pole of the map, across a border between regions, with
//! half-integer moments at a jump) is split; what is left is evaluated sample by sample.
//!
//! Limits: the pixel is the flight core's for every sample; sums are within 1e-11 per sample of its.

use super::arc::Arc;
use super::axes::{Axes, BlockStart, Geometry, Offsets};
use super::lanes::{offset, times};
use super::level::{COARSE, FINE, Level, NODES, Phasors};
use super::pending::Pending;
use super::pixel::{Grid, Key};
use super::powers::{Multiples, Values};
use super::sight::Sights;
use crate::survey::clock::{phase_at, radians_per_sample};
use crate::survey::moment::Moment;
use crate::survey::mount::Mount;
use crate::survey::plain;
use crate::survey::runs::{LONGEST_RUN, Run};
use crate::survey::sampled::{Pixels, Sampled};
use crate::survey::sums::Sums;
use onboard_core::ephemeris::EphemerisError;
use onboard_core::phase::{Phase, Rotor};

/// Most small blocks in a run.
const RUN_BLOCKS: u64 = LONGEST_RUN / FINE as u64;

/// A survey made ready for `LANES` moments at most.
#[derive(Debug)]
pub(in crate::survey) struct Kernel<'s, const LANES: usize> {
    sampled: &'s Sampled<'s>,
    on: Pixels,
    pub(super) moments: &'s [Moment],
    geometry: Geometry,
    pub(super) grid: Grid,
    pub(super) mounts: Vec<Mount>,
    pub(super) plates: Vec<Rotor>,
    pub(super) multiples: Multiples,
    coarse: Option<Box<Level<COARSE, LANES>>>,
    fine: Option<Box<Level<FINE, LANES>>>,
    each: Offsets<FINE>,
    /// Per plate and moment: the plate's phasor at each sample of a small block.
    pub(super) each_plate: Vec<Vec<Values<FINE>>>,
    /// Rotations from a run's first sample to each small block: (cosine, sine).
    precession: Vec<(f64, f64)>,
    spin: Vec<(f64, f64)>,
    /// Per plate, small block and moment.
    plate: Vec<Vec<(f64, f64)>>,
    /// A half-integer m: the plate's phasor jumps once per turn, and is evaluated for each sample.
    pub(super) jumps: bool,
}

/// Working space of one thread.
#[derive(Debug)]
pub(in crate::survey) struct Scratch<const LANES: usize> {
    pub(super) node_axes: Axes<NODES>,
    pub(super) each_axes: Axes<FINE>,
    pub(super) nodes: Sights<NODES>,
    pub(super) each: Sights<FINE>,
    pub(super) node_powers: Vec<Values<NODES>>,
    pub(super) each_powers: Vec<Values<FINE>>,
    pub(super) values: Vec<Values<FINE>>,
    pub(super) each_plate: Vec<Vec<Values<FINE>>>,
    pub(super) phasors: [Phasors<LANES>; NODES],
    /// Per plate and moment, at a block's start.
    pub(super) plate: Vec<(f64, f64)>,
    unsettled: Vec<usize>,
    rest: Vec<usize>,
    pub(super) pending: Pending<LANES>,
}

impl<'s, const LANES: usize> Kernel<'s, LANES> {
    pub(in crate::survey) fn new(
        sampled: &'s Sampled<'s>,
        on: Pixels,
        moments: &'s [Moment],
    ) -> Self {
        let scan = &sampled.clock;
        let (mounts, plates) = sampled.mounts();
        let (precession, spin) =
            (radians_per_sample(scan.precession.rate), radians_per_sample(scan.spin.rate));
        let rates: Vec<f64> = plates.iter().map(|it| radians_per_sample(it.rate)).collect();
        let jumps = moments.iter().any(|it| it.twice_m() % 2 != 0);
        let highest = moments.iter().map(|it| it.n().abs()).fold(1.0, f64::max);
        // Angle by which the fastest phasor turns in half a block.
        let reach = |samples: usize| {
            offset(samples as u64) / 2.0 * (precession.abs() + spin.abs()) * highest
        };
        let smooth = |samples: usize| !jumps && reach(samples) < 1.0;
        let turned = |rate: f64| -> Vec<(f64, f64)> {
            (0..RUN_BLOCKS)
                .map(|q| {
                    let (sin, cos) = (rate * offset(q * FINE as u64)).sin_cos();
                    (cos, sin)
                })
                .collect()
        };
        let plate = rates
            .iter()
            .map(|rate| {
                (0..RUN_BLOCKS)
                    .flat_map(|q| {
                        let turn = rate * offset(q * FINE as u64);
                        moments.iter().map(move |it| {
                            let (sin, cos) = (-it.m() * turn).sin_cos();
                            (cos, sin)
                        })
                    })
                    .collect()
            })
            .collect();
        let samples: [f64; FINE] = std::array::from_fn(|k| offset(k as u64));
        let each_plate = rates
            .iter()
            .map(|rate| {
                moments
                    .iter()
                    .map(|it| {
                        let angles = samples.map(|k| -it.m() * rate * k);
                        [angles.map(f64::cos), angles.map(f64::sin)]
                    })
                    .collect()
            })
            .collect();
        Self {
            sampled,
            on,
            moments,
            geometry: Geometry {
                alpha: (scan.alpha_rad.cos(), scan.alpha_rad.sin()),
                map_axes: on.frame.map_axes(),
            },
            grid: Grid::new(on.nside),
            mounts,
            plates,
            multiples: Multiples::new(moments),
            coarse: smooth(COARSE)
                .then(|| Box::new(Level::new((precession, spin), &rates, moments))),
            fine: smooth(FINE).then(|| Box::new(Level::new((precession, spin), &rates, moments))),
            each: Offsets::new(samples, precession, spin),
            each_plate,
            precession: turned(precession),
            spin: turned(spin),
            plate,
            jumps,
        }
    }

    pub(in crate::survey) fn scratch(&self) -> Scratch<LANES> {
        let multiples = self.multiples.twice.len();
        let moments = self.moments.len();
        Scratch {
            node_axes: Axes::zero(),
            each_axes: Axes::zero(),
            nodes: Sights::zero(),
            each: Sights::zero(),
            node_powers: vec![[[0.0; NODES]; 2]; multiples],
            each_powers: vec![[[0.0; FINE]; 2]; multiples],
            values: vec![[[0.0; FINE]; 2]; moments],
            each_plate: vec![vec![[[0.0; FINE]; 2]; moments]; self.plates.len()],
            phasors: [[[0.0; LANES]; 2]; NODES],
            plate: vec![(1.0, 0.0); self.plates.len() * moments],
            unsettled: Vec::new(),
            rest: Vec::new(),
            pending: Pending::new(),
        }
    }

    /// Collects the samples of a run.
    #[inline(always)]
    pub(in crate::survey) fn collect<const FUSED: bool>(
        &self,
        run: Run,
        scratch: &mut Scratch<LANES>,
        sums: &mut Sums,
    ) -> Result<(), EphemerisError> {
        let scan = &self.sampled.clock;
        let arc = Arc::new(&self.sampled.sun, scan, (run.first, run.end - 1))?;
        let at = |rotor: Rotor| {
            let (sin, cos) = phase_at(rotor, run.first).sin_cos();
            (cos, sin)
        };
        let (precession, spin) = (at(scan.precession), at(scan.spin));
        let plates: Vec<(f64, f64)> = self
            .plates
            .iter()
            .flat_map(|plate| {
                let bits = phase_at(*plate, run.first).bits();
                // exp(-i m phi): whole multiples of the phase, exact modulo a turn.
                self.moments.iter().map(move |it| {
                    let m = i64::from(it.twice_m() / 2).cast_unsigned();
                    let (sin, cos) = Phase::from_bits(bits.wrapping_mul(m)).sin_cos();
                    (cos, -sin)
                })
            })
            .collect();
        let length = run.end - run.first;
        let blocks = usize::try_from(length.div_ceil(FINE as u64)).unwrap_or(0);
        let mut block = 0;
        while block < blocks {
            let first = (block * FINE) as u64;
            let q = block;
            let start = BlockStart {
                samples: offset(first),
                precession: times::<FUSED>(precession, self.precession[q]),
                spin: times::<FUSED>(spin, self.spin[q]),
            };
            let whole = length - first;
            scratch.rest.clear();
            match &self.coarse {
                Some(level) if whole >= COARSE as u64 => {
                    scratch.node_axes.set::<FUSED>(&self.geometry, &arc, &level.nodes, &start);
                    self.start_plates::<FUSED>(&plates, q, scratch);
                    for index in 0..self.mounts.len() {
                        let done = self.smooth::<FUSED, COARSE>(
                            level,
                            index,
                            run.first + first,
                            scratch,
                            sums,
                        );
                        if !done {
                            scratch.rest.push(index);
                        }
                    }
                    if !scratch.rest.is_empty() {
                        let rest = std::mem::take(&mut scratch.rest);
                        for sub in 0..COARSE / FINE {
                            let q = q + sub;
                            let first = first + (sub * FINE) as u64;
                            let start = BlockStart {
                                samples: offset(first),
                                precession: times::<FUSED>(precession, self.precession[q]),
                                spin: times::<FUSED>(spin, self.spin[q]),
                            };
                            self.fine::<FUSED>(
                                (&rest, FINE),
                                (&arc, &start, run.first + first),
                                (&plates, q),
                                scratch,
                                sums,
                            );
                        }
                        scratch.rest = rest;
                    }
                    block += COARSE / FINE;
                }
                _ => {
                    let mut all = std::mem::take(&mut scratch.rest);
                    all.extend(0..self.mounts.len());
                    let count = usize::try_from(whole).unwrap_or(FINE).min(FINE);
                    self.fine::<FUSED>(
                        (&all, count),
                        (&arc, &start, run.first + first),
                        (&plates, q),
                        scratch,
                        sums,
                    );
                    scratch.rest = all;
                    block += 1;
                }
            }
        }
        scratch.pending.flush::<0>(&self.grid, sums);
        Ok(())
    }

    /// The key of the pixel that the flight core decides on.
    #[cold]
    #[inline(never)]
    pub(super) fn decided(&self, index: usize, j: u64) -> Key {
        Grid::key_of_nested(plain::pixel(self.sampled, self.on, (index, j)))
    }

    /// The plates' phasors at a block's start.
    #[inline(always)]
    fn start_plates<const FUSED: bool>(
        &self,
        run_start: &[(f64, f64)],
        q: usize,
        scratch: &mut Scratch<LANES>,
    ) {
        let moments = self.moments.len();
        for (index, table) in self.plate.iter().enumerate() {
            let turned = &table[q * moments..(q + 1) * moments];
            let from = &run_start[index * moments..(index + 1) * moments];
            let to = &mut scratch.plate[index * moments..(index + 1) * moments];
            for ((to, from), turned) in to.iter_mut().zip(from).zip(turned) {
                *to = times::<FUSED>(*from, *turned);
            }
        }
    }

    /// A small block, of `count` samples, for some detectors.
    #[inline(always)]
    fn fine<const FUSED: bool>(
        &self,
        (detectors, count): (&[usize], usize),
        (arc, start, first): (&Arc, &BlockStart, u64),
        (plates, q): (&[(f64, f64)], usize),
        scratch: &mut Scratch<LANES>,
        sums: &mut Sums,
    ) {
        self.start_plates::<FUSED>(plates, q, scratch);
        let mut unsettled = std::mem::take(&mut scratch.unsettled);
        unsettled.clear();
        match &self.fine {
            Some(level) if count == FINE => {
                scratch.node_axes.set::<FUSED>(&self.geometry, arc, &level.nodes, start);
                for &index in detectors {
                    if !self.smooth::<FUSED, FINE>(level, index, first, scratch, sums) {
                        unsettled.push(index);
                    }
                }
            }
            _ => unsettled.extend_from_slice(detectors),
        }
        if !unsettled.is_empty() {
            scratch.each_axes.set::<FUSED>(&self.geometry, arc, &self.each, start);
            self.set_each_plate::<FUSED>(first, scratch);
            for &index in &unsettled {
                self.each::<FUSED>(index, (first, count), scratch, sums);
            }
        }
        scratch.unsettled = unsettled;
    }
}
