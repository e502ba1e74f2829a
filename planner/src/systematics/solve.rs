//! The least-squares solution of a pixel from its orientation functions.
//!
//! A sample is `d = I + Re[P z*]`, `z = exp(i (2 psi_pol - 4 phi))`, without a plate
//! `exp(2i psi_pol)`. The normal equations over (I, Q, U) hold `<z>` and `<z^2>`:
//!
//! `[[1, c, s], [c, (1 + C)/2, S/2], [s, S/2, (1 - C)/2]] (I, Q, U) = (<d>, Re<d z>, Im<d z>)`,
//!
//! `<z> = c + i s`, `<z^2> = C + i S`. Of a pair's difference, which has no I, the lower right block.
//!
//! Method: inverted by Cholesky decomposition; the condition number is that of
//! [`crate::mapmaking::BinnedMaps::condition`].
//!
//! Limits: pixels whose condition number exceeds [`CONDITION_LIMIT`] have no solution.

use super::orientation::{Mean, OrientationError, Orientations, Polarimeter};
use crate::harmonics::Complex64;
use crate::mapmaking::CONDITION_LIMIT;
use nalgebra::{Matrix2, Matrix3};

/// I and P as sums over `<d>`, `<d z>` and its conjugate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inverse {
    /// Of I, whose third is the conjugate of the second.
    pub(super) intensity: [Complex64; 3],
    /// Of P.
    pub(super) polarisation: [Complex64; 3],
}

/// Why a pixel has no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unsolved {
    /// It has no samples.
    Unobserved,
    /// Its angles do not tell I, Q and U apart.
    Singular,
}

/// Solves pixel by pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solver<'h> {
    hits: &'h [u64],
    z: Mean<'h>,
    z_squared: Mean<'h>,
    /// `exp(2i polarisation)` less the sign of z.
    turn: Complex64,
    pair: bool,
}

impl<'h> Solver<'h> {
    pub(super) fn new(
        orientations: &'h Orientations,
        polarimeter: &Polarimeter,
    ) -> Result<Self, OrientationError> {
        let [z, z_squared] = polarimeter.own_spins();
        Ok(Self {
            hits: orientations.hits(),
            z: orientations.mean(z)?,
            z_squared: orientations.mean(z_squared)?,
            turn: turn(polarimeter),
            pair: polarimeter.pair,
        })
    }

    pub(super) fn at(&self, pixel: usize) -> Result<Inverse, Unsolved> {
        if self.hits[pixel] == 0 {
            return Err(Unsolved::Unobserved);
        }
        let z = self.turn * self.z.at(pixel);
        let z_squared = self.turn * self.turn * self.z_squared.at(pixel);
        let (plus, minus) = (0.5 * (1.0 + z_squared.re), 0.5 * (1.0 - z_squared.re));
        let cross = 0.5 * z_squared.im;
        let rows = if self.pair {
            let normal = Matrix2::new(plus, cross, cross, minus);
            let eigenvalues = normal.symmetric_eigenvalues();
            check(eigenvalues.min(), eigenvalues.max())?;
            let inverse = normal.cholesky().ok_or(Unsolved::Singular)?.inverse();
            let [[a, b], [_, c]] = inverse.into();
            [[0.0; 3], [0.0, a, b], [0.0, b, c]]
        } else {
            let normal = Matrix3::new(1.0, z.re, z.im, z.re, plus, cross, z.im, cross, minus);
            let eigenvalues = normal.symmetric_eigenvalues();
            check(eigenvalues.min(), eigenvalues.max())?;
            normal.cholesky().ok_or(Unsolved::Singular)?.inverse().into()
        };
        // u Re y + v Im y = (u - i v)/2 y + (u + i v)/2 y*
        let sums = |of: Complex64, u: Complex64, v: Complex64| {
            let turned = Complex64::I * v;
            [of, 0.5 * (u - turned), 0.5 * (u + turned)]
        };
        let [i, q, u] = rows;
        let p: [Complex64; 3] = std::array::from_fn(|at| Complex64::new(q[at], u[at]));
        Ok(Inverse {
            intensity: sums(i[0].into(), i[1].into(), i[2].into()),
            polarisation: sums(p[0], p[1], p[2]),
        })
    }
}

/// `z = turn exp(i (2 psi - 4 phi))`: `psi_pol` is psi, a quarter turn and the detector's own angle.
pub(super) fn turn(polarimeter: &Polarimeter) -> Complex64 {
    -Complex64::from_polar(1.0, 2.0 * polarimeter.polarisation_rad)
}

fn check(low: f64, high: f64) -> Result<(), Unsolved> {
    if low > 0.0 && high <= CONDITION_LIMIT * low { Ok(()) } else { Err(Unsolved::Singular) }
}
