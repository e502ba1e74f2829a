//! Fields of every shape and strategies at their limits: membership at random instants.

use onboard_core::attitude::attitude;
use onboard_core::ephemeris::{EphemerisError, EphemerisTable};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{Boresight, Telescope};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, SearchOrigin, SearchState, Step, Transit, TransitFinder};
use onboard_core::uplink::Header;
use tests::{Noise, Plain, table, transits, turn_rate};

const DAY_NS: i64 = 86_400_000_000_000;

fn sun() -> SunModel<'static> {
    SunModel::Circular(Rotor {
        rate: turn_rate(31_557_600_000_000_000, 1),
        start: Phase::from_radians(-1.0),
    })
}

/// At random instants, inside by the definition means inside a transit. Returns the transits.
fn check(plain: Plain, field: &FieldOfView, target: [f64; 3], days: i64) -> Vec<Transit> {
    let scan = plain.strategy();
    let end_ns = days * DAY_NS;
    let bytes = table(5, 0, u64::try_from(end_ns).unwrap(), &[vec![target]]);
    let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(end_ns));
    let found = transits(&mut [Channel::new(&scan, sun(), body, field, span)]);
    assert!(found.windows(2).all(|pair| pair[0].exit <= pair[1].entry));
    let inside = |at: Instant| {
        let look = attitude(&scan, &sun(), at).unwrap();
        field.contains(look.inverse().apply(body.state(at).unwrap().direction))
    };
    let mut noise = Noise::new(7);
    let mut hits = 0;
    let transit_at = |at: Instant| {
        let after = found.partition_point(|transit| transit.entry <= at);
        found.get(after.wrapping_sub(1)).is_some_and(|transit| at <= transit.exit)
    };
    let mut probe = |ns: i64| {
        let at = Instant::from_tai_ns(ns.clamp(0, end_ns));
        assert_eq!(inside(at), transit_at(at), "at {ns} ns of {plain:?} {field:?}");
        hits += u32::from(inside(at));
    };
    for _ in 0..20_000 {
        probe((noise.unit() * end_ns as f64) as i64);
    }
    // A millisecond to either side of every edge.
    for transit in found.iter().filter(|transit| transit.dwell().ns() > 10_000_000) {
        for (edge, clipped) in
            [(transit.entry, transit.entry_clipped), (transit.exit, transit.exit_clipped)]
        {
            for offset in [-1_000_000, 1_000_000] {
                if !clipped {
                    probe(edge.tai_ns() + offset);
                }
            }
        }
    }
    found
}

fn circle(degrees: f64) -> FieldOfView {
    FieldOfView::circle(Rotation::<Boresight, Boresight>::IDENTITY, degrees.to_radians()).unwrap()
}

const TARGET: [f64; 3] = [0.6, 0.8, 0.01];

#[test]
// REQ-TRANSIT-1.
fn focal_planes() {
    let tilted = Rotation::<Telescope, Boresight>::about_z(0.3)
        .then(Rotation::<Boresight, Boresight>::about_x(0.1));
    let lft = FieldOfView::rectangle(tilted, 18.0_f64.to_radians(), 8.0_f64.to_radians()).unwrap();
    for target in [TARGET, [0.0, 0.0, 1.0], [-0.8, 0.6, 0.0]] {
        assert!(!check(Plain::LITEBIRD, &lft, target, 120).is_empty());
    }
    assert!(check(Plain::LITEBIRD, &circle(14.0), TARGET, 60).len() > 100);
    let huge = FieldOfView::rectangle(tilted, 3.0, 2.0).unwrap();
    check(Plain::LITEBIRD, &huge, TARGET, 30);
}

#[test]
// REQ-TRANSIT-5.
fn the_closest_approach_in_a_rectangle_is_that_of_dense_sampling() {
    let tilted = Rotation::<Telescope, Boresight>::about_z(0.3)
        .then(Rotation::<Boresight, Boresight>::about_x(0.1));
    let lft = FieldOfView::rectangle(tilted, 18.0_f64.to_radians(), 8.0_f64.to_radians()).unwrap();
    // An arcsecond's hundredth.
    let allowed_rad = 0.01 / 3600.0 * std::f64::consts::PI / 180.0;
    let mut at_an_edge = 0;
    for (plain, days) in [(Plain::LITEBIRD, 400), (Plain::PLANCK, 60)] {
        let (scan, end_ns) = (plain.strategy(), days * DAY_NS);
        let track = vec![TARGET, [2e-3, -1e-3, 1e-3], [0.0, 1e-3, 1e-3]];
        let bytes = table(5, 0, end_ns.unsigned_abs(), &[track]);
        let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
        let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(end_ns));
        let separation = |ns: i64| {
            let at = Instant::from_tai_ns(ns);
            let look = attitude(&scan, &sun(), at).unwrap();
            let seen = look.inverse().apply(body.state(at).unwrap().direction);
            lft.centre().separation_rad(seen)
        };
        let found = transits(&mut [Channel::new(&scan, sun(), body, &lft, span)]);
        assert!(found.len() > 500, "{}", found.len());
        for transit in &found {
            let (entry, exit) = (transit.entry.tai_ns(), transit.exit.tai_ns());
            let step = (exit - entry) / 64 + 1;
            let sampled = (0..=64).map(|k| (entry + k * step).min(exit));
            let least = sampled.min_by(|a, b| separation(*a).total_cmp(&separation(*b))).unwrap();
            let (mut low, mut high) = ((least - step).max(entry), (least + step).min(exit));
            while high - low > 2 {
                let third = (high - low) / 3;
                if separation(low + third) < separation(high - third) {
                    high -= third.max(1);
                } else {
                    low += third.max(1);
                }
            }
            let dense = (low..=high).map(separation).fold(f64::INFINITY, f64::min);
            let off = transit.min_separation_rad - dense;
            assert!(off.abs() < allowed_rad, "{off:e} rad: {transit:?}");
            let stated = separation(transit.closest.tai_ns()) - transit.min_separation_rad;
            assert!(stated.abs() < 1e-12, "{stated:e} rad: {transit:?}");
            at_an_edge += u32::from([transit.entry, transit.exit].contains(&transit.closest));
        }
    }
    assert!(at_an_edge > 50, "{at_an_edge}");
}

#[test]
fn radii_to_half_a_turn() {
    for degrees in [0.001, 0.1, 30.0, 60.0, 90.0, 120.0, 179.0] {
        check(Plain::LITEBIRD, &circle(degrees), TARGET, 30);
        check(Plain::PLANCK, &circle(degrees), TARGET, 3);
    }
    let always = check(Plain::LITEBIRD, &circle(180.0), TARGET, 30);
    assert_eq!(always.len(), 1);
    assert!(always[0].entry_clipped && always[0].exit_clipped);
}

#[test]
fn angles_at_their_limits() {
    for (alpha_deg, beta_deg) in [
        (0.0, 90.0),
        (90.0, 0.0),
        (0.0, 0.0),
        (90.0, 90.0),
        (0.0, 180.0),
        (180.0, 0.0),
        (1e-6, 89.0),
        (45.0, 1e-6),
        (120.0, 60.0),
        (2.0, 1.0),
    ] {
        for degrees in [0.5, 10.0] {
            let plain = Plain { alpha_deg, beta_deg, ..Plain::LITEBIRD };
            check(plain, &circle(degrees), TARGET, 200);
            check(plain, &circle(degrees), [-0.8, 0.6, 0.0], 200);
        }
    }
}

#[test]
// REQ-TRANSIT-8.
fn resuming_a_saved_state_gives_the_same_bits() {
    let bytes = table(5, 0, 30 * DAY_NS as u64, &[vec![TARGET]]);
    let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(30 * DAY_NS));
    let fresh = || Channel::new(&Plain::LITEBIRD.strategy(), sun(), body, &circle(3.0), span);
    let header = Header {
        sequence: 1,
        valid_from: span.0,
        valid_until: span.1,
        mission_digest: [0; 16],
        spacecraft: 1,
    };
    let origin = SearchOrigin::new(&header, 0, &Plain::LITEBIRD.strategy(), &circle(3.0), 5);
    let whole = transits(&mut [fresh()]);
    assert!(whole.len() > 20);
    for steps in [1, 10, 100, 777] {
        let mut first = [fresh()];
        let mut finder = TransitFinder::new(&mut first);
        let mut found = Vec::new();
        for _ in 0..steps {
            if let Step::Transit(transit) = finder.step() {
                found.push(transit);
            }
        }
        let saved = first[0].state().to_le_bytes(&origin);
        let mut second = [fresh()];
        second[0].resume(SearchState::from_le_bytes(&saved, &origin).unwrap());
        found.extend(transits(&mut second));
        assert_eq!(found, whole, "after {steps} steps");
    }
}

#[test]
fn channels_come_out_in_order_of_entry_then_channel() {
    let bytes = table(5, 0, 30 * DAY_NS as u64, &[vec![TARGET]]);
    let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(30 * DAY_NS));
    let scan = Plain::LITEBIRD.strategy();
    let channel = |degrees| Channel::new(&scan, sun(), body, &circle(degrees), span);
    let merged = transits(&mut [channel(3.0), channel(1.0), channel(3.0), channel(20.0)]);
    let keys: Vec<_> = merged.iter().map(|t| (t.entry, t.channel)).collect();
    assert!(keys.is_sorted(), "{keys:?}");
    for (index, degrees) in [3.0, 1.0, 3.0, 20.0].into_iter().enumerate() {
        let alone = transits(&mut [channel(degrees)]);
        let same: Vec<_> = merged
            .iter()
            .filter(|transit| transit.channel == index)
            .map(|transit| Transit { channel: 0, ..*transit })
            .collect();
        assert_eq!(alone, same);
    }
}

#[test]
// REQ-TRANSIT-4.
fn near_equal_entries_come_out_in_order_and_never_before_the_frontier() {
    let end_ns = 1096 * DAY_NS;
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(end_ns));
    let scan = Plain::LITEBIRD.strategy();
    let mut noise = Noise::new(23);
    let (mut near, mut closest_ns) = (0, i64::MAX);
    for pair in 0..16 {
        let apart_rad = 10.0_f64.powi(-6 - pair % 5);
        let target = [noise.signed(), noise.signed(), 0.2 * noise.signed()];
        let tables = [0.0, apart_rad].map(|by| {
            let moved = [target[0] + by, target[1] - by, target[2] + by];
            table(5, 0, end_ns.unsigned_abs(), &[vec![moved]])
        });
        let mut channels: Vec<_> = tables
            .iter()
            .map(|bytes| {
                let body = EphemerisTable::parse(bytes).unwrap().body(5).unwrap();
                Channel::new(&scan, sun(), body, &circle(1.0), span)
            })
            .collect();
        let mut finder = TransitFinder::new(&mut channels);
        let (mut frontier, mut last) = (span.0, None::<Transit>);
        loop {
            match finder.step() {
                Step::Searched(until) => {
                    assert!(until >= frontier, "the frontier moves back to {until:?}");
                    frontier = until;
                }
                Step::Transit(transit) => {
                    assert!(transit.entry >= frontier, "{frontier:?} {transit:?}");
                    if let Some(last) = last {
                        let key = |it: &Transit| (it.entry, it.channel);
                        assert!(key(&last) < key(&transit), "{last:?} {transit:?}");
                        let apart_ns = transit.entry.since(last.entry).ns();
                        near += u32::from(apart_ns < 1_000_000);
                        closest_ns = closest_ns.min(apart_ns);
                    }
                    last = Some(transit);
                }
                Step::Done => break,
                Step::Failed { error, .. } => panic!("{error:?}"),
            }
        }
    }
    assert!(near > 800 && closest_ns < 512, "{near} {closest_ns}");
}

#[test]
fn a_table_that_ends_too_early_is_reported_and_loses_nothing() {
    let bytes = table(5, 0, 10 * DAY_NS as u64, &[vec![TARGET]]);
    let body = EphemerisTable::parse(&bytes).unwrap().body(5).unwrap();
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(30 * DAY_NS));
    let mut channels = [Channel::new(&Plain::LITEBIRD.strategy(), sun(), body, &circle(3.0), span)];
    let mut finder = TransitFinder::new(&mut channels);
    let failure = loop {
        match finder.step() {
            Step::Failed { channel, error } => break (channel, error),
            Step::Done => panic!("searched beyond the table"),
            _ => {}
        }
    };
    let (0, EphemerisError::OutOfSpan(at)) = failure else { panic!("{failure:?}") };
    assert!(at > Instant::from_tai_ns(10 * DAY_NS));
    assert_eq!(finder.step(), Step::Failed { channel: 0, error: failure.1 });
}
