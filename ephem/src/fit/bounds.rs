//! How fast the fitted direction can move.
//!
//! Answers: upper bounds over a span on the unit vector's rate, second derivative and |z|, for the
//! series as they stand in the table (granule by granule; steps of rounding size at joints aside).
//!
//! Method: for a polynomial p of degree m with values in a Euclidean space, sampled at the N > m
//! zeros of `T_N`, `max |p| <= max_j |p(x_j)| / cos(pi m / (2 N))` \[Ehlich1964\], applied to `w . p`
//! for every unit w. With series v of degree d, `r = |v|`, `u = v/r`: `r' = Q'/(2 r)` and
//! `r'' = (Q''/2 - r'^2)/r` for the polynomial `Q = v . v`; `|u'| <= |v'|/r`, because u' is v'/r
//! without its part along u; `u'' = (v'' - r'' u - 2 r' u')/r`.
//!
//! Limits: N = 8 d makes the bounds on v', v'' 2% high; the terms in r', r'' are those of the fit's
//! error and small. `tests/fit.rs` holds the bounds within 25% of the true maxima.

use crate::chebyshev::{derivatives, zeros};
use crate::convert::{f64_from_i64, f64_from_usize};
use core::f64::consts::PI;
use nalgebra::Vector3;
use onboard_core::direction::MotionBounds;

/// Samples per degree.
const SAMPLES: usize = 8;
/// For the rounding of the samples themselves.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Largest magnitudes over samples, with respect to x in [-1, 1].
#[derive(Default)]
struct Largest {
    z: f64,
    slope: f64,
    curvature: f64,
    square: f64,
    square_slope: f64,
    square_curvature: f64,
}

impl Largest {
    fn see(&mut self, [v, d, e]: [Vector3<f64>; 3]) {
        let keep = |slot: &mut f64, value: f64| *slot = slot.max(value.abs());
        keep(&mut self.z, v.z);
        keep(&mut self.slope, d.norm());
        keep(&mut self.curvature, e.norm());
        keep(&mut self.square, v.norm_squared() - 1.0);
        keep(&mut self.square_slope, 2.0 * v.dot(&d));
        keep(&mut self.square_curvature, 2.0 * (v.dot(&e) + d.norm_squared()));
    }
}

/// Bounds over granules of equal length and order.
pub(super) fn motion_bounds(granules: &[Vec<Vector3<f64>>], granule_ns: i64) -> MotionBounds {
    let degree = granules.iter().map(Vec::len).max().unwrap_or(1).saturating_sub(1).max(1);
    let count = SAMPLES * degree;
    let nodes: Vec<f64> = zeros(count).collect();
    let mut largest = Largest::default();
    for series in granules {
        for x in &nodes {
            largest.see(derivatives(series, *x));
        }
    }
    let over =
        |of: usize| ROUNDING / libm::cos(PI * f64_from_usize(of) / f64_from_usize(2 * count));
    let (once, twice) = (over(degree), over(2 * degree));
    // |v|^2 >= 1 - |Q - 1|; a fit that strayed by half its length would not have been accepted.
    let r = libm::sqrt((1.0 - largest.square * twice).max(0.25));
    let r1 = largest.square_slope * twice / (2.0 * r);
    let r2 = (largest.square_curvature * twice / 2.0 + r1 * r1) / r;
    let slope = largest.slope * once / r;
    let curvature = (largest.curvature * once + r2 + 2.0 * r1 * slope) / r;
    let per_second = 2e9 / f64_from_i64(granule_ns);
    MotionBounds {
        rate_rad_s: slope * per_second,
        acceleration_per_s2: curvature * per_second * per_second,
        max_abs_z: (largest.z * once / r).min(1.0),
    }
}
