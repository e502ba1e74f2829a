//! How many samples per second does the survey kernel take, beside a plain implementation.
//!
//! One table, all of it from one run: the best of several passes for each line, so that a busy machine
//! disturbs it least. `cargo test --benches` makes one short pass of each.

#![expect(clippy::print_stdout, reason = "a bench tells")]
#![expect(clippy::cast_precision_loss, reason = "rates in words")]

use onboard_core::phase::Phase;
use onboard_core::time::Instant as Epoch;
use planner::healpix::Nside;
use planner::progress::Quietly;
use planner::survey::{
    BigRational, Collector, ExactRotor, Isa, MapFrame, Moment, SampledScan, SunSource, Survey,
    SurveyDetector, SurveySun,
};
use std::f64::consts::{FRAC_2_PI, TAU};
use std::hint::black_box;
use std::time::Instant;

const HZ: u64 = 19;
const FIVE: [(f64, f64); 5] = [(1.0, 0.0), (2.0, 0.0), (4.0, 0.0), (2.0, 4.0), (4.0, 8.0)];
const NINE: [(f64, f64); 9] = [
    (1.0, 0.0),
    (2.0, 0.0),
    (3.0, 0.0),
    (4.0, 0.0),
    (1.0, 4.0),
    (2.0, 4.0),
    (-2.0, 4.0),
    (4.0, 8.0),
    (-4.0, 8.0),
];

/// So many turns in so many seconds.
fn rotor((turns, seconds): (i64, i64), start: u64) -> ExactRotor {
    let turns_per_s = BigRational::new(turns.into(), seconds.into());
    ExactRotor { turns_per_s, start: Phase::from_bits(start) }
}

/// LiteBIRD's strategy, 61 rpm.
fn seconds(
    isa: Isa,
    (nside, pairs): (u32, &[(f64, f64)]),
    (samples, threads): (u64, usize),
) -> f64 {
    let moments: Vec<Moment> = pairs.iter().filter_map(|&(n, m)| Moment::new(n, m).ok()).collect();
    let detector = SurveyDetector { plate: Some(rotor((61, 60), 0)), ..SurveyDetector::BORESIGHT };
    let Ok(nside) = Nside::new(nside) else { return f64::NAN };
    let survey = Survey {
        scan: SampledScan {
            start: Epoch::from_tai_ns(0),
            sampling_hz: BigRational::from_integer(HZ.into()),
            alpha_rad: 45_f64.to_radians(),
            beta_rad: 50_f64.to_radians(),
            precession: rotor((100, 1_154_088), 0),
            spin: rotor((1, 1200), 1 << 63),
        },
        sun: SurveySun { source: SunSource::Circular(rotor((1, 31_557_600), 0)), step: None },
        detectors: vec![detector],
        nside,
        frame: MapFrame::Ecliptic,
        moments,
    };
    let Ok(mut collector) = Collector::new(survey, isa) else { return f64::NAN };
    // The maps are made, and their pages touched, by a first pass.
    let _ = collector.collect(0..samples, threads, &Quietly);
    let before = Instant::now();
    let _ = collector.collect(0..samples, threads, &Quietly);
    let taken = before.elapsed().as_secs_f64();
    black_box(collector.finish());
    taken
}

/// The same, written down plainly: rotations of vectors one after the other, library functions, one
/// addition to the map per sample and moment.
fn plain_seconds((nside, pairs): (u32, &[(f64, f64)]), samples: u64) -> f64 {
    let pixels = 12 * nside as usize * nside as usize;
    let mut hits = vec![0.0_f64; pixels];
    let mut sums = vec![0.0_f64; pixels * pairs.len() * 2];
    let rate = |turns: f64| TAU * turns / HZ as f64;
    let (orbit, precession, spin, plate) =
        (rate(1.0 / 31_557_600.0), rate(1.0 / 11_540.88), rate(1.0 / 1200.0), rate(61.0 / 60.0));
    let about_z =
        |[x, y, z]: [f64; 3], (sin, cos): (f64, f64)| [x * cos - y * sin, x * sin + y * cos, z];
    let about_y =
        |[x, y, z]: [f64; 3], (sin, cos): (f64, f64)| [x * cos + z * sin, y, z * cos - x * sin];
    // The spin starts at half a turn.
    let half_turned = |(sin, cos): (f64, f64)| (-sin, -cos);
    let alpha = 45_f64.to_radians().sin_cos();
    let beta = 50_f64.to_radians().sin_cos();
    let before = Instant::now();
    for j in 0..samples {
        let t = j as f64;
        let turned = [orbit, precession, spin].map(|rate| (rate * t).rem_euclid(TAU).sin_cos());
        let chain = |axis: [f64; 3]| {
            let tilted = about_y(about_z(about_y(axis, beta), half_turned(turned[2])), alpha);
            let [x, y, z] = about_z(tilted, turned[1]);
            // z away from the Sun, x to the north.
            about_z([z, -y, x], turned[0])
        };
        let (n, x) = (chain([0.0, 0.0, 1.0]), chain([1.0, 0.0, 0.0]));
        let psi = x[2].atan2(x[1] * n[0] - x[0] * n[1]);
        let phi = (plate * t).rem_euclid(TAU);
        let pixel = ring_pixel(nside, n);
        hits[pixel] += 1.0;
        for (index, (order, multiple)) in pairs.iter().enumerate() {
            let phasor = (order * psi + multiple * phi).sin_cos();
            let cell = 2 * (pixel * pairs.len() + index);
            sums[cell] += phasor.1;
            sums[cell + 1] -= phasor.0;
        }
    }
    let taken = before.elapsed().as_secs_f64();
    black_box((hits, sums));
    taken
}

/// The RING pixel of a unit vector.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::many_single_char_names,
    reason = "whole parts"
)]
fn ring_pixel(nside: u32, [x, y, z]: [f64; 3]) -> usize {
    let n = i64::from(nside);
    let side = f64::from(nside);
    let t = (y.atan2(x) * FRAC_2_PI).rem_euclid(4.0);
    let pixel = if z.abs() <= 2.0 / 3.0 {
        let up = (side * (0.5 + t - 0.75 * z)) as i64;
        let down = (side * (0.5 + t + 0.75 * z)) as i64;
        let ring = n + 1 + up - down;
        let shift = 1 - (ring & 1);
        let within = ((up + down - n + shift + 1) / 2).rem_euclid(4 * n);
        2 * n * (n - 1) + (ring - 1) * 4 * n + within
    } else {
        let part = t.fract();
        let scale = side * (3.0 * (1.0 - z.abs())).sqrt();
        let west = (part * scale) as i64;
        let east = ((1.0 - part) * scale) as i64;
        let ring = west + east + 1;
        let within = ((t * ring as f64) as i64).rem_euclid(4 * ring);
        if z > 0.0 {
            2 * ring * (ring - 1) + within
        } else {
            12 * n * n - 2 * ring * (ring + 1) + within
        }
    };
    pixel as usize
}

/// Seconds of arithmetic in registers, the same on each of `threads` threads.
fn arithmetic_seconds(threads: usize, steps: u64) -> f64 {
    let before = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                let mut x = [0.1_f64, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
                for _ in 0..steps {
                    for value in &mut x {
                        *value = *value * 0.999_999 + 0.000_001;
                    }
                    black_box(&mut x);
                }
            });
        }
    });
    before.elapsed().as_secs_f64()
}

/// Name, nside and pairs of a line of the table.
type Line = (&'static str, u32, &'static [(f64, f64)]);

fn main() {
    // Cargo gives `--bench` to `cargo bench` alone.
    let test = !std::env::args().any(|argument| argument == "--bench");
    let (passes, days) = if test { (1, 1) } else { (7, 40) };
    let best =
        |measure: &dyn Fn() -> f64| (0..passes).map(|_| measure()).fold(f64::INFINITY, f64::min);
    let samples = HZ * 86_400 * days;
    let few = samples / if test { 10 } else { 20 };
    println!("one core, {HZ} Hz, M samples/s (times the plain one)");
    println!("{:<26} {:>8} {:>16} {:>16} {:>16}", "", "plain", "avx512", "avx2", "portable");
    let lines: [Line; 5] = [
        ("hits, nside 128", 128, &[]),
        ("five moments, nside 128", 128, &FIVE),
        ("five moments, nside 256", 256, &FIVE),
        ("nine moments, nside 128", 128, &NINE),
        ("nine moments, nside 256", 256, &NINE),
    ];
    for (name, nside, pairs) in lines {
        let plain = few as f64 / best(&|| plain_seconds((nside, pairs), few)) / 1e6;
        print!("{name:<26} {plain:>8.2}");
        for isa in ["avx512", "avx2", "portable"] {
            if let Ok(isa) = Isa::named(isa) {
                let fast = best(&|| seconds(isa, (nside, pairs), (samples, 1)));
                let rate = samples as f64 / fast / 1e6;
                print!(" {rate:>8.1} ({:>4.1})", rate / plain);
            } else {
                print!(" {:>16}", "-");
            }
        }
        println!();
    }
    let isa = Isa::best();
    let steps = if test { 1_000_000 } else { 100_000_000 };
    // Long enough that starting threads does not count.
    let year = 9 * samples;
    let one = best(&|| seconds(isa, (128, &FIVE), (year, 1)));
    let two = best(&|| seconds(isa, (128, &FIVE), (year, 2)));
    let alone = best(&|| arithmetic_seconds(1, steps));
    let both = best(&|| arithmetic_seconds(2, steps));
    println!(
        "two threads over one, {}: {:.2}; plain arithmetic: {:.2}",
        isa.name(),
        one / two,
        2.0 * alone / both
    );
}
