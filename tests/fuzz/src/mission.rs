//! The mission section, without a container about it.

use crate::ephemeris::instants;
use onboard_core::attitude::attitude;
use onboard_core::sun::SunModel;
use onboard_core::uplink::{Counts, MissionTable, SunRecord};

const FIXED_BYTES: usize = 112;
const TELESCOPE_BYTES: usize = 80;
const DETECTOR_BYTES: usize = 40;
const ROTATION_BYTES: usize = 32;

/// Reads the bytes as a mission.
pub fn run(data: &[u8]) {
    if let Ok(mission) = MissionTable::parse(data) {
        check_bytes(&mission, data);
        check(&mission, data.len() as u64);
    }
}

/// The encoders give the bytes back; rotations, which are renormalised, give the same rotation.
fn check_bytes(mission: &MissionTable<'_>, data: &[u8]) {
    let number = |at: usize| u16::from_le_bytes([data[at], data[at + 1]]);
    let counts = Counts { telescopes: number(98), detectors: number(100), avoidance: number(102) };
    let radius = data[104..112].first_chunk::<8>().map_or(0.0, |it| f64::from_le_bytes(*it));
    let strategy = mission.strategy();
    let parameters = strategy.parameters();
    let sun = mission.sun_record();
    let fixed = MissionTable::fixed_to_le_bytes(parameters, sun, counts, radius);
    assert_eq!(fixed, data[..FIXED_BYTES]);
    let mut rest = &data[FIXED_BYTES..];
    let mut next = |size: usize| {
        let (own, after) = rest.split_at(size);
        rest = after;
        own
    };
    for telescope in mission.telescopes() {
        same_record(&telescope.to_le_bytes(), next(TELESCOPE_BYTES));
    }
    for detector in mission.detectors() {
        same_record(&detector.to_le_bytes(), next(DETECTOR_BYTES));
    }
    for limit in mission.avoidance() {
        assert_eq!(limit.to_le_bytes(), next(16));
    }
    assert!(rest.is_empty(), "records left out");
}

fn same_record(again: &[u8], own: &[u8]) {
    assert_eq!(again[ROTATION_BYTES..], own[ROTATION_BYTES..]);
    let numbers = |bytes: &[u8]| {
        let number = |chunk: &[u8; 8]| f64::from_le_bytes(*chunk);
        bytes[..ROTATION_BYTES].as_chunks::<8>().0.iter().map(number).collect::<Vec<f64>>()
    };
    let along: f64 = numbers(again).iter().zip(numbers(own)).map(|(a, b)| a * b).sum();
    assert!((along.abs() - 1.0).abs() < 2e-6, "another rotation: {along}");
}

/// Asks an accepted mission for everything that it can answer.
pub fn check(mission: &MissionTable<'_>, seed: u64) {
    let telescopes = mission.telescopes().count() as u16;
    let mut detectors = 0;
    for index in 0..telescopes {
        let telescope = mission.telescope(index).expect("a telescope");
        telescope.field_of_view().expect("a checked field of view");
        let mut fields = 0_u16;
        while mission.calibration_field(index, fields).is_some() {
            fields += 1;
        }
        let listed = mission.detectors().filter(|it| it.telescope == index).count();
        assert_eq!(usize::from(fields), listed.max(1));
        detectors += listed;
    }
    assert_eq!(mission.detectors().count(), detectors);
    assert!(mission.telescope(telescopes).is_none());
    let limits = mission.avoidance().count() as u16;
    assert_eq!(mission.avoidance_limit(0).is_some(), limits > 0);
    assert!(mission.avoidance_limit(limits).is_none());
    let scan = mission.strategy();
    for at in instants(&[scan.parameters().start], seed) {
        let _ = (scan.phases(at), scan.turns(at), scan.elapsed(at));
        if let SunRecord::Circular(longitude) = mission.sun_record() {
            let look = attitude(&scan, &SunModel::Circular(longitude), at).expect("any time");
            assert!(look.to_xyzw().iter().all(|it| it.is_finite()));
        }
    }
}
