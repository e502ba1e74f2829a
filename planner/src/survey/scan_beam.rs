//! By how much does the direction of the sweep turn in the beam's frame.
//!
//! The scan-beam angle `zeta = atan2(v.x, v.y)`, v the velocity of the line of sight on the sky in the
//! detector's frame, orbital motion included. Its total amplitude is half of the range that it
//! covers over all precession and spin phases [Takase2024, section 5.3, whose "total amplitude"
//! is this half].
//!
//! Method: with the rates of orbit, precession and spin constant, zeta is a smooth function of the two
//! phases; a grid finds the neighbourhood of its extremes, ever finer grids the extremes.
//!
//! Limits: the orbit's rate is its mean. 1e-8 rad where the sweep does not come to rest.

use std::f64::consts::{PI, TAU};

/// Angles and rates of a scan, as far as the sweep's direction goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweeping {
    /// Angle from the anti-Sun axis to the spin axis in radians.
    pub alpha_rad: f64,
    /// Angle from the spin axis to the line of sight in radians.
    pub polar_rad: f64,
    /// Signed rate of the anti-Sun longitude in rad/s.
    pub orbit_rad_s: f64,
    /// Signed precession rate in rad/s.
    pub precession_rad_s: f64,
    /// Signed spin rate in rad/s.
    pub spin_rad_s: f64,
}

impl Sweeping {
    /// The scan-beam angle of a line of sight whose x axis points away from the spin axis, at a
    /// precession phase a and spin phase b, in (-pi, pi].
    #[must_use]
    pub fn angle_rad(&self, a: f64, b: f64) -> f64 {
        // Angular velocity in the spin frame turned back by b: the spin along z; the anti-Sun axis
        // R_y(-alpha) z; ecliptic north, which is x of the anti-Sun frame, R_y(-alpha) R_z(-a) x.
        let (sin_alpha, cos_alpha) = self.alpha_rad.sin_cos();
        let (sin_a, cos_a) = a.sin_cos();
        let (sin_b, cos_b) = b.sin_cos();
        let x = -self.precession_rad_s * sin_alpha + self.orbit_rad_s * cos_a * cos_alpha;
        let y = -self.orbit_rad_s * sin_a;
        let z = self.spin_rad_s
            + self.precession_rad_s * cos_alpha
            + self.orbit_rad_s * cos_a * sin_alpha;
        // Then about z by -b, and about y by -polar into the detector's frame.
        let outward = x * cos_b + y * sin_b;
        let across = -x * sin_b + y * cos_b;
        let (sin_polar, cos_polar) = self.polar_rad.sin_cos();
        let along_x = outward * cos_polar - z * sin_polar;
        // omega cross n has components omega . y along x and -omega . x along y.
        across.atan2(-along_x)
    }

    /// Half of the range of the scan-beam angle over all phases in radians.
    #[must_use]
    pub fn amplitude_rad(&self) -> f64 {
        // Counted from the sweep of the spin alone.
        let zero = if self.spin_rad_s * self.polar_rad.sin() < 0.0 { PI } else { 0.0 };
        let angle = |a: f64, b: f64| (self.angle_rad(a, b) - zero + 3.0 * PI).rem_euclid(TAU) - PI;
        let extreme = |sign: f64| sign * highest(|a, b| sign * angle(a, b));
        (extreme(1.0) - extreme(-1.0)) / 2.0
    }
}

/// Largest value of a function of two phases.
fn highest(f: impl Fn(f64, f64) -> f64) -> f64 {
    const ACROSS: i32 = 16;
    let mut centre = (0.0, 0.0);
    let mut half = PI;
    let mut best = f64::NEG_INFINITY;
    while half > 1e-4 {
        let (a0, b0) = centre;
        for i in -ACROSS..=ACROSS {
            for j in -ACROSS..=ACROSS {
                let at = |k: i32| half * f64::from(k) / f64::from(ACROSS);
                let (a, b) = (a0 + at(i), b0 + at(j));
                let value = f(a, b);
                if value > best {
                    best = value;
                    centre = (a, b);
                }
            }
        }
        half *= 4.0 / f64::from(ACROSS);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweeping(alpha_deg: f64, beta_deg: f64, precession_min: f64, spin_min: f64) -> Sweeping {
        Sweeping {
            alpha_rad: alpha_deg.to_radians(),
            polar_rad: beta_deg.to_radians(),
            orbit_rad_s: TAU / 31_557_600.0,
            precession_rad_s: TAU / (60.0 * precession_min),
            spin_rad_s: TAU / (60.0 * spin_min),
        }
    }

    #[test]
    fn amplitudes_of_the_paper() {
        let deg = |it: Sweeping| it.amplitude_rad().to_degrees();
        assert!((deg(sweeping(45.0, 50.0, 192.348, 20.0)) - 5.12).abs() < 0.005);
        assert!((deg(sweeping(45.0, 50.0, 192.348, 16.9)) - 4.37).abs() < 0.005);
        // Planck: fractions of an arcsecond, mostly the orbit.
        let planck = deg(sweeping(7.5, 85.0, 262_980.0, 1.0)) * 3600.0;
        assert!((0.28..0.50).contains(&planck), "{planck}");
    }

    #[test]
    fn extremes_are_those_of_a_dense_grid() {
        for it in [sweeping(45.0, 50.0, 192.348, 20.0), sweeping(7.5, 85.0, 262_980.0, 1.0)] {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..1000 {
                for j in 0..1000 {
                    let phase = |k: i32| TAU * f64::from(k) / 1000.0;
                    let angle = it.angle_rad(phase(i), phase(j));
                    low = low.min(angle);
                    high = high.max(angle);
                }
            }
            let dense = (high - low) / 2.0;
            let found = it.amplitude_rad();
            // A grid's extreme lies below the function's by at most its curvature over a step.
            assert!(found > dense - 1e-8 && found < dense * (1.0 + 2e-5), "{found} {dense}");
        }
    }

    #[test]
    fn without_precession_and_orbit_nothing_turns() {
        let mut still = sweeping(45.0, 50.0, 192.348, 20.0);
        still.orbit_rad_s = 0.0;
        still.precession_rad_s = 0.0;
        assert!(still.amplitude_rad().abs() < 1e-15);
        still.spin_rad_s = -still.spin_rad_s;
        assert!(still.amplitude_rad().abs() < 1e-15);
    }
}
