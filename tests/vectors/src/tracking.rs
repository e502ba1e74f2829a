//! A tracker fed with measured attitudes, and the transits of the strategy that it corrects.
//!
//! Block: a container (u32 bytes, then it), settings (angles' sigmas 3 f64, rates' 2, angles' walks
//! 3, rates' 2, greatest age i64 ns, greatest lead i64, gate f64, limits 3 f64), epoch i64,
//! measurements (u32 bytes, then each: at i64, now i64, sigma f64, x y z w f64), instants of the
//! covariance (u32 bytes, then i64 each), then a search as in [`transits`](crate::transits).
//!
//! Every measurement writes its residuals or its refusal, then the strategy's bits.

use crate::Malformed;
use crate::reader::Reader;
use crate::sink::Sink;
use crate::tables::Loaded;
use crate::transits::{channels_of, search};
use onboard_core::scan::ScanStrategy;
use onboard_core::time::Instant;
use onboard_core::tracking::{Measurement, Residuals, Tracker, TrackerSettings};
use onboard_core::uncertainty::ScanCovariance;

/// A tracker as a block's settings and epoch say.
///
/// # Errors
/// [`Malformed`] where they are illegal.
pub fn tracker(block: &mut Reader<'_>, scan: &ScanStrategy) -> Result<Tracker, Malformed> {
    let settings = TrackerSettings {
        angle_sigmas_rad: block.numbers()?,
        rate_sigmas: block.numbers()?,
        angle_walks: block.numbers()?,
        rate_walks: block.numbers()?,
        max_age: block.duration()?,
        max_lead: block.duration()?,
        gate: block.f64()?,
        limits_rad: block.numbers()?,
    };
    Tracker::new(scan, &settings, block.instant()?).map_err(|_| Malformed)
}

/// A measurement, and the clock's instant when it arrives.
///
/// # Errors
/// [`Malformed`] at the end, or where the attitude is no rotation.
pub fn measurement(block: &mut Reader<'_>) -> Result<(Measurement, Instant), Malformed> {
    let (at, now) = (block.instant()?, block.instant()?);
    let sigma_rad = block.f64()?;
    Ok((Measurement { at, attitude: block.rotation()?, sigma_rad }, now))
}

/// Feeds the tracker, then searches with its strategy.
///
/// # Errors
/// [`Malformed`] where the container does not load, or the settings or a channel cannot be.
pub fn run(block: &mut Reader<'_>, sink: &mut impl Sink) -> Result<(), Malformed> {
    let loaded = Loaded::read(block.sized()?)?;
    let sun = loaded.sun()?;
    let mut tracker = tracker(block, &loaded.mission.strategy())?;
    let mut measurements = Reader::new(block.sized()?);
    while !measurements.is_empty() {
        let (measurement, now) = measurement(&mut measurements)?;
        sink.item(measurement.at.tai_ns());
        match tracker.update(&sun, &measurement, now) {
            Ok(residuals) => write(&residuals, sink),
            Err(error) => sink.text("measurement refused", &error),
        }
        strategy(tracker.strategy(), sink);
    }
    sink.word("accepted", tracker.accepted().into());
    sink.word("refused in a row", tracker.refused_in_a_row().into());
    sink.numbers(["precession's rate sigma", "spin's rate sigma"], tracker.rate_sigmas_rad_s());
    let mut instants = Reader::new(block.sized()?);
    while !instants.is_empty() {
        let at = instants.instant()?;
        sink.item(at.tai_ns());
        covariance(&tracker.covariance_at(at), sink);
    }
    let saved = tracker.state();
    sink.text("tracker's state", &saved);
    sink.text("resumed", &tracker.resume(&saved));
    search(&mut channels_of(tracker.strategy(), block, &loaded)?, sink);
    Ok(())
}

fn write(residuals: &Residuals, sink: &mut impl Sink) {
    sink.numbers(
        ["precession residual", "alpha residual", "spin residual"],
        residuals.innovation_rad,
    );
    sink.numbers(
        ["precession residual's sigma", "alpha residual's sigma", "spin residual's sigma"],
        residuals.sigma_rad,
    );
    sink.number("chi^2", residuals.chi2);
}

fn strategy(scan: &ScanStrategy, sink: &mut impl Sink) {
    let scan = scan.parameters();
    sink.number("corrected alpha", scan.alpha_rad);
    for rotor in [scan.precession, scan.spin] {
        sink.word("corrected start", rotor.start.bits());
        for half in rotor.rate.bits().to_le_bytes().as_chunks::<8>().0 {
            sink.word("corrected rate", u64::from_le_bytes(*half));
        }
    }
}

fn covariance(covariance: &ScanCovariance, sink: &mut impl Sink) {
    sink.numbers(["precession variance", "alpha variance", "spin variance"], covariance.variances);
    sink.numbers(["precession-alpha", "precession-spin", "alpha-spin"], covariance.covariances);
}
