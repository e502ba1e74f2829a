//! Avoidance against an outline of points and dense sampling: no violation missed, none invented.
#![expect(clippy::unwrap_used, reason = "a test may unwrap")]

use onboard_core::attitude::attitude;
use onboard_core::avoidance::{
    AvoidanceError, AvoidanceFinder, AvoidanceLimit, AvoidanceStep, Violation, Zone,
    angle_to_field_rad,
};
use onboard_core::direction::Direction;
use onboard_core::ephemeris::{BodyTable, EphemerisTable};
use onboard_core::field_of_view::{FieldOfView, FieldShape};
use onboard_core::frame::{Boresight, Telescope};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, MAX_EVALUATIONS_PER_STEP};
use std::f64::consts::{PI, TAU};
use tests::{Noise, Plain, table, turn_rate};

const SUN_AS_TARGET: i32 = 999_999;
const DAY_NS: i64 = 86_400_000_000_000;
const DAYS: i64 = 14;
/// A sample this close to the limit may go either way (`docs/conventions.md`).
const EITHER_WAY_RAD: f64 = 1e-9;
const START_RAD: f64 = 0.7;

fn sun() -> SunModel<'static> {
    SunModel::Circular(Rotor {
        rate: turn_rate(31_557_600_000_000_000, 1),
        start: Phase::from_radians(START_RAD),
    })
}

/// A body in uniform circular motion about the ecliptic pole, tilted, as Chebyshev series by day.
fn circling(body: i32, start_rad: f64, period_days: f64, tilt_rad: f64) -> Vec<u8> {
    const ORDERS: usize = 9;
    let place = |days: f64| {
        let (sin, cos) = (start_rad + TAU * days / period_days).sin_cos();
        [cos, sin * tilt_rad.cos(), sin * tilt_rad.sin()]
    };
    let granules: Vec<Vec<[f64; 3]>> = (0..=DAYS)
        .map(|day| {
            (0..ORDERS)
                .map(|order| {
                    let mut sum = [0.0; 3];
                    for node in 0..ORDERS {
                        let angle = PI * (node as f64 + 0.5) / ORDERS as f64;
                        let p = place(day as f64 + 0.5 * (angle.cos() + 1.0));
                        let weight = (order as f64 * angle).cos() / ORDERS as f64
                            * if order == 0 { 1.0 } else { 2.0 };
                        for (total, part) in sum.iter_mut().zip(p) {
                            *total += weight * part;
                        }
                    }
                    sum
                })
                .collect()
        })
        .collect();
    table(body, 0, DAY_NS as u64, &granules)
}

fn sun_as_target() -> Vec<u8> {
    circling(SUN_AS_TARGET, START_RAD + PI, 365.25, 0.0)
}

fn earth() -> Vec<u8> {
    circling(399, START_RAD + PI + 0.1, 365.25, 0.0)
}

fn moon() -> Vec<u8> {
    circling(301, 2.0, 27.3, 0.09)
}

fn circle(degrees: f64) -> FieldOfView {
    let tilted = Rotation::<Telescope, Boresight>::about_y(0.1);
    FieldOfView::circle(tilted, degrees.to_radians()).unwrap()
}

fn rectangle(width_deg: f64, height_deg: f64) -> FieldOfView {
    let tilted = Rotation::<Telescope, Boresight>::about_z(0.3)
        .then(Rotation::<Boresight, Boresight>::about_x(-0.12));
    FieldOfView::rectangle(tilted, width_deg.to_radians(), height_deg.to_radians()).unwrap()
}

struct Watch<'a> {
    scan: ScanStrategy,
    field: FieldOfView,
    body: BodyTable<'a>,
}

impl Watch<'_> {
    fn angle(&self, ns: i64) -> f64 {
        let at = Instant::from_tai_ns(ns);
        let look = attitude(&self.scan, &sun(), at).unwrap();
        angle_to_field_rad(
            &self.field,
            look.inverse().apply(self.body.state(at).unwrap().direction),
        )
    }

    fn violations(&self, limit: AvoidanceLimit, end_ns: i64) -> Vec<Violation> {
        let Zone::Inside(zone) = limit.zone(&self.field) else { panic!("{limit:?} is hopeless") };
        let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(end_ns));
        let mut channels = [Channel::new(&self.scan, sun(), self.body, &zone, span)];
        let mut finder = AvoidanceFinder::new(&mut channels);
        let (mut found, mut before) = (Vec::new(), 0);
        loop {
            let step = finder.step();
            let after = finder.channels()[0].evaluations();
            assert!(after - before <= u64::from(MAX_EVALUATIONS_PER_STEP));
            before = after;
            match step {
                AvoidanceStep::Violation(violation) => found.push(violation),
                AvoidanceStep::Searched(_) => {}
                AvoidanceStep::Done => {
                    // A rectangle's search may not creep.
                    let turns = end_ns as f64 * 1e-9 / 30.0;
                    assert!((after as f64) < 1000.0 + 20.0 * turns, "{after} evaluations");
                    return found;
                }
                AvoidanceStep::Failed { error, .. } => panic!("{error:?}"),
            }
        }
    }

    /// Compares with samples that step by what the highest speed leaves, at least 50 ms.
    fn check(&self, angle_rad: f64) -> usize {
        let end_ns = DAYS * DAY_NS;
        let limit = AvoidanceLimit::new(301, angle_rad).unwrap();
        let found = self.violations(limit, end_ns);
        let parameters = self.scan.parameters();
        let fastest = parameters.precession.rate.radians_per_second().abs()
            + parameters.spin.rate.radians_per_second().abs()
            + 1e-5;
        let mut least = vec![f64::INFINITY; found.len()];
        let (mut ns, mut inside) = (0, 0);
        while ns <= end_ns {
            let angle = self.angle(ns);
            let at = Instant::from_tai_ns(ns);
            let index = found.partition_point(|violation| violation.start <= at).wrapping_sub(1);
            let here = found.get(index).filter(|violation| at <= violation.end);
            if (angle - angle_rad).abs() > EITHER_WAY_RAD {
                assert_eq!(angle < angle_rad, here.is_some(), "{angle} at {ns} for {angle_rad}");
            }
            if here.is_some() {
                inside += 1;
                least[index] = least[index].min(angle);
            }
            ns += (((angle - angle_rad).abs() / fastest * 1e9) as i64).max(50_000_000);
        }
        let mut excess = 0.0_f64;
        for (violation, least) in found.iter().zip(least) {
            for (edge, clipped) in
                [(violation.start, violation.start_clipped), (violation.end, violation.end_clipped)]
            {
                let off = self.angle(edge.tai_ns()) - angle_rad;
                assert!(
                    clipped || off.abs() < EITHER_WAY_RAD,
                    "{off:e} at an edge of {violation:?}"
                );
            }
            let closest = self.angle(violation.closest.tai_ns());
            assert!((closest - violation.least_angle_rad).abs() < 1e-10, "{violation:?}");
            assert!(violation.least_angle_rad < angle_rad + EITHER_WAY_RAD, "{violation:?}");
            if matches!(self.field.shape(), FieldShape::Circle(_)) {
                assert!(violation.least_angle_rad < least + 1e-9, "{least} below {violation:?}");
            } else {
                excess = excess.max(violation.least_angle_rad - least);
            }
        }
        println!("least angle above the sampled by at most {excess:e} rad");
        assert!(found.windows(2).all(|pair| pair[0].end < pair[1].start));
        assert!(inside > 0 || found.is_empty() || angle_rad < 0.01);
        found.len()
    }
}

const STRATEGIES: [Plain; 4] = [
    Plain::LITEBIRD,
    Plain { signs: (-1, 1), ..Plain::LITEBIRD },
    Plain {
        alpha_deg: 22.5,
        beta_deg: 70.0,
        precession_ns: 3_600_000_000_000,
        spin_ns: 129_000_000_000,
        signs: (1, -1),
        ..Plain::LITEBIRD
    },
    Plain { precession_ns: 600_000_000_000, spin_ns: 7_200_000_000_000, ..Plain::LITEBIRD },
];

/// Every strategy against a body and limits in degrees; returns how many violations there were.
fn run(bytes: &[u8], number: i32, field: &FieldOfView, limits_deg: &[f64]) -> usize {
    let body = EphemerisTable::parse(bytes).unwrap().body(number).unwrap();
    let mut count = 0;
    for plain in STRATEGIES {
        let watch = Watch { scan: plain.strategy(), field: *field, body };
        for degrees in limits_deg {
            count += watch.check(degrees.to_radians());
        }
    }
    count
}

#[test]
fn a_circle_against_the_moon() {
    assert!(run(&moon(), 301, &circle(9.0), &[0.05, 5.0, 30.0, 70.0, 95.0, 140.0]) > 2_000);
}

#[test]
// REQ-AVOID-1.
fn a_focal_plane_against_the_moon() {
    let field = rectangle(18.0, 8.0);
    assert!(run(&moon(), 301, &field, &[0.05, 1.0, 5.0, 30.0, 70.0, 89.9, 90.1, 110.0]) > 2_000);
}

#[test]
fn a_wide_focal_plane_against_the_moon() {
    assert!(run(&moon(), 301, &rectangle(100.0, 30.0), &[2.0, 40.0, 60.0, 100.0]) > 1_000);
}

#[test]
fn sun_and_earth() {
    // LiteBIRD's boresight stays 85 deg from the Sun: limits on both sides of that.
    for field in [circle(9.0), rectangle(18.0, 8.0)] {
        run(&sun_as_target(), SUN_AS_TARGET, &field, &[20.0, 60.0, 76.0, 95.0, 120.0]);
        run(&earth(), 399, &field, &[20.0, 60.0, 76.0, 95.0, 120.0]);
    }
}

#[test]
// REQ-AVOID-1.
fn the_angle_to_a_rectangle_is_that_to_its_nearest_point() {
    let mut noise = Noise::new(3);
    for (width, height) in [(18.0, 8.0), (1.0, 170.0), (120.0, 90.0), (0.01, 0.02), (175.0, 175.0)]
    {
        let field = rectangle(width, height);
        let frame = Rotation::<Telescope, Boresight>::about_z(0.3)
            .then(Rotation::<Boresight, Boresight>::about_x(-0.12));
        let (w, h) = (0.5_f64 * f64::to_radians(width), 0.5 * f64::to_radians(height));
        // Points of the four sides, evenly spaced in angle along each.
        let samples = 4_000;
        let mut outline = Vec::new();
        for k in 0..=samples {
            let share = 2.0 * f64::from(k) / f64::from(samples) - 1.0;
            let along_y = (w.tan() * h.cos()).atan() * share;
            let along_x = (h.tan() * w.cos()).atan() * share;
            for sign in [-1.0, 1.0] {
                let (s, c) = along_y.sin_cos();
                outline.push(Direction::new(sign * h.sin() * c, s, h.cos() * c).unwrap());
                let (s, c) = along_x.sin_cos();
                outline.push(Direction::new(s, sign * w.sin() * c, w.cos() * c).unwrap());
            }
        }
        let outline: Vec<_> = outline.into_iter().map(|point| frame.apply(point)).collect();
        for _ in 0..300 {
            let mut number = || noise.signed();
            let Some(direction) = Direction::new(number(), number(), number()) else { continue };
            let dense = outline.iter().map(|p| p.separation_rad(direction)).fold(9.0, f64::min);
            let angle = angle_to_field_rad(&field, direction);
            if field.contains(direction) {
                assert!(angle.abs() < 1e-15);
            } else {
                assert!(angle <= dense + 1e-12 && angle > dense - 1e-3, "{angle} {dense}");
                let closer = TAU / f64::from(samples);
                // The outline's nearest sample is off by at most half a spacing along a side.
                let bound = (angle * angle + closer * closer).sqrt() + 1e-12;
                assert!(
                    dense <= bound.max(angle + closer * closer / angle.max(closer)),
                    "{angle} {dense}"
                );
            }
        }
    }
}

#[test]
fn a_limit_that_nothing_can_keep_is_named() {
    let limit = |degrees: f64| AvoidanceLimit::new(301, f64::to_radians(degrees)).unwrap();
    let circle = circle(10.0);
    assert!(matches!(limit(170.0).zone(&circle), Zone::Everywhere));
    assert!(matches!(limit(169.9).zone(&circle), Zone::Inside(_)));
    let field = rectangle(18.0, 8.0);
    let corner = field.reach_rad().to_degrees();
    assert!(matches!(limit(180.0 - corner + 1e-6).zone(&field), Zone::Everywhere));
    assert!(matches!(limit(180.0 - corner - 1e-6).zone(&field), Zone::Inside(_)));
    let mut noise = Noise::new(11);
    for _ in 0..100_000 {
        let mut number = || noise.signed();
        let Some(direction) = Direction::new(number(), number(), number()) else { continue };
        assert!(angle_to_field_rad(&field, direction) <= PI - field.reach_rad() + 1e-12);
        let near = limit(40.0);
        let Zone::Inside(zone) = near.zone(&field) else { panic!("40 deg can be kept") };
        let off = angle_to_field_rad(&field, direction) - near.angle_rad();
        if off.abs() > 1e-12 {
            assert_eq!(near.is_violated(&field, direction), zone.contains(direction));
        }
    }
}

#[test]
fn angles_have_a_legal_range() {
    for bad in [0.0, -0.1, 3.2, f64::NAN] {
        let error = AvoidanceLimit::new(301, bad).unwrap_err();
        let AvoidanceError::Angle(angle) = error else { panic!("{error:?}") };
        assert_eq!(angle.to_bits(), bad.to_bits());
    }
    assert_eq!(AvoidanceLimit::new(399, PI).unwrap().body(), 399);
}
