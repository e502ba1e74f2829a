//! When is a sample taken, and how far has each rotation turned by then.
//!
//! Sample j lies at exactly j / `f_s` after the mission's start. Rotations are the flight core's
//! [`Rotor`]s on a clock that ticks once per sample: their rates are turns per sample with 128
//! fractional bits, so phases are exact and the core's own functions give them, the sample's number
//! standing where nanoseconds do.
//!
//! Limits: 2^62 samples; precession and spin below half a turn per sample.

use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::time::{Duration, Instant};

/// The instants of samples, and the strategy on their clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct SampleClock {
    /// Instant of sample 0, where all rotors have their start phase.
    pub(super) start: Instant,
    /// Time between samples in 2^-64 ns, rounded up, so that whole multiples fall on their ns.
    pub(super) period: u128,
    /// Angle from the anti-Sun axis to the spin axis in radians.
    pub(super) alpha_rad: f64,
    /// Angle from the spin axis to the boresight in radians.
    pub(super) beta_rad: f64,
    /// Precession, turns per sample.
    pub(super) precession: Rotor,
    /// Spin, turns per sample.
    pub(super) spin: Rotor,
}

impl SampleClock {
    /// Time from the start to sample `j`, rounded down to ns.
    pub(super) fn elapsed(&self, j: u64) -> Duration {
        let whole = (self.period >> 64).wrapping_mul(u128::from(j));
        let rest = ((self.period & u128::from(u64::MAX)) * u128::from(j)) >> 64;
        Duration::from_ns(i64::try_from(whole + rest).unwrap_or(i64::MAX))
    }

    /// The instant of sample `j`, rounded down to ns.
    pub(super) fn instant(&self, j: u64) -> Instant {
        self.start.plus(self.elapsed(j))
    }

    /// The first sample at `elapsed` or later.
    pub(super) fn first_sample_at(&self, elapsed: Duration) -> u64 {
        let ns = u128::from(elapsed.ns().max(0).unsigned_abs());
        // j >= ns 2^64 / period, at most one off for the rounding of 2^-64 ns.
        let estimate = (ns << 64).div_ceil(self.period.max(1));
        u64::try_from(estimate).unwrap_or(u64::MAX)
    }

    /// Seconds between samples.
    #[expect(clippy::cast_precision_loss, reason = "53 digits are wanted")]
    pub(super) fn period_s(&self) -> f64 {
        self.period as f64 / 18_446_744_073_709_551_616.0 * 1e-9
    }
}

/// The angle of a rotor on the sample clock at sample `j`.
pub(super) fn phase_at(rotor: Rotor, j: u64) -> Phase {
    rotor.phase(Duration::from_ns(j.cast_signed()))
}

/// Twice the most that the rounding of a rate and of a start can be off, in 2^-64 turns.
const ROUNDING: u64 = 8;

/// The same for a half-wave plate: a phase that only rounding keeps from a whole turn is zero, since
/// half-integer multiples of it jump there.
pub(super) fn plate_phase_at(rotor: Rotor, j: u64) -> Phase {
    let phase = phase_at(rotor, j);
    if phase.bits() > u64::MAX - ROUNDING { Phase::ZERO } else { phase }
}

/// Radians per sample of a rate on the sample clock, in [-pi, pi).
pub(super) fn radians_per_sample(rate: TurnRate) -> f64 {
    rate.radians_per_second() * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_turn_that_rounding_misses_is_zero() {
        // 61 rpm at 19 Hz is 61/1140 turns per sample; floor(2^128 61/1140) is below it.
        let bits = u128::MAX / 1140 * 61 + u128::MAX % 1140 * 61 / 1140;
        let rotor = Rotor { rate: TurnRate::from_bits(bits), start: Phase::ZERO };
        assert_eq!(phase_at(rotor, 1140).bits(), u64::MAX);
        for turns in [1, 2, 1440, 1_000_000] {
            assert_eq!(plate_phase_at(rotor, 1140 * turns), Phase::ZERO);
        }
        assert_eq!(plate_phase_at(rotor, 7), phase_at(rotor, 7));
    }

    #[test]
    fn samples_and_instants_belong_together() {
        let rotor = Rotor { rate: TurnRate::from_bits(u128::MAX / 1000), start: Phase::ZERO };
        let clock = SampleClock {
            start: Instant::from_tai_ns(5),
            // 19 Hz.
            period: (1_000_000_000_u128 << 64).div_ceil(19),
            alpha_rad: 0.5,
            beta_rad: 0.5,
            precession: rotor,
            spin: rotor,
        };
        assert_eq!(clock.instant(19), Instant::from_tai_ns(1_000_000_005));
        assert_eq!(clock.elapsed(1), Duration::from_ns(52_631_578));
        for j in [0, 1, 19, 1_641_600, 1_800_000_000] {
            assert_eq!(clock.first_sample_at(clock.elapsed(j)), j);
            let after = clock.elapsed(j).ns() + 1;
            assert_eq!(clock.first_sample_at(Duration::from_ns(after)), j + 1);
        }
        assert!((clock.period_s() - 1.0 / 19.0).abs() < 1e-17);
    }
}
