//! No transit missed, none invented: the finder against dense sampling, every preset.
//!
//! The oracle shares nothing with the finder but the attitude: it samples the separation at a
//! hundredth of the longest dwell wherever the line of sight comes near, finds every minimum and
//! narrows it down.
//!
//! Requirements: REQ-TRANSIT-1.

use onboard_core::attitude::attitude;
use onboard_core::detector::detector_at;
use onboard_core::direction::Direction;
use onboard_core::ephemeris::{BodyTable, EphemerisTable};
use onboard_core::field_of_view::FieldOfView;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::{Phase, Rotor};
use onboard_core::rotation::Rotation;
use onboard_core::scan::ScanStrategy;
use onboard_core::sun::SunModel;
use onboard_core::time::Instant;
use onboard_core::transit::{Channel, Transit};
use tests::{Noise, Plain, table, transits, turn_rate};

const RADIUS_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// A minimum this close to the radius may go either way (`docs/conventions.md`).
const EITHER_WAY_RAD: f64 = 1e-9;
const DAY_NS: i64 = 86_400_000_000_000;

fn sun() -> SunModel<'static> {
    SunModel::Circular(Rotor {
        rate: turn_rate(31_557_600_000_000_000, 1),
        start: Phase::from_radians(0.3),
    })
}

struct Case {
    scan: ScanStrategy,
    detector: Rotation<Detector, Boresight>,
}

impl Case {
    fn separation(&self, target: BodyTable<'_>, ns: i64) -> f64 {
        let at = Instant::from_tai_ns(ns);
        let look = self.detector.then(attitude(&self.scan, &sun(), at).unwrap());
        look.apply(Direction::Z).separation_rad(target.state(at).unwrap().direction)
    }

    /// Instant and depth of every approach within the radius, by dense sampling.
    fn dense(&self, target: BodyTable<'_>, end_ns: i64) -> Vec<(i64, f64)> {
        let parameters = self.scan.parameters();
        let fastest = parameters.precession.rate.radians_per_second().abs()
            + parameters.spin.rate.radians_per_second().abs()
            + 1e-5;
        // At the highest speed the diameter takes a hundred samples.
        let step = (2.0 * RADIUS_RAD / fastest / 100.0 * 1e9) as i64;
        let samples = 120;
        let mut found = Vec::new();
        let mut block = 0;
        while block < end_ns {
            let middle = block + step * samples / 2;
            let reach = fastest * (step * (samples / 2 + 2)) as f64 * 1e-9;
            let middle = self.separation(target, middle.min(end_ns));
            // The separation cannot change faster than the fastest sweep: skip what it rules out.
            let spare = middle - RADIUS_RAD - reach;
            if spare > 0.0 {
                let blocks = (spare / fastest * 1e9) as i64 / (step * samples) + 1;
                block += blocks * step * samples;
                continue;
            }
            let value = |j: i64| self.separation(target, block + j * step);
            let (mut before, mut here) = (value(-1), value(0));
            for j in 0..samples {
                let after = value(j + 1);
                if here <= before && here < after && block + j * step < end_ns {
                    let (ns, depth) = self.minimum(target, block + j * step, step);
                    if depth < RADIUS_RAD + EITHER_WAY_RAD && (0..=end_ns).contains(&ns) {
                        found.push((ns, depth));
                    }
                }
                (before, here) = (here, after);
            }
            block += step * samples;
        }
        found
    }

    fn minimum(&self, target: BodyTable<'_>, around: i64, step: i64) -> (i64, f64) {
        let (mut low, mut high) = (around - step, around + step);
        while high - low > 100 {
            let third = (high - low) / 3;
            let (a, b) = (low + third, high - third);
            if self.separation(target, a) < self.separation(target, b) { high = b } else { low = a }
        }
        let middle = low + (high - low) / 2;
        (middle, self.separation(target, middle))
    }

    fn found(&self, target: BodyTable<'_>, end_ns: i64) -> Vec<Transit> {
        let field = FieldOfView::circle(self.detector, RADIUS_RAD).unwrap();
        let span = (Instant::from_tai_ns(0), Instant::from_tai_ns(end_ns));
        transits(&mut [Channel::new(&self.scan, sun(), target, &field, span)])
    }

    /// Compares both lists; returns how many transits there were.
    fn check(&self, target: BodyTable<'_>, end_ns: i64) -> usize {
        let found = self.found(target, end_ns);
        let sure = |depth: f64| depth < RADIUS_RAD - EITHER_WAY_RAD;
        let dense = self.dense(target, end_ns);
        for (ns, depth) in dense.iter().filter(|(_, depth)| sure(*depth)) {
            let hit = found
                .iter()
                .any(|t| t.entry.tai_ns() <= *ns + 1_000_000 && t.exit.tai_ns() >= *ns - 1_000_000);
            assert!(hit, "missed: {ns} ns, {depth} rad");
        }
        for transit in &found {
            let whole = !transit.entry_clipped && !transit.exit_clipped;
            let real = dense.iter().any(|(ns, depth)| {
                (transit.closest.tai_ns() - ns).abs() < 2_000_000
                    && (transit.min_separation_rad - depth).abs() < 1e-10
            });
            assert!(real || !whole, "invented: {transit:?}");
            if whole {
                for edge in [transit.entry, transit.exit] {
                    let off = self.separation(target, edge.tai_ns()) - RADIUS_RAD;
                    assert!(off.abs() < 1e-10, "{off:e} at the edge of {transit:?}");
                }
            }
        }
        let ordered = found.windows(2).all(|pair| pair[0].exit < pair[1].entry);
        assert!(ordered, "transits overlap");
        found.len()
    }
}

/// Runs targets one after another until a thousand transits are compared.
fn a_thousand(plain: Plain, offset_deg: f64, days: i64) {
    let case = Case {
        scan: plain.strategy(),
        detector: detector_at(
            offset_deg.abs().to_radians(),
            if offset_deg < 0.0 { std::f64::consts::PI } else { 0.0 },
            0.4,
        ),
    };
    let end_ns = days * DAY_NS;
    let mut noise = Noise::new(offset_deg.to_bits());
    let mut count = 0;
    for target in 0..100_000 {
        // Directions all over the sky, drifting by up to 50 deg over the span.
        let mut number = || noise.signed();
        let Some(direction) = Direction::<Boresight>::new(number(), number(), number()) else {
            continue;
        };
        let drift = 0.25;
        let [x, y, z] = direction.xyz();
        let rate = [drift * number(), drift * number(), drift * number()];
        let bytes = table(4, 0, u64::try_from(end_ns).unwrap(), &[vec![[x, y, z], rate]]);
        let body = EphemerisTable::parse(&bytes).unwrap().body(4).unwrap();
        count += case.check(body, end_ns);
        if count >= 1_000 {
            return;
        }
        assert!(target < 99_999, "only {count} transits");
    }
}

macro_rules! presets {
    ($($name:ident: $plain:expr, $days:expr;)*) => {
        $(
            #[test]
            fn $name() {
                for offset_deg in [0.0, 14.0, -14.0] {
                    a_thousand($plain, offset_deg, $days);
                }
            }
        )*
    };
}

presets! {
    litebird: Plain::LITEBIRD, 60;
    litebird_reversed: Plain { signs: (-1, 1), ..Plain::LITEBIRD }, 60;
    pico: Plain::PICO, 20;
    planck: Plain::PLANCK, 10;
    epic: Plain {
        alpha_deg: 45.0, beta_deg: 55.0,
        precession_ns: 11_520_000_000_000, spin_ns: 60_000_000_000,
        ..Plain::LITEBIRD
    }, 10;
    core: Plain {
        alpha_deg: 30.0, beta_deg: 65.0,
        precession_ns: 345_600_000_000_000, spin_ns: 120_000_000_000,
        ..Plain::LITEBIRD
    }, 20;
    wmap: Plain {
        alpha_deg: 22.5, beta_deg: 70.0,
        precession_ns: 3_600_000_000_000, spin_ns: 129_000_000_000,
        signs: (1, -1),
        ..Plain::LITEBIRD
    }, 10;
    precession_faster_than_spin: Plain {
        precession_ns: 600_000_000_000, spin_ns: 7_200_000_000_000,
        ..Plain::LITEBIRD
    }, 20;
}
