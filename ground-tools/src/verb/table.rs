//! `gyrfalcon table`: build, inspect and verify the tables that go on board.

use super::{print_json, tell, world};
use crate::cli::{SharedArgs, TableVerb};
use crate::failure::Failure;
use crate::mission::Mission;
use crate::output::Sink;
use crate::passes;
use crate::quantity;
use crate::rounding;
use crate::uplink::{Contents, digest, span_told, told};
use ephem::fit::{FitOptions, MILLIARCSECOND_RAD};
use ephem::kernel::body_name;
use ephem::source::Source;
use ephem::verify::{BodyCheck, verify};
use onboard_core::ephemeris::{EphemerisTable, SUN, Span};
use onboard_core::uplink::{
    Container, MissionError, MissionTable, PlanError, PlanTable, SectionKind, UplinkError,
};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Instants per body at which `verify` compares.
const SAMPLES: usize = 10_000;
/// Their seed: the same instants in every run.
const SEED: u64 = 1;
const DEFAULT_FILE: &str = "uplink.tbl";

pub(super) fn run(shared: &SharedArgs, verb: &TableVerb) -> Result<(), Failure> {
    match verb {
        TableVerb::Build { error, target, sequence } => build(shared, error, target, *sequence),
        TableVerb::Inspect { file } => inspect(shared, file),
        TableVerb::Verify { file, error } => check(shared, file, error),
    }
}

/// An angle of the command line in radians.
pub(super) fn angle(option: &str, text: &str) -> Result<f64, Failure> {
    let degrees =
        quantity::degrees(text).map_err(|error| Failure::Input(format!("{option}: {error}")))?;
    Ok(rounding::radians(&degrees))
}

fn build(
    shared: &SharedArgs,
    error: &str,
    bodies: &[String],
    sequence: u32,
) -> Result<(), Failure> {
    let mut world = world(shared)?;
    if !bodies.is_empty() {
        let known = std::mem::take(&mut world.targets);
        for name in bodies {
            let own = known.iter().find(|source| source.name() == name).cloned();
            let source = own.map_or_else(|| Source::by_name(name).map_err(Failure::input), Ok)?;
            world.targets.push(source);
        }
    }
    let tolerance_rad = angle("--error", error)?;
    let options =
        FitOptions { tolerance_rad, rough_tolerance_rad: tolerance_rad, ..FitOptions::UPLINK };
    let tables = world.tables(&options)?;
    let contents =
        Contents { world: &world, ephemeris: &tables.fitted.bytes, sessions: None, sequence };
    let bytes = contents.to_bytes()?;
    let path = shared.out.clone().unwrap_or_else(|| DEFAULT_FILE.into());
    let sink = if path.as_os_str() == "-" { Sink::Stdout } else { Sink::File(path.clone()) };
    sink.write(&bytes)?;
    let rows = tables.fitted.bodies.iter().map(|it| {
        json!({
            "body": it.body,
            "name": it.name,
            "spans": it.spans,
            "granules": it.granules,
            "coefficients": it.coefficients,
            "bytes": it.bytes,
            "max_error_mas": it.max_error_rad / MILLIARCSECOND_RAD,
        })
    });
    if shared.json {
        if sink == Sink::Stdout {
            return Ok(());
        }
        return print_json(&json!({
            "bytes": bytes.len(),
            "ephemeris_bytes": tables.fitted.bytes.len(),
            "bodies": rows.collect::<Vec<Value>>(),
        }));
    }
    if sink == Sink::Stdout {
        return Ok(());
    }
    let mut text = format!(
        "{}: {} bytes, of which ephemeris {}\n\n{:<18} {:>8} {:>6} {:>7} {:>14}\n",
        path.display(),
        bytes.len(),
        tables.fitted.bytes.len(),
        "body",
        "granules",
        "terms",
        "bytes",
        "error (mas)"
    );
    for it in &tables.fitted.bodies {
        let _ = writeln!(
            text,
            "{:<18} {:>8} {:>6} {:>7} {:>14.3e}",
            it.name,
            it.granules,
            it.coefficients,
            it.bytes,
            it.max_error_rad / MILLIARCSECOND_RAD
        );
    }
    tell(shared, &text)
}

/// A table's sections, each read by the flight core.
struct Loaded<'b> {
    container: Container<'b>,
    ephemeris: EphemerisTable<'b>,
    mission: Option<MissionTable<'b>>,
    plan: Option<PlanTable<'b>>,
}

pub(super) fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(file).map_err(|error| Failure::file("read", file, &error))
}

fn load<'b>(file: &Path, bytes: &'b [u8]) -> Result<Loaded<'b>, Failure> {
    let refuse = |why: String| Failure::Input(format!("{}: {why}", file.display()));
    let container = Container::parse(bytes).map_err(|error| refuse(told(error)))?;
    let optional = |kind| match container.section(kind) {
        Ok(section) => Ok(Some(section)),
        Err(UplinkError::NoSuchSection(_)) => Ok(None),
        Err(error) => Err(refuse(told(error))),
    };
    let ephemeris =
        container.section(SectionKind::Ephemeris).map_err(|error| refuse(told(error)))?;
    let ephemeris =
        EphemerisTable::parse(ephemeris).map_err(|error| refuse(passes::told(error)))?;
    let mission = optional(SectionKind::Mission)?
        .map(MissionTable::parse)
        .transpose()
        .map_err(|error: MissionError| refuse(format!("its mission is refused: {error:?}")))?;
    let plan = optional(SectionKind::Plan)?
        .map(PlanTable::parse)
        .transpose()
        .map_err(|error: PlanError| refuse(format!("its plan is refused: {error:?}")))?;
    Ok(Loaded { container, ephemeris, mission, plan })
}

/// The ephemeris of an uplink table that was built for this mission.
pub(super) fn ephemeris<'b>(
    file: &Path,
    bytes: &'b [u8],
    mission: &Mission,
) -> Result<EphemerisTable<'b>, Failure> {
    let loaded = load(file, bytes)?;
    if digest(mission) != loaded.container.header().mission_digest {
        return Err(Failure::Input(format!(
            "{}: it was built for another mission (its digest differs): one of table build with \
             the same --mission, --set, --start and --duration is needed",
            file.display()
        )));
    }
    Ok(loaded.ephemeris)
}

/// The name of a body in a table.
fn name(number: i32) -> String {
    match number {
        SUN => "sun_to_spacecraft".to_owned(),
        own if own >= onboard_core::ephemeris::FIRST_USER_BODY => format!("source {own}"),
        body => body_name(body).to_owned(),
    }
}

fn inspect(shared: &SharedArgs, file: &Path) -> Result<(), Failure> {
    let bytes = read(file)?;
    let loaded = load(file, &bytes)?;
    let header = loaded.container.header();
    let hex: String = header.mission_digest.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    });
    let spans: Vec<Span> = loaded.ephemeris.spans().collect();
    if shared.json {
        let spans: Vec<Value> = spans
            .iter()
            .map(|span| {
                json!({
                    "body": span.body,
                    "name": name(span.body),
                    "start_tai_ns": span.start.tai_ns(),
                    "granules": span.granules,
                    "granule_ns": span.granule_ns,
                    "coefficients": span.coefficients,
                })
            })
            .collect();
        return print_json(&json!({
            "bytes": bytes.len(),
            "version": onboard_core::uplink::VERSION,
            "sequence": header.sequence,
            "valid_from_tai_ns": header.valid_from.tai_ns(),
            "valid_until_tai_ns": header.valid_until.tai_ns(),
            "mission_sha256_prefix": hex,
            "spans": spans,
            "telescopes": loaded.mission.map(|mission| mission.telescopes().count()),
            "sessions": loaded.plan.map(|plan| plan.sessions().count()),
        }));
    }
    let mut text = format!(
        "{}: {} bytes, format version {}, sequence {}\nvalid {}\nmission SHA-256 {hex}...\n",
        file.display(),
        bytes.len(),
        onboard_core::uplink::VERSION,
        header.sequence,
        span_told(header.valid_from, header.valid_until)
    );
    if let Some(mission) = loaded.mission {
        let parameters = *mission.strategy().parameters();
        let _ = writeln!(
            text,
            "mission: alpha {} deg, beta {} deg, {} telescopes",
            parameters.alpha_rad.to_degrees(),
            parameters.beta_rad.to_degrees(),
            mission.telescopes().count()
        );
    }
    if let Some(plan) = loaded.plan {
        let _ = writeln!(text, "plan: {} sessions", plan.sessions().count());
    }
    let _ = writeln!(
        text,
        "\n{:<18} {:>8} {:>12} {:>6}  span",
        "body", "granules", "granule (d)", "terms"
    );
    for span in spans {
        let end = span.end().unwrap_or(span.start);
        let granule = onboard_core::time::Duration::from_ns(
            i64::try_from(span.granule_ns.get()).unwrap_or(i64::MAX),
        );
        let _ = writeln!(
            text,
            "{:<18} {:>8} {:>12.3} {:>6}  {}",
            name(span.body),
            span.granules,
            granule.seconds() / 86_400.0,
            span.coefficients,
            span_told(span.start, end)
        );
    }
    tell(shared, &text)
}

fn check(shared: &SharedArgs, file: &Path, error: &str) -> Result<(), Failure> {
    let limit = angle("--error", error)?;
    let bytes = read(file)?;
    let loaded = load(file, &bytes)?;
    let mut world = world(shared)?;
    // Bodies beyond the mission's targets are known by their numbers.
    let known: Vec<Source> =
        ephem::source::names().filter_map(|name| Source::by_name(name).ok()).collect();
    for span in loaded.ephemeris.spans() {
        let here = |source: &Source| source.body() == span.body;
        if !world.targets.iter().any(here) {
            world.targets.extend(known.iter().find(|source| here(source)).cloned());
        }
    }
    let same_mission = digest(&world.mission) == loaded.container.header().mission_digest;
    let checks = verify(loaded.ephemeris, &world.sky, &world.targets, SAMPLES, SEED)
        .map_err(|error| Failure::Input(format!("{}: {error}", file.display())))?;
    let good = |it: &BodyCheck| {
        it.max_error_rad <= limit && it.rate_over_bound <= 1.0 && it.acceleration_over_bound <= 1.0
    };
    let passed = same_mission && checks.iter().all(good);
    if shared.json {
        let bodies: Vec<Value> = checks
            .iter()
            .map(|it| {
                json!({
                    "body": it.body,
                    "name": it.name,
                    "max_error_mas": it.max_error_rad / MILLIARCSECOND_RAD,
                    "rate_over_bound": it.rate_over_bound,
                    "acceleration_over_bound": it.acceleration_over_bound,
                    "ok": good(it),
                })
            })
            .collect();
        print_json(&json!({
            "verdict": if passed { "pass" } else { "fail" },
            "same_mission": same_mission,
            "samples": SAMPLES,
            "bodies": bodies,
        }))?;
    } else {
        let mut text = format!(
            "{:<18} {:>12} {:>12} {:>12}\n",
            "body", "error (mas)", "rate/bound", "acc/bound"
        );
        for it in &checks {
            let _ = writeln!(
                text,
                "{:<18} {:>12.6} {:>12.4} {:>12.4}  {}",
                it.name,
                it.max_error_rad / MILLIARCSECOND_RAD,
                it.rate_over_bound,
                it.acceleration_over_bound,
                if good(it) { "pass" } else { "FAIL" }
            );
        }
        tell(shared, &text)?;
    }
    if passed {
        return Ok(());
    }
    let mut why = Vec::new();
    if !same_mission {
        why.push("it was built for another mission (its digest differs)".to_owned());
    }
    for it in checks.iter().filter(|it| !good(it)) {
        why.push(format!(
            "{} is off by {:.3} mas (allowed {:.3}), or moves beyond its bounds",
            it.name,
            it.max_error_rad / MILLIARCSECOND_RAD,
            limit / MILLIARCSECOND_RAD
        ));
    }
    Err(Failure::Check(format!("{}: {}", file.display(), why.join("; "))))
}
