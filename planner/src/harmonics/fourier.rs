//! Fourier transforms along a ring: from orders m to pixels, and back.
//!
//! `F(phi_j) = sum_m F_m exp(i m phi_j)`, m of both signs. Orders beyond half of the pixels fold onto
//! lower ones, as they do on the sky.
//!
//! Method: transforms of any length by the crate `rustfft`, planned once per length; its vector
//! instructions are not used, so that a map has the same bits on every machine.

use super::Complex64;
use super::circle::Circle;
use rustfft::{Fft, FftPlanner};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::{self, Debug, Formatter};
use std::sync::Arc;

/// To pixels, to orders.
type Plan = [Arc<dyn Fft<f64>>; 2];

/// Planned transforms by length.
pub(super) struct Fourier {
    plans: BTreeMap<usize, Plan>,
}

impl Debug for Fourier {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.debug_set().entries(self.plans.keys()).finish()
    }
}

/// `F_m` and `F_(-m)`; the second is zero for m = 0.
pub(super) type Orders = [Complex64; 2];

impl Fourier {
    pub(super) fn new(lengths: impl Iterator<Item = usize>) -> Self {
        let mut planner = FftPlanner::new();
        let mut plans = BTreeMap::new();
        for count in lengths {
            plans.entry(count).or_insert_with(|| {
                [planner.plan_fft_inverse(count), planner.plan_fft_forward(count)]
            });
        }
        Self { plans }
    }

    /// The pixels of a ring from its orders, m from 0 upwards.
    pub(super) fn pixels(
        &self,
        circle: &Circle,
        orders: impl Iterator<Item = Orders>,
    ) -> Vec<Complex64> {
        let count = circle.count;
        let mut values = vec![Complex64::ZERO; count];
        for (m, [plus, minus]) in orders.enumerate() {
            let turn = turn(circle, m);
            let bin = m % count;
            values[bin] += plus * turn;
            values[(count - bin) % count] += minus * turn.conj();
        }
        if let Some([to_pixels, _]) = self.plans.get(&count) {
            to_pixels.process(&mut values);
        }
        values
    }

    /// `sum_j F(phi_j) exp(-i m phi_j)` and the same of -m, m from 0 to `m_max`; the second is zero
    /// for m = 0.
    pub(super) fn orders(
        &self,
        circle: &Circle,
        pixels: &[Complex64],
        m_max: usize,
    ) -> Vec<Orders> {
        let count = circle.count;
        let mut values = pixels.to_vec();
        if let Some([_, to_orders]) = self.plans.get(&count) {
            to_orders.process(&mut values);
        }
        let order = |m: usize| {
            let turn = turn(circle, m);
            let bin = m % count;
            let minus = if m == 0 { Complex64::ZERO } else { values[(count - bin) % count] * turn };
            [values[bin] * turn.conj(), minus]
        };
        (0..=m_max).map(order).collect()
    }
}

/// `exp(i m phi_0)`, `phi_0` the longitude of the first pixel.
fn turn(circle: &Circle, m: usize) -> Complex64 {
    if !circle.shifted {
        return Complex64::ONE;
    }
    let number = |x: usize| f64::from(u32::try_from(x).unwrap_or(u32::MAX));
    let (sin, cos) = (PI * number(m % (2 * circle.count)) / number(circle.count)).sin_cos();
    Complex64::new(cos, sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_fold_and_come_back() {
        for (count, shifted) in [(4, true), (12, true), (28, false)] {
            let circle = Circle { sagitta: 0.5, count, shifted, first: 0, mirrored: None };
            let fourier = Fourier::new([count].into_iter());
            let orders: Vec<Orders> = (0..9_u8)
                .map(|m| {
                    let x = f64::from(m);
                    let minus = if m == 0 { 0.0 } else { 0.3 * x };
                    [Complex64::new(1.0 - x, 0.5), Complex64::new(minus, -minus)]
                })
                .collect();
            let pixels = fourier.pixels(&circle, orders.iter().copied());
            for (j, pixel) in (0_usize..).zip(&pixels) {
                let halves = 2 * j + usize::from(shifted);
                let number = |x: usize| f64::from(u32::try_from(x).unwrap());
                let expected: Complex64 = (0_usize..)
                    .zip(&orders)
                    .map(|(m, [plus, minus])| {
                        // m phi_j reduced as a whole number of half pixels: m phi as a product would
                        // be off by m phi 2^-53, 4e-13 of all orders.
                        let turned = number(m * halves % (2 * count)) / number(count);
                        let turn = Complex64::from_polar(1.0, PI * turned);
                        plus * turn + minus * turn.conj()
                    })
                    .sum();
                // Orders that add up to 45; a turn to 2e-15.
                assert!((pixel - expected).norm() < 1e-13);
            }
            if count > 16 {
                let back = fourier.orders(&circle, &pixels, 8);
                for (found, expected) in back.iter().zip(&orders) {
                    for (a, b) in found.iter().zip(expected) {
                        assert!((a / 28.0 - b).norm() < 1e-14);
                    }
                }
            }
        }
    }
}
