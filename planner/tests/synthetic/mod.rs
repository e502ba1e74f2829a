//! A made-up mission with the rhythm of a real one: outer planets pass through three fields of view
//! of a precessing, spinning telescope. Deterministic; no kernel needed.

use ephem::random::SplitMix64;
use onboard_core::time::{Duration, Instant};
use planner::schedule::{Candidate, Demands, Exclusive, Problem, Rules, SessionCount};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Start of the synthetic mission in ns of TAI.
pub(crate) const START_TAI_NS: i64 = 1_017_748_800_000_000_000;
/// Nanoseconds in a day.
pub(crate) const DAY_NS: i64 = 86_400_000_000_000;

const SPIN_S: f64 = 1_200.0;
const PRECESSION_S: f64 = 11_540.88;
const ALPHA_DEG: f64 = 45.0;
const BETA_DEG: f64 = 50.0;
const SPEED_DEG_S: f64 = 0.26;
/// Synodic periods in days: Mars, Jupiter, Saturn, Uranus, Neptune.
const SYNODIC_DAYS: [f64; 5] = [779.9, 398.9, 378.1, 369.7, 367.5];

/// The rules of the default mission.
pub(crate) fn default_rules(days: i64) -> Rules {
    Rules {
        setup: Duration::from_seconds(600.0),
        cooldown: Duration::from_seconds(300.0),
        exclusive: Exclusive::Telescope,
        max_per_day: Some(Duration::from_seconds(240.0 * 60.0)),
        max_sessions: Some(SessionCount { count: 4, window: Duration::from_ns(DAY_NS) }),
        // The mission starts a little before a midnight.
        day_boundaries: (0..=days + 1)
            .map(|day| Instant::from_tai_ns(START_TAI_NS + 69_000_000_000 + (day - 1) * DAY_NS))
            .collect(),
    }
}

/// A mission of `days` days; telescopes 1 and 2 see alike unless `jitter` sets them apart.
pub(crate) fn mission(days: i64, seed: u64, jitter: bool, rules: Rules) -> Problem {
    let mut random = SplitMix64(seed);
    let mut groups: BTreeMap<(i64, usize, usize), (f64, f64, f64)> = BTreeMap::new();
    let span_s = Duration::from_ns(days * DAY_NS).seconds();
    for (target, synodic) in SYNODIC_DAYS.iter().enumerate() {
        let phase = unit(&mut random) * TAU;
        for telescope in 0..3 {
            let (height, offset) = match telescope {
                0 => (4.0, 0.0),
                _ if jitter => (14.0, unit(&mut random) - 0.5),
                _ => (14.0, 0.0),
            };
            let mut at = unit(&mut random) * if jitter { SPIN_S } else { 0.0 };
            while at < span_s {
                let elongation = (phase + at / 86_400.0 / synodic * TAU).rem_euclid(TAU) - PI;
                let turn = (at / PRECESSION_S).floor();
                let delta = separation_deg(elongation, (at / PRECESSION_S - turn) * TAU);
                let miss = (delta - BETA_DEG - offset).abs();
                if miss < height {
                    let chord = if telescope == 0 {
                        18.0
                    } else {
                        2.0 * (height * height - miss * miss).sqrt()
                    };
                    let dwell = chord / SPEED_DEG_S;
                    let entry = at + 400.0 * elongation.sin();
                    let key =
                        (Duration::from_seconds(turn).ns() / 1_000_000_000, target, telescope);
                    let group = groups.entry(key).or_insert((entry, entry, 0.0));
                    group.1 = entry + dwell;
                    group.2 += dwell;
                }
                at += SPIN_S;
            }
        }
    }
    let at =
        |seconds: f64| Instant::from_tai_ns(START_TAI_NS).plus(Duration::from_seconds(seconds));
    let candidates = groups
        .into_iter()
        .map(|((_, target, telescope), (entry, exit, dwell))| {
            let (first_entry, last_exit) = (at(entry), at(exit));
            let dwell = Duration::from_seconds(dwell).min(last_exit.since(first_entry));
            Candidate { target, telescope, first_entry, last_exit, dwell }
        })
        .collect();
    Problem {
        span: (at(0.0), at(span_s)),
        candidates,
        weights: vec![1.0; 5],
        rules,
        demands: Demands::default(),
    }
}

/// Angle of a planet on the ecliptic from the spin axis in degrees.
fn separation_deg(from_anti_sun_rad: f64, precession_rad: f64) -> f64 {
    let (sa, ca) = ALPHA_DEG.to_radians().sin_cos();
    let (sg, cg) = from_anti_sun_rad.sin_cos();
    (ca * cg + sa * sg * precession_rad.cos()).clamp(-1.0, 1.0).acos().to_degrees()
}

/// A number in [0, 1), of 32 bits as the mission was drawn whose optimum is stored.
fn unit(random: &mut SplitMix64) -> f64 {
    f64::from(u32::try_from(random.bits() >> 32).unwrap_or(0)) / 4_294_967_296.0
}
