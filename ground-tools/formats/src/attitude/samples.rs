//! Which way does a line of sight's frame point at the samples of a file, and how far apart may they
//! be.
//!
//! Quaternions (x, y, z, w) take components in that frame to components in ICRF. Body rates are its
//! angular velocity against ICRF, components in the frame itself, rad/s. A plan's frame is the mission
//! boresight's.
//!
//! Method: samples lie at whole multiples of the step on the onboard clock (ns of TAI), so that
//! every product and every span shares them; a span's ends at the mission's edges are whole
//! microseconds. Between two samples an interpolation that turns uniformly (slerp) differs from the
//! true rotation by a vector e with e = 0 at both ends and |e''| <= M, so |e| <= h^2 M / 8. With w the
//! body's angular velocity, W its largest derivative and x = h |w|, e' = w - e^(-e) `w_slerp` to first
//! order, whence M <= W / (1 - x/2 - 0.15 h^2 M): M <= 1.001 W (1 + x) for x <= 1/4 and errors below
//! a minute of arc. W comes from `w' = f' + f x (w_a n + w_b s) + w_a w_b n x s`, f the anti-Sun
//! frame's rate, n the anti-Sun axis, s the spin axis.
//!
//! Limits: the attitude follows the Sun model given: for a plan the table that goes on board (1 mas),
//! for `pointing` the ephemeris. Steps are at least 1 ms.

use mission::Product;
use onboard_core::attitude::attitude;
use onboard_core::direction::MotionBounds;
use onboard_core::frame::{Boresight, Detector, Ecliptic, Icrf};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::{AntiSunAxes, SunModel};
use onboard_core::time::{Duration, Instant};
use planner::provenance::Provenance;
use planner::world::TableFault;
use rayon::prelude::*;
use thiserror::Error;

/// Samples that are made together.
const CHUNK: usize = 1 << 15;
/// Samples that one thread makes at a time; a session has some thousand.
const PIECE: usize = 1 << 8;
/// Largest turn between two samples, in radians.
const LARGEST_TURN_RAD: f64 = 0.25;
const US_NS: i64 = 1000;
const MS_NS: i64 = 1_000_000;
const SECOND_NS: i64 = 1_000_000_000;

/// Where attitudes come from.
#[derive(Debug, Clone, Copy)]
pub struct Motion<'m> {
    /// The scanning strategy.
    pub scan: &'m ScanStrategy,
    /// The Sun model.
    pub sun: SunModel<'m>,
    /// The line of sight's frame in the mission boresight's.
    pub frame: Rotation<Detector, Boresight>,
}

/// What files of attitudes are made from.
#[derive(Debug, Clone, Copy)]
pub struct Attitudes<'m> {
    /// Originator and object.
    pub product: &'m Product,
    /// Where it comes from.
    pub provenance: &'m Provenance,
    /// When the files say they were made.
    pub stamp: Instant,
    /// Attitudes.
    pub motion: Motion<'m>,
    /// How far samples are apart.
    pub step: Step,
}

/// An attitude and how it changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// When.
    pub at: Instant,
    /// The frame to ICRF, (x, y, z, w).
    pub quaternion: [f64; 4],
    /// Angular velocity in rad/s, components in the frame.
    pub body_rate_rad_s: [f64; 3],
}

/// How far samples are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Their distance, whole milliseconds.
    pub step: Duration,
    /// Bound on what slerp between them misses, in radians.
    pub error_rad: f64,
}

/// A step between samples that is not legal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error(
    "whole milliseconds from 0.001 to {} s are needed, so that no step turns by more than {LARGEST_TURN_RAD} rad",
    longest.seconds()
)]
pub struct StepError {
    /// The longest legal step.
    pub longest: Duration,
}

impl Motion<'_> {
    /// The attitude at `at`, w >= 0.
    ///
    /// # Errors
    /// [`TableFault`] beyond the Sun's table.
    pub fn sample(&self, at: Instant) -> Result<Sample, TableFault> {
        let to_icrf = Rotation::<Icrf, Ecliptic>::by_obliquity().inverse();
        let rotation = self.frame.then(attitude(self.scan, &self.sun, at)?);
        let parameters = self.scan.parameters();
        let state = self.sun.state(parameters.start, at)?;
        let axes = AntiSunAxes::new(&state);
        let [fx, fy, fz] = axes.angular_velocity_rad_s();
        let spin_to_anti_sun = self.scan.spin_in_anti_sun(at);
        let [sx, sy, sz] = turned(spin_to_anti_sun.to_xyzw(), [0.0, 0.0, 1.0]);
        let spin = parameters.spin.rate.radians_per_second();
        let precession = parameters.precession.rate.radians_per_second();
        // omega = f + w_a z + w_b s in the anti-Sun frame, then into the line of sight's.
        let omega = [fx + spin * sx, fy + spin * sy, fz + precession + spin * sz];
        let boresight = self.scan.boresight_in_spin().then(spin_to_anti_sun);
        let to_body = self.frame.then(boresight).inverse();
        Ok(Sample {
            at,
            quaternion: rotation.then(to_icrf).to_xyzw(),
            body_rate_rad_s: turned(to_body.to_xyzw(), omega),
        })
    }

    /// The largest step at which slerp errs by at most `error_rad` (below a minute of arc).
    #[must_use]
    pub fn step(&self, error_rad: f64) -> Step {
        // The error grows with the step: the largest by halving.
        let (mut below, mut above) = (0.0, self.longest_step_s());
        if self.error_rad(above) <= error_rad {
            below = above;
        } else {
            for _ in 0..60 {
                let middle = 0.5 * (below + above);
                if self.error_rad(middle) <= error_rad { below = middle } else { above = middle }
            }
        }
        let ns = Duration::from_seconds_floor(below).ns();
        let unit = if ns >= SECOND_NS { SECOND_NS } else { MS_NS };
        let step = Duration::from_ns((ns / unit * unit).max(MS_NS));
        Step { step, error_rad: self.error_rad(step.seconds()) }
    }

    /// A step that someone chose, with what slerp then misses.
    ///
    /// # Errors
    /// [`StepError`]: whole milliseconds up to the longest for which the bound holds are legal.
    pub fn step_of(&self, step: Duration) -> Result<Step, StepError> {
        let longest = self.longest_step_s();
        if step.ns() < MS_NS || step.ns() % MS_NS != 0 || step.seconds() > longest {
            let longest_ms = Duration::from_seconds_floor(longest).ns() / MS_NS * MS_NS;
            return Err(StepError { longest: Duration::from_ns(longest_ms) });
        }
        Ok(Step { step, error_rad: self.error_rad(step.seconds()) })
    }

    /// The longest step, in seconds, for which [`Self::error_rad`] holds.
    fn longest_step_s(&self) -> f64 {
        LARGEST_TURN_RAD / self.bounds().0
    }

    /// Bound on what slerp over `step_s` misses, in radians.
    fn error_rad(&self, step_s: f64) -> f64 {
        let (turn, change) = self.bounds();
        0.125 * step_s * step_s * change * 1.001 * (1.0 + step_s * turn)
    }

    /// Bounds on the angular velocity (rad/s) and its change (rad/s^2).
    fn bounds(&self) -> (f64, f64) {
        let parameters = self.scan.parameters();
        let precession = parameters.precession.rate.radians_per_second().abs();
        let spin = parameters.spin.rate.radians_per_second().abs();
        let (frame, frame_change) = frame_bounds(&self.sun.bounds());
        let change = frame_change
            + frame * (precession + spin)
            + precession * spin * parameters.alpha_rad.sin();
        (frame + precession + spin, change)
    }
}

/// Bounds on the anti-Sun frame's rate (rad/s) and its change (rad/s^2).
///
/// With rho the smallest cosine of the latitude, v and a the direction's bounds: v/rho, and
/// 2 (a + 2 v^2/rho)/rho.
fn frame_bounds(sun: &MotionBounds) -> (f64, f64) {
    let rho = (1.0 - sun.max_abs_z * sun.max_abs_z).max(1e-12).sqrt();
    let v = sun.rate_rad_s;
    (v / rho, 2.0 * (sun.acceleration_per_s2 + 2.0 * v * v / rho) / rho)
}

/// q v q*.
#[must_use]
pub fn turned(quaternion: [f64; 4], vector: [f64; 3]) -> [f64; 3] {
    let [x, y, z, w] = quaternion;
    let axis = [x, y, z];
    // v + 2 w (u x v) + u x 2 (u x v), u the quaternion's vector.
    let twice = cross(axis, vector).map(|it| 2.0 * it);
    let across = cross(axis, twice);
    std::array::from_fn(|index| vector[index] + w * twice[index] + across[index])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The samples of one unbroken span, and whose they are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Span {
    /// Its first sample.
    pub first: Instant,
    /// Its last sample.
    pub last: Instant,
    /// What it covers: start and end of each session, padding aside.
    pub covered: (Instant, Instant),
    /// The sessions in it, by position in the timeline.
    pub sessions: Vec<usize>,
}

impl Span {
    /// The whole mission, no session named.
    #[must_use]
    pub fn whole((start, end): (Instant, Instant)) -> Self {
        let (first, last) = inside(start, end);
        Self { first, last, covered: (first, last), sessions: Vec::new() }
    }

    /// Spans of sessions (start and end, by start), each padded by one step at least; those that
    /// meet are one.
    #[must_use]
    pub fn of_sessions(
        sessions: &[(Instant, Instant)],
        mission: (Instant, Instant),
        step: Duration,
    ) -> Vec<Self> {
        let (start, end) = inside(mission.0, mission.1);
        let step = step.ns();
        let mut spans: Vec<Self> = Vec::new();
        for (index, &(from, until)) in sessions.iter().enumerate() {
            let below = from.tai_ns().div_euclid(step).saturating_sub(1).saturating_mul(step);
            let above = until.tai_ns().div_euclid(step).saturating_add(2).saturating_mul(step);
            let first = Instant::from_tai_ns(below).max(start);
            let last = Instant::from_tai_ns(above).min(end);
            let covered = (from.max(start), until.min(end));
            match spans.last_mut().filter(|span| first <= span.last) {
                Some(span) => {
                    span.last = span.last.max(last);
                    span.covered.1 = span.covered.1.max(covered.1);
                    span.sessions.push(index);
                }
                None => spans.push(Self { first, last, covered, sessions: vec![index] }),
            }
        }
        spans
    }

    /// How many samples it has.
    #[must_use]
    pub fn count(&self, step: Duration) -> usize {
        let within = self.last_multiple(step) - self.first_multiple(step) + 1;
        let first = self.first.tai_ns() < self.first_multiple(step) * step.ns();
        let last = self.last.tai_ns() > self.last_multiple(step) * step.ns();
        usize::try_from(within).unwrap_or(0) + usize::from(first) + usize::from(last)
    }

    /// When its samples are: multiples of the step, and both ends.
    pub fn instants(&self, step: Duration) -> impl Iterator<Item = Instant> + Clone + use<> {
        let (from, until) = (self.first_multiple(step), self.last_multiple(step));
        let (first, last, ns) = (self.first, self.last, step.ns());
        let head = (first.tai_ns() < from * ns).then_some(first);
        let tail = (last.tai_ns() > until * ns).then_some(last);
        let within = (from..=until).map(move |index| Instant::from_tai_ns(index * ns));
        head.into_iter().chain(within).chain(tail)
    }

    fn first_multiple(&self, step: Duration) -> i64 {
        -(-self.first.tai_ns()).div_euclid(step.ns())
    }

    fn last_multiple(&self, step: Duration) -> i64 {
        self.last.tai_ns().div_euclid(step.ns())
    }
}

/// Whole microseconds inside a mission.
fn inside(start: Instant, end: Instant) -> (Instant, Instant) {
    let up = -(-start.tai_ns()).div_euclid(US_NS) * US_NS;
    let down = end.tai_ns().div_euclid(US_NS) * US_NS;
    (Instant::from_tai_ns(up), Instant::from_tai_ns(down))
}

/// Makes samples in their order and hands each chunk of them on, in memory that does not grow.
///
/// Signs: w >= 0 at the first instant, then that which lies nearer to the quaternion before.
///
/// # Errors
/// What `take` says, or a sample cannot be made.
pub fn sampled<E: From<TableFault>>(
    motion: &Motion<'_>,
    mut instants: impl Iterator<Item = Instant>,
    mut take: impl FnMut(&[Sample]) -> Result<(), E>,
) -> Result<(), E> {
    let mut before: Option<[f64; 4]> = None;
    loop {
        let chunk: Vec<Instant> = instants.by_ref().take(CHUNK).collect();
        if chunk.is_empty() {
            return Ok(());
        }
        let made: Result<Vec<Sample>, TableFault> =
            chunk.par_iter().with_min_len(PIECE).map(|&at| motion.sample(at)).collect();
        let mut samples = made?;
        for sample in &mut samples {
            let other_side = before.is_some_and(|q| dot(q, sample.quaternion) < 0.0);
            if other_side {
                sample.quaternion = sample.quaternion.map(|it| -it);
            }
            before = Some(sample.quaternion);
        }
        take(&samples)?;
    }
}

fn dot(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Text of samples, each piece made by one thread; the pieces in order.
pub fn lines(samples: &[Sample], write: impl Fn(&mut String, &Sample) + Sync) -> Vec<String> {
    let piece = |samples: &[Sample]| {
        let mut text = String::with_capacity(160 * samples.len());
        for sample in samples {
            write(&mut text, sample);
        }
        text
    };
    samples.par_chunks(PIECE).map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mission::Mission;
    use onboard_core::ephemeris::EphemerisTable;
    use planner::world::World;
    use proptest::prelude::*;

    /// Angle between two attitudes.
    fn apart(a: [f64; 4], b: [f64; 4]) -> f64 {
        let flip = if dot(a, b) < 0.0 { -1.0 } else { 1.0 };
        let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - flip * b).powi(2)).sum();
        4.0 * (0.5 * difference.sqrt()).asin()
    }

    fn slerp(a: [f64; 4], b: [f64; 4], part: f64) -> [f64; 4] {
        let half = 0.5 * apart(a, b);
        if half < 1e-9 {
            return a;
        }
        let (p, q) = ((half * (1.0 - part)).sin() / half.sin(), (half * part).sin() / half.sin());
        std::array::from_fn(|index| p * a[index] + q * b[index])
    }

    fn with_motion(preset: &str, check: impl Fn(&World, &Motion<'_>)) {
        let overrides = ["span.duration_days=20"].map(|it| mission::Override::set(it).unwrap());
        let mut world = World::open(Mission::load(preset, &overrides).unwrap(), None).unwrap();
        world.targets.clear();
        let tables = world.tables(&world.ground_options()).unwrap();
        let table: EphemerisTable<'_> = tables.parse().unwrap();
        let sun = world.sun(table).unwrap();
        check(&world, &Motion { scan: &world.scan, sun, frame: Rotation::IDENTITY });
    }

    #[test]
    fn slerp_between_samples_keeps_its_bound_and_uses_most_of_it() {
        for preset in ["litebird", "pico", "planck", "wmap", "core"] {
            with_motion(preset, |world, motion| {
                for arcsec in [0.01, 1.0, 60.0_f64] {
                    let bound = (arcsec / 3600.0).to_radians();
                    let Step { step, error_rad } = motion.step(bound);
                    assert!(error_rad <= bound, "{preset} {arcsec}");
                    let mut worst = 0.0_f64;
                    for place in 0..400_i64 {
                        let ns = world.start.tai_ns() + place * 4_000_000_000_007;
                        let at = |part: f64| {
                            let offset = Duration::from_seconds(part * step.seconds());
                            motion.sample(Instant::from_tai_ns(ns).plus(offset)).unwrap().quaternion
                        };
                        let (a, b) = (at(0.0), at(1.0));
                        let b = if dot(a, b) < 0.0 { b.map(|it| -it) } else { b };
                        for part in [0.1, 0.3, 0.5, 0.62, 0.9] {
                            worst = worst.max(apart(slerp(a, b, part), at(part)));
                        }
                    }
                    assert!(worst <= error_rad + 1e-15, "{preset} {arcsec}: {worst} {error_rad}");
                    // 1 + x is at most 1.25: where precession times spin leads, the rest is used.
                    let used = worst / error_rad;
                    assert!(preset != "litebird" || used > 0.79, "{preset} {arcsec}: {used}");
                }
            });
        }
    }

    #[test]
    fn body_rates_are_the_derivative_of_the_attitude() {
        with_motion("litebird", |world, motion| {
            for place in 1..200_i64 {
                let at = world.start.plus(Duration::from_ns(place * 8_000_000_000_009));
                let half = Duration::from_ns(50_000_000);
                let [before, after] = [-1, 1].map(|side| {
                    let at = at.plus(Duration::from_ns(side * half.ns()));
                    motion.sample(at).unwrap().quaternion
                });
                let here = motion.sample(at).unwrap();
                // 2 q* q' is (omega, 0) with omega in the body.
                let sign = |q: [f64; 4]| {
                    if dot(q, here.quaternion) < 0.0 { q.map(|it| -it) } else { q }
                };
                let (before, after) = (sign(before), sign(after));
                let rate: [f64; 4] = std::array::from_fn(|i| (after[i] - before[i]) / 0.1);
                let ([x, y, z, w], [dx, dy, dz, dw]) = (here.quaternion, rate);
                let omega = [
                    2.0 * (w * dx - x * dw - y * dz + z * dy),
                    2.0 * (w * dy - y * dw - z * dx + x * dz),
                    2.0 * (w * dz - z * dw - x * dy + y * dx),
                ];
                for (found, expected) in here.body_rate_rad_s.iter().zip(omega) {
                    assert!((found - expected).abs() < 2e-11, "{found} {expected}");
                }
            }
        });
    }

    proptest! {
        #[test]
        fn spans_cover_their_sessions_without_touching(
            starts in prop::collection::vec((0..100_000_i64, 1..3000_i64), 0..30),
            edge in 0..2_000_000_000_i64,
            ms in 1..9000_i64,
        ) {
            let step = Duration::from_ns(ms * MS_NS);
            let at = |s: i64| Instant::from_tai_ns(s * SECOND_NS + 123_456_789);
            let mut sessions: Vec<_> = starts.iter().map(|&(s, l)| (at(s), at(s + l))).collect();
            sessions.sort();
            let mission = (Instant::from_tai_ns(edge), at(104_000));
            sessions.retain(|it| it.0 >= mission.0);
            let spans = Span::of_sessions(&sessions, mission, step);
            prop_assert_eq!(spans.iter().map(|it| it.sessions.len()).sum::<usize>(), sessions.len());
            for span in &spans {
                let instants: Vec<Instant> = span.instants(step).collect();
                prop_assert_eq!(instants.len(), span.count(step));
                prop_assert_eq!((instants[0], instants[instants.len() - 1]), (span.first, span.last));
                let close = |pair: &[Instant]| {
                    pair[0] < pair[1] && pair[1].since(pair[0]).ns() <= step.ns()
                };
                prop_assert!(instants.windows(2).all(close));
                for &index in &span.sessions {
                    prop_assert!(span.first.tai_ns() - sessions[index].0.tai_ns() < US_NS);
                    prop_assert!(span.last >= sessions[index].1);
                }
            }
            prop_assert!(spans.windows(2).all(|pair| pair[0].last < pair[1].first));
        }
    }
}
