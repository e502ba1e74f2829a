//! Instrumental polarisation on the dipole in closed form, in less than a millisecond.
//!
//! Where precession and spin do not beat, the samples of a place at colatitude theta are spread as the
//! scan's density has it, and `h_20 = -h(theta)`, `h = <exp(2i psi_pol)>`, depends on theta alone. The
//! residual of [`super::effects::HwpIp`] on a dipole is then `eps exp(i phi_QI) I h(theta)`, whose E and B
//! are one-dimensional integrals, m = 0 and +-1.
//!
//! Method: with `x1 < .. < x4` the sorted `cos(alpha + beta), cos(alpha - beta), -sin theta, sin theta`, h is the
//! mean of `T_2(cos chi) T_2(cos eps)` at `sn^2(v) = (x3 - x1)(u - x2) / ((x3 - x2)(u - x1))`, v evenly over a
//! quarter period; sn by descending Landen transformations from sines \[DLMF, 22.7(i)\]. The integrals over
//! theta are by Gauss and Legendre between the edges of the scan, graded towards them.
//!
//! Limits: no resonances (10 % in delta r at alpha = 70 deg) and no noise of few samples; both
//! forms of the effect alike. Places that are not seen are left out.

use crate::harmonics::quadrature::gauss_legendre;
use crate::harmonics::{Place, zonal_sums};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

/// Nodes of the mean over the scan's density.
const DENSITY_NODES: usize = 16;
/// Nodes between two edges of the scan, before those that degrees ask for.
const EDGE_NODES: f64 = 20.0;
/// Nodes for each half wave of the last degree.
const NODES_PER_WAVE: f64 = 1.9;
/// Nodes of one panel.
const PANEL_NODES: u32 = 24;
static PANEL: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
/// Edges nearer to each other are one, in radians.
const SAME_EDGE_RAD: f64 = 1e-9;

/// What leaks, and from where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DipoleLeak {
    /// Angle of the spin axis from the anti-Sun axis in radians.
    pub alpha_rad: f64,
    /// Angle of the line of sight from the spin axis in radians.
    pub beta_rad: f64,
    /// Amplitude of the effect.
    pub epsilon: f64,
    /// Its phase in radians.
    pub phi_qi_rad: f64,
    /// The dipole in ecliptic axes.
    pub dipole: [f64; 3],
}

/// `<exp(2i psi_pol)>` of the smooth scan at `z = cos(theta)`; `None` where nothing is seen.
#[must_use]
pub fn smooth_h2(alpha_rad: f64, beta_rad: f64, z: f64) -> Option<f64> {
    let s = ((1.0 - z) * (1.0 + z)).sqrt();
    let (low, high) = ((alpha_rad + beta_rad).cos(), (alpha_rad - beta_rad).cos());
    let (x2, x3) = (low.max(-s), high.min(s));
    let (x1, x4) = (low.min(-s), high.max(s));
    if x3 <= x2 || x4 <= x3 || x2 <= x1 {
        return None;
    }
    // k'^2 = (x2 - x1)(x4 - x3) / ((x4 - x2)(x3 - x1))
    let mut complement = ((x2 - x1) * (x4 - x3) / ((x4 - x2) * (x3 - x1))).sqrt();
    let mut moduli = [0.0; 10];
    let mut depth = 0;
    for modulus in &mut moduli {
        *modulus = (1.0 - complement) / (1.0 + complement);
        depth += 1;
        if *modulus < f64::EPSILON {
            break;
        }
        complement = 2.0 * complement.sqrt() / (1.0 + complement);
    }
    let sin_beta_inverse = beta_rad.sin().recip();
    let (cos_alpha, cos_beta) = (alpha_rad.cos(), beta_rad.cos());
    let mut sum = 0.0;
    for sine in SINES.get_or_init(sines) {
        let sn = moduli[..depth].iter().rev().fold(*sine, |t, k| (1.0 + k) * t / (1.0 + k * t * t));
        let q = sn * sn * (x3 - x2) / (x3 - x1);
        let u = (x2 - q * x1) / (1.0 - q);
        let across = ((1.0 - u) * (1.0 + u)).recip();
        // cos^2 chi, cos^2 eps
        let chi = ((cos_alpha - u * cos_beta) * sin_beta_inverse).powi(2) * across;
        let eps = (u * z / s).powi(2) * across;
        sum += (2.0 * chi - 1.0) * (2.0 * eps - 1.0);
    }
    Some(sum / DENSITY_NODES_F)
}

/// [`DENSITY_NODES`].
const DENSITY_NODES_F: f64 = 16.0;
static SINES: OnceLock<[f64; DENSITY_NODES]> = OnceLock::new();

/// `sin((i + 1/2) pi / (2 n))`.
fn sines() -> [f64; DENSITY_NODES] {
    let mut i = -0.5;
    std::array::from_fn(|_| {
        i += 1.0;
        (i * FRAC_PI_2 / DENSITY_NODES_F).sin()
    })
}

impl DipoleLeak {
    /// `C_l` of E and of B by l from 0 to `l_max`.
    #[must_use]
    pub fn spectra(&self, l_max: usize) -> [Vec<f64>; 2] {
        let mut across = Vec::new();
        let mut along = Vec::new();
        for (theta, weight) in self.nodes(l_max) {
            let (sin, cos) = theta.sin_cos();
            let Some(h) = smooth_h2(self.alpha_rad, self.beta_rad, cos) else { continue };
            let sagitta = sin * sin / (1.0 + cos);
            // d cos(theta) = sin(theta) d theta
            let weight = weight * sin * h;
            across.push(Place { sagitta, north: weight * sin, south: weight * sin });
            along.push(Place { sagitta, north: weight * cos, south: -weight * cos });
        }
        // int h sin(theta) d_(1,-2), int h cos(theta) d_(0,-2)
        let [j, k] = [zonal_sums([1, 2], l_max, &across), zonal_sums([0, 2], l_max, &along)];
        let [x, y, z] = self.dipole;
        let (across, along) = (x * x + y * y, z * z);
        let amplitude = 2.0 * PI * self.epsilon;
        let (sin, cos) = self.phi_qi_rad.sin_cos();
        let parts = [cos, sin].map(|part| (amplitude * part).powi(2));
        let mut to = [vec![0.0; l_max + 1], vec![0.0; l_max + 1]];
        for l in 2..=l_max {
            // (2 |a_l1|^2 + |a_l0|^2) / (2l + 1)
            let power = across * j[l] * j[l] / (8.0 * PI) + along * k[l] * k[l] / (4.0 * PI);
            // Even degrees are B where phi_QI = 0, odd ones E; even ones have no m = 0.
            let [with_cos, with_sin] = if l % 2 == 0 { [1, 0] } else { [0, 1] };
            to[with_cos][l] = power * parts[0];
            to[with_sin][l] = power * parts[1];
        }
        to
    }

    /// theta and weights over the northern half.
    fn nodes(&self, l_max: usize) -> Vec<(f64, f64)> {
        let edge = |angle: f64| angle.cos().abs().asin();
        let (sum, difference) = (self.alpha_rad + self.beta_rad, self.alpha_rad - self.beta_rad);
        let mut edges = [0.0, edge(sum), edge(difference), FRAC_PI_2];
        edges.sort_by(f64::total_cmp);
        let degrees = f64::from(u32::try_from(l_max).unwrap_or(u32::MAX));
        let mut nodes = Vec::new();
        for pair in edges.windows(2) {
            let (from, width) = (pair[0], pair[1] - pair[0]);
            if width < SAME_EDGE_RAD {
                continue;
            }
            let count = EDGE_NODES + NODES_PER_WAVE * width * degrees / PI;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "to 1e5")]
            let panels = (count / f64::from(PANEL_NODES)).ceil() as u32;
            let share = f64::from(panels).recip();
            for panel in 0..panels {
                let panel_nodes = PANEL.get_or_init(|| gauss_legendre(PANEL_NODES));
                nodes.extend(panel_nodes.iter().map(|(at, weight)| {
                    // Graded to the fifth power: t^3 (10 - 15 t + 6 t^2).
                    let t = share * (f64::from(panel) + at);
                    let graded = t * t * t * (10.0 - t * (15.0 - 6.0 * t));
                    let slope = 30.0 * (t * (1.0 - t)).powi(2);
                    (from + width * graded, width * slope * share * weight)
                }));
            }
        }
        nodes
    }
}

#[cfg(test)]
mod tests {
    use super::super::cmb::{CmbSpectra, TensorTilt};
    use super::super::likelihood::Likelihood;
    use super::*;

    const DIPOLE: [f64; 3] =
        [-3_263.780_426_630_218_2, 477.974_366_994_848_9, -650.274_685_624_615_6];

    fn leak(alpha_deg: f64, phi_qi_rad: f64) -> DipoleLeak {
        DipoleLeak {
            alpha_rad: alpha_deg.to_radians(),
            beta_rad: (95.0 - alpha_deg).to_radians(),
            epsilon: 1e-5,
            phi_qi_rad,
            dipole: DIPOLE,
        }
    }

    #[test]
    fn the_smooth_mean_is_that_of_another_program() {
        for (z, expected) in [
            (0.01, 0.048_202_804_325_811_255),
            (0.05, 0.092_733_879_657_909_88),
            (0.2, -0.038_557_995_136_793_394),
            (0.5, -0.264_904_727_231_950_1),
            (0.8, -0.373_884_810_807_785_1),
            (0.95, -0.411_318_209_207_633_84),
            (0.999, 0.030_052_762_274_345_78),
        ] {
            let [alpha, beta] = [45.0_f64, 50.0].map(f64::to_radians);
            let found = smooth_h2(alpha, beta, z).unwrap();
            assert!((found - expected).abs() < 1e-11, "{z} {found} {expected}");
            assert!((smooth_h2(alpha, beta, -z).unwrap() - found).abs() < 1e-15);
        }
        // A scan that does not reach the pole.
        assert_eq!(smooth_h2(0.3, 0.4, 0.99), None);
    }

    #[test]
    fn spectra_and_bias_are_those_of_another_program() {
        let spectra = CmbSpectra::embedded(TensorTilt::Scaleless).unwrap();
        let likelihood = Likelihood::new(&spectra.tensor_bb, &spectra.bb);
        for (alpha_deg, expected) in [
            (10.0, 0.002_034_788_627_706_253_8),
            (30.0, 0.001_050_764_664_059_160_6),
            (45.0, 0.000_479_897_356_182_959_34),
            (60.0, 0.000_174_759_833_006_966_6),
            (80.0, 1.678_588_048_185_503_5e-5),
        ] {
            let [_, bb] = leak(alpha_deg, 0.0).spectra(191);
            let found = likelihood.bias(&bb).unwrap().delta_r;
            assert!((found / expected - 1.0).abs() < 1e-8, "{alpha_deg}: {found} {expected}");
        }
        let [ee, bb] = leak(45.0, 0.0).spectra(191);
        for (found, expected) in [
            (bb[2], 1.539_021_888_112e-5),
            (bb[4], 7.360_308_696_758e-6),
            (bb[6], 4.014_675_223_416e-8),
            (bb[18], 3.162_568_206_197e-10),
            (ee[3], 2.284_883_669_623_270_4e-6),
            (ee[5], 6.705_984_398_087_595e-6),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected}");
        }
        assert!(bb[3].abs() < 1e-30 && ee[4].abs() < 1e-30);
        // A quarter turn of the phase turns E into B.
        let [turned_ee, turned_bb] = leak(45.0, FRAC_PI_2).spectra(191);
        assert!((turned_bb[5] / ee[5] - 1.0).abs() < 1e-12);
        assert!((turned_ee[2] / bb[2] - 1.0).abs() < 1e-12);
    }
}
