//! The survey kernel against maps of an independent program, and against the flight core sample by
//! sample.

mod turning;

use onboard_core::frame::{Boresight, Detector};
use onboard_core::phase::Phase;
use onboard_core::rotation::Rotation;
use onboard_core::time::{Duration, Instant};
use planner::healpix::{Nside, Ordering};
use planner::progress::Quietly;
use planner::survey::{
    BigRational, Collector, ExactRotor, Isa, MOST_MOMENTS, MapFrame, Moment, SampledScan,
    SunSource, Survey, SurveyDetector, SurveyMaps, SurveyStatistics, SurveySun,
};
use serde_json::Value;
use turning::turning;

/// A survey in plain numbers.
#[derive(Debug, Clone)]
struct Case {
    alpha_deg: f64,
    beta_deg: f64,
    precession_s: (i64, i64),
    spin_s: (i64, i64),
    signs: (i64, i64),
    phases_rad: (f64, f64),
    plate_rpm: i64,
    longitude_rad: f64,
    hz: u64,
    samples: u64,
    nside: u32,
    frame: MapFrame,
    step_s: Option<i64>,
    moments: Vec<(f64, f64)>,
    detectors: Vec<Rotation<Detector, Boresight>>,
}

impl Case {
    fn litebird() -> Self {
        Self {
            alpha_deg: 45.0,
            beta_deg: 50.0,
            precession_s: (1_154_088, 100),
            spin_s: (1200, 1),
            signs: (1, 1),
            phases_rad: (0.0, std::f64::consts::PI),
            plate_rpm: 61,
            longitude_rad: 0.0,
            hz: 1,
            samples: 100_000,
            nside: 64,
            frame: MapFrame::Ecliptic,
            step_s: None,
            moments: vec![(1.0, 0.0), (2.0, 0.0), (4.0, 0.0), (2.0, 4.0), (4.0, 8.0)],
            detectors: vec![Rotation::IDENTITY],
        }
    }

    fn run(&self, isa: Isa, threads: usize) -> SurveyMaps {
        let signed = |(above, below): (i64, i64), sign: i64| (sign * above, below);
        let scan = SampledScan {
            start: Instant::from_tai_ns(0),
            sampling_hz: BigRational::from_integer(self.hz.into()),
            alpha_rad: self.alpha_deg.to_radians(),
            beta_rad: self.beta_deg.to_radians(),
            precession: turning(signed(self.precession_s, self.signs.0), self.phases_rad.0),
            spin: turning(signed(self.spin_s, self.signs.1), self.phases_rad.1),
        };
        // A plate of 0 rpm stands still.
        let turns_per_s = BigRational::new(self.plate_rpm.into(), 60.into());
        let plate = Some(ExactRotor { turns_per_s, start: Phase::ZERO });
        let detector =
            |&rotation| SurveyDetector { rotation, plate: plate.clone(), polarisation_rad: 0.0 };
        let moment = |&(n, m): &(f64, f64)| Moment::new(n, m).unwrap();
        let survey = Survey {
            scan,
            sun: SurveySun {
                source: SunSource::Circular(turning((31_557_600, 1), self.longitude_rad)),
                step: self.step_s.map(|s| Duration::from_ns(s * 1_000_000_000)),
            },
            detectors: self.detectors.iter().map(detector).collect(),
            nside: Nside::new(self.nside).unwrap(),
            frame: self.frame,
            moments: self.moments.iter().map(moment).collect(),
        };
        let mut collector = Collector::new(survey, isa).unwrap();
        collector.collect(0..self.samples, threads, &Quietly).unwrap();
        collector.finish()
    }
}

fn reference() -> Value {
    serde_json::from_str(include_str!("../data/maps.json")).unwrap()
}

fn case_of(reference: &Value) -> Case {
    let number = |key: &str| reference["cfg"][key].as_f64().unwrap();
    let whole = |x: f64| (x * 100.0 * 60.0).round() as i64;
    let hz = reference["fs"].as_f64().unwrap() as u64;
    let moments: Vec<(f64, f64)> = reference
        .as_object()
        .unwrap()
        .keys()
        .filter_map(|key| key.strip_prefix('x')?.split_once(','))
        .map(|(n, m)| (n.parse().unwrap(), m.parse().unwrap()))
        .collect();
    Case {
        alpha_deg: number("alpha"),
        beta_deg: number("beta"),
        precession_s: (whole(number("Ta_min")), 100),
        spin_s: (whole(number("Tb_min")), 100),
        phases_rad: (number("pa"), number("pb")),
        plate_rpm: number("hwp_rpm") as i64,
        longitude_rad: number("L0"),
        hz,
        samples: hz * 86_400 * reference["days"].as_u64().unwrap(),
        nside: reference["nside"].as_u64().unwrap() as u32,
        moments,
        ..Case::litebird()
    }
}

/// Mean of |h|^2 over observed pixels.
fn mean(maps: &SurveyMaps, moment: usize) -> f64 {
    let squares: Vec<f64> = (0..maps.nside().pixels())
        .filter_map(|pixel| maps.h(pixel, moment))
        .map(|(re, im)| re * re + im * im)
        .collect();
    squares.iter().sum::<f64>() / squares.len() as f64
}

fn check(name: &str) -> SurveyMaps {
    let all = reference();
    let expected = &all["cases"][name];
    let case = case_of(expected);
    let maps = case.run(Isa::best(), 2);
    let hits: Vec<u64> = maps.hits_in(Ordering::Ring).collect();
    assert_eq!(hits.iter().sum::<u64>(), expected["nhits"].as_u64().unwrap());
    for (found, expected) in hits.iter().zip(expected["first_pixels"].as_array().unwrap()) {
        assert_eq!(*found, expected.as_u64().unwrap(), "{name}");
    }
    let squares: u64 = hits.iter().map(|h| h * h).sum();
    let expected_squares = expected["w2sum"].as_u64().unwrap();
    // Four samples on other sides of edges change the sum of squares by less than 16 of the largest.
    assert!(squares.abs_diff(expected_squares) <= 16 * hits.iter().max().unwrap(), "{name}");
    for (index, (n, m)) in case.moments.iter().enumerate() {
        let expected = expected[format!("x{n},{m}")].as_f64().unwrap();
        let off = (mean(&maps, index) / expected - 1.0).abs();
        assert!(off < if *m == 0.0 { 1e-9 } else { 1e-6 }, "{name} {n},{m}: {off:e}");
    }
    for sample in expected["samples"].as_array().into_iter().flatten() {
        let pixel = maps.nside().nested_of_ring(sample["pix"].as_u64().unwrap() as u32);
        assert_eq!(maps.hits(pixel), sample["hits"].as_u64().unwrap());
        for (index, (n, m)) in case.moments.iter().enumerate() {
            let Some(pair) = sample["h"][format!("{n},{m}")].as_array() else { continue };
            let (re, im) = maps.h(pixel, index).unwrap();
            let off = (re - pair[0].as_f64().unwrap()).hypot(im - pair[1].as_f64().unwrap());
            // The reference turns its plate in f64.
            assert!(off < if *m == 0.0 { 1e-10 } else { 1e-7 }, "{name} {n},{m}: {off:e}");
        }
    }
    maps
}

/// Hits of a reference file: an npy of i32 in RING order.
fn hits_file(bytes: &[u8]) -> Vec<i32> {
    let header = u16::from_le_bytes([bytes[8], bytes[9]]) as usize;
    bytes[10 + header..]
        .chunks_exact(4)
        .map(|it| i32::from_le_bytes(it.try_into().unwrap()))
        .collect()
}

fn distance(maps: &SurveyMaps, expected: &[i32]) -> u64 {
    maps.hits_in(Ordering::Ring).zip(expected).map(|(a, &b)| a.abs_diff(b as u64)).sum()
}

#[test]
fn a_year_of_litebird_at_1_hz() {
    let maps = check("std_fs1_d365_ns64");
    let expected = hits_file(include_bytes!("../data/hits_std_fs1_d365_ns64.npy"));
    assert!(distance(&maps, &expected) <= 4);
}

#[test]
fn a_month_with_odd_angles() {
    let maps = check("odd1_fs1_d30_ns64");
    let expected = hits_file(include_bytes!("../data/hits_odd1_fs1_d30_ns64.npy"));
    assert!(distance(&maps, &expected) <= 4);
}

#[test]
fn other_starts_and_strategies() {
    for name in ["std_fs1_d30_ns64", "std_pole_fs1_d30_ns64", "planck_fs4_d30_ns64"] {
        check(name);
    }
}

#[test]
fn a_year_of_litebird_at_19_hz() {
    check("std_fs19_d365_ns128");
}

/// Same pixels and hits, h to 1e-10.
fn assert_same(name: &str, a: &SurveyMaps, b: &SurveyMaps) {
    for pixel in 0..a.nside().pixels() {
        assert_eq!(a.hits(pixel), b.hits(pixel), "{name}: pixel {pixel}");
        for moment in 0..a.moments().len() {
            if let (Some(x), Some(y)) = (a.h(pixel, moment), b.h(pixel, moment)) {
                let off = (x.0 - y.0).hypot(x.1 - y.1);
                assert!(off < 1e-10, "{name}: pixel {pixel} {:?}: {off:e}", a.moments()[moment]);
            }
        }
    }
}

fn focal_plane() -> Vec<Rotation<Detector, Boresight>> {
    [(0.0, 0.0, 0.0), (0.2, 1.0, 0.4), (0.1, 4.0, -2.0), (0.87, 3.2, 0.1)]
        .map(|(r, a, g)| onboard_core::detector::detector_at(r, a, g))
        .to_vec()
}

/// Every path of the kernel: block lengths, poles, regions, frames, senses, steps, half-integers.
fn cases() -> Vec<(&'static str, Case)> {
    let base = Case::litebird();
    let halves = vec![(0.5, 0.0), (-1.5, 2.0), (2.0, 0.5), (0.0, -1.5), (2.0, 4.0)];
    let many = (0..20).map(|k| (f64::from(k - 9), f64::from(k % 5))).collect();
    vec![
        ("19 Hz", Case { hz: 19, nside: 128, ..base.clone() }),
        ("19 Hz hits", Case { hz: 19, moments: vec![], ..base.clone() }),
        ("1 Hz", base.clone()),
        ("fine", Case { hz: 19, nside: 2048, ..base.clone() }),
        ("coarse", Case { hz: 19, nside: 1, ..base.clone() }),
        ("focal plane", Case { hz: 7, samples: 50_000, detectors: focal_plane(), ..base.clone() }),
        (
            "galactic",
            Case {
                hz: 19,
                frame: MapFrame::Galactic,
                detectors: focal_plane(),
                longitude_rad: 2.0,
                samples: 40_000,
                ..base.clone()
            },
        ),
        ("reversed", Case { hz: 19, signs: (-1, 1), ..base.clone() }),
        ("spin reversed", Case { hz: 5, signs: (1, -1), ..base.clone() }),
        ("steps", Case { hz: 19, step_s: Some(613), ..base.clone() }),
        ("days", Case { step_s: Some(86_400), samples: 200_000, ..base.clone() }),
        ("fast spin", Case { hz: 19, spin_s: (60, 1), ..base.clone() }),
        ("halves", Case { hz: 19, moments: halves, samples: 30_000, ..base.clone() }),
        ("half of psi", Case { hz: 19, moments: vec![(0.5, 0.0), (2.5, 4.0)], ..base.clone() }),
        ("many moments", Case { hz: 19, moments: many, samples: 30_000, ..base.clone() }),
        (
            "through the poles",
            Case { hz: 19, alpha_deg: 40.0, beta_deg: 50.0, nside: 256, ..base.clone() },
        ),
        ("along the equator", Case { hz: 19, alpha_deg: 0.0, beta_deg: 90.0, ..base.clone() }),
        ("at the Sun's back", Case { hz: 19, alpha_deg: 0.0, beta_deg: 0.0, ..base.clone() }),
        ("slow", Case { samples: 100_000, precession_s: (864_000, 1), ..base }),
    ]
}

#[test]
fn every_instruction_set_agrees_with_the_flight_core() {
    for (name, case) in cases() {
        let plain = case.run(Isa::PLAIN, 2);
        for isa in ["avx512", "avx2", "portable"] {
            if let Ok(isa) = Isa::named(isa) {
                assert_same(&format!("{name}, {}", isa.name()), &plain, &case.run(isa, 2));
            }
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let case = Case { hz: 19, samples: 3_000_000, nside: 32, ..Case::litebird() };
    let bits = |threads| -> Vec<(u64, Vec<(u64, u64)>)> {
        let maps = case.run(Isa::best(), threads);
        (0..maps.nside().pixels())
            .map(|pixel| {
                let parts = (0..maps.moments().len())
                    .filter_map(|moment| maps.h(pixel, moment))
                    .map(|(re, im)| (re.to_bits(), im.to_bits()))
                    .collect();
                (maps.hits(pixel), parts)
            })
            .collect()
    };
    let one = bits(1);
    assert_eq!(one, bits(2));
    assert_eq!(one, bits(4));
}

#[test]
fn maps_have_the_moments_that_were_collected() {
    let moments = (0..70).map(|k| (f64::from(k) / 2.0, 0.0)).collect();
    let case = Case { samples: 5000, nside: 4, moments, ..Case::litebird() };
    let (fast, plain) = (case.run(Isa::best(), 1), case.run(Isa::PLAIN, 1));
    assert_eq!(fast.moments().len(), MOST_MOMENTS);
    assert_same("70 moments", &plain, &fast);
    assert_eq!(fast.h(0, MOST_MOMENTS), None);
}

#[test]
fn full_rows_are_set_aside() {
    // All samples in twelve pixels, more than 2^22 in some.
    let case =
        Case { samples: 60_000_000, nside: 1, moments: vec![(0.0, 0.0)], ..Case::litebird() };
    let maps = case.run(Isa::best(), 2);
    let hits: Vec<u64> = (0..12).map(|pixel| maps.hits(pixel)).collect();
    assert_eq!(hits.iter().sum::<u64>(), case.samples);
    assert!(hits.iter().any(|&it| it > 1 << 22));
    for pixel in 0..12 {
        let (re, im) = maps.h(pixel, 0).unwrap();
        assert!((re - 1.0).abs() < 1e-12 && im.abs() < 1e-12);
    }
}

#[test]
fn balanced_angles_spread_hits_by_a_tenth_more() {
    // One year at 19 Hz, nside 256: 209.81 for alpha = 45 deg, 229.92 for alpha = beta = 47.5 deg.
    let year = Case {
        hz: 19,
        samples: 19 * 86_400 * 365,
        nside: 256,
        moments: vec![],
        ..Case::litebird()
    };
    let sigma = |case: &Case| SurveyStatistics::of(&case.run(Isa::best(), 2)).sigma_hits;
    let standard = sigma(&year);
    let balanced = sigma(&Case { alpha_deg: 47.5, beta_deg: 47.5, ..year });
    assert!((standard - 209.81).abs() < 0.01, "{standard}");
    assert!((balanced - 229.92).abs() < 0.01, "{balanced}");
    assert!((balanced / standard - 1.096).abs() < 5e-4);
}
