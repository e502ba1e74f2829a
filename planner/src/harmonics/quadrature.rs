//! Nodes and weights of Gauss and Legendre.
//!
//! Method: Newton's iteration on the polynomial, from the asymptotic places of its zeros.

use std::f64::consts::PI;

/// Nodes on 0 to 1, falling, with weights that sum to 1.
pub(crate) fn gauss_legendre(order: u32) -> Vec<(f64, f64)> {
    let node = |i: u32| {
        let mut x = (PI * (f64::from(i) + 0.75) / (f64::from(order) + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut below, mut now) = (1.0, x);
            for n in 1..order {
                let n = f64::from(n);
                (below, now) = (now, ((2.0 * n + 1.0) * x * now - n * below) / (n + 1.0));
            }
            slope = f64::from(order) * (x * now - below) / (x * x - 1.0);
            x -= now / slope;
        }
        (f64::midpoint(x, 1.0), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..order).map(node).collect()
}
