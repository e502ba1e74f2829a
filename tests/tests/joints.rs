//! Where one series of a table follows another, a direction may jump, as an apparent direction does by
//! dv/c at a burn: the search against dense sampling about such joints, and of the avoidance zones.

use onboard_core::attitude::attitude;
use onboard_core::ephemeris::{BodyTable, EphemerisError, EphemerisTable};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::Boresight;
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, Step, Transit, TransitFinder};
use tests::{Noise, Piece, Plain, table_of, transits};

const SECOND_NS: i64 = 1_000_000_000;
const DAYS_NS: i64 = 4 * 86_400 * SECOND_NS;
const BODY: i32 = 5;
/// Where the target comes into reach.
const TARGET: [f64; 3] = [-0.2, 0.9, 0.05];

/// A burn of 10 m/s, a kilometre per second, and jumps that no burn makes.
const JUMPS_RAD: [f64; 5] = [3.34e-8, 3.34e-6, 1e-4, 1e-2, 0.2];

/// A track that drifts, in two spans that meet at `joint_ns`: the second is displaced, and faster.
fn broken(track: [[f64; 3]; 2], joint_ns: i64, jump: [f64; 3]) -> Vec<u8> {
    let piece = |start_ns: i64, end_ns: i64, by: [f64; 3], faster: f64| {
        let at = |k: usize| track[0][k] + by[k];
        let drift = |k: usize| track[1][k] * faster * (end_ns - start_ns) as f64 / DAYS_NS as f64;
        Piece {
            start_ns,
            granule_ns: (end_ns - start_ns).unsigned_abs(),
            granules: vec![vec![[at(0), at(1), at(2)], [drift(0), drift(1), drift(2)]]],
        }
    };
    table_of(BODY, &[piece(0, joint_ns, [0.0; 3], 1.0), piece(joint_ns, DAYS_NS, jump, 1.5)])
}

fn body(bytes: &[u8]) -> BodyTable<'_> {
    EphemerisTable::parse(bytes).unwrap().body(BODY).unwrap()
}

struct Case<'a> {
    scan: ScanStrategy,
    sun: SunModel<'a>,
    target: BodyTable<'a>,
    field: FieldOfView,
}

impl Case<'_> {
    fn inside(&self, ns: i64) -> bool {
        let at = Instant::from_tai_ns(ns);
        let look = attitude(&self.scan, &self.sun, at).unwrap();
        self.field.contains(look.inverse().apply(self.target.state(at).unwrap().direction))
    }

    fn found(&self, around_ns: i64) -> Vec<Transit> {
        let at = |ns: i64| Instant::from_tai_ns(ns.clamp(0, DAYS_NS));
        let span = (at(around_ns - 4_000 * SECOND_NS), at(around_ns + 4_000 * SECOND_NS));
        transits(&mut [Channel::new(&self.scan, self.sun, self.target, &self.field, span)])
    }

    /// Inside by the definition is inside a transit, about the joint and on both sides of it.
    fn check(&self, joint_ns: i64) -> u32 {
        let found = self.found(joint_ns);
        assert!(found.windows(2).all(|pair| pair[0].exit < pair[1].entry), "{found:?}");
        let near = (-600..=600).map(|k| k * 50_000_000);
        let sides = [-1_000_000, -1_000, -1, 0, 1, 1_000, 1_000_000];
        let mut jumps = 0;
        for offset in near.chain(sides) {
            let ns = joint_ns + offset;
            let at = Instant::from_tai_ns(ns);
            // A crossing without a jump may go either way within its tolerance.
            let at_an_edge = |edge: Instant| {
                let off = at.since(edge).ns().abs();
                off <= 20_000 && edge.since(Instant::from_tai_ns(joint_ns)).ns().abs() > 1
            };
            if !(0..=DAYS_NS).contains(&ns)
                || found.iter().any(|it| at_an_edge(it.entry) || at_an_edge(it.exit))
            {
                continue;
            }
            let listed = found.iter().any(|it| it.entry <= at && at <= it.exit);
            // The last instant inside before a jump is stated to the next nanosecond.
            let stated = listed && !found.iter().any(|it| it.exit == at);
            let inside = self.inside(ns);
            assert!(inside == listed || inside == stated, "{offset} ns from the joint: {found:?}");
        }
        if self.inside(joint_ns - 1) != self.inside(joint_ns) {
            jumps += 1;
        }
        jumps
    }
}

fn fields() -> [FieldOfView; 3] {
    let identity = Rotation::<Boresight, Boresight>::IDENTITY;
    let rectangle = FieldOfView::rectangle(identity, 0.3, 0.14).unwrap();
    [FieldOfView::circle(identity, 0.02).unwrap(), rectangle, rectangle.enlarged(0.4).unwrap()]
}

const SUN_TRACK: [[f64; 3]; 2] = [[0.6, 0.8, 0.0], [-0.03, 0.02, 1e-4]];

/// Joints at the instants about the transits of the unbroken track, where a jump matters most.
fn run(plain: Plain, sun_breaks: bool) {
    let scan = plain.strategy();
    let mut noise = Noise::new(41);
    let (mut jumps, mut tried) = (0, 0);
    for field in fields() {
        let whole_sun = broken(SUN_TRACK, DAYS_NS / 2, [0.0; 3]);
        let whole = broken([TARGET, [0.01, 0.0, 0.01]], DAYS_NS / 2, [0.0; 3]);
        let sun = SunModel::Table(body(&whole_sun));
        let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(DAYS_NS));
        let undisturbed = transits(&mut [Channel::new(&scan, sun, body(&whole), &field, span)]);
        assert!(undisturbed.len() > 3);
        for jump_rad in JUMPS_RAD {
            for _ in 0..16 {
                let index = (noise.bits() % undisturbed.len() as u64) as usize;
                let transit = undisturbed[index];
                let edge = if noise.unit() < 0.5 { transit.entry } else { transit.exit };
                // As far from the edge as the jump carries the target across it, or so.
                let per_second = 0.003;
                let offset_s = 2.0 * noise.signed() * (jump_rad / per_second).min(20.0);
                let joint_ns =
                    (edge.tai_ns() + (offset_s * 1e9) as i64).clamp(SECOND_NS, DAYS_NS - SECOND_NS);
                let jump = [(); 3].map(|()| jump_rad * noise.signed());
                let (sun_jump, target_jump) =
                    if sun_breaks { (jump, [0.0; 3]) } else { ([0.0; 3], jump) };
                let sun_joint_ns = if sun_breaks { joint_ns } else { DAYS_NS / 2 };
                let target_joint_ns = if sun_breaks { DAYS_NS / 2 } else { joint_ns };
                let suns = broken(SUN_TRACK, sun_joint_ns, sun_jump);
                let targets = broken([TARGET, [0.01, 0.0, 0.01]], target_joint_ns, target_jump);
                let case =
                    Case { scan, sun: SunModel::Table(body(&suns)), target: body(&targets), field };
                jumps += case.check(joint_ns);
                tried += 1;
            }
        }
    }
    assert!(jumps * 8 > tried, "{jumps} jumps across an edge of {tried}");
}

#[test]
// REQ-TRANSIT-3.
fn a_target_that_jumps() {
    run(Plain::LITEBIRD, false);
    run(Plain { precession_ns: 900_000_000_000, ..Plain::PICO }, false);
}

#[test]
// REQ-TRANSIT-3.
fn a_sun_that_jumps() {
    run(Plain::LITEBIRD, true);
}

#[test]
// REQ-TRANSIT-3.
fn a_jump_into_the_field_is_an_entry_at_the_joint() {
    // From the far side of the sky to the line of sight, in the middle of a long skip.
    let scan = Plain::LITEBIRD.strategy();
    let suns = broken(SUN_TRACK, DAYS_NS / 2, [0.0; 3]);
    let sun = SunModel::Table(body(&suns));
    let joint_ns = DAYS_NS / 3;
    let joint = Instant::from_tai_ns(joint_ns);
    let look = attitude(&scan, &sun, joint).unwrap();
    let [x, y, z] = look.apply(onboard_core::direction::Direction::Z).xyz();
    let far = [-0.6, -0.8, 0.0];
    let bytes = broken([far, [0.0; 3]], joint_ns, [x - far[0], y - far[1], z - far[2]]);
    let target = body(&bytes);
    for field in fields() {
        let case = Case { scan, sun, target, field };
        let found = case.found(joint_ns);
        assert!(found.iter().any(|it| it.entry == joint && !it.entry_clipped), "{found:?}");
    }
}

#[test]
// REQ-EPH-3.
fn a_gap_between_spans_is_told_of_not_passed_over() {
    let scan = Plain::LITEBIRD.strategy();
    let suns = broken(SUN_TRACK, DAYS_NS / 2, [0.0; 3]);
    let sun = SunModel::Table(body(&suns));
    let piece = |start_ns: i64| Piece {
        start_ns,
        granule_ns: 86_400 * SECOND_NS.unsigned_abs(),
        granules: vec![vec![[-0.6, -0.8, 0.0]]],
    };
    let bytes = table_of(BODY, &[piece(0), piece(2 * 86_400 * SECOND_NS)]);
    let target = body(&bytes);
    let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(3 * 86_400 * SECOND_NS));
    let mut channels = [Channel::new(&scan, sun, target, &fields()[0], span)];
    let mut finder = TransitFinder::new(&mut channels);
    let error = loop {
        match finder.step() {
            Step::Failed { error, .. } => break error,
            Step::Done => panic!("the gap was passed over"),
            Step::Transit(_) | Step::Searched(_) => {}
        }
    };
    let after = Instant::from_tai_ns(86_400 * SECOND_NS + 1);
    assert_eq!(error, EphemerisError::OutOfSpan(after));
}
