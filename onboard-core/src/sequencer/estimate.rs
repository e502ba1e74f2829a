//! The scan as the sequencer is told of it, and how far two scans point apart.

use crate::scan::ScanStrategy;
use crate::time::Instant;
use crate::tracking::Tracker;
use crate::uncertainty::ScanCovariance;

/// The strategy that predictions are made with, and how well it is known.
#[derive(Debug, Clone, Copy, Default)]
pub enum ScanEstimate<'t> {
    /// The mission section's strategy, taken as exact.
    #[default]
    Mission,
    /// Another strategy, taken as exact.
    Strategy(&'t ScanStrategy),
    /// As measured attitudes have corrected it, and as well as the tracker knows it.
    Tracked(&'t Tracker),
}

impl ScanEstimate<'_> {
    /// The strategy, where it is not the mission section's.
    #[must_use]
    pub const fn strategy(&self) -> Option<&ScanStrategy> {
        match self {
            Self::Mission => None,
            Self::Strategy(strategy) => Some(strategy),
            Self::Tracked(tracker) => Some(tracker.strategy()),
        }
    }

    /// How well its angles are known at `at`.
    #[must_use]
    #[inline(never)]
    pub fn covariance_at(&self, at: Instant) -> ScanCovariance {
        match self {
            Self::Mission | Self::Strategy(_) => ScanCovariance::ZERO,
            Self::Tracked(tracker) => tracker.covariance_at(at),
        }
    }
}

/// Angle in radians between the attitudes that two strategies give at `at`, the Sun where it is.
#[inline(never)]
pub(super) fn turned_rad(one: &ScanStrategy, other: &ScanStrategy, at: Instant) -> f64 {
    let into_anti_sun =
        |scan: &ScanStrategy| scan.boresight_in_spin().then(scan.spin_in_anti_sun(at));
    let [x, y, z, w] = into_anti_sun(one).then(into_anti_sun(other).inverse()).to_xyzw();
    2.0 * libm::atan2(libm::sqrt(x * x + y * y + z * z), libm::fabs(w))
}

#[cfg(test)]
mod tests {
    use super::super::trial::{Board, Flight, SETTINGS, later, sessions, strategy, turned};
    use super::super::{ScanEstimate, Settings};
    use super::*;
    use crate::phase::{Phase, Rotor, TurnRate};
    use crate::scan::ScanParameters;

    fn scan(alpha_rad: f64, precession_rad: f64, spin_rad: f64) -> ScanStrategy {
        let rotor =
            |start| Rotor { rate: TurnRate::from_bits(1 << 80), start: Phase::from_radians(start) };
        ScanStrategy::new(ScanParameters {
            start: Instant::from_tai_ns(0),
            alpha_rad,
            beta_rad: 0.8,
            precession: rotor(precession_rad),
            spin: rotor(spin_rad),
        })
        .unwrap()
    }

    #[test]
    fn a_turn_about_one_axis_is_its_angle() {
        let own = scan(0.7, 0.3, 0.2);
        let at = Instant::from_tai_ns(1_234_567_890_123);
        let from = |other: &ScanStrategy| turned_rad(&own, other, at);
        assert!(from(&own) < 1e-15);
        assert!((from(&scan(0.7, 0.3, 0.2 + 1.5)) - 1.5).abs() < 1e-12);
        assert!((from(&scan(0.7, 0.3 - 0.25, 0.2)) - 0.25).abs() < 1e-12);
        assert!((from(&scan(0.7 + 1e-4, 0.3, 0.2)) - 1e-4).abs() < 1e-12);
        // The far way round is the near one.
        assert!((from(&scan(0.7, 0.3, 0.2 + 4.0)) - (core::f64::consts::TAU - 4.0)).abs() < 1e-12);
    }

    #[test]
    // REQ-SEQ-7.
    fn a_verdict_stands_at_the_angle_itself() {
        let session = *sessions().first().expect("a session");
        let bytes = Board::default().uplink(1, &[session]);
        let other = turned(2e-3);
        let by = |at| turned_rad(&strategy(), &other, at);
        let recheck_rad = by(session.start).max(by(session.end));
        let mut flight = Flight::with(Settings { recheck_rad, ..SETTINGS }, &bytes);
        flight.run(later(session.start, -3600), later(session.start, -600));
        flight.scan = ScanEstimate::Strategy(&other);
        assert_eq!(
            flight.told(later(session.start, -600).tai_ns()).check,
            super::super::Progress::Done
        );
    }
}
