//! How a sequencer behaves.

use super::check::MAX_STEPS_PER_TICK;
use crate::time::Duration;

/// How a sequencer behaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Index of its telescope in the mission section.
    pub telescope: u16,
    /// How far predicted and planned first entry and last exit may differ, and how uncertain the
    /// predicted ones may be.
    pub tolerance: Duration,
    /// How far predicted and planned number of passes may differ.
    pub passes_tolerance: u16,
    /// Longest time between two ticks, and latest start of a session after its planned one.
    pub longest_gap: Duration,
    /// How long before its start a session is checked.
    pub check_ahead: Duration,
    /// Angle in radians: where the strategy's change turns the attitude predicted for a session's
    /// start or end by more than this, the session is checked again.
    pub recheck_rad: f64,
    /// Search steps per tick, 1 to [`MAX_STEPS_PER_TICK`].
    pub steps_per_tick: u16,
}

/// Which setting is illegal.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SettingsError {
    /// The tolerance is negative.
    Tolerance(Duration),
    /// The longest gap is not above zero.
    LongestGap(Duration),
    /// Sessions are checked less than the longest gap ahead.
    CheckAhead(Duration),
    /// The angle (radians) of a new check is not above zero and finite.
    Recheck(f64),
    /// The steps per tick are zero or too many.
    StepsPerTick(u16),
}

impl Settings {
    /// Whether all are legal.
    ///
    /// # Errors
    /// [`SettingsError`] names the first that is not.
    pub(super) const fn check(&self) -> Result<(), SettingsError> {
        if self.tolerance.ns() < 0 {
            return Err(SettingsError::Tolerance(self.tolerance));
        }
        if self.longest_gap.ns() <= 0 {
            return Err(SettingsError::LongestGap(self.longest_gap));
        }
        if self.check_ahead.ns() < self.longest_gap.ns() {
            return Err(SettingsError::CheckAhead(self.check_ahead));
        }
        if !(self.recheck_rad > 0.0 && self.recheck_rad < f64::INFINITY) {
            return Err(SettingsError::Recheck(self.recheck_rad));
        }
        if self.steps_per_tick == 0 || self.steps_per_tick > MAX_STEPS_PER_TICK {
            return Err(SettingsError::StepsPerTick(self.steps_per_tick));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::trial::SETTINGS;
    use super::*;

    #[test]
    fn settings_out_of_range_are_named() {
        let with = |settings: Settings| settings.check();
        assert_eq!(with(SETTINGS), Ok(()));
        let (zero, back) = (Duration::ZERO, Duration::from_ns(-1));
        assert_eq!(with(Settings { tolerance: zero, ..SETTINGS }), Ok(()));
        let tolerance = with(Settings { tolerance: back, ..SETTINGS });
        assert_eq!(tolerance, Err(SettingsError::Tolerance(back)));
        let gap = with(Settings { longest_gap: zero, ..SETTINGS });
        assert_eq!(gap, Err(SettingsError::LongestGap(zero)));
        let least = SETTINGS.longest_gap;
        assert_eq!(with(Settings { check_ahead: least, ..SETTINGS }), Ok(()));
        let shorter = Duration::from_ns(least.ns() - 1);
        let ahead = with(Settings { check_ahead: shorter, ..SETTINGS });
        assert_eq!(ahead, Err(SettingsError::CheckAhead(shorter)));
        for recheck_rad in [0.0, -1.0, f64::INFINITY] {
            let recheck = with(Settings { recheck_rad, ..SETTINGS });
            assert_eq!(recheck, Err(SettingsError::Recheck(recheck_rad)));
        }
        assert!(with(Settings { recheck_rad: f64::NAN, ..SETTINGS }).is_err());
        for (steps_per_tick, legal) in [(0, false), (1, true), (8, true), (9, false)] {
            let steps = with(Settings { steps_per_tick, ..SETTINGS });
            let named = Err(SettingsError::StepsPerTick(steps_per_tick));
            assert_eq!(steps, if legal { Ok(()) } else { named });
        }
    }
}
