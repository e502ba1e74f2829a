//! One detector's samples, each evaluated: where blocks are not smooth, and for fast sweeps.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays side by side")]

use super::blocks::{Kernel, Scratch};
use super::lanes::times;
use super::level::FINE;
use super::pending::BATCH;
use super::powers::Values;
use crate::survey::clock::plate_phase_at;
use crate::survey::moment::Moment;
use crate::survey::sums::Sums;
use onboard_core::phase::{Phase, Rotor};

impl<const LANES: usize> Kernel<'_, LANES> {
    /// The plates' phasors at each sample of a small block.
    #[inline(always)]
    pub(super) fn set_each_plate<const FUSED: bool>(
        &self,
        first: u64,
        scratch: &mut Scratch<LANES>,
    ) {
        let count = self.moments.len();
        for (plate, tables) in self.each_plate.iter().enumerate() {
            for (moment, table) in tables.iter().enumerate() {
                let start = scratch.plate[plate * count + moment];
                let to = &mut scratch.each_plate[plate][moment];
                if self.jumps && self.moments[moment].twice_m() % 2 != 0 {
                    half_integer_plate(self.plates[plate], self.moments[moment], first, to);
                } else {
                    for k in 0..FINE {
                        let (re, im) = times::<FUSED>((table[0][k], table[1][k]), start);
                        to[0][k] = re;
                        to[1][k] = im;
                    }
                }
            }
        }
    }

    /// Collects `count` samples of one detector, each evaluated.
    #[inline(always)]
    pub(super) fn each<const FUSED: bool>(
        &self,
        index: usize,
        (first, count): (u64, usize),
        scratch: &mut Scratch<LANES>,
        sums: &mut Sums,
    ) {
        let mount = &self.mounts[index];
        if LANES > 0 {
            scratch.each.set::<FUSED, true>(&scratch.each_axes, mount);
        } else {
            scratch.each.set::<FUSED, false>(&scratch.each_axes, mount);
        }
        let sights = &scratch.each;
        let mut keys = [0.0; FINE];
        for k in 0..FINE {
            keys[k] =
                self.grid.key_at::<FUSED>(sights.z[k], sights.sin_theta[k], sights.quarters[k]);
        }
        if LANES > 0 {
            self.multiples.set::<FUSED, FINE>(&sights.psi, &mut scratch.each_powers);
            for (moment, (power, conjugate)) in self.multiples.of_moment.iter().enumerate() {
                let values = &scratch.each_powers[*power];
                let plate = &scratch.each_plate[mount.plate][moment];
                let to = &mut scratch.values[moment];
                for k in 0..FINE {
                    let im = if *conjugate { -values[1][k] } else { values[1][k] };
                    let (re, im) = times::<FUSED>((values[0][k], im), (plate[0][k], plate[1][k]));
                    to[0][k] = re;
                    to[1][k] = im;
                }
            }
        }
        let mut from = 0;
        while from < count {
            let key = keys[from];
            let mut to = from + 1;
            while key >= 0.0 && to < count && keys[to].to_bits() == key.to_bits() {
                to += 1;
            }
            let mut sum = [[0.0; LANES]; 2];
            if LANES > 0 {
                for (lane, values) in scratch.values.iter().enumerate().take(LANES) {
                    for k in from..to {
                        sum[0][lane] += values[0][k];
                        sum[1][lane] += values[1][k];
                    }
                }
            }
            let key = if key >= 0.0 { key } else { self.decided(index, first + from as u64) };
            scratch.pending.note(key, from..to, &sum);
            from = to;
        }
        scratch.pending.flush::<BATCH>(&self.grid, sums);
    }
}

/// `exp(-i m phi)` at consecutive samples for a half-integer m, phi in [0, 2 pi).
#[inline(never)]
fn half_integer_plate(plate: Rotor, moment: Moment, first: u64, to: &mut Values<FINE>) {
    for k in 0..FINE {
        let phase = plate_phase_at(plate, first + k as u64);
        let turned = phase.half().bits().wrapping_mul(i64::from(moment.twice_m()).cast_unsigned());
        let (sin, cos) = Phase::from_bits(turned).sin_cos();
        to[0][k] = cos;
        to[1][k] = -sin;
    }
}
