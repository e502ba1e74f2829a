//! Visits of pixels against dense sampling, of circles against the flight core's transits.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use onboard_core::direction::Direction;
use onboard_core::frame::{Boresight, Detector, Ecliptic};
use onboard_core::phase::{Phase, Rotor, TurnRate};
use onboard_core::rotation::Rotation;
use onboard_core::scan::{ScanParameters, ScanStrategy};
use onboard_core::time::{Duration, Instant};
use planner::healpix::Nside;
use planner::visits::{Boundary, LineOfSight, Sampling, Sun, Visit, pixel_at, sampled};
use std::f64::consts::TAU;
use std::num::NonZeroU64;

fn rotor(period_s: f64, start: f64) -> Rotor {
    Rotor {
        rate: TurnRate::from_radians_per_second(TAU / period_s),
        start: Phase::from_radians(start),
    }
}

/// Angles in degrees, periods in seconds, starting at instant 0.
fn strategy((alpha, beta): (f64, f64), precession_s: f64, spin_s: f64) -> ScanStrategy {
    ScanStrategy::new(ScanParameters {
        start: Instant::from_tai_ns(0),
        alpha_rad: f64::to_radians(alpha),
        beta_rad: f64::to_radians(beta),
        precession: rotor(precession_s, 0.3),
        spin: rotor(spin_s, 1.1),
    })
    .unwrap()
}

fn litebird() -> ScanStrategy {
    strategy((45.0, 50.0), 11_540.88, 1_200.0)
}

fn pico() -> ScanStrategy {
    strategy((26.0, 69.0), 36_000.0, 60.0)
}

fn line(
    scan: &ScanStrategy,
    detector: Rotation<Detector, Boresight>,
    span_s: (f64, f64),
) -> LineOfSight {
    let at = |seconds| Instant::from_tai_ns(Duration::from_seconds(seconds).ns());
    LineOfSight {
        scan: *scan,
        sun: Sun::Circular(rotor(365.25 * 86_400.0, 0.2)),
        detector,
        ends: (at(span_s.0), at(span_s.1)),
    }
}

/// Runs of samples inside, `step` apart, as (first, last), by cdshealpix's membership.
fn dense(line: &LineOfSight, nside: Nside, pixel: u32, step_ns: i64) -> Vec<(i64, i64)> {
    let mut runs: Vec<(i64, i64)> = Vec::new();
    let (start, end) = (line.ends.0.tai_ns(), line.ends.1.tai_ns());
    let mut previous = false;
    let mut at = start;
    while at <= end {
        let there = line.direction(Instant::from_tai_ns(at)).unwrap();
        let inside = nside.pixel_at(there.longitude_rad(), there.latitude_rad()) == pixel;
        match runs.last_mut() {
            Some(run) if inside && previous => run.1 = at,
            _ if inside => runs.push((at, at)),
            _ => {}
        }
        previous = inside;
        at += step_ns;
    }
    runs
}

/// Every run lies in a visit of its own, edges within a step; a visit without a run is shorter.
fn agree(visits: &[Visit], runs: &[(i64, i64)], step_ns: i64, what: &str) {
    let mut runs = runs.iter().peekable();
    for visit in visits {
        let (entry, exit) = (visit.entry.tai_ns(), visit.exit.tai_ns());
        match runs.next_if(|run| run.0 <= exit) {
            Some(run) => {
                // A nanosecond of rounding where a sample falls on an edge.
                assert!(
                    entry <= run.0 + 1 && run.0 - entry <= step_ns + 1,
                    "{what}: {visit:?} {run:?}"
                );
                assert!(
                    exit >= run.1 - 1 && exit - run.1 <= step_ns + 1,
                    "{what}: {visit:?} {run:?}"
                );
            }
            None => assert!(exit - entry < step_ns, "{what}: {visit:?} invented"),
        }
    }
    assert_eq!(runs.next(), None, "{what}: missed");
}

/// Pixels of each kind: at a pole, on base pixels' edges and corners, in the belt, across the caps'
/// rims.
fn pixels(nside: Nside) -> Vec<u32> {
    let n = nside.get();
    let last = n * n - 1;
    let face = |face: u32, within: u32| face * n * n + within;
    let mut pixels = vec![
        face(0, last), // north pole
        face(2, last),
        face(9, 0), // south pole
        face(1, 0), // a polar base pixel's southern corner
        face(5, 0),
        face(6, last), // an equatorial base pixel's northern corner, on the rim
        face(8, last),
        face(3, last / 2),
        face(10, last / 3),
        face(4, 2 * (last / 3)),
    ];
    pixels.sort_unstable();
    pixels.dedup();
    pixels
}

#[test]
fn whole_base_pixels_against_dense_sampling() {
    let nside = Nside::new(1).unwrap();
    let scan = litebird();
    let line = line(&scan, Rotation::IDENTITY, (0.0, 60_000.0));
    let mut found = 0;
    for pixel in 0..12 {
        let visits = line.pixel_visits(&Boundary::new(nside, pixel)).unwrap();
        let step = 250_000_000;
        agree(&visits, &dense(&line, nside, pixel, step), step, &format!("base {pixel}"));
        found += visits.len();
    }
    assert!(found > 150, "{found}");
}

#[test]
fn a_partition_of_the_sky_is_visited_without_gap_or_overlap() {
    // The line of sight is in exactly one pixel at all times.
    let scan = pico();
    let tilt = Rotation::<Detector, Boresight>::about_y(0.2);
    for detector in [Rotation::IDENTITY, tilt] {
        let line = line(&scan, detector, (1_000.0, 1_600.0));
        for nside in [1, 4, 16] {
            let nside = Nside::new(nside).unwrap();
            let mut all: Vec<Visit> = (0..nside.pixels())
                .flat_map(|pixel| line.pixel_visits(&Boundary::new(nside, pixel)).unwrap())
                .collect();
            all.sort_by_key(|visit| (visit.entry, visit.exit));
            assert_eq!(all.first().unwrap().entry, line.ends.0);
            assert_eq!(all.last().unwrap().exit, line.ends.1);
            assert!(all.len() > 50);
            for pair in all.windows(2) {
                let between = pair[1].entry.since(pair[0].exit).ns();
                // Corner cuts below the tolerance last some tens of nanoseconds.
                assert!((-2..=100).contains(&between), "{nside:?}: {between} ns");
            }
            assert_eq!(all.iter().filter(|visit| visit.entry_clipped).count(), 1);
            assert_eq!(all.iter().filter(|visit| visit.exit_clipped).count(), 1);
        }
    }
}

#[test]
fn pixels_of_every_kind_against_dense_sampling_near_the_visits() {
    // Sampled at a hundredth of the shortest dwell, or of a thousandth of a crossing of the pixel,
    // around each circle that holds the pixel; between these circles nothing can be inside.
    let mut compared = 0;
    for (scan, days) in [(litebird(), 400.0), (pico(), 40.0)] {
        for nside in [64, 2048] {
            let nside = Nside::new(nside).unwrap();
            let span = if nside.get() == 64 { days } else { 4.0 * days };
            for pixel in pixels(nside) {
                let whole = line(&scan, Rotation::IDENTITY, (0.0, span * 86_400.0));
                let boundary = Boundary::new(nside, pixel);
                let visits = whole.pixel_visits(&boundary).unwrap();
                let (centre, radius) = boundary.enclosing_circle();
                let near = whole.circle_visits(centre, radius).unwrap();
                let crossing = 2.0 * radius / whole.largest_speed_rad_s().unwrap();
                let shortest = visits.iter().map(|visit| visit.dwell().ns()).min();
                let floor = Duration::from_seconds(crossing / 1e3).ns();
                let step = (shortest.unwrap_or(i64::MAX) / 100).max(floor / 4).max(1);
                let step = step.min(floor);
                let every = 1 + near.len() / 60;
                for interval in near.iter().step_by(every) {
                    let margin = Duration::from_seconds(0.1 * crossing);
                    let ends = (
                        interval.entry.plus(Duration::from_ns(-margin.ns())).max(whole.ends.0),
                        interval.exit.plus(margin).min(whole.ends.1),
                    );
                    let part = LineOfSight { ends, ..whole.clone() };
                    let runs = dense(&part, nside, pixel, step);
                    let within: Vec<Visit> = visits
                        .iter()
                        .filter(|it| it.exit >= ends.0 && it.entry <= ends.1)
                        .copied()
                        .collect();
                    agree(&within, &runs, step, &format!("nside {} pixel {pixel}", nside.get()));
                    compared += runs.len();
                }
                let all_near = visits.iter().all(|visit| {
                    near.iter().any(|it| it.entry <= visit.entry && visit.exit <= it.exit)
                });
                assert!(all_near);
            }
        }
    }
    assert!(compared > 500, "{compared}");
}

#[test]
fn entries_lie_within_a_nanosecond_of_the_edge() {
    let scan = litebird();
    let line = line(&scan, Rotation::IDENTITY, (0.0, 200.0 * 86_400.0));
    let nside = Nside::new(64).unwrap();
    let boundary = Boundary::new(nside, pixel_at(nside, 0.9, 2.0));
    let visits = line.pixel_visits(&boundary).unwrap();
    assert!(visits.len() > 20, "{}", visits.len());
    let inside = |at: Instant| boundary.contains(line.direction(at).unwrap());
    for visit in visits {
        let next = |ns| Duration::from_ns(ns);
        assert!(inside(visit.entry) && !inside(visit.entry.plus(next(-1))));
        assert!(inside(visit.exit) && !inside(visit.exit.plus(next(1))));
    }
}

#[test]
fn runs_of_samples_are_what_sampling_finds() {
    let scan = litebird();
    let line = line(&scan, Rotation::IDENTITY, (0.0, 3.0 * 86_400.0));
    let nside = Nside::new(8).unwrap();
    // 20e6/1048576 Hz = 78125/4096 Hz would be exact too; a plain 5 Hz is 0.2 s.
    let ratio = |value| NonZeroU64::new(value).unwrap();
    let five = Sampling { start: line.ends.0, rate_hz: (ratio(5), ratio(1)) };
    for pixel in [255, 17, 400, 700] {
        let visits = line.pixel_visits(&Boundary::new(nside, pixel)).unwrap();
        let runs = dense(&line, nside, pixel, 200_000_000);
        let found: Vec<(i64, i64)> = sampled(&visits, &five)
            .iter()
            .map(|visit| (visit.entry.tai_ns(), visit.exit.tai_ns()))
            .collect();
        assert_eq!(found, runs, "pixel {pixel}");
    }
}

#[test]
fn a_circle_is_visited_where_its_centre_is_near() {
    let scan = pico();
    let line = line(&scan, Rotation::IDENTITY, (0.0, 86_400.0));
    let centre = Direction::<Ecliptic>::from_longitude_latitude(1.0, 0.9);
    let radius = 0.03;
    let visits = line.circle_visits(centre, radius).unwrap();
    assert!(visits.len() > 5);
    for visit in &visits {
        for (at, sign) in [(visit.entry, 1.0), (visit.exit, -1.0)] {
            let apart = |s: f64| {
                let at = at.plus(Duration::from_seconds(sign * s));
                line.direction(at).unwrap().separation_rad(centre)
            };
            assert!(apart(1e-6) < radius && apart(-1e-6) > radius);
        }
    }
    assert!(line.circle_visits(centre, 0.0).is_err());
}
