//! Interpolation over a block of samples, and sums of interpolated phasors.
//!
//! Over a short block everything smooth is a polynomial of degree 7 through its values at eight
//! nodes. [`Level::basis`] gives it at each sample. For sums over a run of samples in one pixel,
//! [`Level::prefix`] holds, for each node i and sample j, `sum_{k < j} L_i(k) exp(-i m k delta)`: the sum
//! of any interpolated function times the half-wave plate's phasor over samples j to k is then a
//! difference of two products with the node values, whatever the length of the run.
//!
//! Method: Chebyshev-Lobatto nodes; the two highest Chebyshev coefficients tell whether the degree
//! is enough.

use super::axes::Offsets;
use super::lanes::offset;
use crate::survey::moment::Moment;
use std::f64::consts::PI;

/// Samples of a large block.
pub(super) const COARSE: usize = 128;
/// Samples of a small block; large ones start at its multiples.
pub(super) const FINE: usize = 32;
/// Nodes of a block.
pub(super) const NODES: usize = 8;
/// Their number less one.
const DEGREE: f64 = 7.0;

/// Values at the nodes or sums of them, side by side for up to `LANES` moments: real, imaginary.
pub(super) type Phasors<const LANES: usize> = [[f64; LANES]; 2];

/// Blocks of `B` samples.
#[derive(Debug)]
pub(super) struct Level<const B: usize, const LANES: usize> {
    /// The nodes' offsets.
    pub(super) nodes: Offsets<NODES>,
    /// Lagrange polynomial of each node at each sample.
    pub(super) basis: [[f64; B]; NODES],
    /// Per plate, boundary and node: sums of the basis times the plate's phasor.
    pub(super) prefix: Vec<Vec<[Phasors<LANES>; NODES]>>,
}

/// The coordinate in [-1, 1] of each node, from the last sample of a block to the first.
fn node(i: usize) -> f64 {
    (PI * offset(i as u64) / DEGREE).cos()
}

impl<const B: usize, const LANES: usize> Level<B, LANES> {
    /// `plates` are radians per sample.
    pub(super) fn new((precession, spin): (f64, f64), plates: &[f64], moments: &[Moment]) -> Self {
        let half = offset(B as u64 - 1) / 2.0;
        let samples = std::array::from_fn(|i| half * (1.0 + node(i)));
        let basis = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                let x = offset(k as u64) / half - 1.0;
                (0..NODES)
                    .filter(|&j| j != i)
                    .map(|j| (x - node(j)) / (node(i) - node(j)))
                    .product()
            })
        });
        let prefix = plates.iter().map(|&rate| prefix(&basis, rate, moments)).collect();
        Self { nodes: Offsets::new(samples, precession, spin), basis, prefix }
    }
}

fn prefix<const B: usize, const LANES: usize>(
    basis: &[[f64; B]; NODES],
    rate: f64,
    moments: &[Moment],
) -> Vec<[Phasors<LANES>; NODES]> {
    let mut sums = [[[0.0; LANES]; 2]; NODES];
    let mut all = vec![sums];
    for k in 0..B {
        for (lane, moment) in moments.iter().enumerate().take(LANES) {
            let angle = -moment.m() * rate * offset(k as u64);
            let (sin, cos) = angle.sin_cos();
            for (sum, values) in sums.iter_mut().zip(basis) {
                sum[0][lane] += values[k] * cos;
                sum[1][lane] += values[k] * sin;
            }
        }
        all.push(sums);
    }
    all
}

/// Weights of the node values in the Chebyshev coefficient of order `order`.
const fn tail_weights(order: usize) -> [f64; NODES] {
    // cos(pi i order / 7) from the table of cos(pi k / 7), k modulo 14.
    const COSINES: [f64; 14] = [
        1.0,
        0.900_968_867_902_419_1,
        0.623_489_801_858_733_5,
        0.222_520_933_956_314_4,
        -0.222_520_933_956_314_4,
        -0.623_489_801_858_733_5,
        -0.900_968_867_902_419_1,
        -1.0,
        -0.900_968_867_902_419_1,
        -0.623_489_801_858_733_5,
        -0.222_520_933_956_314_4,
        0.222_520_933_956_314_4,
        0.623_489_801_858_733_5,
        0.900_968_867_902_419_1,
    ];
    let mut weights = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        let end = if i == 0 || i == NODES - 1 { 0.5 } else { 1.0 };
        let top = if order == NODES - 1 { 0.5 } else { 1.0 };
        weights[i] = 2.0 / DEGREE * end * top * COSINES[(i * order) % 14];
        i += 1;
    }
    weights
}

const SIXTH: [f64; NODES] = tail_weights(6);
const SEVENTH: [f64; NODES] = tail_weights(7);

/// Size of the two highest Chebyshev coefficients of the polynomial through node values: what is
/// left out is smaller by at least as much as they fall.
#[inline(always)]
pub(super) fn tail(values: &[f64; NODES]) -> f64 {
    let mut sixth = 0.0;
    let mut seventh = 0.0;
    for i in 0..NODES {
        sixth += SIXTH[i] * values[i];
        seventh += SEVENTH[i] * values[i];
    }
    sixth.abs() + seventh.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_reproduced_and_their_tail_is_seen() {
        let level = Level::<32, 4>::new((0.01, 0.02), &[0.3], &[Moment::new(0.0, 2.0).unwrap()]);
        for degree in 0..8 {
            let values: [f64; NODES] = std::array::from_fn(|i| node(i).powi(degree));
            for k in 0..32 {
                let x = offset(k as u64) / 15.5 - 1.0;
                let sum: f64 = (0..NODES).map(|i| values[i] * level.basis[i][k]).sum();
                assert!((sum - x.powi(degree)).abs() < 1e-14);
            }
            // T_6 = 32 x^6 - ..., T_7 = 64 x^7 - ...
            let expected = match degree {
                6 => 1.0 / 32.0,
                7 => 1.0 / 64.0,
                _ => 0.0,
            };
            assert!((tail(&values) - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn sums_over_runs_are_differences() {
        let level = Level::<32, 4>::new((0.01, 0.02), &[0.3], &[Moment::new(0.0, 2.0).unwrap()]);
        let f = |k: f64| 1.0 + 0.2 * k - 0.01 * k * k;
        let values: [f64; NODES] = std::array::from_fn(|i| f(level.nodes.samples[i]));
        let (mut re, mut im) = (0.0, 0.0);
        for k in 5..19_u64 {
            let (sin, cos) = (-2.0 * 0.3 * offset(k)).sin_cos();
            re += f(offset(k)) * cos;
            im += f(offset(k)) * sin;
        }
        let at = |j: usize, part: usize| -> f64 {
            (0..NODES).map(|i| values[i] * level.prefix[0][j][i][part][0]).sum()
        };
        assert!((at(19, 0) - at(5, 0) - re).abs() < 1e-12);
        assert!((at(19, 1) - at(5, 1) - im).abs() < 1e-12);
    }
}
