//! `gyrfalcon table diff`: what changes on board when one container follows another.
//!
//! Directions are compared at evenly spaced instants of the common validity; sessions by body,
//! telescope and precession turn. Whether a spacecraft with the old container would accept the new
//! one is the flight core's own answer at the start of the common validity.

use super::container::{load, read};
use super::words::{avoidance_told, hex};
use crate::cli::SharedArgs;
use crate::failure::Failure;
use crate::verb::delivered::{answer, answer_json};
use ephem::fit::MILLIARCSECOND_RAD;
use formats::uplink::{body_told, refusal_told, slot_image, span_told, told};
use onboard_core::time::{Duration, Instant};
use onboard_core::uplink::{SessionRecord, Slots, Tables, slot_bytes};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

/// Instants per body at which directions are compared.
const SAMPLES: i64 = 1000;

/// Old and new value of a field that differs.
pub(super) struct Change {
    pub(super) field: String,
    old: String,
    new: String,
}

/// How one body's directions differ.
struct BodyChange {
    body: i32,
    /// `None` where only one container has the body.
    max_difference_rad: Option<f64>,
    in_old: bool,
}

/// Sessions of only one of the two, and those of both with other times.
#[derive(Default)]
struct SessionChanges {
    kept: usize,
    moved: usize,
    added: usize,
    removed: usize,
}

pub(super) fn run(shared: &SharedArgs, old_file: &Path, new_file: &Path) -> Result<(), Failure> {
    let (old_bytes, new_bytes) = (read(old_file)?, read(new_file)?);
    let old = load(old_file, &old_bytes)?;
    let new = load(new_file, &new_bytes)?;
    let common = common_validity(&old, &new);
    let changes = changes(&old, &new);
    let bodies = bodies(&old, &new, common);
    let sessions = sessions(&old, &new);
    let now = common.map_or(new.header().valid_from, |(from, _)| from);
    let slot = slot_image(&old_bytes).map_err(|error| Failure::Input(told(error)))?;
    let room = vec![0xff_u8; slot_bytes(new_bytes.len()).unwrap_or(0)];
    let refusal = Slots { a: &slot, b: &room }.admit(&new_bytes, now).err().map(refusal_told);
    let identical = old_bytes == new_bytes;
    if shared.json {
        let fields: Vec<Value> = changes
            .iter()
            .map(|it| json!({ "field": it.field, "old": it.old, "new": it.new }))
            .collect();
        let bodies: Vec<Value> = bodies
            .iter()
            .map(|it| {
                json!({
                    "body": it.body,
                    "name": body_told(it.body),
                    "in": match it.max_difference_rad { Some(_) => "both", None if it.in_old => "old", None => "new" },
                    "max_difference_mas": it.max_difference_rad.map(|rad| rad / MILLIARCSECOND_RAD),
                })
            })
            .collect();
        return answer_json(
            shared,
            &json!({
                "identical": identical,
                "accepted": refusal.is_none(),
                "refusal": refusal,
                "fields": fields,
                "bodies": bodies,
                "sessions": {
                    "kept": sessions.kept,
                    "moved": sessions.moved,
                    "added": sessions.added,
                    "removed": sessions.removed,
                },
            }),
        );
    }
    let mut text = String::new();
    if identical {
        text.push_str("the two files are equal byte for byte\n");
    }
    for it in &changes {
        let _ = writeln!(text, "{}: {} -> {}", it.field, it.old, it.new);
    }
    for it in &bodies {
        let _ = match it.max_difference_rad {
            Some(rad) => {
                let mas = rad / MILLIARCSECOND_RAD;
                writeln!(text, "{}: directions differ by at most {mas:.3} mas", body_told(it.body))
            }
            None if it.in_old => writeln!(text, "{}: no longer there", body_told(it.body)),
            None => writeln!(text, "{}: new", body_told(it.body)),
        };
    }
    let _ = writeln!(
        text,
        "sessions: {} kept, {} moved, {} added, {} removed",
        sessions.kept, sessions.moved, sessions.added, sessions.removed
    );
    let _ = match refusal {
        None => writeln!(text, "a spacecraft with {} accepts it", old_file.display()),
        Some(why) => {
            writeln!(text, "a spacecraft with {} refuses it: {why}", old_file.display())
        }
    };
    answer(shared, &text)
}

fn common_validity(old: &Tables<'_>, new: &Tables<'_>) -> Option<(Instant, Instant)> {
    let (a, b) = (old.header(), new.header());
    let from = a.valid_from.max(b.valid_from);
    let until = a.valid_until.min(b.valid_until);
    (from <= until).then_some((from, until))
}

/// Header and mission fields that differ.
pub(super) fn changes(old: &Tables<'_>, new: &Tables<'_>) -> Vec<Change> {
    let fields = |tables: &Tables<'_>| {
        let header = tables.header();
        let mission = tables.mission();
        let it = *mission.strategy().parameters();
        let period = |rate: f64| format!("{} s", std::f64::consts::TAU / rate);
        let records = |bytes: Vec<Vec<u8>>| {
            let text: Vec<String> = bytes.iter().map(|record| hex(record)).collect();
            text.join(" ")
        };
        vec![
            ("sequence", header.sequence.to_string()),
            ("validity", span_told(header.valid_from, header.valid_until)),
            ("mission SHA-256", hex(&header.mission_digest)),
            ("spacecraft", format!("{:08x}", header.spacecraft)),
            ("start_tai_ns", it.start.tai_ns().to_string()),
            ("alpha", format!("{} deg", it.alpha_rad.to_degrees())),
            ("beta", format!("{} deg", it.beta_rad.to_degrees())),
            ("precession period", period(it.precession.rate.radians_per_second())),
            ("precession phase", format!("{} turn", it.precession.start.turns())),
            ("spin period", period(it.spin.rate.radians_per_second())),
            ("spin phase", format!("{} turn", it.spin.start.turns())),
            ("Sun model", format!("{:?}", mission.sun_record())),
            (
                "telescopes",
                records(mission.telescopes().map(|it| it.to_le_bytes().to_vec()).collect()),
            ),
            (
                "detectors",
                records(mission.detectors().map(|it| it.to_le_bytes().to_vec()).collect()),
            ),
            (
                "avoidance",
                mission.avoidance().map(|it| avoidance_told(&it)).collect::<Vec<_>>().join(", "),
            ),
        ]
    };
    let pairs = fields(old).into_iter().zip(fields(new));
    pairs
        .filter(|((_, old), (_, new))| old != new)
        .map(|((field, old), (_, new))| {
            let long = ["telescopes", "detectors"].contains(&field);
            let told = |text: String| match (long, text.is_empty()) {
                (_, true) => "none".to_owned(),
                (true, false) => "other records".to_owned(),
                (false, false) => text,
            };
            Change { field: field.to_owned(), old: told(old), new: told(new) }
        })
        .collect()
}

fn bodies(
    old: &Tables<'_>,
    new: &Tables<'_>,
    common: Option<(Instant, Instant)>,
) -> Vec<BodyChange> {
    let numbers = |tables: &Tables<'_>| -> BTreeSet<i32> {
        tables.ephemeris().spans().map(|span| span.body).collect()
    };
    let (in_old, in_new) = (numbers(old), numbers(new));
    in_old
        .union(&in_new)
        .map(|&body| BodyChange {
            body,
            in_old: in_old.contains(&body),
            max_difference_rad: (in_old.contains(&body) && in_new.contains(&body))
                .then(|| common.map_or(0.0, |span| difference_rad(old, new, body, span))),
        })
        .collect()
}

/// Largest angle between two tables' directions of a body.
fn difference_rad(
    old: &Tables<'_>,
    new: &Tables<'_>,
    body: i32,
    (from, until): (Instant, Instant),
) -> f64 {
    let direction = |tables: &Tables<'_>, at| {
        tables.ephemeris().body(body).and_then(|it| it.state(at)).ok().map(|it| it.direction)
    };
    let step = until.since(from).ns() / SAMPLES;
    (0..=SAMPLES)
        .filter_map(|index| {
            let at = from.plus(Duration::from_ns(step * index));
            Some(direction(old, at)?.separation_rad(direction(new, at)?))
        })
        .fold(0.0, f64::max)
}

fn sessions(old: &Tables<'_>, new: &Tables<'_>) -> SessionChanges {
    let keyed = |tables: &Tables<'_>| -> BTreeMap<(i32, u16, u32), SessionRecord> {
        tables.plan().sessions().map(|it| ((it.body, it.telescope, it.turn), it)).collect()
    };
    let (before, after) = (keyed(old), keyed(new));
    let mut changes = SessionChanges::default();
    for (key, session) in &before {
        match after.get(key) {
            Some(same) if same == session => changes.kept += 1,
            Some(_) => changes.moved += 1,
            None => changes.removed += 1,
        }
    }
    changes.added = after.keys().filter(|key| !before.contains_key(key)).count();
    changes
}
