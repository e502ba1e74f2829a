//! One detector's block by interpolation.
//!
//! Pixel coordinates go from the nodes to every sample, where their whole parts tell the pixel;
//! phasors only to the samples at which the pixel changes, as sums from the block's start.
//!
//! Limits: a block is given back where it holds a border between regions or is not smooth enough.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays side by side")]

use super::blocks::{Kernel, Scratch};
use super::lanes::{madd, times};
use super::level::{COARSE, Level, NODES, Phasors, tail};
use super::pending::BATCH;
use super::pixel::{Grid, Key};
use super::sight::Sights;
use crate::survey::sums::Sums;

/// Largest two highest Chebyshev coefficients of pixel coordinates, in pixels. Coefficients fall
/// geometrically: those that reach this by order 6 fall at least fivefold per order, and what is left
/// out stays below 5e-8 pixels, far from [`Grid::EDGE`].
const PIXEL_TAIL: f64 = 1e-6;
/// The same for phasors, which fall at least tenfold: what is left out stays below 1e-11.
const PHASOR_TAIL: f64 = 1e-9;
/// How far beyond its node values a quantity may go between them, over their spread.
const BULGE: f64 = 0.125;

impl<const LANES: usize> Kernel<'_, LANES> {
    /// Collects one detector's block by interpolation; false where it is not smooth enough.
    #[inline(always)]
    pub(super) fn smooth<const FUSED: bool, const B: usize>(
        &self,
        level: &Level<B, LANES>,
        index: usize,
        first: u64,
        scratch: &mut Scratch<LANES>,
        sums: &mut Sums,
    ) -> bool {
        let mount = &self.mounts[index];
        if LANES > 0 {
            scratch.nodes.set::<FUSED, true>(&scratch.node_axes, mount);
        } else {
            scratch.nodes.set::<FUSED, false>(&scratch.node_axes, mount);
        }
        let Some((region, u, v)) = self.coordinates::<FUSED>(&mut scratch.nodes) else {
            return false;
        };
        if LANES > 0 && !self.set_phasors::<FUSED>(mount.plate, scratch) {
            return false;
        }
        // One place free in front, so that each key can be compared with the one before.
        let mut keys = [0.0; COARSE + 1];
        for k in 0..B {
            let (mut u_k, mut v_k) = (0.0, 0.0);
            for i in 0..NODES {
                u_k = madd::<FUSED>(level.basis[i][k], u[i], u_k);
                v_k = madd::<FUSED>(level.basis[i][k], v[i], v_k);
            }
            let floors = (u_k.floor(), v_k.floor());
            let key = Grid::key::<FUSED>(region, floors.0, floors.1);
            let near = Grid::off_middle((u_k, v_k), floors) > 0.5 - Grid::EDGE;
            keys[k + 1] = if near { -1.0 } else { key };
        }
        keys[0] = keys[1];
        let mut before = [[0.0; LANES]; 2];
        let mut from = 0;
        for word in 0..B / 32 {
            let mut changes = 0_u32;
            for bit in 0..32 {
                let k = word * 32 + bit;
                changes |= u32::from(keys[k + 1].to_bits() != keys[k].to_bits()) << bit;
            }
            while changes != 0 {
                let to = word * 32 + changes.trailing_zeros() as usize;
                changes &= changes - 1;
                self.close::<FUSED, B>(
                    level,
                    (index, first),
                    (keys[from + 1], from, to),
                    (scratch, &mut before),
                );
                from = to;
            }
        }
        self.close::<FUSED, B>(
            level,
            (index, first),
            (keys[from + 1], from, B),
            (scratch, &mut before),
        );
        scratch.pending.flush::<BATCH>(&self.grid, sums);
        true
    }

    /// Adds the samples from `from` to `to`, which have one key.
    #[inline(always)]
    fn close<const FUSED: bool, const B: usize>(
        &self,
        level: &Level<B, LANES>,
        (index, first): (usize, u64),
        (key, from, to): (Key, usize, usize),
        (scratch, before): (&mut Scratch<LANES>, &mut Phasors<LANES>),
    ) {
        if key >= 0.0 {
            let sum = self.sum_until::<FUSED, B>(level, index, to, &scratch.phasors, before);
            scratch.pending.note(key, from..to, &sum);
        } else {
            for k in from..to {
                let sum = self.sum_until::<FUSED, B>(level, index, k + 1, &scratch.phasors, before);
                let key = self.decided(index, first + k as u64);
                scratch.pending.note(key, k..k + 1, &sum);
            }
        }
    }

    /// The sums from the boundary of `before`, which moves on, to the boundary at sample `to`.
    #[inline(always)]
    fn sum_until<const FUSED: bool, const B: usize>(
        &self,
        level: &Level<B, LANES>,
        index: usize,
        to: usize,
        phasors: &[Phasors<LANES>; NODES],
        before: &mut Phasors<LANES>,
    ) -> Phasors<LANES> {
        let mut sum = [[0.0; LANES]; 2];
        if LANES == 0 {
            return sum;
        }
        let prefix = &level.prefix[self.mounts[index].plate][to];
        let mut until = [[0.0; LANES]; 2];
        for i in 0..NODES {
            let (f, w) = (&phasors[i], &prefix[i]);
            for lane in 0..LANES {
                let re = madd::<FUSED>(f[0][lane], w[0][lane], until[0][lane]);
                until[0][lane] = madd::<FUSED>(-f[1][lane], w[1][lane], re);
                let im = madd::<FUSED>(f[0][lane], w[1][lane], until[1][lane]);
                until[1][lane] = madd::<FUSED>(f[1][lane], w[0][lane], im);
            }
        }
        for part in 0..2 {
            for lane in 0..LANES {
                sum[part][lane] = until[part][lane] - before[part][lane];
            }
        }
        *before = until;
        sum
    }

    /// Region and pixel coordinates at the nodes, where all samples lie in one region and the
    /// coordinates are smooth.
    #[inline(always)]
    fn coordinates<const FUSED: bool>(
        &self,
        nodes: &mut Sights<NODES>,
    ) -> Option<(f64, [f64; NODES], [f64; NODES])> {
        let reach = |values: &[f64; NODES]| {
            let (mut low, mut high) = (values[0], values[0]);
            for &value in values {
                low = if value < low { value } else { low };
                high = if value > high { value } else { high };
            }
            let margin = BULGE * (high - low) + 1e-9;
            (low - margin, high + margin)
        };
        let first = nodes.quarters[0];
        for value in &mut nodes.quarters {
            let off = *value - first;
            *value -= if off > 2.0 {
                4.0
            } else if off < -2.0 {
                -4.0
            } else {
                0.0
            };
        }
        let (low, high) = reach(&nodes.z);
        let border = 2.0 / 3.0;
        let mut u = [0.0; NODES];
        let mut v = [0.0; NODES];
        let region = if low >= -border && high <= border {
            for i in 0..NODES {
                (u[i], v[i]) = self.grid.belt::<FUSED>(nodes.z[i], nodes.quarters[i]);
            }
            0.0
        } else if low > border || high < -border {
            let (west, east) = reach(&nodes.quarters);
            let quadrant = west.floor();
            if !(0.0..=3.0).contains(&quadrant) || east >= quadrant + 1.0 {
                return None;
            }
            for i in 0..NODES {
                (u[i], v[i]) = self.grid.cap::<FUSED>(
                    (nodes.z[i], nodes.sin_theta[i]),
                    nodes.quarters[i],
                    quadrant,
                );
            }
            quadrant + if low > 0.0 { 1.0 } else { 5.0 }
        } else {
            return None;
        };
        (tail(&u) < PIXEL_TAIL && tail(&v) < PIXEL_TAIL).then_some((region, u, v))
    }

    /// Sets the phasors of all moments at the nodes; false where they are not smooth enough.
    #[inline(always)]
    fn set_phasors<const FUSED: bool>(&self, plate: usize, scratch: &mut Scratch<LANES>) -> bool {
        let count = self.moments.len();
        self.multiples.set::<FUSED, NODES>(&scratch.nodes.psi, &mut scratch.node_powers);
        // The highest multiple is the least smooth; half-integers may jump.
        let last = scratch.node_powers.len() - 1;
        for (index, values) in scratch.node_powers.iter().enumerate() {
            let odd = self.multiples.twice[index] % 2 == 1;
            if (index == last || odd)
                && (tail(&values[0]) > PHASOR_TAIL || tail(&values[1]) > PHASOR_TAIL)
            {
                return false;
            }
        }
        let starts = &scratch.plate[plate * count..(plate + 1) * count];
        for (lane, ((power, conjugate), start)) in
            self.multiples.of_moment.iter().zip(starts).enumerate().take(LANES)
        {
            let values = &scratch.node_powers[*power];
            for i in 0..NODES {
                let im = if *conjugate { -values[1][i] } else { values[1][i] };
                let (re, im) = times::<FUSED>((values[0][i], im), *start);
                scratch.phasors[i][0][lane] = re;
                scratch.phasors[i][1][lane] = im;
            }
        }
        true
    }
}
