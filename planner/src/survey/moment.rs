//! The averages that a survey collects: spin-(n, m) orientation functions.
//!
//! `h_nm = (1/N) sum exp(-i (n psi + m phi))` over the N samples of a pixel, psi the crossing angle in
//! (-pi, pi], phi the half-wave plate's angle in [0, 2 pi); n and m whole or half-integer
//! [Takase2024, section 3.1].

use thiserror::Error;

/// A spin-(n, m) orientation function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Moment {
    twice_n: i32,
    twice_m: i32,
}

/// Most moments of a survey; its maps do not have those beyond.
pub const MOST_MOMENTS: usize = 64;
/// Largest |n| and |m|.
pub const MAX_ORDER: i32 = 64;

/// Not a moment.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("{0}: a whole number or a half between -{MAX_ORDER} and {MAX_ORDER} is needed")]
pub struct MomentError(pub f64);

impl Moment {
    /// The moment of n and m.
    ///
    /// # Errors
    /// [`MomentError`] where one is neither whole nor half-integer, or too large.
    pub fn new(n: f64, m: f64) -> Result<Self, MomentError> {
        let twice = |x: f64| {
            let doubled = 2.0 * x;
            if doubled.fract() == 0.0 && x.abs() <= f64::from(MAX_ORDER) {
                #[expect(clippy::cast_possible_truncation, reason = "a whole number up to 128")]
                Ok(doubled as i32)
            } else {
                Err(MomentError(x))
            }
        };
        Ok(Self { twice_n: twice(n)?, twice_m: twice(m)? })
    }

    /// n.
    #[must_use]
    pub fn n(self) -> f64 {
        f64::from(self.twice_n) / 2.0
    }

    /// m.
    #[must_use]
    pub fn m(self) -> f64 {
        f64::from(self.twice_m) / 2.0
    }

    /// Whether the plate's angle enters.
    #[must_use]
    pub const fn needs_plate(self) -> bool {
        self.twice_m != 0
    }

    pub(super) const fn twice_n(self) -> i32 {
        self.twice_n
    }

    pub(super) const fn twice_m(self) -> i32 {
        self.twice_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_whole_or_half() {
        let it = Moment::new(-2.5, 4.0).unwrap();
        assert_eq!((it.twice_n(), it.twice_m()), (-5, 8));
        for bad in [0.25, 64.5, f64::NAN, f64::INFINITY] {
            assert!(Moment::new(bad, 0.0).is_err());
            assert!(Moment::new(0.0, bad).is_err());
        }
    }
}
