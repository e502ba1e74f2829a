//! What one detector looks at, at several samples side by side: place on the map, crossing angle.
//!
//! Crossing angle psi = atan2(north, east) of the detector's x axis. With N the map's pole, e and f
//! the detector's x and y axes, `sin(theta) (cos psi, sin psi) = (N . f, N . e)`: no longitude and
//! no trigonometric function is needed.
//!
//! Limits: at a pole of the map psi is 0 where the sine of the colatitude underflows.

use super::axes::Axes;
use super::lanes::{madd, quarter_turns, times};
use crate::survey::mount::Mount;

/// Places and crossing angles of one detector at `C` samples.
#[derive(Debug, Clone)]
pub(super) struct Sights<const C: usize> {
    /// Cosine of the colatitude.
    pub(super) z: [f64; C],
    /// Sine of the colatitude.
    pub(super) sin_theta: [f64; C],
    /// Longitude in quarter turns, in [0, 4).
    pub(super) quarters: [f64; C],
    /// Cosine and sine of the crossing angle.
    pub(super) psi: [[f64; C]; 2],
}

impl<const C: usize> Sights<C> {
    pub(super) const fn zero() -> Self {
        let zero = [0.0; C];
        Self { z: zero, sin_theta: zero, quarters: zero, psi: [zero; 2] }
    }

    /// Sets what `mount` looks at; the crossing angle only where `PSI`.
    #[inline(always)]
    pub(super) fn set<const FUSED: bool, const PSI: bool>(
        &mut self,
        axes: &Axes<C>,
        mount: &Mount,
    ) {
        let (cos_polar, sin_polar) = mount.polar;
        for i in 0..C {
            let (cos, sin) = times::<FUSED>(mount.azimuth, (axes.spin[0][i], axes.spin[1][i]));
            // A map axis on the line of sight (sin polar cos, sin polar sin, cos polar).
            let outward =
                |axis: usize| madd::<FUSED>(axes.map[axis][0][i], cos, axes.map[axis][1][i] * sin);
            let along = |axis: usize| {
                madd::<FUSED>(outward(axis), sin_polar, axes.map[axis][2][i] * cos_polar)
            };
            let (x, y) = (along(0), along(1));
            self.z[i] = along(2);
            let rho2 = madd::<FUSED>(x, x, y * y);
            let sin_theta = rho2.sqrt();
            self.sin_theta[i] = sin_theta;
            self.quarters[i] = quarter_turns::<FUSED>(x, y);
            if PSI {
                let north = madd::<FUSED>(outward(2), cos_polar, -(axes.map[2][2][i] * sin_polar));
                let east = madd::<FUSED>(axes.map[2][1][i], cos, -(axes.map[2][0][i] * sin));
                // Its own norm keeps (cos, sin) on the circle near a pole.
                let norm2 = madd::<FUSED>(north, north, east * east);
                let per_norm = 1.0 / norm2.sqrt();
                let (c, s) =
                    if norm2 > 0.0 { (east * per_norm, north * per_norm) } else { (1.0, 0.0) };
                let (c, s) = times::<FUSED>((c, s), mount.turn);
                self.psi[0][i] = c;
                self.psi[1][i] = s;
            }
        }
    }
}
