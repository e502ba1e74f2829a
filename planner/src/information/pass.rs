//! What does one pass teach: its Fisher matrix in closed form.
//!
//! Frames: the detector's; z is the line of sight, v = (sin zeta, cos zeta) its direction of motion, and
//! the impact parameter b is positive along n = z x v = (-cos zeta, sin zeta), as in
//! [`impact_rad`](crate::worth::impact_rad). The source crosses the beam along w = (b n + x v) / s in units
//! of the Gaussian's s = FWHM / sqrt(8 ln 2), x = -v t / s.
//!
//! Method: with G = exp(-w^2 / 2) and a modulation 1 + f cos(theta), `theta = theta_c + rate t`, every
//! derivative is a polynomial in x times G times 1 + f cos(theta), or G times -2 f sin(theta) for the angle
//! of polarisation. Products are moments
//!
//! ```text
//! J_n(k) = int x^n exp(-x^2 + i k x) dx,  J_0 = sqrt(pi) exp(-k^2 / 4),  2 J_(n+1) = n J_(n-1) + i k J_n,
//! ```
//!
//! k = -rate s / v. The time constant delays the signal, ds/dtau = -ds/dt: it is -v times the offset along
//! the scan, and -rate / 2 times the angle of polarisation.
//!
//! Limits: a straight chord of a circular Gaussian at one speed, taken from end to end; a time constant that
//! is small against s / v and the period of the modulation. Quadrature agrees to 1e-9 of the larger
//! diagonal entries (`closed_form_is_the_quadrature`).

use super::fisher::Fisher;
use super::parameter::COUNT;
use nalgebra::Complex;
use std::f64::consts::PI;

/// Gaussian s over the full width at half maximum, 1 / sqrt(8 ln 2).
pub const SIGMA_PER_FWHM: f64 = 0.424_660_900_144_009_53;

/// How a polarised source's signal varies.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Modulation {
    /// Polarised over whole signal.
    pub fraction: f64,
    /// Phase theta at closest approach: 2 psi - 4 phi less twice the source's angle.
    pub phase_rad: f64,
    /// Its rate: -4 times the plate's, or 0.
    pub rate_rad_s: f64,
}

/// A pass of a source through a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The source's signal at the beam's centre in K.
    pub signal_k: f64,
    /// White noise in the same scale, K sqrt(s).
    pub noise_k_rts: f64,
    /// The Gaussian beam's s in radians.
    pub beam_sigma_rad: f64,
    /// Speed of the line of sight in rad/s.
    pub speed_rad_s: f64,
    /// Impact parameter in radians.
    pub impact_rad: f64,
    /// Scan-beam angle zeta in radians.
    pub scan_beam_angle_rad: f64,
    /// For a polarised source.
    pub modulation: Modulation,
}

/// Coefficients of 1, x, x^2.
type Polynomial = [f64; 3];

/// Derivatives that are polynomials: gain, both offsets, width, both ellipticities.
const SHAPES: usize = 6;

/// Weighted moments: of shapes with shapes, shapes with the angle, and the angle with itself.
struct Moments {
    shapes: [f64; 5],
    mixed: [f64; 3],
    angle: f64,
}

impl Crossing {
    /// The information on all parameters.
    #[must_use]
    pub fn fisher(&self) -> Fisher {
        let b = self.impact_rad / self.beam_sigma_rad;
        // K = A^2 exp(-b^2) (s / v) / sigma^2.
        let ratio = self.signal_k / self.noise_k_rts;
        let scale = ratio * ratio * (-b * b).exp() * self.beam_sigma_rad / self.speed_rad_s;
        let moments = self.moments();
        let shapes = self.shapes(b);
        // Rows of shapes and of the angle.
        let mut known = [[0.0; SHAPES + 1]; SHAPES + 1];
        for (i, one) in shapes.iter().enumerate() {
            for (j, other) in shapes.iter().enumerate().skip(i) {
                let entry = scale * product(one, other, &moments.shapes);
                known[i][j] = entry;
                known[j][i] = entry;
            }
            let mixed: f64 = one.iter().zip(&moments.mixed).map(|(a, m)| a * m).sum();
            known[i][SHAPES] = scale * mixed;
            known[SHAPES][i] = scale * mixed;
        }
        known[SHAPES][SHAPES] = scale * moments.angle;
        // ds/dtau = -v (sin zeta ds/dx0 + cos zeta ds/dy0) - (rate / 2) ds/dangle.
        let (sin, cos) = self.scan_beam_angle_rad.sin_cos();
        let along = [-self.speed_rad_s * sin, -self.speed_rad_s * cos];
        let turning = -0.5 * self.modulation.rate_rad_s;
        let delayed =
            |row: &[f64; SHAPES + 1]| along[0] * row[1] + along[1] * row[2] + turning * row[SHAPES];
        let with_delay: [f64; SHAPES + 1] = std::array::from_fn(|i| delayed(&known[i]));
        let delay = delayed(&with_delay);
        // The angle's row is the last, the time constant's the one before it.
        let place = |row: usize| if row == COUNT - 1 { SHAPES } else { row };
        Fisher::from_fn(|i, j| match (i == SHAPES, j == SHAPES) {
            (true, true) => delay,
            (true, false) => with_delay[place(j)],
            (false, true) => with_delay[place(i)],
            (false, false) => known[place(i)][place(j)],
        })
    }

    fn shapes(&self, b: f64) -> [Polynomial; SHAPES] {
        let (sin, cos) = self.scan_beam_angle_rad.sin_cos();
        let (sin2, cos2) = (2.0 * sin * cos, cos * cos - sin * sin);
        let s = self.beam_sigma_rad;
        [
            [1.0, 0.0, 0.0],
            // w_x / s and w_y / s.
            [-b * cos / s, sin / s, 0.0],
            [b * sin / s, cos / s, 0.0],
            // w^2.
            [b * b, 0.0, 1.0],
            // (w_x^2 - w_y^2) / 2 and w_x w_y.
            [0.5 * b * b * cos2, -b * sin2, -0.5 * cos2],
            [-0.5 * b * b * sin2, -b * cos2, 0.5 * sin2],
        ]
    }

    fn moments(&self) -> Moments {
        let Modulation { fraction: f, phase_rad, rate_rad_s } = self.modulation;
        let plain = gaussian_moments(0.0).map(|it| it.re);
        if f <= 0.0 {
            return Moments { shapes: plain, mixed: [0.0; 3], angle: 0.0 };
        }
        let k = -rate_rad_s * self.beam_sigma_rad / self.speed_rad_s;
        let turned = |times: f64| {
            let phase = Complex::from_polar(1.0, times * phase_rad);
            gaussian_moments(times * k).map(|it| it * phase)
        };
        let (once, twice) = (turned(1.0), turned(2.0));
        // (1 + f cos)^2 = 1 + f^2/2 + 2 f cos + (f^2/2) cos 2; -2 f sin (1 + f cos) = -2 f sin - f^2 sin 2;
        // (2 f sin)^2 = 2 f^2 (1 - cos 2).
        let half = 0.5 * f * f;
        Moments {
            shapes: std::array::from_fn(|n| {
                (1.0 + half) * plain[n] + 2.0 * f * once[n].re + half * twice[n].re
            }),
            mixed: std::array::from_fn(|n| -2.0 * f * once[n].im - f * f * twice[n].im),
            angle: 2.0 * f * f * (plain[0] - twice[0].re),
        }
    }
}

/// `J_0` to `J_4`.
fn gaussian_moments(k: f64) -> [Complex<f64>; 5] {
    let first = Complex::new(PI.sqrt() * (-0.25 * k * k).exp(), 0.0);
    let turn = Complex::new(0.0, 0.5 * k);
    let mut moments = [first, turn * first, first, first, first];
    for (n, below) in [(2, 0.5), (3, 1.0), (4, 1.5)] {
        moments[n] = turn * moments[n - 1] + below * moments[n - 2];
    }
    moments
}

fn product(one: &Polynomial, other: &Polynomial, moments: &[f64; 5]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in one.iter().enumerate() {
        for (j, b) in other.iter().enumerate() {
            sum += a * b * moments[i + j];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::signal_model::{Model, STEPS};
    use super::*;

    fn crossings() -> Vec<Crossing> {
        let plain = Crossing {
            signal_k: 0.05,
            noise_k_rts: 3e-4,
            beam_sigma_rad: (17.9_f64 / 60.0).to_radians() * SIGMA_PER_FWHM,
            speed_rad_s: 0.26_f64.to_radians(),
            impact_rad: 0.0,
            scan_beam_angle_rad: 0.0,
            modulation: Modulation::default(),
        };
        let slow = Modulation { fraction: 0.07, phase_rad: 0.7, rate_rad_s: 0.0 };
        let plate = Modulation { fraction: 0.9, phase_rad: -2.1, rate_rad_s: -4.0 * 6.39 };
        let lazy = Modulation { fraction: 1.0, phase_rad: 1.1, rate_rad_s: 3.0 };
        let mut all = Vec::new();
        for (impact, zeta) in [(0.0, 0.0), (1e-3, 0.4), (-3e-3, -2.9), (5e-3, 1.9)] {
            for modulation in [Modulation::default(), slow, plate, lazy] {
                all.push(Crossing {
                    impact_rad: impact,
                    scan_beam_angle_rad: zeta,
                    modulation,
                    ..plain
                });
            }
        }
        all
    }

    #[test]
    fn closed_form_is_the_quadrature() {
        for it in crossings() {
            let closed = it.fisher();
            let summed = Model::of(&it).quadrature(STEPS);
            for row in 0..COUNT {
                for column in row..COUNT {
                    let size = (summed.at(row, row) * summed.at(column, column)).sqrt();
                    let off = (closed.at(row, column) - summed.at(row, column)).abs();
                    assert!(
                        off <= 1e-9 * size,
                        "{it:?}: entry {row}, {column}: {} is not {}",
                        closed.at(row, column),
                        summed.at(row, column)
                    );
                }
            }
        }
    }

    #[test]
    fn a_pass_through_the_centre_teaches_the_gain_by_its_time_in_the_beam() {
        // F = (A / sigma)^2 sqrt(pi) s / v.
        let it = crossings()[0];
        let time = PI.sqrt() * it.beam_sigma_rad / it.speed_rad_s;
        let expected = (it.signal_k / it.noise_k_rts).powi(2) * time;
        assert!((it.fisher().at(0, 0) / expected - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_time_constant_is_the_offset_along_the_scan() {
        // zeta = 0: along y. A matrix of one pass is singular in exactly this direction.
        let (it, y, tau) = (crossings()[0], 2, 6);
        let fisher = it.fisher();
        for row in 0..COUNT {
            let expected = -it.speed_rad_s * fisher.at(row, y);
            assert!((fisher.at(row, tau) - expected).abs() <= 1e-12 * expected.abs());
        }
    }
}
