//! Chebyshev series of vectors.
//!
//! A [`Transform`] samples at the zeros of `T_N`, `x_j = cos(pi (j + 1/2)/N)`, and gives the series
//! that interpolates there: `c_k = (2/N) sum_j f_j cos(k pi (j + 1/2)/N)`, the constant half of that.
//! Series are evaluated by Clenshaw's recurrence, with derivatives with respect to x in [-1, 1].

use crate::convert::f64_from_usize;
use core::f64::consts::PI;
use nalgebra::Vector3;

/// Nodes and cosines of one size.
#[derive(Debug, Clone)]
pub(crate) struct Transform {
    /// cos(k pi (j + 1/2)/N), k major.
    cosines: Vec<f64>,
    size: usize,
}

impl Transform {
    pub(crate) fn new(size: usize) -> Self {
        // cos(k pi (2 j + 1)/(2 N)) has the period 4 N in the product k (2 j + 1).
        let turn: Vec<f64> = (0..4 * size)
            .map(|m| libm::cos(PI * f64_from_usize(m) / f64_from_usize(2 * size)))
            .collect();
        let cosines = (0..size * size)
            .map(|at| turn[(at / size) * (2 * (at % size) + 1) % (4 * size)])
            .collect();
        Self { cosines, size }
    }

    /// The nodes, from 1 down to -1.
    pub(crate) fn nodes(&self) -> &[f64] {
        // T_1(x) = x.
        if self.size > 1 { &self.cosines[self.size..2 * self.size] } else { &[0.0] }
    }

    /// The series through the values at the nodes.
    pub(crate) fn series(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let scale = 2.0 / f64_from_usize(self.size);
        self.cosines
            .chunks_exact(self.size)
            .enumerate()
            .map(|(order, row)| {
                let sum: Vector3<f64> = row.iter().zip(values).map(|(c, v)| v * *c).sum();
                sum * if order == 0 { scale / 2.0 } else { scale }
            })
            .collect()
    }
}

/// The zeros of `T_N`, from 1 down to -1.
pub(crate) fn zeros(count: usize) -> impl Iterator<Item = f64> {
    let count_f64 = f64_from_usize(count);
    (0..count).map(move |j| libm::cos(PI * (f64_from_usize(j) + 0.5) / count_f64))
}

/// Value of a series at x.
pub(crate) fn value(series: &[Vector3<f64>], x: f64) -> Vector3<f64> {
    let (mut b1, mut b2) = (Vector3::zeros(), Vector3::zeros());
    for c in series.iter().skip(1).rev() {
        (b1, b2) = (c + b1 * (2.0 * x) - b2, b1);
    }
    series.first().map_or(b1, |c| c + b1 * x - b2)
}

/// Value, first and second derivative of a series at x.
pub(crate) fn derivatives(series: &[Vector3<f64>], x: f64) -> [Vector3<f64>; 3] {
    let zero = Vector3::zeros();
    let (mut b1, mut b2, mut d1, mut d2, mut e1, mut e2) = (zero, zero, zero, zero, zero, zero);
    for c in series.iter().skip(1).rev() {
        // Each recurrence is the derivative of the one below.
        (e1, e2) = (d1 * 4.0 + e1 * (2.0 * x) - e2, e1);
        (d1, d2) = (b1 * 2.0 + d1 * (2.0 * x) - d2, d1);
        (b1, b2) = (c + b1 * (2.0 * x) - b2, b1);
    }
    let first = series.first().copied().unwrap_or(zero);
    [first + b1 * x - b2, b1 + d1 * x - d2, d1 * 2.0 + e1 * x - e2]
}

/// Values of a series at -1 and 1.
pub(crate) fn ends(series: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let even: Vector3<f64> = series.iter().step_by(2).sum();
    let odd: Vector3<f64> = series.iter().skip(1).step_by(2).sum();
    (even - odd, even + odd)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exponential(x: f64) -> Vector3<f64> {
        Vector3::new(x.exp(), (2.0 * x).exp(), (-x).exp())
    }

    #[test]
    fn an_exponential_and_its_derivatives_come_back() {
        let transform = Transform::new(24);
        let values: Vec<_> = transform.nodes().iter().map(|x| exponential(*x)).collect();
        let series = transform.series(&values);
        for x in [-1.0, -0.3, 0.0, 0.77, 1.0] {
            let [v, d, e] = derivatives(&series, x);
            let f = exponential(x);
            assert!((v - f).norm() < 1e-14 && (value(&series, x) - f).norm() < 1e-14);
            assert!((d - f.component_mul(&Vector3::new(1.0, 2.0, -1.0))).norm() < 1e-11);
            assert!((e - f.component_mul(&Vector3::new(1.0, 4.0, 1.0))).norm() < 1e-9);
        }
        let (low, high) = ends(&series);
        assert!((low - exponential(-1.0)).norm() < 1e-14);
        assert!((high - exponential(1.0)).norm() < 1e-14);
    }
}
