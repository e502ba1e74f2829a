//! The signal itself, for tests: its value at any parameters, derivatives by differences, quadrature.
//!
//! Nothing here shares a formula with the closed form but the definition of the signal.

use super::fisher::Fisher;
use super::parameter::COUNT;
use super::pass::Crossing;

/// Steps of the quadrature.
pub(super) const STEPS: u32 = 2400;

/// A pass as a signal of time.
pub(super) struct Model<'c> {
    it: &'c Crossing,
}

impl<'c> Model<'c> {
    pub(super) const fn of(it: &'c Crossing) -> Self {
        Self { it }
    }

    /// The signal over the noise at a time since closest approach: gain, offsets, ln width, e, tau, angle.
    pub(super) fn signal(&self, p: &[f64; COUNT], t_s: f64) -> f64 {
        let it = self.it;
        let t_s = t_s - p[6];
        let (sin, cos) = it.scan_beam_angle_rad.sin_cos();
        let run = it.speed_rad_s * t_s;
        let x = -it.impact_rad * cos - run * sin - p[1];
        let y = it.impact_rad * sin - run * cos - p[2];
        let width = (2.0 * p[3]).exp() * it.beam_sigma_rad * it.beam_sigma_rad;
        // u C^-1 u with C = width [[1 + e_plus, e_cross], [e_cross, 1 - e_plus]].
        let determinant = 1.0 - p[4] * p[4] - p[5] * p[5];
        let form = (x * x * (1.0 - p[4]) + y * y * (1.0 + p[4]) - 2.0 * x * y * p[5])
            / (width * determinant);
        let angle = it.modulation.phase_rad + it.modulation.rate_rad_s * t_s + 2.0 * p[7];
        let polarised = 1.0 + it.modulation.fraction * angle.cos();
        it.signal_k * p[0].exp() * (-0.5 * form).exp() * polarised / it.noise_k_rts
    }

    /// Derivatives at zero by differences of fourth order.
    pub(super) fn derivatives(&self, t_s: f64) -> [f64; COUNT] {
        let time = self.it.beam_sigma_rad / self.it.speed_rad_s;
        let length = self.it.beam_sigma_rad;
        let scales = [1.0, length, length, 1.0, 1.0, 1.0, time, 1.0];
        std::array::from_fn(|i| {
            let step = 2e-3 * scales[i] / if i >= 6 { 10.0 } else { 1.0 };
            let at = |times: f64| {
                let mut p = [0.0; COUNT];
                p[i] = times * step;
                self.signal(&p, t_s)
            };
            // Sixth order.
            ((at(3.0) - at(-3.0)) - 9.0 * (at(2.0) - at(-2.0)) + 45.0 * (at(1.0) - at(-1.0)))
                / (60.0 * step)
        })
    }

    /// The Fisher matrix by the trapezium rule, which is exact to rounding for such functions.
    pub(super) fn quadrature(&self, steps: u32) -> Fisher {
        let reach = 9.0 * self.it.beam_sigma_rad / self.it.speed_rad_s;
        let step = 2.0 * reach / f64::from(steps);
        let mut sum = Fisher::default();
        for index in 0..=steps {
            let at = f64::from(index) * step - reach;
            let of = self.derivatives(at);
            sum.add(&Fisher::from_fn(|i, j| of[i] * of[j] * step));
        }
        sum
    }
}
