//! Phasors of multiples of the crossing angle.
//!
//! `exp(i n psi)` for whole n are powers of `exp(i psi)`; for half-integers they take the root whose
//! angle is psi / 2 with psi in (-pi, pi].

use super::lanes::times;
use crate::survey::moment::Moment;

/// Complex values at `C` samples: real, imaginary.
pub(super) type Values<const C: usize> = [[f64; C]; 2];

/// Which multiples a survey needs, and which of them each moment takes.
#[derive(Debug, Clone)]
pub(super) struct Multiples {
    /// Twice |n|, each once, ascending.
    pub(super) twice: Vec<u32>,
    /// Per moment: index of its multiple, and whether n is positive (the phasor is conjugated).
    pub(super) of_moment: Vec<(usize, bool)>,
}

impl Multiples {
    pub(super) fn new(moments: &[Moment]) -> Self {
        let mut twice: Vec<u32> = moments.iter().map(|it| it.twice_n().unsigned_abs()).collect();
        twice.sort_unstable();
        twice.dedup();
        let of_moment = moments
            .iter()
            .map(|it| {
                let index = twice.binary_search(&it.twice_n().unsigned_abs()).unwrap_or(0);
                (index, it.twice_n() > 0)
            })
            .collect();
        Self { twice, of_moment }
    }

    /// Sets `out` to `exp(i |n| psi)` for each multiple.
    #[inline(always)]
    pub(super) fn set<const FUSED: bool, const C: usize>(
        &self,
        psi: &Values<C>,
        out: &mut [Values<C>],
    ) {
        let mut power: Values<C> = [[1.0; C], [0.0; C]];
        let mut exponent = 0;
        for (twice, values) in self.twice.iter().zip(out) {
            while exponent < twice / 2 {
                multiply::<FUSED, C>(&mut power, psi);
                exponent += 1;
            }
            *values = power;
            if twice % 2 == 1 {
                multiply::<FUSED, C>(values, &half_angle(psi));
            }
        }
    }
}

#[inline(always)]
fn multiply<const FUSED: bool, const C: usize>(a: &mut Values<C>, b: &Values<C>) {
    for i in 0..C {
        let (re, im) = times::<FUSED>((a[0][i], a[1][i]), (b[0][i], b[1][i]));
        a[0][i] = re;
        a[1][i] = im;
    }
}

/// `exp(i psi / 2)`, psi in (-pi, pi].
#[inline(always)]
fn half_angle<const C: usize>(psi: &Values<C>) -> Values<C> {
    let mut half = [[0.0; C]; 2];
    for i in 0..C {
        let (c, s) = (psi[0][i], psi[1][i]);
        // The larger of the two by a root, the other from sin psi = 2 sin cos.
        let large = (0.5 * (1.0 + c.abs())).sqrt();
        let small = 0.5 * s.abs() / large;
        let (cos, sin) = if c >= 0.0 { (large, small) } else { (small, large) };
        half[0][i] = cos;
        half[1][i] = if s < 0.0 { -sin } else { sin };
    }
    half
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn multiples_are_those_of_the_angle(angle in -3.1..3.1_f64) {
            let moments: Vec<Moment> =
                [(4.0, 0.0), (-0.5, 0.0), (2.5, 1.0), (0.0, 4.0), (-4.0, 2.0), (9.0, 0.0)]
                    .map(|(n, m)| Moment::new(n, m).unwrap())
                    .to_vec();
            let multiples = Multiples::new(&moments);
            let mut out = vec![[[0.0; 1]; 2]; multiples.twice.len()];
            multiples.set::<false, 1>(&[[angle.cos()], [angle.sin()]], &mut out);
            for (moment, (index, conjugate)) in moments.iter().zip(&multiples.of_moment) {
                let (sin, cos) = (moment.n().abs() * angle).sin_cos();
                prop_assert!((out[*index][0][0] - cos).abs() < 1e-14);
                prop_assert!((out[*index][1][0] - sin).abs() < 1e-14);
                prop_assert_eq!(*conjugate, moment.n() > 0.0);
            }
        }
    }
}
