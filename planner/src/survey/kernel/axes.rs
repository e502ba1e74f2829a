//! The map's axes as the spinning spacecraft sees them, at several samples side by side.
//!
//! A line of sight and its crossing angle need only the map's x, y and z (its pole) in the
//! spacecraft's spin frame, turned back by precession and tilt; all detectors share them. The spin
//! itself stays a phase, to which each detector adds its azimuth.
//!
//! Method: `V_spin = R_y(-alpha) R_z(-a) V_antisun`, with the map's axes V in the anti-Sun frame
//! from the [`Arc`] of the Sun.

use super::arc::Arc;
use super::lanes::{madd, times};

/// The map's axes in the spin frame (spin phase left aside), and the spin phase, at `C` samples.
#[derive(Debug, Clone)]
pub(super) struct Axes<const C: usize> {
    /// Components of the map's x, y and z axes.
    pub(super) map: [[[f64; C]; 3]; 3],
    /// Cosine and sine of the spin phase.
    pub(super) spin: [[f64; C]; 2],
}

/// Angles turned by precession and spin at `C` offsets from a first sample: (cosines, sines).
#[derive(Debug, Clone)]
pub(super) struct Offsets<const C: usize> {
    /// Offsets in samples.
    pub(super) samples: [f64; C],
    pub(super) precession: [[f64; C]; 2],
    pub(super) spin: [[f64; C]; 2],
}

/// Where a block starts in its run.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlockStart {
    /// Samples from the run's first.
    pub(super) samples: f64,
    /// Cosine and sine of the precession and spin phases.
    pub(super) precession: (f64, f64),
    pub(super) spin: (f64, f64),
}

/// What does not change during a survey.
#[derive(Debug, Clone, Copy)]
pub(super) struct Geometry {
    /// Cosine and sine of alpha.
    pub(super) alpha: (f64, f64),
    /// The map's axes in the ecliptic; none where they are the ecliptic's.
    pub(super) map_axes: Option<[[f64; 3]; 3]>,
}

impl<const C: usize> Offsets<C> {
    pub(super) fn new(samples: [f64; C], precession_rate: f64, spin_rate: f64) -> Self {
        let turned =
            |rate: f64| [samples.map(|it| (rate * it).cos()), samples.map(|it| (rate * it).sin())];
        Self { samples, precession: turned(precession_rate), spin: turned(spin_rate) }
    }
}

impl<const C: usize> Axes<C> {
    pub(super) const fn zero() -> Self {
        Self { map: [[[0.0; C]; 3]; 3], spin: [[0.0; C]; 2] }
    }

    /// Sets the axes at `offsets` from a block's start.
    #[inline(always)]
    pub(super) fn set<const FUSED: bool>(
        &mut self,
        geometry: &Geometry,
        arc: &Arc,
        offsets: &Offsets<C>,
        start: &BlockStart,
    ) {
        let (cos_alpha, sin_alpha) = geometry.alpha;
        let (sin_l0, cos_l0) = arc.longitude;
        let (sin_b0, cos_b0) = arc.latitude;
        for i in 0..C {
            let phase = (offsets.spin[0][i], offsets.spin[1][i]);
            let (cos, sin) = times::<FUSED>(start.spin, phase);
            self.spin[0][i] = cos;
            self.spin[1][i] = sin;

            let phase = (offsets.precession[0][i], offsets.precession[1][i]);
            let (cos_a, sin_a) = times::<FUSED>(start.precession, phase);

            // The Sun's longitude and latitude a little off the arc's middle.
            let (dl, db) = arc.departure(start.samples + offsets.samples[i]);
            let near = |x: f64| {
                let s = x * x;
                (
                    madd::<FUSED>(s, madd::<FUSED>(s, 1.0 / 24.0, -0.5), 1.0),
                    x * madd::<FUSED>(s, madd::<FUSED>(s, 1.0 / 120.0, -1.0 / 6.0), 1.0),
                )
            };
            let (cos_l, sin_l) = times::<FUSED>((cos_l0, sin_l0), near(dl));
            let (cos_b, sin_b) = times::<FUSED>((cos_b0, sin_b0), near(db));

            // Ecliptic axes in the anti-Sun frame: rows of (x, y, z) with z towards the direction,
            // x north made perpendicular, y = z cross x.
            let ecliptic = [
                [-sin_b * cos_l, sin_l, cos_b * cos_l],
                [-sin_b * sin_l, -cos_l, cos_b * sin_l],
                [cos_b, 0.0, sin_b],
            ];
            for axis in 0..3 {
                let [x, y, z] = match &geometry.map_axes {
                    None => ecliptic[axis],
                    Some(map) => {
                        let g = map[axis];
                        let mut sum = [0.0; 3];
                        for c in 0..3 {
                            let first = g[0] * ecliptic[0][c];
                            let second = madd::<FUSED>(g[1], ecliptic[1][c], first);
                            sum[c] = madd::<FUSED>(g[2], ecliptic[2][c], second);
                        }
                        sum
                    }
                };
                let along = madd::<FUSED>(x, cos_a, y * sin_a);
                self.map[axis][0][i] = madd::<FUSED>(along, cos_alpha, -(z * sin_alpha));
                self.map[axis][1][i] = madd::<FUSED>(y, cos_a, -(x * sin_a));
                self.map[axis][2][i] = madd::<FUSED>(along, sin_alpha, z * cos_alpha);
            }
        }
    }
}
