//! The recurrence of Wigner functions in l for one order m and one spin s, and where it begins.
//!
//! Two functions climb side by side, `d^l_(m,-s)` and `d^l_(m,s)`: the one on a ring of the northern
//! half is, but for the sign `(-1)^(l + m)`, the other on its mirror image.
//!
//! Method: with `S_l = sqrt((l^2 - m^2)(l^2 - s^2)) / l`,
//! `S_(l+1) d^(l+1) = (2l + 1) [cos theta -+ m s / (l (l + 1))] d^l - S_l d^(l-1)`, upper sign for
//! `d_(m,s)`. First values, with h and k the larger and smaller of m and s, are
//! `sqrt(C(2h, h + k)) (sin theta / 2)^(h - k)` times `cos^2k` or `sin^2k` of half the angle.
//!
//! Limits: first values to 1e-16 times their degree, by repeated squaring; below 1e-77 they carry a
//! scale.

use super::circle::Circle;
use super::wigner::{LARGE, Scaled, UNIT};

/// Factors of one step upwards: of the cosine, of the constant, of the degree below.
pub(super) type Step = [f64; 3];

/// The steps of an order and spin.
#[derive(Debug, Clone)]
pub(super) struct Ladder {
    /// The lowest degree, the larger of m and s.
    pub(super) start: usize,
    /// From the lowest degree to `l_max`.
    pub(super) steps: Vec<Step>,
    m: usize,
    spin: usize,
    /// `sqrt(C(2h, h + k)) 2^(k - h)`.
    first: f64,
}

impl Ladder {
    pub(super) fn new(m: usize, spin: usize, l_max: usize) -> Self {
        let start = m.max(spin);
        let (mm, ss) = (number(m).powi(2), number(spin).powi(2));
        let product = number(m) * number(spin);
        let mut l = number(start);
        let mut below = 0.0;
        let mut step = || {
            let next = l + 1.0;
            let size = ((next * next - mm) * (next * next - ss)).sqrt() / next;
            let slope = (2.0 * l + 1.0) / size;
            let coupling = if product > 0.0 { product / (l * next) } else { 0.0 };
            let step = [slope, slope * coupling, below / size];
            (l, below) = (next, size);
            step
        };
        let steps = (start..=l_max).map(|_| step()).collect();
        Self { start, steps, m, spin, first: first_factor(start, m.min(spin)) }
    }

    /// `d_(m,-s)` and `d_(m,s)` at the lowest degree.
    pub(super) fn first(&self, circle: &Circle) -> [Scaled; 2] {
        let (high, low) = (self.start, self.m.min(self.spin));
        let common = power(circle.sin(), high - low);
        let half =
            [circle.sagitta / 2.0, 1.0 - circle.sagitta / 2.0].map(|square| power(square, low));
        let odd = (high + low) % 2 != 0;
        let negative = [odd, odd && self.m >= self.spin];
        [0, 1].map(|which| {
            let x = self.first * common.x * half[which].x;
            let scaled = Scaled {
                x: if negative[which] { -x } else { x },
                units: common.units + half[which].units,
            };
            settled(scaled)
        })
    }

    /// Whether l + m is even at the lowest degree.
    pub(super) const fn is_even(&self) -> bool {
        (self.start + self.m).is_multiple_of(2)
    }

    /// Whether a ring has anything of the order at degrees up to `l_max` \[Reinecke2013, section 3.2\].
    pub(super) fn reaches(&self, circle: &Circle, l_max: usize) -> bool {
        let (m, s, l) = (number(self.m), number(self.spin), number(l_max));
        let room = l * circle.sin() + (0.01 * l).max(100.0);
        // m^2 - 2 m s |cos theta| + s^2 <= room^2
        m * m - 2.0 * m * s * circle.cos() + s * s <= room * room
    }
}

/// `sqrt(C(2h, h + k)) 2^(k - h)`.
fn first_factor(high: usize, low: usize) -> f64 {
    // C(2h, h) / 4^h
    let central: f64 = (1..=high).map(|j| (2.0 * number(j) - 1.0) / (2.0 * number(j))).product();
    let shifted: f64 =
        (1..=low).map(|j| (number(high) - number(j) + 1.0) / (number(high) + number(j))).product();
    let twos = i32::try_from(low).unwrap_or(i32::MAX);
    (central * shifted).sqrt() * 2.0_f64.powi(twos)
}

/// A power of a number between 0 and 1.
fn power(base: f64, exponent: usize) -> Scaled {
    let mut square = Scaled { x: base, units: 0 };
    let mut to = Scaled { x: 1.0, units: 0 };
    let mut left = exponent;
    while left > 0 {
        if left % 2 == 1 {
            to = settled(Scaled { x: to.x * square.x, units: to.units + square.units });
        }
        square = settled(Scaled { x: square.x * square.x, units: 2 * square.units });
        left /= 2;
    }
    to
}

/// The same value with its factor between 2^-256 and 2^256.
fn settled(mut value: Scaled) -> Scaled {
    while value.x.abs() < LARGE.recip() && value.x.abs() > 0.0 {
        value.x /= UNIT;
        value.units += 1;
    }
    while value.x.abs() > LARGE && value.units > 0 {
        value.x *= UNIT;
        value.units -= 1;
    }
    value
}

pub(super) fn number(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::super::wigner::first_value;
    use super::*;

    #[test]
    fn first_values_are_those_of_the_logarithms() {
        for (m, spin, sagitta) in [
            (0, 0, 0.3),
            (3, 0, 1.0),
            (0, 3, 0.2),
            (1, 2, 0.4),
            (2, 2, 0.9),
            (40, 3, 1e-4),
            (700, 2, 1e-3),
        ] {
            let circle = Circle { sagitta, count: 4, shifted: false, first: 0, mirrored: None };
            let theta = circle.sin().atan2(circle.cos());
            let found = Ladder::new(m, spin, 800).first(&circle);
            for (found, sign) in found.into_iter().zip([-1, 1]) {
                let [m, s] = [m, spin].map(|it| i32::try_from(it).unwrap());
                let expected = first_value(m, sign * s, theta);
                let units = f64::from(found.units) - f64::from(expected.units);
                let ratio = found.x / expected.x * (-512.0 * units).exp2();
                assert!((ratio - 1.0).abs() < 1e-11, "{m} {s} {sagitta}: {found:?} {expected:?}");
            }
        }
    }
}
