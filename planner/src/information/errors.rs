//! How well are all parameters known together, and which cannot be told apart.
//!
//! Method: F is scaled to a unit diagonal, C = D F D with D = F_ii^(-1/2), and C taken apart into its
//! eigenvectors (nalgebra's symmetric QR). The error of a parameter with all others free is
//! `D_i sqrt((C^-1)_ii)`. A parameter that no datum depends on is left out. Directions whose eigenvalue is
//! below [`NULL`] of the largest are not measured: a parameter with more than [`PART`] of itself along them
//! has no error, for the others they are left out.
//!
//! Correlations are those of the errors, (C^-1)_ij / sqrt((C^-1)_ii (C^-1)_jj); pairs from [`STRONG`] on
//! are told, and so are the pairs that unmeasured directions join.
//!
//! Limits: errors that follow from F alone are the least possible ones; at a condition of 1e12 half of
//! their digits are lost.

use super::fisher::Fisher;
use super::parameter::{COUNT, Parameter};
use nalgebra::SMatrix;

/// Correlations from here on are told.
pub const STRONG: f64 = 0.9;
/// Eigenvalues of the scaled matrix below this share of the largest count as zero.
pub const NULL: f64 = 1e-13;
/// Squared part along unmeasured directions from which a parameter is unmeasured.
const PART: f64 = 1e-6;

/// Two parameters that are hard to tell apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Degeneracy {
    /// One.
    pub one: Parameter,
    /// The other.
    pub other: Parameter,
    /// Correlation of their errors; 1 or -1 where only a combination is measured.
    pub correlation: f64,
}

impl Degeneracy {
    /// What tells the two apart.
    #[must_use]
    pub const fn broken_by(&self) -> &'static str {
        use Parameter::{
            ECross, EPlus, Gain, OffsetX, OffsetY, PolarisationAngle, TimeConstant, Width,
        };
        match (self.one, self.other) {
            (OffsetX | OffsetY, TimeConstant) => {
                "passes in other directions through the beam, or at other speeds"
            }
            (TimeConstant, PolarisationAngle) => {
                "a plate that turns the other way or at another rate, or passes of a source that is not \
                 polarised"
            }
            (Gain, PolarisationAngle) => "passes at other crossing angles, or a half-wave plate",
            (Gain, Width | EPlus | ECross) | (Width | EPlus, EPlus | ECross) => {
                "passes at more distances from the beam's centre and in other directions"
            }
            _ => "passes at other impact parameters, directions and crossing angles",
        }
    }
}

/// The errors of all parameters with all others free.
#[derive(Debug, Clone, PartialEq)]
pub struct Errors {
    /// One standard deviation by row; `None` where the parameter is not measured.
    pub sigma: [Option<f64>; COUNT],
    /// The same with all others known.
    pub alone: [Option<f64>; COUNT],
    /// Correlations of the errors by row and column; `None` beside what no datum depends on, or between what
    /// is measured and what is not.
    pub correlation: [[Option<f64>; COUNT]; COUNT],
    /// Pairs that are hard to tell apart, the strongest first.
    pub degeneracies: Vec<Degeneracy>,
    /// Largest over smallest eigenvalue of the scaled matrix, of those above zero.
    pub condition: f64,
}

type Matrix = SMatrix<f64, COUNT, COUNT>;

impl Errors {
    /// The errors that follow from an information matrix.
    #[must_use]
    pub fn of(fisher: &Fisher) -> Self {
        let diagonal: [f64; COUNT] = std::array::from_fn(|i| fisher.at(i, i));
        let seen = diagonal.map(|it| it.is_finite() && it > 0.0);
        let scale: [f64; COUNT] =
            std::array::from_fn(|i| if seen[i] { 1.0 / diagonal[i].sqrt() } else { 0.0 });
        let alone = std::array::from_fn(|i| seen[i].then_some(scale[i]));
        let scaled = Matrix::from_fn(|i, j| fisher.at(i, j) * scale[i] * scale[j]);
        let eigen = scaled.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let mut inverse = Matrix::zeros();
        let mut unmeasured = Matrix::zeros();
        let mut smallest = largest;
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            let outer = vector * vector.transpose();
            if *value > NULL * largest {
                inverse += outer / *value;
                smallest = smallest.min(*value);
            } else {
                unmeasured += outer;
            }
        }
        let measured: [bool; COUNT] =
            std::array::from_fn(|i| seen[i] && unmeasured[(i, i)] <= PART);
        let sigma = std::array::from_fn(|i| {
            measured[i].then(|| scale[i] * inverse[(i, i)].max(0.0).sqrt())
        });
        let mut degeneracies = Vec::new();
        let mut correlation = [[None; COUNT]; COUNT];
        for i in (0..COUNT).filter(|&i| seen[i]) {
            correlation[i][i] = Some(1.0);
        }
        for (i, one) in Parameter::EACH.into_iter().enumerate() {
            for (j, other) in Parameter::EACH.into_iter().enumerate().skip(i + 1) {
                let of = if measured[i] && measured[j] { &inverse } else { &unmeasured };
                let size = (of[(i, i)] * of[(j, j)]).sqrt();
                if !(seen[i] && seen[j] && measured[i] == measured[j] && size > 0.0) {
                    continue;
                }
                let found = (of[(i, j)] / size).clamp(-1.0, 1.0);
                correlation[i][j] = Some(found);
                correlation[j][i] = Some(found);
                if found.abs() >= STRONG {
                    degeneracies.push(Degeneracy { one, other, correlation: found });
                }
            }
        }
        degeneracies.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
        let condition = if smallest > 0.0 { largest / smallest } else { f64::INFINITY };
        Self { sigma, alone, correlation, degeneracies, condition }
    }

    /// The error of a parameter with all others free; `None` where it is not measured.
    #[must_use]
    pub const fn of_parameter(&self, parameter: Parameter) -> Option<f64> {
        self.sigma[parameter.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::pass::{Crossing, Modulation, SIGMA_PER_FWHM};
    use super::super::signal_model::Model;
    use super::*;

    /// A tenth of a degree per second, or another speed, at an impact and an angle.
    fn crossing(speed: f64, impact: f64, zeta: f64) -> Crossing {
        Crossing {
            signal_k: 0.05,
            noise_k_rts: 3e-4,
            beam_sigma_rad: 0.3_f64.to_radians() * SIGMA_PER_FWHM,
            speed_rad_s: speed.to_radians(),
            impact_rad: impact.to_radians(),
            scan_beam_angle_rad: zeta.to_radians(),
            modulation: Modulation::default(),
        }
    }

    fn summed(passes: &[Crossing]) -> Fisher {
        let mut sum = Fisher::default();
        for it in passes {
            sum.add(&it.fisher());
        }
        sum
    }

    #[test]
    fn one_direction_does_not_tell_the_time_constant_from_the_offset() {
        let passes: Vec<Crossing> =
            [-0.15, -0.05, 0.0, 0.1, 0.2].map(|b| crossing(0.25, b, 0.0)).to_vec();
        let it = Errors::of(&summed(&passes));
        assert_eq!(it.of_parameter(Parameter::TimeConstant), None);
        assert_eq!(it.of_parameter(Parameter::OffsetY), None);
        assert!(it.of_parameter(Parameter::OffsetX).is_some());
        assert!(it.of_parameter(Parameter::Gain).is_some());
        let strongest = it.degeneracies[0];
        assert_eq!((strongest.one, strongest.other), (Parameter::OffsetY, Parameter::TimeConstant));
        assert!(strongest.correlation > 0.999_999);
        // A source without polarisation says nothing about the angle, and that is no degeneracy.
        assert_eq!(it.alone[Parameter::PolarisationAngle.index()], None);
        // Known otherwise, the time constant leaves the offset.
        assert!(it.alone[Parameter::OffsetY.index()].is_some());
    }

    #[test]
    fn another_direction_or_speed_breaks_it() {
        let mut passes: Vec<Crossing> =
            [-0.15, -0.05, 0.0, 0.1, 0.2].map(|b| crossing(0.25, b, 0.0)).to_vec();
        passes.push(crossing(0.25, 0.0, 180.0));
        let it = Errors::of(&summed(&passes));
        let offset = it.of_parameter(Parameter::OffsetY).unwrap();
        let delay = it.of_parameter(Parameter::TimeConstant).unwrap();
        // y - v tau and y + v tau are measured; tau is half their difference over v.
        assert!((offset / (delay * 0.25_f64.to_radians()) - 1.0).abs() < 1e-6);
        passes[5] = crossing(0.15, 0.0, 0.0);
        assert!(Errors::of(&summed(&passes)).of_parameter(Parameter::TimeConstant).is_some());
    }

    /// Normal deviates by `SplitMix64` and Box and Muller.
    struct Noise(u64);

    impl Noise {
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn normal(&mut self) -> f64 {
            let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
            radius * (std::f64::consts::TAU * self.uniform()).cos()
        }
    }

    /// A fit of one realisation by Gauss and Newton, with the derivatives at zero: their error is of second
    /// order, and steps go on until none is left.
    fn fitted(
        passes: &[Crossing],
        data: &[Vec<f64>],
        (times, step_s): (&[f64], f64),
        (derivatives, inverse): (&[Vec<[f64; COUNT]>], &Matrix),
    ) -> [f64; COUNT] {
        let mut p = [0.0; COUNT];
        for _ in 0..4 {
            let mut gradient = [0.0; COUNT];
            for ((pass, values), of) in passes.iter().zip(data).zip(derivatives) {
                let model = Model::of(pass);
                for ((&t, value), of) in times.iter().zip(values).zip(of) {
                    let left = value - model.signal(&p, t);
                    for (sum, derivative) in gradient.iter_mut().zip(of) {
                        *sum += derivative * left * step_s;
                    }
                }
            }
            let step = inverse * nalgebra::SVector::<f64, COUNT>::from(gradient);
            p.iter_mut().zip(step.iter()).for_each(|(p, step)| *p += step);
        }
        p
    }

    #[test]
    fn two_thousand_fits_scatter_as_told() {
        let plate = Modulation { fraction: 0.4, phase_rad: 0.3, rate_rad_s: -9.0 };
        let passes: Vec<Crossing> = [
            (0.25, 0.05, 0.0),
            (0.25, -0.1, 60.0),
            (0.2, 0.12, 150.0),
            (0.27, -0.03, -80.0),
            (0.22, 0.0, -150.0),
        ]
        .map(|(v, b, zeta)| Crossing { modulation: plate, ..crossing(v, b, zeta) })
        .to_vec();
        let told = Errors::of(&summed(&passes));
        // Samples over six times the beam's s on either side of closest approach.
        let step_s = 0.16;
        let times: Vec<f64> = (-22..=22).map(|n| f64::from(n) * step_s).collect();
        let derivatives: Vec<Vec<[f64; COUNT]>> = passes
            .iter()
            .map(|it| times.iter().map(|&t| Model::of(it).derivatives(t)).collect())
            .collect();
        let mut sampled = Fisher::default();
        for of in derivatives.iter().flatten() {
            sampled.add(&Fisher::from_fn(|i, j| of[i] * of[j] * step_s));
        }
        let inverse = Matrix::from_fn(|i, j| sampled.at(i, j)).try_inverse().unwrap();
        let exact: Vec<Vec<f64>> = passes
            .iter()
            .map(|it| times.iter().map(|&t| Model::of(it).signal(&[0.0; COUNT], t)).collect())
            .collect();
        let mut noise = Noise(17);
        let mut squares = [0.0; COUNT];
        let fits = 2000;
        for _ in 0..fits {
            let data: Vec<Vec<f64>> = exact
                .iter()
                .map(|it| it.iter().map(|s| s + noise.normal() / step_s.sqrt()).collect())
                .collect();
            let p = fitted(&passes, &data, (&times, step_s), (&derivatives, &inverse));
            squares.iter_mut().zip(p).for_each(|(sum, p)| *sum += p * p);
        }
        for (row, sum) in squares.into_iter().enumerate() {
            let found = (sum / f64::from(fits)).sqrt();
            let expected = told.sigma[row].unwrap();
            assert!((found / expected - 1.0).abs() < 0.05, "{row}: {found} is not {expected}");
        }
    }
}
