//! The forecast has the first visit of each target, with the confidence that its channel gives.

use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::frame::Boresight;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, MAX_EVALUATIONS_PER_STEP};
use onboard_core::uncertainty::ScanCovariance;
use tests::{Plain, table, transits, turn_rate};

const DAY_NS: i64 = 86_400_000_000_000;
/// The last one never comes within reach of the scan.
const TARGETS: [[f64; 3]; 4] =
    [[0.2, 0.9, 0.05], [-0.5, 0.6, -0.3], [0.1, -0.2, 0.9], [-0.999, -0.01, 0.0]];

fn tables(days: i64) -> Vec<Vec<u8>> {
    let length = (days * DAY_NS).unsigned_abs();
    TARGETS.iter().map(|at| table(5, 0, length, &[vec![*at, [1e-4, 0.0, 1e-4]]])).collect()
}

fn channels<'a>(tables: &'a [Vec<u8>], end: Instant) -> Vec<Channel<'a>> {
    let sun = SunModel::Circular(Rotor {
        rate: turn_rate(31_557_600_000_000_000, 1),
        start: Phase::from_radians(0.3),
    });
    let field = FieldOfView::circle(Rotation::<Boresight, Boresight>::IDENTITY, 0.02).unwrap();
    let scan = Plain::LITEBIRD.strategy();
    let span = (Instant::from_tai_ns(0), end);
    let channel = |bytes: &'a Vec<u8>| {
        let body = EphemerisTable::parse(bytes).unwrap().body(5).unwrap();
        Channel::new(&scan, sun, body, &field, span)
    };
    tables.iter().map(channel).collect()
}

/// Grows with time, so that a visit must be judged at its own.
fn covariance(at: Instant) -> ScanCovariance {
    let days = at.tai_ns() as f64 / DAY_NS as f64;
    ScanCovariance {
        variances: [1e-10 * days, 1e-12, 1e-10 * days],
        covariances: [0.0, -5e-11 * days, 0.0],
    }
}

#[test]
fn each_target_has_its_first_visit_and_its_confidence() {
    let tables = tables(60);
    let end = Instant::from_tai_ns(60 * DAY_NS);
    let mut own = channels(&tables, end);
    let first: Vec<_> = (0..TARGETS.len())
        .map(|index| transits(&mut own[index..=index]).first().copied())
        .collect();
    assert!(first[..2].iter().all(Option::is_some) && first[3].is_none(), "{first:?}");

    let mut channels = channels(&tables, end);
    let mut next = [None; TARGETS.len()];
    let mut forecast = Forecast::new(&mut channels, &mut next);
    let mut found = 0;
    loop {
        match forecast.step(covariance) {
            ForecastStep::Found(index) => {
                found += 1;
                assert!(forecast.next()[index].is_some());
            }
            ForecastStep::Searched(_) => {}
            ForecastStep::Done => break,
            ForecastStep::Failed { channel, error } => panic!("{channel}: {error:?}"),
        }
    }
    assert_eq!(found, first.iter().flatten().count());
    for (index, expected) in first.iter().enumerate() {
        let Some(expected) = expected else {
            assert_eq!(next[index], None);
            continue;
        };
        let NextVisit { transit, confidence } = next[index].unwrap();
        assert_eq!(
            (transit.channel, transit.entry, transit.exit),
            (index, expected.entry, expected.exit)
        );
        assert_eq!(
            confidence,
            own[index].confidence(expected, &covariance(expected.entry)).unwrap()
        );
        assert!(confidence.entry_sigma_s > 0.0 && confidence.probability > 0.5);
    }
}

#[test]
fn a_step_evaluates_as_often_as_a_finders_step_may() {
    let tables = tables(60);
    let mut channels = channels(&tables, Instant::from_tai_ns(60 * DAY_NS));
    let mut next = [None; TARGETS.len()];
    let mut before = 0;
    loop {
        // A forecast hides its channels: each is begun anew from its saved state.
        let mut forecast = Forecast::new(&mut channels[..1], &mut next[..1]);
        let step = forecast.step(covariance);
        let made = channels[0].evaluations();
        assert!(made - before <= u64::from(MAX_EVALUATIONS_PER_STEP));
        before = made;
        if matches!(step, ForecastStep::Done) || channels[0].frontier().is_none() {
            break;
        }
    }
    assert!(before > 100, "{before}");
}

#[test]
fn a_table_that_ends_is_reported_and_the_search_stands() {
    let tables = tables(2);
    let mut channels = channels(&tables[3..], Instant::from_tai_ns(60 * DAY_NS));
    let mut next = [None; 1];
    let mut forecast = Forecast::new(&mut channels, &mut next);
    let failed = loop {
        match forecast.step(covariance) {
            ForecastStep::Failed { channel: 0, error } => break error,
            ForecastStep::Searched(_) => {}
            other => panic!("{other:?}"),
        }
    };
    assert!(matches!(failed, EphemerisError::OutOfSpan(_)));
    assert_eq!(forecast.step(covariance), ForecastStep::Failed { channel: 0, error: failed });
}
