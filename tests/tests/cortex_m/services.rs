//! Measured attitudes with outliers, stale ones and ones out of order; visits; bright bodies.

use crate::input::{Input, NS_PER_DAY, ONE_MONTH, Tables, channel, container, sized, world};
use ephem::fit::FitOptions;
use onboard_core::attitude::attitude;
use onboard_core::ephemeris::EphemerisTable;
use onboard_core::frame::Boresight;
use onboard_core::rotation::Rotation;
use onboard_core::time::Duration;
use planner::world::World;
use tests::Noise;
use tests::attitudes::{MINUTE_NS, NOISE_RAD, SETTINGS, Truth, shaken};

/// Measurements of a day, every ten minutes.
const MEASUREMENTS: i64 = 145;
const AS_TARGETS: &str = "calibration.targets=[\"jupiter\"]";
const AVOIDED: &str = "calibration.schedule.avoidance=[\
     { body = \"sun\", angle_deg = 30 }, { body = \"earth\", angle_deg = 30 }]";

/// Every block of these services.
pub fn blocks(tables: &Tables, input: &mut Input) {
    for (preset, setting) in
        [("litebird", "scan.spin_sign=1"), ("pico", "scan.spin_sign=-1"), ("planck", ONE_MONTH)]
    {
        let world = world(preset, &[ONE_MONTH, setting]);
        let mut block = tracked(&world, &tables.month, true);
        let epoch = world.start.tai_ns();
        let days = [0, 1, 2, 30, -1].map(|day| epoch + day * NS_PER_DAY);
        let instants: Vec<u8> = days.iter().flat_map(|ns| ns.to_le_bytes()).collect();
        block.extend(sized(&instants));
        search(&world, (1, 3), &mut block);
        input.block(8, &format!("measured attitudes of {preset}"), &block);
    }
    for (preset, alpha) in [("litebird", 1e-5), ("epic", 3e-4)] {
        let world = world(preset, &[ONE_MONTH]);
        let mut block = sized(&container(&world, &tables.month, None));
        let covariance: [f64; 6] = [1e-8, alpha * alpha, 4e-8, 1e-9, -1.9e-8, 0.0];
        // Seconds: dwells to an hour, revisits and gaps from a minute to a month.
        let bins = [0.0, 3600.0, 60.0, 2.6e6, 60.0, 2.6e6];
        block.extend(covariance.iter().chain(&bins).flat_map(|number| number.to_le_bytes()));
        search(&world, (0, 10), &mut block);
        input.block(9, &format!("visits of {preset}"), &block);
    }
    bright_bodies(input);
}

fn search(world: &World, days: (i64, i64), block: &mut Vec<u8>) {
    for day in [days.0, days.1] {
        block.extend((world.start.tai_ns() + day * NS_PER_DAY).to_le_bytes());
    }
    for body in [4, 5, 6, 7, 8] {
        channel(body, 0.5_f64.to_radians(), block);
    }
    channel(5, 0.0, block);
}

/// A container, the tracker's settings and epoch, and a day of measurements of a scan that is a
/// little off.
fn tracked(world: &World, ephemeris: &[u8], disturbed: bool) -> Vec<u8> {
    let mut noise = Noise::new(8);
    let truth = Truth::drawn(&mut noise).of(&world.scan);
    let table = EphemerisTable::parse(ephemeris).expect("a good table");
    let sun = world.sun(table).expect("the Sun is in the table");
    let epoch = world.start;
    let mut measurements = Vec::new();
    for index in 0..MEASUREMENTS {
        let mut at = epoch.plus(Duration::from_ns(10 * index * MINUTE_NS));
        let (mut now, mut sigma) = (at.plus(Duration::from_ns(MINUTE_NS)), NOISE_RAD);
        let exact = attitude(&truth, &sun, at).expect("the Sun is known");
        let mut seen = shaken(exact, NOISE_RAD, &mut noise);
        match index % 9 {
            2 if disturbed => {
                let size = 0.003 * (index as f64);
                seen = Rotation::<Boresight, Boresight>::about_x(size).then(seen);
            }
            4 if disturbed => now = now.plus(Duration::from_ns(5 * MINUTE_NS)),
            5 if disturbed => {
                at = at.plus(Duration::from_ns(-25 * MINUTE_NS));
                now = at;
            }
            6 if disturbed => now = at.plus(Duration::from_ns(-MINUTE_NS)),
            8 if disturbed => sigma = 1e-9,
            _ => {}
        }
        measurements.extend(at.tai_ns().to_le_bytes());
        measurements.extend(now.tai_ns().to_le_bytes());
        measurements.extend(sigma.to_le_bytes());
        measurements.extend(seen.to_xyzw().iter().flat_map(|number| number.to_le_bytes()));
    }
    let number = |numbers: &[f64]| -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
    };
    [
        sized(&container(world, ephemeris, None)),
        number(&SETTINGS.angle_sigmas_rad),
        number(&SETTINGS.rate_sigmas),
        number(&[1e-9; 3]),
        number(&[1e-15; 2]),
        SETTINGS.max_age.ns().to_le_bytes().to_vec(),
        SETTINGS.max_lead.ns().to_le_bytes().to_vec(),
        number(&[SETTINGS.gate]),
        number(&SETTINGS.limits_rad),
        epoch.tai_ns().to_le_bytes().to_vec(),
        sized(&measurements),
    ]
    .concat()
}

/// What the updates are counted on: a day of measurements, none refused.
pub fn metered(tables: &Tables) -> Vec<u8> {
    tracked(&world("litebird", &[ONE_MONTH]), &tables.month, false)
}

/// Sun and Earth against circles and the telescopes' own fields.
fn bright_bodies(input: &mut Input) {
    for preset in ["litebird", "pico"] {
        let world = world(preset, &["span.duration_days=5", AS_TARGETS, AVOIDED]);
        let tables = world.tables(&FitOptions::UPLINK).expect("a table");
        let mut block = sized(&container(&world, &tables.fitted.bytes, None));
        block.extend(world.start.tai_ns().to_le_bytes());
        block.extend(world.end.tai_ns().to_le_bytes());
        let mut limit = |body: i32, degrees: f64, radius_rad: f64| {
            block.extend(body.to_le_bytes());
            block.extend(degrees.to_radians().to_le_bytes());
            block.extend(0_u32.to_le_bytes());
            block.extend(radius_rad.to_le_bytes());
        };
        for (source, _) in &world.avoided {
            for degrees in [10.0, 75.0, 100.0] {
                limit(source.body(), degrees, 0.15);
                limit(source.body(), degrees, 0.0);
            }
        }
        limit(5, 40.0, 0.0);
        limit(5, 179.5, 0.15);
        input.block(10, &format!("bright bodies of {preset}"), &block);
    }
}
