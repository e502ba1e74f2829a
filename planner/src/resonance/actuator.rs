//! How far rates, and so periods, stray from what was commanded.
//!
//! An [`Actuator`] per axis: an error that control leaves, the step in which a momentum wheel's speed
//! sets the rate, of which half is lost, and a drift that grows since the last correction. With
//! rates in rad/s and `t` since the correction,
//!
//! `d_omega(t) = error + step / 2 + drift t`, `T (1 - d) ... T / (1 - d)`, `d = d_omega / omega`.
//!
//! Limits: the larger of the two departures of the period is taken for both; errors add, they are
//! not taken for independent.

use super::motion::{Motion, Tolerance};
use std::f64::consts::TAU;

/// What one axis' rate is subject to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Largest error of the controlled rate, in rad/s.
    pub error_rad_s: f64,
    /// Step in which the rate can be set, in rad/s.
    pub step_rad_s: f64,
    /// Change of the rate's error with time, in rad/s^2.
    pub drift_rad_s2: f64,
}

impl Actuator {
    /// Largest error of the rate at a time after a correction.
    #[must_use]
    pub fn rate_error_rad_s(&self, since_s: f64) -> f64 {
        self.error_rad_s + 0.5 * self.step_rad_s + self.drift_rad_s2 * since_s
    }

    /// Largest departure of a period at a time after a correction, infinite where the rate may come
    /// to a stop.
    #[must_use]
    pub fn period_error_s(&self, period_s: f64, since_s: f64) -> f64 {
        let relative = self.rate_error_rad_s(since_s) * period_s.abs() / TAU;
        if relative < 1.0 { period_s.abs() * relative / (1.0 - relative) } else { f64::INFINITY }
    }

    /// The time after a correction at which a period has departed by `allowed_s`: zero if from the
    /// start, `None` if never.
    #[must_use]
    pub fn time_to(&self, period_s: f64, allowed_s: f64) -> Option<f64> {
        let relative = allowed_s / (period_s.abs() + allowed_s);
        let room = relative * TAU / period_s.abs() - self.rate_error_rad_s(0.0);
        if room < 0.0 {
            Some(0.0)
        } else if self.drift_rad_s2 > 0.0 {
            Some(room / self.drift_rad_s2)
        } else {
            None
        }
    }

    /// The periods within a range, ends included, that steps of the rate allow; none where there is
    /// no step.
    #[must_use]
    pub fn periods_s(&self, [shortest_s, longest_s]: [f64; 2]) -> Vec<f64> {
        if !(self.step_rad_s > 0.0 && 0.0 < shortest_s && shortest_s <= longest_s) {
            return Vec::new();
        }
        let turns = |period_s: f64| TAU / period_s / self.step_rad_s;
        let mut count = (turns(longest_s) * (1.0 - 1e-12)).ceil().max(1.0);
        let last = turns(shortest_s) * (1.0 + 1e-12);
        let mut periods = Vec::new();
        while count <= last && periods.len() < MOST_PERIODS {
            periods.push(TAU / (count * self.step_rad_s));
            count += 1.0;
        }
        periods.reverse();
        periods
    }
}

/// Periods that are listed at most.
pub const MOST_PERIODS: usize = 100_000;

/// The tolerance of both periods at a time after a correction of both rates.
#[must_use]
pub fn tolerance_after(
    motion: &Motion,
    precession: &Actuator,
    spin: &Actuator,
    since_s: f64,
) -> Tolerance {
    Tolerance {
        precession_s: precession.period_error_s(motion.precession_period_s, since_s),
        spin_s: spin.period_error_s(motion.spin_period_s, since_s),
    }
}

/// How long after a correction both periods stay within a tolerance that passes; `None` if for ever.
#[must_use]
pub fn time_within(
    motion: &Motion,
    precession: &Actuator,
    spin: &Actuator,
    free: Tolerance,
) -> Option<f64> {
    let times = [
        precession.time_to(motion.precession_period_s, free.precession_s),
        spin.time_to(motion.spin_period_s, free.spin_s),
    ];
    times.into_iter().flatten().min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEADY: Actuator = Actuator { error_rad_s: 0.0, step_rad_s: 0.0, drift_rad_s2: 0.0 };

    #[test]
    fn errors_grow_until_the_tolerance_is_left() {
        let motion = Motion::year(192.348 * 60.0, 1200.0);
        let spin = Actuator { error_rad_s: 1e-7, step_rad_s: 1e-8, drift_rad_s2: 1e-14 };
        let free = Tolerance { precession_s: 0.6, spin_s: 0.06 };
        let time = time_within(&motion, &STEADY, &spin, free).unwrap();
        let then = tolerance_after(&motion, &STEADY, &spin, time);
        assert!((then.spin_s - 0.06).abs() < 1e-9 && then.precession_s < 1e-12, "{then:?}");
        // 0.06 s of 1200 s is 5e-5 of 5.24e-3 rad/s.
        let expected = (TAU / 1200.0 * 0.06 / 1200.06 - 1.05e-7) / 1e-14;
        assert!((time / expected - 1.0).abs() < 1e-9);
        assert_eq!(time_within(&motion, &STEADY, &STEADY, free), None);
        let coarse = Actuator { error_rad_s: 1e-3, ..STEADY };
        assert_eq!(time_within(&motion, &STEADY, &coarse, free), Some(0.0));
        assert!(Actuator { error_rad_s: 1.0, ..STEADY }.period_error_s(1200.0, 0.0).is_infinite());
    }

    #[test]
    fn steps_of_the_rate_leave_some_periods() {
        let wheel = Actuator { step_rad_s: TAU / 1e6, ..STEADY };
        let periods = wheel.periods_s([11_500.0, 12_000.0]);
        assert!(periods.is_sorted() && periods.iter().all(|it| (11_500.0..=12_000.0).contains(it)));
        // 1e6 / 12,000 = 83.3 to 1e6 / 11,500 = 86.96.
        assert_eq!(periods.len(), 3);
        assert!((periods[0] - 1e6 / 86.0).abs() < 1e-6);
        assert!(wheel.periods_s([11_600.0, 11_601.0]).is_empty());
        assert!(STEADY.periods_s([1.0, 2.0]).is_empty());
    }
}
