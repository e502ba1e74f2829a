//! Integrals over theta of fields that are one order of longitude each.
//!
//! `sum over places of f d^l_(m,-s)(theta)`, a place of the northern half and its mirror image each with
//! its own f: what remains of an integral over the sphere where the longitude is done in closed form.
//!
//! Method: the recurrence of [`super::ladder`] on several places side by side.

use super::circle::Circle;
use super::ladder::Ladder;
use super::lanes::{self, Gathered, PAIRS};

/// A colatitude of the northern half, and what stands there and on its mirror image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// `1 - cos theta`.
    pub(crate) sagitta: f64,
    /// f there.
    pub(crate) north: f64,
    /// f on the mirror image.
    pub(crate) south: f64,
}

/// The sums by l from 0 to `l_max`.
pub(crate) fn zonal_sums([m, spin]: [usize; 2], l_max: usize, places: &[Place]) -> Vec<f64> {
    let ladder = Ladder::new(m, spin, l_max);
    let mut sums: Vec<Gathered> = vec![[[0.0; PAIRS]; 4]; ladder.steps.len()];
    for block in places.chunks(PAIRS) {
        let at = |pair: usize| block[pair.min(block.len() - 1)];
        let circles = std::array::from_fn(|pair| Circle {
            sagitta: at(pair).sagitta,
            count: 0,
            shifted: false,
            first: 0,
            mirrored: None,
        });
        let mut fields = [[0.0; PAIRS]; 8];
        for (pair, place) in block.iter().enumerate() {
            fields[0][pair] = place.north;
            fields[4][pair] = place.south;
        }
        lanes::to_degrees(&ladder, &circles, &fields, &mut sums);
    }
    let mut to = vec![0.0; ladder.start.min(l_max + 1)];
    to.extend(sums.iter().map(|sums| sums[0].iter().sum::<f64>()));
    to
}

#[cfg(test)]
mod tests {
    use super::super::wigner::wigner_d;
    use super::*;

    #[test]
    fn sums_are_those_of_the_functions() {
        let places: Vec<Place> = (1..=11_u8)
            .map(|i| {
                let x = f64::from(i);
                Place { sagitta: x / 11.0, north: x.sin(), south: x.cos() }
            })
            .collect();
        for ([m, spin], signed) in [([1, 2], [1, -2]), ([0, 2], [0, -2]), ([3, 0], [3, 0])] {
            let found = zonal_sums([m, spin], 40, &places);
            let mut expected = vec![0.0; 41];
            for place in &places {
                let theta = (1.0 - place.sagitta).acos();
                for (angle, f) in
                    [(theta, place.north), (std::f64::consts::PI - theta, place.south)]
                {
                    let row = wigner_d(signed[0], signed[1], angle, 40);
                    for (to, d) in expected.iter_mut().zip(row) {
                        *to += f * d;
                    }
                }
            }
            assert_eq!(found.len(), 41);
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-12, "{m} {spin} {a} {b}");
            }
        }
    }
}
