//! Damage of any kind to a container is seen: every single flipped bit, and a million random
//! corruptions. What is refused leaves the active tables as they were.
//!
//! CRC-32 finds every single flipped bit, and every burst of up to 32 bits inside what it covers.
//! Wider damage passes one CRC with a chance of 2^-32; every container has one over the header, one
//! over the directory and one per section, and the set's CRC-64 over all contents.

use ephem::apparent::Sky;
use ephem::fit::{FitOptions, fit};
use ephem::source::Source;
use ephem::time::parse_time;
use onboard_core::phase::{Phase, Rotor};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{
    CONTAINER_OFFSET, Container, FLOOR_OFFSET, Header, SectionKind, SessionRecord, Slot, Slots,
    Tables,
};
use std::thread;
use tests::campaign::{self, BODY, telescope};
use tests::uplink::{container, mission, plan, slot_with};
use tests::{Noise, Plain, turn_rate};

const SECOND: i64 = campaign::SECOND;
const DAYS: i64 = 1095;
const CORRUPTIONS: u64 = 1_000_000;
const THREADS: u64 = 2;

/// A real uplink: the Sun and five planets over three years from the embedded ephemeris, a mission,
/// and a plan that fills it up to 16 KiB.
fn uplink() -> Vec<u8> {
    let start = parse_time("2032-04-01T00:00:00 TDB").unwrap();
    let end = start.plus(Duration::from_ns(DAYS * campaign::DAY));
    let sources =
        ["mars", "jupiter", "saturn", "uranus", "neptune"].map(|it| Source::by_name(it).unwrap());
    let sky = Sky::from_l2(start);
    let fitted = fit(&sky, &sources, (start, end), &FitOptions::UPLINK).unwrap();
    let sun = Rotor { rate: turn_rate(31_557_600_000_000_000, 1), start: Phase::ZERO };
    let mission = mission(&Plain::LITEBIRD, sun, &[telescope()]);
    let header = Header {
        sequence: 7,
        valid_from: start,
        valid_until: end,
        mission_digest: [7; 16],
        spacecraft: 1,
    };
    let at =
        |turn: i64, seconds: i64| start.plus(Duration::from_ns((turn * 40_000 + seconds) * SECOND));
    let session = |turn: i64| SessionRecord {
        start: at(turn, 0),
        end: at(turn, 9000),
        first_entry: at(turn, 600),
        last_exit: at(turn, 8700),
        body: BODY,
        turn: u32::try_from(turn).unwrap(),
        telescope: 0,
        passes: 6,
    };
    let sessions: Vec<SessionRecord> = (0..20).map(session).collect();
    let bytes = container(
        &header,
        &[
            (SectionKind::Ephemeris, &fitted.bytes),
            (SectionKind::Mission, &mission),
            (SectionKind::Plan, &plan(&sessions)),
        ],
    );
    assert!((15 * 1024..=16 * 1024).contains(&bytes.len()), "{} bytes", bytes.len());
    assert!(Tables::load(&bytes).is_ok());
    bytes
}

/// A campaign's container of less than 2 KiB.
fn small() -> Vec<u8> {
    let bytes = campaign::uplink(7, &campaign::sessions(2));
    assert!(bytes.len() < 2048 && Tables::load(&bytes).is_ok());
    bytes
}

/// Calls `work` for every number below `count`, each on one of a few threads with its own image.
fn in_parallel(count: u64, good: &[u8], work: impl Fn(u64, &mut Vec<u8>) + Sync) {
    thread::scope(|scope| {
        for first in 0..THREADS {
            let work = &work;
            scope.spawn(move || {
                let mut image = good.to_vec();
                for index in (first..count).step_by(THREADS as usize) {
                    work(index, &mut image);
                }
            });
        }
    });
}

#[test]
// REQ-CONT-1.
fn every_flipped_bit_of_a_real_uplink_is_refused() {
    let good = uplink();
    in_parallel(good.len() as u64 * 8, &good, |bit, image| {
        let (byte, mask) = ((bit / 8) as usize, 1 << (bit % 8));
        image[byte] ^= mask;
        assert!(Container::parse(image).is_err(), "bit {bit}");
        image[byte] ^= mask;
    });
}

/// One corruption of `good` in `image`: bytes replaced, a range zeroed, set or swapped with another,
/// the end cut off or extended.
fn corrupt(noise: &mut Noise, good: &[u8], image: &mut Vec<u8>) {
    image.clear();
    image.extend(good);
    let below = |noise: &mut Noise, end: usize| (noise.bits() % end as u64) as usize;
    let start = below(noise, good.len());
    let longest = [1, 4, 16, 256, good.len()][below(noise, 5)].min(good.len() - start);
    let end = start + 1 + below(noise, longest);
    match noise.bits() % 7 {
        0 => image[start..end].fill(0),
        1 => image[start..end].fill(0xff),
        2 => image[start..end].iter_mut().for_each(|byte| *byte = noise.bits() as u8),
        3 => {
            let to = below(noise, good.len() - (end - start) + 1);
            image[to..to + end - start].copy_from_slice(&good[start..end]);
        }
        4 => image[start..end].rotate_left(1),
        5 => image.truncate(start),
        _ => {
            let more = 1 + below(noise, 64);
            image.extend((0..more).map(|_| noise.bits() as u8));
        }
    }
    if noise.bits().is_multiple_of(4) && !image.is_empty() {
        for _ in 0..=noise.bits() % 8 {
            let at = below(noise, image.len());
            image[at] = noise.bits() as u8;
        }
    }
}

#[test]
fn a_million_random_corruptions_are_refused() {
    let (small, real) = (small(), uplink());
    // One in sixteen is of the real uplink, which takes ten times as long to read.
    in_parallel(CORRUPTIONS, &[], |index, image| {
        let good = if index % 16 == 0 { &real } else { &small };
        let mut noise = Noise::new(index);
        corrupt(&mut noise, good, image);
        while *image == *good {
            corrupt(&mut noise, good, image);
        }
        assert!(Container::parse(image).is_err(), "corruption {index}");
    });
}

#[test]
// REQ-SLOT-7.
fn what_is_refused_leaves_the_active_tables() {
    let older = slot_with(&campaign::uplink(6, &campaign::sessions(2)));
    let active = slot_with(&small());
    let candidate = campaign::uplink(8, &campaign::sessions(3));
    let uploaded = slot_with(&candidate);
    let digest = Tables::load(&small()).unwrap().set_digest();
    let now = Instant::from_tai_ns(SECOND);
    assert_eq!(Slots { a: &older, b: &active }.active().unwrap().slot, Slot::B);
    in_parallel(20_000, &[], |index, image| {
        let mut noise = Noise::new(index);
        // In the candidate: it is not admitted.
        corrupt(&mut noise, &candidate, image);
        if *image != candidate {
            let slots = Slots { a: &older, b: &active };
            assert!(slots.admit(image, now).is_err(), "corruption {index}");
        }
        // In the slot that it went to: the other one stays. Its head is not looked at beyond its words.
        corrupt(&mut noise, &uploaded, image);
        let needed = CONTAINER_OFFSET + candidate.len();
        let whole = image.len() >= needed
            && image[..FLOOR_OFFSET] == uploaded[..FLOOR_OFFSET]
            && image[CONTAINER_OFFSET..needed] == uploaded[CONTAINER_OFFSET..needed];
        let in_use = Slots { a: image, b: &active }.active().unwrap();
        assert_eq!(in_use.slot, if whole { Slot::A } else { Slot::B }, "corruption {index}");
        assert!(whole || in_use.tables.set_digest() == digest);
    });
}
