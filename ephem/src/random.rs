//! Random numbers that are the same in every run.
//!
//! Method: splitmix64 \[Steele2014\]; a seed names the whole sequence.
//!
//! Limits: for the choice of samples, not for secrets.
//!
//! # Example
//! ```
//! use ephem::random::SplitMix64;
//!
//! let mut random = SplitMix64(2032);
//! let (share, index) = (random.unit(), random.up_to(9));
//! assert!((0.0..1.0).contains(&share) && (0..=9).contains(&index));
//! // The same seed gives the same numbers.
//! assert_eq!(SplitMix64(2032).unit().to_bits(), share.to_bits());
//! ```

use crate::convert::f64_from_u64;

/// The generator splitmix64, from its seed.
#[derive(Debug, Clone)]
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// The next 64 bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        f64_from_u64(self.bits() >> 11) / f64_from_u64(1 << 53)
    }

    /// A number in 0 to `last`, within 2^-64 of evenly; 0 for a negative `last`.
    pub fn up_to(&mut self, last: i64) -> i64 {
        let count = u128::from(u64::try_from(last).unwrap_or(0)) + 1;
        i64::try_from((u128::from(self.bits()) * count) >> 64).unwrap_or(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_gives_its_published_numbers() {
        let mut random = SplitMix64(1_234_567);
        assert_eq!(random.bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn bounded_numbers_reach_both_ends() {
        let mut random = SplitMix64(1);
        let drawn: Vec<i64> = (0..200).map(|_| random.up_to(4)).collect();
        assert_eq!((drawn.iter().min(), drawn.iter().max()), (Some(&0), Some(&4)));
        assert_eq!(random.up_to(-3), 0);
    }
}
