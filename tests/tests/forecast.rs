//! The forecast has the first visit of each target, with the confidence that its channel gives.

use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::forecast::{Forecast, ForecastStep, NextVisit};
use onboard_core::frame::Boresight;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, MAX_EVALUATIONS_PER_STEP, Step, TransitFinder};
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
// REQ-TRANSIT-6.
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

/// Steps until a forecast is done, and the failures on the way.
fn run(channels: &mut [Channel<'_>], next: &mut [Option<NextVisit>]) -> (u32, Vec<usize>) {
    let mut forecast = Forecast::new(channels, next);
    let (mut steps, mut failed) = (0, Vec::new());
    loop {
        steps += 1;
        match forecast.step(covariance) {
            ForecastStep::Found(_) | ForecastStep::Searched(_) => {}
            ForecastStep::Done => return (steps, failed),
            ForecastStep::Failed { channel, .. } if failed.contains(&channel) => {
                return (steps, failed);
            }
            ForecastStep::Failed { channel, .. } => failed.push(channel),
        }
    }
}

#[test]
// REQ-FORECAST-1.
fn targets_take_as_many_steps_together_as_one_by_one() {
    let tables = tables(365);
    let end = Instant::from_tai_ns(365 * DAY_NS);
    let steps = |index: usize| run(&mut channels(&tables, end)[index..=index], &mut [None]).0;
    let alone: u32 = (0..TARGETS.len()).map(steps).sum();
    let mut next = [None; TARGETS.len()];
    let (together, failed) = run(&mut channels(&tables, end), &mut next);
    assert!(failed.is_empty(), "{failed:?}");
    // Each forecast by itself has a last step that only says that it is done.
    assert_eq!(together, alone + 1 - u32::try_from(TARGETS.len()).unwrap());
    // Channels without a place for their visit are not searched.
    let (fewer, _) = run(&mut channels(&tables, end), &mut next[..1]);
    assert_eq!(fewer, steps(0));
}

/// As a caller that keeps channels, visits and the one that waits, but no forecast, between two steps.
#[test]
fn a_forecast_that_is_resumed_at_every_step_takes_the_same_ones() {
    let tables = tables(60);
    let end = Instant::from_tai_ns(60 * DAY_NS);
    let (mut whole, mut pieces) = (channels(&tables, end), channels(&tables, end));
    let (mut next, mut own) = ([None; TARGETS.len()], [None; TARGETS.len()]);
    let mut waiting = None;
    let mut forecast = Forecast::new(&mut whole, &mut next);
    loop {
        let mut resumed = Forecast::resume(&mut pieces, &mut own, waiting);
        let step = resumed.step(covariance);
        waiting = resumed.waiting();
        assert_eq!(step, forecast.step(covariance));
        if step == ForecastStep::Done {
            break;
        }
    }
    assert_eq!(own, next);
    assert!(own[0].is_some());
}

#[test]
// REQ-TRANSIT-7.
fn a_channel_that_fails_holds_up_no_other() {
    let (long, short) = (tables(60), tables(2));
    let end = Instant::from_tai_ns(60 * DAY_NS);
    let mut whole = [None; TARGETS.len()];
    run(&mut channels(&long, end), &mut whole);
    for broken in 0..TARGETS.len() {
        let mixed: Vec<_> = (0..TARGETS.len())
            .map(|index| if index == broken { &short } else { &long }[index].clone())
            .collect();
        let mut next = [None; TARGETS.len()];
        let (_, failed) = run(&mut channels(&mixed, end), &mut next);
        let expected = whole[broken]
            .is_none_or(|it: NextVisit| it.transit.entry > Instant::from_tai_ns(2 * DAY_NS));
        assert_eq!(failed, if expected { vec![broken] } else { vec![] });
        for index in (0..TARGETS.len()).filter(|index| *index != broken) {
            assert_eq!(next[index], whole[index]);
        }
    }
    // The finder below it, too: all transits of the others, then the failure again.
    let mixed = [long[0].clone(), short[3].clone(), long[1].clone()];
    let alone: Vec<_> = [0, 2]
        .map(|index| transits(&mut channels(&mixed, end)[index..=index]))
        .into_iter()
        .flatten()
        .map(|transit| (transit.entry, transit.exit))
        .collect();
    let mut channels = channels(&mixed, end);
    let mut finder = TransitFinder::new(&mut channels);
    let (mut found, mut failures) = (Vec::new(), 0);
    while failures < 2 {
        match finder.step() {
            Step::Transit(transit) => found.push((transit.entry, transit.exit)),
            Step::Searched(_) => {}
            Step::Done => panic!("not all was searched"),
            Step::Failed { channel, .. } => {
                assert_eq!(channel, 1);
                failures += 1;
            }
        }
    }
    assert!(found.is_sorted());
    let mut expected = alone;
    expected.sort_unstable();
    assert_eq!(found, expected);
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
