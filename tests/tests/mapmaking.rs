//! Maps made from the timestream of a known sky: what comes back, how well, in every frame.

mod turning;

use onboard_core::detector::detector_at;
use onboard_core::frame::{Boresight, Detector};
use onboard_core::rotation::Rotation;
use onboard_core::time::Instant;
use planner::healpix::{Nside, Ordering};
use planner::mapmaking::{
    BinnedMaps, CONDITION_LIMIT, MapMaker, PolarisationConvention, Sample, Sky, SkyMap,
};
use planner::progress::Progress;
use planner::survey::{
    BigRational, Isa, MapFrame, SampledScan, SunSource, Survey, SurveyDetector, SurveySun,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering as Memory};
use turning::turning;

/// Counts samples.
#[derive(Default)]
struct Counted(AtomicU64);

impl Progress for Counted {
    fn advance(&self, units: u64) {
        self.0.fetch_add(units, Memory::Relaxed);
    }
}

/// LiteBIRD's strategy on a circular Sun, with some detectors and their polarisation angles.
#[derive(Debug, Clone)]
struct Case {
    hz: u64,
    samples: u64,
    nside: u32,
    frame: MapFrame,
    plate_rpm: Option<i64>,
    detectors: Vec<(Rotation<Detector, Boresight>, f64)>,
    isa: Isa,
    threads: usize,
}

/// Off the boresight, turned in their frames and by polarisation angles.
fn focal_plane() -> Vec<(Rotation<Detector, Boresight>, f64)> {
    vec![
        (detector_at(0.0, 0.0, 0.0), 0.0),
        (detector_at(0.2, 1.0, 0.4), 0.7),
        (detector_at(0.1, 4.0, -2.0), -1.1),
    ]
}

impl Case {
    fn litebird() -> Self {
        Self {
            hz: 1,
            samples: 400_000,
            nside: 16,
            frame: MapFrame::Ecliptic,
            plate_rpm: Some(61),
            detectors: focal_plane(),
            isa: Isa::best(),
            threads: 2,
        }
    }

    fn run(&self, sky: &Arc<Sky>, signal: impl Fn(&Sample) -> f64 + Sync) -> BinnedMaps {
        let plate = self.plate_rpm.map(|rpm| turning((60, rpm), 0.0));
        let detector = |&(rotation, polarisation_rad)| SurveyDetector {
            rotation,
            plate: plate.clone(),
            polarisation_rad,
        };
        let survey = Survey {
            scan: SampledScan {
                start: Instant::from_tai_ns(0),
                sampling_hz: BigRational::from_integer(self.hz.into()),
                alpha_rad: 45.0_f64.to_radians(),
                beta_rad: 50.0_f64.to_radians(),
                precession: turning((1_154_088, 100), 0.0),
                spin: turning((1200, 1), std::f64::consts::PI),
            },
            sun: SurveySun {
                source: SunSource::Circular(turning((31_557_600, 1), 0.0)),
                step: None,
            },
            detectors: self.detectors.iter().map(detector).collect(),
            nside: Nside::new(self.nside).unwrap(),
            frame: self.frame,
            moments: Vec::new(),
        };
        let progress = Counted::default();
        let mut maker = MapMaker::new(survey, Arc::clone(sky), self.isa).unwrap();
        maker.collect(0..self.samples, self.threads, &progress, &signal).unwrap();
        assert_eq!(progress.0.load(Memory::Relaxed), self.samples * self.detectors.len() as u64);
        maker.finish()
    }
}

fn sky(nside: u32, frame: MapFrame, value: impl Fn(u32) -> [f64; 3]) -> Arc<Sky> {
    let nside = Nside::new(nside).unwrap();
    let stokes: Vec<[f64; 3]> = (0..nside.pixels()).map(value).collect();
    let [i, q, u] = [0, 1, 2].map(|k| stokes.iter().map(|it| it[k]).collect::<Vec<f64>>());
    let map = SkyMap {
        nside,
        ordering: Ordering::Nested,
        frame,
        convention: PolarisationConvention::Cosmo,
        stokes: [&i, &q, &u],
    };
    Arc::new(Sky::new(&map).unwrap())
}

/// Pixels that have a solution, all of which are `expected` to `bound`.
fn solved(maps: &BinnedMaps, bound: f64, expected: impl Fn(u32) -> [f64; 3]) -> usize {
    let mut count = 0;
    for pixel in 0..maps.nside().pixels() {
        let Some(solution) = maps.solve(pixel, CONDITION_LIMIT) else { continue };
        count += 1;
        for (found, expected) in solution.stokes.iter().zip(expected(pixel)) {
            assert!(
                (found - expected).abs() < bound,
                "pixel {pixel}: {found} for {expected}, condition {}",
                solution.condition
            );
        }
    }
    count
}

#[test]
fn a_uniform_sky_comes_back() {
    for stokes in [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]] {
        for frame in [MapFrame::Ecliptic, MapFrame::Galactic] {
            for plate_rpm in [None, Some(61)] {
                // The sky's own resolution does not matter.
                let sky = sky(8, frame, |_| stokes);
                let case = Case { frame, plate_rpm, ..Case::litebird() };
                let maps = case.run(&sky, Sample::signal);
                assert_eq!(maps.left_out(), 0);
                assert!(solved(&maps, 1e-10, |_| stokes) > 1500);
            }
        }
    }
}

/// Noise-like numbers in [-1/2, 1/2) [Steele2014].
fn scattered(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

#[test]
fn any_sky_of_the_same_pixels_comes_back() {
    let any = |pixel: u32| [1, 2, 3].map(|k| 10.0 * scattered(u64::from(3 * pixel + k)));
    for frame in [MapFrame::Ecliptic, MapFrame::Galactic] {
        for plate_rpm in [None, Some(61)] {
            let case = Case { frame, plate_rpm, nside: 32, ..Case::litebird() };
            let maps = case.run(&sky(32, frame, any), Sample::signal);
            assert!(solved(&maps, 1e-9, any) > 6000);
        }
    }
}

#[test]
fn the_sign_of_u_follows_the_convention() {
    let nside = Nside::new(4).unwrap();
    let ones = vec![1.0; nside.pixels() as usize];
    let iau = Sky::new(&SkyMap {
        nside,
        ordering: Ordering::Ring,
        frame: MapFrame::Ecliptic,
        convention: PolarisationConvention::Iau,
        stokes: [&ones; 3],
    })
    .unwrap();
    let maps = Case::litebird().run(&Arc::new(iau), Sample::signal);
    assert!(solved(&maps, 1e-10, |_| [1.0, 1.0, -1.0]) > 1500);
}

/// Q and U in the COSMO sense of a smooth field, and I: the transverse parts of two tensors, the
/// second turned by 45 degrees.
fn smooth([x, y, z]: [f64; 3]) -> [f64; 3] {
    let first = [[0.5, 0.3, -0.2], [0.3, -0.1, 0.4], [-0.2, 0.4, -0.7]];
    let second = [[-0.2, 0.1, 0.3], [0.1, 0.6, -0.3], [0.3, -0.3, 0.1]];
    let rho = x.hypot(y);
    let south = [x * z / rho, y * z / rho, -rho];
    let east = [-y / rho, x / rho, 0.0];
    let form = |t: &[[f64; 3]; 3], a: &[f64; 3], b: &[f64; 3]| -> f64 {
        (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).map(|(i, j)| a[i] * t[i][j] * b[j]).sum()
    };
    let along = |t| form(t, &south, &south) - form(t, &east, &east);
    let across = |t| 2.0 * form(t, &south, &east);
    [0.2 + 0.5 * x - 0.3 * z, along(&first) - across(&second), across(&first) + along(&second)]
}

/// Centres of RING pixels at nside 64, and I, Q, U there of the smooth field rotated by healpy 1.20.1
/// (`Rotator.rotate_map_pixel` of its map at nside 512).
const TO_ECLIPTIC: [(u32, [f64; 3]); 12] = [
    (301, [0.086_239, 1.604_863, -0.934_226]),
    (5000, [-0.093_272, -0.956_965, 0.404_182]),
    (10101, [0.370_008, -1.216_096, -0.651_646]),
    (15555, [-0.349_270, 0.593_738, -0.060_087]),
    (20202, [-0.282_900, 0.130_049, -0.253_841]),
    (24576, [-0.026_748, 0.099_640, 0.097_766]),
    (27800, [0.145_096, -1.244_427, 0.358_239]),
    (30303, [0.749_646, 0.833_524, 0.525_771]),
    (35353, [0.378_347, 0.265_860, -0.566_979]),
    (40404, [-0.090_541, 0.885_406, -0.266_590]),
    (45000, [0.590_751, -0.042_787, 1.930_376]),
    (48888, [0.422_992, -1.432_035, 1.099_556]),
];
const TO_GALACTIC: [(u32, [f64; 3]); 12] = [
    (301, [-0.374_359, 0.021_122, 0.628_577]),
    (5000, [-0.265_169, 0.516_249, -1.084_474]),
    (10101, [-0.142_479, 0.754_124, -0.440_444]),
    (15555, [-0.023_449, 0.309_691, -0.377_044]),
    (20202, [0.089_609, 1.034_339, -1.441_506]),
    (24576, [0.198_638, 1.042_395, -1.530_798]),
    (27800, [0.273_782, 0.135_033, 0.428_883]),
    (30303, [0.342_725, 1.667_623, -0.723_082]),
    (35353, [0.460_082, 0.557_166, -0.814_312]),
    (40404, [0.568_172, -0.098_513, -1.787_334]),
    (45000, [0.685_865, 1.895_299, 0.264_862]),
    (48888, [0.777_330, 1.020_278, 1.384_829]),
];

#[test]
fn a_sky_of_another_frame_is_rotated_as_healpy_does() {
    let fine = Nside::new(256).unwrap();
    for (from, to, expected) in [
        (MapFrame::Galactic, MapFrame::Ecliptic, TO_ECLIPTIC),
        (MapFrame::Ecliptic, MapFrame::Galactic, TO_GALACTIC),
    ] {
        let sky = sky(256, from, |pixel| {
            let (lon, lat) = fine.center(pixel);
            smooth(planner::healpix::unit_vector(lon, lat))
        });
        for plate_rpm in [None, Some(61)] {
            let case = Case {
                samples: 100 * 86_400,
                nside: 64,
                frame: to,
                plate_rpm,
                detectors: focal_plane()[..2].to_vec(),
                ..Case::litebird()
            };
            let maps = case.run(&sky, Sample::signal);
            let mut count = 0;
            for (ring, expected) in expected {
                let pixel = maps.nside().nested_of_ring(ring);
                let Some(solution) = maps.solve(pixel, 20.0) else { continue };
                count += 1;
                // The field changes by up to 0.02 from a pixel's centre to its edge.
                for (found, expected) in solution.stokes.iter().zip(expected) {
                    assert!(
                        (found - expected).abs() < 0.02,
                        "{from:?} {ring}: {:?}, {expected}",
                        solution.stokes
                    );
                }
            }
            assert!(count >= 8, "{count}");
        }
    }
}

/// Condition numbers by numpy.linalg.cond of `A^T A / N`, on an independent scan chain and healpy's
/// pixels: RING pixel, samples, without and with a plate.
const CONDITIONS: [(u32, u64, f64, f64); 7] = [
    (79, 118, 3.972_615_529_967_229_4, 2.055_488_783_767_442),
    (405, 144, 13.157_151_756_588_16, 2.120_843_267_977_738_5),
    (1444, 151, 6.438_680_494_164_74, 2.089_676_278_031_406_7),
    (1571, 219, 7.317_636_886_232_919, 2.102_256_696_508_314_3),
    (2348, 81, 4.333_844_130_757_255, 2.130_158_518_890_455_3),
    (2584, 69, 43.089_478_438_683_29, 3.136_480_773_278_468_5),
    (2954, 84, 4.047_051_967_698_41, 2.758_569_142_916_777),
];

#[test]
fn condition_numbers_are_those_of_numpy() {
    let sky = sky(1, MapFrame::Ecliptic, |_| [1.0, 0.0, 0.0]);
    for isa in [Isa::best(), Isa::PORTABLE, Isa::PLAIN] {
        let case = Case { samples: 60_000, isa, ..Case::litebird() };
        let with = case.run(&sky, Sample::signal);
        let without = Case { plate_rpm: None, ..case }.run(&sky, Sample::signal);
        for (ring, hits, bare, modulated) in CONDITIONS {
            let pixel = with.nside().nested_of_ring(ring);
            assert_eq!((with.hits(pixel), without.hits(pixel)), (hits, hits));
            for (maps, expected) in [(&without, bare), (&with, modulated)] {
                let found = maps.condition(pixel).unwrap();
                assert!((found / expected - 1.0).abs() < 1e-10, "{ring}: {found} {expected}");
                assert!(maps.solve(pixel, expected * 1.001).is_some());
                assert!(maps.solve(pixel, expected * 0.999).is_none());
            }
        }
    }
}

#[test]
fn errors_follow_the_inverse_normal_matrix() {
    let sky = sky(1, MapFrame::Ecliptic, |_| [0.0; 3]);
    // Sum of twelve evenly distributed numbers: variance 1.
    let noise = |sample: &Sample| -> f64 {
        let seed = 64 * (sample.number * 8 + sample.detector as u64);
        (0..12).map(|k| scattered(seed + k)).sum()
    };
    let maps = Case { plate_rpm: None, ..Case::litebird() }.run(&sky, noise);
    let (mut squares, mut cross, mut pixels) = ([0.0; 3], 0.0, 0.0);
    for pixel in 0..maps.nside().pixels() {
        let Some(solution) = maps.solve(pixel, 100.0) else { continue };
        pixels += 1.0;
        let (x, c) = (solution.stokes, solution.covariance);
        for k in 0..3 {
            squares[k] += x[k] * x[k] / c[k][k];
        }
        // Q and U made uncorrelated from Q.
        let rest = x[2] - x[1] * c[1][2] / c[1][1];
        cross += x[1] * rest / (c[1][1] * (c[2][2] - c[1][2] * c[1][2] / c[1][1])).sqrt();
    }
    assert!(pixels > 1000.0);
    // Mean of `pixels` squares of unit variance each: five times its standard deviation.
    let bound = 5.0 * (2.0_f64 / pixels).sqrt();
    for square in squares {
        assert!((square / pixels - 1.0).abs() < bound, "{square} {pixels}");
    }
    assert!((cross / pixels).abs() < bound, "{cross} {pixels}");
}

#[test]
fn samples_without_a_value_are_left_out() {
    let holes = sky(16, MapFrame::Ecliptic, |pixel| {
        if pixel % 3 == 0 { [1.0, f64::NAN, 0.0] } else { [1.0, 2.0, 3.0] }
    });
    let case = Case::litebird();
    let whole = case.run(&sky(16, MapFrame::Ecliptic, |_| [1.0; 3]), Sample::signal);
    let hits: Vec<u64> = (0..whole.nside().pixels()).map(|pixel| whole.hits(pixel)).collect();
    assert_eq!(hits.iter().sum::<u64>(), 3 * case.samples);
    let maps = case.run(&holes, Sample::signal);
    assert!(solved(&maps, 1e-10, |_| [1.0, 2.0, 3.0]) > 1000);
    let lost: u64 = hits.iter().step_by(3).sum();
    assert_eq!(maps.left_out(), lost);
    assert_eq!((maps.hits(0), maps.hits(1)), (0, hits[1]));
    // A detector that measures nothing.
    let maps = case.run(&holes, |it| if it.detector == 1 { f64::NAN } else { it.signal() });
    assert!(maps.left_out() > case.samples + lost / 2);
    assert!(solved(&maps, 1e-10, |_| [1.0, 2.0, 3.0]) > 1000);
}

#[test]
fn threads_do_not_change_a_bit() {
    let any = |pixel: u32| [1, 2, 3].map(|k| scattered(u64::from(3 * pixel + k)));
    let sky = sky(16, MapFrame::Galactic, any);
    // More detectors than share a job.
    let detectors = (0..7).map(|k| (detector_at(0.02 * f64::from(k), 1.0, 0.3), 0.2)).collect();
    let case = Case { hz: 19, samples: 300_000, detectors, ..Case::litebird() };
    let bits = |threads| -> Vec<Option<[u64; 3]>> {
        let maps = Case { threads, ..case.clone() }.run(&sky, Sample::signal);
        (0..maps.nside().pixels())
            .map(|pixel| maps.solve(pixel, 1e12).map(|it| it.stokes.map(f64::to_bits)))
            .collect()
    };
    let one = bits(1);
    assert!(one.iter().flatten().count() > 300);
    assert_eq!(one, bits(2));
    assert_eq!(one, bits(4));
}
